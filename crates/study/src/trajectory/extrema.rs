//! The minimum and maximum of every column, and where they occur.

use crate::trajectory::compute::Column;

/// The minimum and maximum of a column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ColumnExtrema {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    /// Smallest and largest value, each with its row.
    pub(crate) min: (f64, usize),
    pub(crate) max: (f64, usize),
}

impl ColumnExtrema {
    pub(crate) fn max_abs(&self) -> f64 {
        self.min.0.abs().max(self.max.0.abs())
    }
}

/// The extrema of some columns, grouped by unit, largest absolute value first.
pub(crate) fn extrema(
    columns: &[Column],
    selected: &[usize],
    rows: &[Vec<f64>],
) -> Vec<ColumnExtrema> {
    let mut units: Vec<&str> = Vec::new();
    let entry = |&k: &usize| {
        // Empty cells are skipped.
        let values = || {
            let rows = rows.iter().enumerate().map(|(i, row)| (row[k], i));
            rows.filter(|(value, _)| !value.is_nan())
        };
        // Of equal values the first.
        let min = values().reduce(|a, b| if b.0 < a.0 { b } else { a })?;
        let max = values().reduce(|a, b| if b.0 > a.0 { b } else { a })?;
        Some(ColumnExtrema {
            name: columns[k].name.clone(),
            unit: columns[k].unit,
            min,
            max,
        })
    };
    let mut all: Vec<ColumnExtrema> = selected.iter().filter_map(entry).collect();
    for entry in &all {
        if !units.contains(&entry.unit) {
            units.push(entry.unit);
        }
    }
    let unit_order = |p: &ColumnExtrema| units.iter().position(|u| *u == p.unit);
    all.sort_by(|a, b| {
        let by_unit = unit_order(a).cmp(&unit_order(b));
        by_unit.then(b.max_abs().total_cmp(&a.max_abs()))
    });
    all
}
