//! The study of extreme parameters: rows of parameter values up to their limits, each with the required digits stated
//! beforehand, compared with closed forms in 32 digits. Every result has an estimated error, and the
//! estimates are checked, too.

mod check;
mod closed_forms;
mod form_model;
mod form_report;
pub mod forms;
mod free_motion;
mod in_scenes;
mod jamming;
mod large_groups;
mod limit_positions;
pub mod mechanisms;
mod narrow_peaks;
mod paper_mechanism;
mod places;
mod ratios;
mod report;
mod run_pair;
mod scale;
pub mod series;
mod singular;
mod stiff;

pub use check::check;
pub use in_scenes::column;
pub use report::outcome;
pub use series::{
    CellResult, EstimatedValue, ParameterSeries, Requirement, ResultCell, SeriesResult,
};

use dwell_study::Outcome;
use dwell_study::StudyError;
use forms::Form;
use rayon::prelude::*;

/// The study: `extremes`, or `extremes-long` with the rows that take minutes.
///
/// # Errors
/// [`StudyError`] if a picture cannot be drawn.
pub fn study(slow: bool) -> Result<Outcome, StudyError> {
    let name = if slow { "extremes-long" } else { "extremes" };
    let results = evaluate(all_series(slow));
    let mut outcome = outcome(&results, large_groups::dense_findings(), name)?;
    forms::add_to(&mut outcome, &results, name);
    Ok(outcome)
}

/// The rows of the grid; with `slow` those that take minutes too.
pub fn all_series(slow: bool) -> Vec<ParameterSeries> {
    let mut series = all_in(Form::PLANE, slow);
    series.extend(narrow_peaks::series());
    series.extend(places::series());
    series
}

/// The rows of the grid in a form.
fn all_in(form: Form, slow: bool) -> Vec<ParameterSeries> {
    let mut series = limit_positions::series(form);
    series.extend(scale::series(form));
    series.extend(free_motion::series(form, slow));
    series.extend(stiff::series(form));
    series.extend(singular::series());
    series.extend(paper_mechanism::series(form));
    series.extend(ratios::series(form));
    series.extend(large_groups::series(form));
    series.extend(jamming::series());
    series
}

/// Computes all cells.
pub fn evaluate(series: Vec<ParameterSeries>) -> Vec<SeriesResult> {
    let row = |series: ParameterSeries| {
        let cells = series.values.par_iter().flat_map(|&at| series.evaluate(at));
        SeriesResult {
            cells: cells.collect(),
            series,
        }
    };
    series.into_par_iter().map(row).collect()
}
