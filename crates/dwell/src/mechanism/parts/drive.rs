//! Drives of free coordinates.

use super::Keys;
use crate::value::Value;

/// A drive of a free coordinate: a torque or force, a DC motor, or a speed controller.
///
/// ```
/// let motor = dwell::Drive::motor_line("phi", 0.5, 240.0).with("gear-ratio", 20.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Drive(pub(crate) Keys);

impl Drive {
    /// A torque, N·m, on an angle or a force, N, on a length: a number or an expression.
    ///
    /// ```
    /// let engine = dwell::Drive::applied_force("phi", "2 - 0.1*phi.velocity");
    /// ```
    pub fn applied_force(coordinate: &str, magnitude: impl Into<Value>) -> Self {
        Self(Keys::new("applied-force", coordinate).with("magnitude", magnitude))
    }

    /// A DC motor by its circuit: voltage, V (a number or an expression), torque constant, N·m/A, and resistance, Ω.
    /// Further keys: `inductance`, `gear-ratio`, `inertia`.
    ///
    /// ```
    /// let motor = dwell::Drive::motor("phi", "min(12, 6*t)", 0.05, 1.2).with("gear-ratio", 20.0);
    /// ```
    pub fn motor(
        coordinate: &str,
        voltage: impl Into<Value>,
        torque_constant: f64,
        resistance: f64,
    ) -> Self {
        let keys = Keys::new("motor", coordinate)
            .with("voltage", voltage)
            .with("torque-constant", torque_constant);
        Self(keys.with("resistance", resistance))
    }

    /// A DC motor by its torque–speed line: stall torque, N·m, and speed without load, rad/s, of its shaft. Further keys:
    /// `gear-ratio`, `inertia`.
    ///
    /// ```
    /// let motor = dwell::Drive::motor_line("phi", 0.5, 240.0);
    /// ```
    pub fn motor_line(coordinate: &str, stall_torque: f64, no_load_speed: f64) -> Self {
        let keys = Keys::new("motor", coordinate).with("stall-torque", stall_torque);
        Self(keys.with("no-load-speed", no_load_speed))
    }

    /// A PI controller of a coordinate's speed: reference speed, rad/s or m/s (a number or an expression), and proportional
    /// gain, N·m·s/rad or N·s/m. Further keys: `integral`, `limit`.
    ///
    /// ```
    /// let governor = dwell::Drive::speed_controller("phi", 3.0, 2.0).with("integral", 5.0);
    /// ```
    pub fn speed_controller(coordinate: &str, speed: impl Into<Value>, proportional: f64) -> Self {
        let keys = Keys::new("speed-controller", coordinate).with("speed", speed);
        Self(keys.with("proportional", proportional))
    }

    /// Sets another key of its kind.
    ///
    /// ```
    /// let motor = dwell::Drive::motor_line("phi", 0.5, 240.0).with("inertia", 1e-5);
    /// ```
    #[must_use]
    pub fn with(self, key: &str, value: impl Into<Value>) -> Self {
        Self(self.0.with(key, value))
    }
}
