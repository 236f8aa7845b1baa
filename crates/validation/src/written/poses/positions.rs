//! The checks of a case's files about positions.

use super::compared::Compared;
use super::contents::compare_contents;
use super::extrema_again::same_extrema;
use super::largest_values::printed_extrema;
use super::movement::movement;
use super::other_units::compare_units;
use super::overshoot::warning_differences;
use super::program::Program;
use super::reduced_files::compare_reduced;
use super::scene_text::{Scene, has_motion, number, text_of, value_of};

/// Number of rows of a motion, and of the motion whose extrema are searched for again.
const POINTS: &str = "97";
const OTHER_POINTS: &str = "26";
/// Amplitudes of a prescribed motion that the scene does not give, rad or parts of the size, and its period, s.
const AMPLITUDES: [f64; 4] = [0.25, 0.2, 0.15, 0.1];
const PERIOD: f64 = 1.0;

/// Runs the commands about positions on a case and compares their files.
pub(crate) fn compare(
    compared: &mut Compared,
    program: &Program,
    scene: &Scene,
) -> Result<(), String> {
    let everything = scene.everything();
    let is_single = scene.actuators.len() == 1;
    let moving = text_of(&with_motion(scene))?;
    // With several actuators a motion says which of them moves.
    let free = if is_single {
        &text_of(&everything)?
    } else {
        &moving
    };
    compare_command(compared, program, (scene, "kinematics"), free)?;
    for command in ["kinetostatics", "statics"] {
        compare_command(compared, program, (scene, command), &moving)?;
    }
    compare_contents(compared, program, &scene.with_table(everything.clone()))?;
    compare_units(compared, program, scene, &moving)?;
    if is_single {
        compared.merge("written-warnings", warning_differences(program, scene)?);
        compare_reduced(compared, program, (scene, &everything))?;
    }
    Ok(())
}

/// The scene without requests, with a sinusoid of every actuator from its assembly on if it has no motion that forces of inertia follow from.
fn with_motion(scene: &Scene) -> toml::Table {
    let mut table = scene.everything();
    if has_motion(&table) {
        return table;
    }
    let mut prescribed = vec![("duration", PERIOD.into())];
    let size = scene.size();
    for (k, actuator) in scene.actuators.iter().enumerate() {
        let part = AMPLITUDES[k % AMPLITUDES.len()];
        let amplitude = if actuator.is_angle { part } else { part * size };
        let sinusoid = [
            ("amplitude", (amplitude / actuator.unit).into()),
            ("period", PERIOD.into()),
        ];
        let law = value_of([("sinusoid", value_of(sinusoid))]);
        prescribed.push((&actuator.name, law));
    }
    table.insert("prescribed".to_owned(), value_of(prescribed));
    table
}

/// The start of an actuator, in the unit of the scene.
pub(super) fn start_of(scene: &Scene, actuator: &str) -> f64 {
    let assembly = scene.table.get("assembly");
    number(assembly.and_then(|assembly| assembly.get(actuator))).unwrap_or(0.0)
}

/// The sentences of a command, and the extrema of the same motion in fewer rows.
fn compare_command(
    compared: &mut Compared,
    program: &Program,
    (scene, command): (&Scene, &str),
    text: &str,
) -> Result<(), String> {
    let run = program.run(command, text, &[command, "--points", POINTS])?;
    compared.merge("written-sentences", printed_extrema(&run, command)?);
    if command == "kinematics" {
        compared.merge("written-movement-sentences", movement(&run, scene)?);
    }
    // Where smoothed friction reverses, forces may have peaks that are narrower than what is looked at between rows.
    if !scene.has("friction") || command == "kinematics" {
        let other = program.run("other-rows", text, &[command, "--points", OTHER_POINTS])?;
        let end = format!("-{command}.json");
        let same = same_extrema([&run.json(&end)?, &other.json(&end)?], command);
        compared.merge("written-extrema-again", same);
    }
    Ok(())
}
