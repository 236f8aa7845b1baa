//! All checks of a case's files about positions, as findings.

use super::closure::closure;
use super::compared::Compared;
use super::contents_files::contents_differences;
use super::difference::Differences;
use super::dwell::dwell_differences;
use super::equilibrium::equilibrium;
use super::extrema_again::same_extrema;
use super::formats::formats;
use super::headings::heading_differences;
use super::joint_forces::joint_force_differences;
use super::law::{Law, number};
use super::movement::movement;
use super::program::{Program, Run};
use super::quotients::quotient_differences;
use super::rates::rates;
use super::reading::{Joint, JointKind, Reading};
use super::reduced_files::compare_reduced;
use super::scene_text::{Draws, has_motion, requests_everything, table_of, text_of, value_of};
use super::section_files::compare_sections;
use super::unit_files::compare_units;

/// The pressure angle of teeth where the scene gives none, rad: 20°.
const PRESSURE_ANGLE: f64 = 0.349_065_850_398_865_9;
/// Rows of a motion whose extrema are looked for once more.
const OTHER_POINTS: &str = "26";
/// How far a case without a motion is swept, rad or m.
const SWEEP: f64 = 0.4;

/// Runs the commands about positions on a case and compares their files.
pub(crate) fn compare(
    compared: &mut Compared,
    program: &Program,
    scene: &str,
) -> Result<(), String> {
    let reading = &Reading::new(scene)?;
    let case = &mut Case {
        program,
        reading,
        draws: Draws::of(scene),
        compared,
    };
    let everything = text_of(&requests_everything(scene)?)?;
    let moving = with_motion(&everything, reading, &mut case.draws)?;
    // With several actuators a motion says which of them moves.
    let is_single = reading.actuator_count == 1;
    compare_kinematics(case, if is_single { &everything } else { &moving })?;
    case.merge("written-dwell", dwell_differences(program, scene)?);
    let [contents, sentences, warnings] = contents_differences(program, reading, &everything)?;
    case.merge("written-contents", contents);
    case.merge("written-contents-sentences", sentences);
    case.merge("written-warnings", warnings);
    compare_forces(case, &moving)?;
    compare_units(case, &moving)?;
    if is_single {
        compare_reduced(case, [scene, &everything])?;
    }
    Ok(())
}

/// A case whose files about positions are compared.
pub(super) struct Case<'a> {
    pub(super) program: &'a Program,
    pub(super) reading: &'a Reading,
    pub(super) draws: Draws,
    pub(super) compared: &'a mut Compared,
}

impl Case<'_> {
    /// Runs a command on a scene under a name.
    pub(super) fn run(&self, name: &str, scene: &str, arguments: &[&str]) -> Result<Run, String> {
        self.program.run(name, scene, arguments)
    }

    /// Adds differences to those of a key.
    pub(super) fn merge(&mut self, key: &'static str, differences: Differences) {
        self.compared.merge(key, differences);
    }
}

/// The scene with a sweep from its assembly on, if it has no motion that forces of inertia follow from.
fn with_motion(scene: &str, reading: &Reading, draws: &mut Draws) -> Result<String, String> {
    let mut table = table_of(scene)?;
    if has_motion(&table) || reading.actuator_count == 0 {
        return Ok(scene.to_owned());
    }
    let coordinate = &reading.coordinates[0];
    let unit = reading.unit_of(coordinate.measure);
    let assembly = table.get("assembly").and_then(|a| a.get(&coordinate.name));
    let start = number(assembly).unwrap_or(0.0);
    let ends = vec![start, start + SWEEP / unit].into();
    let speed = (1.0 + 3.0 * draws.share()) / unit;
    let sweep = value_of([(coordinate.name.as_str(), ends), ("speed", speed.into())]);
    table.insert("coordinate-sweep".to_owned(), sweep);
    text_of(&table)
}

fn compare_kinematics(case: &mut Case<'_>, scene: &str) -> Result<(), String> {
    let (reading, command) = (case.reading, "kinematics");
    let run = case.run(command, scene, &[command])?;
    let rows = run.csv("-kinematics.csv")?;
    add_formats(case.compared, &run, reading, command)?;
    let of_movement = movement(&run, reading, &rows)?;
    case.merge("written-movement", of_movement.numbers);
    case.merge("written-movement-sentences", of_movement.sentences);
    add_other_rows(case, &run, (scene, command))?;
    let of = closure(reading, &rows, command);
    case.merge("written-closure", of.joints);
    case.merge("written-laws", of.laws);
    let quotients = quotient_differences(reading, &rows, command);
    case.merge("written-quotients", quotients);
    case.merge("written-rates", rates(reading, &rows, command));
    Ok(())
}

/// Where laws of the prescribed motion have corners, s.
pub(crate) fn corners(reading: &Reading) -> Vec<f64> {
    let laws = reading.laws.iter().flatten();
    laws.flat_map(Law::corners).collect()
}

fn compare_forces(case: &mut Case<'_>, scene: &str) -> Result<(), String> {
    let reading = case.reading;
    let has_motion = has_motion(&table_of(scene)?);
    for command in ["kinetostatics", "statics"] {
        // Without a motion there are no speeds that forces of inertia follow from.
        if !has_motion && (command == "kinetostatics" || reading.actuator_count > 1) {
            continue;
        }
        let points = (61 + case.draws.below(60)).to_string();
        let run = case.run(command, scene, &[command, "--points", &points])?;
        let rows = run.npz(&format!("-{command}.npz"))?;
        let of = closure(reading, &rows, command);
        case.merge("written-closure", of.joints);
        let forces = equilibrium(reading, &rows, command, command == "statics");
        case.merge("written-equilibrium", forces.bodies);
        case.merge("written-loads", forces.loads);
        case.merge("written-totals", forces.totals);
        let pins = joint_force_differences(reading, &rows, command);
        case.merge("written-joint-forces", pins);
        add_formats(case.compared, &run, reading, command)?;
        add_other_rows(case, &run, (scene, command))?;
    }
    if has_motion {
        compare_sections(case, scene)?;
    }
    if let Some(scene) = with_pressure_angles(scene, reading).filter(|_| has_motion) {
        compare_teeth(case, &scene?)?;
    }
    Ok(())
}

/// The scene with a pressure angle of every pair of teeth; none where it has no teeth, or those have theirs.
fn with_pressure_angles(scene: &str, reading: &Reading) -> Option<Result<String, String>> {
    let has_teeth =
        |joint: &Joint| matches!(joint.kind, JointKind::Gear { .. } | JointKind::Rack { .. });
    let joints = reading.joints.iter();
    let teeth: Vec<&str> = joints
        .filter(|joint| has_teeth(joint) && joint.pressure_angle == 0.0)
        .map(|joint| joint.name.as_str())
        .collect();
    let mut table: toml::Table = scene.parse().ok()?;
    let joints = table.get_mut("joints")?.as_table_mut()?;
    let angle = toml::Value::Float(PRESSURE_ANGLE / reading.units.angle);
    for name in &teeth {
        let joint = joints.get_mut(*name)?.as_table_mut()?;
        joint.insert("pressure-angle".to_owned(), angle.clone());
    }
    (!teeth.is_empty()).then(|| text_of(&table))
}

/// Forces of the scene whose teeth have pressure angles.
fn compare_teeth(case: &mut Case<'_>, scene: &str) -> Result<(), String> {
    let run = case.run("teeth", scene, &["kinetostatics", "--points", "37"])?;
    let reading = Reading::new(scene)?;
    let rows = run.npz("-kinetostatics.npz")?;
    let forces = equilibrium(&reading, &rows, "teeth", false);
    case.merge("written-equilibrium", forces.bodies);
    case.merge("written-loads", forces.loads);
    case.merge("written-totals", forces.totals);
    case.merge(
        "written-joint-forces",
        joint_force_differences(&reading, &rows, "teeth"),
    );
    add_formats(case.compared, &run, &reading, "kinetostatics")?;
    let [_, sentences, _] = contents_differences(case.program, &reading, scene)?;
    case.merge("written-contents-sentences", sentences);
    Ok(())
}

/// The extrema of the same motion in fewer rows.
fn add_other_rows(
    case: &mut Case<'_>,
    run: &Run,
    (scene, command): (&str, &str),
) -> Result<(), String> {
    // Where smoothed friction reverses, forces may have peaks that are narrower than what is looked at between rows.
    if !case.reading.frictions.is_empty() {
        return Ok(());
    }
    let other = case.run("other-rows", scene, &[command, "--points", OTHER_POINTS]);
    let end = format!("-{command}.json");
    let other = other?.json(&end)?;
    let same = same_extrema([&run.json(&end)?, &other], command);
    case.merge("written-extrema-again", same);
    Ok(())
}

/// The files and sentences of a run against each other.
fn add_formats(
    compared: &mut Compared,
    run: &Run,
    reading: &Reading,
    command: &str,
) -> Result<(), String> {
    let of = formats(run, command, command, &corners(reading))?;
    compared.merge("written-files", of.files);
    compared.merge("written-extrema", of.extrema);
    compared.merge("written-places", of.places);
    compared.merge("written-sentences", of.printed);
    let file = run.text(&format!("-{command}.csv"))?;
    let headings = heading_differences(&file, reading, command);
    compared.merge("written-headings", headings);
    Ok(())
}
