//! Structures, which have no actuator and do not move.

use crate::table::scene;
use dwell_study::{Analysis, analyse_trajectory, check, no_progress};

/// Two bars of 0.4 m between supports 0.48 m apart: the apex is above the middle, and each bar rises by arccos(0.24/0.4).
const TWO_BARS: &str = r#"
title = "Two bars"
[bodies]
ground = { points = { A = [0, 0], D = [0.48, 0] } }
left = { points = { A = [0, 0], B = [0.4, 0] } }
right = { points = { D = [0, 0], B = [0.4, 0] } }
[joints]
A = { revolute = ["ground.A", "left.A"] }
D = { revolute = ["ground.D", "right.D"] }
B = { revolute = ["left.B", "right.B"] }
[assembly]
left = 0.8
right = 2.2
"#;

/// A coupler on three parallel cranks, which are fixed by nothing.
const THREE_CRANKS: &str = r#"
title = "Parallelogram on three cranks"
[bodies]
ground = { points = { A = [0, 0], D = [0.5, 0], E = [0.9, 0.1] } }
first = { points = { A = [0, 0], B = [0.2, 0] } }
second = { points = { D = [0, 0], C = [0.2, 0] } }
third = { points = { E = [0, 0], F = [0.2, 0] } }
coupler = { points = { B = [0, 0], C = [0.5, 0], F = [0.9, 0.1] } }
[joints]
A = { revolute = ["ground.A", "first.A"] }
D = { revolute = ["ground.D", "second.D"] }
E = { revolute = ["ground.E", "third.E"] }
B = { revolute = ["first.B", "coupler.B"] }
C = { revolute = ["coupler.C", "second.C"] }
F = { revolute = ["coupler.F", "third.F"] }
"#;

/// The angle (rad) of a body that `check` prints.
fn angle(summary: &str, body: &str) -> f64 {
    let mut words = summary.lines().map(str::split_whitespace);
    let row = words.find_map(|mut row| (row.next() == Some(body)).then(|| row.next()));
    row.flatten().unwrap().parse().unwrap()
}

#[test]
fn a_structure_is_described_at_its_only_position() {
    let summary = check(&scene(TWO_BARS)).unwrap().summary;
    let first =
        "2 moving bodies, 3 joints, 0 degrees of freedom: a structure, in which nothing moves";
    assert!(summary.contains(first), "{summary}");
    let rise = f64::acos(0.24 / 0.4);
    assert!((angle(&summary, "left") - rise).abs() < 1e-6, "{summary}");
    let other = std::f64::consts::PI - rise;
    assert!((angle(&summary, "right") - other).abs() < 1e-6, "{summary}");
    assert!(!summary.contains("several actuators"), "{summary}");
}

/// What follows a motion says that there is none.
#[test]
fn a_structure_has_no_motion() {
    for analysis in [
        Analysis::Kinematics,
        Analysis::Statics,
        Analysis::Kinetostatics,
    ] {
        let refused = analyse_trajectory(&scene(TWO_BARS), analysis, None, &no_progress);
        let text = refused.err().unwrap().to_string();
        assert!(text.contains("no actuators, so nothing moves"), "{text}");
    }
}

/// Fixed by nothing, by counting it has no freedom: as a structure it can be put together in two ways.
#[test]
fn the_assembly_modes_of_a_structure_are_named() {
    let refused = check(&scene(THREE_CRANKS)).unwrap_err().to_string();
    assert!(refused.contains("have 2 assembly modes"), "{refused}");
}
