//! How the rows of motion are run: twice, for the estimate.

use super::shapes::Shape;
use crate::estimate;
use dwell_dynamics::{
    DynamicsError, Guidance, Machine, Options, Point, Run, State, Until, follow, simulate,
};
use dwell_geometry::{Scalar, Wide};
use dwell_kinetostatics::{Exact, Load, Reduced as _};

/// Times of a motion at which its two runs are compared, the end among them.
const COMPARED: usize = 64;

/// The states of a motion at the same times in a run and in its second.
pub(super) struct Twice {
    pub(super) first: Vec<Vec<f64>>,
    pub(super) again: Vec<Vec<f64>>,
}

impl Twice {
    /// The last of a function of the states, and the estimate of its error.
    pub(super) fn last(&self, of: impl Fn(&[f64]) -> f64, rounding: f64) -> (f64, f64) {
        let all = |states: &[Vec<f64>]| states.iter().map(|y| of(y)).collect::<Vec<f64>>();
        let (first, again) = (all(&self.first), all(&self.again));
        let last = first.last().copied().unwrap_or(f64::NAN);
        (last, estimate::of_motion(&first, &again, rounding))
    }
}

/// A motion without loads.
pub(super) fn free(
    model: &Exact,
    start: State,
    end: f64,
    options: &Options,
) -> Result<Twice, DynamicsError> {
    let options = Options {
        every: Some((end - start.t) / COMPARED as f64),
        ..*options
    };
    let run = |options: &Options| -> Result<Vec<Vec<f64>>, DynamicsError> {
        let Run { steps, samples, .. } = simulate(model, start, Until::Time(end), options)?;
        let mut states = samples;
        states.truncate(COMPARED);
        states.extend(steps.last());
        Ok(states.iter().map(|s| vec![s.q, s.q_dot]).collect())
    };
    Ok(Twice {
        first: run(&options)?,
        again: run(&estimate::second(&options))?,
    })
}

/// A motion without loads in parts of equal duration, s, each of which turns by `way`: the angle is wrapped
/// after each, so that it keeps its digits. Compared are the ends of the parts.
pub(super) fn wrapped(
    model: &Exact,
    start: State,
    (parts, duration): (usize, f64),
    way: Wide,
    options: &Options,
) -> Result<Twice, DynamicsError> {
    let run = |options: &Options| -> Result<Vec<Vec<f64>>, DynamicsError> {
        let mut at = start;
        let mut ends = Vec::with_capacity(parts);
        for _ in 0..parts {
            let part = simulate(model, at, Until::Time(duration), options)?;
            if let Some(end) = part.steps.last() {
                let q = (Wide::lift(end.q) - way).value();
                at = State { t: 0.0, q, ..*end };
            }
            ends.push(vec![at.q, at.q_dot]);
        }
        Ok(ends)
    };
    Ok(Twice {
        first: run(options)?,
        again: run(&estimate::second(options))?,
    })
}

/// The kinetic energy of a state, J; no number where there is none.
pub(super) fn kinetic(model: &Exact, y: &[f64]) -> f64 {
    let m = model.inertia(y[0], &mut model.work());
    m.map_or(f64::NAN, |(m, _)| 0.5 * m * y[1] * y[1])
}

/// A machine of one freedom under loads.
pub(super) fn machine(shape: &Shape, loads: &[Load]) -> Result<Machine, String> {
    let model = shape.model(&[]).map_err(|e| e.to_string())?;
    let free = vec![Guidance::Free];
    Machine::new(&shape.mechanism, model, loads, free, &[]).map_err(|e| e.to_string())
}

/// A motion under loads, from rest or not.
pub(super) fn loaded(
    machine: &Machine,
    [q, q_dot]: [f64; 2],
    end: f64,
    options: &Options,
) -> Result<Twice, DynamicsError> {
    let options = Options {
        every: Some(end / COMPARED as f64),
        ..*options
    };
    let start = Point {
        t: 0.0,
        y: machine.start(&[q], &[q_dot]),
    };
    let run = |options: &Options| -> Result<Vec<Vec<f64>>, DynamicsError> {
        let trace = follow(machine, machine.model(), &start, end, options, &[])?;
        if let Some(error) = trace.failed {
            return Err(error);
        }
        let mut states = trace.samples;
        states.truncate(COMPARED);
        states.extend(trace.steps.last().cloned());
        Ok(states.into_iter().map(|s| s.y).collect())
    };
    Ok(Twice {
        first: run(&options)?,
        again: run(&estimate::second(&options))?,
    })
}
