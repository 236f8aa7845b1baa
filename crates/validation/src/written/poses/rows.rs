//! The columns of a file that was read back, by name.

use super::jet::Jet;
use std::collections::BTreeMap;

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
