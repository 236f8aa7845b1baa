//! The events along an orbit. They are searched for in the periods until they repeat, and then continue at equal
//! distances in time.
//!
//! If a coordinate grows by D in those periods, the k-th later passage of a value is the present passage of the value
//! minus kD. It occurs once, and is searched for only in the periods in which the coordinate can have this value. A
//! revolution is completed in every period, since D is a multiple of 2π.

use super::event::{Event, EventKind, EventOccurrence, FoundEvent, TouchTolerance};
use super::observed::Observed;
use super::orbit_solution::point;
use super::stop_at_terminal;
use super::tracker::EventTracker;
use crate::error::{DynamicsError, MAX_OCCURRENCES, Result, too_many_events};
use crate::ode::{OdeState, Step};
use crate::options::Options;
use crate::orbit::Orbit;
use std::f64::consts::TAU;
use std::num::NonZeroUsize;

/// Number of parts of a period, equal in phase, that replace steps.
const PARTS: usize = 64;
/// Number of periods after which events without repetition are followed to the end.
const MAX_PERIODS: usize = 64;
/// Functions that differ by less of their size repeat themselves: solutions of large groups differ by some rounding.
const REPETITION_TOLERANCE: f64 = 1e-8;

/// The events that happen along an orbit.
pub(super) struct OrbitEvents {
    /// In order of time.
    pub(super) occurrences: Vec<EventOccurrence>,
    /// The state at which the motion ends early, and the error, if it is the cause.
    pub(super) end: Option<(OdeState, Option<DynamicsError>)>,
}

impl OrbitEvents {
    /// The events until `end` (s), or until the first that ends the motion.
    pub(super) fn find<O: Observed>(
        orbit: &Orbit,
        observed: O,
        end: f64,
        options: &Options,
        events: &[Event<O::Coordinate>],
    ) -> Result<Self> {
        let mut search = Search::new(orbit, observed, end, options, events)?;
        if events.is_empty() {
            return Ok(search.into_events());
        }
        while !search.step()? && !search.is_full() {
            if let Some(repetition) = search.repetition() {
                return search.repeat(&repetition);
            }
            if search.values.len() > options.max_steps {
                let (state, max_steps) = (search.before.clone(), options.max_steps);
                let error = DynamicsError::MaxStepsReached {
                    t: state.t,
                    max_steps,
                };
                return Ok(Self {
                    end: Some((state, Some(error))),
                    ..search.into_events()
                });
            }
        }
        Ok(search.into_events())
    }
}

/// How the events of a motion repeat themselves.
struct Repetition {
    /// After this number of periods,
    periods: usize,
    /// in which the function of each event has grown by this, rad, m …
    growth: Vec<f64>,
}

/// The search for events, part by part.
struct Search<'s, O: Observed> {
    orbit: &'s Orbit,
    observed: O,
    events: &'s [Event<O::Coordinate>],
    tolerance: TouchTolerance,
    start: f64,
    end: f64,
    /// How much later than the end an event is still at the end, s.
    end_tolerance: f64,
    parts: Vec<f64>,
    trackers: Vec<EventTracker<O::Coordinate>>,
    before: OdeState,
    /// By part, from the start on: the function of each event at its end.
    values: Vec<Vec<f64>>,
    found: Vec<FoundEvent>,
}

impl<'s, O: Observed> Search<'s, O> {
    fn new(
        orbit: &'s Orbit,
        mut observed: O,
        end: f64,
        options: &Options,
        events: &'s [Event<O::Coordinate>],
    ) -> Result<Self> {
        let tolerance = TouchTolerance {
            absolute: options.atol,
            relative: options.rtol,
        };
        let before = OdeState::from(orbit.initial_state());
        let tracker = |(i, event)| EventTracker::new(i, event, tolerance, &mut observed, &before);
        let trackers: Vec<_> = events
            .iter()
            .copied()
            .enumerate()
            .map(tracker)
            .collect::<Result<_>>()?;
        Ok(Self {
            orbit,
            events,
            tolerance,
            start: before.t,
            end,
            end_tolerance: (options.rtol * orbit.period).max(64.0 * f64::EPSILON * end.abs()),
            parts: orbit.times_of_parts(PARTS),
            values: vec![trackers.iter().map(EventTracker::value).collect()],
            trackers,
            before,
            found: Vec::new(),
            observed,
        })
    }

    /// The time at which a number of parts are over, s.
    fn time_after(&self, parts: usize) -> f64 {
        let (periods, parts) = (parts / PARTS, parts % PARTS);
        let within = if parts == 0 {
            0.0
        } else {
            self.parts[parts - 1]
        };
        self.start + self.orbit.period * periods as f64 + within
    }

    /// Looks for events in the next part; whether the motion ends in it.
    fn step(&mut self) -> Result<bool> {
        let t = self.time_after(self.values.len());
        let now = point(self.orbit, t.min(self.end));
        let mut dense = states_of(self.orbit);
        for tracker in &mut self.trackers {
            let mut step = Step {
                before: &self.before,
                now: &now,
                dense: &mut dense,
            };
            tracker.locate(&mut step, &mut self.observed, &mut self.found)?;
        }
        self.values
            .push(self.trackers.iter().map(EventTracker::value).collect());
        self.before = now;
        let is_stopped = self.found.iter().any(|(_, terminal)| *terminal);
        if t >= self.end && !is_stopped {
            for tracker in &mut self.trackers {
                tracker.at_end(&self.before, &mut self.found);
            }
        }
        Ok(is_stopped || t >= self.end)
    }

    /// Whether more was found than can be kept.
    fn is_full(&self) -> bool {
        self.found.len() > MAX_OCCURRENCES
    }

    /// The events found so far.
    fn into_events(mut self) -> OrbitEvents {
        let mut end = stop_at_terminal(&mut self.found).map(|state| (state, None));
        if let Some((last, _)) = self
            .found
            .get(MAX_OCCURRENCES - 1)
            .filter(|_| self.is_full())
        {
            let error = too_many_events(last.state.t);
            end = Some((last.state.clone(), Some(error)));
        }
        self.found.truncate(MAX_OCCURRENCES);
        let occurrences = self.found.into_iter().map(|(occurrence, _)| occurrence);
        OrbitEvents {
            occurrences: occurrences.collect(),
            end,
        }
    }

    /// How the functions of all events repeat themselves, if the last periods show that they do: as many as before them.
    fn repetition(&self) -> Option<Repetition> {
        let done = self.values.len() - 1;
        if !done.is_multiple_of(2 * PARTS) || done > 2 * PARTS * MAX_PERIODS {
            return None;
        }
        let (periods, half) = (done / (2 * PARTS), done / 2);
        let growth = |e: usize| {
            let growth = self.values[done][e] - self.values[half][e];
            let largest = self.values.iter().fold(0.0_f64, |m, v| m.max(v[e].abs()));
            let near = |a: f64, b: f64| (a - b).abs() <= REPETITION_TOLERANCE * largest;
            let pairs = self.values[half..].iter().zip(&self.values);
            let mut repeats = pairs.map(|(now, before)| near(now[e] - before[e], growth));
            let repeats = repeats.all(|same| same);
            let revolutions = (growth / TAU).round();
            match self.events[e].kind {
                _ if !repeats => None,
                _ if near(growth, 0.0) => Some(0.0),
                EventKind::Reaches(..) => Some(growth),
                EventKind::Revolution(_) => near(growth, TAU * revolutions).then_some(growth),
                EventKind::Reversal(_) | EventKind::Reaction(..) => None,
            }
        };
        let growth: Option<Vec<f64>> = (0..self.events.len()).map(growth).collect();
        growth.map(|growth| Repetition { periods, growth })
    }

    /// The further events of the motion; the last periods show how they repeat.
    fn repeat(mut self, repetition: &Repetition) -> Result<OrbitEvents> {
        // One part more: what happens at the end of a period is a rounding before or behind it.
        if self.step()? {
            return Ok(self.into_events());
        }
        stop_at_terminal(&mut self.found);
        let duration = self.orbit.period * repetition.periods as f64;
        let base_end = self.quiet_time(2 * PARTS * repetition.periods);
        let passed_once = |e: usize| {
            matches!(self.events[e].kind, EventKind::Reaches(..)) && repetition.growth[e] != 0.0
        };
        self.found.retain(|(o, _)| o.state.t <= base_end);
        let is_repeated =
            |(o, _): &&FoundEvent| o.state.t > base_end - duration && !passed_once(o.event);
        let base: Vec<EventOccurrence> = self
            .found
            .iter()
            .filter(is_repeated)
            .map(|(o, _)| o.clone())
            .collect();
        let mut once = Vec::new();
        for e in (0..self.events.len()).filter(|&e| passed_once(e)) {
            once.extend(self.later_passages(e, repetition)?);
        }
        once.retain(|o| o.state.t > base_end && o.state.t <= self.end + self.end_tolerance);
        let until = self.stop_time(&base, &once, repetition.periods);
        let last = until.unwrap_or(self.end + self.end_tolerance);
        self.found.extend(once.into_iter().map(|o| (o, false)));
        let mut windows = 1.0;
        // Those of a window are within its duration.
        while !base.is_empty() && base[0].state.t + windows * duration <= last {
            let periods = windows * repetition.periods as f64;
            let later = base.iter().map(|o| EventOccurrence {
                state: self.orbit.after_periods(&o.state, periods),
                ..*o
            });
            self.found.extend(later.map(|o| (o, false)));
            if self.found.len() > 2 * MAX_OCCURRENCES {
                break;
            }
            windows += 1.0;
        }
        self.found.retain(|(o, _)| o.state.t <= last);
        self.found
            .sort_by(|(a, _), (b, _)| a.state.t.total_cmp(&b.state.t));
        for (occurrence, _) in &mut self.found {
            // What is a rounding behind the end is at the end.
            occurrence.state.t = occurrence.state.t.min(self.end);
        }
        if let (Some(_), Some((_, terminal))) = (until, self.found.last_mut()) {
            *terminal = true;
        }
        Ok(self.into_events())
    }

    /// A time (s) in the part after a number of parts that is far from all events.
    fn quiet_time(&self, parts: usize) -> f64 {
        let [from, to] = [parts, parts + 1].map(|k| self.time_after(k));
        let times = self.found.iter().map(|(o, _)| o.state.t);
        let mut within: Vec<f64> = times.filter(|t| (from..to).contains(t)).collect();
        within.extend([from, to]);
        within.sort_by(f64::total_cmp);
        let gaps = within.windows(2).map(|pair| (pair[1] - pair[0], pair[0]));
        let widest = gaps.max_by(|(a, _), (b, _)| a.total_cmp(b));
        widest.map_or(to, |(width, from)| from + 0.5 * width)
    }

    /// The passages of the value of one event, whose coordinate grows, after those that were found.
    // Long because it is one search: in which repetitions it may be passed, and then through these part by part.
    fn later_passages(
        &mut self,
        e: usize,
        repetition: &Repetition,
    ) -> Result<Vec<EventOccurrence>> {
        let (event, growth) = (self.events[e], repetition.growth[e]);
        let EventKind::Reaches(_, target) = event.kind else {
            return Ok(Vec::new());
        };
        let window = PARTS * repetition.periods;
        let last = &self.values[window..=2 * window];
        let [low, high] = last
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| {
                [l.min(v[e]), h.max(v[e])]
            });
        // Between the parts it may go further; and a passage may begin with a window.
        let margin = 0.25 * (high - low) + 0.5 * growth.abs();
        let windows = [low - margin, high + margin].map(|value| (target - value) / growth);
        let first = windows[0].min(windows[1]).floor().max(1.0);
        let last_wanted = windows[0].max(windows[1]).ceil();
        let times: Vec<f64> = (0..=window)
            .map(|part| self.time_after(window + part))
            .collect();
        let duration = self.orbit.period * repetition.periods as f64;
        let after = |windows: f64, part: usize| times[part] + windows * duration;
        let begin = after(first, 0);
        if last_wanted < first || begin >= self.end {
            return Ok(Vec::new());
        }
        let mut before = point(self.orbit, begin);
        let near = self.values[window][e] + first * growth;
        let event = Event {
            terminal: None,
            ..event
        };
        let (tolerance, observed) = (self.tolerance, &mut self.observed);
        let mut tracker =
            EventTracker::new(e, event, tolerance, observed, &before)?.with_value_near(near);
        let mut passages = Vec::new();
        let mut windows = first;
        while windows <= last_wanted && before.t < self.end {
            for part in 1..=window {
                let now = point(self.orbit, after(windows, part));
                let mut step = Step {
                    before: &before,
                    now: &now,
                    dense: &mut states_of(self.orbit),
                };
                tracker.locate(&mut step, &mut self.observed, &mut passages)?;
                before = now;
            }
            windows += 1.0;
        }
        Ok(passages
            .into_iter()
            .map(|(occurrence, _)| occurrence)
            .collect())
    }

    /// When the motion is ended by an event that is not yet among those found, if it is.
    fn stop_time(
        &self,
        base: &[EventOccurrence],
        once: &[EventOccurrence],
        periods: usize,
    ) -> Option<f64> {
        let time = |e: usize| {
            let wanted = self.events[e].terminal.map(NonZeroUsize::get)?;
            let passed = self.found.iter().filter(|(o, _)| o.event == e).count();
            let further = wanted.checked_sub(passed + 1)?;
            let of_event = |all: &[EventOccurrence]| -> Vec<f64> {
                all.iter()
                    .filter(|o| o.event == e)
                    .map(|o| o.state.t)
                    .collect()
            };
            let [base, once] = [base, once].map(of_event);
            if base.is_empty() {
                return once.get(further).copied();
            }
            let periods = (further / base.len() + 1) as f64 * periods as f64;
            Some(base[further % base.len()] + periods * self.orbit.period)
        };
        let times = (0..self.events.len()).filter_map(time);
        let first = times.min_by(f64::total_cmp);
        first.filter(|&t| t <= self.end + self.end_tolerance)
    }
}

/// The states of an orbit as the dense output of a step.
fn states_of(orbit: &Orbit) -> impl FnMut(f64, &mut [f64]) -> Result<()> {
    |t, y| {
        y.copy_from_slice(&point(orbit, t).y);
        Ok(())
    }
}
