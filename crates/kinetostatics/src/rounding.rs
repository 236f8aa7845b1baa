//! Estimates of the rounding errors of a result: it is evaluated again in double-double numbers, of 32 digits.
//!
//! The estimate is the difference of both, plus one unit in the last place of the result, because evaluating twice does not
//! show the rounding of lengths and masses when the model is compiled. Near a jam this rounding is amplified; the estimate
//! there includes the change by another rounding of the friction coefficients.

use crate::error::KinetostaticsError;
use crate::model::{MachineModel as _, Model, Workspace};
use crate::pass::InverseDynamics;
use crate::reduced::{Coefficients, ReducibleModel};
use dwell_geometry::PositionError;
use dwell_numerics::{DoubleDouble, Scalar};

/// Roundings of a law that couples coordinates, with its derivatives: it is evaluated in plain numbers in both.
const LAW_ROUNDINGS: f64 = 5.0;

/// Roundings of the constants that a friction depends on: its coefficient, and the directions of the surfaces.
const FRICTION_ROUNDINGS: f64 = 4.0;

/// The difference from the precise number, plus one unit in the last place.
fn rounding_error(value: f64, precise: DoubleDouble) -> f64 {
    (DoubleDouble::from_f64(value) - precise).abs().value() + f64::EPSILON * value.abs()
}

fn rounding_errors(errors: &mut [f64], values: &[f64], precise: &[DoubleDouble]) {
    for ((error, &value), &precise) in errors.iter_mut().zip(values).zip(precise) {
        *error = rounding_error(value, precise);
    }
}

/// Estimates into `errors` the rounding errors of the reduced `coefficients` at `q` (rad or m) of a model in the plane or in space,
/// each in its own unit.
///
/// # Errors
/// [`PositionError`] when there is no pose at `q`.
pub fn reduction_rounding_errors<M: ReducibleModel>(
    model: &M,
    q: f64,
    coefficients: &Coefficients,
    workspace: &mut M::Workspace<DoubleDouble>,
    errors: &mut Coefficients,
) -> Result<(), PositionError> {
    let mut precise = Coefficients::buffer(model.reaction_count());
    model.reduce_at(DoubleDouble::from_f64(q), workspace, &mut precise)?;
    errors.m = rounding_error(coefficients.m, precise.m);
    errors.half_dm = rounding_error(coefficients.half_dm, precise.half_dm);
    rounding_errors(&mut errors.a, &coefficients.a, &precise.a);
    rounding_errors(&mut errors.b, &coefficients.b, &precise.b);
    Ok(())
}

impl Model {
    /// Estimates into `errors` the rounding errors of the reduced `coefficients` that
    /// [`Model::reduce`] found at `q` (rad or m), each in its own unit.
    ///
    /// # Errors
    /// [`PositionError`] when there is no pose at `q`.
    pub fn reduction_rounding_errors(
        &self,
        q: f64,
        coefficients: &Coefficients,
        workspace: &mut Workspace<DoubleDouble>,
        errors: &mut Coefficients,
    ) -> Result<(), PositionError> {
        reduction_rounding_errors(self, q, coefficients, workspace, errors)?;
        if !self.mechanism().couplings.is_empty() {
            let law = |value: f64| LAW_ROUNDINGS * f64::EPSILON * value.abs();
            errors.m += law(coefficients.m);
            errors.half_dm += law(coefficients.half_dm);
            let rest = errors.a.iter_mut().chain(&mut errors.b);
            let values = coefficients.a.iter().chain(&coefficients.b);
            rest.zip(values)
                .for_each(|(error, &value)| *error += law(value));
        }
        Ok(())
    }

    /// Estimates into `errors` (N·m or N) the rounding errors of the `result` of [`Model::kinetostatics`] in a state of
    /// motion. The laws of loads and couplings are evaluated in plain numbers in both. If friction jams the mechanism
    /// only in 32 digits, or only after a rounding of its coefficients, the result is unknown: the errors are as large
    /// as the values.
    ///
    /// # Errors
    /// As [`Model::kinetostatics`].
    pub fn kinetostatics_rounding_errors(
        &self,
        t: f64,
        [q, q_dot, q_ddot]: [&[f64]; 3],
        result: &InverseDynamics<f64>,
        workspace: &mut Workspace<DoubleDouble>,
        errors: &mut InverseDynamics<f64>,
    ) -> Result<(), KinetostaticsError> {
        let lift = |values: &[f64]| values.iter().map(|&v| DoubleDouble::from_f64(v)).collect();
        let [q, q_dot, q_ddot]: [Vec<DoubleDouble>; 3] = [q, q_dot, q_ddot].map(lift);
        let mut solve = |scale: f64, result: &mut InverseDynamics<DoubleDouble>| {
            workspace.friction_workspace.factor_scale = scale;
            let solved = self.kinetostatics(t, &q, &q_dot, &q_ddot, workspace, result);
            let solved = solved.map(|_| ());
            workspace.friction_workspace.factor_scale = 1.0;
            match solved {
                Err(KinetostaticsError::SelfLocking { .. }) => Ok(false),
                other => other.map(|()| true),
            }
        };
        let mut precise = self.result_buffer();
        let mut is_known = solve(1.0, &mut precise)?;
        let mut changed = precise.clone();
        if self.frictions().len() > 0 {
            is_known &= solve(1.0 + FRICTION_ROUNDINGS * f64::EPSILON, &mut changed)?;
        }
        let parts = [
            (&mut errors.tau, &result.tau, precise.tau, changed.tau),
            (
                &mut errors.reactions,
                &result.reactions,
                precise.reactions,
                changed.reactions,
            ),
        ];
        for (errors, values, precise, changed) in parts {
            rounding_errors(errors, values, &precise);
            for (error, (one, other)) in errors.iter_mut().zip(precise.iter().zip(&changed)) {
                *error += (*other - *one).abs().value();
            }
            if !is_known {
                errors
                    .iter_mut()
                    .zip(values)
                    .for_each(|(error, value)| *error = value.abs());
            }
        }
        Ok(())
    }
}
