//! All checks of a case's files about positions, as findings.

use super::closure::closure;
use super::equilibrium::equilibrium;
use super::formats::formats;
use super::judged::Judged;
use super::law::{Law, number};
use super::program::{Program, Run};
use super::rates::rates;
use super::reading::Reading;
use super::reduced_files::judge_reduced;
use super::scene_text::{Draws, requests_everything, text_of};
use super::section_files::judge_sections;
use super::unit_files::judge_units;
use dwell_findings::Finding;
use std::path::Path;

/// How far a case without a motion is swept, rad or m.
const SWEEP: f64 = 0.4;

/// Runs the program at `path` on a case and judges the files. A run that fails is a failed finding.
pub(crate) fn findings(path: &Path, name: &str, scene: &str) -> Vec<Finding> {
    let mut judged = Judged::default();
    if let Err(reason) = judge(&mut judged, path, name, scene) {
        judged.fail("written-closure", reason);
    }
    judged.findings()
}

fn judge(judged: &mut Judged, path: &Path, name: &str, scene: &str) -> Result<(), String> {
    let program = Program::new(path, name).map_err(|e| format!("no folder for the files: {e}"))?;
    let reading = Reading::new(scene)?;
    let mut draws = Draws::of(scene);
    let everything = text_of(&requests_everything(scene)?)?;
    let moving = with_motion(&everything, &reading, &mut draws)?;
    // With several actuators a motion says which of them moves.
    let kinematic = if reading.actuator_count == 1 {
        &everything
    } else {
        &moving
    };
    judge_kinematics(judged, &program, &reading, kinematic)?;
    judge_forces(judged, &program, &reading, &moving, &mut draws)?;
    judge_units(judged, &program, &reading, &moving, &mut draws)?;
    if reading.actuator_count == 1 {
        judge_reduced(judged, &program, &reading, [scene, &everything], &mut draws)?;
    }
    Ok(())
}

/// The scene with a sweep from its assembly on, if it has no motion that forces of inertia follow from.
fn with_motion(scene: &str, reading: &Reading, draws: &mut Draws) -> Result<String, String> {
    let mut table: toml::Table = scene
        .parse()
        .map_err(|e| format!("the scene is no TOML: {e}"))?;
    let has_motion = ["prescribed", "coordinate-sweep"]
        .iter()
        .any(|key| table.contains_key(*key));
    if has_motion || reading.actuator_count == 0 {
        return Ok(scene.to_owned());
    }
    let coordinate = &reading.coordinates[0];
    let unit = reading.unit_of(coordinate.measure);
    let assembly = table.get("assembly").and_then(|a| a.get(&coordinate.name));
    let start = number(assembly).unwrap_or(0.0);
    let ends = [start, start + SWEEP / unit].map(toml::Value::Float);
    let speed = toml::Value::Float((1.0 + 3.0 * draws.share()) / unit);
    let sweep = [
        (coordinate.name.clone(), toml::Value::Array(ends.to_vec())),
        ("speed".to_owned(), speed),
    ];
    table.insert(
        "coordinate-sweep".to_owned(),
        toml::Value::Table(sweep.into_iter().collect()),
    );
    text_of(&table)
}

fn judge_kinematics(
    judged: &mut Judged,
    program: &Program,
    reading: &Reading,
    scene: &str,
) -> Result<(), String> {
    let run = program
        .run("kinematics", scene, &["kinematics"])
        .map_err(|e| e.to_string())?;
    let rows = run.csv("-kinematics.csv")?;
    add_formats(judged, &run, reading, "kinematics")?;
    let of = closure(reading, &rows, "kinematics");
    judged.merge("written-closure", of.joints);
    judged.merge("written-laws", of.laws);
    if let Some(time) = rows.columns.get("t") {
        judged.merge(
            "written-rates",
            rates(&rows, time, &corners(reading), "kinematics"),
        );
    }
    Ok(())
}

/// Where laws of the prescribed motion have corners, s.
pub(crate) fn corners(reading: &Reading) -> Vec<f64> {
    reading
        .laws
        .iter()
        .flatten()
        .flat_map(Law::corners)
        .collect()
}

fn judge_forces(
    judged: &mut Judged,
    program: &Program,
    reading: &Reading,
    scene: &str,
    draws: &mut Draws,
) -> Result<(), String> {
    let has_motion = scene
        .parse::<toml::Table>()
        .is_ok_and(|s| s.contains_key("prescribed") || s.contains_key("coordinate-sweep"));
    for command in ["kinetostatics", "statics"] {
        // Without a motion there are no speeds that forces of inertia follow from.
        if !has_motion && (command == "kinetostatics" || reading.actuator_count > 1) {
            continue;
        }
        let points = (61 + draws.below(60)).to_string();
        let run = program
            .run(command, scene, &[command, "--points", &points])
            .map_err(|e| e.to_string())?;
        let rows = run.npz(&format!("-{command}.npz"))?;
        let of = closure(reading, &rows, command);
        judged.merge("written-closure", of.joints);
        let forces = equilibrium(reading, &rows, command, command == "statics");
        judged.merge("written-equilibrium", forces.bodies);
        judged.merge("written-loads", forces.loads);
        judged.merge("written-totals", forces.totals);
        add_formats(judged, &run, reading, command)?;
    }
    if has_motion {
        judge_sections(judged, program, reading, scene, draws)?;
    }
    Ok(())
}

/// The files and sentences of a run against each other.
fn add_formats(
    judged: &mut Judged,
    run: &Run,
    reading: &Reading,
    command: &str,
) -> Result<(), String> {
    let of = formats(run, command, command, &corners(reading))?;
    judged.merge("written-files", of.files);
    judged.merge("written-extrema", of.extrema);
    judged.merge("written-sentences", of.printed);
    Ok(())
}
