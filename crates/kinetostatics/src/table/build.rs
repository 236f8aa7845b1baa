//! Builds the parts of tables: curves from their slopes and columns side by side, over one domain and to one
//! accuracy.

use super::bound::{self, Piecewise};
use super::piecewise::{Grid, IntegratedCurve, PiecewiseColumns};
use super::sizing::{self, RowSampler, Sizing};
use super::{Bound, Result, TableDomain, TableError, TableQuantity};
use crate::reduced::Inertia;
use dwell_geometry::Range;
use dwell_numerics::Dual;
use std::f64::consts::TAU;

/// Part of a limited range that is left out at each end, if no domain is given: the inertia grows as one
/// over the distance to a limit position, and everything is measured by its largest value.
const END_MARGIN: f64 = 0.02;
/// A coefficient that a period changes by more than this part of its scale is not periodic.
const PERIODICITY_TOLERANCE: f64 = 1e-9;
/// Points of comparison, as fractions of a period.
const PERIODICITY_POINTS: [f64; 5] = [0.0, 0.131, 0.292, 0.583, 0.877];

/// A function with exact derivatives, from which an [`IntegratedCurve`] is built.
pub trait SlopeSampler {
    /// The function, half its slope and half its second derivative at a coordinate.
    ///
    /// # Errors [`TableError::Exact`] if it has no value.
    fn sample(&mut self, q: f64) -> Result<Inertia>;

    /// The function and half its slope at many coordinates.
    ///
    /// # Errors [`TableError::Exact`] if it has no value.
    fn sample_many(&mut self, q: &[f64]) -> Result<Vec<[f64; 2]>> {
        let both = |&q: &f64| self.sample(q).map(|at| [at.m, at.half_dm]);
        q.iter().map(both).collect()
    }
}

/// Functions with exact derivatives at a coordinate, from which [`PiecewiseColumns`] are built.
pub type ColumnSampler<'a> = dyn FnMut(f64, &mut [Dual]) -> Result<()> + 'a;

/// Builds parts of one table, and records their error bounds.
#[derive(Debug)]
pub struct TableBuilder {
    grid: Grid,
    accuracy: f64,
    bounds: Vec<Bound>,
}

impl TableBuilder {
    /// For tables over a domain within a range, to an accuracy.
    ///
    /// # Errors
    /// [`TableError`] for a domain that is empty or unbounded, or an accuracy that cannot be kept.
    pub fn new(range: Range, domain: TableDomain, accuracy: f64) -> Result<Self> {
        if !(1e-14..=1e-2).contains(&accuracy) {
            return Err(TableError::Accuracy { accuracy });
        }
        Ok(Self {
            grid: domain_grid(range, domain)?,
            accuracy,
            bounds: Vec::new(),
        })
    }

    /// The domain of the tables, rad or m.
    pub fn domain(&self) -> [f64; 2] {
        self.grid.domain()
    }

    /// The period, rad, if there is one.
    pub fn period(&self) -> Option<f64> {
        (self.grid.revolutions > 0).then_some(self.grid.length)
    }

    /// A curve: a function and half its slope.
    ///
    /// # Errors
    /// [`TableError`] when it is not periodic, or the accuracy cannot be reached.
    pub fn curve(
        &mut self,
        quantities: [TableQuantity; 2],
        sampler: &mut dyn SlopeSampler,
    ) -> Result<IntegratedCurve> {
        // The function over a radian of a revolution, or that part of the domain, is of the kind of its half slope.
        let per_revolution = TAU / self.grid.length;
        let scale = |largest: &[f64]| {
            let weighted = [largest[0], largest[1] / per_revolution];
            let slope = sizing::scales(&weighted, &|_, _| 1.0)[1];
            vec![weighted[0], slope * per_revolution]
        };
        let mut values = |q: &[f64]| {
            let rows = sampler.sample_many(q)?.into_iter();
            Ok(rows.map(|at| at.to_vec()).collect())
        };
        let sizing = self.size(&quantities, &scale, &mut values)?;
        self.build(&quantities, &sizing, sampler, |grid, sampler| {
            IntegratedCurve::new(grid, sampler)
        })
    }

    /// Columns side by side. `relation` is the weight of the second of two quantities in the scale of the first: 1 if they are of one kind,
    /// 0 if they are unrelated.
    ///
    /// # Errors
    /// As [`TableBuilder::curve`].
    pub fn columns(
        &mut self,
        quantities: &[TableQuantity],
        relation: &dyn Fn(TableQuantity, TableQuantity) -> f64,
        sampler: &mut ColumnSampler<'_>,
    ) -> Result<PiecewiseColumns> {
        if quantities.is_empty() {
            return Ok(PiecewiseColumns::empty(self.grid));
        }
        let scale = |largest: &[f64]| {
            sizing::scales(largest, &|i, j| relation(quantities[i], quantities[j]))
        };
        let mut here = vec![Dual::default(); quantities.len()];
        let mut values = |q: &[f64]| {
            let mut row = |&q: &f64| {
                sampler(q, &mut here)?;
                Ok(here.iter().map(|here| here.v).collect())
            };
            q.iter().map(&mut row).collect()
        };
        let sizing = self.size(quantities, &scale, &mut values)?;
        let width = quantities.len();
        self.build(quantities, &sizing, sampler, |grid, sampler| {
            PiecewiseColumns::new(grid, width, sampler)
        })
    }

    /// The error bounds, in the order in which the parts were built.
    pub fn bounds(self) -> Vec<Bound> {
        self.bounds
    }

    fn size(
        &self,
        quantities: &[TableQuantity],
        scale: &dyn Fn(&[f64]) -> Vec<f64>,
        values: &mut RowSampler<'_>,
    ) -> Result<Sizing> {
        if self.grid.revolutions > 0 {
            require_periodic(self.grid, quantities, scale, values)?;
        }
        sizing::estimate_sizing(self.grid, quantities.len(), self.accuracy, scale, values)
    }

    /// Builds a part and records its error bounds.
    fn build<S: ?Sized, P: Piecewise<S>>(
        &mut self,
        quantities: &[TableQuantity],
        sizing: &Sizing,
        sampler: &mut S,
        build: impl Fn(Grid, &mut S) -> Result<P>,
    ) -> Result<P> {
        let Self { grid, accuracy, .. } = *self;
        let (part, errors) =
            bound::build_to_accuracy(grid, quantities, sizing, accuracy, sampler, build)?;
        let scaled = quantities.iter().zip(&sizing.scales).zip(errors);
        let bounds = scaled.map(|((&quantity, &scale), error)| Bound {
            quantity,
            scale,
            error,
        });
        self.bounds.extend(bounds);
        Ok(part)
    }
}

/// The domain as a grid of one cell.
fn domain_grid(range: Range, domain: TableDomain) -> Result<Grid> {
    let (from, to) = match (domain, range.period(), range.limits()) {
        (TableDomain::Full, Some(period), _) => {
            let revolutions = (period / TAU).round() as u32;
            return Ok(Grid::new(0.0, period, revolutions, 1));
        }
        (TableDomain::Full, None, None) => return Err(TableError::Unbounded),
        (TableDomain::Full, None, Some((from, to))) => {
            let margin = END_MARGIN * (to - from);
            (from + margin, to - margin)
        }
        (TableDomain::Between(from, to), _, limits) => {
            let inside = limits.is_none_or(|(lowest, highest)| lowest <= from && to <= highest);
            if !(inside && from < to && (to - from).is_finite()) {
                return Err(TableError::Domain { from, to });
            }
            (from, to)
        }
    };
    Ok(Grid::new(from, to - from, 0, 1))
}

/// Refuses coefficients that are not the same a period later.
fn require_periodic(
    grid: Grid,
    quantities: &[TableQuantity],
    scale: &dyn Fn(&[f64]) -> Vec<f64>,
    values: &mut RowSampler<'_>,
) -> Result<()> {
    let here = PERIODICITY_POINTS.map(|part| grid.from + part * grid.length);
    let later = here.map(|q| q + grid.length);
    let (here, later) = (values(&here)?, values(&later)?);
    let max = |k: usize, of: &dyn Fn(f64, f64) -> f64| {
        let pairs = here.iter().zip(&later);
        pairs.fold(0.0_f64, |max, (here, later)| max.max(of(here[k], later[k])))
    };
    let all = 0..quantities.len();
    let largest: Vec<f64> = all.clone().map(|k| max(k, &|here, _| here.abs())).collect();
    let difference = |k: usize| max(k, &|here, later| (here - later).abs());
    let scales = scale(&largest);
    let mut aperiodic = all.filter(|&k| difference(k) > PERIODICITY_TOLERANCE * scales[k]);
    let found = aperiodic.next().map(|k| quantities[k]);
    found.map_or(Ok(()), |what| Err(TableError::NotPeriodic { what }))
}
