//! All checks of a case's files about positions, as findings.

use super::closure::closure;
use super::difference::{Differences, Texts};
use super::equilibrium::equilibrium;
use super::program::Program;
use super::rates::rates;
use super::reading::Reading;
use super::reduced::{ReducedFiles, reduced};
use super::rows::Rows;
use super::scene_text::{Draws, requests_everything, text_of};
use dwell_findings::{Check, Finding};
use std::path::Path;

/// Differences by the check that they belong to.
#[derive(Debug, Default)]
struct Judged {
    closure: Differences,
    laws: Differences,
    rates: Differences,
    equilibrium: Differences,
    loads: Differences,
    totals: Differences,
    reduced_sums: Differences,
    reduced_bodies: Differences,
    reduced_slopes: Differences,
    reduced_runs: Differences,
}

const RULE: &str = "rounding of the written numbers, measured over all cases";

/// Runs the program at `path` on a case and judges the files. A run that fails is a failed finding.
pub(crate) fn findings(path: &Path, name: &str, scene: &str) -> Vec<Finding> {
    let mut judged = Judged::default();
    if let Err(reason) = judge(&mut judged, path, name, scene) {
        judged.closure.fail(reason);
    }
    judged.findings()
}

fn judge(judged: &mut Judged, path: &Path, name: &str, scene: &str) -> Result<(), String> {
    let program = Program::new(path, name).map_err(|e| format!("no folder for the files: {e}"))?;
    let reading = Reading::new(scene)?;
    let mut draws = Draws::of(scene);
    let everything = text_of(&requests_everything(scene)?)?;
    judge_kinematics(judged, &program, &reading, &everything)?;
    judge_forces(judged, &program, &reading, &everything, &mut draws)?;
    if reading.actuator_count == 1 {
        judge_reduced(judged, &program, &reading, [scene, &everything], &mut draws)?;
    }
    Ok(())
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
    let of = closure(reading, &rows, "kinematics");
    judged.closure.merge(of.joints);
    judged.laws.merge(of.laws);
    if let Some(time) = rows.columns.get("t") {
        judged
            .rates
            .merge(rates(&rows, time, &corners(reading), "kinematics"));
    }
    Ok(())
}

/// Where laws of the prescribed motion have corners, s.
fn corners(reading: &Reading) -> Vec<f64> {
    reading
        .laws
        .iter()
        .flatten()
        .flat_map(super::law::Law::corners)
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
        judged.closure.merge(of.joints);
        let forces = equilibrium(reading, &rows, command, command == "statics");
        judged.equilibrium.merge(forces.bodies);
        judged.loads.merge(forces.loads);
        judged.totals.merge(forces.totals);
    }
    Ok(())
}

fn judge_reduced(
    judged: &mut Judged,
    program: &Program,
    reading: &Reading,
    [scene, everything]: [&str; 2],
    draws: &mut Draws,
) -> Result<(), String> {
    let points = (181 + draws.below(180)).to_string();
    let run = |name: &str, scene: &str, command: &str| {
        program
            .run(name, scene, &[command, "--points", &points])
            .map_err(|e| e.to_string())
    };
    let all = run("reduce", everything, "reduce")?.csv("-reduced.csv")?;
    let requested = run("requested", scene, "reduce")?.npz("-reduced.npz")?;
    let runs = run("runs", everything, "runs")?;
    let (run_i, run_ii) = (runs.npz("-run-i.npz")?, runs.csv("-run-ii.csv")?);
    let files = ReducedFiles {
        reduced: &all,
        run_i: &run_i,
        run_ii: &run_ii,
    };
    let coordinate = &reading.coordinates[0].name;
    let of = reduced(reading, &files, coordinate);
    judged.reduced_sums.merge(of.sums);
    judged.reduced_bodies.merge(of.bodies);
    judged.reduced_slopes.merge(of.slopes);
    judged.reduced_runs.merge(of.runs);
    judged.reduced_runs.merge(same_columns(
        &requested,
        &all,
        "the requested file of `reduce`",
    ));
    for (rows, file) in [(&run_i, "run i"), (&run_ii, "run ii")] {
        judged.closure.merge(closure(reading, rows, file).joints);
    }
    Ok(())
}

/// The columns of a file against those of another that has them, too.
fn same_columns(rows: &Rows, other: &Rows, file: &str) -> Differences {
    let mut all = Differences::default();
    for (name, values) in rows
        .columns
        .iter()
        .filter(|(name, _)| *name != "relative_error")
    {
        let Some(others) = other
            .columns
            .get(name)
            .filter(|others| others.len() == values.len())
        else {
            all.fail(format!(
                "{file} has a column {name} of {} rows that the whole one does not have",
                values.len()
            ));
            continue;
        };
        let scale = others.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
        for (row, (value, expected)) in values.iter().zip(others).enumerate() {
            all.add(value - expected, scale, "", || {
                format!("{file}, row {row}, {name}")
            });
        }
    }
    all
}

impl Judged {
    fn findings(self) -> Vec<Finding> {
        let specs = [
            (
                self.closure,
                "written-closure",
                Check::WrittenPositions,
                "joints, points and coordinates of every row with the scene's text: values, velocities, accelerations",
                1e-11,
            ),
            (
                self.laws,
                "written-laws",
                Check::WrittenLaws,
                "actuators of every row with the laws of the scene's text and their derivatives",
                1e-11,
            ),
            (
                self.rates,
                "written-rates",
                Check::WrittenRates,
                "changes between rows with the integrals of their rates",
                1e-9,
            ),
            (
                self.equilibrium,
                "written-equilibrium",
                Check::WrittenForces,
                "Newton's and Euler's equations of every body with the written forces",
                1e-11,
            ),
            (
                self.loads,
                "written-loads",
                Check::WrittenLaws,
                "forces of loads with expressions and tables of the scene's text",
                1e-11,
            ),
            (
                self.totals,
                "written-totals",
                Check::WrittenTotals,
                "shaking forces, powers and energies with sums over all bodies",
                1e-11,
            ),
            (
                self.reduced_sums,
                "written-reduced",
                Check::WrittenTotals,
                "m, ½m′ and w of `reduce` with sums over all bodies",
                1e-11,
            ),
            (
                self.reduced_bodies,
                "written-coefficients",
                Check::WrittenForces,
                "a, b and c of `reduce` in the equations of every body",
                1e-11,
            ),
            (
                self.reduced_slopes,
                "written-slopes",
                Check::WrittenRates,
                "m and V of `reduce` with the integrals of ½m′ and w between rows",
                1e-9,
            ),
            (
                self.reduced_runs,
                "written-runs",
                Check::WrittenTwice,
                "m, ½m′, a and b of `reduce` with two runs of kinetostatics, and with the columns that are requested",
                1e-11,
            ),
        ];
        let finding =
            |(of, key, check, comparison, tolerance): (Differences, &str, Check, &str, f64)| {
                let texts = Texts {
                    key,
                    check,
                    comparison,
                    scale: "the largest of its kind in the file",
                    tolerance,
                    tolerance_reason: RULE,
                };
                of.finding(texts, "all rows of the files")
            };
        specs.into_iter().filter_map(finding).collect()
    }
}
