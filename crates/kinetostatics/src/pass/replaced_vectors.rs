//! Replacement of vectors of the pass by those of a variant.

use dwell_geometry::{Plan, Vec2};

/// Replaces a vector that the structure may leave out, because it is zero in all variants; returns false if it is not
/// zero.
pub(super) fn replace_vector(place: &mut Option<Vec2>, value: Vec2) -> bool {
    match place {
        Some(place) => {
            *place = value;
            true
        }
        None => value == Vec2::ZERO,
    }
}

/// The vector from a body's origin to one of its points, in its frame, m.
pub(super) fn vector_to(plan: &Plan, body: usize, point: Vec2) -> Vec2 {
    plan.tree().vector_to(plan.frames(), body, point).local
}
