//! Numbers that look like slips of units, for `dwell check`: what no machine has by a factor that no machine explains.
//! Each sign leaves several powers of ten to anything real, so that it is silent about every case.

use crate::number_format::number;
use dwell_geometry::BodyId;
use dwell_kinetostatics::{LoadKind, Magnitude};
use dwell_scene::Scene;
use std::f64::consts::TAU;

/// Acceleration of free fall, m/s², and how much another may differ to be a thousand times it: a hundredth.
const FREE_FALL: f64 = 9.81;
const SAME: f64 = 0.01;
/// Revolutions of an angle at the start that is given in radians: 30 is nearly five.
const REVOLUTIONS: f64 = 3.0;
/// Mass over the cube of a mechanism's size, kg/m³, beyond which it is no machine: a boom of 30 m and 100 kg has 4e-3,
/// solid steel 8e3. Below a size (m) that a thing of light bars has, or above one, nothing is said.
const DENSITIES: [f64; 2] = [1e-4, 1e7];
const LARGE: f64 = 30.0;
const SMALL: f64 = 0.01;

/// A line for each number that looks like a slip of units.
pub(crate) fn describe_suspicious_units(scene: &Scene) -> String {
    gravity(scene) + &angles(scene) + &size(scene)
}

/// Gravity of 9810 m/s²: meant in mm/s².
fn gravity(scene: &Scene) -> String {
    let line = |load: &dwell_kinetostatics::Load| {
        let (LoadKind::Gravity { .. }, Magnitude::Constant(value)) = (&load.kind, &load.magnitude)
        else {
            return None;
        };
        let is = |factor: f64| (value.abs() / (factor * FREE_FALL) - 1.0).abs() < SAME;
        (is(1e3) || is(1e-3)).then(|| {
            let (name, value) = (&load.name, number(*value));
            format!(
                "  is a unit meant otherwise? `{name}` is an acceleration of gravity of {value} m/s², not {FREE_FALL}\n"
            )
        })
    };
    scene.loads.iter().filter_map(line).collect()
}

/// Angles at the start of many revolutions in radians: meant in degrees.
fn angles(scene: &Scene) -> String {
    if scene.to_scene_unit(1.0, true).0 != 1.0 {
        return String::new();
    }
    let mechanism = &scene.mechanism;
    let guesses = scene.assembly.initial_guess.iter().enumerate();
    let of_bodies = guesses.map(|(b, angle)| (mechanism.body_name(BodyId(b)), *angle));
    let actuators = mechanism.actuators.iter().zip(&scene.assembly.coordinates);
    let of_actuators = actuators
        .filter(|(actuator, _)| actuator.coordinate().is_angle())
        .map(|(actuator, angle)| (actuator.name.as_str(), Some(*angle)));
    let line = |(name, angle): (&str, Option<f64>)| {
        let angle = angle.filter(|angle| angle.abs() > REVOLUTIONS * TAU)?;
        let revolutions = number(angle / TAU);
        let angle = number(angle);
        Some(format!(
            "  is a unit meant otherwise? `{name}` is at {angle} rad at the start, {revolutions} revolutions; [units] angle = \"deg\" gives degrees\n"
        ))
    };
    of_bodies.chain(of_actuators).filter_map(line).collect()
}

/// A size that the masses contradict: metres for millimetres, or the reverse.
fn size(scene: &Scene) -> String {
    let masses = scene.masses.iter().map(|mass| mass.mass);
    let heaviest = masses.fold(0.0, f64::max);
    let size = scene.mechanism.size();
    let density = heaviest / size.powi(3);
    let [least, most] = DENSITIES;
    let is_suspicious =
        (size > LARGE && density < least) || (size > 0.0 && size < SMALL && density > most);
    if heaviest == 0.0 || !is_suspicious {
        return String::new();
    }
    let (size, heaviest) = (number(size), number(heaviest));
    format!(
        "  is a unit meant otherwise? links are up to {size} m long, and the heaviest body has {heaviest} kg; [units] length = \"mm\" gives millimetres\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn notes(text: &str) -> String {
        describe_suspicious_units(&Scene::parse("scene.toml", text).expect("a scene"))
    }

    fn pendulum(units: &str, tip: f64, angle: f64, gravity: f64) -> String {
        format!(
            r#"
[units]
{units}
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.upper]
points = {{ A = [0, 0], B = [{tip:?}, 0] }}
mass = 1.0
center = [{tip:?}, 0]
[bodies.lower]
points = {{ B = [0, 0], C = [{tip:?}, 0] }}
mass = 0.5
center = [{tip:?}, 0]
[joints]
A = {{ revolute = ["ground.A", "upper.A"] }}
B = {{ revolute = ["upper.B", "lower.B"] }}
[actuators.p]
angle = ["ground", "upper"]
[actuators.q]
angle = ["upper", "lower"]
[assembly]
p = {angle:?}
q = 0.0
[loads]
weight = {{ gravity = [0, -{gravity:?}] }}
"#
        )
    }

    #[test]
    fn slips_are_noticed_and_cases_are_not() {
        assert_eq!(notes(&pendulum("", 0.3, 0.5, 9.81)), "");
        assert!(notes(&pendulum("", 0.3, 0.5, 9810.0)).contains("9810 m/s²"));
        assert!(notes(&pendulum("", 0.3, 30.0, 9.81)).contains("4.77465 revolutions"));
        assert_eq!(notes(&pendulum("angle = \"deg\"", 0.3, 30.0, 9.81)), "");
        assert!(notes(&pendulum("", 300.0, 0.5, 9.81)).contains("up to 300 m"));
        assert_eq!(notes(&pendulum("length = \"mm\"", 300.0, 0.5, 9.81)), "");
        assert!(notes(&pendulum("length = \"mm\"", 0.3, 0.5, 9.81)).contains("0.0003 m"));
        let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
        let mut count = 0;
        for case in std::fs::read_dir(cases).expect("cases").flatten() {
            if let Ok(scene) = Scene::read(case.path().join("scene.toml")) {
                assert_eq!(describe_suspicious_units(&scene), "", "{}", scene.name);
                count += 1;
            }
        }
        assert!(count >= 27, "{count} cases");
    }
}
