//! The effect of rounding on a scene's results: its states evaluated in three precisions, of which the
//! highest shows the errors of the others.

use dwell_findings::{Check, Finding};
use dwell_kinetostatics::{KinetostaticsError, Model};
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::PlaneScene;
use dwell_study::StudyError;
use dwell_study::models::loaded_model;
use dwell_verify::ClaimedState;
use rayon::prelude::*;

/// Largest error of an evaluation in `f64`: measured over all cases, 3e-15; a sum of a hundred rounded terms.
const F64_TOLERANCE: f64 = 1e-13;
/// The error of every actuator force and every reaction in one state, as a part of the largest of its unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StateRounding {
    /// Time, s.
    pub(crate) t: f64,
    /// The largest of `f64`.
    pub(crate) f64_error: f64,
    /// Its quantity.
    pub(crate) quantity: String,
    /// The largest of `f32`; none where the position has no solution in it.
    pub(crate) f32_error: Option<f64>,
}

/// Actuator forces and reactions in one state, in any precision.
fn evaluate<T: Scalar>(model: &Model, state: &ClaimedState) -> Result<Vec<T>, KinetostaticsError> {
    let lift = |values: &[f64]| -> Vec<T> { values.iter().map(|&v| T::from_f64(v)).collect() };
    let (mut workspace, mut out) = (model.workspace(), model.result_buffer());
    let [q, q_dot, q_ddot] = [&state.q, &state.q_dot, &state.q_ddot].map(|v| lift(v));
    model.kinetostatics(state.t, &q, &q_dot, &q_ddot, &mut workspace, &mut out)?;
    out.tau.extend(out.reactions);
    Ok(out.tau)
}

/// Evaluates states of a scene in `f32`, `f64` and double-double numbers.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled.
pub(crate) fn rounding_errors(
    scene: &PlaneScene,
    states: &[ClaimedState],
) -> Result<Vec<StateRounding>, StudyError> {
    let model = loaded_model(scene)?;
    let exact = |state| evaluate::<DoubleDouble>(&model, state).ok();
    let reference: Vec<_> = states.par_iter().map(exact).collect();
    let mechanism = &scene.mechanism;
    let actuators = mechanism.actuators.iter();
    let actuators = actuators.map(|a| (a.name.clone(), a.coordinate().force_unit()));
    let reactions = mechanism.reactions().into_iter();
    let reactions = reactions.map(|r| (mechanism.reaction_name(r), r.component.unit()));
    let named: Vec<(String, &str)> = actuators.chain(reactions).collect();
    let largest = |unit: &str| {
        let all = reference.iter().flatten();
        let all = all.flat_map(|values| named.iter().zip(values));
        let same = all.filter(|((_, of), _)| *of == unit);
        same.fold(0.0_f64, |largest, (_, v)| largest.max(v.value().abs()))
    };
    let [forces, moments] = ["N", "N m"].map(largest);
    let scale = |(_, unit): &(_, &str)| if *unit == "N" { forces } else { moments };
    let scales: Vec<f64> = named.iter().map(scale).collect();
    let rounding = |(state, reference): (&ClaimedState, &Option<Vec<DoubleDouble>>)| {
        let reference = reference.as_ref()?;
        let values = evaluate::<f64>(&model, state).ok()?;
        let (f64_error, k) = max_relative_error(&values, reference, &scales);
        let single = evaluate::<f32>(&model, state).ok();
        Some(StateRounding {
            t: state.t,
            f64_error,
            quantity: named.get(k).map_or(String::new(), |n| n.0.clone()),
            f32_error: single.map(|v| max_relative_error(&v, reference, &scales).0),
        })
    };
    let evaluated = states.par_iter().zip(&reference).filter_map(rounding);
    Ok(evaluated.collect())
}

/// The largest difference from the double-double values, and its index.
fn max_relative_error<T: Scalar>(
    values: &[T],
    reference: &[DoubleDouble],
    scales: &[f64],
) -> (f64, usize) {
    let mut found = (0.0, 0);
    for (k, ((&value, &reference), &scale)) in values.iter().zip(reference).zip(scales).enumerate()
    {
        let difference = DoubleDouble::from_f64(value.value()) - reference;
        let relative = match difference.abs().value() {
            0.0 => 0.0,
            difference => difference / scale,
        };
        if relative > found.0 || relative.is_nan() {
            found = (relative, k);
        }
    }
    found
}

/// The one finding: the error of `f64`.
pub(crate) fn finding(rounding: &[StateRounding]) -> Option<Finding> {
    let states = rounding.iter();
    let largest = states.max_by(|a, b| a.f64_error.total_cmp(&b.f64_error))?;
    let error = [largest.f64_error; 2];
    let f32_errors = rounding.iter().filter_map(|s| s.f32_error);
    let f32_error = f32_errors.reduce(f64::max);
    let condition_text = match f32_error {
        None => "no position in f32".to_owned(),
        Some(f32_error) => format!("f32 errs by {f32_error:.0e}, which shows the condition"),
    };
    Some(Finding {
        comparison: "actuator forces and reactions in f64 with the same in numbers of 32 digits"
            .into(),
        domain: format!("{} states", rounding.len()),
        scale: "the largest of the same unit in all states".to_owned(),
        worst_at: format!("t = {} s, {}", largest.t, largest.quantity),
        tolerance_reason: format!("roundings of an evaluation; {condition_text}"),
        condition_number: f32_error.map_or(1.0, |error| error / f64::from(f32::EPSILON)),
        ..Finding::new("rounding", Check::Rounding, error, F64_TOLERANCE)
    })
}
