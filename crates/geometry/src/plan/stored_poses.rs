//! Poses stored along the range, from which Newton's method starts and whole revolutions are counted: so a
//! pose depends on the coordinate alone, not on what was evaluated before it.

use crate::error::PositionError;
use crate::plan::range::Range;
use crate::plane::Vec2;

/// A stored pose of a group.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct StoredPose {
    /// The coordinate, rad or m.
    pub(crate) q: f64,
    /// By unknown of the group: (cos, sin) of a class, (counted angle, 0) of one whose revolutions are
    /// counted, or (travel, 0) of a slide.
    pub(crate) values: Vec<Vec2>,
    /// By unknown: its derivative with respect to the coordinate.
    pub(crate) slopes: Vec<f64>,
}

/// Stored poses in the order of their coordinates: where the branch was followed in fine steps, they are
/// as dense. Where the pose repeats, those of one period.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct StoredPoses {
    pub(crate) poses: Vec<StoredPose>,
    /// By unknown: what a period adds to a counted angle, rad.
    pub(crate) gain_per_period: Vec<f64>,
}

/// The stored pose nearest to a coordinate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NearestPose<'a> {
    pub(crate) pose: &'a StoredPose,
    /// How far the coordinate is from the stored pose's, whole periods apart.
    pub(crate) distance: f64,
    /// Whole periods between them.
    pub(crate) periods: f64,
}

impl StoredPoses {
    /// The stored pose nearest to `q`.
    ///
    /// # Errors
    /// [`PositionError::OutOfRange`] outside a limited range.
    pub(crate) fn nearest(&self, q: f64, range: Range) -> Result<NearestPose<'_>, PositionError> {
        let error = PositionError::NotFinite { q };
        let (Some(first), Some(last)) = (self.poses.first(), self.poses.last()) else {
            return Err(error);
        };
        let (q, periods) = match range.period() {
            // Over a period the stored poses repeat.
            Some(period) => {
                let periods = ((q - first.q) / period).floor();
                let folded = first.q + (q - first.q).rem_euclid(period);
                (folded, periods)
            }
            None => (range.wrap(q)?, 0.0),
        };
        let nearest_pose = |pose, distance, periods| NearestPose {
            pose,
            distance,
            periods,
        };
        let after = self.poses.partition_point(|pose| pose.q < q);
        let before = self.poses.get(after.wrapping_sub(1));
        let before = before.map(|s| nearest_pose(s, q - s.q, periods));
        let after = match (self.poses.get(after), range.period()) {
            (Some(pose), _) => Some(nearest_pose(pose, q - pose.q, periods)),
            (None, Some(period)) => Some(nearest_pose(first, q - period - first.q, periods + 1.0)),
            (None, None) => None,
        };
        match (before, after) {
            (Some(b), Some(a)) => Ok(if b.distance <= -a.distance { b } else { a }),
            (Some(only), None) | (None, Some(only)) => Ok(only),
            (None, None) => Ok(nearest_pose(last, q - last.q, periods)),
        }
    }

    /// The prediction of an unknown's first component from a stored pose: a counted angle or a travel.
    pub(crate) fn predict(&self, nearest: NearestPose<'_>, unknown: usize) -> f64 {
        let gain = self.gain_per_period.get(unknown).copied().unwrap_or(0.0);
        nearest.pose.values[unknown].x
            + nearest.pose.slopes[unknown] * nearest.distance
            + gain * nearest.periods
    }
}
