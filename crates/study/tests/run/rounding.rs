//! Rounding errors that trajectories state.

use crate::table::{analyse, case};
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
            .find(|line| line.contains("estimated rounding error"));
        let line = line.unwrap_or_else(|| panic!("{summary}"));
        let number = line.split("below ").nth(1).unwrap();
        number.split(' ').next().unwrap().parse::<f64>().unwrap()
    };
    for name in ["four-bar", "single-dwell", "jansen", "planetary"] {
        let error = stated(name);
        assert!((1e-16..=1e-12).contains(&error), "{name} {error}");
    }
}
