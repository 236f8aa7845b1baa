//! The findings over operating points of a case.

use super::characteristic::{Complex, error_of_root, size};
use super::modes::{add_modes, eigenvalues, number};
use crate::written::motions::sentences;
use crate::written::poses::compared::Compared;
use crate::written::poses::difference::Differences;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::rows::Rows;
use dwell_findings::Finding;
use serde_json::Value;
use std::f64::consts::TAU;
use std::path::Path;

/// Runs `linearise` about the initial state and `equilibria` on a scene with a motion, and compares what they write. A run
/// that is refused leaves nothing to compare.
pub(crate) fn findings(path: &Path, name: &str, scene: &str) -> Vec<Finding> {
    let mut compared = Compared::default();
    let has_motion = scene
        .parse::<toml::Table>()
        .is_ok_and(|s| s.contains_key("motion"));
    let program = Program::new(path, &format!("{name}-points"));
    if let (true, Ok(program)) = (has_motion, program) {
        let linear = program.run("linear", scene, &["linearise", "--about", "initial"]);
        let rest = program.run("rest", scene, &["equilibria"]);
        for reason in [
            linear
                .ok()
                .and_then(|run| linearised(&mut compared, &run).err()),
            rest.ok()
                .and_then(|run| equilibria(&mut compared, &run).err()),
        ]
        .into_iter()
        .flatten()
        {
            compared.fail("written-modes", reason);
        }
    }
    compared.findings()
}

fn linearised(compared: &mut Compared, run: &Run) -> Result<(), String> {
    let summary = run.json("-linearise.json")?;
    let matrix =
        state_matrix(&run.text("-linear.csv")?).ok_or("the file has no square matrix A")?;
    let found = eigenvalues(&summary, "initial");
    if found.len() != matrix.len() {
        let (count, states) = (found.len(), matrix.len());
        return Err(format!("{count} eigenvalues of {states} states"));
    }
    let largest = found
        .iter()
        .map(|l| size(*l))
        .fold(f64::MIN_POSITIVE, f64::max);
    let mut roots = Differences::default();
    for lambda in &found {
        let error = error_of_root(&matrix, *lambda, largest);
        roots.add(error, largest, "1/s", || {
            format!("eigenvalue {}", text(*lambda))
        });
    }
    let trace: f64 = (0..matrix.len()).map(|k| matrix[k][k]).sum();
    let sum: f64 = found.iter().map(|l| l[0]).sum();
    roots.add(trace - sum, largest, "1/s", || "the trace of A".to_owned());
    compared.merge("written-eigenvalues", roots);
    add_modes(compared.of("written-modes"), &summary, "initial");
    compared.merge("written-point-sentences", sentences(run, &summary));
    Ok(())
}

fn equilibria(compared: &mut Compared, run: &Run) -> Result<(), String> {
    let summary = run.json("-equilibria.json")?;
    let count = number(&summary, "equilibria").unwrap_or(0.0);
    compared.merge("written-point-sentences", sentences(run, &summary));
    if count == 0.0 {
        return Ok(());
    }
    let rows = run.csv("-equilibria.csv")?;
    compared
        .of("written-point-files")
        .add(rows.count as f64 - count, 1.0, "", || {
            "number of equilibria".to_owned()
        });
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
    let known: Vec<f64> = eigenvalues(summary, &name).into_iter().map(size).collect();
    let largest = known.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    for mode in 1.. {
        let of = |what: &str| rows.get(row, &format!("mode{mode}.{what}"));
        let Some(angular) = of("angular_frequency") else {
            break;
        };
        // A mode that does not oscillate has no number.
        if angular.is_nan() {
            continue;
        }
        let hertz = of("frequency").unwrap_or(f64::NAN);
        compared
            .of("written-modes")
            .add(TAU * hertz - angular, largest, "1/s", || {
                place(&format!("mode {mode}"))
            });
        for value in [angular, TAU * hertz] {
            let nearest = known
                .iter()
                .map(|k| (k - value).abs())
                .fold(f64::INFINITY, f64::min);
            compared
                .of("written-point-files")
                .add(nearest, largest, "1/s", || {
                    place(&format!("mode {mode} in table and summary"))
                });
        }
    }
    for (column, values) in &rows.columns {
        if let Some(stated) = number(summary, &format!("{name}.{column}")) {
            let value = values[row];
            compared.of("written-point-files").add(
                value - stated,
                stated.abs().max(1.0),
                "",
                || place(column),
            );
        }
    }
}

/// A of the file of matrices: its rows begin with `A`, and end with as many numbers as there are rows.
fn state_matrix(file: &str) -> Option<Vec<Vec<f64>>> {
    let rows: Vec<&str> = file.lines().filter(|line| line.starts_with("A,")).collect();
    let row = |line: &&str| -> Option<Vec<f64>> {
        let fields: Vec<&str> = line.split(',').collect();
        let numbers = fields.get(fields.len().checked_sub(rows.len())?..)?;
        numbers
            .iter()
            .map(|field| field.trim().parse().ok())
            .collect()
    };
    let matrix: Vec<Vec<f64>> = rows.iter().map(row).collect::<Option<_>>()?;
    (!matrix.is_empty()).then_some(matrix)
}

fn text([re, im]: Complex) -> String {
    format!("{re:.6e} {im:+.6e} i")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrix_is_read_without_its_names() {
        let file = "matrix,row,phi [rad],phi.velocity [rad/s]\nA,d(phi)/dt [rad/s],0.0,1.0\nA,\"x, y\",-4,0\nmatrix,row,u [V]\nB,x,2\n";
        assert_eq!(
            state_matrix(file),
            Some(vec![vec![0.0, 1.0], vec![-4.0, 0.0]])
        );
    }
}
