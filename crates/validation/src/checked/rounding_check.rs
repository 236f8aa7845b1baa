//! What rounding does to a scene's results: its states evaluated in three lengths of numbers, of which the
//! longest tells the errors of the others.

use dwell_findings::{Check, Finding};
use dwell_kinetostatics::{KinetostaticsError, Model};
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::Scene;
use dwell_study::StudyError;
use dwell_study::models::loaded_model;
use dwell_verify::ClaimedState;
use rayon::prelude::*;

/// What a plain evaluation may lose: measured over all cases, 3e-15; a sum of a hundred rounded terms.
const F64_TOLERANCE: f64 = 1e-13;
/// The error of every actuator's action and every reaction in one state, as a part of the largest of its unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StateRounding {
    /// Time, s.
    pub(crate) t: f64,
    /// The worst of `f64`.
    pub(crate) f64_error: f64,
    /// Of what.
    pub(crate) quantity: String,
    /// The worst of `f32`; none where there is no pose in them.
    pub(crate) f32_error: Option<f64>,
}

/// All states of a case.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RoundingCheck {
    pub(crate) states: Vec<StateRounding>,
}

/// Actions and reactions in one state, in any kind of number.
fn evaluate<T: Scalar>(model: &Model, state: &ClaimedState) -> Result<Vec<T>, KinetostaticsError> {
    let lift = |values: &[f64]| -> Vec<T> { values.iter().map(|&v| T::from_f64(v)).collect() };
    let (mut workspace, mut inverse_dynamics) = (model.workspace(), model.result_buffer());
    let [q, q_dot, q_ddot] = [&state.q, &state.q_dot, &state.q_ddot].map(|v| lift(v));
    model.kinetostatics(
        state.t,
        &q,
        &q_dot,
        &q_ddot,
        &mut workspace,
        &mut inverse_dynamics,
    )?;
    let mut all = inverse_dynamics.tau;
    all.extend(inverse_dynamics.reactions);
    Ok(all)
}

impl RoundingCheck {
    /// Evaluates states of a scene in `f32`, `f64` and two words.
    ///
    /// # Errors
    /// [`StudyError`] when the mechanism cannot be put together.
    pub(crate) fn new(scene: &Scene, states: &[ClaimedState]) -> Result<Self, StudyError> {
        let model = loaded_model(scene)?;
        let reference: Vec<Option<Vec<DoubleDouble>>> = states
            .par_iter()
            .map(|state| evaluate(&model, state).ok())
            .collect();
        let mechanism = &scene.mechanism;
        let actuators = mechanism.actuators.iter().map(|a| {
            let unit = if a.coordinate().is_angle() {
                "N m"
            } else {
                "N"
            };
            (a.name.clone(), unit)
        });
        let reactions = mechanism.reactions().into_iter();
        let reactions = reactions.map(|r| (mechanism.reaction_name(r), r.component.unit()));
        let named: Vec<(String, &str)> = actuators.chain(reactions).collect();
        let largest = |unit: &str| {
            let of = |all: &Vec<DoubleDouble>| {
                let some = named.iter().zip(all).filter(|((_, u), _)| *u == unit);
                some.fold(0.0_f64, |largest_value, (_, v)| {
                    largest_value.max(v.value().abs())
                })
            };
            reference.iter().flatten().map(of).fold(0.0, f64::max)
        };
        let scales: Vec<f64> = named.iter().map(|(_, unit)| largest(unit)).collect();
        let evaluated = states
            .par_iter()
            .zip(&reference)
            .filter_map(|(state, reference)| {
                let reference = reference.as_ref()?;
                let (f64_error, k) =
                    max_relative_error(&evaluate::<f64>(&model, state).ok()?, reference, &scales);
                let f32_values = evaluate::<f32>(&model, state).ok();
                Some(StateRounding {
                    t: state.t,
                    f64_error,
                    quantity: named.get(k).map_or(String::new(), |n| n.0.clone()),
                    f32_error: f32_values
                        .map(|f32_values| max_relative_error(&f32_values, reference, &scales).0),
                })
            });
        Ok(Self {
            states: evaluated.collect(),
        })
    }

    /// The largest errors of `f64`, with its state, and of `f32`.
    pub(crate) fn largest(&self) -> Option<(&StateRounding, Option<f64>)> {
        let f64_state = self
            .states
            .iter()
            .max_by(|a, b| a.f64_error.total_cmp(&b.f64_error))?;
        let f32_errors = self.states.iter().filter_map(|s| s.f32_error);
        Some((f64_state, f32_errors.reduce(f64::max)))
    }
}

/// The largest difference from the wide values, and which it is.
fn max_relative_error<T: Scalar>(
    values: &[T],
    reference: &[DoubleDouble],
    scales: &[f64],
) -> (f64, usize) {
    let mut found = (0.0, 0);
    for (k, ((&value, &reference), &scale)) in values.iter().zip(reference).zip(scales).enumerate()
    {
        let difference = (DoubleDouble::from_f64(value.value()) - reference)
            .abs()
            .value();
        let relative = if difference == 0.0 {
            0.0
        } else {
            difference / scale
        };
        if relative > found.0 || relative.is_nan() {
            found = (relative, k);
        }
    }
    found
}

/// The one finding: the error of `f64`.
pub(crate) fn finding(rounding: &RoundingCheck) -> Option<Finding> {
    let (largest, f32_error) = rounding.largest()?;
    let (condition, condition_text) = match f32_error {
        None => (1.0, "no pose in f32".to_owned()),
        Some(f32_error) => (
            f32_error / f64::from(f32::EPSILON),
            format!("f32 errs by {f32_error:.0e}, which shows the condition"),
        ),
    };
    Some(Finding {
        key: "rounding".to_owned(),
        check: Check::Rounding,
        comparison: "actions and reactions in f64 with the same in numbers of 32 digits".to_owned(),
        domain: format!("{} states", rounding.states.len()),
        absolute_difference: largest.f64_error,
        unit: String::new(),
        relative_difference: largest.f64_error,
        scale: "the largest of the same unit in all states".to_owned(),
        worst_at: format!("t = {} s, {}", largest.t, largest.quantity),
        tolerance: F64_TOLERANCE,
        tolerance_reason: format!("roundings of a plain evaluation; {condition_text}"),
        condition_number: condition,
        integrated: false,
        pass: largest.f64_error <= F64_TOLERANCE,
    })
}
