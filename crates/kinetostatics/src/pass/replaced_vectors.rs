//! Replacement of vectors of the pass by those of a variant.

use dwell_geometry::{Plan, Vec2};
use dwell_numerics::Constant;

/// Replaces a vector that the structure may leave out, because it is zero in all variants; returns false if it is not
/// zero.
pub(super) fn replace_vector<C: Constant>(place: &mut Option<Vec2<C>>, value: Vec2<C>) -> bool {
    match place {
        Some(place) => {
            *place = value;
            true
        }
        // A recording follows a model that the numbers fit.
        None => !C::IS_PREPARED || value == Vec2::zero(),
    }
}

/// The vector from a body's origin to one of its points, in its frame, m.
pub(super) fn vector_to<C: Constant>(plan: &Plan<C>, body: usize, point: Vec2<C>) -> Vec2<C> {
    plan.tree().vector_to(plan.frames(), body, point).local
}
