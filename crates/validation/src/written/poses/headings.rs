//! The units at the head of written columns, by the names of the columns and what the scene's text says of them.

use super::difference::Differences;
use super::read_files::heads;
use super::reading::{Measure, Reading};

/// Units by the last part of a column's name.
#[rustfmt::skip]
const UNITS: [(&str, &[&str]); 10] = [
    ("s", &["t"]),
    ("rad", &["angle", "direction", "transmission_angle"]),
    ("rad/s", &["angular_velocity"]),
    ("rad/s2", &["angular_acceleration"]),
    ("m/s", &["vx", "vy"]),
    ("m/s2", &["ax", "ay"]),
    ("N", &["normal", "magnitude", "tooth", "separating", "load_force", "axial", "shear", "fx", "fy"]),
    ("N m", &["moment", "load_moment", "bending"]),
    ("J", &["work", "kinetic_bodies", "V"]),
    ("A", &["current"]),
];

/// Every unit that is known of the columns of a file; its first line, and what the file is.
pub(crate) fn heading_differences(file: &str, reading: &Reading, what: &str) -> Differences {
    let mut all = Differences::default();
    for (name, unit) in heads(file.lines().next().unwrap_or("")) {
        let Some(expected) = unit_of(&name, reading) else {
            continue;
        };
        let difference = if unit == expected { 0.0 } else { 1.0 };
        all.add(difference, 1.0, "", || {
            format!("{what}, `{name}` in {unit} in place of {expected}")
        });
    }
    all
}

/// The unit of a column; none where its name alone does not say it.
fn unit_of(name: &str, reading: &Reading) -> Option<String> {
    let text = |unit: &str| Some(unit.to_owned());
    if let Some(coordinate) = reading.coordinate(name) {
        return text(unit_of_measure(coordinate.measure));
    }
    let Some((prefix, last)) = name.rsplit_once('.') else {
        let whole = matches!(name, "m" | "m_1" | "half_dm" | "half_m_1q1");
        let first = reading.coordinates.first().filter(|_| whole);
        return match (name, first?.measure) {
            ("m" | "m_1", Measure::Angle(_)) => text("kg m2"),
            ("m" | "m_1", _) => text("kg"),
            (_, Measure::Angle(_)) => text("kg m2/rad"),
            (_, _) => text("kg/m"),
        };
    };
    let last = last.split('@').next().unwrap_or(last);
    if let Some(coordinate) = reading.coordinate(prefix) {
        let unit = unit_of_measure(coordinate.measure);
        return match (last, unit) {
            ("velocity", _) => text(&format!("{unit}/s")),
            ("acceleration", _) => text(&format!("{unit}/s2")),
            ("actuator_force", "m") => text("N"),
            ("actuator_force", _) => text("N m"),
            _ => None,
        };
    }
    match (prefix, last) {
        ("energy", _) => return text("J"),
        ("power", _) | (_, "power" | "electrical_power") => return text("W"),
        ("shaking", "x" | "y") => return text("N"),
        _ => {}
    }
    if matches!(last, "x" | "y") {
        let is_joint = reading.joints.iter().any(|joint| joint.name == prefix);
        let body = prefix.split('.').next().filter(|_| prefix.contains('.'));
        let is_point = body.is_some_and(|body| reading.body_index(body).is_some());
        return match (is_joint, is_point) {
            (true, false) => text("N"),
            (false, true) => text("m"),
            _ => None,
        };
    }
    let found = UNITS.iter().find(|(_, names)| names.contains(&last));
    found.and_then(|(unit, _)| text(unit))
}

fn unit_of_measure(measure: Measure) -> &'static str {
    match measure {
        Measure::Angle(_) => "rad",
        Measure::Travel(..) | Measure::Length(_) => "m",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_unit_is_found() {
        let scene = "[bodies]\nground = { points = { O = [0, 0] } }\nbar = { points = { O = [0, 0], P = [1, 0] } }\n\
                     [joints]\nO = { revolute = [\"ground.O\", \"bar.O\"] }\n[actuators]\nq = { angle = [\"ground\", \"bar\"] }\n";
        let reading = Reading::new(scene).expect("a scene");
        let of = |line: &str| heading_differences(line, &reading, "file").largest();
        let right = "t [s],q [rad],q.velocity [rad/s],bar.P.x [m],O.x [N],O.x@bar [N],q.actuator_force [N m],m [kg m2]";
        assert_eq!(of(right), 0.0);
        for wrong in [
            "O.x [m]",
            "q.velocity [m/s]",
            "m [kg m2/rad]",
            "pen.load_moment [N]",
        ] {
            assert_eq!(of(wrong), 1.0, "{wrong}");
        }
    }
}
