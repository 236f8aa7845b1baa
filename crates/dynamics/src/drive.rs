//! What moves a coordinate: an action given outright, a motor, a regulator of speed.
//!
//! ```text
//! action      τ = F(t, …)
//! motor       L di/dt = u − R i − k N ṡ,    τ = N k i − N² J s̈                   (1)
//! regulator   τ = P e + I ∫e dt,    e = w − ṡ,    held within ± limit             (2)
//! ```
//!
//! Without inductance the current of (1) follows at once: the motor's torque falls in a line with its
//! speed. A regulator at its limit stops integrating what would drive it further beyond.

use dwell_geometry::measure::Measured;
use dwell_geometry::{Coordinate, Mechanism, Scalar};
use dwell_kinetostatics::{Load, LoadKind, Magnitude};

/// What acts along a coordinate s, an actuator's or another.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// The name a table uses.
    pub name: String,
    /// The coordinate.
    pub coordinate: Coordinate,
    /// How.
    pub kind: DriveKind,
}

impl Drive {
    /// The load through which it acts.
    ///
    /// # Errors
    /// Why there is none: its coordinate is not there.
    pub fn load(&self, mechanism: &Mechanism) -> Result<Load, &'static str> {
        let kind = LoadKind::along(mechanism, self.coordinate);
        Ok(Load {
            name: self.name.clone(),
            kind: kind.ok_or("it drives a coordinate that is not there")?,
            magnitude: Magnitude::Given(self.kind.given().signals().to_vec()),
        })
    }
}

/// How a drive acts.
#[derive(Debug, Clone, PartialEq)]
pub enum DriveKind {
    /// A couple or force, N·m or N, on the coordinate.
    Action(Magnitude),
    /// A motor of direct current behind a gear.
    Motor(Motor),
    /// A proportional and integral regulator of the coordinate's speed.
    Regulator(Regulator),
}

impl DriveKind {
    /// What is given from outside: an action, a voltage, a wanted speed.
    pub fn given(&self) -> &Magnitude {
        match self {
            Self::Action(magnitude) => magnitude,
            Self::Motor(motor) => &motor.voltage,
            Self::Regulator(regulator) => &regulator.speed,
        }
    }
}

/// A motor of direct current behind a gear, eq. (1).
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    /// Voltage u, V.
    pub voltage: Magnitude,
    /// Torque constant k, N·m/A = V·s/rad.
    pub constant: f64,
    /// Resistance R, Ω.
    pub resistance: f64,
    /// Inductance L, H; zero: the current follows at once.
    pub inductance: f64,
    /// Turns of the motor by those of the coordinate, N (rad/m for a length).
    pub ratio: f64,
    /// Moment of inertia of the rotor, J, kg m².
    pub inertia: f64,
}

/// A regulator of speed, eq. (2).
#[derive(Debug, Clone, PartialEq)]
pub struct Regulator {
    /// The wanted speed w, rad/s or m/s.
    pub speed: Magnitude,
    /// P, N·m·s/rad or N·s/m.
    pub proportional: f64,
    /// I, N·m/rad or N/m.
    pub integral: f64,
    /// Largest action, N·m or N.
    pub limit: f64,
}

/// A drive that cannot be taken into a machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("drive {drive}: {what}")]
pub struct DriveError {
    /// Index of the drive.
    pub drive: usize,
    /// What is wrong with it.
    pub what: &'static str,
}

/// A drive ready to be evaluated.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Driven {
    /// Its load in the model.
    pub(crate) load: usize,
    pub(crate) measured: Measured,
    /// Its state (current in A, or integral in rad or m), by its place among the drives' states.
    pub(crate) state: Option<usize>,
    /// N² J, kg m² or kg.
    pub(crate) inertia: f64,
    /// What is given from outside: an action, a voltage, a wanted speed.
    pub(crate) given: Magnitude,
    law: Law,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Law {
    Action,
    /// k N, R and L.
    Motor([f64; 3]),
    /// P, I and the limit.
    Regulator([f64; 3]),
}

impl Driven {
    /// Takes drives into use.
    ///
    /// # Errors
    /// The first [`DriveError`].
    pub(crate) fn all(
        mechanism: &Mechanism,
        drives: &[Drive],
        first_load: usize,
    ) -> Result<Vec<Self>, DriveError> {
        let mut states = 0;
        let mut found = Vec::with_capacity(drives.len());
        for (i, drive) in drives.iter().enumerate() {
            let wrong = |what| DriveError { drive: i, what };
            let load = first_load + i;
            let one = Self::new(mechanism, drive, load, &mut states).map_err(wrong)?;
            found.push(one);
        }
        Ok(found)
    }

    fn new(
        mechanism: &Mechanism,
        drive: &Drive,
        load: usize,
        states: &mut usize,
    ) -> Result<Self, &'static str> {
        let measured = Measured::find(mechanism, drive.coordinate);
        let measured = measured.ok_or("it drives a coordinate that is not there")?;
        let mut state = |wanted: bool| {
            let place = *states;
            *states += usize::from(wanted);
            wanted.then_some(place)
        };
        let not_negative = |numbers: &[f64]| numbers.iter().all(|n| n.is_finite() && *n >= 0.0);
        let (law, inertia, state) = match &drive.kind {
            DriveKind::Action(_) => (Law::Action, 0.0, None),
            DriveKind::Motor(m) => {
                let finite = m.constant.is_finite() && m.ratio.is_finite();
                let positive = not_negative(&[m.inductance, m.inertia, m.resistance]);
                if !(finite && positive) || m.resistance == 0.0 {
                    return Err("a motor needs a resistance above zero, no number below zero");
                }
                let law = Law::Motor([m.constant * m.ratio, m.resistance, m.inductance]);
                let inertia = m.ratio * m.ratio * m.inertia;
                (law, inertia, state(m.inductance > 0.0))
            }
            DriveKind::Regulator(r) => {
                if !not_negative(&[r.proportional, r.integral])
                    || r.limit.is_nan()
                    || r.limit <= 0.0
                {
                    return Err("a regulator needs gains from zero and a limit above zero");
                }
                let law = Law::Regulator([r.proportional, r.integral, r.limit]);
                (law, 0.0, state(r.integral > 0.0))
            }
        };
        let given = drive.kind.given().clone();
        if matches!(given, Magnitude::Friction(_) | Magnitude::Given(_)) {
            return Err("friction acts in joints alone, and a drive is not given by another");
        }
        Ok(Self {
            load,
            measured,
            state,
            inertia,
            given,
            law,
        })
    }

    /// The action on the coordinate (without the rotor's inertia) and the rate of the drive's state, for
    /// the action, voltage or speed that it is given and the coordinate's speed.
    pub(crate) fn act<T: Scalar>(&self, given: T, speed: T, state: Option<T>) -> (T, T) {
        let zero = T::lift(0.0);
        match self.law {
            Law::Action => (given, zero),
            Law::Motor([constant, resistance, inductance]) => {
                let constant = T::lift(constant);
                let rest = given - constant * speed;
                match state {
                    None => (constant * rest / T::lift(resistance), zero),
                    Some(current) => {
                        let rate = rest - current * T::lift(resistance);
                        (constant * current, rate / T::lift(inductance))
                    }
                }
            }
            Law::Regulator([proportional, integral, limit]) => {
                let error = given - speed;
                let sum = state.unwrap_or(zero) * T::lift(integral) + error * T::lift(proportional);
                if sum.value().abs() <= limit {
                    return (sum, error);
                }
                let beyond = sum.value().signum();
                let held = error.value() * beyond > 0.0;
                (T::lift(limit * beyond), if held { zero } else { error })
            }
        }
    }
}
