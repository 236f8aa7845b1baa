//! Distances of curves from the rows of a table, with what they consist of.

use super::curves::Samples;
use super::design_worker::{DesignWorker, Lane, Open, Recorded};
use super::measured::{Measured, Peak};
use super::recorded_designs::Wanted;
use crate::trajectory::compute::Statistic;
use dwell_numerics::optimise::Residuals;
use std::f64::consts::TAU;

/// A distance from a table below this part of the values counts as a point on the curve.
const ON_CURVE: f64 = 1e-9;
/// Steps to a foot point, the longest in distances of the samples, and half the distance of the positions that give a direction.
const ROUNDS: usize = 5;
const MOST: f64 = 0.7;
const STEP: f64 = 1e-3;

/// The differences of values from wanted ones.
type Differences<'d> = &'d dyn Fn(&[f64], &[f64]) -> Vec<f64>;

impl DesignWorker<'_, '_> {
    /// Distances of curves from the rows of a table.
    // Long because values and derivatives of a row belong together.
    pub(super) fn distance(&mut self, wanted: &Wanted, template: &[Lane]) -> Option<Measured> {
        let Wanted::Distance {
            channels,
            rows,
            code,
            places,
            are_angles,
            statistic,
        } = wanted
        else {
            return None;
        };
        let of = Recorded {
            channels,
            code,
            template,
        };
        let off = |values: &[f64], row: &[f64]| -> Vec<f64> {
            let each = values.iter().zip(row).map(|(value, wanted)| {
                let off = value - wanted;
                match are_angles {
                    true => off - TAU * (off / TAU).round(),
                    false => off,
                }
            });
            each.collect()
        };
        let (places, tangents) = match places {
            Some(places) => (places.clone(), None),
            None if self.is_rough => return Some(self.rough_distance(of, rows, &off)),
            None => {
                let (places, tangents) = self.nearest(of, rows, &off)?;
                (places, Some(tangents))
            }
        };
        let has_slopes = !self.effects.is_empty();
        let columns = self.at_places(of, &places, has_slopes)?;
        let root = (rows.len() as f64).sqrt();
        let (mut residuals, mut peaks) = (Residuals::default(), Vec::new());
        for (k, row) in rows.iter().enumerate() {
            let values: Vec<f64> = columns.iter().map(|column| column[k].value).collect();
            let mut off = off(&values, row);
            let mut slopes: Vec<Vec<f64>> = columns.iter().map(|c| c[k].slope.clone()).collect();
            let size = 1e-300 + off.iter().chain(row).map(|v| v * v).sum::<f64>().sqrt();
            if let Some(tangent) = tangents.as_ref().map(|all| &all[k]) {
                // The place of the nearest position moves along the curve.
                remove_along(tangent, &mut off);
                for i in 0..self.effects.len() {
                    let mut column: Vec<f64> = slopes.iter().map(|slope| slope[i]).collect();
                    remove_along(tangent, &mut column);
                    for (slope, value) in slopes.iter_mut().zip(column) {
                        slope[i] = value;
                    }
                }
            }
            let length = off.iter().map(|v| v * v).sum::<f64>().sqrt();
            let slope = (0..self.effects.len()).map(|i| {
                let along = off.iter().zip(&slopes).map(|(off, slope)| off * slope[i]);
                along.sum::<f64>() / length.max(ON_CURVE * size)
            });
            peaks.push(Peak {
                place: k as f64 / rows.len() as f64,
                value: length,
                slope: slope.collect(),
            });
            residuals.values.extend(off.iter().map(|v| v / root));
            let scaled = slopes
                .into_iter()
                .map(|slope| slope.iter().map(|v| v / root).collect());
            residuals.slopes.extend(scaled);
        }
        let mut found = match statistic {
            Statistic::Rms => {
                let square = residuals.values.iter().map(|v| v * v).sum();
                let slope = (0..self.effects.len()).map(|i| {
                    let each = residuals.values.iter().zip(&residuals.slopes);
                    each.map(|(v, slope)| 2.0 * v * slope[i]).sum()
                });
                Measured::root(square, slope.collect())
            }
            Statistic::Mean => {
                let count = peaks.len() as f64;
                let slope = |i: usize| peaks.iter().map(|p| p.slope[i]).sum::<f64>() / count;
                Measured {
                    value: peaks.iter().map(|p| p.value).sum::<f64>() / count,
                    slope: (0..self.effects.len()).map(slope).collect(),
                    ..Measured::default()
                }
            }
            _ => Measured::of_peaks(peaks, false),
        };
        found.residuals = Some(residuals);
        Some(found)
    }

    /// The root mean square of the distances of rows from the lines between samples.
    fn rough_distance(
        &self,
        of: Recorded<'_>,
        rows: &[Vec<f64>],
        off: Differences<'_>,
    ) -> Measured {
        let count = self.curves[of.channels[0]].len();
        let is_turn = self.of.is_turn;
        let square = |row: &Vec<f64>| {
            let from = |k: usize| {
                let values = of.channels.iter().map(|c| self.curves[*c][k % count]);
                off(&values.collect::<Vec<_>>(), row)
            };
            let (mut least, mut before) = (f64::INFINITY, from(0));
            for k in 1..count + usize::from(is_turn) {
                let next = from(k);
                let pairs = || before.iter().zip(&next);
                let length: f64 = pairs().map(|(a, b)| (b - a).powi(2)).sum();
                let along: f64 = pairs().map(|(a, b)| a * (a - b)).sum();
                let part = (along / length.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
                let distance = pairs().map(|(a, b)| (a + part * (b - a)).powi(2)).sum();
                least = least.min(distance);
                before = next;
            }
            least
        };
        let sum = rows.iter().map(square).sum::<f64>();
        Measured::root(sum / rows.len() as f64, Vec::new())
    }

    /// By row, the place where curves are nearest to it, and their direction there.
    fn nearest(
        &mut self,
        of: Recorded<'_>,
        rows: &[Vec<f64>],
        off: Differences<'_>,
    ) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        let square =
            |values: &[f64], row: &[f64]| -> f64 { off(values, row).iter().map(|v| v * v).sum() };
        let count = self.curves[of.channels[0]].len();
        let is_turn = self.of.is_turn;
        let start = |row: &Vec<f64>| {
            let heights = (0..count).map(|k| {
                let values = of.channels.iter().map(|c| self.curves[*c][k]);
                let values: Vec<f64> = values.collect();
                -square(&values, row)
            });
            let heights: Vec<f64> = heights.collect();
            let samples = Samples {
                values: &heights,
                is_turn,
            };
            samples.maxima(1.0)[0]
        };
        let starts: Vec<(f64, bool)> = rows.iter().map(start).collect();
        let places: Vec<f64> = starts.iter().map(|(u, _)| *u).collect();
        let fixed: Vec<bool> = starts.iter().map(|(_, is_end)| *is_end).collect();
        let spacing = 1.0 / (count - usize::from(!is_turn)) as f64;
        self.foot_points(
            of,
            rows,
            off,
            Open {
                places,
                fixed,
                spacing,
            },
        )
    }

    /// Places moved to where curves are nearest to the rows, by Newton's method, with the directions of the curves there, which are zero at the
    /// ends of a trajectory.
    fn foot_points(
        &mut self,
        of: Recorded<'_>,
        rows: &[Vec<f64>],
        off: Differences<'_>,
        mut open: Open,
    ) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        let step = STEP * open.spacing;
        let mut tangents = vec![vec![0.0; of.channels.len()]; rows.len()];
        for _ in 0..ROUNDS {
            let triples = open.places.iter().flat_map(|u| [u - step, *u, u + step]);
            let triples: Vec<f64> = triples.map(|u| self.wrapped(u)).collect();
            let values = self.values_at(of, &triples)?;
            for (k, around) in values.chunks(3).enumerate() {
                let is_end = !self.of.is_turn && !(step..1.0 - step).contains(&open.places[k]);
                if open.fixed[k] || is_end {
                    tangents[k].fill(0.0);
                    continue;
                }
                let (mut slope, mut bend) = (0.0, 0.0);
                let parts = off(&around[2], &around[0]);
                let (ahead, behind) = (off(&around[2], &around[1]), off(&around[1], &around[0]));
                for (i, distance) in off(&around[1], &rows[k]).into_iter().enumerate() {
                    let tangent = parts[i] / (2.0 * step);
                    slope += distance * tangent;
                    bend += tangent * tangent + distance * (ahead[i] - behind[i]) / (step * step);
                }
                let most = MOST * open.spacing;
                let change = if bend > 0.0 {
                    -slope / bend
                } else {
                    -most * slope.signum()
                };
                open.places[k] = self.wrapped(open.places[k] + change.clamp(-most, most));
                tangents[k] = parts;
            }
        }
        Some((open.places, tangents))
    }
}

/// Removes the part of a vector along another.
fn remove_along(tangent: &[f64], vector: &mut [f64]) {
    let square: f64 = tangent.iter().map(|t| t * t).sum();
    if square == 0.0 {
        return;
    }
    let part = tangent
        .iter()
        .zip(&*vector)
        .map(|(t, v)| t * v)
        .sum::<f64>()
        / square;
    vector
        .iter_mut()
        .zip(tangent)
        .for_each(|(v, t)| *v -= part * t);
}
