//! The matrix of faults and checks as a figure.

use super::detection::{CHECKS, Detection};
use super::study::Study;
use super::tallies::Tally;
use dwell_findings::Check;
use dwell_report::{Axis, Cell, Figure, Grid, Group, Panel, Row};

/// The figure `mutations`.
pub fn figure(study: &Study, steps: &[(&'static str, Tally)]) -> Figure {
    let exceptions = match study.exceptions {
        [] => "",
        _ => {
            " Where a guess of Newton's method is wrong, which decides nothing but the branch, one is enough."
        }
    };
    Figure {
        name: study.name.into(),
        title: study.title.into(),
        caption: format!(
            "Above: named faults, each on the mechanism where the fewest checks detect it; a number is the digits by which the \
             difference exceeds the tolerance of the check, 0: not detected, hatched: not applied. Below: {} faults of single \
             operations in the source code, every sign, term and factor of each step; a number is the share that a check \
             detects, in percent. At least two checks must detect a fault.{exceptions}",
            study.operation_results.len()
        ),
        columns: 1,
        panels: vec![named_mutations(study), operations(steps)],
        ..Figure::default()
    }
}

fn columns() -> Vec<String> {
    CHECKS.iter().map(Check::to_string).collect()
}

fn named_mutations(study: &Study) -> Panel {
    let clean = Group {
        heading: String::new(),
        rows: vec![row("no fault", &study.without_mutation)],
    };
    let groups = study.groups.iter().map(|group| Group {
        heading: group.title.into(),
        rows: group
            .rows
            .iter()
            .map(|r| row(r.description, &r.detection))
            .collect(),
    });
    Panel::from(Grid {
        title: "Named faults".into(),
        columns: columns(),
        groups: std::iter::once(clean).chain(groups).collect(),
        values: Axis::new("digits above the tolerance", "").with_range(0.0, 16.0),
        compact: true,
    })
}

fn row(name: &str, detection: &Detection) -> Row {
    let cell = |(number, digits): (usize, &Option<f64>)| {
        digits.map(|digits| match detection.detects(number) {
            true => Cell::new(digits, format!("{digits:.0}")),
            false => Cell::text_only("0"),
        })
    };
    Row::new(
        name,
        detection.digits.iter().enumerate().map(cell).collect(),
    )
}

fn operations(steps: &[(&'static str, Tally)]) -> Panel {
    let row = |(step, tally): &(&'static str, Tally)| {
        let cell = |number: usize| {
            let (caught, effective) = (tally.detected[number], tally.effective());
            let share = 100.0 * caught as f64 / effective.max(1) as f64;
            (tally.applicable[number] > 0).then(|| match caught {
                0 => Cell::text_only("0"),
                _ => Cell::new(share, format!("{share:.0}")),
            })
        };
        let min_checks = tally.min_checks.map_or("-".to_owned(), |n| n.to_string());
        let name = format!(
            "{step}: {} with an effect, detected by {min_checks} or more",
            tally.effective()
        );
        Row::new(name, (0..CHECKS.len()).map(cell).collect())
    };
    Panel::from(Grid {
        title: "Every sign, term and factor, by the steps of a plan".into(),
        columns: columns(),
        groups: vec![Group {
            heading: String::new(),
            rows: steps.iter().map(row).collect(),
        }],
        values: Axis::new("detected by the check", "%").with_range(0.0, 100.0),
        compact: true,
    })
}
