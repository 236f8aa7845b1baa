//! Integration of order 8, of Dormand and Prince with Hairer's control of the step (DOP853), for what is
//! smooth.
//!
//! ```text
//! y₁ = y₀ + h Σ bᵢ kᵢ,   kᵢ = f(t₀ + cᵢ h, y₀ + h Σ aᵢⱼ kⱼ),   12 stages             (1)
//! e  = |h| e₅² / √(e₅² + e₃²/100),   e₅, e₃: the step less those of order 5 and 3    (2)
//! ```
//!
//! (Hairer, Nørsett and Wanner 1993, eq. II.10.17.) diffsol's explicit methods have at most 8 stages and one error
//! formula, so this one has steps of its own. It fits where diffsol's stand: behind the same `integrate`, watched in
//! the same way. An evaluation that fails shortens the step, and ends the motion where no step is short
//! enough. Three more stages are evaluated where something is looked for within a step.

mod coefficients;

use crate::driver::{Ended, Next, Watch};
use crate::error::DynamicsError;
use crate::options::{Options, Statistics};
use crate::system::{Point, System};
use coefficients::{DENSE, ERRORS, EXTRA, EXTRA_PLACES, PLACES, Row, STAGES, STEP};

/// Stages, the interpolant's among them.
const ALL: usize = 16;
/// The rates at the end of a step.
const LAST: usize = 12;
/// A new step is this part of what the error allows, and no less or more than these times the last.
const SAFETY: f64 = 0.9;
const LEAST: f64 = 1.0 / 3.0;
const MOST: f64 = 6.0;
/// Terms of the interpolant.
const TERMS: usize = 8;
/// Exponents of a step's own error and of the one before in the choice of the next step (Gustafsson): against
/// 1/8 and 0 a third fewer steps are rejected, at the same work for the same error.
const OWN: f64 = -(0.125 - 0.2 * BEFORE);
const BEFORE: f64 = 0.04;
/// Below this part of the tolerance an error is no guide.
const TINY: f64 = 1e-4;
/// What is left of a step in which an evaluation failed.
const FAILED: f64 = 0.25;
/// A step that ends within this part of itself before the end is stretched to it.
const STRETCHED: f64 = 0.01;

/// Integrates a system whose start has `rates`, by steps no shorter than `shortest` (s), each state to its own
/// absolute tolerance.
pub(crate) fn integrate(
    system: &mut dyn System,
    (start, rates): (&Point, &[f64]),
    end: Option<f64>,
    options: &Options,
    (absolute, shortest): (&[f64], f64),
    watch: Watch<'_>,
) -> Ended {
    let tolerance = (options.relative, absolute);
    let mut steps = Steps {
        stages: Stages::new(system, rates),
        tolerance,
        from: start.clone(),
        to: start.clone(),
        shortest,
        before: TINY,
        rejected: 0,
        taken: 0,
    };
    let failed = steps.all(end, options, watch).err();
    Ended {
        at: steps.from,
        failed,
        statistics: Statistics {
            steps: steps.taken,
            rejected: steps.rejected,
            evaluations: steps.stages.evaluations,
            ..Statistics::default()
        },
    }
}

struct Steps<'s> {
    stages: Stages<'s>,
    /// Relative, and absolute by state.
    tolerance: (f64, &'s [f64]),
    /// Where the step begins and ends.
    from: Point,
    to: Point,
    shortest: f64,
    /// Error of the step before, in units of the tolerance.
    before: f64,
    rejected: usize,
    taken: usize,
}

impl Steps<'_> {
    fn all(
        &mut self,
        end: Option<f64>,
        options: &Options,
        watch: Watch<'_>,
    ) -> Result<(), DynamicsError> {
        let longest = options.longest.unwrap_or(f64::INFINITY);
        let room = |t: f64| end.map_or(f64::INFINITY, |end| end - t);
        let mut h = self.first(room(self.from.t).min(longest));
        for _ in 0..options.budget {
            h = self.step(h.min(longest), end)?;
            let (stages, from, to) = (&mut self.stages, &self.from, &self.to);
            let mut ready = false;
            let next = watch(from, to, &mut |t, y| {
                if !ready {
                    stages.interpolant(from, to)?;
                    ready = true;
                }
                stages.inside((t - from.t) / (to.t - from.t), y);
                Ok(())
            })?;
            std::mem::swap(&mut self.from, &mut self.to);
            self.stages.go_on();
            if next == Next::Stop || room(self.from.t) <= 0.0 {
                return Ok(());
            }
        }
        Err(DynamicsError::Budget {
            t: self.from.t,
            steps: options.budget,
        })
    }

    /// Takes one step of about `h`, or less, and returns what the next may be.
    fn step(&mut self, mut h: f64, end: Option<f64>) -> Result<f64, DynamicsError> {
        let t = self.from.t;
        let mut most = MOST;
        let mut failure = None;
        loop {
            let end = end.filter(|end| end - t <= (1.0 + STRETCHED) * h);
            self.to.t = end.unwrap_or(t + h);
            // As long as rounding makes it.
            h = self.to.t - t;
            if !(h > self.shortest && t + 0.1 * h > t) {
                return Err(failure.unwrap_or(DynamicsError::SmallStep { t }));
            }
            if let Err(error) = self.stages.take(&self.from, h, &mut self.to) {
                // The first failure is the cause; what shorter steps then meet is not.
                failure.get_or_insert(error);
                (h, most) = (FAILED * h, 1.0);
                continue;
            }
            let error = self
                .stages
                .error(h, self.tolerance, [&self.from.y, &self.to.y]);
            // An error that is no number is not small.
            if error <= 1.0 {
                let factor = SAFETY * error.powf(OWN) * self.before.powf(BEFORE);
                self.before = error.max(TINY);
                self.taken += 1;
                return Ok(factor.clamp(LEAST, most) * h);
            }
            self.rejected += 1;
            let shorter = if error.is_finite() {
                (SAFETY * error.powf(-0.125)).max(LEAST)
            } else {
                FAILED
            };
            (h, most) = (shorter * h, 1.0);
        }
    }

    /// A first step of which an Euler step's curvature says that it fits (Hairer, Nørsett and Wanner 1993,
    /// II.4).
    fn first(&mut self, longest: f64) -> f64 {
        let (relative, absolute) = self.tolerance;
        let y = &self.from.y;
        let scale = |i: usize| absolute[i] + relative * y[i].abs();
        let norm = |of: &dyn Fn(usize) -> f64| {
            let sum: f64 = (0..y.len()).map(|i| (of(i) / scale(i)).powi(2)).sum();
            (sum / y.len() as f64).sqrt()
        };
        let Stages { rates, stage, .. } = &mut self.stages;
        let (size, speed) = (norm(&|i| y[i]), norm(&|i| rates[i][0]));
        let guess = if size > 1e-5 && speed > 1e-5 {
            0.01 * size / speed
        } else {
            1e-6
        };
        let guess = guess.min(longest);
        for (i, stage) in stage.iter_mut().enumerate() {
            *stage = y[i] + guess * rates[i][0];
        }
        if self.stages.evaluate(1, self.from.t + guess).is_err() {
            return guess;
        }
        let rates = &self.stages.rates;
        let turn = norm(&|i| rates[i][1] - rates[i][0]) / guess;
        let steepest = speed.max(turn);
        let second = if steepest > 1e-15 {
            (0.01 / steepest).powf(0.125)
        } else {
            (1e-3 * guess).max(1e-6)
        };
        (100.0 * guess).min(second).min(longest)
    }
}

/// The stages of one step.
struct Stages<'s> {
    system: &'s mut dyn System,
    /// By state, the rates at all stages.
    rates: Vec<[f64; ALL]>,
    /// By state: the increment of the step, and what earlier sums have lost to rounding.
    increment: Vec<f64>,
    lost: Vec<f64>,
    /// The same with that of the step just taken.
    losing: Vec<f64>,
    /// The state at a stage, and its rates.
    stage: Vec<f64>,
    out: Vec<f64>,
    /// By state, the interpolant's coefficients.
    terms: Vec<[f64; TERMS]>,
    evaluations: usize,
}

impl<'s> Stages<'s> {
    fn new(system: &'s mut dyn System, rates: &[f64]) -> Self {
        let n = rates.len();
        let first = |&rate: &f64| {
            let mut all = [0.0; ALL];
            all[0] = rate;
            all
        };
        let zeros = vec![0.0; n];
        Self {
            system,
            rates: rates.iter().map(first).collect(),
            increment: zeros.clone(),
            lost: zeros.clone(),
            losing: zeros.clone(),
            stage: zeros.clone(),
            out: zeros,
            terms: vec![[0.0; TERMS]; n],
            evaluations: 1,
        }
    }

    /// A step of `h` by (1), and the rates at its end.
    fn take(&mut self, from: &Point, h: f64, to: &mut Point) -> Result<(), DynamicsError> {
        for (k, (row, place)) in STAGES.iter().zip(&PLACES).enumerate() {
            self.at(row, from, h);
            self.evaluate(k + 1, from.t + place * h)?;
        }
        for (i, rates) in self.rates.iter().enumerate() {
            // What rounding took off the sum before is put back (Kahan).
            self.increment[i] = h * STEP.sum(rates) - self.lost[i];
            self.stage[i] = from.y[i] + self.increment[i];
        }
        to.y.copy_from_slice(&self.stage);
        self.evaluate(LAST, to.t)?;
        for (i, lost) in self.losing.iter_mut().enumerate() {
            *lost = (to.y[i] - from.y[i]) - self.increment[i];
        }
        Ok(())
    }

    /// The state at a stage.
    fn at(&mut self, row: &Row, from: &Point, h: f64) {
        for ((y, from), rates) in self.stage.iter_mut().zip(&from.y).zip(&self.rates) {
            *y = from + h * row.sum(rates);
        }
    }

    /// The rates of a stage, whose state is in `stage`.
    fn evaluate(&mut self, k: usize, t: f64) -> Result<(), DynamicsError> {
        self.evaluations += 1;
        self.system.rates(t, &self.stage, &mut self.out)?;
        for (rates, out) in self.rates.iter_mut().zip(&self.out) {
            rates[k] = *out;
        }
        Ok(())
    }

    /// The error of the step in units of the tolerance, by (2).
    fn error(&self, h: f64, (relative, absolute): (f64, &[f64]), y: [&[f64]; 2]) -> f64 {
        let [mut fifth, mut third] = [0.0; 2];
        for (i, rates) in self.rates.iter().enumerate() {
            let size = y[0][i].abs().max(y[1][i].abs());
            let scale = absolute[i] + relative * size;
            let [e5, e3] = [0, 1].map(|k: usize| ERRORS[k].sum(rates) / scale);
            fifth += e5 * e5;
            third += e3 * e3;
        }
        if fifth == 0.0 {
            return 0.0;
        }
        let n = self.rates.len() as f64;
        h * fifth / ((fifth + 0.01 * third) * n).sqrt()
    }

    /// The end of a step becomes the start of the next.
    fn go_on(&mut self) {
        for rates in &mut self.rates {
            rates[0] = rates[LAST];
        }
        std::mem::swap(&mut self.lost, &mut self.losing);
    }

    /// Makes the interpolant of the step taken, with three more stages.
    fn interpolant(&mut self, from: &Point, to: &Point) -> Result<(), DynamicsError> {
        let h = to.t - from.t;
        for (k, (row, place)) in EXTRA.iter().zip(&EXTRA_PLACES).enumerate() {
            self.at(row, from, h);
            self.evaluate(LAST + 1 + k, from.t + place * h)?;
        }
        for (i, (terms, rates)) in self.terms.iter_mut().zip(&self.rates).enumerate() {
            let along = to.y[i] - from.y[i];
            let bent = h * rates[0] - along;
            *terms = [
                from.y[i],
                along,
                bent,
                along - h * rates[LAST] - bent,
                h * DENSE[0].sum(rates),
                h * DENSE[1].sum(rates),
                h * DENSE[2].sum(rates),
                h * DENSE[3].sum(rates),
            ];
        }
        Ok(())
    }

    /// The state at a part of the step, of which the interpolant is known: its terms are taken alternately by
    /// what lies behind and what lies ahead.
    fn inside(&self, part: f64, y: &mut [f64]) {
        let factors = [part, 1.0 - part];
        for (y, terms) in y.iter_mut().zip(&self.terms) {
            let inner = (1..TERMS).rev();
            *y = inner.fold(0.0, |sum, k| (sum + terms[k]) * factors[(k + 1) % 2]) + terms[0];
        }
    }
}

impl Row {
    /// The weighted sum of a state's rates.
    #[inline]
    fn sum(&self, rates: &[f64; ALL]) -> f64 {
        let rest = self.rest.iter().zip(&rates[self.from..]);
        rest.fold(self.first * rates[0], |sum, (a, k)| sum + a * k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every quadrature condition, Σ bᵢ cᵢᵏ = 1/(k + 1), up to the order, and the rows' sums.
    #[test]
    fn coefficients_are_those_of_order_8() {
        let mut ones = [0.0; ALL];
        ones[..LAST].fill(1.0);
        let mut places = [0.0; ALL];
        places[1..LAST].copy_from_slice(&PLACES);
        for (row, place) in STAGES.iter().zip(&PLACES) {
            assert!((row.sum(&ones) - place).abs() < 1e-14);
        }
        let moment = |row: &Row, k: i32| row.sum(&places.map(|c| c.powi(k)));
        for k in 1..8 {
            let off = moment(&STEP, k) - 1.0 / f64::from(k + 1);
            assert!(off.abs() < 1e-14, "order {}: {off:e}", k + 1);
        }
        // The lower orders agree with it as far as they reach, and no further.
        for (row, reaches) in ERRORS.iter().zip([5, 3]) {
            for k in 1..=reaches {
                let off = moment(row, k);
                assert_eq!(off.abs() < 1e-14, k < reaches, "{k}: {off:e}");
            }
        }
    }
}
