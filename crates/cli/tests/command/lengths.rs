//! `reduce` and `calibrate` where a length is driven, and where there are loads: against closed forms.

use crate::test_dir::TestDir;
use serde_json::Value;
use std::f64::consts::{PI, TAU};
use std::fs;

/// A block of 2 kg on a guide, held by a spring of 200 N/m and moving at 1 m/s where the spring is free.
const BLOCK: &str = r#"
title = "Block on a spring"
[bodies.ground]
points = { A = [0, 0], W = [-1, 0] }
[bodies.block]
points = { A = [0, 0] }
mass = 2.0
center = [0, 0]
inertia = 0.1
[joints]
guide = { prismatic = ["ground.A", "block.A"], axis = [1, 0] }
[actuators]
s = { length = "guide" }
[assembly]
s = 0
block = 0
[loads]
spring = { spring = ["ground.W", "block.A"], stiffness = 200, free-length = 1 }
[motion]
initial-coordinate = { s = 0 }
initial-velocity = 1
periods = 1
"#;

/// A rod of moment of inertia 3 kg m² about its pin, turned by the length between its end and a point of the ground, both
/// 1 m from the pin.
const CYLINDER: &str = r#"
title = "Rod and cylinder"
[bodies.ground]
points = { O = [0, 0], Q = [1, 0] }
[bodies.rod]
points = { O = [0, 0], P = [1, 0] }
inertia = 3.0
[joints]
O = { revolute = ["ground.O", "rod.O"] }
[actuators]
s = { length = ["ground.Q", "rod.P"] }
[assembly]
s = 1.0
rod = 1.0
"#;

fn results(dir: &TestDir, path: &str) -> Value {
    let text = fs::read_to_string(dir.0.join(path)).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()["results"].clone()
}

/// The period is 2π √(M/k).
#[test]
fn a_block_on_a_spring_is_calibrated_to_its_closed_form() {
    let dir = TestDir::new();
    dir.put("block.toml", BLOCK);
    let period = TAU * (2.5_f64 / 200.0).sqrt();
    let period = format!("{period:?}");
    let run = dir.run(&[
        "calibrate",
        "block.toml",
        "--parameter",
        "block.mass",
        "--period",
        &period,
    ]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let found = results(&dir, "reports/block-calibrate.json");
    let value = |name: &str| found[name]["value"].as_f64().unwrap();
    assert!((value("block.mass") - 2.5).abs() < 1e-10, "{found}");
    assert!((value("scene.period") - TAU * 0.1).abs() < 1e-11, "{found}");
}

/// A pendulum that starts at its lowest point with ω: its period is 4 K(k)/√(m g l/J) with k = ω/2 √(J/(m g l)).
#[test]
fn a_pendulum_under_its_weight_is_calibrated_to_the_elliptic_integral() {
    let dir = TestDir::new();
    let scene = "[bodies.ground]\npoints = { O = [0, 0] }\n[bodies.bar]\npoints = { O = [0, 0] }\nmass = 2\ncenter = [0.5, 0]\n\
                 inertia = 0.3\n[joints]\nO = { revolute = [\"ground.O\", \"bar.O\"] }\n[actuators]\nphi = { angle = [\"ground\", \"bar\"] }\n\
                 [loads]\nweight = { gravity = [0, -9.81] }\n[motion]\ninitial-coordinate = { phi = -1.5707963267948966 }\n\
                 initial-velocity = 3\nperiods = 1\n";
    dir.put("pendulum.toml", scene);
    // By the arithmetic–geometric mean: K(k) = π / (2 agm(1, √(1 − k²))).
    let period = |inertia: f64| {
        let natural = (2.0 * 9.81 * 0.5 / (inertia + 2.0 * 0.25)).sqrt();
        let k = 3.0 / (2.0 * natural);
        let (mut a, mut g) = (1.0, (1.0_f64 - k * k).sqrt());
        for _ in 0..10 {
            (a, g) = (0.5 * (a + g), (a * g).sqrt());
        }
        4.0 * PI / (2.0 * a) / natural
    };
    let wanted = format!("{:?}", period(0.35));
    let run = dir.run(&[
        "calibrate",
        "pendulum.toml",
        "--parameter",
        "bar.inertia",
        "--period",
        &wanted,
    ]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let found = results(&dir, "reports/pendulum-calibrate.json");
    let value = |name: &str| found[name]["value"].as_f64().unwrap();
    assert!((value("bar.inertia") - 0.35).abs() < 1e-10, "{found}");
    assert!(
        (value("scene.period") - period(0.3)).abs() < 1e-11,
        "{found}"
    );
}

/// m = J / (1 − s²/4) and ½m′ = J s/4 / (1 − s²/4)², with s = 2 sin(θ/2).
#[test]
fn the_reduced_mass_of_a_driven_length_is_its_closed_form() {
    let dir = TestDir::new();
    dir.put("cylinder.toml", CYLINDER);
    let run = dir.run(&["reduce", "cylinder.toml", "--pictures", "all"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert!(
        run.out.contains(" kg\n") && run.out.contains(" kg/m\n"),
        "{}",
        run.out
    );
    let text = fs::read_to_string(dir.0.join("reports/cylinder-reduced.csv")).unwrap();
    let mut lines = text.lines();
    let head = lines.next().unwrap();
    assert!(head.starts_with("s [m],m [kg],half_dm [kg/m],"), "{head}");
    assert!(head.contains("O.x.a [kg],O.x.b [kg/m]"), "{head}");
    let mut count = 0;
    for line in lines {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let (s, left) = (cells[0], 1.0 - cells[0] * cells[0] / 4.0);
        // Towards the ends, where 1 − s²/4 is small, a rounding of s is a larger part of it.
        let tolerance = 1e-13 / left;
        let m = 3.0 / left;
        assert!((cells[1] - m).abs() <= tolerance * m, "{line}");
        let half_dm = 3.0 * s / 4.0 / (left * left);
        assert!(
            (cells[2] - half_dm).abs() <= 4.0 * tolerance * half_dm.max(1.0),
            "{line}"
        );
        count += 1;
    }
    assert_eq!(count, 721);
    // A table of a length is refused by name.
    let run = dir.run(&["reduce", "cylinder.toml", "--table-accuracy", "1e-9"]);
    assert_eq!(run.status, Some(2));
    assert!(run.err.contains("drives a length"), "{}", run.err);
}

/// What has no period is refused by name.
#[test]
fn calibration_of_what_has_no_period_names_the_reason() {
    let dir = TestDir::new();
    let damped = BLOCK.replace(
        "[motion]",
        "damper = { damper = [\"ground.W\", \"block.A\"], damping = 3 }\n[motion]",
    );
    dir.put("damped.toml", damped);
    let driven = BLOCK.replace(
        "[motion]",
        "[drives]\npush = { applied-force = \"s\", magnitude = 3 }\n[motion]",
    );
    dir.put("driven.toml", driven);
    for (name, reason) in [("damped", "damper"), ("driven", "push")] {
        let scene = format!("{name}.toml");
        let run = dir.run(&[
            "calibrate",
            &scene,
            "--parameter",
            "block.mass",
            "--period",
            "1",
        ]);
        assert_eq!(run.status, Some(2), "{run:?}");
        assert!(run.err.contains(reason), "{}", run.err);
    }
}
