//! No digit is printed beyond the estimated error, and rounding is reported as rounding.

use crate::table::{PENDULUM, scene};
use dwell_dynamics::Method;
use dwell_study::{
    OperatingPoint, SolverSettings, compute_sweep, equilibria, linearise, no_progress, simulate,
    simulate_to_accuracy,
};
use std::f64::consts::FRAC_PI_2;

fn moving(start: f64, duration: f64, more: &str) -> String {
    format!(
        "{PENDULUM}[motion]\ninitial-coordinate = {start}\ninitial-velocity = 0\nduration = {duration}\n{more}"
    )
}

fn at_tolerance(tolerance: f64) -> SolverSettings {
    SolverSettings {
        method: Method::Bdf,
        rtol: tolerance,
        atol: tolerance,
        ..SolverSettings::default()
    }
}

/// A printed number, and what one of its last digit is worth.
fn printed(text: &str) -> (f64, f64) {
    let (mantissa, power) = text.split_once('e').unwrap_or((text, "0"));
    let decimals = mantissa
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    let unit = 10_f64.powi(power.parse::<i32>().unwrap() - decimals as i32);
    (text.parse().unwrap(), unit)
}

/// The text between two others.
fn between<'a>(text: &'a str, before: &str, after: &str) -> &'a str {
    let (_, rest) = text
        .split_once(before)
        .unwrap_or_else(|| panic!("{before}: {text}"));
    rest.split_once(after)
        .unwrap_or_else(|| panic!("{after}: {rest}"))
        .0
}

/// The half period of a pendulum by quadrature has 13 digits, and integrations as many as their error leaves.
#[test]
fn the_time_of_an_event_has_the_digits_of_its_error() {
    let scene = scene(&moving(-0.3, 5.0, "events.back = { reverses = \"phi\" }\n"));
    let first = |summary: &str| {
        let (time, unit) = printed(between(summary, "first at t = ", " s"));
        let error: f64 = between(summary, " s (estimated error ", " s)")
            .parse()
            .unwrap();
        (time, unit, error)
    };
    let exact = simulate_to_accuracy(&scene, 1e-10, None, &|_| {}).unwrap();
    let (exact, _, error) = first(&exact.outcome.summary);
    assert!(error < 1e-13, "{error}");
    for tolerance in [1e-4, 1e-7, 1e-10] {
        let found = simulate(&scene, &at_tolerance(tolerance), &|_| {}).unwrap();
        let (time, unit, error) = first(&found.outcome.summary);
        println!("{tolerance:e}: {time} {unit:e} {error:e}, exact {exact}");
        assert!(
            (time - exact).abs() <= error + unit,
            "{time} {exact} {error}"
        );
        assert!(unit >= error || error < 1e-12, "{unit} {error}");
    }
}

/// The largest forces of a coarse run have no digits that a fine run contradicts.
#[test]
fn the_largest_values_of_a_motion_have_the_digits_of_their_errors() {
    let scene = scene(&moving(-0.3, 5.0, ""));
    let largest = |tolerance: f64| -> Vec<(String, f64, f64)> {
        let found = simulate(&scene, &at_tolerance(tolerance), &|_| {}).unwrap();
        let summary = found.outcome.summary;
        let lines = summary.lines().filter(|line| line.contains(" reaches "));
        let parsed = lines.map(|line| {
            let (name, rest) = line.split_once(" reaches ").unwrap();
            let (value, unit) = printed(rest.split_once(' ').unwrap().0);
            (name.to_owned(), value, unit)
        });
        parsed.collect()
    };
    let fine = largest(1e-11);
    let coarse = largest(1e-6);
    assert!(coarse.len() > 1, "{coarse:?}");
    for (name, value, unit) in &coarse {
        let Some((_, exact, fine_unit)) = fine.iter().find(|(other, ..)| other == name) else {
            continue;
        };
        // The error, and the rounding of what is printed.
        let wrong = (value.abs() - exact.abs()).abs();
        assert!(wrong <= 1.5 * unit, "{name}: {value} {exact}");
        // Six digits would be too many, and one too few.
        assert!(
            unit > fine_unit && *unit < 0.1 * exact.abs(),
            "{name}: {value} {exact}"
        );
    }
}

/// A pendulum that hangs as exactly as numbers allow stays at rest, although its forces are not zero; one that stands so
/// leaves its place when rounding decides, which is no result.
#[test]
fn rest_is_rest_within_rounding() {
    let summary = |start: f64, duration: f64| {
        let scene = scene(&moving(start, duration, ""));
        let found = simulate(&scene, &SolverSettings::default(), &|_| {}).unwrap();
        (
            found.outcome.summary,
            found.early_stop.map(|e| e.to_string()),
        )
    };
    let (hanging, stop) = summary(-FRAC_PI_2, 10.0);
    assert!(
        hanging.contains("stays at rest within rounding"),
        "{hanging}"
    );
    assert!(
        !hanging.contains("unstable") && stop.is_none(),
        "{hanging} {stop:?}"
    );
    let (standing, stop) = summary(FRAC_PI_2, 0.2);
    assert!(
        standing.contains("stays at rest within rounding"),
        "{standing}"
    );
    assert!(
        standing.contains("starts in an unstable equilibrium"),
        "{standing}"
    );
    assert!(stop.is_none(), "{stop:?}");
    // An implicit method may stay for ever; an explicit one multiplies the rounding.
    let upright = scene(&moving(FRAC_PI_2, 30.0, ""));
    let settings = SolverSettings {
        method: Method::Dop853,
        ..SolverSettings::default()
    };
    let found = simulate(&upright, &settings, &|_| {}).unwrap();
    let (fallen, stop) = (
        found.outcome.summary,
        found.early_stop.map(|e| e.to_string()),
    );
    assert!(!fallen.contains("stays at rest"), "{fallen}");
    let stop = stop.unwrap();
    assert!(stop.contains("starts in an unstable equilibrium"), "{stop}");
    let pushed = PENDULUM.split("weight").next().unwrap();
    let pushed = format!("{pushed}push = {{ torque = \"bar\", magnitude = 3 }}\n");
    let none = equilibria(&scene(&pushed)).unwrap().summary;
    assert!(
        none.contains("the static force along phi is 3 N m everywhere"),
        "{none}"
    );
    // A millionth of a radian is a release, and no rounding.
    let (released, stop) = summary(-FRAC_PI_2 + 1e-6, 1.0);
    assert!(
        !released.contains("at rest") && stop.is_none(),
        "{released}"
    );
}

const WHEEL: &str = r#"
[bodies.ground]
points = { A = [0, 0] }
[bodies.arm]
points = { A = [0, 0], B = [0.6, 0] }
mass = 1.3
center = [0.35, 0]
inertia = 0.05
[bodies.wheel]
points = { B = [0, 0] }
mass = 0.8
center = "B"
inertia = 0.02
[joints]
A = { revolute = ["ground.A", "arm.A"] }
B = { revolute = ["arm.B", "wheel.B"] }
[actuators]
p = { angle = ["ground", "arm"] }
q = { angle = ["ground", "wheel"] }
[assembly]
p = -1.0
q = -0.5
[loads]
weight = { gravity = [0, -9.81] }
"#;

/// Of two freedoms all equilibria are listed, a neutral direction is named, and its eigenvalues are zero.
#[test]
fn equilibria_of_two_freedoms_are_listed_with_their_neutral_directions() {
    let double = WHEEL.replace("center = \"B\"", "center = [0.25, 0]");
    let found = equilibria(&scene(&double)).unwrap().summary;
    assert!(
        found.contains("4 equilibria of 2 free coordinates found from 400 starts"),
        "{found}"
    );
    assert!(found.matches(": unstable").count() == 3, "{found}");
    assert!(found.contains("stable without damping"), "{found}");
    assert!(found.matches("estimated errors: ").count() == 4, "{found}");

    let wheel = equilibria(&scene(WHEEL)).unwrap();
    let text = &wheel.summary;
    assert!(text.contains("2 equilibria"), "{text}");
    assert!(text.matches("neutral direction q: ").count() == 2, "{text}");
    assert!(text.contains("eigenvalue 0 1/s"), "{text}");
    let table = wheel
        .files
        .iter()
        .find(|(path, _)| path.to_string_lossy().ends_with(".csv"));
    let table = String::from_utf8(table.unwrap().1.to_vec()).unwrap();
    assert!(
        table
            .lines()
            .next()
            .unwrap()
            .ends_with(",neutral_directions"),
        "{table}"
    );

    // Linearised about the equilibrium nearest to the start, the wheel stays where it is.
    let linear = linearise(&scene(WHEEL), OperatingPoint::Equilibrium).unwrap();
    assert!(
        linear.summary.contains("q = -0.5 rad"),
        "{}",
        linear.summary
    );
}

/// Without any force every position is an equilibrium: it is said once, at the start.
#[test]
fn without_a_force_every_position_is_an_equilibrium() {
    let free = PENDULUM.split("[loads]").next().unwrap();
    let text = format!("{free}[assembly]\nphi = 0.7\n");
    let found = equilibria(&scene(&text)).unwrap().summary;
    assert!(found.contains("1 equilibrium of phi"), "{found}");
    assert!(
        found.contains("phi = 0.7 rad") && found.contains(": neutral\n"),
        "{found}"
    );
    assert!(
        found.contains("neutral: every position of phi between"),
        "{found}"
    );
}

/// The eigenvalues about the start state their error, too; those of a free wheel are zero, and printed so.
#[test]
fn eigenvalues_about_the_start_state_their_error() {
    let linear = linearise(&scene(WHEEL), OperatingPoint::InitialState).unwrap();
    let summary = linear.summary;
    assert!(
        summary.matches("    eigenvalue 0 1/s\n").count() == 2,
        "{summary}"
    );
    let error: f64 = between(&summary, "    estimated error: ", " 1/s")
        .parse()
        .unwrap();
    // The double zero of the wheel is known to a root of a rounding.
    assert!(error > 1e-10 && error < 1e-5, "{summary}");
    let tilted = format!("{PENDULUM}[assembly]\nphi = -1.0\n");
    let pendulum = linearise(&scene(&tilted), OperatingPoint::InitialState).unwrap();
    let error: f64 = between(&pendulum.summary, "    estimated error: ", " 1/s")
        .parse()
        .unwrap();
    assert!(error < 1e-9, "{}", pendulum.summary);
}

/// The moment that holds a bar is largest where its centre of mass is level with the pin, half a degree beside a position of
/// the sweep: m g r there, 4e-5 less at the position.
#[test]
fn the_peaks_of_a_sweep_are_those_between_its_positions() {
    let offset = 0.3 * 0.5_f64.to_radians().tan();
    let text = PENDULUM.replace("center = [0.3, 0]", &format!("center = [0.3, {offset}]"));
    let vary = ["bar.inertia=0.05,0.06".to_owned()];
    let requests = ["phi.actuator_force".to_owned()];
    let found = compute_sweep(&scene(&text), &vary, None, 0, &requests, &no_progress).unwrap();
    let expected = 2.0 * 9.81 * 0.3_f64.hypot(offset);
    for row in &found.table.rows {
        assert!(
            (row[1] / expected - 1.0).abs() < 1e-12,
            "{row:?} {expected}"
        );
    }
}
