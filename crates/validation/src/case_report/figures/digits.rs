//! The digits of agreement of the findings of a case.

use dwell_findings::{Check, Finding};
use dwell_report::{Axis, Cell, Figure, Grid, Group, Row};
use dwell_scene::Scene;
use dwell_study::number_format::count;
use dwell_study::output::figure;

/// Digits of a number: exact agreement has no more.
const MAX_DIGITS: f64 = 16.0;

/// Difference, tolerance and their ratio of every finding, by check.
pub(crate) fn digits(scene: &Scene, findings: &[Finding]) -> Figure {
    let of_check = |check| findings.iter().filter(move |f| f.check == check);
    let group = |check: Check| Group {
        heading: check.to_string(),
        rows: of_check(check).map(row).collect(),
    };
    let groups = Check::ALL.map(group).into_iter();
    let groups = groups.filter(|group| !group.rows.is_empty()).collect();
    let columns = [
        "relative difference",
        "tolerance",
        "tolerance over difference",
    ];
    let count = count(findings.len(), "finding");
    let grid = Grid {
        columns: columns.map(str::to_owned).into(),
        groups,
        values: Axis::new("digits that agree", "").with_range(0.0, MAX_DIGITS),
        ..Grid::default()
    };
    let text =
        "The largest relative difference of every finding and its tolerance, grouped by check.";
    let provenance = format!("{count}, each with its own check and tolerance");
    figure(
        scene,
        "digits",
        "Digits of agreement",
        text,
        vec![grid.into()],
        provenance,
    )
}

fn row(finding: &Finding) -> Row {
    let part = |value: f64| {
        let text = match value {
            0.0 => "0".to_owned(),
            value => format!("{value:.1e}").replace('-', "−"),
        };
        // Zero has all digits; what is not a number has no colour.
        Cell {
            value: (!value.is_nan()).then(|| (-value.log10()).min(MAX_DIGITS)),
            ..Cell::text_only(text)
        }
    };
    let between = match finding.tolerance / finding.relative_difference {
        factor if !factor.is_finite() => None,
        factor if factor < 100.0 => Some(Cell::text_only(format!("{factor:.1}"))),
        factor if factor < 1e5 => Some(Cell::text_only(format!("{factor:.0}"))),
        factor => Some(Cell::text_only(format!("{factor:.0e}"))),
    };
    let mut difference = part(finding.relative_difference);
    difference.failed = !finding.pass;
    let tolerance = Some(part(finding.tolerance));
    let cells = vec![Some(difference), tolerance, between];
    Row::new(finding.key.clone(), cells)
}
