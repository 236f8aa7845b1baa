//! One combination after another.

use super::combination::Effort;
use super::evaluator::Evaluator;
use super::subject::Subject;
use dwell_dynamics::{
    Dense, DynamicsError, Method, Next, Options, Orbit, Point, State, Statistics, integrate,
};
use std::time::Instant;

/// What is not the mechanism itself may take so many times the steps that it does: its values are not
/// smooth below its accuracy, where an integrator finds no end.
const ROUGH: usize = 3;
const FEW: usize = 200;
/// A tolerance so far below what an evaluation keeps gains nothing.
const FUTILE: f64 = 1e-2;

/// The states at the subject's times, and what they took.
#[derive(Debug, Clone)]
pub(super) struct Run {
    pub(super) states: Vec<Vec<f64>>,
    pub(super) statistics: Statistics,
    pub(super) seconds: f64,
}

/// The runs of one method with one evaluator, from the coarsest tolerance on.
#[derive(Debug, Clone)]
pub(super) struct Ladder {
    pub(super) method: Method,
    pub(super) runs: Vec<(f64, Run)>,
    /// What was left out, and why.
    pub(super) left_out: Vec<String>,
}

/// Follows the motion at one tolerance.
pub(super) fn follow(
    evaluator: &dyn Evaluator,
    subject: &Subject,
    (method, tolerance): (Method, f64),
    budget: usize,
) -> Result<Run, DynamicsError> {
    let options = Options {
        budget,
        ..Options::new(method, tolerance)
    };
    let mut system = evaluator.system()?;
    let mut states: Vec<Vec<f64>> = Vec::with_capacity(subject.times.len());
    let mut watch = |_: &Point, now: &Point, dense: Dense<'_>| {
        while let Some(&t) = subject.times.get(states.len()).filter(|t| **t <= now.t) {
            let mut y = now.y.clone();
            if t < now.t {
                dense(t, &mut y)?;
            }
            states.push(y);
        }
        Ok(Next::GoOn)
    };
    let (start, end) = (&subject.start, Some(subject.end()));
    let began = Instant::now();
    let ended = integrate(&mut *system, start, end, &options, &mut watch)?;
    let seconds = began.elapsed().as_secs_f64();
    match ended.failed {
        Some(error) => Err(error),
        None if states.len() < subject.times.len() => Err(DynamicsError::TooShort),
        None => Ok(Run {
            states,
            statistics: ended.statistics,
            seconds,
        }),
    }
}

/// The motion by quadrature.
pub(super) fn quadrature(evaluator: &dyn Evaluator, subject: &Subject) -> Option<Run> {
    let began = Instant::now();
    let (orbit, evaluations) = evaluator.orbit(subject.state())?;
    let states = along(&orbit, &subject.times);
    Some(Run {
        states,
        seconds: began.elapsed().as_secs_f64(),
        statistics: Statistics {
            evaluations,
            ..Statistics::default()
        },
    })
}

/// The states of an orbit.
pub(super) fn along(orbit: &Orbit, times: &[f64]) -> Vec<Vec<f64>> {
    let state = |&t: &f64| {
        let State { q, q_dot, .. } = orbit.at(t);
        vec![q, q_dot]
    };
    times.iter().map(state).collect()
}

impl Ladder {
    /// Runs a method through the tolerances. `exact` is what it took with the mechanism itself.
    pub(super) fn new(
        evaluator: &dyn Evaluator,
        subject: &Subject,
        method: Method,
        effort: &Effort,
        exact: Option<&Self>,
    ) -> Self {
        let mut ladder = Self {
            method,
            runs: Vec::new(),
            left_out: Vec::new(),
        };
        let evaluation = evaluator.evaluation();
        for power in &effort.tolerances {
            let tolerance = 10_f64.powi(*power);
            let name = format!(
                "{}, {} at {tolerance:.0e}",
                evaluation.name(),
                method.name()
            );
            if tolerance < FUTILE * evaluation.keeps() {
                break;
            }
            let budget = match exact {
                None => effort.budget,
                Some(exact) => match exact.at(tolerance) {
                    // Why, has been said of the mechanism itself.
                    None => continue,
                    Some(run) => ROUGH * run.statistics.steps + FEW,
                },
            };
            let rough = match exact {
                None => "",
                Some(_) => ", far more than of the mechanism itself: it is not smooth there",
            };
            let many = || format!("{name} and finer: more than {budget} steps{rough}");
            if ladder.next() > budget as f64 {
                ladder.left_out.push(many());
                break;
            }
            match follow(evaluator, subject, (method, tolerance), budget) {
                Ok(run) => ladder.runs.push((tolerance, run)),
                Err(DynamicsError::Budget { .. }) => {
                    ladder.left_out.push(many());
                    break;
                }
                Err(error) => ladder.left_out.push(format!("{name}: {error}")),
            }
        }
        ladder
    }

    /// The steps that the next tolerance will take, if they go on growing as they have grown.
    pub(super) fn next(&self) -> f64 {
        let steps = |(_, run): &(f64, Run)| run.statistics.steps as f64;
        match self.runs.as_slice() {
            [.., before, last] => steps(last) * (steps(last) / steps(before)).max(1.0),
            _ => 0.0,
        }
    }

    fn at(&self, tolerance: f64) -> Option<&Run> {
        let found = self.runs.iter().find(|(own, _)| *own == tolerance);
        found.map(|(_, run)| run)
    }
}
