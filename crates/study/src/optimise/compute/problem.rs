//! A job as a smooth problem: scaled by its bounds, with a level above the extrema that a goal contains, and with squares in place of roots.

use super::engine::Worker;
use super::expressions::{DesignValues, JobExpression, Variable};
use super::measured::{Measured, Peak};
use crate::sweep::compute::Design;
use dwell_numerics::optimise::{Constraint, Evaluation, Residuals};

/// A condition that changes by less than this part of its limit over the whole ranges is constant: its derivatives are rounding.
const CONSTANT: f64 = 1e-9;

/// How an expression is bounded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sense {
    AtMost,
    AtLeast,
    Equal,
}

/// A condition of a job.
#[derive(Debug, Clone)]
pub(super) struct Condition {
    pub(super) expression: JobExpression,
    pub(super) sense: Sense,
    pub(super) limit: f64,
    /// A size of its order.
    pub(super) scale: f64,
}

/// A goal: the sum of expressions with weights.
#[derive(Debug, Clone, Default)]
pub(super) struct Goal {
    pub(super) summands: Vec<(JobExpression, f64)>,
}

/// A problem of a job.
#[derive(Debug, Clone)]
pub(super) struct Problem<'a> {
    pub(super) design: &'a Design,
    /// By axis: its bounds.
    pub(super) bounds: Vec<[f64; 2]>,
    pub(super) goal: Goal,
    pub(super) conditions: Vec<Condition>,
    /// The goal at a design, or its square.
    pub(super) scale: f64,
    /// The results whose extrema a level bounds, each with whether these are least ones.
    pub(super) levels: Vec<(usize, bool)>,
    /// Whether the goal is a single root mean square, whose square is minimised.
    pub(super) is_square: bool,
}

impl Problem<'_> {
    /// The numbers of a design in parts of their ranges.
    pub(super) fn parts(&self, values: &[f64]) -> Vec<f64> {
        let each = values.iter().zip(&self.bounds);
        each.map(|(v, [from, to])| ((v - from) / (to - from)).clamp(0.0, 1.0))
            .collect()
    }

    /// The numbers of a design whose parts of their ranges are these.
    pub(super) fn values(&self, parts: &[f64]) -> Vec<f64> {
        let each = parts.iter().zip(&self.bounds);
        // Second derivatives take designs beyond the bounds; rounding does not.
        let value = |(x, [from, to]): (&f64, &[f64; 2])| {
            let value = from + x * (to - from);
            if (0.0..=1.0).contains(x) {
                value.clamp(*from, *to)
            } else {
                value
            }
        };
        each.map(value).collect()
    }

    /// The number of families of constraints.
    pub(super) fn families(&self) -> usize {
        self.conditions.len() + self.levels.len()
    }

    /// The bounds of all variables, the levels last.
    pub(super) fn variable_bounds(&self) -> Vec<[f64; 2]> {
        let mut all = vec![[0.0, 1.0]; self.bounds.len()];
        all.resize(self.bounds.len() + self.levels.len(), [-1e6, 1e6]);
        all
    }

    /// The value of the goal, and by condition that of its expression.
    pub(super) fn report(&self, results: &[Measured], numbers: &[f64]) -> (f64, Vec<f64>) {
        let at = DesignValues {
            results,
            numbers,
            effects: &[],
        };
        let goal = self.goal.summands.iter();
        let goal = goal.map(|(of, weight)| weight * of.value(&at)).sum();
        let conditions = self.conditions.iter();
        (
            goal,
            conditions.map(|of| of.expression.value(&at)).collect(),
        )
    }

    /// The same, of results without derivatives.
    pub(super) fn report_values(&self, results: &[f64], numbers: &[f64]) -> (f64, Vec<f64>) {
        let measured = results.iter().map(|value| Measured {
            value: *value,
            ..Measured::default()
        });
        self.report(&measured.collect::<Vec<_>>(), numbers)
    }

    /// The goal at the design from which the scales come.
    pub(super) fn goal_size(&self) -> f64 {
        if self.is_square {
            self.scale.sqrt()
        } else {
            self.scale
        }
    }

    /// How good a design is: the goal in parts of its scale, and ten times the violations of the conditions in parts of theirs.
    pub(super) fn score(&self, worker: &mut Worker<'_, '_>, values: &[f64]) -> Option<f64> {
        let results = worker.evaluate_roughly(values)?;
        let (goal, conditions) = self.report(&results, &self.design.numbers(values));
        Some(goal / self.goal_size() + 10.0 * self.violation(&conditions))
            .filter(|score| score.is_finite())
    }

    /// The sum of the violations of conditions whose expressions have these values, in parts of their scales.
    pub(super) fn violation(&self, values: &[f64]) -> f64 {
        let each = self.conditions.iter().zip(values);
        each.map(|(of, value)| of.violation(*value)).sum()
    }

    /// The variables of a design: its parts, then the levels.
    pub(super) fn start(&self, worker: &mut Worker<'_, '_>, values: &[f64]) -> Option<Vec<f64>> {
        let mut x = self.parts(values);
        if !self.levels.is_empty() {
            let results = worker.evaluate(values, false)?;
            let levels = self.levels.iter();
            x.extend(levels.map(|(k, _)| results[*k].value / self.level_scale()));
        }
        Some(x)
    }

    fn level_scale(&self) -> f64 {
        self.scale
    }

    /// The problem at some variables; `None` where the design has no results.
    pub(super) fn evaluate(&self, worker: &mut Worker<'_, '_>, x: &[f64]) -> Option<Evaluation> {
        let (parts, levels) = x.split_at(self.bounds.len());
        let values = self.values(parts);
        let mut results = worker.evaluate(&values, true)?;
        let numbers = self.design.numbers(&values);
        let axes = 0..values.len();
        let effects: Vec<Vec<f64>> = axes.map(|k| self.design.slopes(&numbers, k)).collect();
        let peaks: Vec<Vec<Peak>> = (self.levels.iter())
            .map(|(k, _)| results[*k].peaks.clone())
            .collect();
        let conditions = self.condition_rows(&results, &numbers, &effects, levels.len());
        for ((k, _), level) in self.levels.iter().zip(levels) {
            results[*k].value = level * self.level_scale();
        }
        let at = DesignValues {
            results: &results,
            numbers: &numbers,
            effects: &effects,
        };
        let (goal, slope) = self.goal_at(&at);
        let mut constraints = conditions;
        for (j, ((_, is_least), peaks)) in self.levels.iter().zip(peaks).enumerate() {
            let sign = if *is_least { -1.0 } else { 1.0 };
            for peak in peaks {
                let mut slope = self.scaled(&peak.slope, -sign / self.level_scale(), levels.len());
                slope[self.bounds.len() + j] = sign;
                constraints.push(Constraint {
                    value: sign * (levels[j] - peak.value / self.level_scale()),
                    slope,
                    is_equality: false,
                    family: self.conditions.len() + j,
                    place: peak.place,
                });
            }
        }
        let is_finite = goal.is_finite()
            && slope.iter().all(|s| s.is_finite())
            && (constraints.iter())
                .all(|c| c.value.is_finite() && c.slope.iter().all(|s| s.is_finite()));
        is_finite.then_some(Evaluation {
            goal,
            slope,
            constraints,
        })
    }

    /// Derivatives by the axes as such by the variables, times a factor.
    fn scaled(&self, slope: &[f64], factor: f64, levels: usize) -> Vec<f64> {
        let each = slope.iter().zip(&self.bounds);
        let mut all: Vec<f64> = each
            .map(|(s, [from, to])| factor * s * (to - from))
            .collect();
        all.resize(self.bounds.len() + levels, 0.0);
        all
    }

    fn goal_at(&self, at: &DesignValues<'_>) -> (f64, Vec<f64>) {
        let count = self.levels.len();
        if self.is_square
            && let Some((expression, weight)) = self.goal.summands.first()
            && let Some(k) = expression.result()
            && let Some((square, slope)) = &at.results[k].square
        {
            let factor = weight.signum() / self.scale;
            return (factor * square, self.scaled(slope, factor, count));
        }
        let is_level = |k: usize| self.levels.iter().any(|(of, _)| *of == k);
        let (mut goal, mut slope) = (0.0, vec![0.0; self.bounds.len() + count]);
        for (of, weight) in &self.goal.summands {
            let factor = weight / self.scale;
            goal += factor * of.value(at);
            let by_axes = self.scaled(&of.slope(at, &is_level), factor, count);
            slope.iter_mut().zip(by_axes).for_each(|(sum, s)| *sum += s);
            for (variable, partial) in of.variables.iter().zip(of.partials(at)) {
                let is_it = |(k, _): &(usize, bool)| *variable == Variable::Result(*k);
                if let Some(j) = self.levels.iter().position(is_it) {
                    slope[self.bounds.len() + j] += factor * partial * self.level_scale();
                }
            }
        }
        (goal, slope)
    }

    fn condition_rows(
        &self,
        results: &[Measured],
        numbers: &[f64],
        effects: &[Vec<f64>],
        levels: usize,
    ) -> Vec<Constraint> {
        let at = DesignValues {
            results,
            numbers,
            effects,
        };
        let mut rows = Vec::new();
        for (family, of) in self.conditions.iter().enumerate() {
            let sign = if of.sense == Sense::AtMost { -1.0 } else { 1.0 };
            let mut add = |value: f64, slope: &[f64], place: f64| {
                let mut slope = self.scaled(slope, sign / of.scale, levels);
                if slope.iter().all(|part| part.abs() < CONSTANT) {
                    slope.fill(0.0);
                }
                rows.push(Constraint {
                    value: sign * (value - of.limit) / of.scale,
                    slope,
                    is_equality: of.sense == Sense::Equal,
                    family,
                    place,
                });
            };
            match of.expression.result().map(|k| &results[k]) {
                Some(result) if of.bounds_all(result) => {
                    let peaks = result.peaks.iter();
                    peaks.for_each(|peak| add(peak.value, &peak.slope, peak.place));
                }
                _ => {
                    let slope = of.expression.slope(&at, &|_| false);
                    add(of.expression.value(&at), &slope, 0.0);
                }
            }
        }
        rows
    }

    /// The residuals of a goal that is the root mean square of the distance from a table alone, in parts of its scale.
    pub(super) fn residuals(
        &self,
        worker: &mut Worker<'_, '_>,
        parts: &[f64],
    ) -> Option<Residuals> {
        let (expression, _) = self.goal.summands.first()?;
        let mut results = worker.evaluate(&self.values(parts), true)?;
        let mut found = results[expression.result()?].residuals.take()?;
        let scale = 1.0 / self.scale.sqrt();
        found.values.iter_mut().for_each(|value| *value *= scale);
        for slope in &mut found.slopes {
            *slope = self.scaled(slope, scale, 0);
        }
        let is_finite = |slope: &Vec<f64>| slope.iter().all(|s| s.is_finite());
        found.slopes.iter().all(is_finite).then_some(found)
    }
}

impl Condition {
    /// By how much a value of the expression is beyond the limit, in parts of the scale.
    pub(super) fn violation(&self, value: f64) -> f64 {
        let over = (value - self.limit) / self.scale;
        match self.sense {
            Sense::AtMost => over.max(0.0),
            Sense::AtLeast => (-over).max(0.0),
            Sense::Equal => over.abs(),
        }
    }

    /// Whether all extrema of a result are on one side of the limit where the condition holds.
    fn bounds_all(&self, result: &Measured) -> bool {
        let mut values = result.peaks.iter().map(|peak| peak.value);
        !result.peaks.is_empty()
            && match self.sense {
                Sense::AtMost => values.all(|value| value <= result.value),
                Sense::AtLeast => values.all(|value| value >= result.value),
                Sense::Equal => false,
            }
    }
}
