//! Runs of combinations.

use super::combination::Effort;
use super::evaluator::Evaluator;
use super::studied_scene::StudiedScene;
use super::subject::Subject;
use dwell_dynamics::{
    DenseOutput, DynamicsError, Method, OdeState, Options, Orbit, ReducedState, Statistics,
    StepControl, integrate,
};
use dwell_geometry::PositionError;
use std::time::Instant;

/// Evaluators other than the exact one may take this multiple of its steps: their values are not
/// smooth below their accuracy, where an integrator would not end.
const NON_SMOOTH_STEP_FACTOR: usize = 3;
const EXTRA_STEPS: usize = 200;
/// Smallest useful ratio of a tolerance to the accuracy of an evaluation.
const MIN_TOLERANCE_RATIO: f64 = 1e-2;

/// The states at the subject's times, and their cost.
#[derive(Debug, Clone)]
pub(super) struct Run {
    pub(super) states: Vec<Vec<f64>>,
    pub(super) statistics: Statistics,
    pub(super) seconds: f64,
}

/// The runs of one method with one evaluator, from the coarsest tolerance on.
#[derive(Debug, Clone)]
pub(super) struct ToleranceSeries {
    pub(super) method: Method,
    pub(super) runs: Vec<(f64, Run)>,
    /// The omitted runs, with the reason.
    pub(super) omitted: Vec<String>,
}

/// Integrates the motion at one tolerance.
pub(super) fn solve<S: StudiedScene>(
    evaluator: &dyn Evaluator,
    subject: &Subject<S>,
    method: Method,
    tolerance: f64,
    max_steps: usize,
) -> Result<Run, DynamicsError> {
    let options = Options {
        max_steps,
        ..Options::new(method, tolerance)
    };
    let mut system = evaluator.system()?;
    let mut states: Vec<Vec<f64>> = Vec::with_capacity(subject.times.len());
    let mut observer = |_: &OdeState, current: &OdeState, dense: DenseOutput<'_>| {
        while let Some(&t) = subject.times.get(states.len()).filter(|t| **t <= current.t) {
            let mut y = current.y.clone();
            if t < current.t {
                dense(t, &mut y)?;
            }
            states.push(y);
        }
        Ok(StepControl::Continue)
    };
    let (start, end) = (&subject.initial_state, Some(subject.end()));
    let started = Instant::now();
    let termination = integrate(&mut *system, start, end, &options, &mut observer)?;
    let seconds = started.elapsed().as_secs_f64();
    match termination.error {
        Some(error) => Err(error),
        None if states.len() < subject.times.len() => Err(DynamicsError::DurationTooShort),
        None => Ok(Run {
            states,
            statistics: termination.statistics,
            seconds,
        }),
    }
}

/// The reason for an omitted run. A NaN coordinate is not printed.
pub(super) fn reason(error: &DynamicsError) -> String {
    match error {
        DynamicsError::Position(PositionError::NotFinite) => {
            "its coordinates grow beyond all numbers".to_owned()
        }
        other => other.to_string(),
    }
}

/// The motion by quadrature.
pub(super) fn quadrature<S: StudiedScene>(
    evaluator: &dyn Evaluator,
    subject: &Subject<S>,
) -> Option<Run> {
    let started = Instant::now();
    let (orbit, evaluations) = evaluator.orbit(subject.reduced_state())?;
    let states = orbit_states(&orbit, &subject.times);
    Some(Run {
        states,
        seconds: started.elapsed().as_secs_f64(),
        statistics: Statistics {
            evaluations,
            ..Statistics::default()
        },
    })
}

/// The states of an orbit.
pub(super) fn orbit_states(orbit: &Orbit, times: &[f64]) -> Vec<Vec<f64>> {
    let state = |&t: &f64| {
        let ReducedState { q, q_dot, .. } = orbit.state_at(t);
        vec![q, q_dot]
    };
    times.iter().map(state).collect()
}

impl ToleranceSeries {
    /// Runs a method through the tolerances. `exact` are its runs with the mechanism itself.
    pub(super) fn new<S: StudiedScene>(
        evaluator: &dyn Evaluator,
        subject: &Subject<S>,
        method: Method,
        effort: &Effort,
        exact: Option<&Self>,
    ) -> Self {
        let mut series = Self {
            method,
            runs: Vec::new(),
            omitted: Vec::new(),
        };
        let evaluation = evaluator.evaluation();
        for power in &effort.tolerance_exponents {
            let tolerance = 10_f64.powi(*power);
            let (by, method_name) = (evaluation.name(), method.name());
            let name = format!("{by}, {method_name} at {tolerance:.0e}");
            if tolerance < MIN_TOLERANCE_RATIO * evaluation.relative_error() {
                break;
            }
            let (max_steps, non_smooth_text) = match exact.map(|exact| exact.run_at(tolerance)) {
                None => (effort.max_steps, ""),
                // The reason is the same as for the mechanism itself.
                Some(None) => continue,
                Some(Some(run)) => (
                    NON_SMOOTH_STEP_FACTOR * run.statistics.steps + EXTRA_STEPS,
                    ", far more than of the mechanism itself: it is not smooth there",
                ),
            };
            let too_many_steps =
                || format!("{name} and finer: more than {max_steps} steps{non_smooth_text}");
            if series.predicted_steps() > max_steps as f64 {
                series.omitted.push(too_many_steps());
                break;
            }
            match solve(evaluator, subject, method, tolerance, max_steps) {
                Ok(run) => series.runs.push((tolerance, run)),
                Err(DynamicsError::MaxStepsReached { .. }) => {
                    series.omitted.push(too_many_steps());
                    break;
                }
                Err(error) => series.omitted.push(format!("{name}: {}", reason(&error))),
            }
        }
        series
    }

    /// The predicted number of steps at the next tolerance, by extrapolation.
    pub(super) fn predicted_steps(&self) -> f64 {
        let steps = |(_, run): &(f64, Run)| run.statistics.steps as f64;
        match self.runs.as_slice() {
            [.., before, last] => steps(last) * (steps(last) / steps(before)).max(1.0),
            _ => 0.0,
        }
    }

    fn run_at(&self, tolerance: f64) -> Option<&Run> {
        let mut runs = self.runs.iter();
        Some(&runs.find(|(of_run, _)| *of_run == tolerance)?.1)
    }
}
