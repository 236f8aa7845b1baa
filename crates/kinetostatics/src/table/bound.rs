//! How far a table is from the exact model: measured between the places it was made from, with a margin,
//! and measured again elsewhere.

use super::fit::{FEWEST_CELLS, Fit};
use super::make::{Fill, Slopes};
use super::pieces::{BETWEEN, Columns, Curve, Grid, TERMS};
use super::{Entry, TableError};
use dwell_geometry::Dual;

/// The bound is so many times the largest error met. Over all cases of validation/ the largest at 10 000
/// other points was 1.7 times that; where the rounding of the exact model decides most,
/// next to change points, 3.2 times.
const MARGIN: f64 = 4.0;
/// Points at which the pieces are looked at again, steps of the golden section: so many by cell, but no
/// fewer and no more than these.
const CHECKED_BY_CELL: usize = 32;
const FEWEST_CHECKED: usize = 256;
const MOST_CHECKED: usize = 4096;
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Most cells: 10 megabytes for m and ½m′.
pub(super) const MOST_CELLS: usize = 65_536;
/// Sizes that are tried.
const TRIES: usize = 10;
/// A table is made again with fewer cells if its bound is this part of the accuracy.
const GENEROUS: f64 = 0.05;

/// Something that can be made of any number of cells and held against what it is made from.
pub(super) trait Pieces<S: ?Sized>: Sized {
    /// It in cells.
    fn make(grid: Grid, width: usize, source: &mut S) -> Result<Self, TableError>;

    /// Its errors at some coordinates, each raised to `most` if larger.
    fn compare(&self, q: &[f64], source: &mut S, most: &mut [f64]) -> Result<(), TableError>;
}

impl<'a> Pieces<dyn Slopes + 'a> for Curve {
    fn make(grid: Grid, _: usize, source: &mut (dyn Slopes + 'a)) -> Result<Self, TableError> {
        Self::new(grid, source)
    }

    fn compare(
        &self,
        q: &[f64],
        source: &mut (dyn Slopes + 'a),
        most: &mut [f64],
    ) -> Result<(), TableError> {
        for (&q, exact) in q.iter().zip(source.many(q)?) {
            let own = self.at(q)?;
            raise(
                most,
                own.into_iter().zip(exact).map(|(own, exact)| own - exact),
            );
        }
        Ok(())
    }
}

impl<'a> Pieces<Fill<'a>> for Columns {
    fn make(grid: Grid, width: usize, source: &mut Fill<'a>) -> Result<Self, TableError> {
        Self::new(grid, width, source)
    }

    fn compare(
        &self,
        q: &[f64],
        source: &mut Fill<'a>,
        most: &mut [f64],
    ) -> Result<(), TableError> {
        let (mut exact, mut own) = (vec![Dual::default(); self.width], vec![0.0; self.width]);
        for &q in q {
            source(q, &mut exact)?;
            self.at(q, &mut own, &mut [])?;
            raise(
                most,
                own.iter().zip(&exact).map(|(own, exact)| own - exact.v),
            );
        }
        Ok(())
    }
}

fn raise(most: &mut [f64], errors: impl Iterator<Item = f64>) {
    for (most, error) in most.iter_mut().zip(errors) {
        // An error that is not a number is the largest there is.
        let error = if error.is_nan() {
            f64::INFINITY
        } else {
            error.abs()
        };
        *most = most.max(error);
    }
}

/// The smallest table met whose bound is within the accuracy, and the bounds by entry, as parts of the
/// scales.
pub(super) fn size<S: ?Sized, P: Pieces<S>>(
    grid: Grid,
    which: &[Entry],
    fit: &Fit,
    accuracy: f64,
    source: &mut S,
) -> Result<(P, Vec<f64>), TableError> {
    let mut cells = fit.cells;
    let mut best: Option<(P, Vec<f64>, usize)> = None;
    let mut least = (f64::INFINITY, Entry::M);
    for _ in 0..TRIES {
        if cells > MOST_CELLS {
            break;
        }
        let grid = grid.with(cells);
        let pieces = P::make(grid, which.len(), source)?;
        let bounds = bounds(&pieces, grid, fit, source)?;
        let worst = worst(&bounds, which);
        if worst.0 < least.0 {
            least = worst;
        }
        let part = worst.0 / accuracy;
        let enough = part <= 1.0;
        if enough && best.as_ref().is_none_or(|(.., known)| cells < *known) {
            best = Some((pieces, bounds, cells));
        }
        // The error goes as the size of a cell to the number of terms; aimed at is half the accuracy.
        let next = cells as f64 * (2.0 * part).powf(1.0 / TERMS as f64);
        let next = (next.ceil() as usize).max(FEWEST_CELLS);
        cells = match (enough, &best) {
            (true, _) if part > GENEROUS || next >= cells => break,
            (true, _) => next,
            // One that was too small follows one that was large enough.
            (false, Some(_)) => break,
            (false, None) => next.max(cells + cells / 8 + 1),
        };
    }
    match best {
        Some((pieces, bounds, _)) => Ok((pieces, bounds)),
        None => Err(TableError::NotReached {
            what: least.1,
            reached: least.0,
            accuracy,
        }),
    }
}

/// The bounds by entry as parts of the scales: from points between the nodes of every cell, and others.
fn bounds<S: ?Sized, P: Pieces<S>>(
    pieces: &P,
    grid: Grid,
    fit: &Fit,
    source: &mut S,
) -> Result<Vec<f64>, TableError> {
    let mut most = vec![0.0; fit.scales.len()];
    let cells = 0..grid.cells;
    let between = cells.flat_map(|cell| BETWEEN.map(|x| grid.coordinate(cell, x)));
    let others = (CHECKED_BY_CELL * grid.cells).clamp(FEWEST_CHECKED, MOST_CHECKED);
    let elsewhere = (0..others).map(|i| {
        let part = (0.5 + i as f64 * GOLDEN).fract();
        grid.from + grid.length * part
    });
    let places: Vec<f64> = between.chain(elsewhere).collect();
    pieces.compare(&places, source, &mut most)?;
    let bound = |(&most, &scale): (&f64, &f64)| match most {
        0.0 => 0.0,
        most => MARGIN * most / scale,
    };
    Ok(most.iter().zip(&fit.scales).map(bound).collect())
}

fn worst(bounds: &[f64], which: &[Entry]) -> (f64, Entry) {
    let all = bounds.iter().copied().zip(which.iter().copied());
    all.fold(
        (0.0, Entry::M),
        |worst, one| {
            if one.0 <= worst.0 { worst } else { one }
        },
    )
}
