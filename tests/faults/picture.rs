//! The matrix of faults and truths as a picture.

use super::steps::Tally;
use super::study::Study;
use super::verdict::{TRUTHS, Verdict};
use dwell_report::{Axis, Cell, Figure, Grid, Group, Panel, Row};

/// The figure `faults`.
pub(crate) fn picture(study: &Study, steps: &[(&'static str, Tally)]) -> Figure {
    Figure {
        name: "faults".into(),
        title: "Deliberate faults and the independent truths that catch them".into(),
        caption: format!(
            "Above: named faults, each on the machine that shows it to the fewest truths; a number is the digits by which the \
             difference exceeds the truth's tolerance, 0: not seen, hatched: not asked. Below: {} faults of single operations in \
             the product's own lines, every sign, term and factor of each step; a number is the share that a truth catches, in \
             percent. A fault must be caught by two truths at least.",
            study.slips.len()
        ),
        columns: 1,
        panels: vec![named(study), operations(steps)],
        ..Figure::default()
    }
}

fn columns() -> Vec<String> {
    TRUTHS.map(str::to_owned).to_vec()
}

fn named(study: &Study) -> Panel {
    let clean = Group {
        heading: String::new(),
        rows: vec![row("no fault", &study.clean)],
    };
    let chapters = study.chapters.iter().map(|chapter| Group {
        heading: chapter.title.into(),
        rows: chapter
            .rows
            .iter()
            .map(|r| row(r.fault, &r.verdict))
            .collect(),
    });
    Panel::from(Grid {
        title: "Named faults".into(),
        columns: columns(),
        groups: std::iter::once(clean).chain(chapters).collect(),
        values: Axis::new("digits above the tolerance", "").within(0.0, 16.0),
    })
}

fn row(name: &str, verdict: &Verdict) -> Row {
    let cell = |(number, digits): (usize, &Option<f64>)| {
        digits.map(|digits| match verdict.caught(number) {
            true => Cell::new(digits, format!("{digits:.0}")),
            false => Cell::words("0"),
        })
    };
    Row::new(name, verdict.digits.iter().enumerate().map(cell).collect())
}

fn operations(steps: &[(&'static str, Tally)]) -> Panel {
    let row = |(step, tally): &(&'static str, Tally)| {
        let cell = |number: usize| {
            let (caught, felt) = (tally.caught[number], tally.felt());
            let share = 100.0 * caught as f64 / felt.max(1) as f64;
            (tally.asked[number] > 0).then(|| match caught {
                0 => Cell::words("0"),
                _ => Cell::new(share, format!("{share:.0}")),
            })
        };
        let fewest = tally.fewest.map_or("-".to_owned(), |n| n.to_string());
        let name = format!("{step}: {} felt, by {fewest} or more", tally.felt());
        Row::new(name, (0..TRUTHS.len()).map(cell).collect())
    };
    Panel::from(Grid {
        title: "Every sign, term and factor, by the steps of a plan".into(),
        columns: columns(),
        groups: vec![Group {
            heading: String::new(),
            rows: steps.iter().map(row).collect(),
        }],
        values: Axis::new("caught by the truth", "%").within(0.0, 100.0),
    })
}
