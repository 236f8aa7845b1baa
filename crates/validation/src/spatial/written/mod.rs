//! What the commands write of a case in space: the program runs as a process, and its files and sentences are read back.
//!
//! ```text
//! scene text ── scenes (adds a motion where there is none) ── program ── files
//!      files ── states (rows as states) ── the dense equations in body coordinates ──┐
//!      files ── sums (power, shaking force, energies), between_rows (time) ──────────┤
//!      files ── reduced_file (m, ½m′, a, b, c, w), contents (sentences of `check`) ──┴── findings
//! ```
//!
//! Placements, motions, reactions and actions come from the columns; of the model only what no column says is taken: magnitudes of loads,
//! and the components of reactions that redundant constraints leave open.

mod between_rows;
mod contents;
mod reduced_file;
mod scenes;
mod states;
mod sums;

use super::claims::SpaceClaims;
use crate::error::ValidationError;
use crate::written::poses::difference::Differences;
use crate::written::poses::extrema_again::same_extrema;
use crate::written::poses::formats::{Formats, formats};
use crate::written::poses::program::{Program, Run};
use crate::written::poses::rows::Rows;
use dwell_findings::{Check, Finding};
use dwell_scene::SpaceScene;
use dwell_verify::FindingSpec;
use scenes::Scenes;
use std::path::Path;

/// The accuracy of one of the motions; with end stops a coarse one, whose steps are long enough to pass a stop.
const ACCURACY: &str = "1e-8";
const ACCURACY_WITH_STOPS: &str = "1e-6";

/// Intervals between the rows of another run.
const OTHER_ROWS: f64 = 88.3;
/// The largest rounding error that a case may state of positions and forces, of the largest of a unit; 1e-13 is seen.
const MAX_ROUNDING: f64 = 1e-11;
const EXTREMA_AGAIN: FindingSpec<'_> = FindingSpec {
    key: "written-motion-extrema-again",
    check: Check::WrittenTwice,
    comparison: "extrema of `simulate` with those of the same motion by dop853 in other rows",
    scale: "the largest extremum of the unit",
    // The largest seen in a case is 8.6e-6, of a motion that strikes stops.
    tolerance: 1e-4,
    tolerance_reason: "the errors of both motions",
};

/// The findings of what the program at a path writes of a scene.
pub(super) fn written_findings(
    scene: &SpaceScene,
    program: &Path,
) -> Result<Vec<Finding>, ValidationError> {
    let claims = SpaceClaims::new(scene)?;
    let scenes = Scenes::new(scene, &claims);
    let runs = Program::new(program, &format!("{}-in-space", scene.name));
    let given = (&claims, scene);
    let judged = || {
        let mut found = forced(&runs, given, &scenes)?;
        found.extend(free(&runs, given, &scenes)?);
        found.extend(without_forces(&runs, scene, &scenes)?);
        found.extend(contents::findings(&runs, given)?);
        Ok(found)
    };
    let mut found = judged().unwrap_or_else(|reason: String| vec![refused(&reason)]);
    if scene.mechanism.actuators.len() == 1 {
        found.extend(reduced_file::findings(scene, (program, &scenes.plain))?);
    }
    Ok(found)
}

/// The findings of a command that could not be read back.
fn refused(reason: &str) -> Finding {
    Finding {
        worst_at: reason.to_owned(),
        pass: false,
        ..Finding::new("written-files", Check::WrittenTwice, [f64::NAN; 2], 0.0)
    }
}

/// `kinetostatics` along a prescribed motion.
fn forced(
    program: &Program,
    (claims, scene): (&SpaceClaims<'_>, &SpaceScene),
    scenes: &Scenes,
) -> Result<Vec<Finding>, String> {
    let arguments = ["kinetostatics", "--points", "25"];
    let run = program.run(&scene.name, &scenes.forced, &arguments)?;
    let rows = run.csv("-kinetostatics.csv")?;
    let mut found = states::findings(claims, scene, &rows, states::Kind::Forced)?;
    found.extend(sums::findings(claims, scene, &rows, "kinetostatics"));
    found.extend(between_rows::laws(scenes, scene, &rows));
    found.extend(twice(&run, "kinetostatics", "kinetostatics")?);
    Ok(found)
}

/// `kinematics` along a prescribed motion, and `statics` of one coordinate.
fn without_forces(
    program: &Program,
    scene: &SpaceScene,
    scenes: &Scenes,
) -> Result<Vec<Finding>, String> {
    let name = format!("{}-forced", scene.name);
    let arguments = ["kinematics", "--points", "25"];
    let moved = program.run(&name, &scenes.forced, &arguments)?;
    let mut found = twice(&moved, "kinematics", "kinematics")?;
    if scene.mechanism.actuators.len() == 1 {
        let name = format!("{}-at-rest", scene.name);
        let arguments = ["statics", "--points", "121"];
        let held = program.run(&name, &scenes.plain, &arguments)?;
        found.extend(twice(&held, "statics", "statics")?);
    }
    Ok(found)
}

/// `simulate`, where the scene has a motion or one coordinate: by its default method, and to an accuracy.
fn free(
    program: &Program,
    (claims, scene): (&SpaceClaims<'_>, &SpaceScene),
    scenes: &Scenes,
) -> Result<Vec<Finding>, String> {
    let Some((text, interval)) = &scenes.free else {
        return Ok(Vec::new());
    };
    let arguments = ["simulate", "--sample-interval", interval];
    let first = program.run(&scene.name, text, &arguments)?;
    let rows = first.csv("-motion.csv")?;
    let mut found = Vec::new();
    // An end stop acts beside the loads.
    if scene.stops.is_empty() {
        found.extend(states::findings(claims, scene, &rows, states::Kind::Free)?);
        found.extend(sums::findings(claims, scene, &rows, "motion"));
        found.extend(between_rows::motion(scene, &rows));
    }
    found.extend(twice(&first, "motion", "simulate")?);
    let summary = first.json("-simulate.json")?;
    let events = first.csv("-motion-events.csv").ok();
    found.extend(between_rows::summary(&summary, &rows, events.as_ref()));
    let name = format!("{}-default-rows", scene.name);
    let all = program
        .run(&name, text, &["simulate"])?
        .csv("-motion.csv")?;
    found.extend(between_rows::default_rows(&all, &rows));
    let accuracy = match scene.stops.is_empty() {
        true => ACCURACY,
        false => ACCURACY_WITH_STOPS,
    };
    let arguments = [&arguments[..], &["--accuracy", accuracy]].concat();
    let name = format!("{}-to-accuracy", scene.name);
    let other = program.run(&name, text, &arguments)?;
    let others = other.csv("-motion.csv")?;
    if scene.stops.is_empty() {
        found.extend(between_rows::again(scene, [&rows, &others]));
    }
    found.extend(between_rows::stops(scene, [&rows, &others]));
    let duration = rows.end();
    let interval = format!("{:e}", duration / OTHER_ROWS);
    let arguments = ["simulate", "--method", "dop853", "--rtol", "1e-9"];
    let arguments = [&arguments[..], &["--sample-interval", &interval]].concat();
    let name = format!("{}-other-rows", scene.name);
    let again = program
        .run(&name, text, &arguments)?
        .json("-simulate.json")?;
    let same = same_extrema([&summary, &again], "simulate and simulate by dop853");
    found.extend(same.counted_finding(&EXTREMA_AGAIN, "simulate"));
    Ok(found)
}

/// The same numbers in the files and sentences of a run.
fn twice(run: &Run, stem: &str, command: &str) -> Result<Vec<Finding>, String> {
    let Formats {
        files,
        extrema,
        places,
        mut printed,
    } = formats(run, stem, command, &[])?;
    if command != "simulate" {
        printed.merge(rounding(&run.printed));
    }
    let [of_files, of_extrema, of_places] = tolerances(command);
    let of = |differences: Differences, end: &str, check, comparison, tolerance| {
        let texts = FindingSpec {
            key: &format!("written-{stem}-{end}"),
            check,
            comparison,
            scale: "the number, or the largest extremum of its unit",
            tolerance,
            tolerance_reason: "the same numbers; between rows, the error of a polynomial through them",
        };
        differences.counted_finding(&texts, command)
    };
    let all = [
        of(
            files,
            "twice",
            Check::WrittenTwice,
            "CSV with NPZ, and no row beyond an extremum",
            of_files,
        ),
        of(
            extrema,
            "extrema",
            Check::WrittenTwice,
            "extrema of the summary with a polynomial through rows",
            of_extrema,
        ),
        of(
            places,
            "places",
            Check::WrittenTwice,
            "slopes of that polynomial at the places of extrema, over one row",
            of_places,
        ),
        of(
            printed,
            "printed",
            Check::WrittenSentences,
            "printed extrema with the summary, and a rounding error that leaves them known",
            1e-12,
        ),
    ];
    Ok(all.into_iter().flatten().collect())
}

/// The tolerances of files, extrema and their places.
fn tolerances(command: &str) -> [f64; 3] {
    match command {
        // The largest seen in a case are 2.7e-15, 2.7e-15 and 6.1e-6.
        "kinematics" => [2e-13, 2e-13, 5e-4],
        // 8.9e-16, 8.9e-16 and 8.9e-14.
        "statics" => [8e-14, 8e-14, 8e-12],
        // 2.7e-15, 1.7e-6 and 2.7e-5.
        "kinetostatics" => [2e-13, 1e-5, 1e-3],
        // 4.6e-11 N m, of a moment that is zero beside forces of 300 N; the error of a polynomial; 2.7e-4.
        _ => [4e-9, 1e-5, 1e-3],
    }
}

/// The rounding error that a command states of its own values: at most [`MAX_ROUNDING`] of them, so that no extremum is unknown.
fn rounding(printed: &str) -> Differences {
    let mut found = Differences::default();
    let line = printed
        .lines()
        .find_map(|line| line.trim().strip_prefix("estimated rounding error below "));
    let stated = line.and_then(|rest| rest.split(' ').next()?.parse::<f64>().ok());
    // None where nothing was held, and all forces are zero.
    if let Some(stated) = stated {
        found.add((stated - MAX_ROUNDING).max(0.0), 1.0, "", || {
            format!("a stated rounding error of {stated:e}")
        });
    }
    if let Some(line) = printed.lines().find(|line| line.contains("is not known")) {
        found.fail(line.trim().to_owned());
    }
    found
}

/// A finding of a worst difference with its texts.
fn finding(worst: Differences, of: &FindingSpec<'_>, rows: &Rows, file: &str) -> Option<Finding> {
    worst.finding(of, &format!("{file}, {} rows", rows.count))
}
