//! The extremes: rows of parameters driven as far as they go, each with the digits that it must keep stated
//! beforehand, held against closed forms in 32 digits. Every result carries the estimate of its error, and the
//! estimates are judged too.

mod edge;
pub mod grid;
mod judge;
mod limit;
mod motion;
mod moving;
mod page;
mod scale;
mod shapes;
mod stiff;
mod truth;

pub use grid::{Cell, Measured, Reading, Row, Stated, Told};
pub use judge::judge;
pub use page::outcome;

use crate::error::StudyError;
use crate::outcome::Outcome;
use rayon::prelude::*;

/// The whole study: `extremes`, or `extremes-long` with the rows that take minutes.
///
/// # Errors
/// [`StudyError`] where a picture cannot be drawn.
pub fn study(long: bool) -> Result<Outcome, StudyError> {
    let name = if long { "extremes-long" } else { "extremes" };
    outcome(&measure(rows(long)), name)
}

/// The rows of the grid; `long` for those that take minutes.
pub fn rows(long: bool) -> Vec<Row> {
    let mut rows = limit::rows();
    rows.extend(scale::rows());
    rows.extend(motion::rows(long));
    rows.extend(stiff::rows());
    rows.extend(edge::rows());
    rows
}

/// Computes all cells.
pub fn measure(rows: Vec<Row>) -> Vec<Measured> {
    let jobs: Vec<(usize, f64)> = rows
        .iter()
        .enumerate()
        .flat_map(|(k, row)| row.values.iter().map(move |&at| (k, at)))
        .collect();
    let cells: Vec<(usize, Vec<Cell>)> = jobs
        .into_par_iter()
        .map(|(k, at)| (k, rows[k].cells(at)))
        .collect();
    let mut measured: Vec<Measured> = rows
        .into_iter()
        .map(|row| Measured {
            row,
            cells: Vec::new(),
        })
        .collect();
    for (k, more) in cells {
        measured[k].cells.extend(more);
    }
    measured
}
