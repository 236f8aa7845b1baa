//! Error bounds of a table against the exact model: measured between the points it was built from and at further
//! points, with a safety factor.

use super::build::{ColumnSampler, SlopeSampler};
use super::piecewise::{BETWEEN_NODES, Grid, IntegratedCurve, PiecewiseColumns, TERMS};
use super::sizing::{MIN_CELLS, Sizing};
use super::{Result, TableError, TableQuantity};
use dwell_numerics::Dual;

/// Ratio of the bound to the largest error found. Over all cases of validation/ the largest at 10 000
/// other points was 1.7 times that; where the rounding of the exact model decides most,
/// next to change points, 3.2 times.
const SAFETY_FACTOR: f64 = 4.0;
/// Further points at which the errors are measured, at steps of the golden section: a number for each cell, within
/// these bounds.
const CHECK_POINTS_PER_CELL: usize = 32;
const MIN_CHECK_POINTS: usize = 256;
const MAX_CHECK_POINTS: usize = 4096;
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Highest number of cells: 10 megabytes for m and ½m′.
pub(super) const MAX_CELLS: usize = 65_536;
/// Sizes that are tried.
const MAX_ATTEMPTS: usize = 10;
/// A table is built again with fewer cells if its bound is below this part of the accuracy.
const OVERSIZED: f64 = 0.05;

/// A part of a table that can be compared with its sampler.
pub(super) trait Piecewise<S: ?Sized> {
    /// Raises `max_errors` to its errors at some coordinates where these are larger.
    fn raise_errors(&self, q: &[f64], source: &mut S, most: &mut [f64]) -> Result<()>;
}

impl<'a> Piecewise<dyn SlopeSampler + 'a> for IntegratedCurve {
    fn raise_errors(
        &self,
        q: &[f64],
        sampler: &mut (dyn SlopeSampler + 'a),
        max_errors: &mut [f64],
    ) -> Result<()> {
        for (&q, exact) in q.iter().zip(sampler.sample_many(q)?) {
            let tabulated = self.eval(q)?;
            let pairs = tabulated.into_iter().zip(exact);
            let errors = pairs.map(|(tabulated, exact)| tabulated - exact);
            raise_to(max_errors, errors);
        }
        Ok(())
    }
}

impl<'a> Piecewise<ColumnSampler<'a>> for PiecewiseColumns {
    fn raise_errors(
        &self,
        q: &[f64],
        sampler: &mut ColumnSampler<'a>,
        max_errors: &mut [f64],
    ) -> Result<()> {
        let (mut exact, mut tabulated) = (vec![Dual::default(); self.width], vec![0.0; self.width]);
        for &q in q {
            sampler(q, &mut exact)?;
            self.eval(q, &mut tabulated, &mut [])?;
            let pairs = tabulated.iter().zip(&exact);
            let errors = pairs.map(|(tabulated, exact)| tabulated - exact.v);
            raise_to(max_errors, errors);
        }
        Ok(())
    }
}

fn raise_to(max_errors: &mut [f64], errors: impl Iterator<Item = f64>) {
    for (max_errors, error) in max_errors.iter_mut().zip(errors) {
        // NaN counts as the largest error.
        let finite = !error.is_nan();
        *max_errors = max_errors.max(if finite { error.abs() } else { f64::INFINITY });
    }
}

/// The smallest table tried whose bound is within the accuracy, and the bounds by quantity, as parts of the
/// scales.
pub(super) fn build_to_accuracy<S: ?Sized, P: Piecewise<S>>(
    grid: Grid,
    quantities: &[TableQuantity],
    sizing: &Sizing,
    accuracy: f64,
    sampler: &mut S,
    build: impl Fn(Grid, &mut S) -> Result<P>,
) -> Result<(P, Vec<f64>)> {
    let mut cells = sizing.cells;
    let mut best: Option<(P, Vec<f64>, usize)> = None;
    let mut smallest = (f64::INFINITY, TableQuantity::M);
    for _ in 0..MAX_ATTEMPTS {
        if cells > MAX_CELLS {
            break;
        }
        let grid = grid.with_cells(cells);
        let piecewise = build(grid, sampler)?;
        let bounds = bounds(&piecewise, grid, sizing, sampler)?;
        let largest = largest_bound(&bounds, quantities);
        if largest.0 < smallest.0 {
            smallest = largest;
        }
        let part = largest.0 / accuracy;
        let enough = part <= 1.0;
        if enough && best.as_ref().is_none_or(|(.., known)| cells < *known) {
            best = Some((piecewise, bounds, cells));
        }
        // The error is proportional to the cell's size to the power of the number of terms; half the accuracy is aimed at.
        let wanted = cells as f64 * (2.0 * part).powf(1.0 / TERMS as f64);
        let next = (wanted.ceil() as usize).max(MIN_CELLS);
        cells = match (enough, &best) {
            (true, _) if part > OVERSIZED || next >= cells => break,
            (true, _) => next,
            // A smaller one after one that was large enough does not reach the accuracy.
            (false, Some(_)) => break,
            (false, None) => next.max(cells + cells / 8 + 1),
        };
    }
    match best {
        Some((piecewise, bounds, _)) => Ok((piecewise, bounds)),
        // The samples ask for too many cells, or miss where most of a function is.
        None if smallest.0 >= 1.0 => Err(TableError::TooNarrow { most: MAX_CELLS }),
        None => Err(TableError::NotReached {
            what: smallest.1,
            reached: smallest.0,
            accuracy,
        }),
    }
}

/// The bounds by quantity as parts of the scales: from points between the nodes of every cell, and others.
fn bounds<S: ?Sized, P: Piecewise<S>>(
    piecewise: &P,
    grid: Grid,
    sizing: &Sizing,
    sampler: &mut S,
) -> Result<Vec<f64>> {
    let mut max_errors = vec![0.0; sizing.scales.len()];
    let cells = 0..grid.cells;
    let between = cells.flat_map(|cell| BETWEEN_NODES.map(|x| grid.coordinate(cell, x)));
    let others = (CHECK_POINTS_PER_CELL * grid.cells).clamp(MIN_CHECK_POINTS, MAX_CHECK_POINTS);
    let elsewhere = (0..others).map(|i| {
        let part = (0.5 + i as f64 * GOLDEN).fract();
        grid.from + grid.length * part
    });
    let coordinates: Vec<f64> = between.chain(elsewhere).collect();
    piecewise.raise_errors(&coordinates, sampler, &mut max_errors)?;
    let bound = |(&max_errors, &scale): (&f64, &f64)| match max_errors {
        0.0 => 0.0,
        max_errors => SAFETY_FACTOR * max_errors / scale,
    };
    Ok(max_errors.iter().zip(&sizing.scales).map(bound).collect())
}

fn largest_bound(bounds: &[f64], quantities: &[TableQuantity]) -> (f64, TableQuantity) {
    let all = bounds.iter().copied().zip(quantities.iter().copied());
    all.fold((0.0, TableQuantity::M), |largest, one| {
        if one.0 <= largest.0 { largest } else { one }
    })
}
