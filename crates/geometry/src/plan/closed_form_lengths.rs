//! The constants of the closed forms, derived from the lengths of their vectors.

use crate::plan::{GuidedPoint, RrrDyad};
use crate::plane::Vec2;
use dwell_numerics::Constant;

impl<C: Constant> RrrDyad<C> {
    /// Derives the constants from the two vectors that turn and from the loop's part on the ground, m.
    pub(crate) fn set_lengths(&mut self, local: [Vec2<C>; 2], fixed: Vec2<C>) {
        let local = local.map(Vec2::values);
        let [one, two] = local.map(Vec2::norm);
        self.per_square = [
            local[0] * (1.0 / (one * one)),
            local[1] * (1.0 / (two * two)),
        ];
        self.sum_squared = (one + two) * (one + two);
        self.difference_squared = (one - two) * (one - two);
        self.square_difference = (two - one) * (two + one);
        self.fixed = fixed;
    }
}

impl<C: Constant> GuidedPoint<C> {
    /// Derives the constants from the direction of the line and the loop's vector in the turning frame and from the
    /// loop's part on the ground, m.
    pub(crate) fn set_lengths(&mut self, axis: Vec2<C>, local: Vec2<C>, fixed: Vec2<C>) {
        self.local = local;
        let (axis, local) = (axis.values(), local.values());
        self.length = local.norm();
        self.unit = if self.line_rotates {
            axis.perp()
        } else {
            local * (1.0 / local.norm())
        };
        self.fixed = fixed;
    }
}
