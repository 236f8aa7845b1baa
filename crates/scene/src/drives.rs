//! The drives of a free motion.

use crate::coordinates::{AnyCoordinate, NamedActuator, ParsedCoordinates, report_ambiguous_name};
use crate::diagnostics::Span;
use crate::keys;
use crate::kind::{kind, reject_unread_kind};
use crate::magnitude::Magnitudes;
use crate::motion::ParsedMotion;
use crate::names::read_each;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::units::{SI, Unit};
use crate::value::{NumberRule, SignRule};
use crate::wording::{list, shorten};
use dwell_kinetostatics::{Drive, DriveKind, Magnitude, Motor, SpeedController};

/// Reads drives, with the coordinates on which they can act or depend.
pub(crate) struct DriveReader<'r, C> {
    pub(crate) coordinates: &'r ParsedCoordinates<'r, C>,
    pub(crate) magnitudes: &'r Magnitudes<C>,
}

impl<C: AnyCoordinate> DriveReader<'_, C> {
    /// Every drive of the section that was read well, with where its coordinate is named. The drives follow the `loads`, as in a
    /// model that has them as its last loads.
    pub(crate) fn drives(&self, fields: &TableReader<'_>, loads: usize) -> Vec<(Drive<C>, Span)> {
        read_each(fields, "a drive", SceneLocation::Drive, |k, entry| {
            entry.place(SceneLocation::Load(loads + k));
            self.drive(entry, SceneLocation::Magnitude(loads + k))
        })
    }

    fn drive(&self, entry: &Entry<'_>, magnitude: SceneLocation) -> Option<(Drive<C>, Span)> {
        let fields = &TableReader::open(entry, format!("drive `{}`", shorten(entry.name)))?;
        let (kind, kind_entry) = kind(fields, "drive")?;
        let coordinate = self.coordinates.named_by(kind_entry, fields);
        for key in ["speed", "stall-torque", "voltage", "magnitude"] {
            fields.place(key, magnitude);
        }
        let table = DriveTable {
            magnitudes: self.magnitudes,
            fields,
            // Units of what could not be read do not matter: there is an error already.
            is_angle: coordinate.is_none_or(C::is_angle),
        };
        let kind = match kind {
            "applied-force" => table.applied_force(),
            "motor" => table.motor(),
            "speed-controller" => table.speed_controller(),
            _ => reject_unread_kind(kind_entry),
        };
        let drive = Drive {
            name: entry.name.to_owned(),
            coordinate: coordinate?,
            kind: kind?,
        };
        Some((drive, kind_entry.value.span()))
    }
}

/// Rejects a drive and a load with the same name, because the name is that of columns.
pub(crate) fn reject_shared_names(
    drives: &Option<TableReader<'_>>,
    loads: &Option<TableReader<'_>>,
) {
    let Some((drives, loads)) = drives.as_ref().zip(loads.as_ref()) else {
        return;
    };
    for drive in &drives.entries {
        if let Some(load) = loads.entries.iter().find(|load| load.name == drive.name) {
            report_ambiguous_name(drive, &load.key, "a load", "a drive", "results");
        }
    }
}

/// One drive while it is read.
struct DriveTable<'p, C> {
    magnitudes: &'p Magnitudes<C>,
    fields: &'p TableReader<'p>,
    is_angle: bool,
}

impl<C: AnyCoordinate> DriveTable<'_, C> {
    fn applied_force(&self) -> Option<DriveKind<C>> {
        let unit = if self.is_angle { "N m" } else { "N" };
        let help = format!("add for instance `magnitude = 2.0`, in {unit}");
        self.magnitude("magnitude", &SI, &help)
            .map(DriveKind::AppliedForce)
    }

    fn motor(&self) -> Option<DriveKind<C>> {
        let (fields, units) = (self.fields, self.fields.units());
        let ratio_rule = NumberRule {
            unit: &SI,
            sign: SignRule::NotZero,
            why: "below zero the motor rotates in the opposite direction; at zero it is not connected",
        };
        let ratio = fields.number_or(1.0, "gear-ratio", &ratio_rule);
        if let Some(entry) = fields.get("inertia") {
            units.require_inertia_unit(&entry.value.span(), fields.log());
        }
        let inertia_rule = NumberRule::new(&units.inertia, SignRule::NotNegative);
        let inertia = fields.number_or(0.0, "inertia", &inertia_rule);
        let is_torque_speed_line = self.is_torque_speed_line()?;
        let circuit = if is_torque_speed_line {
            self.torque_speed_line()
        } else {
            self.circuit()
        };
        let (voltage, [constant, resistance, inductance]) = circuit?;
        Some(DriveKind::Motor(Motor {
            voltage,
            torque_constant: constant,
            resistance,
            inductance,
            gear_ratio: ratio?,
            rotor_inertia: inertia?,
            is_torque_speed_line,
        }))
    }

    /// Whether the motor is given by its torque–speed line, not by its circuit.
    fn is_torque_speed_line(&self) -> Option<bool> {
        let sets = keys::table("motor").sets();
        let mut given = sets
            .iter()
            .map(|set| set.iter().find_map(|key| self.fields.get(key)));
        let what = &self.fields.what;
        let (message, labels) = match (given.next().flatten(), given.next().flatten()) {
            (Some(_), None) => return Some(false),
            (None, Some(_)) => return Some(true),
            (None, None) => (
                format!("{what} has neither a circuit nor a torque–speed line"),
                vec![(&self.fields.key, "its motor is not described")],
            ),
            (Some(a), Some(b)) => {
                let (one, other) = (a.written(), b.written());
                let circuit = (&a.key, "part of the circuit");
                let line = (&b.key, "part of the torque–speed line");
                let message = format!("{what} has both `{one}` and `{other}`");
                (message, vec![circuit, line])
            }
        };
        let sets = sets.iter().filter_map(|set| list(set.iter().copied()));
        let sets: Vec<_> = sets.collect();
        let help = format!("a motor is given by {}", sets.join(", or by "));
        self.fields.log().reject(message, &labels, help)
    }

    /// Voltage; torque constant, resistance and inductance.
    fn circuit(&self) -> Option<(Magnitude<C>, [f64; 3])> {
        let positive = NumberRule::new(&SI, SignRule::Positive);
        let voltage = self.magnitude("voltage", &SI, "add for instance `voltage = 12`, in V");
        let help =
            "add for instance `torque-constant = 0.05`, in N m/A (or V s/rad, the same number)";
        let constant = self.fields.number("torque-constant", help, &positive);
        let help = "add for instance `resistance = 1.2`, in ohm";
        let resistance = self.fields.number("resistance", help, &positive);
        let not_negative = NumberRule::new(&SI, SignRule::NotNegative);
        let inductance = self.fields.number_or(0.0, "inductance", &not_negative);
        Some((voltage?, [constant?, resistance?, inductance?]))
    }

    /// The circuit at 1 V whose torque falls along the same line.
    fn torque_speed_line(&self) -> Option<(Magnitude<C>, [f64; 3])> {
        let (fields, angle) = (self.fields, &self.fields.units().angle);
        let rule = |unit| NumberRule::new(unit, SignRule::Positive);
        let help =
            "add for instance `stall-torque = 0.5`: the torque of the motor shaft at rest, in N m";
        let stall_torque = fields.number("stall-torque", help, &rule(&SI));
        let unit = &angle.name;
        let help =
            format!("add `no-load-speed`: the speed of the motor shaft without load, in {unit}/s");
        let no_load_speed = fields.number("no-load-speed", &help, &rule(angle));
        if let Some(entry) = fields.get("inductance") {
            let what = &fields.what;
            let message = format!("{what} has an inductance and a torque–speed line");
            let label = "the inductance belongs to a circuit";
            let help = "give the motor by `voltage`, `torque-constant` and `resistance`, or leave the inductance out";
            return entry.reject(message, label, help);
        }
        let constant = 1.0 / no_load_speed?;
        let numbers = [constant, constant / stall_torque?, 0.0];
        Some((Magnitude::Constant(1.0), numbers))
    }

    fn speed_controller(&self) -> Option<DriveKind<C>> {
        let fields = self.fields;
        let unit = fields.units().coordinate_unit(self.is_angle);
        let [damping, force] = if self.is_angle {
            ["N m s/rad", "N m"]
        } else {
            ["N s/m", "N"]
        };
        let help = format!("add the reference speed: `speed = 10`, in {}/s", unit.name);
        let speed = self.magnitude("speed", unit, &help);
        let gain = NumberRule::new(&SI, SignRule::NotNegative);
        let gain = gain.because("a negative gain would drive the speed away from the reference");
        let help = format!("add for instance `proportional = 2.0`, in {damping}");
        let proportional = fields.number("proportional", &help, &gain);
        let integral = fields.number_or(0.0, "integral", &gain);
        let why = format!("it is the largest force or torque, in {force}, in either direction");
        let positive = NumberRule::new(&SI, SignRule::Positive).because(&why);
        let limit = fields.number_or(f64::INFINITY, "limit", &positive);
        Some(DriveKind::SpeedController(SpeedController {
            reference_speed: speed?,
            proportional_gain: proportional?,
            integral_gain: integral?,
            limit: limit?,
        }))
    }

    fn magnitude(&self, key: &str, unit: &Unit, help: &str) -> Option<Magnitude<C>> {
        let entry = self.fields.require(key, help)?;
        let rule = NumberRule::new(unit, SignRule::Any);
        self.magnitudes.read(entry, self.fields, &rule)
    }
}

/// Reports drives that act on a prescribed actuator.
pub(crate) fn reject_drives_of_prescribed<'a, C: AnyCoordinate>(
    drives: &[(Drive<C>, Span)],
    motion: &ParsedMotion<'_>,
    actuators: impl Iterator<Item = (&'a NamedActuator<'a>, Option<C>)>,
) {
    for ((a, coordinate), law) in actuators.zip(&motion.prescribed) {
        let (Some(law), Some(prescribed)) = (law, coordinate) else {
            continue;
        };
        let acts_on_it = |(drive, _): &&(Drive<C>, Span)| drive.coordinate.is_same(prescribed);
        for (drive, at) in drives.iter().filter(acts_on_it) {
            let (drive, name) = (shorten(&drive.name), shorten(a.name));
            let message = format!("drive `{drive}` acts on `{name}`, which is prescribed");
            let labels = [(at, "driven here"), (&law.key, "prescribed here")];
            let help =
                "leave out the drive, which cannot change a prescribed motion, or the motion law";
            law.log().report(message, &labels, help);
        }
    }
}
