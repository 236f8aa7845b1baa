//! Findings, figure and document of the forms.

use super::check::{check_digits, check_estimates};
use super::forms::{Form, evaluate};
use super::series::{ResultCell, SeriesResult};
use crate::report_parts::{StudyReport, figure_blocks, nearest, table};
use dwell_findings::Finding;
use dwell_report::{Axis, Cell, Figure, Grid, Group, Row};
use dwell_study::Outcome;
use dwell_study::ranges::extent;

/// Digits of double precision, the most that the figure shows.
const MAX_DIGITS: f64 = 16.0;

/// The findings of each form: required digits, and safety of the stated errors.
pub fn check(results: &[(Form, Vec<SeriesResult>)]) -> Vec<Finding> {
    let of_form = |(form, results): &(Form, Vec<SeriesResult>)| {
        [
            Finding {
                scale: "the error that the floor allows; typed errors only where half of the digits are lost, or where the fit says so"
                    .to_owned(),
                ..combined(*form, "digits", results.iter().map(check_digits))
            },
            combined(*form, "error-estimate", results.iter().map(check_estimates)),
        ]
    };
    results.iter().flat_map(of_form).collect()
}

/// The worst finding of the series of a form, which represents all of them.
fn combined(form: Form, what: &str, findings: impl Iterator<Item = Finding>) -> Finding {
    let findings: Vec<Finding> = findings.collect();
    let key = format!(
        "{}-{what}",
        form.name().replace(", ", "-").replace(' ', "-")
    );
    let worst = nearest(findings.iter());
    Finding {
        key,
        comparison: "series of the extremes, against their closed forms".to_owned(),
        tolerance_reason: "as each series, with the roundings or the accuracy of the form"
            .to_owned(),
        domain: format!("{} series of the grid", findings.len()),
        worst_at: worst.map_or_else(String::new, |f| format!("{}: {}", f.key, f.worst_at)),
        ..worst.cloned().unwrap_or_default()
    }
}

/// Adds the report of the forms, next to the results of the grid itself: `extremes-forms`.
pub fn add_to(outcome: &mut Outcome, plane: &[SeriesResult], name: &str) {
    let results = evaluate(&Form::OTHERS);
    let figures = [figure(plane, &results)];
    let name = format!("{name}-forms");
    let mut reasons: Vec<[String; 3]> = Vec::new();
    for form in Form::OTHERS {
        let without = plane
            .iter()
            .filter(|s| Form::of_grid(&s.series.key) != form)
            .filter_map(|s| Some((s, form.not_run(&s.series.key)?)));
        for (series, reason) in without {
            let key = &series.series.key;
            match reasons.iter_mut().find(|[k, _, r]| k == key && r == reason) {
                Some([_, forms, _]) => *forms += &format!("; {}", form.name()),
                None => reasons.push([key.clone(), form.name(), reason.to_owned()]),
            }
        }
    }
    let cells: usize = results
        .iter()
        .flat_map(|(_, all)| all)
        .map(|s| s.cells.len())
        .sum();
    let mut blocks = figure_blocks(&name, &figures, true);
    blocks.push(table(
        &["Series", "Not run in", "Why"],
        reasons.into_iter().map(Vec::from),
    ));
    let report = StudyReport {
        name: &name,
        title: "Extremes in other forms",
        text: "The series of the extremes again, with the same references: in an oblique plane in space, where the planar equivalent is taken or every loop is closed in space; in single precision; on tables; as exported code, operation by operation. Each form states beforehand what it may lose of the digits of double precision in the plane: 32 roundings of its numbers, or 32 times the accuracy that is asked of it. The errors that it states must not be below the true ones."
            .to_owned(),
        blocks,
        snapshot: snapshot(&results),
        figures: &figures,
        findings: check(&results),
        count: format!("{cells} cells"),
    };
    report.add_to(outcome);
}

/// The reproducible text: the number of series of each form, and the required digits.
fn snapshot(results: &[(Form, Vec<SeriesResult>)]) -> String {
    let mut text = "Extremes in other forms\n\n".to_owned();
    for (form, all) in results {
        let cells = all.iter().flat_map(|series| &series.cells);
        let [min, max] = extent(cells.map(|cell| cell.requirement.min_digits));
        let (name, count) = (form.name(), all.len());
        text += &format!("{name}  {count} series  floors {max:.1} to {min:.1} digits\n");
    }
    text
}

/// Series by form: the remaining digits, together with those lost by the condition number.
fn figure(plane: &[SeriesResult], results: &[(Form, Vec<SeriesResult>)]) -> Figure {
    let cell = |series: &SeriesResult| {
        let kept = series.cells.iter().filter_map(|cell| {
            Some(cell.digits()? + cell.requirement.condition_number.log10().max(0.0))
        });
        let [fewest, _] = extent(kept);
        let known = fewest.is_finite().then(|| fewest.clamp(0.0, MAX_DIGITS));
        Cell {
            value: known,
            text: known.map_or("refused".to_owned(), |digits| format!("{digits:.0}")),
            failed: !series.cells.iter().all(ResultCell::meets_requirement),
        }
    };
    let row = |series: &SeriesResult| {
        let key = &series.series.key;
        let own = Form::of_grid(key);
        let others = results.iter().map(|(form, all)| {
            let same = all.iter().find(|other| other.series.key == *key);
            same.or_else(|| (*form == own).then_some(series)).map(cell)
        });
        let in_plane = (own == Form::PLANE).then(|| cell(series));
        Row {
            name: key.clone(),
            cells: std::iter::once(in_plane).chain(others).collect(),
        }
    };
    let forms = std::iter::once(Form::PLANE).chain(results.iter().map(|(form, _)| *form));
    let grid = Grid {
        title: String::new(),
        columns: forms.map(Form::name).collect(),
        groups: vec![Group {
            heading: String::new(),
            rows: plane.iter().map(row).collect(),
        }],
        values: Axis::new("digits kept, plus those that the condition takes", "")
            .with_range(0.0, MAX_DIGITS),
        compact: true,
    };
    Figure {
        name: "forms".to_owned(),
        title: "Digits kept in each form".to_owned(),
        caption: "The fewest digits over each series, with those that its condition takes from any result; hatched: not run in this form, for the reason in the table below.".to_owned(),
        columns: 1,
        panels: vec![grid.into()],
        ..Figure::default()
    }
}
