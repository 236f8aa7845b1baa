//! All cases and all checks at once.

use crate::overview::{CaseResult, CheckCell, check_cells};
use dwell_findings::Check;
use dwell_report::{Axis, Cell, Figure, Grid, Group, Panel, Row};
use std::collections::BTreeMap;

/// Digits that the colours cover: from those of an integrated motion to the last place.
const COLOR_RANGE: [f64; 2] = [6.0, 16.0];

/// Digits of agreement, case by check.
pub(crate) fn overview(results: &[CaseResult<'_>]) -> Figure {
    // By check and reason: the cases.
    let mut not_applicable: BTreeMap<(Check, &str), Vec<&str>> = BTreeMap::new();
    let mut rows = Vec::new();
    for (name, result) in results {
        let Ok((scene, validation)) = result else {
            let failed = Cell::text_only("none").failed();
            rows.push(Row::new(*name, vec![Some(failed); Check::ALL.len()]));
            continue;
        };
        let cells = Check::ALL.into_iter().zip(check_cells(validation));
        let cells = cells.map(|(check, cell)| match cell {
            CheckCell::Digits(digits) => Some(Cell::new(digits, format!("{digits:.1}"))),
            CheckCell::Failed(_) => Some(Cell::text_only("FAIL").failed()),
            CheckCell::NotApplicable(why) => {
                let cases = not_applicable.entry((check, why)).or_default();
                cases.push(&scene.name);
                None
            }
        });
        rows.push(Row::new(&scene.name, cells.collect()));
    }
    let mut caption =
        "Agreeing digits of the worst finding of each check; double precision has 15.7. Checks 5, 6 and part of 4 are limited by the integrator's tolerance."
            .to_owned();
    for ((check, why), cases) in &not_applicable {
        caption += &format!("\n{check}, {why}: {}.", cases.join(", "));
    }
    Figure {
        name: "index".to_owned(),
        title: "Every case and every check".to_owned(),
        caption,
        columns: 1,
        panels: vec![Panel::from(Grid {
            columns: Check::ALL.map(|check| check.to_string()).to_vec(),
            groups: vec![Group {
                heading: String::new(),
                rows,
            }],
            values: Axis::new("digits of agreement", "").with_range(COLOR_RANGE[0], COLOR_RANGE[1]),
            ..Grid::default()
        })],
        provenance: format!("Dwell {}", env!("CARGO_PKG_VERSION")),
    }
}
