//! Figures, tables and the document of the grid.

use super::check::check;
use super::series::{MAX_ESTIMATE_RATIO, ResultCell, SeriesResult};
use crate::report_parts::{StudyReport, TextColumn, figure_blocks, table_of};
use dwell_findings::Finding;
use dwell_report::{
    Axis, Chart, Column, Figure, Mark, Paint, Series, Stroke, Table, TableExport as _,
};
use dwell_study::output::chart;
use dwell_study::ranges::extent;
use dwell_study::{Outcome, StudyError};

/// Maximum number of digits in a chart.
const MAX_DIGITS: f64 = 17.0;
/// Height of typed errors in a chart of digits.
const TYPED_ERROR_HEIGHT: f64 = 0.4;
/// Range of ratios in a chart.
const RATIO_RANGE: [f64; 2] = [0.1, 1e5];

/// The report of the grid and of further findings: `NAME.md`, `NAME.txt` and the folder `NAME/`.
///
/// # Errors
/// [`StudyError`] if a table cannot be written.
pub fn outcome(
    results: &[SeriesResult],
    further: Vec<Finding>,
    name: &str,
) -> Result<Outcome, StudyError> {
    let mut findings = check(results);
    findings.extend(further);
    let figures = figures(results);
    let mut outcome = Outcome::default();
    for result in results {
        let file = format!("{name}/{}.csv", result.series.key);
        outcome.files.add(file, csv_table(result).csv()?);
    }
    let columns: [TextColumn<&SeriesResult>; 6] = [
        ("Row", |row| row.series.description.clone()),
        ("Floor, digits", |row| {
            let [min, max] = extent(row.cells.iter().map(|c| c.requirement.min_digits));
            format!("{max:.1} to {min:.1}")
        }),
        ("Fewest digits", |row| {
            let [min, _] = extent(row.cells.iter().filter_map(ResultCell::digits));
            format!("{min:.1}")
        }),
        ("Typed errors", |row| {
            let errors = row.cells.iter().filter(|c| c.result.is_err());
            format!("{} of {}", errors.count(), row.cells.len())
        }),
        ("Estimate / true error", |row| {
            let ratios = row.cells.iter().filter_map(ResultCell::estimate_ratio);
            let [low, high] = extent(ratios);
            format!("{low:.2} to {high:.0}")
        }),
        ("Why this floor", |row| row.series.reason.to_owned()),
    ];
    let mut blocks = vec![table_of(&columns, results.iter())];
    blocks.extend(figure_blocks(name, &figures, false));
    let cells: usize = results.iter().map(|m| m.cells.len()).sum();
    let report = StudyReport {
        name,
        title: "Extremes",
        text: "Parameters are driven to their extremes, and the results are compared with closed forms in 32 digits. Each row states beforehand how many digits it must keep; below that only a typed error is accepted, and only where the condition number is above 1e8. Each result carries an estimate of its error: from the same evaluation in double-double numbers, from a second run at a tenth of the tolerance, or from the change of a period with its initial state."
            .to_owned(),
        blocks,
        snapshot: snapshot(results),
        figures: &figures,
        findings,
        count: format!("{cells} cells"),
    };
    report.add_to(&mut outcome);
    Ok(outcome)
}

/// A figure for each family of rows: digits on the left, estimates on the right.
fn figures(results: &[SeriesResult]) -> Vec<Figure> {
    let mut figures: Vec<Figure> = Vec::new();
    for result in results {
        let series = &result.series;
        let (name, title) = series.figure;
        if figures.last().is_none_or(|figure| figure.name != name) {
            figures.push(Figure {
                name: name.to_owned(),
                title: title.to_owned(),
                caption: format!(
                    "Left: decimal digits kept; dashed: the floor stated beforehand; at the foot: typed errors, allowed \
                     where the condition is above 1e8. Right: the estimated error over the true one, which must not be \
                     below 1 and in 95 % of all cells not above {MAX_ESTIMATE_RATIO}. The references of the results:"
                ),
                columns: 2,
                ..Figure::default()
            });
        }
        if let Some(figure) = figures.last_mut() {
            // Rows with one reference state it once.
            if !figure.caption.contains(series.reference) {
                figure.caption += &format!("\n{}: {}.", series.description, series.reference);
            }
            figure.panels.push(digits_chart(result).into());
            figure.panels.push(ratio_chart(result).into());
        }
    }
    figures
}

/// The points of a quantity's cells, if any.
fn points(
    result: &SeriesResult,
    quantity: usize,
    of: impl Fn(&ResultCell) -> Option<f64>,
) -> Vec<[f64; 2]> {
    let cells = result.cells.iter().filter(|c| c.quantity == quantity);
    cells.filter_map(|c| Some([c.parameter, of(c)?])).collect()
}

fn parameter_axis(result: &SeriesResult) -> Axis {
    let (label, unit) = result.series.parameter;
    let [low, high] = extent(result.series.values.iter().copied());
    // A margin at the outermost points, the same on the left and on the right.
    let margin = (high / low).powf(0.03);
    Axis::log(label, unit).with_range(low / margin, high * margin)
}

fn digits_chart(result: &SeriesResult) -> Chart {
    let parameter_series = &result.series;
    let mut series = Vec::new();
    let mut required_lines: Vec<(Vec<[f64; 2]>, Paint)> = Vec::new();
    for (k, quantity) in parameter_series.quantities.iter().enumerate() {
        let paint = Paint::Palette(k);
        let achieved = Series::line(*quantity, points(result, k, ResultCell::digits));
        series.push(achieved.stroke(Stroke::LineAndPoints).color(paint));
        // One line each if they differ, otherwise one for all.
        let digits = |c: &ResultCell| Some(c.requirement.min_digits.min(MAX_DIGITS));
        let required = points(result, k, digits);
        let mut known = required_lines.iter_mut();
        match known.find(|(line, _)| *line == required) {
            Some((_, paint)) => *paint = Paint::Grey,
            None => required_lines.push((required, paint)),
        }
    }
    for (required, paint) in required_lines {
        let dashed = Series::line("", required).stroke(Stroke::Dashed);
        series.push(dashed.color(paint));
    }
    let failed = result.cells.iter().filter(|c| c.result.is_err());
    let typed_errors = failed.map(|c| [c.parameter, TYPED_ERROR_HEIGHT]);
    let typed_errors: Vec<[f64; 2]> = typed_errors.collect();
    if !typed_errors.is_empty() {
        let marked = Series::line("typed error", typed_errors).stroke(Stroke::Points);
        series.push(marked.color(Paint::Ink));
    }
    let x = parameter_axis(result);
    let y = Axis::new("digits kept", "").with_range(0.0, MAX_DIGITS);
    chart(&parameter_series.description, x, y, series)
}

fn ratio_chart(result: &SeriesResult) -> Chart {
    let [low, high] = RATIO_RANGE;
    let named = result.series.quantities.iter().enumerate();
    let series = named.map(|(k, quantity)| {
        let clamped = |c: &ResultCell| Some(c.estimate_ratio()?.clamp(low, high));
        let line = Series::line(*quantity, points(result, k, clamped));
        line.stroke(Stroke::Points).color(Paint::Palette(k))
    });
    let line = |at: f64| Mark::horizontal(at, "");
    Chart {
        x: parameter_axis(result),
        y: Axis::log("estimate / true error", "").with_range(low, high),
        series: series.collect(),
        marks: vec![line(1.0), line(MAX_ESTIMATE_RATIO)],
        ..Chart::default()
    }
}

/// All numbers of a row.
fn csv_table(result: &SeriesResult) -> Table {
    let series = &result.series;
    let mut columns = vec![Column::new(series.parameter.0, series.parameter.1)];
    for quantity in series.quantities {
        for kind in ["", ", reference", ", true error", ", estimate", ", floor"] {
            let unit = if kind == ", floor" { "digits" } else { "" };
            columns.push(Column::new(format!("{quantity}{kind}"), unit));
        }
    }
    let at = |&value: &f64| {
        let mut cells = vec![value];
        for cell in result.cells.iter().filter(|c| c.parameter == value) {
            cells.extend(match &cell.result {
                Ok(r) => [r.value, r.reference.hi, r.true_error(), r.error_estimate],
                Err(_) => [f64::NAN; 4],
            });
            cells.push(cell.requirement.min_digits);
        }
        cells
    };
    Table {
        columns,
        rows: series.values.iter().map(at).collect(),
    }
}

/// The reproducible text: the requirements.
fn snapshot(results: &[SeriesResult]) -> String {
    let mut text = "Extremes\n\n".to_owned();
    for result in results {
        let series = &result.series;
        let [min, max] = extent(result.cells.iter().map(|c| c.requirement.min_digits));
        text += &format!(
            "{}  {} values of {} quantities  floors {max:.1} to {min:.1} digits\n",
            series.key,
            series.values.len(),
            series.quantities.len()
        );
    }
    text
}
