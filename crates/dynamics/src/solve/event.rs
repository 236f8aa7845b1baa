//! Events: functions of the state that pass a value.
//!
//! An event happens where its function passes to the other side of the value. The start is no event, whatever the
//! value there, and no event is a *touch*: a function that comes to the value and turns back, or goes beyond it by
//! less than the error of the motion, has not passed it. So a pendulum released at 90° never passes 90°, whichever
//! method computes its return.

use super::observed::{Observed, ObservedValue};
use crate::error::Result;
use crate::ode::OdeState;
use crate::options::Options;
use dwell_geometry::body_states::CoordinateFunction;
use std::num::NonZeroUsize;

/// The function whose passage through a value is an event. `C` names a coordinate of the system that moves: of a
/// machine, any [`CoordinateFunction`]; of a reduced model, its [`ReducedCoordinate`](crate::ReducedCoordinate).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EventKind<C = CoordinateFunction> {
    /// A coordinate passes a value, rad or m. One that turns back there, or beyond it by less than the error of the
    /// motion, does not pass it.
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
    /// The motion ends with this occurrence of the event; `None` if it continues.
    pub terminal: Option<NonZeroUsize>,
}

/// An event that happened.
#[derive(Debug, Clone, PartialEq)]
pub struct EventOccurrence {
    /// Index of the event.
    pub event: usize,
    /// Time and state of its zero.
    pub state: OdeState,
    /// Whether the function increases through the value.
    pub rising: bool,
}

/// An occurrence found in a step, and whether it is the one that ends the motion.
pub(super) type FoundEvent = (EventOccurrence, bool);

/// How far a function must pass a value: less is within the error of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TouchTolerance {
    /// rad or m, and per s; not of reactions.
    pub(crate) absolute: f64,
    /// Size relative to the function's largest value.
    pub(crate) relative: f64,
}

impl TouchTolerance {
    /// Any passage counts.
    pub(crate) const NONE: Self = Self {
        absolute: 0.0,
        relative: 0.0,
    };

    /// The touch of an integration.
    pub(crate) fn of_integration(options: &Options) -> Self {
        /// Errors of an amplitude over ten periods, in tolerances: up to 15 by explicit methods. By implicit ones they
        /// are hundreds and more, but none gains more than this (`tests/grazing.rs`).
        const ERROR_RATIO: f64 = 50.0;
        Self {
            absolute: ERROR_RATIO * options.atol,
            relative: ERROR_RATIO * options.rtol,
        }
    }
}

impl<C: Copy> EventKind<C> {
    /// The value of its function.
    pub(super) fn eval(
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
            Self::Reaches(coordinate, _) | Self::Revolution(coordinate) => {
                observed.coordinate(coordinate, at)?
            }
            Self::Reversal(coordinate) => uncounted(observed.coordinate(coordinate, at)?.rate),
            Self::Reaction(k, _) => uncounted(observed.reaction(k, at)?),
        })
    }

    /// The change of its function in a time (s) at its present rate; of a function without known rate, its last
    /// change.
    pub(super) fn expected_change(self, now: ObservedValue, time: f64, last_change: f64) -> f64 {
        match self {
            Self::Reaches(..) | Self::Revolution(_) => now.rate * time,
            Self::Reversal(_) | Self::Reaction(..) => last_change,
        }
    }
}
