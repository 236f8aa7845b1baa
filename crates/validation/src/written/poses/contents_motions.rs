//! What `check` prints of motions, stops and teeth, against the scene's text: the beginnings of lines, and the numbers that follow.

use super::law::number;
use super::reading::Reading;
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
    // A number in a name is not one of the line's.
    lines.retain(|(start, _)| !start.split_whitespace().any(is_number));
    lines
}

/// Whether a word of a name reads as a number.
fn is_number(word: &str) -> bool {
    word.trim_end_matches(':')
        .parse::<f64>()
        .is_ok_and(f64::is_finite)
}

fn expected(value: f64) -> Expected {
    (value, value.abs().max(f64::MIN_POSITIVE))
}

/// Start, velocity and duration, where the text gives the start of every actuator.
fn free_motion(reading: &Reading, scene: &Table) -> Option<Line> {
    let motion = scene.get("motion")?.as_table()?;
    // Of a single coordinate the number itself is allowed.
    let of = |key: &str, name: &str| {
        let value = motion.get(key)?;
        number(Some(value)).or_else(|| number(value.get(name)))
    };
    let mut values = Vec::new();
    for coordinate in reading.coordinates.iter().take(reading.actuator_count) {
        if motion.contains_key(&coordinate.name)
            || coordinate.name.split_whitespace().any(is_number)
        {
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
        // One that yields has a stiffness instead.
        if keys.get("stiffness").is_none() {
            values.push(expected(of("restitution").unwrap_or(0.0)));
        }
        (format!("end stop {name}: "), values)
    };
    stops.iter().map(line).collect()
}

/// Pressure angles of teeth, in degrees.
fn teeth(reading: &Reading) -> Option<Line> {
    let angles = reading.joints.iter().map(|joint| joint.pressure_angle);
    let angles: Vec<Expected> = angles
        .filter(|a| *a != 0.0)
        .map(|a| expected(a.to_degrees()))
        .collect();
    (!angles.is_empty()).then(|| ("separating forces: ".to_owned(), angles))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_that_yields_has_no_restitution() {
        let scene: Table = "[stops]\nhard = { max = 300, restitution = 0.5 }\nsoft = { min = -10, stiffness = 1e4, damping = 20 }"
            .parse()
            .expect("a scene");
        let lines = stops(&scene);
        assert_eq!(lines[0].1, [(300.0, 300.0), (0.5, 0.5)]);
        assert_eq!(lines[1].1, [(-10.0, 10.0)]);
        assert!(is_number("2") && is_number("2:") && !is_number("mesh-2"));
    }
}
