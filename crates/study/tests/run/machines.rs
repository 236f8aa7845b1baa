//! Cycles, equilibria and linearised motions, held against closed forms.

use dwell_scene::Scene;
use dwell_study::{OperatingPoint, Outcome, SolverSettings, cycle, equilibria, linearise};
use std::f64::consts::{FRAC_PI_2, TAU};

const PENDULUM: &str = r#"
title = "Pendulum"
[bodies.ground]
points = { A = [0, 0] }
[bodies.bar]
points = { A = [0, 0] }
mass = 2.0
center = [0.3, 0]
inertia = 0.05
[joints]
A = { revolute = ["ground.A", "bar.A"] }
[actuators.phi]
angle = ["ground", "bar"]
[assembly]
phi = -1.0
[loads]
weight = { gravity = [0, -9.81] }
"#;

const MOTOR: &str = r#"
title = "Motor under a constant torque"
[bodies.ground]
points = { A = [0, 0] }
[bodies.shaft]
points = { A = [0, 0] }
mass = 1.0
center = "A"
inertia = 0.02
[joints]
A = { revolute = ["ground.A", "shaft.A"] }
[actuators.phi]
angle = ["ground", "shaft"]
[loads]
load = { torque = "shaft", magnitude = -1.5 }
[drives]
motor = { motor = "phi", voltage = 24, constant = 0.05, resistance = 1.2, inductance = 0.002, ratio = 10, inertia = 1e-5 }
[motion]
duration = 1
"#;

fn scene(text: &str) -> Scene {
    Scene::parse("machine.toml", text).unwrap()
}

fn text<'a>(outcome: &'a Outcome, end: &str) -> &'a str {
    let mut files = outcome.files.iter();
    let file = files.find(|(path, _)| path.to_str().unwrap().ends_with(end));
    std::str::from_utf8(file.unwrap().1).unwrap()
}

/// The column of a table whose header begins so.
fn column(table: &str, name: &str) -> Vec<f64> {
    let mut lines = table.lines();
    let mut header = lines.next().unwrap().split(',');
    let k = header.position(|h| h == name).unwrap();
    let cell = |line: &str| line.split(',').nth(k).unwrap().parse().unwrap_or(f64::NAN);
    lines.map(cell).collect()
}

/// To rounding, through a root and a linearisation.
fn assert_near(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * b.abs(), "{a} {b}");
}

#[test]
fn a_pendulum_hangs_and_stands_and_swings_with_the_root_of_its_moments() {
    let outcome = equilibria(&scene(PENDULUM)).unwrap();
    let table = text(&outcome, "equilibria.csv");
    let phi = column(table, "phi [rad]");
    assert_eq!(phi.len(), 2, "{table}");
    assert_near(phi[0], -FRAC_PI_2, 1e-14);
    assert_near(phi[1], FRAC_PI_2, 1e-14);
    assert_eq!(column(table, "stability"), [0.0, -1.0]);
    assert_near(
        column(table, "phi.deflection [rad]")[0],
        1.0 - FRAC_PI_2,
        1e-14,
    );
    let frequency = f64::sqrt(2.0 * 9.81 * 0.3 / (0.05 + 2.0 * 0.3 * 0.3));
    assert_near(
        column(table, "mode1.angular_frequency [rad/s]")[0],
        frequency,
        1e-14,
    );
    assert_near(
        column(table, "mode1.frequency [Hz]")[0],
        frequency / TAU,
        1e-14,
    );
    // Standing, it falls as fast as it would swing.
    assert_near(
        column(table, "max_real_eigenvalue [1/s]")[1],
        frequency,
        1e-14,
    );
}

#[test]
fn a_damped_pendulum_tells_its_damping_ratio() {
    let damped =
        format!("{PENDULUM}oil = {{ torsion-damper = [\"ground\", \"bar\"], constant = 0.7 }}\n");
    let outcome = equilibria(&scene(&damped)).unwrap();
    let table = text(&outcome, "equilibria.csv");
    let inertia = 0.05 + 2.0 * 0.3 * 0.3;
    let frequency = f64::sqrt(2.0 * 9.81 * 0.3 / inertia);
    assert_eq!(column(table, "stability"), [1.0, -1.0]);
    let ratio = 0.7 / (2.0 * inertia * frequency);
    assert_near(column(table, "mode1.damping_ratio")[0], ratio, 1e-13);
}

#[test]
fn a_linearised_pendulum_is_that_of_the_book() {
    let linear = linearise(&scene(PENDULUM), OperatingPoint::Equilibrium).unwrap();
    let table = text(&linear, "linear.csv");
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows[0], "matrix,row,phi [rad],phi.velocity [rad/s]");
    let stiffness = column(&rows[..3].join("\n"), "phi [rad]");
    assert_eq!(stiffness[0], 0.0);
    let inertia = 0.05 + 2.0 * 0.3 * 0.3;
    assert_near(stiffness[1], -2.0 * 9.81 * 0.3 / inertia, 1e-14);
    // About the start, 1 rad below the level, gravity has only the part of its lever that is left.
    let linear = linearise(&scene(PENDULUM), OperatingPoint::InitialState).unwrap();
    let rows: Vec<&str> = text(&linear, "linear.csv").lines().collect();
    let stiffness = column(&rows[..3].join("\n"), "phi [rad]");
    assert_near(
        stiffness[1],
        -2.0 * 9.81 * 0.3 * 1_f64.sin() / inertia,
        1e-14,
    );
    assert!(
        linear.summary.contains("not an equilibrium"),
        "{}",
        linear.summary
    );
}

#[test]
fn a_motor_under_load_turns_where_its_line_meets_the_load() {
    let outcome = cycle(&scene(MOTOR), &SolverSettings::default(), Some(0.02)).unwrap();
    let table = text(&outcome, "-cycle.csv");
    // Current 1.5 / (k N) = 3 A; speed (u − R i) / (k N). The tolerance is the integrator's.
    for speed in column(table, "phi.velocity [rad/s]") {
        assert_near(speed, (24.0 - 1.2 * 3.0) / 0.5, 1e-9);
    }
    for current in column(table, "motor.current [A]") {
        assert_near(current, 3.0, 1e-9);
    }
    let work = text(&outcome, "-work.csv");
    assert_near(column(work, "load.work [J]")[0], -1.5 * TAU, 1e-9);
    assert_near(column(work, "motor.work [J]")[0], 1.5 * TAU, 1e-8);
    assert!(outcome.summary.contains("stable: "), "{}", outcome.summary);
    assert!(
        outcome.summary.contains("no flywheel is needed"),
        "{}",
        outcome.summary
    );
}

#[test]
fn a_flywheel_evens_an_uneven_load() {
    let uneven_scene = MOTOR.replace("magnitude = -1.5", "magnitude = \"-1.5 - sin(phi)\"");
    let outcome = cycle(
        &scene(&uneven_scene),
        &SolverSettings::default(),
        Some(0.001),
    )
    .unwrap();
    let spread = |end: &str| {
        let table = text(&outcome, end);
        let speeds = column(table, "phi.velocity [rad/s]");
        let low = speeds.iter().copied().fold(f64::MAX, f64::min);
        let high = speeds.iter().copied().fold(f64::MIN, f64::max);
        let time = column(table, "t [s]");
        (high - low) * time[time.len() - 1] / TAU
    };
    assert!(spread("-cycle.csv") > 0.002);
    // The samples, a degree apart, miss the extremes by less than (½°)²/2 of them.
    assert_near(spread("-flywheel.csv"), 0.001, 1e-4);
    let sum = column(text(&outcome, "-work.csv"), "work_sum [J]")[0];
    assert!(sum.abs() < 1e-7, "{sum}");
}

#[test]
fn what_has_no_cycle_or_equilibrium_says_where() {
    let refused = |text: &str| {
        let error = cycle(&scene(text), &SolverSettings::default(), None).unwrap_err();
        error.to_string()
    };
    assert!(refused(PENDULUM).contains("no unique steady cycle"));
    let in_time = MOTOR.replace("voltage = 24", "voltage = \"24 + t\"");
    assert!(refused(&in_time).contains("autonomous"));
    let weak = MOTOR.replace("voltage = 24", "voltage = 3");
    // It rotates backwards, driven by its load: this is a cycle as well.
    let outcome = cycle(&scene(&weak), &SolverSettings::default(), None).unwrap();
    assert!(
        outcome.summary.contains("mean speed -1.2 rad/s"),
        "{}",
        outcome.summary
    );
    let error = linearise(&scene(MOTOR), OperatingPoint::Equilibrium).unwrap_err();
    assert!(
        error.to_string().contains("no equilibrium found"),
        "{error}"
    );
}
