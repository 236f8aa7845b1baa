//! The smallest and the largest value of each column along a trajectory, also between two rows.
//!
//! A column is evaluated in the rows and at further positions between them: for a free motion at its steps, which adapt
//! to the motion. About a local extremum there, three positions enclose one of the column. It is found by parabolas and
//! golden sections, each of whose points is evaluated like a row.

use crate::trajectory::compute::corners::{Sharp, sharp_maxima, side_of_jump};
use crate::trajectory::compute::maximum::{NO_GAIN, between_events, promising, refine_maximum};
use crate::trajectory::compute::{
    BALANCE, Column, Point, Quantity, RowEvaluator, Trajectory, TrajectorySample,
};
use SamplePrecision::{Exact, Interpolated};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::io;

/// Least number of positions at which a trajectory is examined.
const MIN_POSITIONS: usize = 720;
/// Highest number of local extrema of a column that are found exactly; of all columns together.
const MAX_REFINED: usize = 3;
const MAX_REFINED_OF_ALL: usize = 1500;
/// Columns that are searched between the rows, times all columns: the cost of a position grows with the columns, so that without this bound
/// the cost of thousands of loads would be quadratic. A minimum of columns is always searched.
const MAX_SEARCHED_TIMES_ALL: usize = 600_000;
const MIN_SEARCHED: usize = 100;
/// Extrema that differ relatively by less than this are the same: the first one counts.
const SAME: f64 = 1e-12;

/// A value of a column, and its abscissa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extremum {
    pub(crate) value: f64,
    pub(crate) at: f64,
}

/// The extrema of all columns.
#[derive(Debug, Clone, Default)]
pub(crate) struct Extrema {
    /// By column: the smallest and the largest value, if it has any.
    pub(crate) of_columns: Vec<Option<[Extremum; 2]>>,
    /// By column: whether they are the extrema of the rows only; larger ones may lie between the rows.
    pub(crate) of_rows: Vec<bool>,
    /// By column of an integrated motion: its local extrema in the rows and at the steps between them.
    turns: Vec<Vec<Extremum>>,
}

impl Extrema {
    /// Further points of the drawn curve of a column. Without them, the peak nearest to a row would appear as the highest of several.
    #[cfg(feature = "output")]
    pub(crate) fn of_curve(&self, k: usize) -> impl Iterator<Item = Extremum> {
        let ends = self.of_columns.get(k).copied().flatten();
        let turns = self.turns.get(k).into_iter().flatten();
        ends.into_iter().flatten().chain(turns.copied())
    }

    /// Whether extrema are those of the trajectory, except for some columns.
    pub(crate) fn are_between_rows(&self) -> bool {
        self.of_rows.contains(&false)
    }
}

/// How a position between others is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SamplePrecision {
    /// For the search of an extremum: an integrated motion may be interpolated within its steps.
    Interpolated,
    /// For the value of an extremum.
    Exact,
}

/// The position at a parameter; `None` if it cannot be computed.
pub(crate) type Sampler<'s> = Box<dyn FnMut(f64, SamplePrecision) -> Option<TrajectorySample> + 's>;

/// A trajectory at any position.
pub(crate) struct BetweenRows<'s> {
    /// The parameter of each row: a time, or a completed fraction.
    pub(crate) parameters: Vec<f64>,
    /// Further positions, in the order of their parameters.
    pub(crate) further: Vec<(f64, TrajectorySample)>,
    /// A new sampler: each thread has its own.
    pub(crate) sampler: &'s (dyn Fn() -> Sampler<'s> + Sync),
}

impl<'s> BetweenRows<'s> {
    /// The search along a trajectory that is known at some further positions; others are added if these and the rows
    /// are far apart.
    pub(crate) fn new(
        parameters: Vec<f64>,
        further: Vec<(f64, TrajectorySample)>,
        sampler: &'s (dyn Fn() -> Sampler<'s> + Sync),
    ) -> Self {
        let mut sample = sampler();
        let mut known: Vec<f64> = further.iter().map(|(u, _)| *u).collect();
        known.extend(&parameters);
        known.sort_by(f64::total_cmp);
        let ends = known.first().zip(known.last());
        let longest = ends.map_or(0.0, |(first, last)| (last - first) / MIN_POSITIONS as f64);
        let mut all = further;
        for pair in known.windows(2) {
            let (from, length) = (pair[0], pair[1] - pair[0]);
            // Up to rounding, as many rows as that are enough.
            let parts = (length / longest * (1.0 - 1e-9)).ceil();
            if length > 0.0 && parts > 1.0 {
                let between = (1..parts as usize).map(|k| from + length * k as f64 / parts);
                all.extend(between.filter_map(|u| Some((u, sample(u, Exact)?))));
            }
        }
        all.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        Self {
            parameters,
            further: all,
            sampler,
        }
    }
}

/// The search for extrema.
pub(crate) struct ExtremaSearch<'a, E> {
    pub(crate) trajectory: &'a Trajectory<'a>,
    pub(crate) columns: &'a [Column],
    /// The index of the abscissa's column.
    pub(crate) abscissa: usize,
    /// All values of a column.
    pub(crate) values: &'a (dyn Fn(usize) -> io::Result<Vec<f64>> + Sync),
    pub(crate) evaluators: &'a [E],
}

impl<E: RowEvaluator> ExtremaSearch<'_, E> {
    /// The extrema in the rows.
    pub(crate) fn in_rows(&self) -> io::Result<Extrema> {
        let at = (self.values)(self.abscissa)?;
        let both = |k| -> io::Result<Option<[Extremum; 2]>> {
            let mut found: Option<[Extremum; 2]> = None;
            for (value, &at) in (self.values)(k)?.into_iter().zip(&at) {
                let here = Extremum { value, at };
                // Of equal values the first.
                match &mut found {
                    Some([smallest, _]) if value < smallest.value => *smallest = here,
                    Some([_, largest]) if value > largest.value => *largest = here,
                    None if !value.is_nan() => found = Some([here; 2]),
                    _ => {}
                }
            }
            Ok(found)
        };
        Ok(Extrema {
            of_columns: (0..self.columns.len())
                .map(both)
                .collect::<io::Result<_>>()?,
            of_rows: vec![true; self.columns.len()],
            turns: vec![Vec::new(); self.columns.len()],
        })
    }

    /// The extrema of some columns along the whole trajectory, on all cores; of the others in the rows.
    pub(crate) fn between_rows(
        &self,
        wanted: &[usize],
        between: &BetweenRows<'_>,
    ) -> io::Result<Extrema> {
        let mut extrema = self.in_rows()?;
        let [wanted, left_out] = self.searched(wanted);
        for (of_rows, column) in extrema.of_rows.iter_mut().zip(self.columns) {
            // Time has its extrema at the ends.
            *of_rows = column.quantity != Quantity::Time && !is_continuous(column);
        }
        left_out.iter().for_each(|&k| extrema.of_rows[k] = true);
        let points = KnownPoints::new(between, self.evaluate_all(&wanted, &between.further));
        let refined = (MAX_REFINED_OF_ALL / wanted.len().max(1)).clamp(1, MAX_REFINED);
        let known: Vec<(usize, usize)> = wanted.iter().copied().enumerate().collect();
        let part = known.len().div_ceil(rayon::current_num_threads());
        let parts = known.par_chunks(part.max(1)).map(|columns| {
            let mut search = ColumnSearch {
                trajectory: self.trajectory,
                columns: self.columns,
                abscissa: self.abscissa,
                evaluators: self.evaluators.to_vec(),
                sample: (between.sampler)(),
            };
            let column = |&(i, k): &(usize, usize)| {
                let points = points.of_column(i, (self.values)(k)?, self.columns[k].unwraps);
                let parts: Vec<&[Point]> = between_events(&points).collect();
                let mut found = |sign| search.largest(k, sign, &points, &parts, refined);
                io::Result::Ok((k, [found(-1.0), found(1.0)], turns(&points)))
            };
            columns.iter().map(column).collect::<io::Result<Vec<_>>>()
        });
        for part in parts.collect::<Vec<_>>() {
            for (k, found, turns) in part? {
                // Other parameters than times are not the abscissa.
                if self.trajectory.free_motion().is_some() {
                    extrema.turns[k] = turns;
                }
                let Some(ends) = &mut extrema.of_columns[k] else {
                    continue;
                };
                for (extremum, (sign, found)) in
                    ends.iter_mut().zip([-1.0, 1.0].into_iter().zip(found))
                {
                    let from = extremum.value;
                    let beats =
                        |found: &Extremum| sign * (found.value - from) > NO_GAIN * from.abs();
                    if let Some(found) = found.filter(beats) {
                        *extremum = found;
                    }
                }
            }
        }
        Ok(extrema)
    }

    /// The requested columns that are searched between the rows, and those beyond the bound; forces and powers of loads are the last.
    fn searched(&self, wanted: &[usize]) -> [Vec<usize>; 2] {
        let is_searched = |&k: &usize| is_continuous(&self.columns[k]);
        let mut searched: Vec<usize> = wanted.iter().copied().filter(is_searched).collect();
        searched.sort_by_key(|&k| is_of_load(&self.columns[k]));
        let most = (MAX_SEARCHED_TIMES_ALL / self.columns.len().max(1)).max(MIN_SEARCHED);
        let left_out = searched.split_off(most.min(searched.len()));
        [searched, left_out]
    }

    /// Some columns at many positions, on all cores.
    fn evaluate_all(
        &self,
        columns: &[usize],
        positions: &[(f64, TrajectorySample)],
    ) -> Vec<(f64, Vec<f64>)> {
        let (trajectory, all, evaluators) = (self.trajectory, self.columns, self.evaluators);
        let part = positions.len().div_ceil(rayon::current_num_threads());
        let parts = positions.par_chunks(part.max(1)).map(|positions| {
            let mut evaluators = evaluators.to_vec();
            limit(&mut evaluators, all, columns);
            let mut found = Vec::with_capacity(positions.len());
            for (u, sample) in positions {
                let Some(evaluator) = evaluated(trajectory, &mut evaluators, sample) else {
                    continue;
                };
                let mut values = Vec::with_capacity(columns.len());
                for &k in columns {
                    values.push(evaluator.value(all[k].quantity, sample));
                }
                found.push((*u, values));
            }
            found
        });
        parts.flatten().collect()
    }
}

/// The positions at which the columns are known: the rows, and others between them.
struct KnownPoints<'b> {
    parameters: &'b [f64],
    further: Vec<(f64, Vec<f64>)>,
    /// By parameter, each once: a row, or else one of the others.
    order: Vec<(f64, Result<usize, usize>)>,
}

impl<'b> KnownPoints<'b> {
    fn new(between: &'b BetweenRows<'_>, further: Vec<(f64, Vec<f64>)>) -> Self {
        let rows = between.parameters.iter().enumerate();
        let mut order: Vec<_> = rows.map(|(row, &u)| (u, Ok(row))).collect();
        order.extend(further.iter().enumerate().map(|(i, (u, _))| (*u, Err(i))));
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        order.dedup_by_key(|point| point.0);
        Self {
            parameters: &between.parameters,
            further,
            order,
        }
    }

    /// The values of the `i`th searched column; its values in the rows are given.
    fn of_column(&self, i: usize, rows: Vec<f64>, unwraps: bool) -> Vec<Point> {
        // An angle's revolutions are counted from row to row.
        if unwraps {
            let rows = self.parameters.iter().zip(rows);
            let mut points: Vec<Point> = rows.map(|(&u, value)| [u, value]).collect();
            points.dedup_by_key(|point| point[0]);
            return points;
        }
        // A motion may end before its last row.
        let mut known = Vec::with_capacity(self.order.len());
        for &(u, place) in &self.order {
            match place {
                Ok(row) if row < rows.len() => known.push([u, rows[row]]),
                Ok(_) => {}
                Err(other) => known.push([u, self.further[other].1[i]]),
            }
        }
        known
    }
}

/// The search for extrema of one column after another.
struct ColumnSearch<'a, 's, E> {
    trajectory: &'a Trajectory<'a>,
    columns: &'a [Column],
    abscissa: usize,
    evaluators: Vec<E>,
    sample: Sampler<'s>,
}

impl<E: RowEvaluator> ColumnSearch<'_, '_, E> {
    /// Some columns at a position.
    fn evaluate<const N: usize>(
        &mut self,
        columns: [usize; N],
        u: f64,
        precision: SamplePrecision,
    ) -> Option<[f64; N]> {
        let sample = (self.sample)(u, precision)?;
        let evaluator = evaluated(self.trajectory, &mut self.evaluators, &sample)?;
        Some(columns.map(|k| evaluator.value(self.columns[k].quantity, &sample)))
    }

    /// The largest value times `sign` of a column; `points` are some of its values, `parts` those between events.
    fn largest(
        &mut self,
        k: usize,
        sign: f64,
        points: &[Point],
        parts: &[&[Point]],
        refined: usize,
    ) -> Option<Extremum> {
        limit(&mut self.evaluators, self.columns, &[k, self.abscissa]);
        let (mut largest, mut scale) = (None::<Point>, 0.0);
        for &[u, value] in points {
            let signed = sign * value;
            if largest.map_or(!value.is_nan(), |largest| signed > largest[1]) {
                largest = Some([u, signed]);
            }
            if value.abs() > scale {
                scale = value.abs();
            }
        }
        let largest = largest?;
        // Each with its abscissa, where that is known.
        let mut found: Vec<(Point, Option<f64>)> = vec![(largest, None)];
        let unwraps = self.columns[k].unwraps;
        let smooth = promising(parts, sign, largest[1], refined);
        let corner = |(near, bracket)| (near, Sharp::Corner(bracket));
        let sharp = sharp_maxima(parts, sign, largest[1], scale);
        for (near, place) in smooth.into_iter().map(corner).chain(sharp) {
            let columns = [k, self.abscissa];
            let mut value = |u: f64, precision: SamplePrecision| {
                let [mut value, at] = self.evaluate(columns, u, precision)?;
                if unwraps {
                    value += TAU * ((sign * near - value) / TAU).round();
                }
                Some((sign * value, at)).filter(|(value, _)| value.is_finite())
            };
            let interpolated = &mut |u| Some(value(u, Interpolated)?.0);
            let top = match place {
                Sharp::Corner(bracket) => refine_maximum(interpolated, bracket, scale),
                Sharp::Jump(sides) => side_of_jump(interpolated, sides),
            };
            found.extend(top.and_then(|[u, _]| {
                let (value, at) = value(u, Exact)?;
                Some(([u, value], Some(at)))
            }));
        }
        let values = found.iter().map(|([_, v], _)| *v);
        let best = values.fold(f64::NEG_INFINITY, f64::max);
        let is_best = |(point, _): &&(Point, _)| point[1] >= best - SAME * scale;
        let first = found.iter().filter(is_best);
        let ([u, value], at) = *first.min_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]))?;
        let at = match at {
            Some(at) => at,
            None => self.evaluate([self.abscissa], event_at(u, points), Exact)?[0],
        };
        Some(Extremum {
            value: sign * value,
            at,
        })
    }
}

/// Where a function of time turns, at its points.
fn turns(points: &[Point]) -> Vec<Extremum> {
    let is_turn = |w: &&[Point]| (w[1][1] - w[0][1]) * (w[1][1] - w[2][1]) > 0.0;
    let all = points.windows(3).filter(is_turn).map(|w| w[1]);
    all.map(|[at, value]| Extremum { value, at }).collect()
}

/// The event before which a limit is known, a rounding earlier; else the parameter itself.
fn event_at(u: f64, points: &[Point]) -> f64 {
    let is_known = |u: &f64| points.binary_search_by(|p| p[0].total_cmp(u)).is_ok();
    Some(u.next_up()).filter(is_known).unwrap_or(u)
}

/// Only some of all columns are evaluated.
fn limit(evaluators: &mut [impl RowEvaluator], all: &[Column], columns: &[usize]) {
    for evaluator in evaluators {
        evaluator.limit_to(columns.iter().map(|&k| all[k].quantity));
    }
}

/// The evaluator of a sample's chart, at its position.
fn evaluated<'e, E: RowEvaluator>(
    trajectory: &Trajectory<'_>,
    evaluators: &'e mut [E],
    sample: &TrajectorySample,
) -> Option<&'e E> {
    let evaluator = evaluators.get_mut(sample.chart)?;
    let t = trajectory.load_time(sample);
    evaluator.evaluate(sample, t).ok()?;
    Some(evaluator)
}

/// Whether a column can have extrema between rows. The error of the integration cannot, nor can columns that are
/// infinite in some positions or count revolutions from row to row.
pub(super) fn is_continuous(column: &Column) -> bool {
    use Quantity::{MechanicalAdvantage, Pole, Power, Rotation, Time};
    match column.quantity {
        Time | Power(3) | MechanicalAdvantage(..) | Pole(..) => false,
        Rotation(_, 0, _) => column.unwraps,
        _ => column.name != BALANCE,
    }
}

/// Whether a column belongs to one load.
fn is_of_load(column: &Column) -> bool {
    matches!(
        column.quantity,
        Quantity::LoadForce(_) | Quantity::LoadPower(_)
    )
}
