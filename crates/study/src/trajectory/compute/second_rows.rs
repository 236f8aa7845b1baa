//! The rows of a second computation of a motion, from which the errors of its columns are estimated.

use crate::estimate;
use crate::trajectory::compute::{ComputedTrajectory, RowScene, RowSource, Trajectory};

/// The rows of a second computation, and the time of each, s.
pub(crate) struct SecondRows {
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

impl SecondRows {
    /// The rows along a motion, up to where it can be evaluated. `None` if a column cannot be evaluated.
    pub(crate) fn new<S: RowScene>(
        source: &RowSource<'_, '_, S>,
        trajectory: &Trajectory<'_>,
    ) -> Option<Self> {
        let rows = source.only_rows(trajectory)?;
        let times = times_of(trajectory);
        Some(Self { times, rows })
    }
}

/// The times of a motion's samples, s.
fn times_of(trajectory: &Trajectory<'_>) -> Vec<f64> {
    let motion = trajectory.free_motion();
    let samples = motion.map_or(&[][..], |motion| &motion.samples);
    samples.iter().map(|sample| sample.t).collect()
}

impl ComputedTrajectory<'_> {
    /// Sets the errors of a motion's columns from their differences in a second computation at the same times; without
    /// one, or if a column never has values in both, the error is unknown.
    pub(crate) fn set_errors(&mut self, other: Option<&SecondRows>) {
        let Some(other) = other else { return };
        let own = times_of(&self.trajectory);
        let mut others = other.times.iter().zip(&other.rows).peekable();
        let mut pairs: Vec<(&Vec<f64>, &Vec<f64>)> = Vec::new();
        for (t, row) in own.iter().zip(&self.results.rows) {
            while others.next_if(|(other, _)| *other < t).is_some() {}
            if let Some((_, other)) = others.next_if(|(other, _)| *other == t) {
                pairs.push((row, other));
            }
        }
        let error = |k: usize| {
            let values = pairs.iter().map(|(a, b)| (a[k], b[k]));
            // Next to a change point a reaction may be undefined.
            let known = values.filter(|(a, b)| a.is_finite() && b.is_finite());
            let (one, two): (Vec<f64>, Vec<f64>) = known.unzip();
            if one.is_empty() {
                f64::INFINITY
            } else {
                estimate::over_motion(&one, &two, 0.0)
            }
        };
        self.results.errors = (0..self.results.columns.len()).map(error).collect();
    }
}
