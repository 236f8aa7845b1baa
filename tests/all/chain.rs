//! IFToMM's A02: a chain of N equal four-bars, which its parallel links make a pendulum. All its
//! reactions have a closed form, and what a pose costs is counted in operations: it grows as N.

use dwell_tests::chain::counting_scalar::operations;
use dwell_tests::chain::links::{GRAVITY, closed_form, errors, model};
use std::f64::consts::PI;

#[test]
fn the_hand_agrees_with_the_pendulum() {
    // A pendulum of m = (4 N + 1)/3 in the potential (3 N + 1)/2 g sin θ.
    for n in [1, 2, 40] {
        for state in [[0.7, 1.1, -0.4], [2.0, -3.0, 5.0]] {
            let (torque, forces) = closed_form(n, state);
            let links = n as f64;
            let m = (4.0 * links + 1.0) / 3.0;
            let weight = 0.5 * (3.0 * links + 1.0) * GRAVITY * state[0].cos();
            let want = m * state[2] + weight;
            // The recursion's sums are of the size of the forces, and there are N of them.
            let scale = forces.iter().fold(0.0_f64, |s, f| s.max(f.norm()));
            assert!((torque - want).abs() < 1e-14 * scale, "{torque} {want}");
            assert_eq!(forces.len(), 3 * n + 1);
        }
    }
}

#[test]
fn all_reactions_are_those_by_hand() {
    for n in [1, 2, 5, 40, 200] {
        let model = model(n);
        for part in 0..=16 {
            // sin θ is 0.5 and more.
            let theta = PI / 6.0 + f64::from(part) / 16.0 * (2.0 * PI / 3.0);
            for (omega, alpha) in [(0.0, 0.0), (1.3, 0.0), (-0.7, 2.0)] {
                let [torque, force] = errors(&model, n, [theta, omega, alpha]);
                // Both sides add N terms, each rounded: 4e-14 for 200; 3e-14 were met.
                assert!(torque < 1e-12, "{n} {theta} {torque:e}");
                assert!(force < 1e-12, "{n} {theta} {force:e}");
            }
        }
    }
}

#[test]
fn a_pose_costs_in_proportion_to_its_size() {
    let one = operations(&model(1));
    let each = operations(&model(2)) - one;
    // What a loop costs is no law of nature; that it has not doubled unseen is asserted here.
    assert_eq!((one, each), (227, 192));
    for n in [10, 100, 1000, 10000] {
        let counted = operations(&model(n));
        assert_eq!(counted, one + (n as u64 - 1) * each, "{n}");
    }
}
