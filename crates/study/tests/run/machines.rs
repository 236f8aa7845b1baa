//! Cycles, equilibria and linearised motions, held against closed forms.

use crate::table::PENDULUM;
use dwell_dynamics::Method;
use dwell_scene::PlaneScene;
use dwell_study::{OperatingPoint, Outcome, SolverSettings, StudyError, equilibria, linearise};
use std::f64::consts::{FRAC_PI_2, TAU};

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
motor = { motor = "phi", voltage = 24, torque-constant = 0.05, resistance = 1.2, inductance = 0.002, gear-ratio = 10, inertia = 1e-5 }
[motion]
duration = 1
"#;

/// The pendulum put together at an angle (rad).
fn pendulum_at(angle: &str) -> String {
    format!("{PENDULUM}[assembly]\nphi = {angle}\n")
}

fn scene(text: &str) -> PlaneScene {
    PlaneScene::parse("machine.toml", text).unwrap()
}

/// The cycle of a scene that has one.
fn cycle(
    scene: &PlaneScene,
    settings: &SolverSettings,
    fluctuation: Option<f64>,
) -> Result<Outcome, StudyError> {
    let found = dwell_study::cycle(scene, settings, fluctuation)?;
    assert!(found.early_stop.is_none(), "{:?}", found.early_stop);
    Ok(found.outcome)
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
    let outcome = equilibria(&scene(&pendulum_at("-1.0"))).unwrap();
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
        format!("{PENDULUM}oil = {{ rotational-damper = [\"ground\", \"bar\"], damping = 0.7 }}\n");
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
    let linear = linearise(&scene(&pendulum_at("-1.0")), OperatingPoint::Equilibrium).unwrap();
    let table = text(&linear, "linear.csv");
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows[0], "matrix,row,phi [rad],phi.velocity [rad/s]");
    let stiffness = column(&rows[..3].join("\n"), "phi [rad]");
    assert_eq!(stiffness[0], 0.0);
    let inertia = 0.05 + 2.0 * 0.3 * 0.3;
    assert_near(stiffness[1], -2.0 * 9.81 * 0.3 / inertia, 1e-14);
    // About the start, 1 rad below the level, gravity has only the part of its lever that is left.
    let linear = linearise(&scene(&pendulum_at("-1.0")), OperatingPoint::InitialState).unwrap();
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

/// The upright position is π/2 only to rounding, where the weight still turns the pendulum by 1e-15 rad/s²; with two
/// weights in balance the roundings of the weights remain at every angle.
#[test]
fn an_equilibrium_at_the_start_is_one_within_rounding() {
    let about_start = |text: &str| {
        let linear = linearise(&scene(text), OperatingPoint::InitialState).unwrap();
        linear.summary
    };
    let balanced = PENDULUM
        .replace("[joints]", "[bodies.load]\npoints = { P = [0.1, 0] }\nmass = 3.0\ncenter = \"P\"\ninertia = 0.1\n[joints]\nP = { weld = [\"bar.P\", \"load.P\"] }")
        .replace("points = { A = [0, 0] }\nmass = 2.0", "points = { A = [0, 0], P = [-0.2, 0] }\nmass = 2.0");
    for text in [
        pendulum_at("1.5707963267948966"),
        pendulum_at("-1.5707963267948966"),
        format!("{balanced}[assembly]\nphi = 0.3\n"),
    ] {
        let summary = about_start(&text);
        assert!(summary.contains("  an equilibrium"), "{summary}");
    }
    for angle in ["1.57079632679", "0.1"] {
        let summary = about_start(&pendulum_at(angle));
        assert!(summary.contains("not an equilibrium"), "{angle}: {summary}");
    }
}

const WINDMILL: &str = r#"
title = "Wheel in the wind"
[bodies.ground]
points = { A = [0, 0] }
[bodies.wheel]
points = { A = [0, 0] }
inertia = 0.02
center = "A"
mass = 1.0
[joints]
A = { revolute = ["ground.A", "wheel.A"] }
[actuators.phi]
angle = ["ground", "wheel"]
[loads]
push = { torque = "wheel", magnitude = "1.5 + 0.9*sin(phi)" }
drag = { torque = "wheel", magnitude = "-0.002*phi.velocity^2" }
"#;

/// E = ½Jω² of the wheel follows a linear equation over φ, whose periodic solution is
/// E = JM/2c + A (β sin φ − cos φ)/(1 + β²), β = 2c/J. What is printed agrees with it to the last digit.
#[test]
fn no_digit_of_a_cycle_is_wrong() {
    let (inertia, push, sway, drag) = (0.02, 1.5, 0.9, 0.002);
    let beta: f64 = 2.0 * drag / inertia;
    let energy = |phi: f64| {
        inertia * push / (2.0 * drag) + sway * (beta * phi.sin() - phi.cos()) / (1.0 + beta * beta)
    };
    let speed = |phi: f64| (2.0 * energy(phi) / inertia).sqrt();
    let points = 4096;
    let slowness = |k: i32| 1.0 / speed(TAU * f64::from(k) / f64::from(points));
    let mean = f64::from(points) / (0..points).map(slowness).sum::<f64>();
    let fastest_at = std::f64::consts::PI - beta.atan();
    let exact = [
        ("mean speed ", mean),
        ("slowest ", speed(fastest_at + 0.5 * TAU)),
        ("fastest ", speed(fastest_at)),
        (
            "coefficient of fluctuation ",
            (speed(fastest_at) - speed(fastest_at + 0.5 * TAU)) / mean,
        ),
        ("multipliers): ", (-TAU * beta).exp()),
        ("work of push per cycle ", push * TAU),
        ("work of drag per cycle ", -push * TAU),
    ];
    for (method, rtol) in [
        (Method::Bdf, 1e-6),
        (Method::Bdf, 1e-7),
        (Method::Bdf, 1e-10),
        (Method::TrBdf2, 1e-6),
        (Method::Tsit45, 1e-8),
        (Method::Dop853, 1e-6),
    ] {
        let settings = SolverSettings {
            method,
            rtol,
            atol: rtol,
            ..SolverSettings::default()
        };
        let outcome = cycle(&scene(WINDMILL), &settings, None).unwrap();
        assert!(outcome.summary.contains("estimated errors: "));
        for (name, exact) in exact {
            let (_, rest) = outcome.summary.split_once(name).unwrap();
            let printed = rest.split([' ', '\n']).next().unwrap();
            let decimals = printed.split_once('.').map_or(0, |(_, after)| after.len());
            let unit = 10_f64.powi(-i32::try_from(decimals).unwrap());
            let error = (printed.parse::<f64>().unwrap() - exact).abs();
            assert!(
                error <= unit,
                "{method:?} {rtol:e}: {name}{printed}, not {exact}"
            );
        }
    }
}

/// A constant torque gains 2π times itself in every cycle, at any speed: the speed that Newton's method settles on at last,
/// hundreds of thousands of rad/s, is rounding.
#[test]
fn a_machine_that_gains_energy_in_each_cycle_has_no_steady_one() {
    let rolling = WINDMILL.replace("-0.002*phi.velocity^2", "-0.5");
    for method in [
        Method::Bdf,
        Method::Esdirk34,
        Method::Tsit45,
        Method::Dop853,
    ] {
        for rtol in [1e-6, 1e-8, 1e-10] {
            let settings = SolverSettings {
                method,
                rtol,
                atol: rtol,
                ..SolverSettings::default()
            };
            let found = dwell_study::cycle(&scene(&rolling), &settings, None).unwrap();
            let reason = found.early_stop.unwrap().to_string();
            assert!(reason.contains("gains 6.28 J per cycle"), "{reason}");
            assert!(found.outcome.files.is_empty());
        }
    }
}

/// Without a drive, a damper stops the wheel after ω J/c, and a steady cycle is not what it has.
#[test]
fn a_machine_that_stops_has_no_steady_cycle() {
    let still = WINDMILL
        .replace("\"1.5 + 0.9*sin(phi)\"", "0")
        .replace("-0.002*phi.velocity^2", "-0.03*phi.velocity")
        + "[motion]\ninitial-velocity = 3\nduration = 1\n";
    for method in [Method::Bdf, Method::Tsit45, Method::Dop853] {
        let settings = SolverSettings {
            method,
            ..SolverSettings::default()
        };
        let found = dwell_study::cycle(&scene(&still), &settings, None).unwrap();
        let reason = found.early_stop.unwrap().to_string();
        assert!(reason.contains("comes to rest at `phi` = 2"), "{reason}");
    }
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

/// Speeds and positions are printed in the unit of the scene.
#[test]
fn a_cycle_speaks_in_the_scene_s_units() {
    let uneven = MOTOR.replace("magnitude = -1.5", "magnitude = \"-1.5 - sin(phi)\"");
    let printed = |scene: &str| {
        let scene = self::scene(scene);
        cycle(&scene, &SolverSettings::default(), None)
            .unwrap()
            .summary
    };
    let plain = printed(&uneven);
    let degrees = printed(&uneven.replace(
        "[bodies.ground]",
        "[units]\nangle = \"deg\"\n[bodies.ground]",
    ));
    let slowest = |text: &str, before: &str| -> f64 {
        let line = text.lines().find(|line| line.contains("slowest ")).unwrap();
        let number = line.split(before).nth(1).unwrap().trim_start();
        number.split(' ').next().unwrap().parse().unwrap()
    };
    for before in ["slowest ", "phi = "] {
        let [radians, degrees] = [&plain, &degrees].map(|text| slowest(text, before));
        assert_near(degrees, radians.to_degrees(), 1e-6 * degrees.abs());
    }
    assert!(
        degrees.contains(" deg/s (") && degrees.contains(" rad)"),
        "{degrees}"
    );
    assert!(
        plain.contains(" rad/s (") && plain.contains("°)"),
        "{plain}"
    );
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
