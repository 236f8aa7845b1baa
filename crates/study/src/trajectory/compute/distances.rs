//! Distances of quantities along a trajectory from a table of the values that they should have.

use crate::trajectory::compute::along::{Curve, CurveSearch};
use crate::trajectory::compute::{Point, RowEvaluator, Signal, highest_between};
use dwell_numerics::root;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Distance of the positions that give a tangent, in completed fractions.
const TANGENT: f64 = 1e-6;

/// The distance of some quantities from the rows of a table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Distance {
    /// The quantity at whose value a row counts; without one a row counts where the others are nearest to it.
    pub(crate) at: Option<(Signal, Arc<[f64]>)>,
    /// The quantities, each with its values by row.
    pub(crate) of: Vec<(Signal, Arc<[f64]>)>,
    /// Whether they are angles, which are compared without whole revolutions.
    pub(crate) are_angles: bool,
}

impl Distance {
    /// The values of row `k`.
    fn row(&self, k: usize) -> Vec<f64> {
        self.of.iter().map(|(_, values)| values[k]).collect()
    }

    /// Differences of values from wanted ones.
    fn differences(&self, values: &[f64], wanted: &[f64]) -> Vec<f64> {
        let difference = |(value, wanted): (&f64, &f64)| {
            let off = value - wanted;
            match self.are_angles {
                true => off - TAU * (off / TAU).round(),
                false => off,
            }
        };
        values.iter().zip(wanted).map(difference).collect()
    }
}

impl<E: RowEvaluator> CurveSearch<'_, E> {
    /// The distances from all rows; `None` if one is beyond the trajectory.
    pub(super) fn distances(&mut self, of: &Distance, curves: &[Curve]) -> Option<Vec<f64>> {
        let signals = of.at.iter().chain(&of.of).map(|(signal, _)| signal);
        let curve = |signal: &Signal| curves.iter().find(|curve| curve.signal == *signal);
        let all: Vec<&Curve> = signals.filter_map(curve).collect();
        let quantities = all.iter().flat_map(|curve| curve.signal.quantities());
        self.evaluator.limit_to(quantities);
        let (_, wanted) = of.of.first()?;
        let rows = 0..wanted.len();
        match &of.at {
            Some((_, values)) => {
                let (at, curves) = all.split_first()?;
                rows.map(|k| self.timed(of, k, values[k], at, curves))
                    .collect()
            }
            None => rows.map(|k| self.nearest(of, k, &all)).collect(),
        }
    }

    /// The distance from row `k` where a curve has a value.
    fn timed(
        &mut self,
        of: &Distance,
        k: usize,
        value: f64,
        at: &Curve,
        curves: &[&Curve],
    ) -> Option<f64> {
        let pairs = at.points.windows(2);
        let encloses = |pair: &&[Point]| (pair[0][1] - value) * (pair[1][1] - value) <= 0.0;
        let around = pairs.clone().find(encloses)?;
        let mut off = |u: f64| {
            self.values(u, &[at])
                .map(|found| found[0] - value)
                .ok_or(())
        };
        let u = root::find(&mut off, around[0][0], around[1][0]).ok()??;
        let found = self.values(u, curves)?;
        Some(norm(&of.differences(&found, &of.row(k))))
    }

    /// The distance from row `k` to the nearest position.
    fn nearest(&mut self, of: &Distance, k: usize, curves: &[&Curve]) -> Option<f64> {
        let wanted = of.row(k);
        let nearness = |values: &[f64]| -norm(&of.differences(values, &wanted)).powi(2);
        let first = curves.first()?;
        let points = first.points.iter().enumerate().map(|(row, [u, _])| {
            let values: Vec<f64> = curves.iter().map(|curve| curve.points[row][1]).collect();
            [*u, nearness(&values)]
        });
        let points: Vec<Point> = points.collect();
        let mut value = |u: f64| self.values(u, curves).map(|values| nearness(&values));
        let [u, square] = highest_between(&points, &mut value)?;
        let distance = (-square).sqrt();
        // The place is known to half of the digits: the part along the tangent is left out, unless the nearest position is an end.
        let sides = [u - TANGENT, u + TANGENT].map(|u| self.values(u, curves));
        let [Some(before), Some(after)] = sides else {
            return Some(distance);
        };
        if u <= TANGENT || u >= 1.0 - TANGENT {
            return Some(distance);
        }
        let tangent = of.differences(&after, &before);
        let off = of.differences(&self.values(u, curves)?, &wanted);
        let along: f64 = tangent.iter().zip(&off).map(|(t, d)| t * d).sum();
        let across = off.iter().map(|d| d * d).sum::<f64>() - (along / norm(&tangent)).powi(2);
        Some(across.max(0.0).sqrt().min(distance))
    }
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}
