//! Makes the parts of tables: curves from their slopes and columns side by side, over one extent and to one
//! accuracy.

use super::bound;
use super::fit::{self, Fit, Values};
use super::pieces::{Columns, Curve, Grid};
use super::{Bound, Entry, Extent, TableError};
use crate::reduced::Inertia;
use dwell_geometry::{Dual, Range};
use std::f64::consts::TAU;

/// Part of a limited range that is left out at each end, if no extent is given: the inertia grows as one
/// over the distance to a limit position, and everything is measured by its largest value.
const LEFT_OUT: f64 = 0.02;
/// A coefficient that a whole turn changes by more than this part of its scale does not come back.
const SAME: f64 = 1e-9;
/// Where they are compared, in parts of a period.
const COMPARED: [f64; 5] = [0.0, 0.131, 0.292, 0.583, 0.877];

/// A function with exact derivatives, to make a [`Curve`] from.
pub trait Slopes {
    /// The function, half its slope and half its second derivative at a coordinate.
    ///
    /// # Errors
    /// [`TableError::Exact`] where it has no value.
    fn at(&mut self, q: f64) -> Result<Inertia, TableError>;

    /// The function and half its slope at many coordinates.
    ///
    /// # Errors
    /// [`TableError::Exact`] where it has no value.
    fn many(&mut self, q: &[f64]) -> Result<Vec<[f64; 2]>, TableError> {
        let both = |&q: &f64| self.at(q).map(|at| [at.m, at.half_dm]);
        q.iter().map(both).collect()
    }
}

/// Functions with exact derivatives at a coordinate, to make [`Columns`] from.
pub type Fill<'a> = dyn FnMut(f64, &mut [Dual]) -> Result<(), TableError> + 'a;

/// Makes parts of one table, and takes down how far each is off.
#[derive(Debug)]
pub struct Maker {
    grid: Grid,
    accuracy: f64,
    bounds: Vec<Bound>,
}

impl Maker {
    /// For tables over an extent of a range, to an accuracy.
    ///
    /// # Errors
    /// [`TableError`] when there is nothing to reach over, or the accuracy cannot be kept.
    pub fn new(range: Range, extent: Extent, accuracy: f64) -> Result<Self, TableError> {
        if !(1e-14..=1e-2).contains(&accuracy) {
            return Err(TableError::Accuracy { accuracy });
        }
        Ok(Self {
            grid: reach(range, extent)?,
            accuracy,
            bounds: Vec::new(),
        })
    }

    /// From where to where the tables reach, rad or m.
    pub fn extent(&self) -> [f64; 2] {
        let Grid { from, length, .. } = self.grid;
        [from, from + length]
    }

    /// After how many radians everything comes back, if it does.
    pub fn period(&self) -> Option<f64> {
        (self.grid.turns > 0).then_some(self.grid.length)
    }

    /// A curve: a function and half its slope.
    ///
    /// # Errors
    /// [`TableError`] when it does not come back after a turn, or the accuracy cannot be reached.
    pub fn curve(
        &mut self,
        which: [Entry; 2],
        source: &mut dyn Slopes,
    ) -> Result<Curve, TableError> {
        // The function over a radian of a turn, or as much of an extent, is of the kind of its half slope.
        let per_turn = TAU / self.grid.length;
        let scale = |largest: &[f64]| {
            let weighed = [largest[0], largest[1] / per_turn];
            let slope = fit::scales(&weighed, &|_, _| true)[1];
            vec![weighed[0], slope * per_turn]
        };
        let mut values =
            |q: &[f64]| Ok(source.many(q)?.into_iter().map(|at| at.to_vec()).collect());
        let fit = self.fit(&which, &scale, &mut values)?;
        let made =
            bound::size::<dyn Slopes, Curve>(self.grid, &which, &fit, self.accuracy, source)?;
        Ok(self.note(&which, &fit, made))
    }

    /// Columns side by side; `alike` says which are of one kind.
    ///
    /// # Errors
    /// As [`Maker::curve`].
    pub fn columns(
        &mut self,
        which: &[Entry],
        alike: &dyn Fn(Entry, Entry) -> bool,
        source: &mut Fill<'_>,
    ) -> Result<Columns, TableError> {
        if which.is_empty() {
            return Ok(Columns::none(self.grid));
        }
        let scale = |largest: &[f64]| fit::scales(largest, &|i, j| alike(which[i], which[j]));
        let mut here = vec![Dual::default(); which.len()];
        let mut values = |q: &[f64]| {
            let mut row = |&q: &f64| {
                source(q, &mut here)?;
                Ok(here.iter().map(|here| here.v).collect())
            };
            q.iter().map(&mut row).collect()
        };
        let fit = self.fit(which, &scale, &mut values)?;
        let made = bound::size::<Fill<'_>, Columns>(self.grid, which, &fit, self.accuracy, source)?;
        Ok(self.note(which, &fit, made))
    }

    /// How far each part may be off, in the order in which they were made.
    pub fn bounds(self) -> Vec<Bound> {
        self.bounds
    }

    fn fit(
        &self,
        which: &[Entry],
        scale: &dyn Fn(&[f64]) -> Vec<f64>,
        values: &mut Values<'_>,
    ) -> Result<Fit, TableError> {
        if self.grid.turns > 0 {
            comes_back(self.grid, which, scale, values)?;
        }
        fit::fit(self.grid, which.len(), self.accuracy, scale, values)
    }

    /// Takes down the bounds of what was made.
    fn note<P>(&mut self, which: &[Entry], fit: &Fit, (pieces, errors): (P, Vec<f64>)) -> P {
        let known = which.iter().zip(&fit.scales).zip(errors);
        self.bounds
            .extend(known.map(|((&of, &scale), error)| Bound { of, scale, error }));
        pieces
    }
}

/// The extent as a grid of one cell.
fn reach(range: Range, extent: Extent) -> Result<Grid, TableError> {
    let (from, to) = match (extent, range.period(), range.limits()) {
        (Extent::Whole, Some(period), _) => {
            let turns = (period / TAU).round() as u32;
            return Ok(Grid::new(0.0, period, turns, 1));
        }
        (Extent::Whole, None, None) => return Err(TableError::Endless),
        (Extent::Whole, None, Some((from, to))) => {
            let margin = LEFT_OUT * (to - from);
            (from + margin, to - margin)
        }
        (Extent::Between(from, to), _, limits) => {
            let inside = limits.is_none_or(|(lowest, highest)| lowest <= from && to <= highest);
            if !(inside && from < to && (to - from).is_finite()) {
                return Err(TableError::Extent { from, to });
            }
            (from, to)
        }
    };
    Ok(Grid::new(from, to - from, 0, 1))
}

/// Refuses coefficients that are not the same a period later.
fn comes_back(
    grid: Grid,
    which: &[Entry],
    scale: &dyn Fn(&[f64]) -> Vec<f64>,
    values: &mut Values<'_>,
) -> Result<(), TableError> {
    let here = COMPARED.map(|part| grid.from + part * grid.length);
    let later = here.map(|q| q + grid.length);
    let (here, later) = (values(&here)?, values(&later)?);
    let most = |k: usize, of: &dyn Fn(f64, f64) -> f64| {
        let pairs = here.iter().zip(&later);
        pairs.fold(0.0_f64, |most, (here, later)| {
            most.max(of(here[k], later[k]))
        })
    };
    let largest: Vec<f64> = (0..which.len())
        .map(|k| most(k, &|here, _| here.abs()))
        .collect();
    let apart = |k: usize| most(k, &|here, later| (here - later).abs());
    let scales = scale(&largest);
    let gone = (0..which.len()).find(|&k| apart(k) > SAME * scales[k]);
    match gone {
        Some(k) => Err(TableError::NotPeriodic { what: which[k] }),
        None => Ok(()),
    }
}
