//! The extremes of every column, and where they are.

use crate::run::columns::Column;
use crate::words::number;

/// The extremes of a column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Peak {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    /// Smallest and largest value, each with its row.
    pub(crate) low: (f64, usize),
    pub(crate) high: (f64, usize),
}

impl Peak {
    pub(crate) fn size(&self) -> f64 {
        self.low.0.abs().max(self.high.0.abs())
    }
}

/// The extremes of some columns, by unit and within one from the largest down.
pub(crate) fn peaks(columns: &[Column], chosen: &[usize], rows: &[Vec<f64>]) -> Vec<Peak> {
    let mut units: Vec<&str> = Vec::new();
    let peak = |&k: &usize| {
        // An empty cell is no extreme.
        let values = || {
            let rows = rows.iter().enumerate().map(|(i, row)| (row[k], i));
            rows.filter(|(value, _)| !value.is_nan())
        };
        // The first of equals.
        let low = values().reduce(|a, b| if b.0 < a.0 { b } else { a })?;
        let high = values().reduce(|a, b| if b.0 > a.0 { b } else { a })?;
        Some(Peak {
            name: columns[k].name.clone(),
            unit: columns[k].unit,
            low,
            high,
        })
    };
    let mut all: Vec<Peak> = chosen.iter().filter_map(peak).collect();
    for peak in &all {
        if !units.contains(&peak.unit) {
            units.push(peak.unit);
        }
    }
    let place = |p: &Peak| units.iter().position(|u| *u == p.unit);
    all.sort_by(|a, b| {
        let by_unit = place(a).cmp(&place(b));
        by_unit.then(b.size().total_cmp(&a.size()))
    });
    all
}

/// The peaks as CSV; `over` is the column that says where, with its values.
pub(crate) fn csv(peaks: &[Peak], (over, unit): (&str, &str), at: &[f64]) -> String {
    let mut text = format!("quantity,unit,min,min at {over} [{unit}],max,max at {over} [{unit}]\n");
    for peak in peaks {
        let Peak { name, unit, .. } = peak;
        let [(low, l), (high, h)] = [peak.low, peak.high];
        // Names of a scene hold neither commas nor quotes.
        text += &format!("{name},{unit},{low:?},{:?},{high:?},{:?}\n", at[l], at[h]);
    }
    text
}

/// The header and the cells of a table to read.
pub(crate) fn cells(
    peaks: &[Peak],
    (over, unit): (&str, &str),
    at: &[f64],
) -> (Vec<String>, Vec<Vec<String>>) {
    let header = [
        "quantity",
        "unit",
        "min",
        &format!("at {over} [{unit}]"),
        "max",
        &format!("at {over} [{unit}]"),
    ];
    let row = |peak: &Peak| {
        vec![
            peak.name.clone(),
            peak.unit.to_owned(),
            number(peak.low.0),
            number(at[peak.low.1]),
            number(peak.high.0),
            number(at[peak.high.1]),
        ]
    };
    (
        header.map(str::to_owned).to_vec(),
        peaks.iter().map(row).collect(),
    )
}
