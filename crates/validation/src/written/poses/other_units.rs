//! A scene rewritten in another system of units: every number of a length, mass, inertia or angle is converted, and the
//! program must write the same files.

use super::law::number;
use super::reading::{JointKind, Measure, Reading};
use super::scene_text::value_of;
use super::units::{ANGLES, LENGTHS, MASSES, Units};
use toml::{Table, Value};

/// By which components of directions are multiplied, whose ratio alone counts.
const LENGTH_OF_DIRECTIONS: f64 = 3.7;

/// By which numbers of the scene are multiplied.
struct Factors {
    length: f64,
    mass: f64,
    inertia: f64,
    angle: f64,
}

/// The scene in other units, and their names: of as many successive systems as there are lengths each unit is one.
pub(crate) fn in_other_units(scene: &Table, reading: &Reading, system: usize) -> (Table, String) {
    let pick = |of: &[(&'static str, f64)], k: usize| of[k % of.len()];
    let (length, mass) = (pick(&LENGTHS, system), pick(&MASSES, system));
    let (inertia_mass, inertia_length) = (pick(&MASSES, system + 1), pick(&LENGTHS, system + 3));
    let angle = pick(&ANGLES, system);
    let inertia = (
        format!("{} {}2", inertia_mass.0, inertia_length.0),
        inertia_mass.1 * inertia_length.1 * inertia_length.1,
    );
    let old = reading.units;
    let new = Units {
        length: length.1,
        mass: mass.1,
        inertia: inertia.1,
        angle: angle.1,
    };
    let factors = Factors {
        length: old.length / new.length,
        mass: old.mass / new.mass,
        inertia: old.inertia / new.inertia,
        angle: old.angle / new.angle,
    };
    let names = [
        ("length", length.0),
        ("mass", mass.0),
        ("inertia", &inertia.0),
        ("angle", angle.0),
    ];
    let units = value_of(names.map(|(key, name)| (key, name.into())));
    let mut changed = scene.clone();
    changed.insert("units".to_owned(), units);
    factors.convert(&mut changed, reading);
    (changed, names.map(|(_, name)| name).join(", "))
}

/// Multiplies a number, or every number of an array.
fn scale(value: Option<&mut Value>, factor: f64) {
    match value {
        Some(Value::Array(all)) => all.iter_mut().for_each(|value| scale(Some(value), factor)),
        Some(value) => {
            if let Some(x) = number(Some(value)) {
                *value = Value::Float(x * factor);
            }
        }
        None => {}
    }
}

/// Multiplies the columns of a table's rows.
fn scale_rows(value: Option<&mut Value>, factors: [f64; 2]) {
    for row in value.and_then(Value::as_array_mut).into_iter().flatten() {
        for (cell, factor) in row.as_array_mut().into_iter().flatten().zip(factors) {
            scale(Some(cell), factor);
        }
    }
}

fn tables<'a>(
    scene: &'a mut Table,
    section: &str,
) -> impl Iterator<Item = (String, &'a mut Table)> {
    let section = scene.get_mut(section).and_then(Value::as_table_mut);
    let entries = section.into_iter().flat_map(|section| section.iter_mut());
    entries.filter_map(|(name, value)| Some((name.clone(), value.as_table_mut()?)))
}

impl Factors {
    fn of(&self, measure: Measure) -> f64 {
        match measure.is_angle() {
            true => self.angle,
            false => self.length,
        }
    }

    fn of_name(&self, reading: &Reading, name: &str) -> Option<f64> {
        Some(self.of(reading.coordinate(name)?.measure))
    }

    /// Of the coordinate that an entry names under a key.
    fn of_named(&self, reading: &Reading, entry: &Table, key: &str) -> f64 {
        let name = entry.get(key).and_then(Value::as_str).unwrap_or("");
        self.of_name(reading, name).unwrap_or(1.0)
    }

    fn convert(&self, scene: &mut Table, reading: &Reading) {
        for (_, body) in tables(scene, "bodies") {
            self.convert_body(body);
        }
        // A direction has no unit, and any length.
        for (section, key) in [("loads", "direction"), ("joints", "axis")] {
            for (_, entry) in tables(scene, section) {
                scale(entry.get_mut(key), LENGTH_OF_DIRECTIONS);
            }
        }
        for (name, joint) in tables(scene, "joints") {
            self.convert_joint(joint, &name, reading);
        }
        self.convert_assembly(scene, reading);
        for (name, law) in tables(scene, "prescribed") {
            let factor = self.of_name(reading, &name).unwrap_or(1.0);
            self.convert_law(law, [1.0, factor]);
        }
        self.convert_sweep(scene, reading);
        for (_, load) in tables(scene, "loads") {
            scale(load.get_mut("free-length"), self.length);
            scale(load.get_mut("free-angle"), self.angle);
            for key in ["magnitude", "stiffness", "damping"] {
                if let Some(table) = load.get_mut(key).and_then(Value::as_table_mut) {
                    let of = table.get("of").and_then(Value::as_str).unwrap_or("t");
                    let of = of.strip_suffix(".velocity").unwrap_or(of);
                    let factor = self.of_name(reading, of).unwrap_or(1.0);
                    scale_rows(table.get_mut("table"), [factor, 1.0]);
                }
            }
        }
        let is_pin = |name: &str| {
            let of_pin = format!("{name}-");
            let is_named = |of: &str| of == name || of.starts_with(&of_pin);
            let mut joints = reading.joints.iter();
            joints.any(|j| j.kind == JointKind::Revolute && is_named(&j.name))
        };
        for (name, friction) in tables(scene, "friction") {
            let speed = match is_pin(&name) {
                true => self.angle,
                false => self.length,
            };
            scale(friction.get_mut("radius"), self.length);
            scale(friction.get_mut("guide-length"), self.length);
            scale(friction.get_mut("regularization-speed"), speed);
        }
        self.convert_motion(scene, reading);
    }

    fn convert_body(&self, body: &mut Table) {
        let points = body.get_mut("points").and_then(Value::as_table_mut);
        for (_, point) in points.into_iter().flat_map(|points| points.iter_mut()) {
            scale(Some(point), self.length);
        }
        scale(body.get_mut("center"), self.length);
        scale(body.get_mut("mass"), self.mass);
        scale(body.get_mut("inertia"), self.inertia);
        let varying = body.get_mut("varying-inertia");
        if let Some(table) = varying.and_then(Value::as_table_mut) {
            scale(table.get_mut("angle"), self.angle);
            scale(table.get_mut("inertia"), self.inertia);
            scale(table.get_mut("half-slope"), self.inertia);
        }
    }

    fn convert_joint(&self, joint: &mut Table, name: &str, reading: &Reading) {
        for key in ["length", "radii", "radius"] {
            scale(joint.get_mut(key), self.length);
        }
        for key in ["angle", "pressure-angle"] {
            scale(joint.get_mut(key), self.angle);
        }
        let found = reading.joints.iter().find(|j| j.name == name);
        if let Some(JointKind::Coupling {
            dependent,
            independent,
            ..
        }) = found.map(|j| &j.kind)
        {
            let factors = [self.of(*independent), self.of(*dependent)];
            scale(joint.get_mut("start"), factors[1]);
            self.convert_law(joint, factors);
        }
    }

    /// A law, with the factors of its variable and of its value.
    fn convert_law(&self, law: &mut Table, [variable, value]: [f64; 2]) {
        scale(law.get_mut("speed"), value);
        scale_rows(law.get_mut("table"), [variable, value]);
        for kind in [
            "sinusoid",
            "polynomial345",
            "polynomial4567",
            "cycloidal",
            "trapezoidal",
        ] {
            let Some(of) = law.get_mut(kind).and_then(Value::as_table_mut) else {
                continue;
            };
            for key in ["amplitude", "rise"] {
                scale(of.get_mut(key), value);
            }
            for key in ["period", "duration", "delay", "ramp"] {
                scale(of.get_mut(key), variable);
            }
            scale(of.get_mut("phase"), self.angle);
        }
    }

    /// Coordinates of actuators, angles of bodies, travels of slides and directions of distances.
    fn convert_assembly(&self, scene: &mut Table, reading: &Reading) {
        let Some(assembly) = scene.get_mut("assembly").and_then(Value::as_table_mut) else {
            return;
        };
        for (name, value) in assembly.iter_mut() {
            let is_slide = reading.body_index(name).is_none() && reading.slide(name).is_some();
            let usual = if is_slide { self.length } else { self.angle };
            scale(Some(value), self.of_name(reading, name).unwrap_or(usual));
        }
    }

    fn convert_sweep(&self, scene: &mut Table, reading: &Reading) {
        let sweep = scene.get_mut("coordinate-sweep");
        let Some(sweep) = sweep.and_then(Value::as_table_mut) else {
            return;
        };
        let swept = sweep.iter().find(|(_, value)| value.is_array());
        let swept = swept.map(|(name, _)| name.as_str());
        let swept = swept.or_else(|| reading.coordinates.first().map(|c| c.name.as_str()));
        let speed = swept.and_then(|name| self.of_name(reading, name));
        let speed = speed.unwrap_or(1.0);
        for (name, value) in sweep.iter_mut() {
            if name == "speed" {
                scale(Some(value), speed);
            } else if let Some(factor) = self.of_name(reading, name) {
                scale(Some(value), factor);
            }
        }
    }

    /// Free motions, their drives and stops.
    fn convert_motion(&self, scene: &mut Table, reading: &Reading) {
        for (_, stop) in tables(scene, "stops") {
            let factor = self.of_named(reading, stop, "coordinate");
            for key in ["min", "max"] {
                scale(stop.get_mut(key), factor);
            }
        }
        for (_, drive) in tables(scene, "drives") {
            scale(drive.get_mut("no-load-speed"), self.angle);
            scale(drive.get_mut("inertia"), self.inertia);
            let factor = self.of_named(reading, drive, "speed-controller");
            match drive.get_mut("speed") {
                Some(Value::Table(table)) => scale_rows(table.get_mut("table"), [1.0, factor]),
                speed => scale(speed, factor),
            }
        }
        let Some(motion) = scene.get_mut("motion").and_then(Value::as_table_mut) else {
            return;
        };
        let first = reading.coordinates.first();
        let first = first.map_or(1.0, |c| self.of(c.measure));
        for key in ["initial-coordinate", "initial-velocity"] {
            match motion.get_mut(key) {
                Some(Value::Table(table)) => {
                    for (name, value) in table.iter_mut() {
                        scale(Some(value), self.of_name(reading, name).unwrap_or(1.0));
                    }
                }
                value => scale(value, first),
            }
        }
        for (name, law) in tables(motion, "prescribed") {
            let factor = self.of_name(reading, &name).unwrap_or(1.0);
            self.convert_law(law, [1.0, factor]);
        }
        for (_, event) in tables(motion, "events") {
            let factor = self.of_named(reading, event, "reaches");
            scale(event.get_mut("value"), factor);
        }
    }
}
