//! The method of order 8 of Dormand and Prince with Hairer's step-size control (DOP853), for smooth systems.
//!
//! ```text
//! y₁ = y₀ + h Σ bᵢ kᵢ,   kᵢ = f(t₀ + cᵢ h, y₀ + h Σ aᵢⱼ kⱼ),   12 stages             (1)
//! e  = |h| e₅² / √(e₅² + e₃²/100),   e₅, e₃: the step less those of order 5 and 3    (2)
//! ```
//!
//! (Hairer, Nørsett and Wanner 1993, eq. II.10.17.) diffsol's explicit methods have at most 8 stages and one error
//! formula, so this method has its own step loop, which `integrate` calls with the same observers. A failed
//! evaluation shortens the step, and ends the motion if no step is short enough. Three more stages are evaluated if
//! dense output is needed within a step.

mod coefficients;
mod interpolation;

use crate::error::{DynamicsError, Result};
use crate::integration_parts::Part;
use crate::ode::{OdeState, OdeSystem, StepControl, StepObserver, Termination};
use crate::options::Statistics;
use crate::pace::Pace;
use crate::time_pieces::TimePieces;
use coefficients::{ERRORS, NODES, Row, STAGES, WEIGHTS};
use interpolation::Interpolant;

/// Stages, the interpolant's among them.
const ALL_STAGES: usize = 16;
/// The stage at the end of a step.
const END_STAGE: usize = 12;
/// A new step is this fraction of the step that the error allows, within these multiples of the last step.
const SAFETY: f64 = 0.9;
const MIN_FACTOR: f64 = 1.0 / 3.0;
const MAX_FACTOR: f64 = 6.0;
/// Exponents of a step's error and of the one before in the choice of the next step (Gustafsson): compared with
/// 1/8 and 0, a third fewer steps are rejected, with the same work for the same error.
const ERROR_EXPONENT: f64 = -(0.125 - 0.2 * PREVIOUS_ERROR_EXPONENT);
const PREVIOUS_ERROR_EXPONENT: f64 = 0.04;
/// An error below this part of the tolerance does not control the step.
const MIN_ERROR: f64 = 1e-4;
/// h |λ| up to which the method is stable on the real axis (Hairer and Wanner 1996, IV.2).
const STABILITY_LIMIT: f64 = 6.1;
/// h |λ| above which a step is repeated with a shorter length, because (2) may be smaller than the error of such a step
/// (decision 52).
const MAX_STIFFNESS: f64 = 4.0;
/// No decay is this stiff in a step that (2) accepts; a larger value is the rounding of two states that hardly differ.
const ROUNDING_STIFFNESS: f64 = 9.0;
/// The factor of a step in which an evaluation failed.
const FAILURE_REDUCTION: f64 = 0.25;
/// A step that ends within this part of itself before the end is stretched to it.
const STRETCH_FRACTION: f64 = 0.01;

/// An integration of a part of a motion.
pub(crate) struct Stepper<'s> {
    stages: Stages<'s>,
    part: &'s Part,
    /// The absolute tolerance, by state.
    atol: &'s [f64],
    /// Where the step begins and ends.
    from: OdeState,
    to: OdeState,
    min_step: f64,
    /// Error of the step before, in units of the tolerance.
    previous_error: f64,
    /// h |λ| of the step.
    stiffness: f64,
    interpolant: Interpolant,
    statistics: Statistics,
}

impl<'s> Stepper<'s> {
    /// Of a part whose start has `rates`, by steps no shorter than `min_step` (s), each state to its own absolute tolerance.
    pub(crate) fn new(
        system: &'s mut dyn OdeSystem,
        part: &'s Part,
        rates: &[f64],
        atol: &'s [f64],
        min_step: f64,
    ) -> Self {
        Self {
            stages: Stages::new(system, rates),
            part,
            atol,
            from: part.start.clone(),
            to: part.start.clone(),
            min_step,
            previous_error: MIN_ERROR,
            stiffness: 0.0,
            interpolant: Interpolant::new(rates.len()),
            statistics: Statistics::default(),
        }
    }

    /// Integrates; `pieces` and `pace` limit the steps.
    pub(crate) fn integrate(
        mut self,
        pieces: Option<&mut TimePieces<'_>>,
        pace: &mut Pace,
        observer: StepObserver<'_>,
    ) -> Termination {
        let error = self.run(pieces, pace, observer).err();
        self.statistics.evaluations = self.stages.evaluations;
        Termination {
            state: self.from,
            error,
            statistics: self.statistics,
        }
    }

    fn run(
        &mut self,
        mut pieces: Option<&mut TimePieces<'_>>,
        pace: &mut Pace,
        observer: StepObserver<'_>,
    ) -> Result<()> {
        let (options, end) = (&self.part.options, self.part.end);
        let max_step = options.max_step.unwrap_or(f64::INFINITY);
        let mut longest = |t: f64| -> Result<f64> {
            Ok(match &mut pieces {
                Some(pieces) => max_step.min(pieces.latest_end(t)? - t),
                None => max_step,
            })
        };
        let remaining = |t: f64| end.map_or(f64::INFINITY, |end| end - t);
        let first = remaining(self.from.t).min(longest(self.from.t)?);
        // Behind an event the step before it fits, where the rates that jump have their size.
        let mut h = match self.part.first_step {
            Some(step) => step.min(first),
            None => self.initial_step(first),
        };
        for _ in 0..options.max_steps {
            h = self.step(h.min(longest(self.from.t)?), end)?;
            pace.step_taken(self.to.t)?;
            let (system, to) = (&mut self.stages.system, &self.to);
            pace.look_at_balance(to.t, || system.balance(to))?;
            let (stages, from, to) = (&mut self.stages, &self.from, &self.to);
            let (interpolant, stiffness) = (&mut self.interpolant, self.stiffness);
            let mut ready = false;
            let control = observer(from, to, &mut |t, y| {
                if !ready {
                    interpolant.build(stages, [from, to], stiffness)?;
                    ready = true;
                }
                interpolant.at((t - from.t) / (to.t - from.t), y);
                Ok(())
            })?;
            std::mem::swap(&mut self.from, &mut self.to);
            self.stages.advance();
            if control == StepControl::Stop || remaining(self.from.t) <= 0.0 {
                return Ok(());
            }
        }
        Err(DynamicsError::MaxStepsReached {
            t: self.from.t,
            max_steps: options.max_steps,
        })
    }

    /// Takes one step of length `h` or less, and returns the length of the next.
    fn step(&mut self, mut h: f64, end: Option<f64>) -> Result<f64> {
        let t = self.from.t;
        let mut max_factor = MAX_FACTOR;
        let mut failure = None;
        let mut is_repeated = false;
        loop {
            let end = end.filter(|end| end - t <= (1.0 + STRETCH_FRACTION) * h);
            self.to.t = end.unwrap_or(t + h);
            // Its length after rounding.
            h = self.to.t - t;
            if !(h > self.min_step && t + 0.1 * h > t) {
                return Err(failure.unwrap_or(DynamicsError::StepTooSmall { t }));
            }
            if let Err(error) = self.stages.take_step(&self.from, h, &mut self.to) {
                // The first failure is the cause; later ones of shorter steps are not.
                failure.get_or_insert(error);
                (h, max_factor) = (FAILURE_REDUCTION * h, 1.0);
                continue;
            }
            let ends = [&self.from.y[..], &self.to.y[..]];
            let error = self
                .stages
                .error_norm(h, self.part.options.rtol, self.atol, ends);
            // NaN is not accepted.
            if error <= 1.0 {
                self.stiffness = self.stages.stiffness(h, self.atol, &self.to.y);
                let is_stiff = (MAX_STIFFNESS..ROUNDING_STIFFNESS).contains(&self.stiffness);
                let stable = MAX_STIFFNESS / self.stiffness;
                if is_stiff && error > MIN_ERROR && !is_repeated {
                    self.statistics.rejected_steps += 1;
                    (h, max_factor, is_repeated) = (stable * h, 1.0, true);
                    continue;
                }
                let factor = SAFETY
                    * error.powf(ERROR_EXPONENT)
                    * self.previous_error.powf(PREVIOUS_ERROR_EXPONENT);
                self.previous_error = error.max(MIN_ERROR);
                self.statistics.steps += 1;
                let is_limited = is_repeated || self.stiffness > STABILITY_LIMIT;
                self.statistics.stiff_steps += usize::from(is_limited);
                return Ok(factor.clamp(MIN_FACTOR, max_factor) * h);
            }
            self.statistics.rejected_steps += 1;
            let shorter = if error.is_finite() {
                (SAFETY * error.powf(-0.125)).max(MIN_FACTOR)
            } else {
                FAILURE_REDUCTION
            };
            (h, max_factor) = (shorter * h, 1.0);
        }
    }

    /// A first step from the curvature that an Euler step shows (Hairer, Nørsett and Wanner 1993,
    /// II.4).
    fn initial_step(&mut self, max_step: f64) -> f64 {
        let (rtol, atol) = (self.part.options.rtol, self.atol);
        let y = &self.from.y;
        let scale = |i: usize| atol[i] + rtol * y[i].abs();
        let norm = |of: &dyn Fn(usize) -> f64| {
            let sum: f64 = (0..y.len()).map(|i| (of(i) / scale(i)).powi(2)).sum();
            (sum / y.len() as f64).sqrt()
        };
        let Stages {
            stage_rhs: rates,
            stage_state: stage,
            ..
        } = &mut self.stages;
        let (size, speed) = (norm(&|i| y[i]), norm(&|i| rates[i][0]));
        let guess = if size > 1e-5 && speed > 1e-5 {
            0.01 * size / speed
        } else {
            1e-6
        };
        let guess = guess.min(max_step);
        for (i, stage) in stage.iter_mut().enumerate() {
            *stage = y[i] + guess * rates[i][0];
        }
        if self.stages.evaluate_stage(1, self.from.t + guess).is_err() {
            return guess;
        }
        let rates = &self.stages.stage_rhs;
        let rhs_change = norm(&|i| rates[i][1] - rates[i][0]) / guess;
        let steepest = speed.max(rhs_change);
        let second = if steepest > 1e-15 {
            (0.01 / steepest).powf(0.125)
        } else {
            (1e-3 * guess).max(1e-6)
        };
        (100.0 * guess).min(second).min(max_step)
    }
}

/// The stages of one step.
struct Stages<'s> {
    system: &'s mut dyn OdeSystem,
    /// By state, the rates at all stages.
    stage_rhs: Vec<[f64; ALL_STAGES]>,
    /// By state: the increment of the step, and the rounding of earlier sums.
    increment: Vec<f64>,
    compensation: Vec<f64>,
    /// The compensation after the step.
    next_compensation: Vec<f64>,
    /// The state at a stage, the state at the twelfth stage, and rates.
    stage_state: Vec<f64>,
    stage_12_state: Vec<f64>,
    rhs: Vec<f64>,
    evaluations: usize,
}

impl<'s> Stages<'s> {
    fn new(system: &'s mut dyn OdeSystem, rates: &[f64]) -> Self {
        let first = |&rate: &f64| {
            let mut all = [0.0; ALL_STAGES];
            all[0] = rate;
            all
        };
        let zeros = vec![0.0; rates.len()];
        Self {
            system,
            stage_rhs: rates.iter().map(first).collect(),
            increment: zeros.clone(),
            compensation: zeros.clone(),
            next_compensation: zeros.clone(),
            stage_state: zeros.clone(),
            stage_12_state: zeros.clone(),
            rhs: zeros,
            evaluations: 1,
        }
    }

    /// A step of `h` by (1), and the rates at its end.
    fn take_step(&mut self, from: &OdeState, h: f64, to: &mut OdeState) -> Result<()> {
        for (k, (row, node)) in STAGES.iter().zip(&NODES).enumerate() {
            self.set_stage_state(row, from, h);
            self.evaluate_stage(k + 1, from.t + node * h)?;
        }
        self.stage_12_state.copy_from_slice(&self.stage_state);
        for (i, rates) in self.stage_rhs.iter().enumerate() {
            // The rounding of the sum before is compensated (Kahan).
            self.increment[i] = h * WEIGHTS.weighted_sum(rates) - self.compensation[i];
            self.stage_state[i] = from.y[i] + self.increment[i];
        }
        to.y.copy_from_slice(&self.stage_state);
        self.evaluate_stage(END_STAGE, to.t)?;
        for (i, next_loss) in self.next_compensation.iter_mut().enumerate() {
            *next_loss = (to.y[i] - from.y[i]) - self.increment[i];
        }
        Ok(())
    }

    /// The state at a stage.
    fn set_stage_state(&mut self, row: &Row, from: &OdeState, h: f64) {
        let states = self.stage_state.iter_mut().zip(&from.y);
        for ((y, from), rates) in states.zip(&self.stage_rhs) {
            *y = from + h * row.weighted_sum(rates);
        }
    }

    /// Evaluates the rates of a stage, whose state is in `stage_state`.
    fn evaluate_stage(&mut self, k: usize, t: f64) -> Result<()> {
        self.evaluations += 1;
        self.system.rhs(t, &self.stage_state, &mut self.rhs)?;
        for (rates, out) in self.stage_rhs.iter_mut().zip(&self.rhs) {
            rates[k] = *out;
        }
        Ok(())
    }

    /// The error of the step in units of the tolerance, by (2).
    fn error_norm(&self, h: f64, rtol: f64, atol: &[f64], y: [&[f64]; 2]) -> f64 {
        let [mut fifth, mut third] = [0.0; 2];
        for (i, rates) in self.stage_rhs.iter().enumerate() {
            let size = y[0][i].abs().max(y[1][i].abs());
            let scale = atol[i] + rtol * size;
            let [e5, e3] = [0, 1].map(|k: usize| ERRORS[k].weighted_sum(rates) / scale);
            fifth += e5 * e5;
            third += e3 * e3;
        }
        if fifth == 0.0 {
            return 0.0;
        }
        let n = self.stage_rhs.len() as f64;
        h * fifth / ((fifth + 0.01 * third) * n).sqrt()
    }

    /// h |λ| of the largest eigenvalue, from two states at the end of the step: the stage's and the step's.
    fn stiffness(&self, h: f64, atol: &[f64], end: &[f64]) -> f64 {
        let [mut rhs_difference, mut state_difference] = [0.0; 2];
        for (i, all) in self.stage_rhs.iter().enumerate() {
            rhs_difference += ((all[END_STAGE] - all[END_STAGE - 1]) / atol[i]).powi(2);
            state_difference += ((end[i] - self.stage_12_state[i]) / atol[i]).powi(2);
        }
        if state_difference > 0.0 {
            h * (rhs_difference / state_difference).sqrt()
        } else {
            0.0
        }
    }

    /// The end of a step becomes the start of the next.
    fn advance(&mut self) {
        self.continue_from_end();
        std::mem::swap(&mut self.compensation, &mut self.next_compensation);
    }
}

impl Row {
    /// The weighted sum of a state's rates.
    #[inline]
    fn weighted_sum(&self, rates: &[f64; ALL_STAGES]) -> f64 {
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
        let mut ones = [0.0; ALL_STAGES];
        ones[..END_STAGE].fill(1.0);
        let mut nodes = [0.0; ALL_STAGES];
        nodes[1..END_STAGE].copy_from_slice(&NODES);
        for (row, node) in STAGES.iter().zip(&NODES) {
            assert!((row.weighted_sum(&ones) - node).abs() < 1e-14);
        }
        let moment = |row: &Row, k: i32| row.weighted_sum(&nodes.map(|c| c.powi(k)));
        for k in 1..8 {
            let difference = moment(&WEIGHTS, k) - 1.0 / f64::from(k + 1);
            assert!(difference.abs() < 1e-14, "order {}: {difference:e}", k + 1);
        }
        // The lower orders agree with it as far as they reach, and no further.
        for (row, order) in ERRORS.iter().zip([5, 3]) {
            for k in 1..=order {
                let difference = moment(row, k);
                assert_eq!(difference.abs() < 1e-14, k < order, "{k}: {difference:e}");
            }
        }
    }
}
