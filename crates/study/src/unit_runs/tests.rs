//! The combined runs compared with the reduced model, and with a hand calculation.

use super::compute::{compute_unit_runs, values};
use crate::no_progress;
use dwell_scene::PlaneScene;
use std::path::Path;

fn case(name: &str) -> PlaneScene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    PlaneScene::read(folder.join(name).join("scene.toml")).expect("a scene")
}

#[test]
fn run_ii_is_uniformly_accelerated_and_passes_the_positions_of_run_i() {
    let scene = case("single-dwell");
    let runs = compute_unit_runs(&scene, Some(73), &no_progress).expect("runs");
    let [q, speed, acceleration] = ["phi", "phi.velocity", "phi.acceleration"]
        .map(|name| [0, 1].map(|run| values(&runs.runs[run], name)));
    for k in 0..73 {
        assert_eq!((speed[0][k], acceleration[0][k]), (1.0, 0.0));
        assert_eq!(acceleration[1][k], 1.0);
        // q̇² = 2 q of a uniform acceleration from rest at q = 0.
        assert!((speed[1][k].powi(2) - 2.0 * q[1][k]).abs() < 1e-14);
        // Half the square of a root: some roundings.
        assert!((q[0][k] - q[1][k]).abs() <= 8.0 * f64::EPSILON * q[0][k]);
    }
}

#[test]
fn the_combined_runs_are_the_reduced_model() {
    for name in [
        "single-dwell",
        "slider-crank",
        "watt-six-bar",
        "class-three-six-bar",
        "planetary",
        "jansen",
    ] {
        let scene = case(name);
        let runs = compute_unit_runs(&scene, None, &no_progress).expect("runs");
        let comparison = runs.comparison();
        let tolerances = comparison.iter().map(|of| of.tolerance);
        let plain = tolerances.fold(f64::INFINITY, f64::min);
        for coefficient in comparison {
            // Where run ii is fast, its forces are this many times the part of the acceleration: 875 for the class-three group.
            let lost = coefficient.tolerance / plain;
            let difference = coefficient.relative_difference;
            assert!(
                difference < 1e-13 + 1e-14 * lost,
                "{name}: {} {difference:e}",
                coefficient.symbol
            );
        }
    }
}

#[test]
fn loads_and_a_scene_s_own_motion_do_not_change_the_runs() {
    let scene = case("slider-crank");
    let runs = compute_unit_runs(&scene, Some(19), &no_progress).expect("runs");
    let mut bare = scene.clone();
    bare.loads.clear();
    bare.prescribed = None;
    let other = compute_unit_runs(&bare, Some(19), &no_progress).expect("runs");
    assert_eq!(runs.runs, other.runs);
}
