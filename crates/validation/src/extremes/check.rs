//! The verdict on the grid.

use super::series::{
    MAX_ESTIMATE_RATIO, MIN_ILL_CONDITIONED, REQUIRED_CELL_FRACTION, ResultCell, SeriesResult,
};
use dwell_findings::{Check, Finding};

/// The findings: of each row its floor and the safe side of its estimates, and of all rows how near the
/// estimates are.
pub fn check(results: &[SeriesResult]) -> Vec<Finding> {
    let mut findings: Vec<Finding> = results
        .iter()
        .flat_map(|m| [check_digits(m), check_estimates(m)])
        .collect();
    findings.push(check_estimate_ratios(results));
    findings
}

fn location(result: &SeriesResult, cell: &ResultCell) -> String {
    let series = &result.series;
    format!(
        "{} = {:e} {}, {}",
        series.parameter.0, cell.parameter, series.parameter.1, series.quantities[cell.quantity]
    )
}

/// The cell with the most of something, and how much that is.
fn cell_with_max(
    result: &SeriesResult,
    of: impl Fn(&ResultCell) -> Option<f64>,
) -> Option<(f64, &ResultCell)> {
    let all = result.cells.iter().filter_map(|c| Some((of(c)?, c)));
    all.max_by(|a, b| a.0.total_cmp(&b.0))
}

fn base_finding(result: &SeriesResult, key: &str) -> Finding {
    let series = &result.series;
    let from = series.values.iter().fold(f64::INFINITY, |a, &b| a.min(b));
    let to = series.values.iter().fold(0.0_f64, |a, &b| a.max(b));
    Finding {
        key: format!("{}-{key}", series.key),
        check: Check::ClosedForms,
        comparison: format!("{}: {}", series.description, series.reference),
        domain: format!(
            "{} from {from:e} to {to:e} {}",
            series.parameter.0, series.parameter.1
        ),
        absolute_difference: 0.0,
        unit: String::new(),
        relative_difference: 0.0,
        scale: String::new(),
        worst_at: String::new(),
        tolerance: 1.0,
        tolerance_reason: series.reason.to_owned(),
        ..Finding::default()
    }
}

/// Whether every cell keeps its floor, or is a typed error where the condition is bad.
fn check_digits(result: &SeriesResult) -> Finding {
    // Errors over what the floor allows; an error that is not allowed is as bad as can be.
    let excess = |cell: &ResultCell| match cell.digits() {
        Some(digits) => Some(10.0_f64.powf(cell.requirement.min_digits - digits)),
        None if cell.meets_requirement() => None,
        None => Some(f64::INFINITY),
    };
    let found = cell_with_max(result, excess);
    let relative = found.as_ref().map_or(0.0, |w| w.0);
    let location_text = found.map_or(String::new(), |(_, cell)| match &cell.result {
        Ok(_) => location(result, cell),
        Err(error) => format!("{}: {error}", location(result, cell)),
    });
    Finding {
        absolute_difference: relative,
        relative_difference: relative,
        scale: format!(
            "the error that the floor allows; typed errors only where the condition is above {MIN_ILL_CONDITIONED:e}"
        ),
        worst_at: location_text,
        pass: result.cells.iter().all(ResultCell::meets_requirement) && !result.cells.is_empty(),
        ..base_finding(result, "digits")
    }
}

/// Whether no estimate is below the true error.
fn check_estimates(result: &SeriesResult) -> Finding {
    let found = cell_with_max(result, |cell| {
        cell.estimate_ratio().map(|ratio| 1.0 / ratio)
    });
    let relative = found.as_ref().map_or(0.0, |w| w.0);
    Finding {
        absolute_difference: relative,
        relative_difference: relative,
        scale: "the estimated error".to_owned(),
        worst_at: found.map_or(String::new(), |(_, cell)| location(result, cell)),
        tolerance_reason: "an estimate below the true error would hide a wrong number".to_owned(),
        pass: relative <= 1.0,
        ..base_finding(result, "error-estimate")
    }
}

/// Whether the estimates are within a hundred times the true errors, in nearly all cells.
fn check_estimate_ratios(results: &[SeriesResult]) -> Finding {
    let ratios: Vec<f64> = results
        .iter()
        .flat_map(|m| m.cells.iter().filter_map(ResultCell::estimate_ratio))
        .collect();
    let outside = |ratio: &&f64| !(1.0..=MAX_ESTIMATE_RATIO).contains(*ratio);
    let share = ratios.iter().filter(outside).count() as f64 / ratios.len().max(1) as f64;
    let allowed = 1.0 - REQUIRED_CELL_FRACTION;
    Finding {
        key: "error-estimates".to_owned(),
        check: Check::ClosedForms,
        comparison: "estimated errors within 1 and 100 times the true ones".to_owned(),
        domain: "all cells of the grid that hold a result".to_owned(),
        absolute_difference: share,
        unit: String::new(),
        relative_difference: share,
        scale: "the cells".to_owned(),
        worst_at: String::new(),
        tolerance: allowed,
        tolerance_reason: "an estimate that is often far too large says nothing; now and then an error is small by chance".to_owned(),
        pass: !ratios.is_empty() && share <= allowed,
        ..Finding::default()
    }
}
