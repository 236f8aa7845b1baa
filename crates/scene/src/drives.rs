//! The drives of a free motion.

use crate::coordinates::{ParsedActuator, ParsedCoordinates, is_same};
use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::kind::kind;
use crate::magnitude::{MagnitudeRule, Magnitudes};
use crate::motion::ParsedMotion;
use crate::names::check;
use crate::table_reader::{Entry, SignRule, TableReader, quantity_with_sign, string};
use crate::units::{Unit, Units};
use crate::wording::{list, shorten};
use dwell_geometry::{Actuator, Coordinate};
use dwell_kinetostatics::{Drive, DriveKind, Magnitude, Motor, SpeedController};

/// The two sets of keys that give a motor: its circuit, or its torque–speed line.
const CIRCUIT: [&str; 3] = ["voltage", "torque-constant", "resistance"];
const TORQUE_SPEED_LINE: [&str; 2] = ["stall-torque", "no-load-speed"];

/// A drive as read; nothing in it if it was wrong.
#[derive(Debug)]
pub(crate) struct ParsedDrive {
    pub(crate) key: Span,
    /// Its magnitude, voltage, stall torque or reference speed.
    pub(crate) magnitude: Option<Span>,
    /// Where its coordinate is named.
    at: Option<Span>,
    pub(crate) drive: Option<Drive>,
}

/// Reads the drives.
pub(crate) struct DriveReader<'r> {
    pub(crate) named_coordinates: &'r ParsedCoordinates<'r>,
    pub(crate) units: &'r Units,
    pub(crate) magnitudes: &'r Magnitudes<'r>,
}

impl DriveReader<'_> {
    /// Every drive of the section.
    pub(crate) fn read(
        &self,
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Vec<ParsedDrive> {
        let one = |entry: &Entry<'_>| {
            check("a drive", entry.name, &entry.key, diagnostics);
            self.drive(entry, diagnostics)
        };
        fields.entries.iter().map(one).collect()
    }

    fn drive(&self, entry: &Entry<'_>, diagnostics: &mut Diagnostics) -> ParsedDrive {
        let mut parsed = ParsedDrive {
            key: entry.key.clone(),
            magnitude: None,
            at: None,
            drive: None,
        };
        let what = format!("drive `{}`", shorten(entry.name));
        let Some(fields) = TableReader::open(entry, what, diagnostics) else {
            return parsed;
        };
        let Some((kind_name, kind_entry)) = kind(&fields, &entry.key, "drive", diagnostics) else {
            return parsed;
        };
        let what = format_args!("{kind_name} of {}", fields.what);
        let coordinate = string(kind_entry.value, what, diagnostics).and_then(|name| {
            self.named_coordinates
                .find(name, &kind_entry.value.span(), diagnostics)
        });
        parsed.at = Some(kind_entry.value.span());
        let magnitude = ["magnitude", "voltage", "stall-torque", "speed"];
        let magnitude = magnitude.iter().find_map(|key| fields.get(key));
        parsed.magnitude = magnitude.map(|e| e.value.span());
        let table = DriveTable {
            reader: self,
            fields: &fields,
            at: &entry.key,
            // Units of what could not be read do not matter: there is an error already.
            is_angle: coordinate.is_none_or(Coordinate::is_angle),
        };
        let kind = match kind_name {
            "applied-force" => table.applied_force(diagnostics),
            "motor" => table.motor(diagnostics),
            _ => table.speed_controller(diagnostics),
        };
        parsed.drive = coordinate.zip(kind).map(|(coordinate, kind)| Drive {
            name: entry.name.to_owned(),
            coordinate,
            kind,
        });
        parsed
    }
}

/// One drive while it is read.
struct DriveTable<'p> {
    reader: &'p DriveReader<'p>,
    fields: &'p TableReader<'p>,
    /// Its name.
    at: &'p Span,
    is_angle: bool,
}

impl DriveTable<'_> {
    fn applied_force(&self, diagnostics: &mut Diagnostics) -> Option<DriveKind> {
        let unit = if self.is_angle { "N m" } else { "N" };
        let help = format!("add for instance `magnitude = 2.0`, in {unit}");
        let magnitude = self.magnitude("magnitude", &Unit::si_unit(), &help, diagnostics);
        magnitude.map(DriveKind::AppliedForce)
    }

    fn motor(&self, diagnostics: &mut Diagnostics) -> Option<DriveKind> {
        let si = Unit::si_unit();
        let units = self.reader.units;
        let why =
            "below zero the motor turns in the opposite direction; at zero it is not connected";
        let ratio = self.optional(
            "gear-ratio",
            1.0,
            (&si, SignRule::NotZero, why),
            diagnostics,
        );
        if let Some(entry) = self.fields.get("inertia") {
            units.require_inertia_unit(&entry.value.span(), diagnostics);
        }
        let inertia = (&units.inertia, SignRule::NotNegative, "");
        let inertia = self.optional("inertia", 0.0, inertia, diagnostics);
        let circuit = match self.is_torque_speed_line(diagnostics)? {
            true => self.torque_speed_line(diagnostics),
            false => self.circuit(diagnostics),
        };
        let (voltage, [constant, resistance, inductance]) = circuit?;
        Some(DriveKind::Motor(Motor {
            voltage,
            torque_constant: constant,
            resistance,
            inductance,
            gear_ratio: ratio?,
            rotor_inertia: inertia?,
        }))
    }

    /// Whether the motor is given by its torque–speed line, not by its circuit.
    fn is_torque_speed_line(&self, diagnostics: &mut Diagnostics) -> Option<bool> {
        let [circuit, line] = [CIRCUIT.as_slice(), &TORQUE_SPEED_LINE];
        let first = |set: &[&str]| set.iter().find_map(|key| self.fields.get(key));
        let what = &self.fields.what;
        let both = format!(
            "a motor is given by {}, or by {}",
            list(circuit.iter().copied()).unwrap_or_default(),
            list(line.iter().copied()).unwrap_or_default()
        );
        let diagnostic = match (first(circuit), first(line)) {
            (Some(_), None) => return Some(false),
            (None, Some(_)) => return Some(true),
            (None, None) => Diagnostic::new(format!(
                "{what} has neither a circuit nor a torque–speed line"
            ))
            .label(self.at.clone(), "its motor is not described"),
            (Some(a), Some(b)) => {
                let (one, other) = (a.name, b.name);
                Diagnostic::new(format!("{what} has both `{one}` and `{other}`"))
                    .label(a.key.clone(), "part of the circuit")
                    .label(b.key.clone(), "part of the torque–speed line")
            }
        };
        diagnostics.push(diagnostic.help(both));
        None
    }

    /// Voltage; torque constant, resistance and inductance.
    fn circuit(&self, diagnostics: &mut Diagnostics) -> Option<(Magnitude, [f64; 3])> {
        let si = Unit::si_unit();
        let help = "add for instance `voltage = 12`, in V";
        let voltage = self.magnitude("voltage", &si, help, diagnostics);
        let help =
            "add for instance `torque-constant = 0.05`, in N m/A (or V s/rad, the same number)";
        let constant = self.required(
            "torque-constant",
            (&si, SignRule::Positive, ""),
            help,
            diagnostics,
        );
        let help = "add for instance `resistance = 1.2`, in ohm";
        let resistance = self.required(
            "resistance",
            (&si, SignRule::Positive, ""),
            help,
            diagnostics,
        );
        let inductance = (&si, SignRule::NotNegative, "");
        let inductance = self.optional("inductance", 0.0, inductance, diagnostics);
        Some((voltage?, [constant?, resistance?, inductance?]))
    }

    /// The circuit at 1 V whose torque falls along the same line.
    fn torque_speed_line(&self, diagnostics: &mut Diagnostics) -> Option<(Magnitude, [f64; 3])> {
        let help =
            "add for instance `stall-torque = 0.5`: the torque of the motor shaft at rest, in N m";
        let stall_torque = (&Unit::si_unit(), SignRule::Positive, "");
        let stall_torque = self.required("stall-torque", stall_torque, help, diagnostics);
        let unit = &self.reader.units.angle;
        let name = &unit.name;
        let help =
            format!("add `no-load-speed`: the speed of the motor shaft without load, in {name}/s");
        let no_load_speed = self.required(
            "no-load-speed",
            (unit, SignRule::Positive, ""),
            &help,
            diagnostics,
        );
        if let Some(entry) = self.fields.get("inductance") {
            let what = &self.fields.what;
            diagnostics.push(
                Diagnostic::new(format!("{what} has an inductance and a torque–speed line"))
                    .label(entry.key.clone(), "the inductance belongs to a circuit")
                    .help("give the motor by `voltage`, `torque-constant` and `resistance`, or leave the inductance out"),
            );
            return None;
        }
        let constant = 1.0 / no_load_speed?;
        let numbers = [constant, constant / stall_torque?, 0.0];
        Some((Magnitude::Constant(1.0), numbers))
    }

    fn speed_controller(&self, diagnostics: &mut Diagnostics) -> Option<DriveKind> {
        let si = Unit::si_unit();
        let unit = self.reader.units.coordinate_unit(self.is_angle);
        let [damping, force] = match self.is_angle {
            true => ["N m s/rad", "N m"],
            false => ["N s/m", "N"],
        };
        let help = format!("add the reference speed: `speed = 10`, in {}/s", unit.name);
        let speed = self.magnitude("speed", unit, &help, diagnostics);
        let why = "a negative gain would drive the speed away from the reference";
        let gain = (&si, SignRule::NotNegative, why);
        let help = format!("add for instance `proportional = 2.0`, in {damping}");
        let proportional = self.required("proportional", gain, &help, diagnostics);
        let integral = self.optional("integral", 0.0, gain, diagnostics);
        let why = format!("it is the largest force or torque, in {force}, in either direction");
        let limit = (&si, SignRule::Positive, why.as_str());
        let limit = self.optional("limit", f64::INFINITY, limit, diagnostics);
        Some(DriveKind::SpeedController(SpeedController {
            reference_speed: speed?,
            proportional_gain: proportional?,
            integral_gain: integral?,
            limit: limit?,
        }))
    }

    fn magnitude(
        &self,
        key: &str,
        unit: &Unit,
        help: &str,
        diagnostics: &mut Diagnostics,
    ) -> Option<Magnitude> {
        let entry = self.fields.require(key, self.at, help, diagnostics)?;
        let rule = MagnitudeRule {
            unit,
            sign: SignRule::Any,
            why: "",
        };
        let magnitudes = self.reader.magnitudes;
        magnitudes.read(entry, &self.fields.what, &rule, diagnostics)
    }

    fn required(
        &self,
        key: &str,
        as_is: (&Unit, SignRule, &str),
        help: &str,
        diagnostics: &mut Diagnostics,
    ) -> Option<f64> {
        self.fields.require(key, self.at, help, diagnostics)?;
        self.optional(key, 0.0, as_is, diagnostics)
    }

    fn optional(
        &self,
        key: &str,
        default: f64,
        (unit, sign, why): (&Unit, SignRule, &str),
        diagnostics: &mut Diagnostics,
    ) -> Option<f64> {
        let Some(entry) = self.fields.get(key) else {
            return Some(default);
        };
        let what = format_args!("{key} of {}", self.fields.what);
        quantity_with_sign(entry.value, unit, sign, what, why, diagnostics)
    }
}

/// Reports drives that act on a prescribed actuator.
pub(crate) fn reject_drives_of_prescribed(
    drives: &[ParsedDrive],
    motion: &ParsedMotion<'_>,
    actuators: &[ParsedActuator<'_>],
    diagnostics: &mut Diagnostics,
) {
    for (a, law) in actuators.iter().zip(&motion.prescribed) {
        let (Some(law), Some(actuator)) = (law, &a.actuator) else {
            continue;
        };
        let prescribed = Actuator::coordinate(actuator);
        for parsed in drives {
            let (Some(drive), Some(at)) = (&parsed.drive, &parsed.at) else {
                continue;
            };
            if is_same(drive.coordinate, prescribed) {
                let (drive, name) = (shorten(&drive.name), shorten(a.name));
                diagnostics.push(
                    Diagnostic::new(format!(
                        "drive `{drive}` acts on `{name}`, which is prescribed"
                    ))
                    .label(at.clone(), "driven here")
                    .label(law.key.clone(), "prescribed here")
                    .help(
                        "leave out the drive, which cannot change a prescribed motion, or the motion law",
                    ),
                );
            }
        }
    }
}
