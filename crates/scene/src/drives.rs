//! The drives: what moves a coordinate in a free motion.

use crate::coordinates::{ActuatorText, Measures, is_same};
use crate::fields::{Entry, Fields, Sign, signed, string};
use crate::keys::DRIVES;
use crate::kind::kind;
use crate::magnitude::{Magnitudes, Size};
use crate::motion::MotionText;
use crate::names::{check, shorten};
use crate::problem::{Problem, Problems, Span, list};
use crate::units::{Unit, Units};
use dwell_dynamics::{Drive, DriveKind, Motor, Regulator};
use dwell_geometry::{Actuator, Coordinate};
use dwell_kinetostatics::Magnitude;

/// How a motor is told: by its circuit, or by the line of its torque over its speed.
const CIRCUIT: [&str; 3] = ["voltage", "constant", "resistance"];
const LINE: [&str; 2] = ["stall", "idle"];

/// A drive as read; nothing in it if it was wrong.
#[derive(Debug)]
pub(crate) struct DriveText {
    pub(crate) key: Span,
    /// What it is given: its magnitude, voltage or wanted speed.
    pub(crate) given: Option<Span>,
    /// Where its coordinate is named.
    at: Option<Span>,
    pub(crate) drive: Option<Drive>,
}

/// What drives are read with.
pub(crate) struct DriveReader<'r> {
    pub(crate) measures: &'r Measures<'r>,
    pub(crate) units: &'r Units,
    pub(crate) magnitudes: &'r Magnitudes<'r>,
}

impl DriveReader<'_> {
    /// Every drive of the section.
    pub(crate) fn read(&self, fields: &Fields<'_>, problems: &mut Problems) -> Vec<DriveText> {
        let one = |entry: &Entry<'_>| {
            check("a drive", entry.name, &entry.key, problems);
            self.drive(entry, problems)
        };
        fields.entries.iter().map(one).collect()
    }

    fn drive(&self, entry: &Entry<'_>, problems: &mut Problems) -> DriveText {
        let mut text = DriveText {
            key: entry.key.clone(),
            given: None,
            at: None,
            drive: None,
        };
        let what = format!("drive `{}`", shorten(entry.name));
        let Some(fields) = Fields::open(entry, what, problems) else {
            return text;
        };
        let Some((word, held)) = kind(&fields, &entry.key, "drive", &DRIVES, problems) else {
            return text;
        };
        let what = format_args!("{word} of {}", fields.what);
        let coordinate = string(held.value, what, problems)
            .and_then(|name| self.measures.find(name, &held.value.span(), problems));
        text.at = Some(held.value.span());
        let given = ["magnitude", "voltage", "stall", "speed"];
        let given = given.iter().find_map(|key| fields.get(key));
        text.given = given.map(|e| e.value.span());
        let part = Part {
            reader: self,
            fields: &fields,
            at: &entry.key,
            // Units of what could not be read do not matter: there is an error already.
            is_angle: coordinate.is_none_or(Coordinate::is_angle),
        };
        let kind = match word {
            "action" => part.action(problems),
            "motor" => part.motor(problems),
            _ => part.regulator(problems),
        };
        text.drive = coordinate.zip(kind).map(|(coordinate, kind)| Drive {
            name: entry.name.to_owned(),
            coordinate,
            kind,
        });
        text
    }
}

/// One drive while it is read.
struct Part<'p> {
    reader: &'p DriveReader<'p>,
    fields: &'p Fields<'p>,
    /// Its name.
    at: &'p Span,
    is_angle: bool,
}

impl Part<'_> {
    fn action(&self, problems: &mut Problems) -> Option<DriveKind> {
        let unit = if self.is_angle { "N m" } else { "N" };
        let help = format!("add for instance `magnitude = 2.0`, in {unit}");
        let magnitude = self.given("magnitude", &Unit::of_si(), &help, problems);
        magnitude.map(DriveKind::Action)
    }

    fn motor(&self, problems: &mut Problems) -> Option<DriveKind> {
        let si = Unit::of_si();
        let units = self.reader.units;
        let why = "below zero the motor turns the other way, at zero it drives nothing";
        let ratio = self.or("ratio", 1.0, (&si, Sign::NotZero, why), problems);
        if let Some(entry) = self.fields.get("inertia") {
            units.ask_inertia(&entry.value.span(), problems);
        }
        let inertia = (&units.inertia, Sign::NotNegative, "");
        let inertia = self.or("inertia", 0.0, inertia, problems);
        let circuit = match self.is_line(problems)? {
            true => self.line(problems),
            false => self.circuit(problems),
        };
        let (voltage, [constant, resistance, inductance]) = circuit?;
        Some(DriveKind::Motor(Motor {
            voltage,
            constant,
            resistance,
            inductance,
            ratio: ratio?,
            inertia: inertia?,
        }))
    }

    /// Whether the motor is told by a line, not by its circuit.
    fn is_line(&self, problems: &mut Problems) -> Option<bool> {
        let [circuit, line] = [CIRCUIT.as_slice(), &LINE];
        let first = |set: &[&str]| set.iter().find_map(|key| self.fields.get(key));
        let what = &self.fields.what;
        let both = format!(
            "a motor is told by {}, or by {}",
            list(circuit.iter().copied()).unwrap_or_default(),
            list(line.iter().copied()).unwrap_or_default()
        );
        let problem = match (first(circuit), first(line)) {
            (Some(_), None) => return Some(false),
            (None, Some(_)) => return Some(true),
            (None, None) => Problem::new(format!("{what} does not say how strong the motor is"))
                .at(self.at.clone(), "which motor?"),
            (Some(a), Some(b)) => {
                let (one, other) = (a.name, b.name);
                Problem::new(format!("{what} has both `{one}` and `{other}`"))
                    .at(a.key.clone(), "of its circuit")
                    .at(b.key.clone(), "of its line")
            }
        };
        problems.push(problem.help(both));
        None
    }

    /// Voltage; torque constant, resistance and inductance.
    fn circuit(&self, problems: &mut Problems) -> Option<(Magnitude, [f64; 3])> {
        let si = Unit::of_si();
        let help = "add for instance `voltage = 12`, in V";
        let voltage = self.given("voltage", &si, help, problems);
        let help = "add for instance `constant = 0.05`, in N m/A (or V s/rad, the same number)";
        let constant = self.needed("constant", (&si, Sign::Positive, ""), help, problems);
        let help = "add for instance `resistance = 1.2`, in ohm";
        let resistance = self.needed("resistance", (&si, Sign::Positive, ""), help, problems);
        let inductance = (&si, Sign::NotNegative, "");
        let inductance = self.or("inductance", 0.0, inductance, problems);
        Some((voltage?, [constant?, resistance?, inductance?]))
    }

    /// The circuit at 1 V whose torque falls along the same line.
    fn line(&self, problems: &mut Problems) -> Option<(Magnitude, [f64; 3])> {
        let help = "add for instance `stall = 0.5`: the torque of its shaft at rest, in N m";
        let stall = (&Unit::of_si(), Sign::Positive, "");
        let stall = self.needed("stall", stall, help, problems);
        let unit = &self.reader.units.angle;
        let name = &unit.name;
        let help = format!("add `idle`: the speed of its shaft without torque, in {name}/s");
        let idle = self.needed("idle", (unit, Sign::Positive, ""), &help, problems);
        if let Some(entry) = self.fields.get("inductance") {
            let what = &self.fields.what;
            problems.push(
                Problem::new(format!("{what} has an inductance beside a line"))
                    .at(entry.key.clone(), "of which current?")
                    .help("tell the motor by `voltage`, `constant` and `resistance`, or leave the inductance out"),
            );
            return None;
        }
        let constant = 1.0 / idle?;
        let numbers = [constant, constant / stall?, 0.0];
        Some((Magnitude::Constant(1.0), numbers))
    }

    fn regulator(&self, problems: &mut Problems) -> Option<DriveKind> {
        let si = Unit::of_si();
        let unit = self.reader.units.of(self.is_angle);
        let [damping, force] = match self.is_angle {
            true => ["N m s/rad", "N m"],
            false => ["N s/m", "N"],
        };
        let help = format!("add the wanted speed: `speed = 10`, in {}/s", unit.name);
        let speed = self.given("speed", unit, &help, problems);
        let why = "below zero it would drive the speed away from what is wanted";
        let gain = (&si, Sign::NotNegative, why);
        let help = format!("add for instance `proportional = 2.0`, in {damping}");
        let proportional = self.needed("proportional", gain, &help, problems);
        let integral = self.or("integral", 0.0, gain, problems);
        let why = format!("it is the largest action, in {force}, either way");
        let limit = (&si, Sign::Positive, why.as_str());
        let limit = self.or("limit", f64::INFINITY, limit, problems);
        Some(DriveKind::Regulator(Regulator {
            speed: speed?,
            proportional: proportional?,
            integral: integral?,
            limit: limit?,
        }))
    }

    fn given(
        &self,
        key: &str,
        unit: &Unit,
        help: &str,
        problems: &mut Problems,
    ) -> Option<Magnitude> {
        let entry = self.fields.need(key, self.at, help, problems)?;
        let size = Size {
            unit,
            sign: Sign::Any,
            why: "",
        };
        let magnitudes = self.reader.magnitudes;
        magnitudes.read(entry, &self.fields.what, &size, problems)
    }

    fn needed(
        &self,
        key: &str,
        as_is: (&Unit, Sign, &str),
        help: &str,
        problems: &mut Problems,
    ) -> Option<f64> {
        self.fields.need(key, self.at, help, problems)?;
        self.or(key, 0.0, as_is, problems)
    }

    fn or(
        &self,
        key: &str,
        default: f64,
        (unit, sign, why): (&Unit, Sign, &str),
        problems: &mut Problems,
    ) -> Option<f64> {
        let Some(entry) = self.fields.get(key) else {
            return Some(default);
        };
        let what = format_args!("{key} of {}", self.fields.what);
        signed(entry.value, unit, sign, what, why, problems)
    }
}

/// Says which drives act on an actuator that the motion leads by a law.
pub(crate) fn held(
    drives: &[DriveText],
    motion: &MotionText<'_>,
    actuators: &[ActuatorText<'_>],
    problems: &mut Problems,
) {
    for (a, law) in actuators.iter().zip(&motion.led) {
        let (Some(law), Some(actuator)) = (law, &a.actuator) else {
            continue;
        };
        let led = Actuator::coordinate(actuator);
        for text in drives {
            let (Some(drive), Some(at)) = (&text.drive, &text.at) else {
                continue;
            };
            if is_same(drive.coordinate, led) {
                let (drive, name) = (shorten(&drive.name), shorten(a.name));
                problems.push(
                    Problem::new(format!(
                        "drive `{drive}` acts on `{name}`, which a law leads"
                    ))
                    .at(at.clone(), "driven here")
                    .at(law.key.clone(), "led here")
                    .help(
                        "leave out the drive, which would change nothing of the motion, or the law",
                    ),
                );
            }
        }
    }
}
