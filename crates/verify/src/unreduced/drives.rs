//! What drives do, from the words of their kinds.

use super::instant::Instant;
use super::{Unreduced, UnreducedError};
use dwell_dynamics::{DriveKind, Guidance};
use dwell_kinetostatics::Magnitude;

/// What a drive does at an instant.
pub(super) struct Driving {
    /// On the coordinate, N·m or N.
    pub(super) action: f64,
    /// The rate of its current (A/s) or integral (rad/s or m/s), if it has one.
    pub(super) rate: f64,
}

/// What the rotor's inertia is on the coordinate, kg m² or kg.
pub(super) fn rotor(kind: &DriveKind) -> f64 {
    match kind {
        DriveKind::Motor(motor) => motor.ratio * motor.ratio * motor.inertia,
        DriveKind::Action(_) | DriveKind::Regulator(_) => 0.0,
    }
}

impl Unreduced {
    pub(super) fn check_drives(&self) -> Result<(), UnreducedError> {
        for (i, drive) in self.drives.iter().enumerate() {
            let wrong = |what| UnreducedError::Drive { drive: i, what };
            match self.guidance.get(drive.actuator.0) {
                None => return Err(wrong("its actuator is not there")),
                Some(Guidance::Prescribed(_)) => {
                    return Err(wrong("its actuator is prescribed"));
                }
                Some(Guidance::Free) => {}
            }
            let magnitude = match &drive.kind {
                DriveKind::Action(magnitude) => magnitude,
                DriveKind::Motor(motor) => &motor.voltage,
                DriveKind::Regulator(regulator) => &regulator.speed,
            };
            if matches!(magnitude, Magnitude::Friction(_)) {
                return Err(wrong("friction acts in joints alone"));
            }
        }
        Ok(())
    }

    /// Kinetic energy of the rotors, ½ N² J q̇², J.
    pub(super) fn rotor_energy(&self, at: &Instant) -> f64 {
        let energy = self.drives.iter().map(|drive| {
            let speed = self.actuator_speed(drive.actuator.0, at).unwrap_or(0.0);
            0.5 * rotor(&drive.kind) * speed * speed
        });
        energy.sum()
    }

    /// A drive at its coordinate's speed, with its current (A) or integral (rad or m) in `state`.
    pub(super) fn drive(
        &self,
        drive: usize,
        speed: f64,
        state: f64,
        at: &Instant,
    ) -> Option<Driving> {
        match &self.drives.get(drive)?.kind {
            DriveKind::Action(action) => Some(Driving {
                action: self.magnitude(action, at)?,
                rate: 0.0,
            }),
            // u = R i + L di/dt + k (N q̇): the rotor turns N times as fast, its couple arrives N-fold.
            DriveKind::Motor(motor) => {
                let left =
                    self.magnitude(&motor.voltage, at)? - motor.constant * motor.ratio * speed;
                let stiff = motor.inductance == 0.0;
                let current = if stiff {
                    left / motor.resistance
                } else {
                    state
                };
                let drop = left - motor.resistance * current;
                Some(Driving {
                    action: motor.ratio * (motor.constant * current),
                    rate: if stiff { 0.0 } else { drop / motor.inductance },
                })
            }
            // It goes on integrating only what brings it back from its limit.
            DriveKind::Regulator(regulator) => {
                let error = self.magnitude(&regulator.speed, at)? - speed;
                let wanted = regulator.proportional * error + regulator.integral * state;
                let action = wanted.clamp(-regulator.limit, regulator.limit);
                let outward = action != wanted && error * wanted > 0.0;
                Some(Driving {
                    action,
                    rate: if outward { 0.0 } else { error },
                })
            }
        }
    }
}
