//! The columns of a file that was read back, by name.

use super::jet::Jet;
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
    /// Arrays of words of an archive, and of a CSV file its headings.
    pub(crate) words: BTreeMap<String, Vec<String>>,
}

impl Rows {
    /// A number.
    pub(crate) fn get(&self, row: usize, name: &str) -> Option<f64> {
        self.columns.get(name)?.get(row).copied()
    }

    /// The numbers of a column; none of one that is not there.
    pub(crate) fn column(&self, name: &str) -> &[f64] {
        self.columns.get(name).map_or(&[], Vec::as_slice)
    }

    /// The columns whose names end in this way.
    pub(crate) fn ending<'a>(
        &'a self,
        end: &'a str,
    ) -> impl Iterator<Item = (&'a String, &'a Vec<f64>)> {
        self.columns
            .iter()
            .filter(move |(name, _)| name.ends_with(end))
    }

    /// The variable of the last row.
    pub(crate) fn end(&self) -> f64 {
        self.time(self.count.saturating_sub(1))
    }

    /// A quantity with its derivatives, from three columns whose names end like these. Where the file has no derivatives at
    /// all, they are zero.
    pub(crate) fn jet(&self, row: usize, prefix: &str, ends: [&str; 3]) -> Option<Jet> {
        let of = |end: &str| self.get(row, &format!("{prefix}{end}"));
        Some(Jet([
            of(ends[0])?,
            of(ends[1]).unwrap_or(0.0),
            of(ends[2]).unwrap_or(0.0),
        ]))
    }

    /// The variable of the rows: time, or of a sweep the first coordinate.
    pub(crate) fn time(&self, row: usize) -> f64 {
        self.get(row, "t").unwrap_or(0.0)
    }
}
