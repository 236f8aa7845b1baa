//! The findings of the grid.

use super::series::{
    MAX_ESTIMATE_RATIO, MIN_ILL_CONDITIONED, REQUIRED_CELL_FRACTION, ResultCell, SeriesResult,
};
use dwell_findings::{Check, Finding};
use dwell_study::ranges::extent;

/// The findings: for each row whether it keeps its required digits and its estimates are safe, and for all rows the ratio of
/// estimates to errors.
pub fn check(results: &[SeriesResult]) -> Vec<Finding> {
    let mut findings: Vec<Finding> = results
        .iter()
        .flat_map(|m| [check_digits(m), check_estimates(m)])
        .collect();
    findings.push(check_estimate_ratios(results));
    findings
}

/// The cell with the largest value of a function, and that value.
fn cell_with_max(
    result: &SeriesResult,
    of: impl Fn(&ResultCell) -> Option<f64>,
) -> Option<(f64, &ResultCell)> {
    let all = result.cells.iter().filter_map(|c| Some((of(c)?, c)));
    all.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// A finding on a row, relative to the allowed value, with the largest value and its cell.
fn row_finding(result: &SeriesResult, key: &str, max: Option<(f64, &ResultCell)>) -> Finding {
    let series = &result.series;
    let [from, to] = extent(series.values.iter().copied());
    let (parameter, unit) = series.parameter;
    let location = |(_, cell): (f64, &ResultCell)| {
        let error = cell.result.as_ref().err().map(|error| format!(": {error}"));
        let (value, quantity) = (cell.parameter, series.quantities[cell.quantity]);
        let error = error.unwrap_or_default();
        format!("{parameter} = {value:e} {unit}, {quantity}{error}")
    };
    let largest = max.map_or(0.0, |(largest, _)| largest);
    let key = format!("{}-{key}", series.key);
    Finding {
        comparison: format!("{}: {}", series.description, series.reference),
        domain: format!("{parameter} from {from:e} to {to:e} {unit}"),
        worst_at: max.map(location).unwrap_or_default(),
        tolerance_reason: series.reason.to_owned(),
        ..Finding::new(&key, Check::ClosedForms, [largest; 2], 1.0)
    }
}

/// Whether every cell keeps its required digits, or is a typed error if the condition number permits that.
pub(super) fn check_digits(result: &SeriesResult) -> Finding {
    // Errors relative to the allowed ones; a typed error that is not permitted counts as infinite.
    let excess = |cell: &ResultCell| match cell.digits() {
        // If the condition number leaves no digits, none is required.
        Some(_) if cell.requirement.min_digits <= 0.0 => None,
        Some(digits) => Some(10.0_f64.powf(cell.requirement.min_digits - digits)),
        None if cell.meets_requirement() => None,
        None => Some(f64::INFINITY),
    };
    Finding {
        scale: format!(
            "the error that the floor allows; typed errors only where the condition is above {MIN_ILL_CONDITIONED:e}"
        ),
        pass: result.cells.iter().all(ResultCell::meets_requirement) && !result.cells.is_empty(),
        ..row_finding(result, "digits", cell_with_max(result, excess))
    }
}

/// Whether no estimate is below the true error.
pub(super) fn check_estimates(result: &SeriesResult) -> Finding {
    let largest = cell_with_max(result, |cell| Some(1.0 / cell.estimate_ratio()?));
    Finding {
        scale: "the estimated error".to_owned(),
        tolerance_reason: "an estimate below the true error would hide a wrong number".to_owned(),
        ..row_finding(result, "error-estimate", largest)
    }
}

/// Whether the estimates are at most a hundred times the true errors, in nearly all cells.
fn check_estimate_ratios(results: &[SeriesResult]) -> Finding {
    let cells = results.iter().flat_map(|m| &m.cells);
    let ratios: Vec<f64> = cells.filter_map(ResultCell::estimate_ratio).collect();
    let outside = |ratio: &&f64| !(1.0..=MAX_ESTIMATE_RATIO).contains(*ratio);
    let share = ratios.iter().filter(outside).count() as f64 / ratios.len().max(1) as f64;
    let allowed = 1.0 - REQUIRED_CELL_FRACTION;
    Finding {
        comparison: "estimated errors within 1 and 100 times the true ones".to_owned(),
        domain: "all cells of the grid that hold a result".to_owned(),
        scale: "the cells".to_owned(),
        tolerance_reason: "an estimate that is often far too large says nothing; now and then an error is small by chance".to_owned(),
        pass: !ratios.is_empty() && share <= allowed,
        ..Finding::new("error-estimates", Check::ClosedForms, [share; 2], allowed)
    }
}
