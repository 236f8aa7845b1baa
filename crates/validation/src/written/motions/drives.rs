//! The second reading of drives: what they exert on their coordinates in a row.

use crate::written::poses::law::number;
use crate::written::poses::motion::Motion;
use crate::written::poses::reading::{Magnitude, Measure, Reading, entries};
use toml::Table;

/// A drive, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drive {
    pub(crate) name: String,
    pub(crate) measure: Measure,
    pub(crate) kind: DriveKind,
    /// Of a motor; 1 of another drive.
    gear_ratio: f64,
    /// The rotor's inertia on the coordinate, kg m² or kg.
    pub(super) rotor_inertia: f64,
}

/// What it exerts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum DriveKind {
    AppliedForce(Magnitude),
    /// Voltage, torque per current, resistance; with inductance the current is a state.
    Circuit {
        voltage: Magnitude,
        torque_constant: f64,
        resistance: f64,
        inductance: f64,
    },
    /// Torque of the shaft at rest, and its speed without load.
    Line {
        stall_torque: f64,
        no_load_speed: f64,
    },
    /// Its integral is in no file: its rows are compared alone. The reference speed, none of a table; N m/rad or N/m.
    SpeedController {
        reference: Option<Magnitude>,
        integral: f64,
    },
}

/// The circuit of a motor in a row: voltage and induced voltage, V; current, A; resistance, Ω; inductance, H.
pub(super) struct CircuitState {
    pub(super) voltage: f64,
    induced: f64,
    pub(super) current: f64,
    pub(super) resistance: f64,
    inductance: f64,
}

/// All drives of a scene; why they cannot be read, in words.
pub(crate) fn drives(scene: &Table, reading: &Reading) -> Result<Vec<Drive>, String> {
    entries(scene, "drives")
        .map(|(name, table)| {
            drive(name, table, reading).ok_or_else(|| format!("drive `{name}` cannot be read"))
        })
        .collect()
}

fn drive(name: &str, table: &Table, reading: &Reading) -> Option<Drive> {
    let kinds = ["applied-force", "motor", "speed-controller"];
    let key = kinds.into_iter().find(|kind| table.contains_key(*kind))?;
    let coordinate = reading.coordinate(table.get(key)?.as_str()?)?;
    let of = |key: &str| number(table.get(key));
    let gear_ratio = of("gear-ratio").unwrap_or(1.0);
    let inertia = of("inertia").unwrap_or(0.0) * reading.units.inertia;
    let kind = match key {
        "applied-force" => DriveKind::AppliedForce(reading.magnitude(table.get("magnitude"))?),
        "speed-controller" => DriveKind::SpeedController {
            reference: match table.get("speed")? {
                toml::Value::Table(_) => None,
                text @ toml::Value::String(_) => reading.magnitude(Some(text)),
                value => {
                    let speed = number(Some(value))? * reading.unit_of(coordinate.measure);
                    reading.magnitude(Some(&toml::Value::Float(speed)))
                }
            },
            integral: of("integral").unwrap_or(0.0),
        },
        _ if table.contains_key("stall-torque") => DriveKind::Line {
            stall_torque: of("stall-torque")?,
            no_load_speed: of("no-load-speed")? * reading.units.angle,
        },
        _ => DriveKind::Circuit {
            voltage: reading.magnitude(table.get("voltage"))?,
            torque_constant: of("torque-constant")?,
            resistance: of("resistance")?,
            inductance: of("inductance").unwrap_or(0.0),
        },
    };
    Some(Drive {
        name: name.to_owned(),
        measure: coordinate.measure,
        kind,
        gear_ratio,
        rotor_inertia: gear_ratio * gear_ratio * inertia,
    })
}

impl Drive {
    /// What an increase of its state, or of the share of the full voltage, adds to the force, and to the state's rate by itself.
    pub(crate) fn state_slopes(&self) -> [f64; 2] {
        match &self.kind {
            DriveKind::AppliedForce(_) => [0.0; 2],
            DriveKind::Line { stall_torque, .. } => [self.gear_ratio * stall_torque, 0.0],
            DriveKind::Circuit {
                torque_constant,
                resistance,
                inductance,
                ..
            } => [self.gear_ratio * torque_constant, -resistance / inductance],
            DriveKind::SpeedController { integral, .. } => [*integral, 0.0],
        }
    }

    /// The rate of its state in a row: of a current, A/s, or of a controller's integral; none of a drive without one.
    pub(crate) fn state_rate(&self, motion: &Motion<'_>) -> Option<f64> {
        match &self.kind {
            DriveKind::SpeedController { reference, .. } => {
                Some(reference.as_ref()?.at(motion)? - motion.measure(self.measure).0[1])
            }
            _ => self.current_rate(motion),
        }
    }

    /// The force on the coordinate in a row. That of a controller is the written one, and so is a current with inductance.
    pub(crate) fn force(&self, motion: &Motion<'_>) -> Option<f64> {
        let (speed, n) = (motion.measure(self.measure).0[1], self.gear_ratio);
        match &self.kind {
            DriveKind::AppliedForce(magnitude) => magnitude.at(motion),
            DriveKind::Line {
                stall_torque,
                no_load_speed,
            } => Some(n * stall_torque * (1.0 - n * speed / no_load_speed)),
            DriveKind::Circuit {
                torque_constant: k, ..
            } => Some(n * k * self.circuit(motion)?.current),
            // It has no rotor.
            DriveKind::SpeedController { .. } => self.written_force(motion),
        }
    }

    /// The circuit of a motor in a row, none of one that is given by its line and of another drive. With inductance the current is the written one.
    pub(super) fn circuit(&self, motion: &Motion<'_>) -> Option<CircuitState> {
        let [voltage, constant, resistance, inductance] = match &self.kind {
            DriveKind::Circuit {
                voltage,
                torque_constant,
                resistance,
                inductance,
            } => [
                voltage.at(motion)?,
                *torque_constant,
                *resistance,
                *inductance,
            ],
            DriveKind::Line { .. }
            | DriveKind::AppliedForce(_)
            | DriveKind::SpeedController { .. } => return None,
        };
        let speed = motion.measure(self.measure).0[1];
        let induced = constant * self.gear_ratio * speed;
        let current = match inductance > 0.0 {
            true => motion.get(&format!("{}.current", self.name))?,
            false => (voltage - induced) / resistance,
        };
        Some(CircuitState {
            voltage,
            induced,
            current,
            resistance,
            inductance,
        })
    }

    /// The rate of the current by the circuit, A/s, where the current is a state.
    pub(super) fn current_rate(&self, motion: &Motion<'_>) -> Option<f64> {
        let of = self.circuit(motion)?;
        let rest = of.voltage - of.resistance * of.current - of.induced;
        (of.inductance > 0.0).then(|| rest / of.inductance)
    }

    /// The force as it is written: what remains of it beside what accelerates the rotor.
    pub(super) fn written_force(&self, motion: &Motion<'_>) -> Option<f64> {
        let of = |end: &str| motion.get(&format!("{}.load_{end}", self.name));
        of("moment").or_else(|| of("force"))
    }

    /// Whether it is a motor, and its circuit is known; none is known of one given by its torque–speed line.
    pub(super) fn has_circuit(&self) -> bool {
        matches!(self.kind, DriveKind::Circuit { .. })
    }
}
