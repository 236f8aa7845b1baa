//! The forces of drives, from the definitions of their kinds.

use super::state::MultibodyState;
use super::{MultibodyError, MultibodySystem, Result};
use dwell_geometry::{Actuator, Mechanism};
use dwell_kinetostatics::{Drive, DriveKind};

/// The rotor's inertia on the coordinate, kg m² or kg.
pub(super) fn rotor_inertia(kind: &DriveKind) -> f64 {
    match kind {
        DriveKind::Motor(motor) => motor.gear_ratio * motor.gear_ratio * motor.rotor_inertia,
        DriveKind::AppliedForce(_) | DriveKind::SpeedController(_) => 0.0,
    }
}

/// The mechanism with one more actuator for each drive: its row gives the drive's coordinate, and the
/// effect of a unit of its force on every body.
pub(super) fn with_drives(mechanism: &Mechanism, drives: &[Drive]) -> Result<Mechanism> {
    let mut extended = mechanism.clone();
    for (i, drive) in drives.iter().enumerate() {
        let what = "its coordinate is not there";
        let wrong = MultibodyError::Drive { drive: i, what };
        let actuator = Actuator::of(&drive.name, drive.coordinate, mechanism).ok_or(wrong)?;
        let exists = |b: &dwell_geometry::BodyId| b.0 < mechanism.bodies.len();
        if !actuator.bodies.iter().all(exists) {
            return Err(wrong);
        }
        extended.actuators.push(actuator);
    }
    Ok(extended)
}

impl MultibodySystem {
    pub(super) fn check_drives(&self) -> Result<()> {
        for (i, drive) in self.drives.iter().enumerate() {
            let input = drive.kind.input();
            if self.magnitude(input, &self.rest_state()).is_none() {
                let what = "its magnitude does not fit the mechanism";
                return Err(MultibodyError::Drive { drive: i, what });
            }
        }
        Ok(())
    }

    /// Kinetic energy of the rotors, ½ N² J ṡ², J.
    pub(super) fn rotor_energy(&self, at: &MultibodyState) -> f64 {
        let energy = self.drives.iter().map(|drive| {
            let coordinate = at.motion().coordinate(&self.mechanism, drive.coordinate);
            let speed = coordinate.map_or(0.0, |s| s[1]);
            0.5 * rotor_inertia(&drive.kind) * speed * speed
        });
        energy.sum()
    }

    /// A drive at its coordinate's speed, with its current (A) or integral (rad or m) in `state`: its force on
    /// the coordinate, N·m or N, and the rate of that state.
    pub(super) fn drive_output(
        &self,
        kind: &DriveKind,
        speed: f64,
        state: f64,
        at: &MultibodyState,
    ) -> Option<[f64; 2]> {
        match kind {
            DriveKind::AppliedForce(force) => Some([self.magnitude(force, at)?, 0.0]),
            // u = R i + L di/dt + k (N q̇): the rotor rotates N times as fast, and its torque acts N-fold.
            DriveKind::Motor(motor) => {
                let net_voltage = self.magnitude(&motor.voltage, at)?
                    - motor.torque_constant * motor.gear_ratio * speed;
                let (current, state_rate) = match motor.inductance {
                    0.0 => (net_voltage / motor.resistance, 0.0),
                    inductance => (state, (net_voltage - motor.resistance * state) / inductance),
                };
                let force = motor.gear_ratio * (motor.torque_constant * current);
                Some([force, state_rate])
            }
            // At its limit it integrates only what brings it back.
            DriveKind::SpeedController(regulator) => {
                let error = self.magnitude(&regulator.reference_speed, at)? - speed;
                let unlimited =
                    regulator.proportional_gain * error + regulator.integral_gain * state;
                let force = unlimited.clamp(-regulator.limit, regulator.limit);
                let outward = force != unlimited && error * unlimited > 0.0;
                Some([force, if outward { 0.0 } else { error }])
            }
        }
    }
}
