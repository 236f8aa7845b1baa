//! Motions by quadrature: long ones, and their events.

use crate::table::{PENDULUM, scene};
use dwell_study::{SolverSettings, check, simulate, simulate_to_accuracy};

/// A million seconds at 1000 rad/s are 159 million turns: as many rows as in a second, and φ = 1000 t.
#[test]
fn a_long_motion_is_sampled_to_its_end() {
    let free = PENDULUM.split("[loads]").next().unwrap();
    let spun = format!("{free}[motion]\ninitial-velocity = 1000\nduration = 1e6\n");
    let found = simulate_to_accuracy(&scene(&spun), 1e-3, None, &|_| {}).unwrap();
    assert!(found.early_stop.is_none(), "{:?}", found.early_stop);
    let files = &found.outcome.files;
    let (_, csv) = files
        .iter()
        .find(|(path, _)| path.to_string_lossy().ends_with("-motion.csv"))
        .unwrap();
    let csv = std::str::from_utf8(csv).unwrap();
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let [t, phi] =
        ["t [s]", "phi [rad]"].map(|name| header.iter().position(|h| *h == name).unwrap());
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|v| v.parse().unwrap_or(0.0)).collect())
        .collect();
    assert_eq!((rows.len(), rows[1000][t]), (1001, 1e6));
    for row in rows {
        assert!((row[phi] - 1000.0 * row[t]).abs() < 1e-5, "{row:?}");
    }
}

/// A pendulum released at rest reverses first on the other side, half a period later, by every method.
#[test]
fn a_release_is_no_reversal() {
    let count = |summary: &str| -> (usize, f64) {
        let (_, rest) = summary.split_once("  back: ").unwrap();
        let (often, rest) = rest.split_once(", first at t = ").unwrap();
        let (first, _) = rest.split_once(" s").unwrap();
        let often = match often {
            "once" => 1,
            "twice" => 2,
            often => often.strip_suffix(" times").unwrap().parse().unwrap(),
        };
        (often, first.parse().unwrap())
    };
    for stop in ["", ", stop = true"] {
        let text = format!(
            "{PENDULUM}[motion]\ninitial-coordinate = -0.3\nduration = 5\nevents.back = {{ reverses = \"phi\"{stop} }}\n"
        );
        let scene = scene(&text);
        let integrated = simulate(&scene, &SolverSettings::default(), &|_| {}).unwrap();
        let integrated = count(&integrated.outcome.summary);
        let orbit = simulate_to_accuracy(&scene, 1e-6, None, &|_| {}).unwrap();
        let orbit = count(&orbit.outcome.summary);
        assert_eq!(orbit.0, integrated.0, "{stop}");
        assert!(
            (orbit.1 - integrated.1).abs() < 1e-6,
            "{orbit:?} {integrated:?}"
        );
        assert!(orbit.1 > 0.5, "{orbit:?}");
    }
}

/// The nearest assembly mode may still be far from what was meant.
#[test]
fn a_mode_far_from_the_approximate_angles_is_named() {
    let four_bar = |coupler: f64| {
        let text = format!(
            r#"
[bodies.ground]
points = {{ A = [0, 0], D = [1, 0] }}
[bodies.crank]
points = {{ A = [0, 0], B = [0.3, 0] }}
mass = 1
inertia = 0.01
center = "A"
[bodies.coupler]
points = {{ B = [0, 0], C = [0.9, 0] }}
mass = 1
inertia = 0.01
center = "B"
[bodies.rocker]
points = {{ D = [0, 0], C = [0.6, 0] }}
mass = 1
inertia = 0.01
center = "D"
[joints]
A = {{ revolute = ["ground.A", "crank.A"] }}
B = {{ revolute = ["crank.B", "coupler.B"] }}
C = {{ revolute = ["coupler.C", "rocker.C"] }}
D = {{ revolute = ["ground.D", "rocker.D"] }}
[actuators.phi]
angle = ["ground", "crank"]
[assembly]
phi = 1.0
coupler = {coupler}
rocker = 1.5
"#
        );
        check(&scene(&text)).unwrap().summary
    };
    let far = four_bar(-0.1);
    let words = "coupler is at 22.7°, far from the approximate -5.73°";
    assert!(far.contains(words), "{far}");
    assert!(!four_bar(0.3).contains("far from"));
}
