//! Assembly branches that are too close to each other for rounding to show which of them a motion follows.

use dwell_geometry::{NearBranch, Plan};

/// Accelerations within a half-width w (rad, or of the mechanism's size) err by eps/w² of themselves: 2.5e-7 at this
/// one. Between methods, motions past smaller ones differed by up to 100 times their estimates.
pub(crate) const MIN_HALF_WIDTH: f64 = 3e-5;

/// Whether a near branch is so close that rounding does not show which of the two a motion follows.
pub(crate) fn is_too_close(near: &NearBranch, plan: &Plan) -> bool {
    near.half_width < MIN_HALF_WIDTH * plan.coordinate_unit()
}
