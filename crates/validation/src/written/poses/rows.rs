//! The columns of a file that was read back, by name.

use std::collections::BTreeMap;

/// The largest absolute value.
pub(crate) fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values
        .into_iter()
        .fold(0.0, |max: f64, value| max.max(value.abs()))
}

/// The smallest and the largest value.
pub(crate) fn extent<'a>(values: impl IntoIterator<Item = &'a f64>) -> [f64; 2] {
    let ends = [f64::INFINITY, f64::NEG_INFINITY];
    let wider = |[low, high]: [f64; 2], value: &f64| [low.min(*value), high.max(*value)];
    values.into_iter().fold(ends, wider)
}

/// Columns of equal length.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Rows {
    pub(crate) columns: BTreeMap<String, Vec<f64>>,
    pub(crate) count: usize,
}

impl Rows {
    /// A number.
    pub(crate) fn get(&self, row: usize, name: &str) -> Option<f64> {
        self.columns.get(name)?.get(row).copied()
    }

    /// The numbers of a column; empty if there is no such column.
    pub(crate) fn column(&self, name: &str) -> &[f64] {
        self.columns.get(name).map_or(&[], Vec::as_slice)
    }

    /// The variable of the last row.
    pub(crate) fn end(&self) -> f64 {
        self.time(self.count.saturating_sub(1))
    }

    /// The variable of the rows: time, or of a sweep the first coordinate.
    pub(crate) fn time(&self, row: usize) -> f64 {
        self.get(row, "t").unwrap_or(0.0)
    }
}
