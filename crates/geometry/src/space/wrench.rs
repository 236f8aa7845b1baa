//! Forces with moments.

use super::vector::Vec3;
use dwell_numerics::Scalar;

/// A force (N) and a moment (N·m) about a point, in the axes of the ground.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench<T = f64> {
    /// The force.
    pub force: Vec3<T>,
    /// The moment.
    pub moment: Vec3<T>,
}

impl<T: Scalar> Wrench<T> {
    /// Adds a force at this vector from the point, with a couple.
    #[inline(always)]
    #[track_caller]
    pub fn add_at(&mut self, arm: Vec3<T>, force: Vec3<T>, couple: Vec3<T>) {
        self.force += force;
        self.moment += couple + arm.cross(force);
    }

    /// Subtracts a force, or else a couple.
    #[inline(always)]
    pub(super) fn subtract(&mut self, action: Vec3<T>, is_force: bool) {
        let part = if is_force {
            &mut self.force
        } else {
            &mut self.moment
        };
        *part -= action;
    }
}
