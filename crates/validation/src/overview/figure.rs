//! The verdict in one picture: passed checks, key numbers, and every case by every check.

use super::{CheckCell, ValidationRun, check_cells, summary};
use crate::report_parts::{margin, margin_text};
use dwell_findings::Check;
use dwell_report::{Axis, Cell, Figure, Grid, Group, Panel, Row, Tiles};

/// Margins that the colours cover.
const COLOR_RANGE: [f64; 2] = [1.0, 1e4];

/// Tiles above a matrix of margins.
pub(super) fn overview(judged: &ValidationRun<'_>) -> Figure {
    let group = |in_space: bool| Group {
        heading: if in_space { "In space" } else { "In the plane" }.to_owned(),
        rows: (judged.cases.iter())
            .filter(|case| case.in_space == in_space)
            .map(|case| {
                let cells = match &case.result {
                    Ok(done) => check_cells(done).map(cell).into(),
                    Err(_) => vec![Some(Cell::text_only("none").failed()); Check::ALL.len()],
                };
                Row::new(case.name, cells)
            })
            .collect(),
    };
    let groups = [false, true].map(group).into_iter();
    let matrix = Grid {
        columns: Check::ALL.map(|check| check.to_string()).into(),
        groups: groups.filter(|group| !group.rows.is_empty()).collect(),
        values: Axis::log("margin: tolerance over difference", "")
            .with_range(COLOR_RANGE[0], COLOR_RANGE[1]),
        compact: true,
        ..Grid::default()
    };
    let rows = summary::tiles(judged)
        .into_iter()
        .filter(|tiles| !tiles.is_empty())
        .map(|tiles| {
            let columns = tiles.len();
            Panel::from(Tiles { columns, tiles })
        });
    Figure {
        name: "index".to_owned(),
        title: judged.headline(),
        caption: "Least margin of each case in each check; = no difference. Details: cases.md."
            .to_owned(),
        columns: 1,
        panels: rows.chain([matrix.into()]).collect(),
        provenance: format!("Dwell {}", env!("CARGO_PKG_VERSION")),
    }
}

fn cell(cell: CheckCell<'_>) -> Option<Cell> {
    match cell {
        CheckCell::Nearest(f) if !f.pass => Some(Cell::text_only("FAIL").failed()),
        CheckCell::Nearest(f) => {
            let margin = margin(f);
            let colored = margin.min(COLOR_RANGE[1]);
            Some(Cell::new(colored, margin_text(margin)))
        }
        CheckCell::NotApplicable(_) => None,
    }
}
