//! The motion by the classical Runge–Kutta method of fourth order with a fixed step, as it is often programmed, for
//! comparison with methods with step control.

use super::combination::Errors;
use super::evaluator::Evaluator;
use super::reference_solution::ReferenceSolution;
use super::studied_scene::StudiedScene;
use super::subject::Subject;
use dwell_dynamics::{DynamicsError, OdeSystem};
use std::time::Instant;

/// The step, s.
pub(super) const STEP: f64 = 1e-3;
/// Maximum number of steps; longer motions are omitted.
const MAX_STEPS: f64 = 1e6;

/// A motion by fixed steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedStep {
    /// Number of steps.
    pub steps: usize,
    /// Their time, in units of one exact evaluation.
    pub time: f64,
    /// The true errors.
    pub errors: Errors,
}

/// Integrates the motion by fixed steps; the subject's times between them are reached by partial steps.
pub(super) fn fixed_step<S: StudiedScene>(
    reference: &mut ReferenceSolution<'_, S>,
    evaluator: &dyn Evaluator,
    subject: &Subject<S>,
    evaluation_time: f64,
) -> Result<FixedStep, DynamicsError> {
    if subject.end() / STEP > MAX_STEPS {
        let (t, max_steps) = (0.0, MAX_STEPS as usize);
        return Err(DynamicsError::MaxStepsReached { t, max_steps });
    }
    let mut system = evaluator.system()?;
    let mut y = subject.initial_state.y.clone();
    let mut states = Vec::with_capacity(subject.times.len());
    let mut steps = 0;
    let started = Instant::now();
    for &t in &subject.times {
        while (steps + 1) as f64 * STEP <= t {
            let from = steps as f64 * STEP;
            y = runge_kutta(&mut *system, from, &y, STEP)?;
            steps += 1;
        }
        let from = steps as f64 * STEP;
        states.push(runge_kutta(&mut *system, from, &y, t - from)?);
    }
    Ok(FixedStep {
        steps,
        time: started.elapsed().as_secs_f64() / evaluation_time,
        errors: reference.errors(&states, &mut evaluator.reactions())?,
    })
}

/// A step of the classical method.
fn runge_kutta(
    system: &mut dyn OdeSystem,
    t: f64,
    y: &[f64],
    step: f64,
) -> Result<Vec<f64>, DynamicsError> {
    let moved = |slope: &[f64], part: f64| -> Vec<f64> {
        let sum = y.iter().zip(slope);
        sum.map(|(y, slope)| y + part * step * slope).collect()
    };
    let mut slopes = vec![vec![0.0; y.len()]; 4];
    system.rhs(t, y, &mut slopes[0])?;
    for (k, part) in [(1, 0.5), (2, 0.5), (3, 1.0)] {
        let state = moved(&slopes[k - 1], part);
        system.rhs(t + part * step, &state, &mut slopes[k])?;
    }
    let mean = (0..y.len())
        .map(|i| (slopes[0][i] + 2.0 * slopes[1][i] + 2.0 * slopes[2][i] + slopes[3][i]) / 6.0);
    Ok(moved(&mean.collect::<Vec<f64>>(), 1.0))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    /// y′ = y.
    struct Growth;

    impl OdeSystem for Growth {
        fn size(&self) -> usize {
            1
        }

        fn rhs(&mut self, _: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
            out[0] = y[0];
            Ok(())
        }

        fn jacobian(&mut self, _: f64, _: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
            out[0] = 1.0;
            Ok(())
        }
    }

    #[test]
    fn a_step_is_the_series_up_to_the_fourth_power() {
        let h: f64 = 0.25;
        let found = runge_kutta(&mut Growth, 0.0, &[1.0], h).unwrap()[0];
        let series = 1.0 + h + h * h / 2.0 + h.powi(3) / 6.0 + h.powi(4) / 24.0;
        assert!((found - series).abs() < 1e-15, "{found} and {series}");
        assert!((found - h.exp()).abs() > 1e-6);
    }
}
