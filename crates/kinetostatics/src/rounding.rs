//! What rounding does to a result: it is evaluated again in numbers of two words, of 32 digits.
//!
//! The estimate of an error is the difference of both, and one last place of the result: what its lengths and
//! masses are rounded to when the model is compiled is not seen by evaluating twice.

use crate::kinetostatics::KinetostaticsError;
use crate::model::{Actions, Model, Workspace};
use crate::reduced::Coefficients;
use dwell_geometry::{PlaceError, Scalar, Wide};

/// How far a number is from the wide one, and one last place.
fn off(value: f64, wide: Wide) -> f64 {
    (Wide::lift(value) - wide).abs().value() + f64::EPSILON * value.abs()
}

fn all_off(errors: &mut [f64], values: &[f64], wide: &[Wide]) {
    for ((error, &value), &wide) in errors.iter_mut().zip(values).zip(wide) {
        *error = off(value, wide);
    }
}

impl Model {
    /// The estimated rounding errors, to `errors`, of the reduced coefficients `at` that
    /// [`Model::reduce`] found at `q` (rad or m), each in its own unit.
    ///
    /// # Errors
    /// [`PlaceError`] when there is no pose at `q`.
    pub fn reduce_errors(
        &self,
        q: f64,
        at: &Coefficients,
        work: &mut Workspace<Wide>,
        errors: &mut Coefficients,
    ) -> Result<(), PlaceError> {
        let mut wide = self.coefficients();
        self.reduce(Wide::lift(q), work, &mut wide)?;
        errors.m = off(at.m, wide.m);
        errors.half_dm = off(at.half_dm, wide.half_dm);
        all_off(&mut errors.a, &at.a, &wide.a);
        all_off(&mut errors.b, &at.b, &wide.b);
        Ok(())
    }

    /// The estimated rounding errors, to `errors` (N·m or N), of the `actions` that
    /// [`Model::kinetostatics`] found in a state of motion. The laws of loads and relations are
    /// evaluated in plain numbers in both.
    ///
    /// # Errors
    /// As [`Model::kinetostatics`].
    pub fn action_errors(
        &self,
        t: f64,
        [q, q_dot, q_ddot]: [&[f64]; 3],
        actions: &Actions<f64>,
        work: &mut Workspace<Wide>,
        errors: &mut Actions<f64>,
    ) -> Result<(), KinetostaticsError> {
        let lift = |values: &[f64]| values.iter().map(|&v| Wide::lift(v)).collect();
        let [q, q_dot, q_ddot]: [Vec<Wide>; 3] = [q, q_dot, q_ddot].map(lift);
        let mut wide = self.actions();
        self.kinetostatics(t, &q, &q_dot, &q_ddot, work, &mut wide)?;
        all_off(&mut errors.tau, &actions.tau, &wide.tau);
        all_off(&mut errors.reactions, &actions.reactions, &wide.reactions);
        Ok(())
    }
}
