//! A long motion in single precision.

use super::machine::{bare, export};
use dwell_export::{Evaluator, Precision, State};

/// A million steps of a motion without loads: the energy stays to 1e-6, since q is wrapped, the sums carry their rounding and
/// m is the integral of the tabulated slope.
#[test]
fn a_million_float_steps_keep_the_energy() {
    let export = export(bare(), 1e-6, Precision::Float);
    let twin = Evaluator::<f32>::new(&export.machine, &export.parts, Precision::Float);
    let mut state = twin.state(export.machine.initial);
    // Judged in double precision, so that the rounding of the judge does not count.
    let judge = Evaluator::<f64>::new(&export.machine, &export.parts, Precision::Float);
    // The state is what is stored less what the sums have lost.
    let energy = |state: &State<f32>| {
        let both = state.y.iter().zip(&state.carry);
        let y: Vec<f64> = both.map(|(&y, &c)| f64::from(y) - f64::from(c)).collect();
        let [kinetic, _] = judge.energies(&y).unwrap();
        kinetic
    };
    let before = energy(&state);
    for _ in 0..1_000_000 {
        twin.step(1e-3, &mut state).unwrap();
    }
    let drift = energy(&state) / before - 1.0;
    assert!(
        state.periods > 100 && drift.abs() < 1e-6,
        "{drift:e} after {}",
        state.periods
    );
}
