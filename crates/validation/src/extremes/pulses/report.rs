//! The table and the picture of the pulses.

use super::check::{MAX_ERROR_RATIO, check};
use super::pulse::PulseShape;
use super::run::{PulseResult, PulseRun, RunKind};
use crate::report_parts::{figure_blocks, findings_text, pass_or_fail, pictures, table};
use dwell_dynamics::Method;
use dwell_findings::all_pass;
use dwell_report::{
    Axis, Block, Chart, Column, Document, Figure, Mark, Paint, Series, Stroke, Table,
    TableExport as _, reproducible_text,
};
use dwell_study::output::chart;
use dwell_study::{Outcome, StudyError};

/// Least and largest ratios that a chart shows.
const RATIO_RANGE: [f64; 2] = [1e-6, 1e2];

/// Adds the report of the pulses, `NAME-pulses.md` with its text, its table and its picture, to an outcome.
///
/// # Errors
/// [`StudyError`] where a table cannot be written.
// Longer than a screen, with the text of the page.
pub(in crate::extremes) fn add_to(
    outcome: &mut Outcome,
    results: &[PulseResult],
    seed: u64,
    name: &str,
) -> Result<(), StudyError> {
    let findings = check(results);
    let name = format!("{name}-pulses");
    let figures = [figure(results, seed)];
    outcome.pictures.extend(pictures(&name, &figures));
    outcome
        .files
        .add(format!("{name}/pulses.csv"), csv_table(results).csv()?);
    let head = format!("Pulses\n\n{} pulses of seed {seed}\n\n", results.len());
    outcome
        .files
        .add(format!("{name}.txt"), head + &reproducible_text(&findings));
    let mut blocks = vec![
        Block::Text(format!(
            "{}. Loads of widths from a millionth of the motion to all of it, at random times, on a wheel, a slider and a \
             pendulum, half of them at rest. Drawn by seed {seed}; `dwell validate --seed N` draws others. Each is integrated by \
             every method and to every preset of `--accuracy`, and compared with its impulse or, on the pendulum, with a motion \
             restarted by hand at the switches at 1e-13.",
            pass_or_fail(all_pass(&findings))
        )),
        table(
            &[
                "Shape",
                "Pulses",
                "Runs",
                "Refused",
                "Missed",
                "Error / accuracy",
                "Error / restarts by hand",
            ],
            PulseShape::ALL
                .iter()
                .map(|&shape| summary_row(shape, results)),
        ),
    ];
    blocks.extend(figure_blocks(&name, &figures, false));
    blocks.push(Block::Heading("Findings".to_owned()));
    blocks.push(Block::Findings(findings.clone()));
    let document = Document {
        title: "Pulses".to_owned(),
        blocks,
    };
    outcome.files.add_document(&name, &document);
    let count = format!(", {} pulses", results.len());
    outcome.summary += &findings_text(&name, &findings, &count);
    outcome.findings.extend(findings);
    Ok(())
}

/// A shape in numbers.
fn summary_row(shape: PulseShape, results: &[PulseResult]) -> Vec<String> {
    let pulses: Vec<&PulseResult> = results.iter().filter(|p| p.shape == shape).collect();
    let runs = || pulses.iter().flat_map(|p| &p.runs);
    let completed = || runs().filter(|run| run.refused.is_none());
    let largest = |of: &dyn Fn(&PulseRun) -> Option<f64>| {
        let largest = completed().filter_map(of).fold(0.0, f64::max);
        format!("{largest:.1e}")
    };
    vec![
        shape.name().to_owned(),
        pulses.len().to_string(),
        runs().count().to_string(),
        (runs().count() - completed().count()).to_string(),
        completed()
            .filter(|run| run.missed.is_nan() || run.missed > 0.5)
            .count()
            .to_string(),
        largest(&PulseRun::accuracy_ratio),
        largest(&PulseRun::restart_ratio),
    ]
}

/// Points of runs over the width of their pulses, within what a chart shows.
fn points(
    results: &[PulseResult],
    [low, high]: [f64; 2],
    of: impl Fn(&PulseRun) -> Option<f64>,
) -> Vec<[f64; 2]> {
    let runs = results
        .iter()
        .flat_map(|p| p.runs.iter().map(move |run| (p, run)));
    let completed = runs.filter(|(_, run)| run.refused.is_none());
    let point =
        |(p, run): (&PulseResult, &PulseRun)| Some([p.relative_width, of(run)?.clamp(low, high)]);
    completed.filter_map(point).collect()
}

fn figure(results: &[PulseResult], seed: u64) -> Figure {
    let runs: usize = results.iter().map(|p| p.runs.len()).sum();
    Figure {
        name: "pulses".to_owned(),
        title: "Pulses: none missed, accuracies reached, as exact as restarts by hand".to_owned(),
        caption: format!(
            "{} pulses of seed {seed} in {runs} runs, one mark each, over the width of the pulse. Above: the error of the \
             speed after the pulse over what it changes the speed by, where a missed pulse is at 1; the true error of the \
             coordinate over the required accuracy, which must stay below 1. Below: the error of a method over that of the same \
             method restarted by hand at the switches, which must stay below {MAX_ERROR_RATIO}; the estimated error over \
             the true one, where it is above rounding.",
            results.len()
        ),
        columns: 2,
        panels: [
            missed(results),
            accuracy(results),
            restarts(results),
            estimates(results),
        ]
        .map(Into::into)
        .into(),
        ..Figure::default()
    }
}

fn width_axis() -> Axis {
    Axis::log("width of the pulse / duration of the motion", "").with_range(5e-7, 2.0)
}

fn line(at: f64, label: &str) -> Mark {
    Mark::Horizontal {
        at,
        label: label.to_owned(),
    }
}

/// A chart of marks by method, or by accuracy.
fn marks_chart(title: &str, y: Axis, series: Vec<Series>, line: Mark) -> Chart {
    let stroke = |series: Series| series.stroke(Stroke::Points);
    let series = series.into_iter().map(stroke).collect();
    Chart {
        marks: vec![line],
        ..chart(title, width_axis(), y, series)
    }
}

fn by_method(
    results: &[PulseResult],
    range: [f64; 2],
    of: &dyn Fn(&PulseRun) -> Option<f64>,
) -> Vec<Series> {
    let series = Method::ALL.iter().enumerate().map(|(k, method)| {
        let of_method = |run: &PulseRun| match run.kind {
            RunKind::Fixed(by, _) if by == *method => of(run),
            _ => None,
        };
        Series::line(method.name(), points(results, range, of_method)).color(Paint::Palette(k))
    });
    series.collect()
}

fn by_accuracy(
    results: &[PulseResult],
    range: [f64; 2],
    of: &dyn Fn(&PulseRun) -> Option<f64>,
) -> Vec<Series> {
    let series = super::run::ACCURACIES
        .iter()
        .enumerate()
        .map(|(k, accuracy)| {
            let of_accuracy = |run: &PulseRun| {
                (run.kind == RunKind::Accuracy(*accuracy))
                    .then(|| of(run))
                    .flatten()
            };
            Series::line(
                format!("accuracy {accuracy:.0e}"),
                points(results, range, of_accuracy),
            )
            .color(Paint::Palette(k))
        });
    series.collect()
}

fn missed(results: &[PulseResult]) -> Chart {
    let range = [1e-16, 10.0];
    let [low, high] = range;
    let y = Axis::log("error of the speed / effect of the pulse", "").with_range(low, high);
    marks_chart(
        "Seen",
        y,
        by_method(results, range, &|run| Some(run.missed)),
        line(1.0, "missed"),
    )
}

fn accuracy(results: &[PulseResult]) -> Chart {
    let y =
        Axis::log("true error / required accuracy", "").with_range(RATIO_RANGE[0], RATIO_RANGE[1]);
    let series = by_accuracy(results, RATIO_RANGE, &PulseRun::accuracy_ratio);
    marks_chart("Accuracy kept", y, series, line(1.0, "promised"))
}

fn restarts(results: &[PulseResult]) -> Chart {
    let y = Axis::log("error / error of restarts by hand", "")
        .with_range(RATIO_RANGE[0], RATIO_RANGE[1]);
    let series = by_method(results, RATIO_RANGE, &PulseRun::restart_ratio);
    marks_chart("Methods", y, series, line(MAX_ERROR_RATIO, "allowed"))
}

fn estimates(results: &[PulseResult]) -> Chart {
    let range = [0.1, 1e8];
    let y = Axis::log("estimate / true error", "").with_range(range[0], range[1]);
    // Below the rounding of the reference there is no true error.
    let ratio = |run: &PulseRun| (run.error > run.rounding).then(|| run.estimate / run.error);
    marks_chart(
        "Estimates",
        y,
        by_accuracy(results, range, &ratio),
        line(1.0, ""),
    )
}

/// All numbers of all runs.
fn csv_table(results: &[PulseResult]) -> Table {
    let columns = [
        ("pulse", ""),
        ("relative width", ""),
        ("span", "s"),
        ("initial speed", "1/s"),
        ("run", ""),
        ("tolerance", ""),
        ("refused", ""),
        ("error", ""),
        ("speed error / effect", ""),
        ("error by hand", ""),
        ("estimate", ""),
        ("rounding", ""),
    ];
    let row = |p: &PulseResult, k: usize, run: &PulseRun| {
        let (RunKind::Fixed(_, tolerance) | RunKind::Accuracy(tolerance)) = run.kind;
        let refused = f64::from(u8::from(run.refused.is_some()));
        let errors = [
            run.error,
            run.missed,
            run.error_by_hand.unwrap_or(f64::NAN),
            run.estimate,
            run.rounding,
        ];
        let mut row = vec![
            p.number as f64,
            p.relative_width,
            p.span,
            p.speed,
            k as f64,
            tolerance,
            refused,
        ];
        row.extend(errors);
        row
    };
    let rows = results.iter().flat_map(|p| {
        p.runs
            .iter()
            .enumerate()
            .map(move |(k, run)| row(p, k, run))
    });
    Table {
        columns: columns.map(|(name, unit)| Column::new(name, unit)).into(),
        rows: rows.collect(),
    }
}
