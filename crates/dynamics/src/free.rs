//! The free motion of a mechanism of one degree of freedom without loads.

use crate::conservative::limits;
use crate::driver::{Dense, Next, integrate};
use crate::equation::Equation;
use crate::error::DynamicsError;
use crate::options::{Options, Statistics};
use crate::root;
use crate::system::{Point, System};
use dwell_kinetostatics::Reduced;
use std::f64::consts::TAU;

/// A motion this near a limit position, rad, has reached it: the inertia grows as the inverse of
/// the distance, and the steps would go on shrinking.
const AT_LIMIT: f64 = 1e-9;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Until {
    /// At a time, s.
    Time(f64),
    /// After so many whole turns of the coordinate.
    Turns(usize),
}

/// Time, coordinate and speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Time, s.
    pub t: f64,
    /// Coordinate, rad.
    pub q: f64,
    /// Speed, rad/s.
    pub q_dot: f64,
}

/// A motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Run {
    /// The start and the end of each step.
    pub steps: Vec<State>,
    /// Equally spaced samples, if asked for.
    pub samples: Vec<State>,
    /// The state at each whole turn, located on the dense output.
    pub turns: Vec<State>,
    /// The work done.
    pub statistics: Statistics,
}

/// Integrates a free motion from `start`, until a time or a number of whole turns.
///
/// # Errors
/// [`DynamicsError`] with the place and the reason: no pose, no inertia, a limit position, a budget
/// used up, a state that is not finite, an option that cannot be used.
pub fn simulate<R: Reduced>(
    model: &R,
    start: State,
    until: Until,
    options: &Options,
) -> Result<Run, DynamicsError> {
    let limits = limits(model.range(), start.q)?;
    if matches!(until, Until::Turns(n) if n > 0) && start.q_dot == 0.0 {
        return Err(DynamicsError::AtRest);
    }
    let end = match until {
        Until::Time(t) => Some(t),
        Until::Turns(_) => None,
    };
    let mut run = Run {
        steps: vec![start],
        samples: options.every.map(|_| start).into_iter().collect(),
        ..Run::default()
    };
    let from = Point {
        t: start.t,
        y: vec![start.q, start.q_dot],
    };
    let mut watch = |before: &Point, now: &Point, dense: Dense<'_>| {
        let (before, now) = (State::of(before), State::of(now));
        // Without loads the speed keeps its sign. In the coordinate of an actuator the way through a
        // limit position looks like a smooth return, but the mechanism goes on on another branch.
        let ends =
            limits.is_some_and(|(from, to)| now.q < from + AT_LIMIT || now.q > to - AT_LIMIT);
        if now.q_dot * start.q_dot < 0.0 || ends {
            let State { t, q, .. } = before;
            return Err(DynamicsError::Limit { t, q });
        }
        run.steps.push(now);
        let mut at = |t: f64| -> Result<State, DynamicsError> {
            let mut y = [0.0; 2];
            dense(t, &mut y)?;
            let [q, q_dot] = y;
            Ok(State { t, q, q_dot })
        };
        turns(&mut run.turns, start, before, now, &mut at)?;
        let enough = matches!(until, Until::Turns(n) if run.turns.len() >= n);
        let end = match run.turns.last() {
            Some(last) if enough => last.t,
            _ => now.t,
        };
        if let Some(every) = options.every {
            samples(&mut run.samples, every, start.t, end, &mut at)?;
        }
        Ok(if enough { Next::Stop } else { Next::GoOn })
    };
    let mut equation = Equation::new(model).at_speed(start.q_dot);
    let ended = integrate(&mut equation, &from, end, options, &mut watch)?;
    match ended.failed {
        // Within its range the mechanism has a pose everywhere: it is the end that was met.
        Some(DynamicsError::Place(_)) if limits.is_some() => {
            let State { t, q, .. } = State::of(&ended.at);
            Err(DynamicsError::Limit { t, q })
        }
        Some(error) => Err(error),
        None => {
            run.statistics = ended.statistics;
            Ok(run)
        }
    }
}

impl State {
    fn of(point: &Point) -> Self {
        Self {
            t: point.t,
            q: point.y[0],
            q_dot: point.y[1],
        }
    }
}

impl<R: Reduced> System for Equation<'_, R> {
    fn size(&self) -> usize {
        2
    }

    fn rates(&mut self, _: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        out[1] = self.acceleration(y[0], y[1])?;
        out[0] = y[1];
        Ok(())
    }

    fn jacobian(&mut self, _: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        let row = Equation::jacobian(self, y[0], y[1])?;
        out.copy_from_slice(&[0.0, 1.0, row[0], row[1]]);
        Ok(())
    }

    fn weight(&self, state: usize) -> f64 {
        if state == 0 { 1.0 } else { self.speed }
    }
}

/// Locates the whole turns passed in a step, in the direction of the start's speed. They are
/// found here rather than by the integrator's own events, which stop it and miss a second one in the step.
fn turns(
    found: &mut Vec<State>,
    start: State,
    before: State,
    now: State,
    at: &mut impl FnMut(f64) -> Result<State, DynamicsError>,
) -> Result<(), DynamicsError> {
    let forward = if start.q_dot < 0.0 { -1.0 } else { 1.0 };
    loop {
        let target = start.q + forward * TAU * (found.len() + 1) as f64;
        if (now.q - target) * forward < 0.0 || (before.q - target) * forward >= 0.0 {
            return Ok(());
        }
        let short = |t| Ok::<_, DynamicsError>(at(t)?.q - target);
        let passed = root::zero(short, before.t, now.t)?;
        found.push(passed.map_or(Ok(now), &mut *at)?);
    }
}

/// Takes the equally spaced samples of a step.
fn samples(
    taken: &mut Vec<State>,
    every: f64,
    from: f64,
    until: f64,
    at: &mut impl FnMut(f64) -> Result<State, DynamicsError>,
) -> Result<(), DynamicsError> {
    loop {
        let t = from + every * taken.len() as f64;
        if t > until {
            return Ok(());
        }
        taken.push(at(t)?);
    }
}
