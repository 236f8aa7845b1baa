//! The search for one event over the steps of a motion: on the dense output, to rounding.
//!
//! A step is divided so that its ends are near each other in angle. Between two points on different sides of the value
//! lies a passage; between two on one side a polynomial through five points shows whether the function may reach the
//! value and return, and only then its minimum is searched for. A passage counts when the function has gone beyond the
//! value by more than a touch; its time is that of the zero.

use super::event::{Event, EventKind, EventOccurrence, FoundEvent, TouchTolerance};
use super::excursion::may_dip;
use super::observed::{Observed, ObservedValue};
use crate::error::{DynamicsError, MAX_OCCURRENCES, Result, too_many_events};
use crate::ode::{OdeState, Step};
use dwell_numerics::{minimum, root};
use std::f64::consts::{FRAC_PI_4, TAU};
use std::num::NonZeroUsize;

/// Parts of a step, and of each angle of this size if it is longer.
const SUBINTERVALS: usize = 4;
const MAX_ANGLE: f64 = FRAC_PI_4;
/// Largest number of parts of a step in which events are searched for: 8192 revolutions.
const MAX_PARTS: usize = 1 << 18;
/// Resolution of a minimum in time, as a part of a subinterval.
const RESOLUTION: f64 = 1e-5;

/// The search for one event.
pub(crate) struct EventTracker<C> {
    event: Event<C>,
    /// Index of the event.
    index: usize,
    tolerance: TouchTolerance,
    /// Time and value of the last evaluation: angles whose revolutions are not counted are continued from it.
    previous: (f64, ObservedValue),
    /// The expected change of the function over each of the last two subintervals.
    expected_changes: [f64; 2],
    /// Revolutions, rad, that a counted angle differs by from the continued one since another system took over.
    revolution_offset: f64,
    /// For revolutions: the value at the start, and the number passed.
    origin: f64,
    revolutions: f64,
    /// The largest absolute value so far.
    size: f64,
    /// The sign of the distance from the value when it was last more than a touch; 0 before.
    side: f64,
    /// A value, and the zero that the function has passed by no more than a touch.
    pending: Option<(f64, EventOccurrence)>,
    occurrences: usize,
    /// Points of the last step.
    points: Vec<(f64, ObservedValue)>,
}

/// A value to be passed, and the side that the function is on.
#[derive(Clone, Copy)]
struct Target {
    value: f64,
    side: f64,
}

/// A passage of a value, and the passage back if it follows at once.
struct Passage {
    target: Target,
    entry: EventOccurrence,
    exit: Option<EventOccurrence>,
}

impl<C: Copy> EventTracker<C> {
    pub(super) fn new(
        index: usize,
        event: Event<C>,
        tolerance: TouchTolerance,
        observed: &mut impl Observed<Coordinate = C>,
        start: &OdeState,
    ) -> Result<Self> {
        let value = event.kind.eval(observed, start)?;
        let mut tracker = Self {
            event,
            index,
            tolerance,
            previous: (start.t, value),
            expected_changes: [0.0; 2],
            revolution_offset: 0.0,
            origin: value.value,
            revolutions: 0.0,
            size: value.value.abs(),
            side: 0.0,
            pending: None,
            occurrences: 0,
            points: Vec::new(),
        };
        tracker.take_side(value.value);
        Ok(tracker)
    }

    /// The last value, with its revolutions.
    pub(super) fn value(&self) -> f64 {
        self.previous.1.value
    }

    /// This tracker at its start with another count of revolutions, so that the function is near a value.
    pub(super) fn with_value_near(mut self, value: f64) -> Self {
        let now = &mut self.previous.1;
        if now.revolutions_counted == Some(false) {
            now.value += TAU * ((value - now.value) / TAU).round();
        }
        self.side = 0.0;
        self.take_side(self.value());
        self
    }

    /// Continues with another system, whose angles may differ by whole revolutions.
    pub(super) fn continue_from(
        &mut self,
        observed: &mut impl Observed<Coordinate = C>,
        at: &OdeState,
    ) -> Result<()> {
        let mut value = self.event.kind.eval(observed, at)?;
        self.revolution_offset = 0.0;
        if value.revolutions_counted.is_some() {
            let shift = TAU * ((self.previous.1.value - value.value) / TAU).round();
            value.value += shift;
            self.revolution_offset = shift;
        }
        self.previous = (at.t, value);
        // Its state is one of the system before.
        self.pending = None;
        Ok(())
    }

    /// The function, with the revolutions that make an angle continuous from its `last` value.
    fn eval_unwrapped(
        &self,
        last: (f64, ObservedValue),
        observed: &mut impl Observed<Coordinate = C>,
        at: &OdeState,
    ) -> Result<ObservedValue> {
        let mut value = self.event.kind.eval(observed, at)?;
        value.value += match value.revolutions_counted {
            None => 0.0,
            Some(true) => self.revolution_offset,
            Some(false) => {
                let (t, last) = last;
                let near = last.value + 0.5 * (last.rate + value.rate) * (at.t - t);
                TAU * ((near - value.value) / TAU).round()
            }
        };
        Ok(value)
    }

    /// The size of a touch.
    fn touch(&self) -> f64 {
        let absolute = match self.event.kind {
            EventKind::Reaction(..) => 0.0,
            _ => self.tolerance.absolute,
        };
        // An angle that grows with every revolution is no less certain to turn back than in the first.
        let size = match self.previous.1.revolutions_counted {
            Some(_) => self.size.min(TAU),
            None => self.size,
        };
        absolute + self.tolerance.relative * size
    }

    /// The value of an event with one value.
    fn single_value(&self) -> Option<f64> {
        match self.event.kind {
            EventKind::Reaches(_, value) | EventKind::Reaction(_, value) => Some(value),
            EventKind::Reversal(_) => Some(0.0),
            EventKind::Revolution(_) => None,
        }
    }

    /// Sets the side, if the function is beyond a touch.
    fn take_side(&mut self, value: f64) {
        let distance = value - self.single_value().unwrap_or(value);
        if distance != 0.0 && distance.abs() >= self.touch() {
            self.side = distance.signum();
        }
    }

    /// The values that may be passed next. Forwards and back over the same mark is no second revolution.
    fn targets(&self) -> [Option<Target>; 2] {
        match self.single_value() {
            Some(value) => {
                let side = self.side;
                [(side != 0.0).then_some(Target { value, side }), None]
            }
            None => [1.0, -1.0].map(|direction| {
                Some(Target {
                    value: self.origin + TAU * (self.revolutions + direction),
                    side: -direction,
                })
            }),
        }
    }

    /// Finds the occurrences in one step.
    pub(super) fn locate(
        &mut self,
        step: &mut Step<'_>,
        observed: &mut impl Observed<Coordinate = C>,
        found: &mut Vec<FoundEvent>,
    ) -> Result<()> {
        let angle = observed.angle_between(step.before, step.now);
        let parts = SUBINTERVALS * ((angle / MAX_ANGLE).ceil() as usize).max(1);
        if parts > MAX_PARTS {
            let t = step.before.t;
            return Err(DynamicsError::StepTooLongForEvents { t, angle });
        }
        let mut points = std::mem::take(&mut self.points);
        points.clear();
        points.push(self.previous);
        for t in step.subinterval_ends(parts) {
            let point = step.state_at(t)?;
            let last = points.last().copied().unwrap_or(self.previous);
            let value = self.eval_unwrapped(last, observed, &point)?;
            self.size = self.size.max(value.value.abs());
            points.push((point.t, value));
        }
        for k in 1..points.len() {
            if self.side == 0.0 {
                // It leaves the value that it began at.
                self.take_side(points[k].1.value);
            }
            while let Some(passage) = self.passage(&points, k, step, observed)? {
                let returns = passage.exit.is_some();
                self.add(passage, found);
                if found.len() > MAX_OCCURRENCES {
                    return Err(too_many_events(step.before.t));
                }
                if self.single_value().is_some() || returns {
                    break;
                }
            }
            let [(t0, v0), (t1, v1)] = [points[k - 1], points[k]];
            let change = v1.value - v0.value;
            let expected = self.event.kind.expected_change(v1, t1 - t0, change);
            self.expected_changes = [self.expected_changes[1], expected];
            self.previous = points[k];
        }
        self.points = points;
        Ok(())
    }

    /// A passage between a point of a step and the one before, with the return if that follows before the point.
    // Long because where a passage begins and ends depends on both points, and on what was passed before them.
    fn passage(
        &mut self,
        points: &[(f64, ObservedValue)],
        k: usize,
        step: &mut Step<'_>,
        observed: &mut impl Observed<Coordinate = C>,
    ) -> Result<Option<Passage>> {
        let [(t0, v0), (t1, v1)] = [points[k - 1], points[k]];
        let touch = self.touch();
        for target in self.targets().into_iter().flatten() {
            let [d0, d1] = [v0, v1].map(|v| target.distance(v.value));
            let mut distance_at = |t: f64| -> Result<f64> {
                let state = step.state_at(t)?;
                let value = self.eval_unwrapped(points[k - 1], observed, &state)?;
                Ok(target.distance(value.value))
            };
            // The time from which on the function is beyond the value, and until when.
            let mut beyond = (d1 <= -touch).then_some([t1, t1]);
            if beyond.is_none() {
                let distance = |i: usize| target.distance(points[i].1.value);
                if may_dip(distance, points.len(), k - 1) {
                    let resolution = RESOLUTION * (t1 - t0);
                    let lowest = minimum::find(&mut distance_at, [t0, t1], resolution, -touch)?;
                    beyond = (lowest[1] <= -touch).then_some([lowest[0], t1]);
                }
            }
            let is_pending = self
                .pending
                .as_ref()
                .is_some_and(|(value, _)| *value == target.value);
            let Some([deep, until]) = beyond else {
                if d1 > 0.0 && is_pending {
                    self.pending = None;
                } else if d1 <= 0.0 && !is_pending {
                    let zero = if d0 > 0.0 {
                        root::find(&mut distance_at, t0, t1)?
                    } else {
                        Some(t0)
                    };
                    let state = step.state_at(zero.unwrap_or(t1))?;
                    self.pending = Some((target.value, self.occurrence(state, target.side < 0.0)));
                }
                continue;
            };
            let entry = if d0 > 0.0 {
                root::find(&mut distance_at, t0, deep)?.unwrap_or(deep)
            } else {
                t0
            };
            let exit = if d1 > 0.0 {
                root::find(&mut distance_at, deep, until)?
            } else {
                None
            };
            let exit = exit.map(|t| step.state_at(t)).transpose()?;
            let exit = exit.map(|state| self.occurrence(state, target.side > 0.0));
            let entry = match self.pending.take().filter(|_| is_pending) {
                Some((_, entry)) => entry,
                None => self.occurrence(step.state_at(entry)?, target.side < 0.0),
            };
            return Ok(Some(Passage {
                target,
                entry,
                exit,
            }));
        }
        Ok(None)
    }

    fn occurrence(&self, state: OdeState, rising: bool) -> EventOccurrence {
        EventOccurrence {
            event: self.index,
            state,
            rising,
        }
    }

    /// Counts a passage.
    fn add(&mut self, passage: Passage, found: &mut Vec<FoundEvent>) {
        let is_single = self.single_value().is_some();
        if is_single && passage.exit.is_none() {
            self.side = -passage.target.side;
        }
        if !is_single {
            self.revolutions -= passage.target.side;
        }
        let exit = passage.exit.filter(|_| is_single);
        let last_wanted = self.event.terminal.map(NonZeroUsize::get);
        for occurrence in std::iter::once(passage.entry).chain(exit) {
            self.occurrences += 1;
            found.push((occurrence, last_wanted == Some(self.occurrences)));
        }
    }

    /// The passage at the end of a motion, if the function has reached the value and continues: at the end, rounding
    /// decides whether it has passed the value.
    pub(super) fn at_end(&mut self, end: &OdeState, found: &mut Vec<FoundEvent>) {
        let touch = self.touch();
        let value = self.value();
        let reached = self.targets().into_iter().flatten().find(|target| {
            let distance = target.distance(value);
            let [before, now] = self.expected_changes.map(|change| target.side * change);
            // A parabola with these slopes, one subinterval apart, turns back there.
            let lowest = if now > before {
                distance - 0.5 * now * now / (now - before)
            } else {
                f64::NEG_INFINITY
            };
            distance.abs() <= touch && now < 0.0 && lowest < -touch
        });
        let Some(target) = reached else {
            return;
        };
        let entry = match self
            .pending
            .take()
            .filter(|(value, _)| *value == target.value)
        {
            Some((_, entry)) => entry,
            None => self.occurrence(end.clone(), target.side < 0.0),
        };
        let exit = None;
        self.add(
            Passage {
                target,
                entry,
                exit,
            },
            found,
        );
    }
}

impl Target {
    /// How far a function is from passing it; negative beyond it.
    fn distance(self, value: f64) -> f64 {
        self.side * (value - self.value)
    }
}
