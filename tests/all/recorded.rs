//! Reduced coefficients recorded as operations of the coordinate and of all numbers of a mechanism, against models that are compiled
//! for other numbers, and their gradients against differences of such models.

use super::variants::{variant, without_loads};
use dwell_kinetostatics::{CoefficientsRecordingError, Model, RecordedCoefficients};
use dwell_numerics::ReverseSweep;
use dwell_scene::PlaneScene;

/// Cases of one actuator: of dyads, guided points, constructions and groups solved by iterations.
const CASES: [&str; 9] = [
    "crank-rocker",
    "single-dwell",
    "slider-crank",
    "watt-six-bar",
    "whitworth",
    "slotted-rocker",
    "jansen",
    "scotch-yoke",
    "class-three-six-bar",
];
/// Largest relative change of the numbers from one mechanism to the next, and coordinates beside that of the assembly, rad or m by
/// the size of the mechanism.
const DEVIATION: f64 = 0.02;
const COORDINATES: [f64; 3] = [0.11, 0.17, 0.23];

/// The model of a scene for all its reactions.
fn model(scene: &PlaneScene) -> Model {
    let start = scene.assembly.to_configuration();
    let reactions = scene.mechanism.reactions();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &reactions);
    model.expect("a model")
}

/// The coordinates at which a scene is looked at.
fn coordinates(scene: &PlaneScene, model: &Model) -> [f64; 3] {
    let unit = model.plan().coordinate_unit();
    COORDINATES.map(|part| scene.assembly.to_configuration().q[0] + part * unit)
}

/// m, ½m′, all a and all b of a compiled model.
fn compiled(model: &Model, q: f64) -> Vec<f64> {
    let (mut workspace, mut out) = (model.workspace(), model.coefficient_buffer());
    model.reduce(q, &mut workspace, &mut out).expect("a pose");
    [vec![out.m, out.half_dm], out.a, out.b].concat()
}

/// A recording of a scene at a coordinate, in the model of another one.
fn recorded(model: &Model, scene: &PlaneScene, q: f64) -> RecordedCoefficients {
    let recorded = model.record_coefficients(&scene.mechanism, &scene.masses, &[q]);
    recorded.unwrap_or_else(|error| panic!("{}: {error:?}", scene.name))
}

#[test]
fn a_recording_at_other_numbers_is_the_model_compiled_for_them() {
    for case in CASES {
        let scene = without_loads(case);
        let [base, one, other] = [1, 2, 3].map(|k| variant(&scene, DEVIATION, k));
        let base = model(&base);
        let fresh = model(&other);
        let mut worst = 0.0_f64;
        for q in coordinates(&other, &fresh) {
            let expected = compiled(&fresh, q);
            let [of_one, of_other] = [&one, &other].map(|scene| recorded(&base, scene, q));
            let found = of_one.code.evaluate(&of_other.inputs(q).expect("a pose"));
            let scale = |k: usize| match k {
                0 | 1 => expected[0],
                _ => expected[2..]
                    .iter()
                    .fold(0.0, |max: f64, v| max.max(v.abs())),
            };
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                worst = worst.max((found - expected).abs() / scale(k));
            }
        }
        // Seen: 1.9e-15 (jansen).
        assert!(worst < 1e-13, "{case}: an output differs by {worst:e}");
    }
}

#[test]
fn the_gradient_of_a_recording_is_the_difference_of_compiled_models() {
    /// Relative change of a number, of which the difference has an error of second order.
    const STEP: f64 = 1e-4;
    for case in CASES {
        let scene = without_loads(case);
        let base = variant(&scene, DEVIATION, 1);
        let model_of_base = model(&base);
        let q = coordinates(&base, &model_of_base)[0];
        let recording = recorded(&model_of_base, &base, q);
        let mut sweep = ReverseSweep::default();
        let at = recording.inputs(q).expect("a pose");
        let count = sweep.evaluate(&recording.code, &at).len();
        // One weight for each output, so that all take part.
        let weights: Vec<f64> = (0..count).map(|k| 1.0 / (1.0 + k as f64)).collect();
        let gradient = sweep.gradient(&recording.code, &at, &weights)[1..].to_vec();
        // A solution does not depend on where the iterations began.
        let (of_numbers, of_unknowns) = gradient.split_at(recording.numbers.len());
        let largest = |of: &[f64]| of.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
        // Seen: 1.1e-17.
        assert!(
            largest(of_unknowns) <= 1e-15 * largest(of_numbers),
            "{case}"
        );
        let mut worst = 0.0_f64;
        for path in base.number_paths() {
            let value = base.value(&path).expect("a number");
            let [less, more] = [-STEP, STEP].map(|step| {
                let changed = base.with_values(&[(&path, value * (1.0 + step))]);
                let changed = changed.expect("a scene");
                let sum = compiled(&model(&changed), q)
                    .iter()
                    .zip(&weights)
                    .map(|(f, w)| f * w)
                    .sum::<f64>();
                (sum, recorded(&model_of_base, &changed, q).numbers)
            });
            let by_gradient = gradient
                .iter()
                .zip(less.1.iter().zip(&more.1))
                .map(|(slope, (a, b))| slope * (b - a));
            let (found, difference) = (by_gradient.sum::<f64>(), more.0 - less.0);
            let scale = gradient
                .iter()
                .zip(&recording.numbers)
                .map(|(g, n)| (g * n).abs())
                .fold(0.0, f64::max);
            // The error of the difference: the third derivative times the step cubed, and rounding.
            worst = worst.max((found - difference).abs() / (2.0 * STEP * scale));
        }
        // Seen: 4.8e-7 (jansen), the error of the difference.
        assert!(worst < 1e-6, "{case}: a derivative differs by {worst:e}");
    }
}

#[test]
fn other_structures_and_several_actuators_are_refused() {
    let scene = without_loads("boom");
    let refused = model(&scene).record_coefficients(&scene.mechanism, &scene.masses, &[0.1]);
    assert_eq!(refused, Err(CoefficientsRecordingError::Actuators(2)));
    let [one, other] = ["crank-rocker", "slider-crank"].map(without_loads);
    let refused = model(&one).record_coefficients(&other.mechanism, &other.masses, &[0.1]);
    assert_eq!(refused, Err(CoefficientsRecordingError::Structure));
}
