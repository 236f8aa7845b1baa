//! All cases and all truths at once.

use crate::index::{TRUTHS, Verdict, Word, words};
use dwell_report::{Axis, Cell, Figure, Grid, Group, Panel, Row};

/// Digits that the colours cover: from a motion that is merely followed to the last place.
const DIGITS: [f64; 2] = [6.0, 16.0];

/// Digits of agreement, case by truth.
pub(crate) fn overview(verdicts: &[Verdict<'_>]) -> Figure {
    // By truth and reason: the cases.
    let mut silent: Vec<((usize, &str), Vec<&str>)> = Vec::new();
    let mut rows = Vec::new();
    for (name, verdict) in verdicts {
        let Ok((scene, done)) = verdict else {
            let failed = Cell::words("none").failed();
            rows.push(Row::new(*name, vec![Some(failed); TRUTHS.len()]));
            continue;
        };
        let cells = words(done).into_iter().enumerate();
        let cells = cells.map(|(truth, word)| match word {
            Word::Digits(digits) => Some(Cell::new(digits, format!("{digits:.1}"))),
            Word::Failed(_) => Some(Cell::words("FAIL").failed()),
            Word::None(why) => {
                let found = silent.iter_mut().find(|(of, _)| *of == (truth, why));
                match found {
                    Some((_, cases)) => cases.push(&scene.name),
                    None => silent.push(((truth, why), vec![&scene.name])),
                }
                None
            }
        });
        rows.push(Row::new(&scene.name, cells.collect()));
    }
    silent.sort_by_key(|(of, _)| *of);
    let mut caption =
        "Digits of agreement of the worst finding of each truth; 15.7 is the last place of double \
                       precision. 5, 6 and part of 4 are of integrated motions."
            .to_owned();
    for ((truth, why), cases) in &silent {
        caption += &format!("\n{}, {why}: {}.", TRUTHS[*truth], cases.join(", "));
    }
    Figure {
        name: "index".to_owned(),
        title: "Every case and every truth".to_owned(),
        caption,
        columns: 1,
        panels: vec![Panel::from(Grid {
            columns: TRUTHS.map(str::to_owned).to_vec(),
            groups: vec![Group {
                heading: String::new(),
                rows,
            }],
            values: Axis::new("digits of agreement", "").within(DIGITS[0], DIGITS[1]),
            ..Grid::default()
        })],
        provenance: format!("Dwell {}", env!("CARGO_PKG_VERSION")),
    }
}
