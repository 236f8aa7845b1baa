//! Grids: what each check sees of each fault, and how many digits each case keeps.

use dwell_report::{Axis, Cell, Figure, Grid, Group, Row};

/// Numbers without a pattern, the same each time.
fn scattered(row: usize, column: usize) -> usize {
    (row * 7919 + column * 104_729 + row * column * 31) % 101
}

/// Faults against checks: the colour is by how much a fault exceeds the tolerance.
//
// Long: one picture, written out as data.
pub(crate) fn mutations() -> Figure {
    let columns = [
        "dense rows",
        "virtual power",
        "tape",
        "quadrature",
        "textbook",
        "energy",
        "multibody",
        "published values",
        "mirror image",
        "scaled by two",
        "turned scene",
        "calibrated",
    ];
    let families = [
        ("Geometry", "a link of another length", 12),
        ("Masses and loads", "gravity at the wrong end of a link", 14),
        ("Solver", "a stopped step", 10),
    ];
    let cell = |row: usize, column: usize| {
        let n = scattered(row, column);
        match n {
            0..30 => None,
            30..38 => Some(Cell::text_only("0")),
            _ => {
                let exponent = n as f64 / 8.0 - 3.0;
                let cell = Cell::new(
                    10f64.powf(exponent),
                    format!("{:.0e}", 10f64.powf(exponent)),
                );
                Some(if exponent < 2.0 { cell.failed() } else { cell })
            }
        }
    };
    let mut count = 0;
    let groups = families.map(|(heading, name, rows)| Group {
        heading: heading.to_owned(),
        rows: (0..rows)
            .map(|i| {
                count += 1;
                let cells = (0..columns.len())
                    .map(|column| cell(count, column))
                    .collect();
                Row::new(format!("{name}, {}", i + 1), cells)
            })
            .collect(),
    });
    Figure {
        name: "faults".to_owned(),
        title: "Which check sees which deliberate fault".to_owned(),
        caption: "Each number is the difference over its tolerance. A fault that no check sees would be a row without blue."
            .to_owned(),
        provenance: "Dwell 0.1.0 · 36 faults · no scene".to_owned(),
        columns: 1,
        panels: vec![
            Grid {
                title: "Difference over tolerance".to_owned(),
                columns: columns.map(str::to_owned).into(),
                groups: groups.into(),
                values: Axis::log("difference over tolerance", "").with_range(1e-2, 1e8),
                ..Grid::default()
            }
            .into(),
        ],
    }
}

/// A long page: digits that agree, of 120 cases.
pub(crate) fn digits() -> Figure {
    let columns = ["m", "½m′", "½m″", "τ", "x", "y", "M", "E", "P", "Q", "q̈"];
    let rows = (0..120).map(|row| {
        let cell = |column| {
            let digits = 3 + scattered(row, column) % 13;
            let cell = Cell::new(digits as f64, digits.to_string());
            Some(if digits < 4 { cell.failed() } else { cell })
        };
        let cells = (0..columns.len()).map(cell).collect();
        Row::new(format!("four-bar-{row}"), cells)
    });
    Figure {
        name: "digits-of-cases".to_owned(),
        title: "Digits that agree".to_owned(),
        columns: 1,
        panels: vec![
            Grid {
                columns: columns.map(str::to_owned).into(),
                groups: vec![Group {
                    rows: rows.collect(),
                    ..Group::default()
                }],
                values: Axis::new("digits that agree with the truth", "").with_range(0.0, 16.0),
                ..Grid::default()
            }
            .into(),
        ],
        ..Figure::default()
    }
}
