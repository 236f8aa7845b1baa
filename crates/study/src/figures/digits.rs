//! How far the findings of a case agree.

use super::foot;
use crate::words::count;
use dwell_findings::Finding;
use dwell_report::{Axis, Cell, Figure, Grid, Group, Row};
use dwell_scene::Scene;

/// Digits of a number: what agrees exactly has no more.
const MOST: f64 = 16.0;

/// Difference, tolerance and what is between them, of every finding, by truth.
pub(crate) fn digits(scene: &Scene, findings: &[Finding]) -> Figure {
    let mut groups: Vec<Group> = Vec::new();
    let mut findings_by_truth: Vec<&Finding> = findings.iter().collect();
    findings_by_truth.sort_by_key(|finding| (finding.number(), finding.truth.as_str()));
    for finding in findings_by_truth {
        match groups
            .iter_mut()
            .find(|group| group.heading == finding.truth)
        {
            Some(group) => group.rows.push(row(finding)),
            None => groups.push(Group {
                heading: finding.truth.clone(),
                rows: vec![row(finding)],
            }),
        }
    }
    let columns = [
        "relative difference",
        "tolerance",
        "tolerance over difference",
    ];
    Figure {
        name: "h-digits".to_owned(),
        title: "Digits of agreement".to_owned(),
        caption: foot(
            scene,
            "The largest relative difference of every finding beside its tolerance, by the truth it is held against.",
        ),
        columns: 1,
        panels: vec![
            Grid {
                columns: columns.map(str::to_owned).into(),
                groups,
                values: Axis::new("digits that agree", "").within(0.0, MOST),
                ..Grid::default()
            }
            .into(),
        ],
        provenance: format!(
            "{}, each with its own truth and tolerance",
            count(findings.len(), "finding")
        ),
    }
}

fn row(finding: &Finding) -> Row {
    let part = |value: f64| {
        let text = match value {
            0.0 => "0".to_owned(),
            value => format!("{value:.1e}").replace('-', "−"),
        };
        // Zero has all the digits there are; what is no number has no colour.
        Cell {
            value: (!value.is_nan()).then(|| (-value.log10()).min(MOST)),
            ..Cell::words(text)
        }
    };
    let between = match finding.tolerance / finding.relative {
        factor if !factor.is_finite() => None,
        factor if factor < 100.0 => Some(Cell::words(format!("{factor:.1}"))),
        factor if factor < 1e5 => Some(Cell::words(format!("{factor:.0}"))),
        factor => Some(Cell::words(format!("{factor:.0e}"))),
    };
    let mut difference = part(finding.relative);
    difference.failed = !finding.pass;
    Row::new(
        finding.key.clone(),
        vec![Some(difference), Some(part(finding.tolerance)), between],
    )
}
