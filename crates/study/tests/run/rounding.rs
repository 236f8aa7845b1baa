//! Rounding errors that trajectories state.

use crate::table::{analyse, case, file, scene};
use dwell_study::Analysis;

/// `kinematics` states the rounding of positions, velocities and accelerations, from 32-digit arithmetic: a few units in the
/// last place of a four-bar, and much more next to a jam of its loop.
#[test]
fn kinematics_states_its_rounding_error() {
    let stated = |name: &str| {
        let summary = analyse(&case(name), Analysis::Kinematics, 91)
            .outcome
            .summary;
        let line = summary
            .lines()
            .find(|line| line.contains("estimated rounding error"))
            .unwrap_or_else(|| panic!("{summary}"));
        let number = line.split("below ").nth(1).unwrap();
        number.split(' ').next().unwrap().parse::<f64>().unwrap()
    };
    for name in ["four-bar", "single-dwell", "jansen", "planetary"] {
        let error = stated(name);
        assert!((1e-16..=1e-12).contains(&error), "{name} {error}");
    }
}

/// A point far outside the mechanism is fast, and its acceleration is no rounding of its velocity.
#[test]
fn the_extrema_of_a_far_point_are_those_of_its_rows() {
    let ladder = r#"
title = "Double slider"
[bodies]
ground = { points = { O = [0, 0] } }
ladder = { points = { P = [-1, 0], Q = [1, 0], M = [0, 1e30] } }
[joints]
floor = { slot = ["ground.O", "ladder.P"], axis = [1, 0] }
wall = { slot = ["ground.O", "ladder.Q"], axis = [0, 1] }
[actuators]
phi = { angle = ["ground", "ladder"] }
[assembly]
phi = 2.0
[coordinate-sweep]
phi = [1.7, 3.0]
[requests]
paths = ["ladder.M"]
"#;
    let result = analyse(&scene(ladder), Analysis::Kinematics, 7);
    let extrema = file(&result, "extrema.csv");
    let row = extrema.lines().find(|row| row.starts_with("ladder.M.ax,"));
    let cells: Vec<&str> = row.unwrap().split(',').collect();
    // At unit speed the acceleration is the distance from the middle, towards it: 1e30 sin φ.
    for (cell, angle) in [(cells[2], 3.0_f64), (cells[4], 1.7)] {
        let (found, expected) = (cell.parse::<f64>().unwrap(), 1e30 * angle.sin());
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
}
