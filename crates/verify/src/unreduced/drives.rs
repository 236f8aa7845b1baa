//! What drives do, from the words of their kinds.

use super::instant::Instant;
use super::{Unreduced, UnreducedError};
use dwell_dynamics::{Drive, DriveKind};
use dwell_geometry::{Actuator, Coordinate, Mechanism};

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

/// The mechanism with one more actuator for each drive: its row tells the drive's coordinate, and what
/// a unit of its action does to every body.
pub(super) fn with_drives(
    mechanism: &Mechanism,
    drives: &[Drive],
) -> Result<Mechanism, UnreducedError> {
    let mut made = mechanism.clone();
    for (i, drive) in drives.iter().enumerate() {
        let what = "its coordinate is not there";
        let wrong = UnreducedError::Drive { drive: i, what };
        let (bodies, along) = match drive.coordinate {
            Coordinate::Angle(bodies) => (bodies, dwell_geometry::Drive::Angle),
            Coordinate::Length { bodies, points } => {
                (bodies, dwell_geometry::Drive::Length(points))
            }
            Coordinate::Travel(joint) => {
                let of = mechanism.joints.get(joint.0).ok_or(wrong)?;
                (of.bodies, dwell_geometry::Drive::Travel(joint))
            }
        };
        if bodies.iter().any(|b| b.0 >= mechanism.bodies.len()) {
            return Err(wrong);
        }
        made.actuators.push(Actuator {
            name: drive.name.clone(),
            bodies,
            drive: along,
        });
    }
    Ok(made)
}

impl Unreduced {
    pub(super) fn check_drives(&self) -> Result<(), UnreducedError> {
        for (i, drive) in self.drives.iter().enumerate() {
            let magnitude = match &drive.kind {
                DriveKind::Action(magnitude) => magnitude,
                DriveKind::Motor(motor) => &motor.voltage,
                DriveKind::Regulator(regulator) => &regulator.speed,
            };
            if self.magnitude(magnitude, &self.still()).is_none() {
                let what = "its magnitude does not fit the mechanism";
                return Err(UnreducedError::Drive { drive: i, what });
            }
        }
        Ok(())
    }

    /// Kinetic energy of the rotors, ½ N² J ṡ², J.
    pub(super) fn rotor_energy(&self, at: &Instant) -> f64 {
        let energy = self.drives.iter().map(|drive| {
            let speed = self.measure(drive.coordinate, at).map_or(0.0, |s| s[1]);
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
