//! What a sweep has stored, by result instead of by row: a study of 10⁸ points is reported with one column in memory.

use crate::explain::SweepError;
use crate::sweep::compute::Row;
use std::ops::Range;

/// The indices of stored points, ascending: ranges that do not touch each other.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct StoredPoints {
    ranges: Vec<Range<u64>>,
}

impl StoredPoints {
    /// Adds points behind all others.
    pub(crate) fn push(&mut self, range: Range<u64>) {
        match self.ranges.last_mut() {
            Some(last) if last.end == range.start => last.end = range.end,
            _ => self.ranges.push(range),
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.ranges
            .iter()
            .map(|range| (range.end - range.start) as usize)
            .sum()
    }

    pub(crate) fn indices(&self) -> impl Iterator<Item = u64> {
        self.ranges.iter().cloned().flatten()
    }

    /// The index of the point at a position in this order.
    pub(crate) fn index(&self, position: usize) -> u64 {
        let mut rest = position as u64;
        for range in &self.ranges {
            let count = range.end - range.start;
            if rest < count {
                return range.start + rest;
            }
            rest -= count;
        }
        // Positions are those of values, of which there is one for each point.
        self.ranges.last().map_or(0, |range| range.end)
    }
}

/// The points without all results.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct FailedPoints {
    pub(crate) count: usize,
    /// The first of them, with their messages.
    pub(crate) first: Vec<(u64, String)>,
}

/// Maximum number of messages in a summary.
pub(crate) const MAX_LISTED: usize = 3;

impl FailedPoints {
    /// Of points and their messages, where they have one.
    pub(crate) fn of(points: impl Iterator<Item = (u64, Option<String>)>) -> Self {
        let mut failed = Self::default();
        for (index, message) in points.filter_map(|(k, message)| Some((k, message?))) {
            failed.count += 1;
            if failed.first.len() < MAX_LISTED {
                failed.first.push((index, message));
            }
        }
        failed
    }
}

/// The stored points of a sweep.
pub(crate) trait StoredResults {
    fn points(&self) -> &StoredPoints;

    /// A result of all stored points, in the order of their indices; NaN where there is none.
    fn values(&self, result: usize) -> Result<Vec<f64>, SweepError>;

    fn failed(&self) -> Result<FailedPoints, SweepError>;

    /// Everything, for a table.
    fn rows(&self) -> Result<Vec<Row>, SweepError>;
}

/// Stored points that are in memory.
pub(crate) struct LoadedRows {
    points: StoredPoints,
    rows: Vec<Row>,
}

impl LoadedRows {
    /// Of rows in the order of their indices.
    pub(crate) fn new(rows: Vec<Row>) -> Self {
        let mut points = StoredPoints::default();
        for row in &rows {
            points.push(row.index..row.index + 1);
        }
        Self { points, rows }
    }
}

impl StoredResults for LoadedRows {
    fn points(&self) -> &StoredPoints {
        &self.points
    }

    fn values(&self, result: usize) -> Result<Vec<f64>, SweepError> {
        let rows = self.rows.iter();
        Ok(rows.map(|row| row.result.values[result]).collect())
    }

    fn failed(&self) -> Result<FailedPoints, SweepError> {
        let messages = self.rows.iter();
        let messages = messages.map(|row| (row.index, row.result.message.clone()));
        Ok(FailedPoints::of(messages))
    }

    fn rows(&self) -> Result<Vec<Row>, SweepError> {
        Ok(self.rows.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_counted_over_gaps() {
        let mut points = StoredPoints::default();
        for range in [0..3, 3..4, 10..12] {
            points.push(range);
        }
        assert_eq!(points.ranges, [0..4, 10..12]);
        assert_eq!(points.count(), 6);
        let indices: Vec<u64> = points.indices().collect();
        assert_eq!(indices, [0, 1, 2, 3, 10, 11]);
        let by_position: Vec<u64> = (0..6).map(|k| points.index(k)).collect();
        assert_eq!(by_position, indices);
    }
}
