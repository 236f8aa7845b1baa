//! The solution of an initial-value problem: its steps, equally spaced samples, and events.
//!
//! An event is a zero of a function of the state. It is looked for in several subintervals of each step's
//! dense output, so that two in one step are found, and located there to rounding; the error of the dense
//! output itself is that of the integration.

mod event;
mod observed;

use crate::error::{DynamicsError, Result};
use crate::integrate::integrate;
use crate::machine::Machine;
use crate::machine_ode::MachineOde;
use crate::ode::{DenseOutput, OdeState, OdeSystem, StepControl, state_at};
use crate::options::{Options, Statistics};
use crate::orbit::Orbit;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_kinetostatics::Model;
use event::EventTracker;
pub use event::{Event, EventKind, EventOccurrence};
pub use observed::{Observed, ObservedMachine, ObservedValue};

/// Parts of an orbit's period that take the place of steps.
const ORBIT_PARTS: f64 = 64.0;

/// Parts beyond which an orbit without events is sampled directly.
const MAX_ORBIT_STEPS: usize = 100_000;

/// A motion, complete or as far as it could be computed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Solution {
    /// The start and the end of each step; a terminal event ends the last one.
    pub steps: Vec<OdeState>,
    /// Equally spaced samples, if asked for; [`Solution::sample_end`] adds the end.
    pub samples: Vec<OdeState>,
    /// The events that happened, in order of time.
    pub event_occurrences: Vec<EventOccurrence>,
    /// Whether a terminal event ended it.
    pub terminated_by_event: bool,
    /// The error that ended it early, if one did.
    pub error: Option<DynamicsError>,
    /// The work done.
    pub statistics: Statistics,
}

impl Solution {
    /// The solution, if no error ended it early.
    ///
    /// # Errors
    /// [`Solution::error`].
    pub fn completed(mut self) -> Result<Self> {
        match self.error.take() {
            Some(error) => Err(error),
            None => Ok(self),
        }
    }

    /// Adds the end to the samples, unless one of them is there up to rounding.
    pub fn sample_end(&mut self) {
        let Some(end) = self.steps.last() else {
            return;
        };
        let is_there = |last: &OdeState| end.t - last.t <= 4.0 * f64::EPSILON * end.t.abs();
        if !self.samples.last().is_some_and(is_there) {
            self.samples.push(end.clone());
        }
    }
}

/// Integrates the motion of a machine from `start` until `end` (s), or until a terminal event.
///
/// `output_model` is the same mechanism with the same loads (those of the drives last), for the reactions
/// that events name.
///
/// # Errors
/// [`DynamicsError`] where not even the start can be evaluated, or an option cannot be used. An error that
/// ends the motion later is in [`Solution::error`].
pub fn solve(
    machine: &Machine,
    output_model: &Model,
    start: &OdeState,
    end: f64,
    options: &Options,
    events: &[Event],
) -> Result<Solution> {
    let mut ode = MachineOde::until(machine, start.t, &start.y, Some(end))?;
    let observed = ObservedMachine::new(machine, output_model);
    solve_system(&mut ode, observed, start, Some(end), options, events)
}

/// Integrates any system from `start` until `end` (s), or without an end until a terminal event; `observed`
/// evaluates the events at its states.
///
/// # Errors
/// As [`solve`].
pub fn solve_system<O: Observed>(
    system: &mut dyn OdeSystem,
    observed: O,
    start: &OdeState,
    end: Option<f64>,
    options: &Options,
    events: &[Event<O::Coordinate>],
) -> Result<Solution> {
    let mut recorder_state = RecorderState::new(start.t, events);
    let mut recorder = recorder_state.recorder(observed, start)?;
    let mut solution = recorder.begin_solution(start, options);
    let mut observer = |before: &OdeState, now: &OdeState, dense: DenseOutput<'_>| {
        recorder.record_step(&mut solution, options, before, now, dense)
    };
    let termination = integrate(system, start, end, options, &mut observer)?;
    solution.error = termination.error;
    solution.statistics = termination.statistics;
    Ok(solution)
}

/// The solution along an orbit of a machine, which is known at every time: no integration. Events are looked
/// for in equal parts of its period.
///
/// # Errors
/// [`DynamicsError`] where the start cannot be evaluated, or an option cannot be used. That the number of
/// steps is used up is in [`Solution::error`].
pub fn solve_orbit(
    orbit: &Orbit,
    observed: ObservedMachine<'_>,
    end: f64,
    options: &Options,
    events: &[Event],
) -> Result<Solution> {
    options.check()?;
    let point = |t: f64| OdeState::from(orbit.state_at(t));
    // As given: a speed of zero is no rounding of one, which would reverse at once.
    let start = OdeState::from(orbit.initial_state());
    let mut recorder_state = RecorderState::new(start.t, events);
    let mut recorder = recorder_state.recorder(observed, &start)?;
    let mut solution = recorder.begin_solution(&start, options);
    solution.statistics.evaluations = orbit.points;
    let part = orbit.period / ORBIT_PARTS;
    let span = end - start.t;
    if events.is_empty() && span > part * options.max_steps.min(MAX_ORBIT_STEPS) as f64 {
        sample_orbit(&mut solution, point, end, options);
        return Ok(solution);
    }
    let mut before = start;
    while before.t < end {
        let now = point((before.t + part).min(end));
        let mut dense = |t: f64, y: &mut [f64]| {
            y.copy_from_slice(&point(t).y);
            Ok(())
        };
        let control = recorder.record_step(&mut solution, options, &before, &now, &mut dense)?;
        solution.statistics.steps += 1;
        if control == StepControl::Stop {
            break;
        }
        if solution.statistics.steps >= options.max_steps {
            let (t, max_steps) = (now.t, options.max_steps);
            solution.error = Some(DynamicsError::MaxStepsReached { t, max_steps });
            break;
        }
        before = now;
    }
    Ok(solution)
}

/// The samples of an orbit, and its end: at a cost by samples, however many periods lie between them.
fn sample_orbit(
    solution: &mut Solution,
    point: impl Fn(f64) -> OdeState,
    end: f64,
    options: &Options,
) {
    let start = solution.steps[0].t;
    if let Some(sample_interval) = options.sample_interval {
        let times = (1_u32..).map(|k| start + sample_interval * f64::from(k));
        for t in times.take_while(|&t| t <= end) {
            let state = point(t);
            solution.steps.push(state.clone());
            solution.samples.push(state);
        }
    }
    if solution.steps.last().is_some_and(|last| last.t < end) {
        solution.steps.push(point(end));
    }
    solution.statistics.steps = solution.steps.len() - 1;
}

/// What a recording keeps when the motion passes from one system to the next.
pub(crate) struct RecorderState<'e, C = CoordinateFunction> {
    events: &'e [Event<C>],
    trackers: Vec<EventTracker<C>>,
    /// When the motion began, and the samples taken since.
    start_time: f64,
    sample_count: usize,
}

impl<'e, C: Copy> RecorderState<'e, C> {
    pub(crate) fn new(start_time: f64, events: &'e [Event<C>]) -> Self {
        Self {
            events,
            trackers: Vec::with_capacity(events.len()),
            start_time,
            sample_count: 0,
        }
    }

    /// Begins, or continues with another system, at a state.
    pub(crate) fn recorder<'m, O: Observed<Coordinate = C>>(
        &'m mut self,
        mut observed: O,
        from: &OdeState,
    ) -> Result<SolutionRecorder<'m, 'e, O>> {
        if self.trackers.is_empty() {
            for &event in self.events {
                self.trackers
                    .push(EventTracker::new(event, &mut observed, from)?);
            }
        } else {
            for tracker in &mut self.trackers {
                tracker.continue_from(&mut observed, from)?;
            }
        }
        Ok(SolutionRecorder {
            observed,
            state: self,
        })
    }
}

/// Records the steps of one system.
pub(crate) struct SolutionRecorder<'m, 'e, O: Observed> {
    observed: O,
    state: &'m mut RecorderState<'e, O::Coordinate>,
}

impl<O: Observed> SolutionRecorder<'_, '_, O> {
    /// A solution that begins at a state.
    pub(crate) fn begin_solution(&mut self, start: &OdeState, options: &Options) -> Solution {
        let first = options.sample_interval.is_some() && self.state.sample_count == 0;
        self.state.sample_count += usize::from(first);
        Solution {
            steps: vec![start.clone()],
            samples: first.then(|| start.clone()).into_iter().collect(),
            ..Solution::default()
        }
    }

    /// Adds a step to the solution, with the samples and events in it.
    pub(crate) fn record_step(
        &mut self,
        solution: &mut Solution,
        options: &Options,
        before: &OdeState,
        now: &OdeState,
        dense: DenseOutput<'_>,
    ) -> Result<StepControl> {
        let Self { observed, state } = self;
        let mut found = Vec::new();
        for (i, tracker) in state.trackers.iter_mut().enumerate() {
            tracker.locate_roots(i, [before, now], dense, observed, &mut found)?;
        }
        found.sort_by(|(a, _), (b, _)| a.state.t.total_cmp(&b.state.t));
        let stop = found.iter().position(|(_, terminal)| *terminal);
        if let Some(stop) = stop {
            found.truncate(stop + 1);
        }
        let until = match (stop, found.last()) {
            (Some(_), Some((last, _))) => last.state.t,
            _ => now.t,
        };
        if let Some(sample_interval) = options.sample_interval {
            while let t = state.start_time + sample_interval * state.sample_count as f64
                && t <= until
            {
                // Between two integrations lie a few roundings of time, in which nothing happens.
                let mut sample = state_at(t.max(before.t), now, dense)?;
                sample.t = t;
                solution.samples.push(sample);
                state.sample_count += 1;
            }
        }
        solution.steps.push(state_at(until, now, dense)?);
        let occurrences = found.into_iter().map(|(occurrence, _)| occurrence);
        solution.event_occurrences.extend(occurrences);
        solution.terminated_by_event = stop.is_some();
        Ok(if solution.terminated_by_event {
            StepControl::Stop
        } else {
            StepControl::Continue
        })
    }
}
