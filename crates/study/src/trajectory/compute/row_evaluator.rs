//! What evaluates the columns of a trajectory, in the plane or in space.

use crate::trajectory::compute::{Quantity, StopCause, TrajectorySample};

/// Evaluates all quantities at one position after another.
pub(crate) trait RowEvaluator: Clone + Send + Sync {
    /// From now on only some quantities are asked for: what they do not need may be left out.
    fn limit_to(&mut self, quantities: impl Iterator<Item = Quantity>);

    /// Evaluates the position of a sample, with the loads at time `t`.
    fn evaluate(&mut self, sample: &TrajectorySample, t: f64) -> Result<(), StopCause>;

    /// The value of a column at the position that was evaluated last.
    fn value(&self, quantity: Quantity, sample: &TrajectorySample) -> f64;

    /// The rate of an angle that is unwrapped along the trajectory, rad/s.
    fn angular_velocity(&self, angle: Quantity) -> f64;
}
