//! Poses stored along the range, from which Newton's method starts and whole turns are counted: so a
//! pose depends on the coordinate alone, not on what was evaluated before it.

use crate::error::PlaceError;
use crate::plane::Vec2;
use crate::range::Range;

/// A stored pose of a group.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Seed {
    /// The coordinate, rad or m.
    pub(crate) q: f64,
    /// By unknown of the group: (cos, sin) of a class, (counted angle, 0) of one whose turns are
    /// counted, or (travel, 0) of a slide.
    pub(crate) values: Vec<Vec2>,
    /// By unknown: its derivative with respect to the coordinate.
    pub(crate) slopes: Vec<f64>,
}

/// Seeds in the order of their coordinates: where the branch was followed in fine steps, they are
/// as dense. Where the mechanism comes back after whole turns, those of one period.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Seeds {
    pub(crate) list: Vec<Seed>,
    /// By unknown: what a period adds to a counted angle, rad.
    pub(crate) gains: Vec<f64>,
}

/// The seed nearest to a coordinate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Near<'a> {
    pub(crate) seed: &'a Seed,
    /// How far the coordinate is from the seed's, whole periods apart.
    pub(crate) away: f64,
    /// Whole periods between them.
    pub(crate) periods: f64,
}

impl Seeds {
    /// The seed nearest to `q`.
    ///
    /// # Errors
    /// [`PlaceError::OutOfRange`] outside a limited range.
    pub(crate) fn nearest(&self, q: f64, range: Range) -> Result<Near<'_>, PlaceError> {
        let nowhere = PlaceError::NotFinite { q };
        let (Some(first), Some(last)) = (self.list.first(), self.list.last()) else {
            return Err(nowhere);
        };
        let (q, periods) = match range.period() {
            // Over a period the seeds repeat.
            Some(period) => {
                let periods = ((q - first.q) / period).floor();
                let folded = first.q + (q - first.q).rem_euclid(period);
                (folded, periods)
            }
            None => (range.fold(q)?, 0.0),
        };
        let near = |seed, away, periods| Near {
            seed,
            away,
            periods,
        };
        let after = self.list.partition_point(|seed| seed.q < q);
        let before = self.list.get(after.wrapping_sub(1));
        let before = before.map(|s| near(s, q - s.q, periods));
        let after = match (self.list.get(after), range.period()) {
            (Some(seed), _) => Some(near(seed, q - seed.q, periods)),
            (None, Some(period)) => Some(near(first, q - period - first.q, periods + 1.0)),
            (None, None) => None,
        };
        match (before, after) {
            (Some(b), Some(a)) => Ok(if b.away <= -a.away { b } else { a }),
            (Some(only), None) | (None, Some(only)) => Ok(only),
            (None, None) => Ok(near(last, q - last.q, periods)),
        }
    }

    /// The prediction of an unknown's first component from a seed: a counted angle or a travel.
    pub(crate) fn predict(&self, near: Near<'_>, unknown: usize) -> f64 {
        let gain = self.gains.get(unknown).copied().unwrap_or(0.0);
        near.seed.values[unknown].x + near.seed.slopes[unknown] * near.away + gain * near.periods
    }
}
