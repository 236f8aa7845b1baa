//! What drawings and texts need of the results along a trajectory.

use crate::trajectory::compute::{Quantity, Trajectory, TrajectoryResults};
use dwell_scene::Scene;

impl TrajectoryResults {
    /// The bodies that are not modelled, because nothing needs them.
    pub(crate) fn unmodelled_bodies(&self, scene: &Scene) -> Vec<String> {
        let bodies = scene.mechanism.bodies.iter().zip(&self.modelled);
        let unmodelled = bodies.filter(|(_, modelled)| !**modelled);
        unmodelled.map(|(body, _)| body.name.clone()).collect()
    }

    /// The index of the column of a quantity.
    pub(crate) fn column_index(&self, quantity: Quantity) -> Option<usize> {
        self.columns.iter().position(|c| c.quantity == quantity)
    }

    /// The index of the column of the abscissa: time, or the swept coordinate.
    pub(crate) fn abscissa(&self, trajectory: &Trajectory<'_>) -> usize {
        let swept = trajectory.swept_actuator();
        let quantity = swept.map_or(Quantity::Time, |a| Quantity::ActuatorCoordinate(a, 0));
        self.column_index(quantity).unwrap_or(0)
    }
}
