//! Events: zeros of functions of the state, located to rounding on the dense output of a step.

use super::observed::{Observed, ObservedValue};
use crate::error::Result;
use crate::ode::{DenseOutput, OdeState, root_subintervals, state_at};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_numerics::root;
use std::f64::consts::TAU;
use std::num::NonZeroUsize;

/// The function whose zero is an event. `C` names a coordinate of the system that moves: of a machine, any
/// [`CoordinateFunction`]; of a reduced model, its [`ReducedCoordinate`](crate::ReducedCoordinate).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EventKind<C = CoordinateFunction> {
    /// A coordinate passes a value, rad or m.
    Reaches(C, f64),
    /// The speed of a coordinate changes its sign.
    Reversal(C),
    /// A reaction, by its index in the output model, passes a value, N or N·m: at zero, a guide that can
    /// only push loses contact.
    Reaction(usize, f64),
    /// A coordinate completes a revolution from its value at the start, in either direction.
    Revolution(C),
}

/// An event to look for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event<C = CoordinateFunction> {
    /// Its function.
    pub kind: EventKind<C>,
    /// The motion ends with this occurrence of the event; none: it goes on.
    pub terminal: Option<NonZeroUsize>,
}

/// An event that happened.
#[derive(Debug, Clone, PartialEq)]
pub struct EventOccurrence {
    /// Index of the event.
    pub event: usize,
    /// Time and state of its zero.
    pub state: OdeState,
    /// Whether the function increases through zero.
    pub rising: bool,
}

/// An occurrence found in a step, and whether it is the one that ends the motion.
pub(super) type FoundEvent = (EventOccurrence, bool);

/// The search for one event over the steps of a motion.
pub(crate) struct EventTracker<C> {
    event: Event<C>,
    /// Time and value of the last evaluation: angles whose revolutions are not counted are continued from it.
    previous: (f64, ObservedValue),
    /// Revolutions, rad, that a counted angle differs by from the continued one since another system took over.
    revolution_offset: f64,
    /// Of revolutions: the value at the start, and the number passed.
    origin: f64,
    revolutions: f64,
    occurrences: usize,
}

impl<C: Copy> EventTracker<C> {
    pub(super) fn new(
        event: Event<C>,
        observed: &mut impl Observed<Coordinate = C>,
        start: &OdeState,
    ) -> Result<Self> {
        let value = event.kind.eval(observed, start)?;
        Ok(Self {
            event,
            previous: (start.t, value),
            revolution_offset: 0.0,
            origin: value.value,
            revolutions: 0.0,
            occurrences: 0,
        })
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

    /// Finds the occurrences in one step.
    pub(super) fn locate_roots(
        &mut self,
        index: usize,
        [before, now]: [&OdeState; 2],
        dense: DenseOutput<'_>,
        observed: &mut impl Observed<Coordinate = C>,
        found: &mut Vec<FoundEvent>,
    ) -> Result<()> {
        for t in root_subintervals(before, now) {
            let point = state_at(t, now, dense)?;
            let last = self.previous;
            let (t0, v0) = (last.0, last.1.value);
            let value = self.eval_unwrapped(last, observed, &point)?;
            let v1 = value.value;
            while let Some(target) = self.target(v0, v1) {
                let mut difference = |t: f64| -> Result<f64> {
                    let at = state_at(t, now, dense)?;
                    Ok(self.eval_unwrapped(last, observed, &at)?.value - target)
                };
                // A value that is zero at the subinterval's start was found before.
                let t = if v0 == target {
                    None
                } else {
                    root::find(&mut difference, t0, point.t)?
                };
                let Some(t) = t else {
                    break;
                };
                let occurrence = EventOccurrence {
                    event: index,
                    state: state_at(t, now, dense)?,
                    rising: v1 > v0,
                };
                self.occurrences += 1;
                let last_wanted = self.event.terminal.map(NonZeroUsize::get);
                found.push((occurrence, last_wanted == Some(self.occurrences)));
                if !matches!(self.event.kind, EventKind::Revolution(_)) {
                    break;
                }
                self.revolutions += (v1 - v0).signum();
            }
            self.previous = (point.t, value);
        }
        Ok(())
    }

    /// The target value that lies between two values of the function, if there is one.
    fn target(&self, v0: f64, v1: f64) -> Option<f64> {
        let passes = |target: f64| (v0 - target) * (v1 - target) < 0.0 || v1 == target;
        if matches!(self.event.kind, EventKind::Revolution(_)) {
            let next =
                [1.0, -1.0].map(|direction| self.origin + TAU * (self.revolutions + direction));
            // Forwards and back over the same mark is no second revolution.
            return next
                .into_iter()
                .find(|&target| v0 != target && passes(target));
        }
        (v0 != 0.0 && passes(0.0)).then_some(0.0)
    }
}

impl<C: Copy> EventKind<C> {
    /// The value of its function.
    fn eval(
        self,
        observed: &mut impl Observed<Coordinate = C>,
        at: &OdeState,
    ) -> Result<ObservedValue> {
        let uncounted = |value| ObservedValue {
            value,
            rate: 0.0,
            revolutions_counted: None,
        };
        Ok(match self {
            Self::Reaches(coordinate, target) => {
                let found = observed.coordinate(coordinate, at)?;
                ObservedValue {
                    value: found.value - target,
                    ..found
                }
            }
            Self::Revolution(coordinate) => observed.coordinate(coordinate, at)?,
            Self::Reversal(coordinate) => uncounted(observed.coordinate(coordinate, at)?.rate),
            Self::Reaction(k, target) => uncounted(observed.reaction(k, at)? - target),
        })
    }
}
