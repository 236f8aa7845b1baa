//! The solution of an initial-value problem: its steps, equally spaced samples, and events.
//!
//! An event is the passage of a function of the state through a value. It is searched for in several subintervals of
//! each step's dense output, so that two in one step are found, and located to rounding. The error of the dense output
//! itself is that of the integration. On an orbit, which is known at every time, the search covers one period.

mod event;
mod excursion;
mod observed;
mod orbit_events;
mod orbit_solution;
mod tracker;

use crate::contact::ContactEvent;
use crate::error::{DynamicsError, MAX_OCCURRENCES, Result, too_many_events};
use crate::integrate::integrate;
use crate::machine::{Machine, MovingModel};
use crate::machine_ode::MachineOde;
use crate::modes::MotionModes;
use crate::ode::{DenseOutput, OdeState, OdeSystem, Step, StepControl};
use crate::options::{Options, Statistics};
use dwell_geometry::body_states::CoordinateFunction;
pub use event::{Event, EventKind, EventOccurrence};
use event::{FoundEvent, TouchTolerance};
pub use observed::{Observed, ObservedMachine, ObservedValue};
pub use orbit_solution::solve_orbit;
use tracker::EventTracker;

/// A motion, complete or as far as it could be computed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Solution {
    /// The start and the end of each step; a terminal event ends the last one.
    pub steps: Vec<OdeState>,
    /// Equally spaced samples, if requested; [`Solution::sample_end`] adds the end.
    pub samples: Vec<OdeState>,
    /// The events that happened, in order of time.
    pub event_occurrences: Vec<EventOccurrence>,
    /// Where surfaces with dry friction came to rest or let go, and end stops were met, in order of time.
    pub contact_events: Vec<ContactEvent>,
    /// The modes of the motion from each event to the next.
    pub modes: MotionModes,
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

    /// Adds occurrences; one of them may have begun in an earlier step.
    fn add_occurrences(&mut self, found: Vec<FoundEvent>) {
        let all = &mut self.event_occurrences;
        let last = all.last().map(|last| last.state.t);
        let is_later = |(first, _): &FoundEvent| last.is_none_or(|last| last <= first.state.t);
        let in_order = found.first().is_none_or(is_later);
        all.extend(found.into_iter().map(|(occurrence, _)| occurrence));
        if !in_order {
            all.sort_by(|a, b| a.state.t.total_cmp(&b.state.t));
        }
    }

    /// Adds the changes of contacts, and the motion's slides along switches, up to the end.
    pub fn add_contact_events(&mut self, mut events: Vec<ContactEvent>) {
        let end = self.steps.last().map_or(f64::NEG_INFINITY, |step| step.t);
        events.retain(|event| event.t() <= end);
        self.contact_events = events;
    }

    /// Ends at a state before the last step's end.
    fn cut(&mut self, end: &OdeState) {
        self.steps.retain(|step| step.t < end.t);
        self.steps.push(end.clone());
        self.samples.retain(|sample| sample.t <= end.t);
        self.event_occurrences.retain(|o| o.state.t <= end.t);
    }

    /// Ends the solution at its last sample up to a time, s, because the motion after it is unknown.
    pub fn end_at(&mut self, t: f64) {
        let end = self.samples.iter().rfind(|sample| sample.t <= t).cloned();
        self.steps.retain(|step| step.t <= t);
        self.samples.retain(|sample| sample.t <= t);
        self.event_occurrences.retain(|o| o.state.t <= t);
        self.contact_events.retain(|event| event.t() <= t);
        let last = self.steps.last().map_or(f64::NEG_INFINITY, |step| step.t);
        self.steps.extend(end.filter(|end| end.t > last));
        (self.error, self.terminated_by_event) = (None, false);
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
/// [`DynamicsError`] if the start cannot be evaluated, or an option is invalid. An error that
/// ends the motion later is in [`Solution::error`].
pub fn solve<M: MovingModel>(
    machine: &Machine<M>,
    output_model: &M,
    start: &OdeState,
    end: f64,
    options: &Options,
    events: &[Event<M::CoordinateFunction>],
) -> Result<Solution> {
    let recorder_state = RecorderState::new(start.t, events, options);
    record_machine(machine, output_model, recorder_state, start, end, options)
}

/// As [`solve`], for a motion that started at t = 0 in another coordinate: its samples continue at multiples of their
/// interval.
///
/// # Errors
/// As [`solve`].
pub fn solve_further<M: MovingModel>(
    machine: &Machine<M>,
    output_model: &M,
    start: &OdeState,
    end: f64,
    options: &Options,
    events: &[Event<M::CoordinateFunction>],
) -> Result<Solution> {
    let recorder_state = RecorderState::new(0.0, events, options).sampled_until(start.t, options);
    record_machine(machine, output_model, recorder_state, start, end, options)
}

/// Integrates the motion of a machine, and records it.
fn record_machine<M: MovingModel>(
    machine: &Machine<M>,
    output_model: &M,
    recorder_state: RecorderState<'_, M::CoordinateFunction>,
    start: &OdeState,
    end: f64,
    options: &Options,
) -> Result<Solution> {
    machine.check_start(&start.y)?;
    let mut ode = MachineOde::until(machine, start.t, &start.y, Some(end))?;
    let observed = ObservedMachine::new(machine, output_model).in_modes(ode.modes());
    let mut solution = record(
        &mut ode,
        observed,
        recorder_state,
        start,
        Some(end),
        options,
    )?;
    solution.add_contact_events(ode.take_contact_events());
    solution.modes = ode.modes().take();
    Ok(solution)
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
    solve_with_limits(system, observed, start, end, options, [events, &[]])
}

/// As `solve`, with further events after the others whose values are limits: the motion need not pass them by more than
/// its error.
pub(crate) fn solve_with_limits<O: Observed>(
    system: &mut dyn OdeSystem,
    observed: O,
    start: &OdeState,
    end: Option<f64>,
    options: &Options,
    [events, limits]: [&[Event<O::Coordinate>]; 2],
) -> Result<Solution> {
    let recorder_state = RecorderState::new(start.t, events, options).with_limits(limits);
    record(system, observed, recorder_state, start, end, options)
}

/// Integrates and records.
fn record<O: Observed>(
    system: &mut dyn OdeSystem,
    observed: O,
    mut recorder_state: RecorderState<'_, O::Coordinate>,
    start: &OdeState,
    end: Option<f64>,
    options: &Options,
) -> Result<Solution> {
    let mut recorder = recorder_state.recorder(observed, start)?;
    let mut solution = recorder.begin_solution(start, options);
    let mut observer = |before: &OdeState, now: &OdeState, dense: DenseOutput<'_>| {
        recorder.record_step(&mut solution, options, &mut Step { before, now, dense })
    };
    let termination = integrate(system, start, end, options, &mut observer)?;
    if termination.error.is_none() {
        recorder.record_end(&mut solution);
    }
    solution.error = termination.error;
    solution.statistics = termination.statistics;
    Ok(solution)
}

/// The state of a recording, kept when the motion passes from one system to the next.
pub(crate) struct RecorderState<'e, C = CoordinateFunction> {
    events: Vec<(&'e Event<C>, TouchTolerance)>,
    trackers: Vec<EventTracker<C>>,
    /// When the motion began, and the samples taken since.
    start_time: f64,
    sample_count: usize,
}

impl<'e, C: Copy> RecorderState<'e, C> {
    pub(crate) fn new(start_time: f64, events: &'e [Event<C>], options: &Options) -> Self {
        let tolerance = TouchTolerance::of_integration(options);
        Self {
            events: events.iter().map(|event| (event, tolerance)).collect(),
            trackers: Vec::with_capacity(events.len()),
            start_time,
            sample_count: 0,
        }
    }

    /// The state for a motion whose samples up to a time, s, exist.
    fn sampled_until(mut self, t: f64, options: &Options) -> Self {
        if let Some(interval) = options.sample_interval {
            self.sample_count = (t / interval).floor() as usize + 1;
        }
        self
    }

    /// The state with further events that occur when their value is touched.
    fn with_limits(mut self, limits: &'e [Event<C>]) -> Self {
        let exact = limits.iter().map(|event| (event, TouchTolerance::NONE));
        self.events.extend(exact);
        self
    }

    /// Begins, or continues with another system, at a state.
    pub(crate) fn recorder<'m, O: Observed<Coordinate = C>>(
        &'m mut self,
        mut observed: O,
        from: &OdeState,
    ) -> Result<SolutionRecorder<'m, 'e, O>> {
        if self.trackers.is_empty() {
            for (i, &(&event, tolerance)) in self.events.iter().enumerate() {
                let tracker = EventTracker::new(i, event, tolerance, &mut observed, from)?;
                self.trackers.push(tracker);
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
        step: &mut Step<'_>,
    ) -> Result<StepControl> {
        let Self { observed, state } = self;
        let (before, now) = (step.before, step.now);
        let mut found = Vec::new();
        for tracker in &mut state.trackers {
            tracker.locate(step, observed, &mut found)?;
        }
        if solution.event_occurrences.len() + found.len() > MAX_OCCURRENCES {
            return Err(too_many_events(before.t));
        }
        let stop = stop_at_terminal(&mut found);
        if let Some(until) = stop.as_ref().filter(|until| until.t < before.t) {
            // It came to the value in an earlier step, and has passed it in this one only.
            solution.cut(until);
        } else {
            let until = stop.as_ref().map_or(now.t, |until| until.t);
            if let Some(sample_interval) = options.sample_interval {
                while let t = state.start_time + sample_interval * state.sample_count as f64
                    && t <= until
                {
                    // Between two integrations lie a few roundings of time, in which nothing happens.
                    let mut sample = step.state_at(t.max(before.t))?;
                    sample.t = t;
                    solution.samples.push(sample);
                    state.sample_count += 1;
                }
            }
            solution.steps.push(step.state_at(until)?);
        }
        solution.add_occurrences(found);
        solution.terminated_by_event = stop.is_some();
        Ok(match stop {
            Some(_) => StepControl::Stop,
            None => StepControl::Continue,
        })
    }

    /// Adds the events that happen at the very end of the motion.
    pub(crate) fn record_end(&mut self, solution: &mut Solution) {
        let Some(end) = solution.steps.last().cloned() else {
            return;
        };
        if solution.terminated_by_event {
            return;
        }
        let mut found = Vec::new();
        for tracker in &mut self.state.trackers {
            tracker.at_end(&end, &mut found);
        }
        let stop = stop_at_terminal(&mut found);
        if let Some(until) = &stop {
            solution.cut(until);
        }
        solution.add_occurrences(found);
        solution.terminated_by_event = stop.is_some();
    }
}

/// Orders occurrences by time, up to the first that ends the motion; its state.
fn stop_at_terminal(found: &mut Vec<FoundEvent>) -> Option<OdeState> {
    found.sort_by(|(a, _), (b, _)| a.state.t.total_cmp(&b.state.t));
    let stop = found.iter().position(|(_, terminal)| *terminal)?;
    found.truncate(stop + 1);
    found.last().map(|(last, _)| last.state.clone())
}
