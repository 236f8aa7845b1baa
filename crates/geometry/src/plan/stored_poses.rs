//! Poses stored along the range, from which Newton's method starts and whole revolutions are counted: so that a pose
//! depends on the coordinate alone, not on earlier evaluations.

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
    /// By unknown: its second derivative.
    pub(crate) curvatures: Vec<f64>,
}

/// Stored poses in the order of their coordinates: where the branch was followed in fine steps, they are
/// as dense. Where the pose repeats, those of one period.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct StoredPoses {
    pub(crate) poses: Vec<StoredPose>,
    /// By unknown: the change of a counted angle in a period, rad.
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

/// The stored poses before and after a coordinate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EnclosingPoses<'a> {
    ends: [&'a StoredPose; 2],
    /// Whole periods from each to the coordinate.
    periods: [f64; 2],
    /// Hermite's weights of the values at the ends, and of their first and second derivatives.
    weights: [[f64; 2]; 3],
}

impl StoredPoses {
    /// The first and the last stored pose, and the coordinate among them with the whole periods that it is away.
    fn folded(&self, q: f64, range: Range) -> Result<([&StoredPose; 2], f64, f64), PositionError> {
        let (Some(first), Some(last)) = (self.poses.first(), self.poses.last()) else {
            return Err(PositionError::NotFinite);
        };
        let (folded, periods) = match range.period() {
            // Over a period the stored poses repeat.
            Some(period) => {
                let distance = q - first.q;
                let periods = (distance / period).floor();
                (first.q + distance.rem_euclid(period), periods)
            }
            None => (range.wrap(q)?, 0.0),
        };
        Ok(([first, last], folded, periods))
    }

    /// The stored poses before and after `q`; where there is one only, it is both.
    ///
    /// # Errors
    /// [`PositionError::OutOfRange`] outside a limited range.
    pub(crate) fn enclosing(
        &self,
        q: f64,
        range: Range,
    ) -> Result<EnclosingPoses<'_>, PositionError> {
        let ([first, last], folded, periods) = self.folded(q, range)?;
        let period = range.period().unwrap_or(f64::INFINITY);
        let after = self.poses.partition_point(|pose| pose.q < folded);
        let before = self.poses.get(after.wrapping_sub(1)).unwrap_or(first);
        let (after, shift, periods_after) = match self.poses.get(after) {
            Some(pose) => (pose, 0.0, periods),
            None if period.is_finite() => (first, period, periods + 1.0),
            None => (last, 0.0, periods),
        };
        let width = after.q + shift - before.q;
        let distance = folded - before.q;
        let t = if width > 0.0 { distance / width } else { 0.0 };
        let s = 1.0 - t;
        // The polynomial of degree five that has all six.
        let of_end = |near: f64, far: f64, side: f64| {
            let cube = near * near * near;
            let slope = side * width * cube * far * (1.0 + 3.0 * far);
            let curvature = 0.5 * width * width * cube * far * far;
            [cube * (1.0 + 3.0 * far + 6.0 * far * far), slope, curvature]
        };
        let weights = if width > 0.0 {
            let [before, after] = [of_end(s, t, 1.0), of_end(t, s, -1.0)];
            [0, 1, 2].map(|k| [before[k], after[k]])
        } else {
            [[1.0, 0.0], [distance, 0.0], [0.0; 2]]
        };
        Ok(EnclosingPoses {
            ends: [before, after],
            periods: [periods, periods_after],
            weights,
        })
    }

    /// The prediction of an unknown's first component: a counted angle or a travel.
    pub(crate) fn predict_between(&self, at: EnclosingPoses<'_>, unknown: usize) -> f64 {
        let gain = self.gain_per_period.get(unknown).copied().unwrap_or(0.0);
        let [values, slopes, curvatures] = at.weights;
        let of_end = |k: usize| {
            let end = at.ends[k];
            let value = end.values[unknown].x + gain * at.periods[k];
            let derivatives =
                slopes[k] * end.slopes[unknown] + curvatures[k] * end.curvatures[unknown];
            values[k] * value + derivatives
        };
        of_end(0) + of_end(1)
    }

    /// The stored pose nearest to `q`.
    ///
    /// # Errors
    /// [`PositionError::OutOfRange`] outside a limited range.
    pub(crate) fn nearest(&self, q: f64, range: Range) -> Result<NearestPose<'_>, PositionError> {
        let ([first, last], q, periods) = self.folded(q, range)?;
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

    /// The linear prediction of an unknown's first component from a stored pose: a counted angle or a travel.
    pub(crate) fn predict(&self, nearest: NearestPose<'_>, unknown: usize) -> f64 {
        let gain = self.gain_per_period.get(unknown).copied().unwrap_or(0.0);
        nearest.pose.values[unknown].x
            + nearest.pose.slopes[unknown] * nearest.distance
            + gain * nearest.periods
    }
}

impl EnclosingPoses<'_> {
    /// The prediction of (cos, sin) of an unknown class.
    pub(crate) fn predict_rotation(&self, unknown: usize) -> Vec2 {
        let [values, slopes, curvatures] = self.weights;
        let of_end = |k: usize| {
            let end = self.ends[k];
            let (slope, curvature) = (end.slopes[unknown], end.curvatures[unknown]);
            let along = values[k] - curvatures[k] * slope * slope;
            let across = slopes[k] * slope + curvatures[k] * curvature;
            let value = end.values[unknown];
            value * along + value.perp() * across
        };
        let predicted = of_end(0) + of_end(1);
        predicted * (1.0 / predicted.dot(predicted).sqrt())
    }
}
