//! What `check` prints of motions, stops and teeth, against the scene's text: the beginnings of lines, and the numbers that follow.

use super::law::number;
use super::reading::{JointKind, Reading};
use super::stated::Expected;
use toml::{Table, Value};

/// A line's beginning and its numbers with their scales.
type Line = (String, Vec<Expected>);

/// The lines that the scene's text determines.
pub(super) fn motion_lines(reading: &Reading, scene: &Table) -> Vec<Line> {
    let mut lines = Vec::new();
    lines.extend(free_motion(reading, scene));
    lines.extend(prescribed_motion(scene));
    lines.extend(sweep(reading, scene));
    lines.extend(stops(scene));
    lines.extend(teeth(reading));
    lines
}

fn expected(value: f64) -> Expected {
    (value, value.abs().max(f64::MIN_POSITIVE))
}

/// Start, velocity and duration, where the text gives the start of every actuator.
fn free_motion(reading: &Reading, scene: &Table) -> Option<Line> {
    let motion = scene.get("motion")?.as_table()?;
    let of = |key: &str, name: &str| number(motion.get(key)?.get(name));
    let mut values = Vec::new();
    for coordinate in reading.coordinates.iter().take(reading.actuator_count) {
        if motion.contains_key(&coordinate.name) {
            return None;
        }
        values.push(expected(of("initial-coordinate", &coordinate.name)?));
        let velocity = of("initial-velocity", &coordinate.name).unwrap_or(0.0);
        values.push(expected(velocity));
    }
    let length = ["duration", "periods"]
        .iter()
        .find_map(|key| number(motion.get(*key)));
    values.push(expected(length?));
    Some(("free motion: ".to_owned(), values))
}

fn prescribed_motion(scene: &Table) -> Option<Line> {
    let prescribed = scene.get("prescribed")?.as_table()?;
    let numbers = [Some("duration"), prescribed.get("points").map(|_| "points")];
    let values = numbers
        .into_iter()
        .flatten()
        .map(|key| number(prescribed.get(key)).map(expected));
    Some((
        "prescribed motion: ".to_owned(),
        values.collect::<Option<_>>()?,
    ))
}

/// The ends of a sweep.
fn sweep(reading: &Reading, scene: &Table) -> Option<Line> {
    let sweep = scene.get("coordinate-sweep")?.as_table()?;
    let ranges = reading.coordinates.iter().filter_map(|c| {
        let range = sweep.get(&c.name)?.as_array()?;
        Some((&c.name, [number(range.first())?, number(range.get(1))?]))
    });
    let (name, ends) = ranges.into_iter().next()?;
    Some((
        format!("coordinate sweep: {name} "),
        ends.map(expected).to_vec(),
    ))
}

/// Limits and coefficient of restitution of each stop.
fn stops(scene: &Table) -> Vec<Line> {
    let stops = scene
        .get("stops")
        .and_then(Value::as_table)
        .cloned()
        .unwrap_or_default();
    let line = |(name, keys): (&String, &Value)| {
        let of = |key: &str| number(keys.get(key));
        let limits = [of("min"), of("max")].into_iter().flatten();
        let mut values: Vec<Expected> = limits.map(expected).collect();
        values.push(expected(of("restitution").unwrap_or(0.0)));
        (format!("end stop {name}: "), values)
    };
    stops.iter().map(line).collect()
}

/// Pressure angles of teeth, in degrees.
fn teeth(reading: &Reading) -> Option<Line> {
    let angle = |kind: &JointKind| match kind {
        JointKind::Gear { pressure_angle, .. } | JointKind::Rack { pressure_angle, .. } => {
            Some(*pressure_angle)
        }
        JointKind::Revolute
        | JointKind::Prismatic { .. }
        | JointKind::Slot { .. }
        | JointKind::Weld { .. }
        | JointKind::Rolling { .. }
        | JointKind::Distance { .. }
        | JointKind::Coupling { .. } => None,
    };
    let angles = reading.joints.iter().filter_map(|joint| angle(&joint.kind));
    let angles: Vec<Expected> = angles
        .filter(|a| *a != 0.0)
        .map(|a| expected(a.to_degrees()))
        .collect();
    (!angles.is_empty()).then(|| ("separating forces: ".to_owned(), angles))
}
