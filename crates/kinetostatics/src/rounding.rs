//! Estimates of the rounding errors of a result: it is evaluated again in double-double numbers, of 32 digits.
//!
//! The estimate is the difference of both, plus one unit in the last place of the result, because evaluating twice does
//! not show the rounding of lengths and masses when the model is compiled.

use crate::error::KinetostaticsError;
use crate::model::{Model, Workspace};
use crate::pass::InverseDynamics;
use crate::reduced::Coefficients;
use dwell_geometry::PositionError;
use dwell_numerics::{DoubleDouble, Scalar};

/// The difference from the precise number, plus one unit in the last place.
fn rounding_error(value: f64, precise: DoubleDouble) -> f64 {
    (DoubleDouble::from_f64(value) - precise).abs().value() + f64::EPSILON * value.abs()
}

fn rounding_errors(errors: &mut [f64], values: &[f64], precise: &[DoubleDouble]) {
    for ((error, &value), &precise) in errors.iter_mut().zip(values).zip(precise) {
        *error = rounding_error(value, precise);
    }
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
        let mut precise = self.coefficient_buffer();
        self.reduce(DoubleDouble::from_f64(q), workspace, &mut precise)?;
        errors.m = rounding_error(coefficients.m, precise.m);
        errors.half_dm = rounding_error(coefficients.half_dm, precise.half_dm);
        rounding_errors(&mut errors.a, &coefficients.a, &precise.a);
        rounding_errors(&mut errors.b, &coefficients.b, &precise.b);
        Ok(())
    }

    /// Estimates into `errors` (N·m or N) the rounding errors of the `result` that
    /// [`Model::kinetostatics`] found in a state of motion. The laws of loads and couplings are
    /// evaluated in plain numbers in both.
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
        let mut precise = self.result_buffer();
        self.kinetostatics(t, &q, &q_dot, &q_ddot, workspace, &mut precise)?;
        rounding_errors(&mut errors.tau, &result.tau, &precise.tau);
        rounding_errors(&mut errors.reactions, &result.reactions, &precise.reactions);
        Ok(())
    }
}
