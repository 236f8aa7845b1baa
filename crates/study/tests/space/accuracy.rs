//! Motions in space to an accuracy, and at the end of the range.

use super::as_in_the_plane::column;
use super::scene;
use dwell_dynamics::Method;
use dwell_scene::SpaceScene;
use dwell_study::{
    FreeMotion, MotionSolver, PictureSpan, SolverSettings, compute_free_motion, no_progress,
    simulate_within,
};

fn computed(scene: &SpaceScene, solver: &MotionSolver) -> FreeMotion {
    let done = compute_free_motion(scene, solver, &no_progress);
    done.unwrap_or_else(|e| panic!("{e:?}"))
}

fn to_accuracy(accuracy: f64) -> MotionSolver {
    MotionSolver::Accuracy {
        accuracy,
        sample_interval: None,
    }
}

fn by_method(method: Method, rtol: f64) -> MotionSolver {
    MotionSolver::Settings(SolverSettings {
        method,
        rtol,
        atol: rtol,
        ..SolverSettings::default()
    })
}

/// A scene of `validation/spatial` that has a motion, for so long.
fn lasting(name: &str, from: &str, to: &str) -> SpaceScene {
    let path = format!(
        "{}/../../validation/spatial/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path)
        .expect("a scene")
        .replace(from, to);
    SpaceScene::parse(name, &text).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// The stiff governor goes by BDF, which takes a hundredth of the evaluations, the smooth one by DOP853; both keep what they promise,
/// compared with a method that was not chosen.
#[test]
fn what_is_stiff_in_space_goes_by_bdf() {
    let stiff = lasting("governor-a05", "duration = 10", "duration = 0.5");
    let smooth = scene(
        "governor",
        "\n[motion]\nduration = 0.5\ninitial-velocity = { q = 0, s = 6.283185307179586 }\n",
    );
    for (name, scene, accuracy, expected, reference) in [
        ("governor-a05", &stiff, 1e-6, "BDF", Method::Dop853),
        ("governor", &smooth, 1e-9, "DOP853", Method::Tsit45),
    ] {
        let found = computed(scene, &to_accuracy(accuracy));
        let method = &found.computed.trajectory.method_text;
        assert!(method.starts_with(expected), "{name}: {method}");
        let estimate = found.estimated_error.expect("an estimate");
        assert!(estimate <= accuracy, "{name}: {estimate:.1e}");
        assert!(found.computed.early_stop.is_none());
        let other = computed(scene, &by_method(reference, 1e-13));
        let actuators = scene.mechanism.actuators.iter();
        let off = actuators.map(|actuator| {
            let angle = |of: &FreeMotion| column(&of.computed.table, &actuator.name);
            let pairs = angle(&found).into_iter().zip(angle(&other));
            pairs.fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()))
        });
        let off = off.fold(0.0, f64::max);
        println!("{name} by {method}: {off:.1e} of {estimate:.1e}");
        assert!(off <= estimate, "{name}: {off:.1e} of {estimate:.1e}");
    }
}

/// What is said of it is what is said in the plane, with the numbers in the record.
#[test]
fn the_summary_says_how_the_accuracy_is_reached() {
    let scene = lasting("governor-a05", "duration = 10", "duration = 0.1");
    let span = PictureSpan::default();
    let done = simulate_within(&scene, &to_accuracy(1e-5), None, span, &no_progress);
    let outcome = done.unwrap_or_else(|e| panic!("{e:?}")).outcome;
    let text = &outcome.summary;
    for words in [
        "  accuracy 1e-5: BDF, tolerance ",
        " % of the steps of a coarse run are stiff; ",
        "  estimated errors over the whole motion: ",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let numbers = &outcome.record.numbers;
    for name in [
        "accuracy",
        "error.coordinates",
        "error.reactions",
        "tolerance",
    ] {
        assert!(numbers.iter().any(|number| number.name == name), "{name}");
    }
}

/// A screw has no end: by all methods the screw jack falls on by the closed form, far beyond the eight turns over which positions were once
/// sought, within some hundred steps.
#[test]
fn a_screw_turns_without_end() {
    let scene = scene(
        "screw-jack",
        "\n[motion]\nduration = 0.3\ninitial-velocity = 1.5\n",
    );
    // m q̈ = −F with the lead 6 mm: m = I + M h², F = M g h.
    let lead = 0.006 / std::f64::consts::TAU;
    let (m, force) = (4e-5 + 25.0 * lead * lead, 25.0 * 9.81 * lead);
    let (a, end) = (force / m, 0.3);
    let turned = 1.5 * end - 0.5 * a * end * end;
    assert!(turned < -20.0 * std::f64::consts::TAU, "{turned} rad");
    for method in Method::ALL {
        let solver = by_method(method, 1e-10);
        let done = computed(&scene, &solver);
        let name = method.name();
        let early = &done.computed.early_stop;
        assert!(early.is_none(), "{name}: {early:?}");
        let angle = column(&done.computed.table, "q");
        let reached = angle.last().copied().unwrap_or_default();
        let off = reached / turned - 1.0;
        println!("{name}: {off:.1e}");
        assert!(off.abs() < 2e-10, "{name}: {reached} is not {turned}");
    }
}
