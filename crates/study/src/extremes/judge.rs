//! The verdict on the grid.

use super::grid::{Cell, ILL_CONDITIONED, MOST_CELLS, MOST_TIMES, Measured};
use dwell_findings::Finding;

/// What the floors rest on, and what the estimates do.
const FLOOR: &str = "extremes: closed forms in 32 digits";
const ESTIMATE: &str = "extremes: true errors in 32 digits";

/// The findings: of each row its floor and the safe side of its estimates, and of all rows how near the
/// estimates are.
pub fn judge(grid: &[Measured]) -> Vec<Finding> {
    let mut findings: Vec<Finding> = grid.iter().flat_map(|m| [floor(m), safe(m)]).collect();
    findings.push(near(grid));
    findings
}

fn place(measured: &Measured, cell: &Cell) -> String {
    let row = &measured.row;
    format!(
        "{} = {:e} {}, {}",
        row.parameter.0, cell.at, row.parameter.1, row.quantities[cell.quantity]
    )
}

/// The cell with the most of something, and how much that is.
fn worst(measured: &Measured, of: impl Fn(&Cell) -> Option<f64>) -> Option<(f64, &Cell)> {
    let all = measured.cells.iter().filter_map(|c| Some((of(c)?, c)));
    all.max_by(|a, b| a.0.total_cmp(&b.0))
}

fn finding(measured: &Measured, key: &str) -> Finding {
    let row = &measured.row;
    let from = row.values.iter().fold(f64::INFINITY, |a, &b| a.min(b));
    let to = row.values.iter().fold(0.0_f64, |a, &b| a.max(b));
    Finding {
        key: format!("{}-{key}", row.key),
        truth: FLOOR.to_owned(),
        compared: format!("{}: {}", row.what, row.truth),
        over: format!(
            "{} from {from:e} to {to:e} {}",
            row.parameter.0, row.parameter.1
        ),
        absolute: 0.0,
        unit: String::new(),
        relative: 0.0,
        scale: String::new(),
        worst: String::new(),
        tolerance: 1.0,
        why: row.why.to_owned(),
        ..Finding::default()
    }
}

/// Whether every cell keeps its floor, or is a typed error where the condition is bad.
fn floor(measured: &Measured) -> Finding {
    // Errors over what the floor allows; an error that is not allowed is as bad as can be.
    let beyond = |cell: &Cell| match cell.digits() {
        Some(digits) => Some(10.0_f64.powf(cell.stated.floor - digits)),
        None if cell.holds() => None,
        None => Some(f64::INFINITY),
    };
    let found = worst(measured, beyond);
    let relative = found.as_ref().map_or(0.0, |w| w.0);
    let told = found.map_or(String::new(), |(_, cell)| match &cell.told {
        Ok(_) => place(measured, cell),
        Err(error) => format!("{}: {error}", place(measured, cell)),
    });
    Finding {
        absolute: relative,
        relative,
        scale: format!(
            "the error that the floor allows; typed errors only where the condition is above {ILL_CONDITIONED:e}"
        ),
        worst: told,
        pass: measured.cells.iter().all(Cell::holds) && !measured.cells.is_empty(),
        ..finding(measured, "floor")
    }
}

/// Whether no estimate is below the true error.
fn safe(measured: &Measured) -> Finding {
    let found = worst(measured, |cell| cell.ratio().map(|ratio| 1.0 / ratio));
    let relative = found.as_ref().map_or(0.0, |w| w.0);
    Finding {
        truth: ESTIMATE.to_owned(),
        absolute: relative,
        relative,
        scale: "the estimated error".to_owned(),
        worst: found.map_or(String::new(), |(_, cell)| place(measured, cell)),
        why: "an estimate below the true error would be a silent wrong number".to_owned(),
        pass: relative <= 1.0,
        ..finding(measured, "estimate")
    }
}

/// Whether the estimates are within a hundred times the true errors, in nearly all cells.
fn near(grid: &[Measured]) -> Finding {
    let ratios: Vec<f64> = grid
        .iter()
        .flat_map(|m| m.cells.iter().filter_map(Cell::ratio))
        .collect();
    let outside = |ratio: &&f64| !(1.0..=MOST_TIMES).contains(*ratio);
    let share = ratios.iter().filter(outside).count() as f64 / ratios.len().max(1) as f64;
    let allowed = 1.0 - MOST_CELLS;
    Finding {
        key: "estimates".to_owned(),
        truth: ESTIMATE.to_owned(),
        compared: "estimated errors within 1 and 100 times the true ones".to_owned(),
        over: "all cells of the grid that hold a result".to_owned(),
        absolute: share,
        unit: String::new(),
        relative: share,
        scale: "the cells".to_owned(),
        worst: String::new(),
        tolerance: allowed,
        why: "an estimate that is often far too large says nothing; now and then an error is small by chance".to_owned(),
        pass: !ratios.is_empty() && share <= allowed,
        ..Finding::default()
    }
}
