//! The picture, the table and the document of the study.

use super::compute::{Cell, DIGITS, INTERPOLATIONS, POSITIONS, QUANTITIES};
use crate::report_parts::{StudyReport, TextColumn, figure_blocks, table_of};
use dwell_findings::{Check, Finding};
use dwell_report::{
    Axis, Block, Chart, Column, Figure, Mark, Paint, Panel, Series, Stroke, Table, TableExport as _,
};
use dwell_study::exported_runs::SampleInterpolation;
use dwell_study::output::chart;
use dwell_study::{Outcome, StudyError};

const NAME: &str = "exported-runs";
/// The errors that a chart has room for.
const ERROR_RANGE: [f64; 2] = [1e-16, 1.0];
/// Allowance for rounding in addition to stated errors: the largest measured error of the reaction is 3e-13, where
/// 2e-13 is stated.
const ROUNDING: f64 = 2e-13;

/// The report: `exported-runs.md`, `.txt` and the folder `exported-runs/`.
///
/// # Errors
/// [`StudyError`] where the table cannot be written.
pub(super) fn outcome(cells: &[Cell]) -> Result<Outcome, StudyError> {
    let figures = [figure(cells)];
    let mut outcome = Outcome::default();
    let numbers = numbers(cells).csv()?;
    outcome.files.add(format!("{NAME}/errors.csv"), numbers);
    let mut blocks = figure_blocks(NAME, &figures, true);
    let heading = "Errors relative to the largest value";
    blocks.push(Block::Heading(heading.to_owned()));
    blocks.push(errors_table(cells));
    let report = StudyReport {
        name: NAME,
        title: "Exported runs",
        text: "`dwell reduce --from RUN_I RUN_II` knows the mechanism only where the tables have positions, and only to their printed \
               digits. Here its result is compared with the mechanism that made them, so that a user knows what to export: for a \
               mechanism without sharp features a position for each degree, twelve digits, a whole revolution at equal angles."
            .to_owned(),
        blocks,
        snapshot: format!("Exported runs\n\n{} exports\n", cells.len()),
        figures: &figures,
        findings: findings(cells),
        count: format!("{} exports", cells.len()),
    };
    report.add_to(&mut outcome);
    Ok(outcome)
}

/// For each interpolation and quantity: no error is above the stated one.
fn findings(cells: &[Cell]) -> Vec<Finding> {
    let of = |interpolation: SampleInterpolation, k: usize| {
        let excess = |cell: &Cell| cell.errors[k] / (cell.estimates[k] + ROUNDING);
        let all = cells.iter().filter(|c| c.interpolation == interpolation);
        let worst = all.max_by(|one, other| excess(one).total_cmp(&excess(other)));
        let ratio = worst.map_or(f64::NAN, excess);
        let key = format!("{NAME}-{}-{}", interpolation.name(), QUANTITIES[k]);
        let check = match QUANTITIES[k] {
            "period" => Check::Period,
            _ => Check::WrittenTwice,
        };
        let worst_at = worst.map(|c| format!("{} positions, {} digits", c.positions, c.digits));
        Finding {
            comparison: format!(
                "error of the {} of exported runs, {} interpolation, over the stated error",
                QUANTITIES[k],
                interpolation.name()
            ),
            scale: "the stated error".to_owned(),
            worst_at: worst_at.unwrap_or_default(),
            ..Finding::new(&key, check, [ratio, ratio], 1.0)
        }
    };
    let each = |interpolation| (0..QUANTITIES.len()).map(move |k| of(interpolation, k));
    INTERPOLATIONS.into_iter().flat_map(each).collect()
}

/// Errors over the number of positions: by interpolation with all digits, and by digits with trigonometric interpolation.
fn figure(cells: &[Cell]) -> Figure {
    let most = DIGITS[DIGITS.len() - 1];
    let trigonometric = SampleInterpolation::Trigonometric;
    let of_quantity = |(k, name): (usize, &str)| {
        let series = |(i, (name, interpolation, digits)): (usize, (String, _, usize))| {
            let is_of = |c: &&Cell| c.interpolation == interpolation && c.digits == digits;
            lines(name, i, k, &cells.iter().filter(is_of).collect::<Vec<_>>())
        };
        let by_interpolation = INTERPOLATIONS.map(|by| (by.name().to_owned(), by, most));
        let by_digits = DIGITS.map(|n| (format!("{n} digits"), trigonometric, n));
        let titles = [
            format!("{name}: by interpolation, {most} digits"),
            format!("{name}: by digits, trigonometric"),
        ];
        let groups = [by_interpolation.to_vec(), by_digits.to_vec()];
        let panels = titles.into_iter().zip(groups).map(|(title, group)| {
            let series = group.into_iter().enumerate().flat_map(series);
            panel(&title, k, series.collect())
        });
        panels.collect::<Vec<_>>()
    };
    let names = ["m", "the reaction's a, b", "the period"];
    Figure {
        name: "errors".to_owned(),
        title: "What two exported runs are worth".to_owned(),
        caption: "The two kinetostatic runs of the single-dwell mechanism, printed with some digits at some positions of a \
                  revolution, and combined. Full: the largest error of m, of a and b of the slide's normal force (relative to \
                  the largest value), and of the period of the free motion, against the mechanism itself; dashed: what is stated \
                  from the tables alone. The vertical line is one position for each degree."
            .to_owned(),
        columns: 2,
        panels: names.into_iter().enumerate().flat_map(of_quantity).collect(),
        ..Figure::default()
    }
}

/// The true and the stated errors of some exports.
fn lines(name: String, paint: usize, quantity: usize, of: &[&Cell]) -> [Series; 2] {
    let at = |error: fn(&Cell) -> &[f64; 3]| -> Vec<[f64; 2]> {
        let clamped = |c: &Cell| error(c)[quantity].clamp(ERROR_RANGE[0], ERROR_RANGE[1]);
        of.iter()
            .map(|c| [c.positions as f64, clamped(c)])
            .collect()
    };
    let paint = Paint::Palette(paint);
    let found = Series::line(name, at(|c| &c.errors)).stroke(Stroke::LineAndPoints);
    let stated = Series::line("", at(|c| &c.estimates)).stroke(Stroke::Dashed);
    [found, stated].map(|series| series.color(paint))
}

fn panel(title: &str, quantity: usize, series: Vec<Series>) -> Panel {
    let [first, last] = [POSITIONS[0], POSITIONS[POSITIONS.len() - 1]].map(|n| n as f64);
    let positions = Axis::log("positions of a revolution", "").with_range(0.9 * first, 1.1 * last);
    let error = format!("error of {} / largest", QUANTITIES[quantity]);
    let errors = Axis::log(error, "").with_range(ERROR_RANGE[0], ERROR_RANGE[1]);
    Panel::from(Chart {
        // One for each degree.
        marks: vec![Mark::vertical(360.0, "")],
        ..chart(title, positions, errors, series)
    })
}

fn numbers(cells: &[Cell]) -> Table {
    let mut columns = vec![
        Column::new("positions", ""),
        Column::new("digits", ""),
        Column::new("interpolation (0 linear, 1 cubic, 2 trigonometric)", ""),
    ];
    for quantity in QUANTITIES {
        columns.push(Column::new(format!("{quantity}.error"), ""));
        columns.push(Column::new(format!("{quantity}.stated"), ""));
    }
    let row = |cell: &Cell| {
        let interpolation = INTERPOLATIONS.iter().position(|i| *i == cell.interpolation);
        let mut row = vec![
            cell.positions as f64,
            cell.digits as f64,
            interpolation.unwrap_or(0) as f64,
        ];
        row.extend((0..QUANTITIES.len()).flat_map(|k| [cell.errors[k], cell.estimates[k]]));
        row
    };
    Table {
        columns,
        rows: cells.iter().map(row).collect(),
    }
}

fn errors_table(cells: &[Cell]) -> Block {
    let columns: [TextColumn<&Cell>; 6] = [
        ("Positions", |cell| cell.positions.to_string()),
        ("Digits", |cell| cell.digits.to_string()),
        ("Interpolation", |cell| cell.interpolation.name().to_owned()),
        ("m", |cell| format!("{:.0e}", cell.errors[0])),
        ("a, b", |cell| format!("{:.0e}", cell.errors[1])),
        ("Period", |cell| format!("{:.0e}", cell.errors[2])),
    ];
    let is_shown = |c: &&Cell| {
        let positions = [36, 72, 180, 360, 720, 3600];
        positions.contains(&c.positions) && [4, 6, 12, 16].contains(&c.digits)
    };
    table_of(&columns, cells.iter().filter(is_shown))
}
