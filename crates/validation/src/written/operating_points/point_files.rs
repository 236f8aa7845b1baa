//! The findings over operating points of a case.

use super::characteristic::{Complex, error_of_root, largest_size, size};
use super::equilibrium_files;
use super::linear_file::LinearFile;
use super::modes::{add_modes, eigenvalues};
use super::rest::Rest;
use super::slopes::Slopes;
use super::starts::Start;
use crate::written::motions::{MotionReading, sentences};
use crate::written::poses::compared::Compared;
use crate::written::poses::difference::Differences;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::rows::Rows;
use crate::written::poses::scene_text::{requests_everything, table_of, text_of};
use crate::written::poses::stated::result;
use serde_json::Value;
use std::f64::consts::TAU;

/// Runs `linearise` about the initial state and `equilibria` on a scene with a motion, and compares what they write. A run
/// that is refused leaves nothing to compare.
pub(crate) fn compare(
    compared: &mut Compared,
    program: &Program,
    scene: &str,
) -> Result<(), String> {
    if !table_of(scene)?.contains_key("motion") {
        return Ok(());
    }
    let linear = program.run("linear", scene, &["linearise", "--about", "initial"]);
    let rest = program.run("rest", scene, &["equilibria"]);
    let of_linear = linear.as_ref().map(|run| linearised(compared, run));
    let of_rest = rest.as_ref().map(|run| equilibria(compared, run));
    for compared_files in [of_linear, of_rest] {
        if let Ok(Err(reason)) = compared_files {
            compared.fail("written-modes", reason);
        }
    }
    let about = program.run("about", scene, &["linearise"]);
    for (run, words) in [(&linear, "the initial state"), (&about, "its equilibrium")] {
        if let Ok(run) = run {
            let first = run.printed.lines().next().unwrap_or("");
            let is_said = first.ends_with(&format!(": linearised about {words}"));
            let found = compared.of("written-rest-words");
            found.require(is_said, || {
                format!("`linearise` about {words} prints `{first}`")
            });
        }
    }
    let rest = rest.as_ref().ok().zip(Some(about.as_ref().ok()));
    other_starts(compared, program, scene, rest)
}

/// A, B, C and D with differences, what is written of equilibria, and the motion from them; nothing of a motion that cannot be linearised.
fn other_starts(
    compared: &mut Compared,
    program: &Program,
    scene: &str,
    rest: Option<(&Run, Option<&Run>)>,
) -> Result<(), String> {
    let everything = requests_everything(scene)?;
    let text = text_of(&everything)?;
    let motion = MotionReading::new(&text)?;
    let Ok(run) = program.run("all", &text, &["linearise", "--about", "initial"]) else {
        return Ok(());
    };
    let linear = LinearFile::read(&run.text("-linear.csv")?);
    let linear = linear.ok_or("the file has no matrices")?;
    let archive = run.npz("-linear.npz")?;
    let is_coordinate = |name: &&String| motion.reading.coordinate(name).is_some();
    let names = linear.columns.iter().filter(is_coordinate).cloned();
    let state = archive.columns.get("state");
    let state = state.ok_or("the archive has no state")?;
    let start = Start::new(everything, &motion, &names.collect::<Vec<_>>(), state);
    let start = start.ok_or("the start cannot be read")?;
    let slopes = Slopes {
        program,
        start: &start,
        linear: &linear,
    };
    slopes.compare(compared, &archive)?;
    let Some((rest, about)) = rest else {
        return Ok(());
    };
    equilibrium_files::compare(compared, program, &start, (rest, about))?;
    if result(&rest.json("-equilibria.json")?, "equilibria") == Some(0.0) {
        return Ok(());
    }
    let found = Rest {
        program,
        start: &start,
        rows: &rest.csv("-equilibria.csv")?,
        summary: &rest.json("-equilibria.json")?,
    };
    found.compare(compared)
}

fn linearised(compared: &mut Compared, run: &Run) -> Result<(), String> {
    let summary = run.json("-linearise.json")?;
    let file = LinearFile::read(&run.text("-linear.csv")?);
    let matrix = file.and_then(|file| file.state_matrix());
    let matrix = matrix.ok_or("the file has no square matrix A")?;
    let found = eigenvalues(&summary, "initial");
    if found.len() != matrix.len() {
        let (count, states) = (found.len(), matrix.len());
        return Err(format!("{count} eigenvalues of {states} states"));
    }
    let largest = largest_size(&found);
    let mut roots = Differences::default();
    for lambda in &found {
        let error = error_of_root(&matrix, *lambda, largest);
        roots.add(error, largest, "1/s", || {
            format!("eigenvalue {}", text(*lambda))
        });
    }
    let trace: f64 = (0..matrix.len()).map(|k| matrix[k][k]).sum();
    let sum: f64 = found.iter().map(|l| l[0]).sum();
    roots.add(trace - sum, largest, "1/s", || "the trace of A");
    compared.merge("written-eigenvalues", roots);
    add_modes(compared.of("written-modes"), &summary, "initial");
    compared.merge("written-point-sentences", sentences(run, &summary));
    Ok(())
}

fn equilibria(compared: &mut Compared, run: &Run) -> Result<(), String> {
    let summary = run.json("-equilibria.json")?;
    let count = result(&summary, "equilibria").unwrap_or(0.0);
    compared.merge("written-point-sentences", sentences(run, &summary));
    if count == 0.0 {
        return Ok(());
    }
    let rows = run.csv("-equilibria.csv")?;
    compared.add(
        "written-point-files",
        rows.count as f64 - count,
        1.0,
        "",
        || "number of equilibria",
    );
    for row in 0..rows.count {
        let name = format!("equilibrium.{}", row + 1);
        add_modes(compared.of("written-modes"), &summary, &name);
        add_row(compared, &summary, &rows, row);
    }
    Ok(())
}

/// A row of the table of equilibria: its modes by themselves, and all of it with the summary.
fn add_row(compared: &mut Compared, summary: &Value, rows: &Rows, row: usize) {
    let place = |what: &str| format!("equilibrium {}, {what}", row + 1);
    let name = format!("equilibrium.{}", row + 1);
    let values = eigenvalues(summary, &name);
    let largest = largest_size(&values);
    let mut modes = 0;
    for mode in 1.. {
        let of = |what: &str| rows.get(row, &format!("mode{mode}.{what}"));
        let Some(angular) = of("angular_frequency") else {
            break;
        };
        // A mode that does not oscillate has no number.
        if angular.is_nan() {
            continue;
        }
        modes += 1;
        let hertz = of("frequency").unwrap_or(f64::NAN);
        compared.add(
            "written-modes",
            TAU * hertz - angular,
            largest,
            "1/s",
            || place(&format!("mode {mode}")),
        );
        for value in [angular, TAU * hertz] {
            let away = values.iter().map(|known| (size(*known) - value).abs());
            let nearest = away.fold(f64::INFINITY, f64::min);
            compared.add("written-point-files", nearest, largest, "1/s", || {
                place(&format!("mode {mode} in table and summary"))
            });
        }
    }
    let error = result(summary, &format!("{name}.error.eigenvalues")).unwrap_or(0.0);
    // One of each pair whose imaginary parts are clear of their errors.
    let pairs = values.iter().filter(|[_, im]| *im > 2.0 * error).count();
    let is_clear = |[_, im]: &Complex| *im == 0.0 || im.abs() > 2.0 * error;
    if values.iter().all(is_clear) {
        let modes = f64::from(modes) - pairs as f64;
        compared.add("written-modes", modes, 1.0, "", || {
            place("the number of modes")
        });
    }
    for (column, values) in &rows.columns {
        if let Some(stated) = result(summary, &format!("{name}.{column}")) {
            let value = values[row];
            compared.add(
                "written-point-files",
                value - stated,
                stated.abs().max(1.0),
                "",
                || place(column),
            );
        }
    }
}

fn text([re, im]: Complex) -> String {
    format!("{re:.6e} {im:+.6e} i")
}
