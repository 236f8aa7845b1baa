//! Models of other programs: torque, reactions and points of the imported scenes against values that other engines computed for the files.

use dwell::{Import, ImportOptions, InverseDynamics, Scene};
use serde_json::Value;

const FOLDER: &str = "../../validation/imported";
/// Relative to the largest force or moment of a case. The files have 12 decimals.
const TOLERANCE: f64 = 1e-10;

type Failure = Box<dyn std::error::Error>;

/// A model with the options that its file needs, and the points of the scene in the order of the expected file.
struct Case {
    file: &'static str,
    options: ImportOptions,
    points: &'static [&'static str],
}

fn case(file: &'static str, drives: &[&str], points: &'static [&'static str]) -> Case {
    let options = ImportOptions {
        drives: drives.iter().map(|name| (*name).to_owned()).collect(),
        ..ImportOptions::default()
    };
    Case {
        file,
        options,
        points,
    }
}

fn cases() -> Result<Vec<Case>, Failure> {
    let mut key = case("m6-include.xml", &["A"], &["rocker.C"]);
    key.options.key = Some("start".to_owned());
    let mut five_bar = case("u3-fivebar.urdf", &[], &["a2.loop1"]);
    let start = [("q1", 2.2), ("q2", 0.9), ("p1", -1.4), ("p2", 1.3)];
    five_bar.options.start = start
        .map(|(joint, value)| (joint.to_owned(), value))
        .to_vec();
    let loops = std::fs::read_to_string(format!("{FOLDER}/u3-fivebar.yaml"))?;
    five_bar.options.loops = Some(loops);
    // Couplings in space, too.
    let in_space = |mut case: Case| {
        case.options.spatial = true;
        case
    };
    Ok(vec![
        in_space(case("m5-jointeq.xml", &["a"], &[])),
        in_space(case("u2-mimic.urdf", &["jl"], &["left.jl", "right.jr"])),
        case("m1-fourbar.xml", &[], &["coupler.C"]),
        case("m2-rssr.xml", &["A"], &["rod.C"]),
        case("m3-slidercrank.xml", &["A"], &["piston.C"]),
        case("m4-sixbar.xml", &["A"], &["slider.F"]),
        case("m5-jointeq.xml", &["a"], &[]),
        key,
        case("u1-fourbar.urdf", &["A"], &["coupler.C"]),
        case("u2-mimic.urdf", &["jl"], &["left.jl", "right.jr"]),
        five_bar,
        case("s1-fourbar.sdf", &["A"], &["coupler.C"]),
        case("s2-slidercrank.sdf", &["A"], &["slider.C"]),
        case("a1-fourbar.asmt", &[], &["coupler.C"]),
    ])
}

fn expected(file: &str) -> Result<Value, Failure> {
    let stem = file.split('.').next().unwrap_or_default();
    let text = std::fs::read_to_string(format!("{FOLDER}/{stem}.expected.json"))?;
    Ok(serde_json::from_str(&text)?)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn vector(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .map(|list| list.iter().map(number).collect())
        .unwrap_or_default()
}

fn entries(value: &Value) -> Vec<(String, Value)> {
    let object = value.as_object();
    object
        .map(|o| o.iter().map(|(k, v)| (k.clone(), v.clone())).collect())
        .unwrap_or_default()
}

/// What a case is compared by: the largest difference of forces and moments, and the largest value; the largest difference of points.
#[derive(Default)]
struct Differences {
    force: f64,
    largest: f64,
    point: f64,
}

impl Differences {
    fn force(&mut self, found: f64, expected: f64) {
        self.force = self.force.max((found - expected).abs());
        self.largest = self.largest.max(expected.abs());
        assert!(found.is_finite() && expected.is_finite());
    }

    fn vector(&mut self, found: [f64; 3], expected: &[f64]) {
        for (found, expected) in found.iter().zip(expected) {
            self.force(*found, *expected);
        }
        assert_eq!(expected.len(), 3);
    }
}

/// A vector of the scene in the axes of the file.
fn in_space(import: &Import, flat: [f64; 2]) -> [f64; 3] {
    let [x, y, _] = import.plane.unwrap_or_default();
    [0, 1, 2].map(|k| x[k] * flat[0] + y[k] * flat[1])
}

/// The axis of a slide in a planar scene.
fn axis(import: &Import, joint: &str) -> [f64; 2] {
    let line = import
        .scene
        .lines()
        .find(|line| line.starts_with(&format!("{joint} = {{ prismatic")));
    let list = line.and_then(|line| line.split("axis = [").nth(1)?.split(']').next());
    let numbers: Vec<f64> = list
        .unwrap_or_default()
        .split(", ")
        .filter_map(|x| x.parse().ok())
        .collect();
    let length = numbers[0].hypot(numbers[1]);
    [numbers[0] / length, numbers[1] / length]
}

fn reaction(
    import: &Import,
    forces: &InverseDynamics,
    joint: &str,
) -> Result<[f64; 3], dwell::Error> {
    let part = |component: &str| forces.reaction(&format!("{joint}.{component}"));
    if import.plane.is_none() {
        return Ok([part("x")?, part("y")?, part("z")?]);
    }
    match part("normal") {
        Ok(normal) => {
            let [x, y] = axis(import, joint);
            Ok(in_space(import, [-y * normal, x * normal]))
        }
        Err(_) => Ok(in_space(import, [part("x")?, part("y")?])),
    }
}

fn compare(case: &Case) -> Result<Differences, Failure> {
    let import = dwell::import(format!("{FOLDER}/{}", case.file), &case.options)?;
    assert_eq!(import.losses().count(), 0, "{}", case.file);
    let mechanism = Scene::parse(&import.scene)?.assemble()?;
    let expected = expected(case.file)?;
    let instants = expected["instants"].as_array().cloned().unwrap_or_default();
    assert!(instants.len() >= 3);
    let mut differences = Differences::default();
    for instant in &instants {
        // The scene counts from the pose as drawn, which is the first instant.
        let drives: Vec<String> = entries(&instant["velocities"])
            .into_iter()
            .map(|(name, _)| name)
            .collect();
        let of = |key: &str| {
            drives
                .iter()
                .map(|name| number(&instant[key][name]))
                .collect::<Vec<_>>()
        };
        let drawn = drives
            .iter()
            .map(|name| number(&instants[0]["coordinates"][name]));
        let coordinates: Vec<f64> = of("coordinates")
            .into_iter()
            .zip(drawn)
            .map(|(q, drawn)| q - drawn)
            .collect();
        let forces = mechanism.inverse_dynamics(
            0.0,
            &coordinates,
            &of("velocities"),
            &of("accelerations"),
        )?;
        for (drive, force) in entries(&instant["actuator_forces"]) {
            differences.force(
                forces.actuator_force(&format!("q_{drive}"))?,
                number(&force),
            );
        }
        for (joint, force) in entries(&instant["reactions"]) {
            differences.vector(reaction(&import, &forces, &joint)?, &vector(&force));
        }
        for (key, column) in [
            ("coupling_moment_on_b", "loop1.moment"),
            ("coupling_force_on_jr", "jr_mimic.force"),
        ] {
            if !instant[key].is_null() {
                differences.force(forces.reaction(column)?, number(&instant[key]));
            }
        }
        for ((_, place), point) in entries(&instant["points"]).iter().zip(case.points) {
            let found = if import.plane.is_some() {
                let flat = in_space(&import, forces.kinematics().position(point)?);
                // The depth along the normal is not in a planar scene.
                let [.., n] = import.plane.unwrap_or_default();
                let depth: f64 = vector(place).iter().zip(n).map(|(p, n)| p * n).sum();
                [0, 1, 2].map(|k| flat[k] + depth * n[k])
            } else {
                forces.kinematics().position(point)?
            };
            for (found, place) in found.iter().zip(vector(place)) {
                differences.point = differences.point.max((found - place).abs());
            }
        }
    }
    Ok(differences)
}

#[test]
fn imported_models_have_the_torque_reactions_and_points_that_other_engines_compute()
-> Result<(), Failure> {
    for case in cases()? {
        let Differences {
            force,
            largest,
            point,
        } = compare(&case).map_err(|e| format!("{}: {e}", case.file))?;
        println!(
            "{}: force {:.1e} of {largest:.3}, points {point:.1e} m",
            case.file,
            force / largest
        );
        assert!(
            force <= TOLERANCE * largest,
            "{}: {force:e} of {largest}",
            case.file
        );
        assert!(point <= TOLERANCE, "{}: {point:e}", case.file);
    }
    Ok(())
}

#[test]
fn a_link_of_pmks_has_the_torque_reactions_and_positions_of_newton_and_euler() -> Result<(), Failure>
{
    let import = dwell::import(
        format!("{FOLDER}/p1-fourbar.txt"),
        &ImportOptions::default(),
    )?;
    let mechanism = Scene::parse(&import.scene)?.assemble()?;
    let mut differences = Differences::default();
    let expected = expected("p1-fourbar.txt")?;
    let instants = expected["instants"].as_array().cloned().unwrap_or_default();
    for instant in &instants {
        let q = number(&instant["crank_angle"]) - number(&instants[0]["crank_angle"]);
        let forces =
            mechanism.inverse_dynamics(0.0, &[q], &[number(&instant["crank_speed"])], &[0.0])?;
        differences.force(
            forces.actuator_force("q_A")?,
            number(&instant["input_torque"]),
        );
        for (joint, force) in entries(&instant["reactions"]) {
            let force = vector(&force);
            differences.vector(
                reaction(&import, &forces, &joint)?,
                &[force[0], force[1], 0.0],
            );
        }
        for (joint, place) in entries(&instant["positions"]) {
            let [x, y] = forces.kinematics().position(&format!("BC.{joint}"))?;
            for (found, place) in [x, y].iter().zip(vector(&place)) {
                differences.point = differences.point.max((found - place).abs());
            }
        }
    }
    let Differences {
        force,
        largest,
        point,
    } = differences;
    println!(
        "p1: force {:.1e} of {largest:.3}, points {point:.1e} m",
        force / largest
    );
    assert!(
        force <= TOLERANCE * largest && point <= TOLERANCE,
        "{force:e} of {largest}, {point:e}"
    );
    Ok(())
}
