//! A scene rewritten in another system of units: every number of a length, mass, inertia or angle is converted, and the
//! program must write the same files.

use super::compared::Compared;
use super::program::Program;
use super::same_columns::same_columns;
use super::scene_text::{Coordinate, Scene, entries, number, text_of, value_of};
use super::units::{ANGLES, LENGTHS, MASSES, Units};
use toml::{Table, Value};

/// Systems of units in which each case is written again: as many as there are units of length.
const SYSTEMS: usize = LENGTHS.len();

/// Compares with the files from the scene in other units.
pub(super) fn compare_units(
    compared: &mut Compared,
    program: &Program,
    scene: &Scene,
    text: &str,
) -> Result<(), String> {
    let moving = Scene::read(text)?;
    let arguments = ["kinetostatics", "--points", "31"];
    let rows = |name: &str, text: &str| {
        let run = program.run(name, text, &arguments);
        run?.npz("-kinetostatics.npz")
    };
    let expected = rows("units", text)?;
    for system in 0..SYSTEMS {
        let (other, units) = in_other_units(&moving.table, scene, system);
        let file = format!("the scene in {units}");
        match rows("other-units", &text_of(&other)?) {
            Ok(rows) => {
                compared.merge("written-units", same_columns(&rows, &expected, &file));
            }
            Err(reason) => compared.fail("written-units", format!("{file}: {reason}")),
        }
    }
    Ok(())
}

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
fn in_other_units(table: &Table, scene: &Scene, system: usize) -> (Table, String) {
    let pick = |of: &[(&'static str, f64)], k: usize| of[k % of.len()];
    let (length, mass) = (pick(&LENGTHS, system), pick(&MASSES, system));
    let (inertia_mass, inertia_length) = (pick(&MASSES, system + 1), pick(&LENGTHS, system + 3));
    let angle = pick(&ANGLES, system);
    let inertia = (
        format!("{} {}2", inertia_mass.0, inertia_length.0),
        inertia_mass.1 * inertia_length.1 * inertia_length.1,
    );
    let old = scene.units;
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
    let mut changed = table.clone();
    changed.insert("units".to_owned(), units);
    factors.convert(&mut changed, scene);
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

/// The entries of a section.
fn section<'a>(
    table: &'a mut Table,
    section: &str,
) -> impl Iterator<Item = (&'a String, &'a mut Value)> {
    let section = table.get_mut(section).and_then(Value::as_table_mut);
    section.into_iter().flat_map(|section| section.iter_mut())
}

fn tables<'a>(table: &'a mut Table, name: &str) -> impl Iterator<Item = (String, &'a mut Table)> {
    let entries = section(table, name);
    entries.filter_map(|(name, value)| Some((name.clone(), value.as_table_mut()?)))
}

/// Whether a joint has one of these kinds. A joint of a pin of three bodies is named after its second body.
fn has_kind(scene: &Scene, name: &str, kinds: &[&str]) -> bool {
    entries(&scene.table, "joints").any(|(joint, keys)| {
        let rest = name.strip_prefix(joint.as_str());
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
            && kinds.iter().any(|kind| keys.contains_key(*kind))
    })
}

impl Factors {
    fn of(&self, coordinate: &Coordinate) -> f64 {
        match coordinate.is_angle {
            true => self.angle,
            false => self.length,
        }
    }

    fn of_name(&self, scene: &Scene, name: &str) -> Option<f64> {
        scene.coordinate(name).map(|coordinate| self.of(coordinate))
    }

    /// The factor of the coordinate that an entry names under a key.
    fn of_named(&self, scene: &Scene, entry: &Table, key: &str) -> f64 {
        let name = entry.get(key).and_then(Value::as_str).unwrap_or("");
        self.of_name(scene, name).unwrap_or(1.0)
    }

    fn convert(&self, table: &mut Table, scene: &Scene) {
        for (_, body) in tables(table, "bodies") {
            self.convert_body(body);
        }
        // A direction has no unit, and any length.
        for (section, key) in [("loads", "direction"), ("joints", "axis")] {
            for (_, entry) in tables(table, section) {
                scale(entry.get_mut(key), LENGTH_OF_DIRECTIONS);
            }
        }
        for (_, joint) in tables(table, "joints") {
            self.convert_joint(joint, scene);
        }
        self.convert_assembly(table, scene);
        for (name, law) in tables(table, "prescribed") {
            let factor = self.of_name(scene, &name).unwrap_or(1.0);
            self.convert_law(law, [1.0, factor]);
        }
        self.convert_sweep(table, scene);
        for (_, load) in tables(table, "loads") {
            scale(load.get_mut("free-length"), self.length);
            scale(load.get_mut("free-angle"), self.angle);
            for key in ["magnitude", "stiffness", "damping"] {
                if let Some(table) = load.get_mut(key).and_then(Value::as_table_mut) {
                    let of = table.get("of").and_then(Value::as_str).unwrap_or("t");
                    let of = of.strip_suffix(".velocity").unwrap_or(of);
                    let factor = self.of_name(scene, of).unwrap_or(1.0);
                    scale_rows(table.get_mut("table"), [factor, 1.0]);
                }
            }
        }
        for (name, friction) in tables(table, "friction") {
            let speed = match has_kind(scene, &name, &["revolute"]) {
                true => self.angle,
                false => self.length,
            };
            for key in ["radius", "guide-length", "bearing-distance"] {
                scale(friction.get_mut(key), self.length);
            }
            scale(friction.get_mut("regularization-speed"), speed);
        }
        self.convert_motion(table, scene);
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

    fn convert_joint(&self, joint: &mut Table, scene: &Scene) {
        for key in ["length", "radii", "radius", "pitch"] {
            scale(joint.get_mut(key), self.length);
        }
        for key in ["angle", "pressure-angle"] {
            scale(joint.get_mut(key), self.angle);
        }
        let names = joint.get("coupling").and_then(Value::as_array).cloned();
        let of = |name: &Value| self.of_name(scene, name.as_str()?);
        if let Some([dependent, independent]) = names.as_deref() {
            let factors = [independent, dependent].map(|name| of(name).unwrap_or(1.0));
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

    /// Coordinates of actuators, angles of bodies, travels of slides, directions of distances and frames.
    fn convert_assembly(&self, table: &mut Table, scene: &Scene) {
        for (name, value) in section(table, "assembly") {
            if let Value::Table(frame) = value {
                scale(frame.get_mut("at"), self.length);
                scale(frame.get_mut("turn"), self.angle);
                continue;
            }
            let usual = match has_kind(scene, name, &["prismatic", "slot"]) {
                true => self.length,
                false => self.angle,
            };
            scale(Some(value), self.of_name(scene, name).unwrap_or(usual));
        }
    }

    fn convert_sweep(&self, table: &mut Table, scene: &Scene) {
        let sweep = table.get_mut("coordinate-sweep");
        let Some(sweep) = sweep.and_then(Value::as_table_mut) else {
            return;
        };
        let swept = sweep.iter().find(|(_, value)| value.is_array());
        let swept = swept.map(|(name, _)| name.as_str());
        let swept = swept.or_else(|| scene.actuators.first().map(|c| c.name.as_str()));
        let speed = swept.and_then(|name| self.of_name(scene, name));
        let speed = speed.unwrap_or(1.0);
        for (name, value) in sweep.iter_mut() {
            if name == "speed" {
                scale(Some(value), speed);
            } else if let Some(factor) = self.of_name(scene, name) {
                scale(Some(value), factor);
            }
        }
    }

    /// Free motions, their drives and stops.
    fn convert_motion(&self, table: &mut Table, scene: &Scene) {
        for (_, stop) in tables(table, "stops") {
            let factor = self.of_named(scene, stop, "coordinate");
            for key in ["min", "max"] {
                scale(stop.get_mut(key), factor);
            }
        }
        for (_, drive) in tables(table, "drives") {
            scale(drive.get_mut("no-load-speed"), self.angle);
            scale(drive.get_mut("inertia"), self.inertia);
            let factor = self.of_named(scene, drive, "speed-controller");
            match drive.get_mut("speed") {
                Some(Value::Table(table)) => scale_rows(table.get_mut("table"), [1.0, factor]),
                speed => scale(speed, factor),
            }
        }
        let Some(motion) = table.get_mut("motion").and_then(Value::as_table_mut) else {
            return;
        };
        let first = scene.actuators.first();
        let first = first.map_or(1.0, |actuator| self.of(actuator));
        for key in ["initial-coordinate", "initial-velocity"] {
            match motion.get_mut(key) {
                Some(Value::Table(table)) => {
                    for (name, value) in table.iter_mut() {
                        scale(Some(value), self.of_name(scene, name).unwrap_or(1.0));
                    }
                }
                value => scale(value, first),
            }
        }
        for (name, law) in tables(motion, "prescribed") {
            let factor = self.of_name(scene, &name).unwrap_or(1.0);
            self.convert_law(law, [1.0, factor]);
        }
        for (_, event) in tables(motion, "events") {
            let factor = self.of_named(scene, event, "reaches");
            scale(event.get_mut("value"), factor);
        }
    }
}
