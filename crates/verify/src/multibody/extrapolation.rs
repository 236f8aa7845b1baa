//! Integration by extrapolation (Gragg 1965; Bulirsch & Stoer 1966; Hairer, Nørsett & Wanner, *Solving
//! Ordinary Differential Equations I*, II.9).
//!
//! A step H is taken with the explicit midpoint rule in n = 2, 4, 6, … parts. For even n the error has
//! an expansion in (H/n)², so that Aitken and Neville's table
//!
//! ```text
//! T(k, j) = T(k, j−1) + (T(k, j−1) − T(k−1, j−1)) / ((n_k / n_{k−j})² − 1)          (1)
//! ```
//!
//! gains two orders a column. The table starts with Gragg's ½ (z_n + z_{n−1} + h f(z_n)), which also evaluates the end
//! of the step, so that a jump of the forces shortly before it is not missed. The step ends as soon as the last two
//! columns agree. The length of the next step minimises the number of evaluations per length.

use super::equations::MultibodyOde;
use super::{MotionSample, MultibodyError, Result};
use crate::pose::{Pose, Twist};

/// Error of a step, relative to the largest of its kind so far.
const TOLERANCE: f64 = 1e-13;
/// Most columns of the table: order 20; and the fewest, for two that agree by chance are no proof.
const MAX_COLUMNS: usize = 10;
const MIN_COLUMNS: usize = 3;
/// Most steps of a run, tried and taken.
const MAX_STEPS: usize = 20_000;
/// A step this short, relative to the time of the motion for a radian or a size, crosses a jump of the forces. The
/// method then has no order, and its error is at most of the size of the step.
const MIN_STEP: f64 = 1e-13;

/// A run in the making.
pub(super) struct ExtrapolationSolver<'a> {
    ode: &'a MultibodyOde<'a>,
    t: f64,
    y: Vec<f64>,
    /// Length of the next step, s.
    step: f64,
    /// By state: the scale of its error.
    error_scale: Vec<f64>,
    steps_left: usize,
    duration: f64,
}

/// The result of an attempted step: the new state, if it is accepted, and the factor of the length.
type StepResult = (Option<Vec<f64>>, f64);

/// Evaluations of the table up to row k, the first at the start of the step.
fn evaluation_count(k: usize) -> f64 {
    (0..=k).map(|i| (2 * i + 2) as f64).sum::<f64>() + 1.0
}

impl<'a> ExtrapolationSolver<'a> {
    pub(super) fn new(
        of: &'a MultibodyOde<'a>,
        start: &MotionSample,
        end: Option<f64>,
    ) -> Result<Self> {
        let poses: Vec<Pose> = start.poses.iter().map(|pose| (*pose).into()).collect();
        let rates: Vec<Twist> = start
            .velocities
            .iter()
            .map(|rates| (*rates).into())
            .collect();
        let mut y = of.frames.coordinates_of(&of.frames.moved_frames(&poses)?);
        y.extend(of.frames.velocities(&poses, &rates));
        y.resize(of.dimension(), 0.0);
        of.project(start.t, &mut y)?;
        let duration = end.map_or(1.0, |end| end - start.t);
        let mut solver = Self {
            ode: of,
            t: start.t,
            error_scale: vec![0.0; y.len()],
            y,
            step: duration,
            steps_left: MAX_STEPS,
            duration,
        };
        let derivative = of.solve(solver.t, &solver.y)?.derivative;
        solver.step = (0.1 / solver.update_scales(&derivative)).min(duration);
        Ok(solver)
    }

    pub(super) fn sample(&self) -> Result<MotionSample> {
        self.ode.sample(self.t, &self.y)
    }

    /// Takes a state's rates into the scales; how fast it moves, in sizes or rad, 1/s.
    fn update_scales(&mut self, derivative: &[f64]) -> f64 {
        let frames = &self.ode.frames;
        let n = frames.rows.columns();
        let (v, a) = (&derivative[..n], &derivative[n..2 * n]);
        let [v, a] = [v, a].map(|rates| frames.largest_component(rates));
        let speed_scale = v.max(a.sqrt()).max(1.0 / self.duration);
        for (i, scale) in self.error_scale.iter_mut().enumerate() {
            let size = if i < n {
                frames.size * frames.column_scale(i)
            } else if i < 2 * n {
                speed_scale * frames.size * frames.column_scale(i - n)
            } else {
                let largest = self.y[i].abs().max(derivative[i].abs() / speed_scale);
                largest.max(f64::MIN_POSITIVE)
            };
            *scale = scale.max(size);
        }
        speed_scale
    }

    /// Goes on to a time.
    pub(super) fn advance_to(&mut self, to: f64) -> Result<()> {
        while self.t < to {
            let stuck = MultibodyError::AccuracyNotReached(self.t);
            self.steps_left = self.steps_left.checked_sub(1).ok_or(stuck)?;
            let remaining = to - self.t;
            // No crumb is left behind.
            let reaches_target = remaining <= 1.01 * self.step;
            let step = if reaches_target { remaining } else { self.step };
            let derivative = self.ode.solve(self.t, &self.y)?.derivative;
            let speed_scale = self.update_scales(&derivative);
            let at_min_step = step * speed_scale <= MIN_STEP;
            let (accepted, factor) = self.try_step(step, &derivative, at_min_step)?;
            let next = step * factor;
            // A step cut short by `to` does not shorten the next one.
            let arrives = accepted.is_some() && reaches_target;
            self.step = if arrives { self.step.max(next) } else { next };
            if let Some(y) = accepted {
                self.t = if reaches_target { to } else { self.t + step };
                self.y = y;
                self.ode.project(self.t, &mut self.y)?;
            }
        }
        Ok(())
    }

    fn try_step(&self, step: f64, derivative: &[f64], at_min_step: bool) -> Result<StepResult> {
        let mut previous_row: Vec<Vec<f64>> = vec![];
        let mut factor = 0.1;
        let mut cheapest = f64::INFINITY;
        for k in 0..MAX_COLUMNS {
            let first = match self.midpoint(step, 2 * (k + 1), derivative) {
                Ok(first) => first,
                Err(error) if at_min_step => return Err(error),
                // The midpoint rule went where there is no motion.
                Err(_) => return Ok((None, 0.25)),
            };
            let mut row = vec![first];
            for (j, coarse) in previous_row.iter().enumerate() {
                let ratio = (k + 1) as f64 / (k - j) as f64;
                let weight = 1.0 / (ratio * ratio - 1.0);
                let both = row[j].iter().zip(coarse);
                row.push(both.map(|(f, c)| f + (f - c) * weight).collect());
            }
            if k > 0 {
                let error = self.error_norm(&row[k], &row[k - 1]);
                // That of T(k, k−1), whose order is 2k.
                let order = (2 * k + 1) as f64;
                let growth = (0.65 / error).powf(1.0 / order).clamp(0.05, 4.0) * 0.94;
                let cost = evaluation_count(k) / growth;
                if cost < cheapest {
                    (cheapest, factor) = (cost, growth);
                }
                if (error <= 1.0 && k + 1 >= MIN_COLUMNS) || at_min_step {
                    // It came easily: more columns are worth a longer step.
                    if k + 2 < MAX_COLUMNS && cost <= cheapest {
                        factor = growth * evaluation_count(k + 1) / evaluation_count(k);
                    }
                    return Ok((Some(row.swap_remove(k)), factor));
                }
            }
            previous_row = row;
        }
        Ok((None, factor.min(0.7)))
    }

    fn error_norm(&self, one: &[f64], other: &[f64]) -> f64 {
        let errors = one.iter().zip(other).zip(&self.error_scale);
        let errors = errors.map(|((a, b), scale)| (a - b).abs() / (TOLERANCE * scale));
        errors.fold(0.0, f64::max)
    }

    /// The midpoint rule in `parts` parts.
    fn midpoint(&self, step: f64, parts: usize, rates: &[f64]) -> Result<Vec<f64>> {
        let h = step / parts as f64;
        let mut before = self.y.clone();
        let euler_step = |from: &[f64], by: f64, derivative: &[f64]| -> Vec<f64> {
            let both = from.iter().zip(derivative);
            both.map(|(y, r)| y + by * r).collect()
        };
        let mut now = euler_step(&before, h, rates);
        for i in 1..parts {
            let derivative = self.ode.solve(self.t + h * i as f64, &now)?.derivative;
            let next = euler_step(&before, 2.0 * h, &derivative);
            before = std::mem::replace(&mut now, next);
        }
        let derivative = self.ode.solve(self.t + step, &now)?.derivative;
        let end = euler_step(&before, h, &derivative);
        let mean = now.iter().zip(end).map(|(now, end)| 0.5 * (now + end));
        Ok(mean.collect())
    }
}
