//! Compares the columns of a file with those of another file that has them, too.

use super::difference::Differences;
use super::rows::{Rows, largest};
use std::collections::BTreeMap;

/// The kind of a column, which determines its scale: forces in x and y, and along the axes of a body, are of one kind.
fn kind_of(name: &str, is_point: bool) -> String {
    if let Some((_, load)) = name.split_once(".c.") {
        return format!("c.{load}");
    }
    let end = name.rsplit('.').next().unwrap_or(name);
    // In space three components of a body are below a name.
    let of_body = name.rsplit('.').nth(1).unwrap_or("");
    if is_point
        && matches!(
            of_body,
            "angular_velocity" | "angular_acceleration" | "rotation"
        )
    {
        return of_body.to_owned();
    }
    if end.starts_with("moment-") || matches!(end, "mx" | "my" | "mz") {
        return "moment".to_owned();
    }
    let kind = match end.split('@').next().unwrap_or(end) {
        "half_dm" => "m",
        "x" | "y" | "z" if is_point && !end.contains('@') => "position",
        "travel" => "position",
        "vx" | "vy" | "vz" => "v",
        "ax" | "ay" | "az" => "a",
        "x" | "y" | "z" | "normal" | "tangent" | "tooth" | "axial" | "across" | "force"
        | "magnitude" | "fx" | "fy" | "fz" | "load_force" => "force",
        "moment" | "load_moment" => "moment",
        _ if name.starts_with("power.") || end == "power" => "power",
        other => other,
    };
    kind.to_owned()
}

/// Compares the columns of a file with those of another file that has them, too, relative to the largest with the same
/// ending.
pub(crate) fn same_columns(rows: &Rows, other: &Rows, file: &str) -> Differences {
    let is_point = |name: &str| name.matches('.').count() == 2;
    let ending = |name: &str| kind_of(name, is_point(name));
    let mut scales = BTreeMap::<String, f64>::new();
    for (name, values) in &other.columns {
        let scale = scales.entry(ending(name)).or_default();
        *scale = scale.max(largest(values));
    }
    // Where no point moves, what rotations would make of it stands in, and where nothing accelerates, what velocities would.
    let of = |scales: &BTreeMap<String, f64>, kind: &str| scales.get(kind).copied().unwrap_or(0.0);
    let turning = of(&scales, "position") * of(&scales, "angular_velocity");
    let moving = scales.entry("v".to_owned()).or_default();
    *moving = moving.max(turning);
    let turning = turning * of(&scales, "angular_velocity");
    let accelerating = scales.entry("a".to_owned()).or_default();
    *accelerating = accelerating.max(turning);
    for (coordinate, point) in [("velocity", "v"), ("acceleration", "a")] {
        let point = scales.get(point).copied().unwrap_or(0.0);
        let scale = scales.entry(coordinate.to_owned()).or_default();
        *scale = scale.max(point);
    }
    for (acceleration, velocity) in [("angular_acceleration", "angular_velocity"), ("a", "v")] {
        let velocity = scales.get(velocity).copied().unwrap_or(0.0);
        let scale = scales.entry(acceleration.to_owned()).or_default();
        *scale = scale.max(velocity * velocity);
    }
    let mut all = Differences::default();
    let known = |(name, _): &(&String, &Vec<f64>)| *name != "relative_error";
    for (name, values) in rows.columns.iter().filter(known) {
        let others = other.columns.get(name);
        let Some(others) = others.filter(|others| others.len() == values.len()) else {
            all.fail(format!(
                "{file} has a column {name} of {} rows that the whole one does not have",
                values.len()
            ));
            continue;
        };
        let scale = scales.get(&ending(name)).copied().unwrap_or(0.0);
        let pairs = values.iter().zip(others);
        let differences = pairs.map(|(value, expected)| value - expected);
        all.add_rows(differences, scale, "", |row| {
            format!("{file}, row {row}, {name}")
        });
    }
    all
}
