//! The search from many starts: the best of a pool of random designs, and the scene itself.

use super::engine::{Engine, Worker};
use super::problem::{Problem, Sense};
use crate::progress::{Progress, Step};
use crate::sweep::compute::RequestedQuantities;
use crate::trajectory::compute::Statistic;
use dwell_dynamics::interruption;
use dwell_numerics::optimise::{Evaluation, Optimum, SequentialSettings, least_squares, minimise};
use rayon::prelude::*;

/// Convergence that is aimed at, and that which counts.
const TOLERANCE: f64 = 1e-10;
pub(super) const CONVERGED: f64 = 1e-6;
const ITERATIONS: usize = 200;
/// Evaluations of a fit of a table.
const EVALUATIONS: usize = 150;
/// Fits that are searched further, the best ones.
const POLISHED: usize = 4;
/// Starts that are nearer than this part of the typical distance of so many random designs are one.
const APART: f64 = 0.5;
/// Random designs of a thread in a row.
const CHUNK: usize = 64;

/// An accepted point of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HistoryPoint {
    /// The number of the start, from 0: the scene itself if it can be evaluated.
    pub start: usize,
    /// The number of the accepted point.
    pub iteration: usize,
    /// The goal there, in its unit.
    pub goal: f64,
    /// The largest violation of a condition, in parts of its limit.
    pub violation: f64,
}

/// Where the search from a start ended.
#[derive(Debug, Clone)]
pub(super) struct Ended {
    pub(super) optimum: Optimum,
    pub(super) history: Vec<HistoryPoint>,
}

impl Ended {
    /// Whether the conditions of an optimum hold.
    pub(super) fn is_converged(&self) -> bool {
        let of = &self.optimum;
        of.residual <= CONVERGED && self.is_feasible() && of.complementarity <= CONVERGED
    }

    pub(super) fn is_feasible(&self) -> bool {
        self.optimum.evaluation.violation() <= CONVERGED
    }
}

/// The scales of a problem, from a design at which it has results; squares in place of roots, and levels above extrema.
pub(super) fn scale_problem(
    problem: &mut Problem<'_>,
    worker: &mut Worker<'_, '_>,
    values: &[f64],
    requested: &RequestedQuantities,
) -> Option<()> {
    let results = worker.evaluate(values, true)?;
    let numbers = problem.design.numbers(values);
    let (goal, conditions) = problem.report(&results, &numbers);
    for (of, value) in problem.conditions.iter_mut().zip(conditions) {
        let size = if of.limit == 0.0 { value } else { of.limit };
        of.scale = if size == 0.0 { 1.0 } else { size.abs() };
    }
    problem.scale = if goal == 0.0 { 1.0 } else { goal.abs() };
    let axes = 0..values.len();
    let effects: Vec<Vec<f64>> = axes.map(|k| problem.design.slopes(&numbers, k)).collect();
    let single = match &problem.goal.summands[..] {
        [(of, weight)] if *weight > 0.0 => of.result(),
        _ => None,
    };
    if single.is_some_and(|k| results[k].square.is_some()) {
        problem.is_square = true;
        problem.scale *= problem.scale;
        return Some(());
    }
    let at = super::expressions::DesignValues {
        results: &results,
        numbers: &numbers,
        effects: &effects,
    };
    for (of, weight) in &problem.goal.summands {
        for (variable, partial) in of.variables.iter().zip(of.partials(&at)) {
            let super::expressions::Variable::Result(k) = *variable else {
                continue;
            };
            let is_least = requested.quantities[k].kind.statistic() == Some(Statistic::Min);
            let rises = weight * partial > 0.0;
            let is_new = problem.levels.iter().all(|(known, _)| *known != k);
            // A level above the largest extremum is as low as it can be where the goal rises with it.
            if !results[k].peaks.is_empty() && rises != is_least && is_new {
                problem.levels.push((k, is_least));
            }
        }
    }
    Some(())
}

/// The starts: the scene's own design, then the best of the pool that are apart from each other.
pub(super) fn starts(
    problem: &Problem<'_>,
    engine: &Engine<'_>,
    own: Option<&[f64]>,
    count: usize,
) -> Vec<Vec<f64>> {
    let pool: Vec<u64> = (0..problem.design.points).collect();
    let scored = pool.par_chunks(CHUNK).flat_map_iter(|chunk| {
        let mut worker = engine.worker();
        let mut scored = Vec::new();
        for k in chunk {
            if interruption::is_requested() {
                break;
            }
            let values = problem.design.values(*k);
            if let Some(score) = problem.score(&mut worker, &values) {
                scored.push((score, problem.parts(&values), values));
            }
        }
        scored
    });
    let mut scored: Vec<(f64, Vec<f64>, Vec<f64>)> = scored.collect();
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    let axes = problem.bounds.len() as f64;
    let least = APART * (1.0 / scored.len().max(1) as f64).powf(1.0 / axes);
    let mut found: Vec<Vec<f64>> = own.map(<[f64]>::to_vec).into_iter().collect();
    let mut parts: Vec<Vec<f64>> = found.iter().map(|values| problem.parts(values)).collect();
    let mut left = Vec::new();
    for (_, part, values) in scored {
        if found.len() >= count {
            break;
        }
        let distance = |other: &Vec<f64>| {
            let each = other.iter().zip(&part);
            each.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        match parts.iter().all(|other| distance(other) >= least) {
            true => {
                parts.push(part);
                found.push(values);
            }
            false => left.push(values),
        }
    }
    let missing = count.saturating_sub(found.len());
    found.extend(left.into_iter().take(missing));
    found
}

/// Searches from each start; what is known is kept where the computation is interrupted.
pub(super) fn search(
    problem: &Problem<'_>,
    engine: &Engine<'_>,
    starts: &[Vec<f64>],
    progress: Progress<'_>,
) -> Vec<Ended> {
    let starts = if fits_table(problem) {
        fitted(problem, engine, starts)
    } else {
        starts.to_vec()
    };
    let ended = starts.par_iter().enumerate().map(|(number, start)| {
        let mut worker = engine.worker();
        // The scene itself and the best of the pool have at least one step.
        let ended = if interruption::is_requested() && number > 1 {
            None
        } else {
            from_start(problem, &mut worker, start, number)
        };
        progress(Step {
            total: starts.len(),
            done: "starts",
        });
        ended
    });
    ended.collect::<Vec<_>>().into_iter().flatten().collect()
}

/// Whether the goal is the root mean square of the distance from a table alone.
fn fits_table(problem: &Problem<'_>) -> bool {
    let is_distance = |text: &str| {
        let mut parts = text.trim_matches('`').rsplit('.');
        parts.next() == Some("rms")
            && matches!(parts.next(), Some("distance" | "angle" | "difference"))
    };
    let summands = &problem.goal.summands;
    problem.is_square && problem.conditions.is_empty() && is_distance(&summands[0].0.text)
}

/// The best fits from each start, as starts.
fn fitted(problem: &Problem<'_>, engine: &Engine<'_>, starts: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let bounds = vec![[0.0, 1.0]; problem.bounds.len()];
    let fits = starts.par_iter().filter_map(|start| {
        let mut worker = engine.worker();
        let mut residuals = |x: &[f64]| problem.residuals(&mut worker, x);
        let found = least_squares(&mut residuals, &problem.parts(start), &bounds, EVALUATIONS)?;
        Some((found.sum, problem.values(&found.x)))
    });
    let mut fits: Vec<(f64, Vec<f64>)> = fits.collect();
    fits.sort_by(|a, b| a.0.total_cmp(&b.0));
    fits.truncate(POLISHED);
    fits.into_iter().map(|(_, values)| values).collect()
}

/// The search from one start.
pub(super) fn from_start(
    problem: &Problem<'_>,
    worker: &mut Worker<'_, '_>,
    start: &[f64],
    number: usize,
) -> Option<Ended> {
    let x = problem.start(worker, start)?;
    let mut history = Vec::new();
    let mut done = |_: &[f64], at: &Evaluation| {
        history.push(HistoryPoint {
            start: number,
            iteration: history.len(),
            goal: problem.goal_of(at.goal),
            violation: at.violation(),
        });
        !interruption::is_requested()
    };
    let mut evaluate = |x: &[f64]| problem.evaluate(worker, x);
    let settings = SequentialSettings {
        tolerance: TOLERANCE,
        iterations: ITERATIONS,
        families: problem.families(),
    };
    let bounds = problem.variable_bounds();
    let optimum = minimise(&mut evaluate, &x, &bounds, settings, &mut done)?;
    Some(Ended { optimum, history })
}

impl Problem<'_> {
    /// The goal in its unit, from that of the scaled problem.
    pub(super) fn goal_of(&self, scaled: f64) -> f64 {
        match self.is_square {
            true => (scaled * self.scale).max(0.0).sqrt() * self.goal.summands[0].1,
            false => scaled * self.scale,
        }
    }

    /// The derivative of the goal, in its unit, by the scaled one, where the goal has a value.
    pub(super) fn goal_rate(&self, goal: f64) -> f64 {
        match self.is_square && goal != 0.0 {
            true => self.scale * self.goal.summands[0].1 / (2.0 * goal / self.goal.summands[0].1),
            false => self.scale,
        }
    }

    /// By how much the goal rises where the limit of a condition rises by one unit, from the multiplier of the scaled problem.
    pub(super) fn price(&self, condition: usize, multiplier: f64, goal: f64) -> f64 {
        let of = &self.conditions[condition];
        let sign = if of.sense == Sense::AtMost { -1.0 } else { 1.0 };
        sign * multiplier * self.goal_rate(goal) / of.scale
    }
}
