//! Poses stored along the range, from which Newton's method starts: so a pose depends on the
//! coordinate alone, not on what was evaluated before it.

use crate::error::PlaceError;
use crate::plane::Vec2;
use crate::range::Range;
use std::f64::consts::TAU;

/// A stored pose of a Newton group.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Seed {
    /// The coordinate, rad.
    pub(crate) q: f64,
    /// By unknown of the group: (cos, sin) of a class, or (travel, 0) of a slide.
    pub(crate) values: Vec<Vec2>,
    /// By unknown: its derivative with respect to the coordinate.
    pub(crate) slopes: Vec<f64>,
}

/// Seeds in the order of their coordinates: where the branch was followed in fine steps, they are
/// as dense. Over a full turn, those of one turn.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Seeds(pub(crate) Vec<Seed>);

impl Seeds {
    /// The seed nearest to `q`, and how far `q` is from it.
    ///
    /// # Errors
    /// [`PlaceError::OutOfRange`] outside a limited range.
    pub(crate) fn nearest(&self, q: f64, range: Range) -> Result<(&Seed, f64), PlaceError> {
        let nowhere = PlaceError::NotFinite { q };
        let (Some(first), Some(last)) = (self.0.first(), self.0.last()) else {
            return Err(nowhere);
        };
        let (q, next_turn) = match range {
            // Over a turn the seeds repeat.
            Range::Full => (first.q + (q - first.q).rem_euclid(TAU), Some(first)),
            Range::Between(..) => (range.fold(q)?, None),
        };
        let after = self.0.partition_point(|seed| seed.q < q);
        let before = self.0.get(after.wrapping_sub(1)).map(|s| (s, q - s.q));
        let after = match self.0.get(after) {
            Some(seed) => Some((seed, q - seed.q)),
            None => next_turn.map(|seed| (seed, q - TAU - seed.q)),
        };
        match (before, after) {
            (Some(b), Some(a)) => Ok(if b.1 <= -a.1 { b } else { a }),
            (Some(only), None) | (None, Some(only)) => Ok(only),
            (None, None) => Ok((last, q - last.q)),
        }
    }
}
