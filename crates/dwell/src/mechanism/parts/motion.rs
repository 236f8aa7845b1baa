//! Free motions and their events.

use super::{Keys, Law};
use crate::value::Value;

/// A free motion: its duration, its initial state, the actuators that follow a law, and its events. Actuators without a law
/// are free: loads and drives move them.
///
/// ```
/// use dwell::{Event, Motion};
/// let motion = Motion::seconds(5.0)
///     .initial_coordinate("phi", 0.5)
///     .initial_velocity("phi", 3.0)
///     .event("turn", Event::revolution("phi").stop());
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Motion {
    pub(crate) keys: Keys,
    coordinates: Keys,
    velocities: Keys,
    laws: Keys,
    events: Keys,
}

impl Motion {
    /// A motion of a duration, s.
    ///
    /// ```
    /// let motion = dwell::Motion::seconds(5.0);
    /// ```
    pub fn seconds(duration: f64) -> Self {
        Self {
            keys: Keys::new("duration", duration),
            ..Self::default()
        }
    }

    /// A motion of a number of its own periods; for one free actuator and conservative loads.
    ///
    /// ```
    /// let motion = dwell::Motion::periods(2.0).initial_velocity("phi", 1.0);
    /// ```
    pub fn periods(periods: f64) -> Self {
        Self {
            keys: Keys::new("periods", periods),
            ..Self::default()
        }
    }

    /// Sets the initial coordinate of a free actuator, rad or m; the default is that of the assembly.
    ///
    /// ```
    /// let motion = dwell::Motion::seconds(1.0).initial_coordinate("phi", 0.5);
    /// ```
    #[must_use]
    pub fn initial_coordinate(mut self, actuator: &str, coordinate: f64) -> Self {
        self.coordinates = self.coordinates.with(actuator, coordinate);
        self
    }

    /// Sets the initial velocity of a free actuator, rad/s or m/s; the default is 0.
    ///
    /// ```
    /// let motion = dwell::Motion::seconds(1.0).initial_velocity("phi", 3.0);
    /// ```
    #[must_use]
    pub fn initial_velocity(mut self, actuator: &str, velocity: f64) -> Self {
        self.velocities = self.velocities.with(actuator, velocity);
        self
    }

    /// Prescribes an actuator by a law of time.
    ///
    /// ```
    /// use dwell::{Law, Motion};
    /// let motion = Motion::seconds(1.0).prescribed("phi", Law::speed(10.0));
    /// ```
    #[must_use]
    pub fn prescribed(mut self, actuator: &str, law: Law) -> Self {
        self.laws = self.laws.with(actuator, law.0);
        self
    }

    /// Adds an event.
    ///
    /// ```
    /// use dwell::{Event, Motion};
    /// let motion = Motion::seconds(1.0).event("top", Event::reverses("phi"));
    /// ```
    #[must_use]
    pub fn event(mut self, name: &str, event: Event) -> Self {
        self.events = self.events.with(name, event.0);
        self
    }

    /// All keys of `[motion]`.
    pub(crate) fn into_keys(self) -> Keys {
        let tables = [
            ("initial-coordinate", self.coordinates),
            ("initial-velocity", self.velocities),
            ("prescribed", self.laws),
            ("events", self.events),
        ];
        let given = tables.into_iter().filter(|(_, table)| !table.0.is_empty());
        given.fold(self.keys, |keys, (key, table)| {
            keys.with(key, Value::from(table))
        })
    }
}

/// An event of a free motion, whose time is located.
///
/// ```
/// let lift_off = dwell::Event::reaction("contact.normal", 0.0).stop();
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Event(Keys);

impl Event {
    /// A coordinate passes a value, rad or m; an angle counts whole revolutions.
    ///
    /// ```
    /// let top = dwell::Event::reaches("phi", 1.57);
    /// ```
    pub fn reaches(coordinate: &str, value: f64) -> Self {
        Self(Keys::new("reaches", coordinate).with("value", value))
    }

    /// A coordinate reverses.
    ///
    /// ```
    /// let turning_point = dwell::Event::reverses("phi");
    /// ```
    pub fn reverses(coordinate: &str) -> Self {
        Self(Keys::new("reverses", coordinate))
    }

    /// A reaction passes a value, N or N·m.
    ///
    /// ```
    /// let lift_off = dwell::Event::reaction("contact.normal", 0.0);
    /// ```
    pub fn reaction(component: &str, value: f64) -> Self {
        Self(Keys::new("reaction", component).with("value", value))
    }

    /// An angle completes a revolution from its initial value.
    ///
    /// ```
    /// let turn = dwell::Event::revolution("phi");
    /// ```
    pub fn revolution(coordinate: &str) -> Self {
        Self(Keys::new("revolution", coordinate))
    }

    /// Makes the event end the motion.
    ///
    /// ```
    /// let turn = dwell::Event::revolution("phi").stop();
    /// ```
    #[must_use]
    pub fn stop(self) -> Self {
        Self(self.0.with("stop", true))
    }
}
