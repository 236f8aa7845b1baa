//! The table and the picture of the pulses.

use super::check::{MAX_ERROR_RATIO, check};
use super::pulse::PulseShape;
use super::run::{ACCURACIES, PulseResult, PulseRun, RunKind};
use crate::drawn::{completed, runs};
use dwell_dynamics::Method;
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Series, Stroke, Table, TableExport as _};
use dwell_study::output::chart;
use dwell_study::{Outcome, StudyError};
use dwell_validation::report_parts::{NumberColumn, StudyReport, figure_blocks, numbers, table};

/// Least and largest ratios that a chart shows.
const RATIO_RANGE: [f64; 2] = [1e-6, 1e2];

/// Adds the report of the pulses, `NAME.md` with its text, its table and its picture, to an outcome.
///
/// # Errors
/// [`StudyError`] where a table cannot be written.
pub fn add_to(
    outcome: &mut Outcome,
    results: &[PulseResult],
    seed: u64,
    name: &str,
) -> Result<(), StudyError> {
    let figures = [figure(results, seed)];
    let csv = csv_table(results).csv()?;
    outcome.files.add(format!("{name}/pulses.csv"), csv);
    let header = [
        "Shape",
        "Pulses",
        "Runs",
        "Refused",
        "Missed",
        "Error / accuracy",
        "Error / restarts by hand",
    ];
    let rows = PulseShape::ALL.map(|shape| summary_row(shape, results));
    let mut blocks = vec![table(&header, rows)];
    blocks.extend(figure_blocks(name, &figures, false));
    let report = StudyReport {
        name,
        title: "Pulses",
        text: format!(
            "Loads of widths from a millionth of the motion to all of it, at random times, on a wheel, a slider and a \
             pendulum, half of them at rest. Drawn by seed {seed}; `just trials --seed N` draws others. Each is integrated by \
             every method and to every preset of `--accuracy`, and compared with its impulse or, on the pendulum, with a motion \
             restarted by hand at the switches at 1e-13."
        ),
        blocks,
        snapshot: format!("Pulses\n\n{} pulses of seed {seed}\n", results.len()),
        figures: &figures,
        findings: check(results),
        count: format!("{} pulses", results.len()),
    };
    report.add_to(outcome);
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

fn figure(results: &[PulseResult], seed: u64) -> Figure {
    let by_method = Method::ALL.map(|method| method.name().to_owned());
    let by_accuracy = ACCURACIES.map(|accuracy| RunKind::Accuracy(accuracy).name());
    let chart = |title: &str, (label, range), line, groups: &[String], of: RunNumber| {
        marks_chart(results, (title, label, range), line, groups, of)
    };
    let panels = [
        chart(
            "Seen",
            ("error of the speed / effect of the pulse", [1e-16, 10.0]),
            Mark::horizontal(1.0, "missed"),
            &by_method,
            |run| Some(run.missed),
        ),
        chart(
            "Accuracy kept",
            ("true error / required accuracy", RATIO_RANGE),
            Mark::horizontal(1.0, "promised"),
            &by_accuracy,
            PulseRun::accuracy_ratio,
        ),
        chart(
            "Methods",
            ("error / error of restarts by hand", RATIO_RANGE),
            Mark::horizontal(MAX_ERROR_RATIO, "allowed"),
            &by_method,
            PulseRun::restart_ratio,
        ),
        chart(
            "Estimates",
            ("estimate / true error", [0.1, 1e8]),
            Mark::horizontal(1.0, ""),
            &by_accuracy,
            // Below the rounding of the reference there is no true error.
            |run| (run.error > run.rounding).then(|| run.estimate / run.error),
        ),
    ];
    Figure {
        name: "pulses".to_owned(),
        title: "Pulses: none missed, accuracies reached, as exact as restarts by hand".to_owned(),
        caption: format!(
            "{} pulses of seed {seed} in {} runs, one mark each, over the width of the pulse. Above: the error of the \
             speed after the pulse over what it changes the speed by, where a missed pulse is at 1; the true error of the \
             coordinate over the required accuracy, which must stay below 1. Below: the error of a method over that of the same \
             method restarted by hand at the switches, which must stay below {MAX_ERROR_RATIO}; the estimated error over \
             the true one, where it is above rounding.",
            results.len(),
            runs(results).count()
        ),
        columns: 2,
        panels: panels.map(Into::into).into(),
        ..Figure::default()
    }
}

/// A number of a run, where it has one.
type RunNumber = fn(&PulseRun) -> Option<f64>;

/// A chart of marks over the width of the pulses, in the colours of groups: the methods, or the required accuracies.
fn marks_chart(
    results: &[PulseResult],
    (title, label, [low, high]): (&str, &str, [f64; 2]),
    line: Mark,
    groups: &[String],
    of: RunNumber,
) -> Chart {
    let width = Axis::log("width of the pulse / duration of the motion", "").with_range(5e-7, 2.0);
    let series = groups.iter().enumerate().map(|(k, group)| {
        let of_group = completed(results).filter(|(_, run)| run.kind.group() == *group);
        let point = |(pulse, run): (&PulseResult, _)| {
            Some([pulse.relative_width, of(run)?.clamp(low, high)])
        };
        let marks = Series::line(group.clone(), of_group.filter_map(point).collect());
        marks.stroke(Stroke::Points).color(Paint::Palette(k))
    });
    let y = Axis::log(label, "").with_range(low, high);
    Chart {
        marks: vec![line],
        ..chart(title, width, y, series.collect())
    }
}

/// All numbers of all runs.
fn csv_table(results: &[PulseResult]) -> Table {
    let columns: [NumberColumn<'_, (&PulseResult, usize, &PulseRun)>; 12] = [
        ("pulse", "", |(pulse, ..)| pulse.number as f64),
        ("relative width", "", |(pulse, ..)| pulse.relative_width),
        ("span", "s", |(pulse, ..)| pulse.span),
        ("initial speed", "1/s", |(pulse, ..)| pulse.speed),
        ("run", "", |(_, k, _)| *k as f64),
        ("tolerance", "", |(.., run)| match run.kind {
            RunKind::Fixed(_, tolerance) | RunKind::Accuracy(tolerance) => tolerance,
        }),
        ("refused", "", |(.., run)| f64::from(run.refused.is_some())),
        ("error", "", |(.., run)| run.error),
        ("speed error / effect", "", |(.., run)| run.missed),
        ("error by hand", "", |(.., run)| {
            run.error_by_hand.unwrap_or(f64::NAN)
        }),
        ("estimate", "", |(.., run)| run.estimate),
        ("rounding", "", |(.., run)| run.rounding),
    ];
    let rows = results.iter().flat_map(|pulse| {
        let runs = pulse.runs.iter().enumerate();
        runs.map(move |(k, run)| (pulse, k, run))
    });
    numbers(&columns, rows)
}
