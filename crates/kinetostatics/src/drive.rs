//! The plain data of drives: an applied force, a direct-current motor, a speed controller.
//!
//! A drive is a load along a coordinate s whose magnitude ([`Magnitude::External`]) is computed by the
//! equation of motion, since it may have a state of its own:
//!
//! ```text
//! applied force      τ = F(t, …)
//! motor              L di/dt = u − R i − k N ṡ,    τ = N k i − N² J s̈              (1)
//! speed controller   τ = P e + I ∫e dt,    e = w − ṡ,    limited to ± limit          (2)
//! ```
//!
//! Without inductance the current of (1) follows the voltage at once, so that the motor's torque falls linearly with
//! its speed. A controller at its limit does not integrate an error that would drive it further beyond (anti-windup).

use crate::load::{Load, LoadKind, Magnitude};
use dwell_geometry::{Coordinate, Mechanism};

/// A drive of a coordinate s, of an actuator or any other.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive<C = Coordinate> {
    /// The name used in tables.
    pub name: String,
    /// The coordinate s.
    pub coordinate: C,
    /// The kind of drive, with its data.
    pub kind: DriveKind<C>,
}

impl Drive {
    /// The load by which it acts on the mechanism.
    ///
    /// # Errors
    /// A message if the mechanism does not have its coordinate.
    pub fn load(&self, mechanism: &Mechanism) -> Result<Load, &'static str> {
        let kind = LoadKind::along(mechanism, self.coordinate);
        Ok(Load {
            name: self.name.clone(),
            kind: kind.ok_or(Self::UNKNOWN_COORDINATE)?,
            magnitude: Magnitude::External(self.kind.input().signals().to_vec()),
        })
    }

    /// The message of a drive whose coordinate the mechanism does not have.
    pub const UNKNOWN_COORDINATE: &'static str = "it drives a coordinate that is not there";
}

/// The kind of a drive.
#[derive(Debug, Clone, PartialEq)]
pub enum DriveKind<C = Coordinate> {
    /// A given couple or force on the coordinate, N·m or N.
    AppliedForce(Magnitude<C>),
    /// A direct-current motor with a gear.
    Motor(Motor<C>),
    /// A proportional-integral controller of the coordinate's speed.
    SpeedController(SpeedController<C>),
}

impl<C> DriveKind<C> {
    /// Its input: the force, the voltage or the reference speed.
    pub fn input(&self) -> &Magnitude<C> {
        match self {
            Self::AppliedForce(magnitude) => magnitude,
            Self::Motor(motor) => &motor.voltage,
            Self::SpeedController(controller) => &controller.reference_speed,
        }
    }
}

/// The names of a kind of drive, and its state, if it has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DriveWords {
    /// The kind.
    pub kind: &'static str,
    /// Its input.
    pub input: &'static str,
    /// The unit of its input.
    pub input_unit: &'static str,
    /// Name, unit and meaning of its state; the meaning is empty if the name states it.
    pub state: Option<[&'static str; 3]>,
}

impl<C> DriveKind<C> {
    /// Its names and units on an angle or a length.
    pub fn words(&self, is_angle: bool) -> DriveWords {
        let of = |angle, length| if is_angle { angle } else { length };
        match self {
            Self::AppliedForce(_) => DriveWords {
                kind: "applied force",
                input: "applied_force",
                input_unit: of("N m", "N"),
                state: None,
            },
            Self::Motor(motor) => DriveWords {
                kind: "direct-current motor",
                input: "voltage",
                input_unit: "V",
                state: (motor.inductance > 0.0).then_some(["current", "A", ""]),
            },
            Self::SpeedController(controller) => DriveWords {
                kind: "speed controller",
                input: "set_speed",
                input_unit: of("rad/s", "m/s"),
                state: (controller.integral_gain > 0.0).then_some([
                    "integral",
                    of("rad", "m"),
                    "integral of the controller error",
                ]),
            },
        }
    }

    /// The motor, if it is one.
    pub fn motor(&self) -> Option<&Motor<C>> {
        match self {
            Self::Motor(motor) => Some(motor),
            Self::AppliedForce(_) | Self::SpeedController(_) => None,
        }
    }
}

/// A direct-current motor with a gear, eq. (1).
#[derive(Debug, Clone, PartialEq)]
pub struct Motor<C = Coordinate> {
    /// Voltage u, V.
    pub voltage: Magnitude<C>,
    /// Torque constant k, N·m/A = V·s/rad.
    pub torque_constant: f64,
    /// Resistance R, Ω.
    pub resistance: f64,
    /// Inductance L, H; zero: the current follows at once.
    pub inductance: f64,
    /// Revolutions of the motor per revolution of the coordinate, N (rad/m for a length).
    pub gear_ratio: f64,
    /// Moment of inertia of the rotor, J, kg m².
    pub rotor_inertia: f64,
    /// Whether voltage, torque constant and resistance are a torque–speed line written as a circuit. Then they, the current, and the power
    /// and losses derived from them are no quantities of the motor.
    pub is_torque_speed_line: bool,
}

/// A proportional-integral speed controller, eq. (2).
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedController<C = Coordinate> {
    /// The reference speed w, rad/s or m/s.
    pub reference_speed: Magnitude<C>,
    /// P, N·m·s/rad or N·s/m.
    pub proportional_gain: f64,
    /// I, N·m/rad or N/m.
    pub integral_gain: f64,
    /// Largest force, N·m or N.
    pub limit: f64,
}
