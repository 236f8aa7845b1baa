//! What a pass finds.

use super::{PassModel, RecursivePass};
use dwell_geometry::Pose;
use dwell_numerics::Scalar;

/// The actuators' actions and the requested reactions in one state of motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InverseDynamics<T> {
    /// By actuator: its force on its second body, N·m; of a length, N, positive when it pushes apart.
    pub tau: Vec<T>,
    /// By requested reaction: N or N·m.
    pub reactions: Vec<T>,
}

impl<T: Scalar> InverseDynamics<T> {
    /// Adds a multiple of other results of the same model.
    pub fn add_scaled(&mut self, other: &Self, factor: T) {
        for (sum, more) in self.reactions.iter_mut().zip(&other.reactions) {
            *sum += *more * factor;
        }
        for (sum, more) in self.tau.iter_mut().zip(&other.tau) {
            *sum += *more * factor;
        }
    }

    /// Copies them from a pass.
    pub(crate) fn read_from(
        &mut self,
        model: &PassModel,
        pose: &Pose<T>,
        pass: &RecursivePass<T, 1>,
    ) {
        for (i, tau) in self.tau.iter_mut().enumerate() {
            *tau = pass.tau(model, i)[0];
        }
        for (k, value) in self.reactions.iter_mut().enumerate() {
            *value = pass.reaction(model, pose, k)[0];
        }
    }
}
