//! Dense output of the method of order 8: the states within a step by its polynomial of degree 7, with three more stages.
//!
//! A step may be so long that a decaying part of the motion, which no longer counts at its end, is no polynomial within it: a step is then
//! limited by stability, |λ| h being several units, and not by its error. If states within such a step are requested, the step is repeated
//! in shorter parts, each with its own polynomial.

use super::coefficients::{DENSE, EXTRA_NODES, EXTRA_STAGES};
use super::{ALL_STAGES, END_STAGE, Stages};
use crate::error::Result;
use crate::ode::OdeState;

/// Terms of the interpolant.
const TERMS: usize = 8;
/// Parts have at most this h |λ|, as far as their number allows.
const PART_STIFFNESS: f64 = 1.5;
/// Below this h |λ| the polynomial of a step is as good as the step.
const MIN_STIFFNESS: f64 = 3.0;
const MAX_PARTS: usize = 8;

/// The states within a step.
pub(super) struct Interpolant {
    parts: usize,
    /// By part, then by state.
    terms: Vec<[f64; TERMS]>,
    /// By state: how far the parts end from the end of the step.
    shift: Vec<f64>,
    /// Rates at the end of the step, and the compensations of its sums, saved while parts are taken.
    end_rates: Vec<f64>,
    compensation: Vec<f64>,
}

impl Interpolant {
    pub(super) fn new(states: usize) -> Self {
        let zeros = vec![0.0; states];
        Self {
            parts: 1,
            terms: vec![[0.0; TERMS]; states],
            shift: zeros.clone(),
            end_rates: zeros.clone(),
            compensation: zeros,
        }
    }

    /// Builds the interpolation of the last step, with its h |λ|.
    pub(super) fn build(
        &mut self,
        stages: &mut Stages<'_>,
        [from, to]: [&OdeState; 2],
        stiffness: f64,
    ) -> Result<()> {
        self.parts = if stiffness > MIN_STIFFNESS {
            ((stiffness / PART_STIFFNESS).ceil() as usize).clamp(2, MAX_PARTS)
        } else {
            1
        };
        self.shift.fill(0.0);
        if self.parts == 1 {
            return stages.interpolate(from, to, &mut self.terms);
        }
        self.keep(stages);
        let taken = self.take_parts(stages, [from, to]);
        self.restore(stages);
        taken
    }

    /// Takes the step again in parts.
    fn take_parts(&mut self, stages: &mut Stages<'_>, [from, to]: [&OdeState; 2]) -> Result<()> {
        let states = from.y.len();
        self.terms.resize(self.parts * states, [0.0; TERMS]);
        let (mut begin, mut end) = (from.clone(), from.clone());
        let length = to.t - from.t;
        for part in 0..self.parts {
            end.t = from.t + length * (part + 1) as f64 / self.parts as f64;
            stages.take_step(&begin, end.t - begin.t, &mut end)?;
            let terms = &mut self.terms[part * states..][..states];
            stages.interpolate(&begin, &end, terms)?;
            stages.continue_from_end();
            std::mem::swap(&mut begin, &mut end);
        }
        for (shift, (to, end)) in self.shift.iter_mut().zip(to.y.iter().zip(&begin.y)) {
            *shift = to - end;
        }
        Ok(())
    }

    fn keep(&mut self, stages: &Stages<'_>) {
        for (kept, rates) in self.end_rates.iter_mut().zip(&stages.stage_rhs) {
            *kept = rates[END_STAGE];
        }
        self.compensation.copy_from_slice(&stages.next_compensation);
    }

    fn restore(&self, stages: &mut Stages<'_>) {
        for (kept, rates) in self.end_rates.iter().zip(&mut stages.stage_rhs) {
            rates[END_STAGE] = *kept;
        }
        stages.next_compensation.copy_from_slice(&self.compensation);
    }

    /// The state at a fraction of the step: terms are multiplied alternately by the fraction and by one minus the fraction.
    pub(super) fn at(&self, fraction: f64, y: &mut [f64]) {
        let place = fraction * self.parts as f64;
        let part = (place.max(0.0) as usize).min(self.parts - 1);
        let behind = place - part as f64;
        let factors = [behind, 1.0 - behind];
        let terms = &self.terms[part * y.len()..];
        for ((y, terms), shift) in y.iter_mut().zip(terms).zip(&self.shift) {
            let inner = (1..TERMS).rev();
            let value = inner.fold(0.0, |sum, k| (sum + terms[k]) * factors[(k + 1) % 2]);
            *y = value + terms[0] + fraction * shift;
        }
    }
}

impl Stages<'_> {
    /// The polynomial of the step that was taken last, by state.
    fn interpolate(
        &mut self,
        from: &OdeState,
        to: &OdeState,
        out: &mut [[f64; TERMS]],
    ) -> Result<()> {
        let h = to.t - from.t;
        for (k, (row, node)) in EXTRA_STAGES.iter().zip(&EXTRA_NODES).enumerate() {
            self.set_stage_state(row, from, h);
            self.evaluate_stage(END_STAGE + 1 + k, from.t + node * h)?;
        }
        let states = out.iter_mut().zip(&self.stage_rhs);
        for (i, (terms, rates)) in states.enumerate() {
            let rates: &[f64; ALL_STAGES] = rates;
            let increment = to.y[i] - from.y[i];
            let slope_difference = h * rates[0] - increment;
            *terms = [
                from.y[i],
                increment,
                slope_difference,
                increment - h * rates[END_STAGE] - slope_difference,
                h * DENSE[0].weighted_sum(rates),
                h * DENSE[1].weighted_sum(rates),
                h * DENSE[2].weighted_sum(rates),
                h * DENSE[3].weighted_sum(rates),
            ];
        }
        Ok(())
    }

    /// The next part begins with the rates at the end of this one.
    pub(super) fn continue_from_end(&mut self) {
        for rates in &mut self.stage_rhs {
            rates[0] = rates[END_STAGE];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ode::OdeSystem;

    /// ẏ₀ = −λ (y₀ − cos t), ẏ₁ = y₀: a current that decays to what a voltage asks for, and its integral.
    struct Decay;

    const RATE: f64 = 150.0;
    const TRANSIENT: f64 = 1e-4;

    impl OdeSystem for Decay {
        fn size(&self) -> usize {
            2
        }

        fn rhs(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
            out.copy_from_slice(&[-RATE * (y[0] - t.cos()), y[0]]);
            Ok(())
        }

        fn jacobian(&mut self, _: f64, _: &[f64], out: &mut [f64]) -> Result<()> {
            out.copy_from_slice(&[-RATE, 0.0, 1.0, 0.0]);
            Ok(())
        }
    }

    /// y₀ in closed form.
    fn exact(t: f64) -> f64 {
        let forced = RATE * (RATE * t.cos() + t.sin()) / (RATE * RATE + 1.0);
        forced + TRANSIENT * (-RATE * t).exp()
    }

    #[test]
    fn a_transient_within_a_long_step_is_resolved() {
        let from = OdeState {
            t: 0.0,
            y: vec![exact(0.0), 0.0],
        };
        let (mut system, mut rates) = (Decay, [0.0; 2]);
        system.rhs(0.0, &from.y, &mut rates).expect("rates");
        let mut to = from.clone();
        to.t = 0.035;
        let mut stages = Stages::new(&mut system, &rates);
        stages.take_step(&from, to.t, &mut to).expect("a step");
        let stiffness = stages.stiffness(to.t, &[1e-8; 2], &to.y);
        assert!((stiffness - RATE * to.t).abs() < 0.1, "{stiffness}");
        let ends = [&from, &to];
        let mut error = |stiffness: f64| {
            let mut interpolant = Interpolant::new(2);
            let before = stages.stage_rhs.clone();
            interpolant
                .build(&mut stages, ends, stiffness)
                .expect("dense output");
            let ends = |all: &[[f64; ALL_STAGES]]| -> Vec<f64> {
                all.iter().map(|rates| rates[END_STAGE]).collect()
            };
            // The next step begins as if nothing had been asked.
            assert_eq!(ends(&before), ends(&stages.stage_rhs));
            let mut y = [0.0; 2];
            let errors = (0..=100).map(|k| {
                let fraction = f64::from(k) / 100.0;
                interpolant.at(fraction, &mut y);
                (y[0] - exact(fraction * to.t)).abs()
            });
            errors.fold(0.0, f64::max)
        };
        let (whole, parts) = (error(0.0), error(stiffness));
        let own = (to.y[0] - exact(to.t)).abs();
        assert!(whole > 0.5 * TRANSIENT, "{whole:e}");
        assert!(parts < 2.0 * own, "{parts:e}, {own:e}");
    }
}
