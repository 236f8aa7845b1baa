//! The loads at one state of motion.

use super::signal::SignalWorkspace;
use super::wrench::AppliedWrench;
use dwell_geometry::Vec2;
use dwell_numerics::Scalar;

/// The loads at one state of motion: working memory, and what it holds afterwards.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadState<T = f64> {
    /// By load: its magnitude F, in the unit of its kind.
    pub magnitude: Vec<T>,
    /// The wrenches of the loads on the bodies, in the order of the loads.
    pub wrenches: Vec<AppliedWrench<T>>,
    /// The acceleration of gravity of all such loads together, m/s².
    pub gravity: Vec2<T>,
    /// By body: the sum of the forces on it, N, and their moment about its origin, N·m.
    pub(crate) force: Vec<Vec2<T>>,
    pub(crate) moment: Vec<T>,
    /// By moving body: the forces on it and on all that it carries, N.
    pub(crate) subtree_force: Vec<Vec2<T>>,
    pub(crate) signal_workspace: SignalWorkspace<T>,
}

impl<T: Scalar> LoadState<T> {
    /// Sums the wrenches on each body.
    pub(super) fn sum_by_body(&mut self) {
        self.force.fill(Vec2::zero());
        self.moment.fill(T::from_f64(0.0));
        for wrench in &self.wrenches {
            self.force[wrench.body.0] += wrench.force;
            self.moment[wrench.body.0] += wrench.moment();
        }
    }
}
