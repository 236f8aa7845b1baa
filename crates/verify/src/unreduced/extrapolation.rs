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
//! gains two orders a column. What begins the table is Gragg's ½ (z_n + z_{n−1} + h f(z_n)): it looks at
//! the end of the step too, so that a jump of the forces shortly before it is not passed unseen. The step
//! is done as soon as the last two columns agree; the next is as long as the number of evaluations for
//! its length makes worth while.

use super::equations::Meshed;
use super::{MotionSample, UnreducedError};

/// Error of a step, relative to the largest of its kind so far.
const TOLERANCE: f64 = 1e-13;
/// Most columns of the table: order 20; and the fewest, for two that agree by chance are no proof.
const COLUMNS: usize = 10;
const FEWEST: usize = 3;
/// Most steps of a run, tried and taken.
const BUDGET: usize = 20_000;
/// A step this short, relative to what the motion takes for a radian or a size, crosses a jump of
/// the forces: no order is left, and what it is wrong by is no more than itself.
const SHORTEST: f64 = 1e-13;

/// A run in the making.
pub(super) struct Steps<'a> {
    of: &'a Meshed<'a>,
    t: f64,
    y: Vec<f64>,
    /// Length of the next step, s.
    length: f64,
    /// By state: what its error is relative to.
    scale: Vec<f64>,
    left: usize,
    span: f64,
}

/// What came of an attempted step.
enum Attempt {
    /// The new state, and by what the length may change.
    Done(Vec<f64>, f64),
    /// By what the length must change.
    Again(f64),
}

/// Evaluations of the table up to row k, the first at the start of the step.
fn effort(k: usize) -> f64 {
    (0..=k).map(|i| (2 * i + 2) as f64).sum::<f64>() + 1.0
}

impl<'a> Steps<'a> {
    pub(super) fn new(
        of: &'a Meshed<'a>,
        start: &MotionSample,
        end: Option<f64>,
    ) -> Result<Self, UnreducedError> {
        let (x, v) = of.frames.enter(&start.bodies, &start.velocity);
        let mut y = vec![0.0; of.states()];
        y[..x.len()].copy_from_slice(&x);
        y[x.len()..2 * x.len()].copy_from_slice(&v);
        of.project(start.t, &mut y)?;
        let span = end.map_or(1.0, |end| end - start.t);
        let mut steps = Self {
            of,
            t: start.t,
            scale: vec![0.0; y.len()],
            y,
            length: span,
            left: BUDGET,
            span,
        };
        let rates = of.solve(steps.t, &steps.y)?.rates;
        steps.length = (0.1 / steps.measure(&rates)).min(span);
        Ok(steps)
    }

    pub(super) fn sample(&self) -> Result<MotionSample, UnreducedError> {
        self.of.sample(self.t, &self.y)
    }

    /// Takes a state's rates into the scales; how fast it moves, in sizes or rad, 1/s.
    fn measure(&mut self, rates: &[f64]) -> f64 {
        let frames = &self.of.frames;
        let n = frames.count();
        let (v, a) = (&rates[..n], &rates[n..2 * n]);
        let fast = frames.reach(v).max(frames.reach(a).sqrt());
        let fast = fast.max(1.0 / self.span);
        for (i, scale) in self.scale.iter_mut().enumerate() {
            let now = if i < n {
                frames.size * frames.column_scale(i)
            } else if i < 2 * n {
                fast * frames.size * frames.column_scale(i - n)
            } else {
                let largest = self.y[i].abs().max(rates[i].abs() / fast);
                if largest > 0.0 {
                    largest
                } else {
                    f64::MIN_POSITIVE
                }
            };
            *scale = scale.max(now);
        }
        fast
    }

    /// Goes on to a time.
    pub(super) fn advance(&mut self, to: f64) -> Result<(), UnreducedError> {
        while self.t < to {
            let stuck = UnreducedError::Steps { t: self.t };
            self.left = self.left.checked_sub(1).ok_or(stuck)?;
            let rest = to - self.t;
            // No crumb is left behind.
            let cut = rest <= 1.01 * self.length;
            let length = if cut { rest } else { self.length };
            let rates = self.of.solve(self.t, &self.y)?.rates;
            let fast = self.measure(&rates);
            match self.attempt(length, &rates, length * fast <= SHORTEST)? {
                Attempt::Done(y, factor) => {
                    self.t = if cut { to } else { self.t + length };
                    self.y = y;
                    let next = length * factor;
                    self.length = if cut { self.length.max(next) } else { next };
                    self.of.project(self.t, &mut self.y)?;
                }
                Attempt::Again(factor) => self.length = length * factor,
            }
        }
        Ok(())
    }

    fn attempt(
        &self,
        length: f64,
        rates: &[f64],
        shortest: bool,
    ) -> Result<Attempt, UnreducedError> {
        let mut above: Vec<Vec<f64>> = vec![];
        let mut factor = 0.1;
        let mut cheapest = f64::INFINITY;
        for k in 0..COLUMNS {
            let first = match self.midpoint(length, 2 * (k + 1), rates) {
                Ok(first) => first,
                Err(error) if shortest => return Err(error),
                // The midpoint rule went where there is no motion.
                Err(_) => return Ok(Attempt::Again(0.25)),
            };
            let mut line = vec![first];
            for (j, coarse) in above.iter().enumerate() {
                let ratio = (k + 1) as f64 / (k - j) as f64;
                let weight = 1.0 / (ratio * ratio - 1.0);
                let fine = &line[j];
                let better = fine.iter().zip(coarse).map(|(f, c)| f + (f - c) * weight);
                let better = better.collect();
                line.push(better);
            }
            if k > 0 {
                let error = self.error(&line[k], &line[k - 1]);
                // That of T(k, k−1), whose order is 2k.
                let order = (2 * k + 1) as f64;
                let may = (0.65 / error).powf(1.0 / order).clamp(0.05, 4.0) * 0.94;
                let cost = effort(k) / may;
                if cost < cheapest {
                    (cheapest, factor) = (cost, may);
                }
                if (error <= 1.0 && k + 1 >= FEWEST) || shortest {
                    // It came easily: more columns are worth a longer step.
                    if k + 2 < COLUMNS && cost <= cheapest {
                        factor = may * effort(k + 1) / effort(k);
                    }
                    return Ok(Attempt::Done(line.swap_remove(k), factor));
                }
            }
            above = line;
        }
        Ok(Attempt::Again(factor.min(0.7)))
    }

    fn error(&self, one: &[f64], other: &[f64]) -> f64 {
        let each = one.iter().zip(other).zip(&self.scale);
        each.map(|((a, b), scale)| (a - b).abs() / (TOLERANCE * scale))
            .fold(0.0, f64::max)
    }

    /// The midpoint rule in `parts` parts.
    fn midpoint(
        &self,
        length: f64,
        parts: usize,
        rates: &[f64],
    ) -> Result<Vec<f64>, UnreducedError> {
        let h = length / parts as f64;
        let mut before = self.y.clone();
        let along = |from: &[f64], by: f64, rates: &[f64]| -> Vec<f64> {
            from.iter().zip(rates).map(|(y, r)| y + by * r).collect()
        };
        let mut now = along(&before, h, rates);
        for i in 1..parts {
            let rates = self.of.solve(self.t + h * i as f64, &now)?.rates;
            let next = along(&before, 2.0 * h, &rates);
            before = std::mem::replace(&mut now, next);
        }
        let rates = self.of.solve(self.t + length, &now)?.rates;
        let end = along(&before, h, &rates);
        let mean = now.iter().zip(end).map(|(now, end)| 0.5 * (now + end));
        Ok(mean.collect())
    }
}
