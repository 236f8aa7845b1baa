//! The table and the picture of the random machines.

use super::check::check;
use super::run::{ACCURACIES, MachineResult, MachineRun};
use crate::drawn::{completed, runs};
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Series, Stroke, Table, TableExport as _};
use dwell_study::output::chart;
use dwell_study::{Outcome, StudyError};
use dwell_validation::extremes::series::MAX_ESTIMATE_RATIO;
use dwell_validation::report_parts::{NumberColumn, StudyReport, figure_blocks, numbers, table};

/// Errors that a chart shows.
const ERROR_RANGE: [f64; 2] = [1e-16, 1e-2];

/// Adds the report of the machines, `NAME.md` with its text, its table and its picture, to an outcome.
///
/// # Errors
/// [`StudyError`] where a table cannot be written.
pub fn add_to(
    outcome: &mut Outcome,
    results: &[MachineResult],
    seed: u64,
    name: &str,
) -> Result<(), StudyError> {
    let figures = [figure(results, seed)];
    let files = &mut outcome.files;
    files.add(format!("{name}/machines.csv"), csv_table(results).csv()?);
    for machine in results {
        let file = format!("{name}/machine-{:03}.toml", machine.number);
        files.add(file, machine.text.clone());
    }
    let header = [
        "Accuracy",
        "Runs",
        "Refused",
        "Largest true error",
        "Largest error / estimate",
        "Estimates above 100 times",
    ];
    let rows = ACCURACIES.map(|accuracy| summary_row(accuracy, results));
    let mut blocks = vec![table(&header, rows)];
    blocks.extend(figure_blocks(name, &figures, false));
    let report = StudyReport {
        name,
        title: "Random machines",
        text: format!(
            "Mechanisms of one and two freedoms, drawn by seed {seed}, under loads that switch with time, coordinates and \
             speeds, with motors and with speed controllers that saturate; `just trials --seed N` draws others. Each is \
             simulated to four accuracies, and compared with a Runge–Kutta method of order 5 with step control of its own at \
             1e-13, restarted by hand at the switches in time; the error of that reference is its difference from 1e-12. The scenes \
             are in the folder of the picture."
        ),
        blocks,
        snapshot: format!("Machines\n\n{} machines of seed {seed}\n", results.len()),
        figures: &figures,
        findings: check(results),
        count: format!("{} machines", results.len()),
    };
    report.add_to(outcome);
    Ok(())
}

/// An accuracy in numbers.
fn summary_row(accuracy: f64, results: &[MachineResult]) -> Vec<String> {
    let runs = runs(results).map(|(_, run)| run);
    let runs: Vec<_> = runs.filter(|run| run.accuracy == accuracy).collect();
    let completed = || runs.iter().filter(|run| run.refused.is_none());
    let ratios: Vec<f64> = completed().filter_map(|run| run.estimate_ratio()).collect();
    let error = completed().map(|run| run.error).fold(0.0, f64::max);
    let below = ratios.iter().map(|ratio| 1.0 / ratio).fold(0.0, f64::max);
    let above = ratios.iter().filter(|ratio| **ratio > MAX_ESTIMATE_RATIO);
    vec![
        format!("{accuracy:.0e}"),
        runs.len().to_string(),
        (runs.len() - completed().count()).to_string(),
        format!("{error:.1e}"),
        format!("{below:.2}"),
        above.count().to_string(),
    ]
}

fn figure(results: &[MachineResult], seed: u64) -> Figure {
    Figure {
        name: "machines".to_owned(),
        title: "Random machines: promised, estimated and true errors".to_owned(),
        caption: format!(
            "{} machines of seed {seed}, each to four required accuracies; one mark for each motion that is not refused. Left: the \
             true error by machine; dashed: the required accuracies, which it must not exceed. Right: the estimated error over \
             the true one, between 1 and {MAX_ESTIMATE_RATIO} wherever the true error is above 1e-13.",
            results.len()
        ),
        columns: 2,
        panels: [errors(results), estimates(results)].map(Into::into).into(),
        ..Figure::default()
    }
}

fn by_accuracy(
    results: &[MachineResult],
    of: impl Fn(&MachineResult, &MachineRun) -> Option<[f64; 2]>,
) -> Vec<Series> {
    let series = ACCURACIES.iter().enumerate().map(|(k, accuracy)| {
        let runs = completed(results).filter(|(_, run)| run.accuracy == *accuracy);
        let points = runs.filter_map(|(m, run)| of(m, run)).collect();
        let series = Series::line(format!("accuracy {accuracy:.0e}"), points);
        series.stroke(Stroke::Points).color(Paint::Palette(k))
    });
    series.collect()
}

fn errors(results: &[MachineResult]) -> Chart {
    let [low, high] = ERROR_RANGE;
    let last = results.len() as f64;
    let mut series = by_accuracy(results, |m, run| {
        (!run.error.is_nan()).then(|| [m.number as f64, run.error.clamp(low, high)])
    });
    for (k, accuracy) in ACCURACIES.iter().enumerate() {
        let line = Series::line("", vec![[-0.5, *accuracy], [last, *accuracy]]);
        series.push(line.stroke(Stroke::Dashed).color(Paint::Palette(k)));
    }
    let x = Axis::new("machine", "").with_range(-0.5, last);
    let y = Axis::log("true error", "").with_range(low, high);
    chart("Accuracy kept", x, y, series)
}

fn estimates(results: &[MachineResult]) -> Chart {
    let series = by_accuracy(results, |_, run| {
        Some([run.error, run.estimate_ratio()?.clamp(0.1, 1e6)])
    });
    let line = |at: f64| Mark::horizontal(at, "");
    let x = Axis::log("true error", "").with_range(1e-13, ERROR_RANGE[1]);
    let y = Axis::log("estimate / true error", "").with_range(0.1, 1e6);
    Chart {
        marks: vec![line(1.0), line(MAX_ESTIMATE_RATIO)],
        ..chart("Estimates", x, y, series)
    }
}

/// All numbers of all runs.
fn csv_table(results: &[MachineResult]) -> Table {
    let columns: [NumberColumn<'_, (&MachineResult, &MachineRun)>; 6] = [
        ("machine", "", |(machine, _)| machine.number as f64),
        ("accuracy", "", |(_, run)| run.accuracy),
        ("refused", "", |(_, run)| f64::from(run.refused.is_some())),
        ("true error", "", |(_, run)| run.error),
        ("error of the reference", "", |(_, run)| run.reference_error),
        ("estimate", "", |(_, run)| run.estimate),
    ];
    numbers(&columns, runs(results))
}
