//! The study of extremes sees what it is there to see.

use dwell_findings::Finding;
use dwell_study::extremes::{Measured, judge, measure, rows};
use std::sync::LazyLock;

/// Rows that take little time, of every family.
const QUICK: [&str; 9] = [
    "limit-four-bar",
    "flat-parallelogram",
    "mass-ratio",
    "power-of-two",
    "speed",
    "tolerance-tsit45",
    "stiffness",
    "light-crank",
    "turns",
];

static GRID: LazyLock<Vec<Measured>> = LazyLock::new(grid);

fn grid() -> Vec<Measured> {
    let quick = rows(false).into_iter();
    measure(
        quick
            .filter(|row| QUICK.contains(&row.key.as_str()))
            .collect(),
    )
}

/// The rows again, each with some of its cells changed.
fn spoilt(change: impl Fn(&mut dwell_study::extremes::Cell)) -> Vec<Finding> {
    let cells = GRID.iter().map(|m| m.cells.clone());
    let rows = rows(false).into_iter();
    let rows = rows.filter(|row| QUICK.contains(&row.key.as_str()));
    let mut grid: Vec<Measured> = rows
        .zip(cells)
        .map(|(row, cells)| Measured { row, cells })
        .collect();
    grid.iter_mut().flat_map(|m| &mut m.cells).for_each(change);
    judge(&grid)
}

fn failed(findings: &[Finding]) -> Vec<&str> {
    let failed = findings.iter().filter(|f| !f.pass);
    failed.map(|f| f.key.as_str()).collect()
}

/// Of slow motions, light cranks and pendulums near the separatrix too, in which the workbench once had no
/// digits or no answer.
#[test]
fn val_the_floors_and_the_estimates_hold() {
    let findings = judge(&GRID);
    assert_eq!(findings.len(), 2 * QUICK.len() + 1);
    assert_eq!(failed(&findings), Vec::<&str>::new());
}

/// Seven digits instead of sixteen: every row that promises more is below its floor, and every estimate is
/// below the error.
#[test]
fn the_noise_of_short_numbers_is_seen() {
    let findings = spoilt(|cell| {
        if let Ok(reading) = &mut cell.told {
            reading.value = f64::from(reading.value as f32 * (1.0 + f32::EPSILON));
        }
    });
    let failed = failed(&findings);
    for key in [
        "limit-four-bar",
        "mass-ratio",
        "power-of-two",
        "stiffness",
        "turns",
    ] {
        assert!(
            failed.contains(&format!("{key}-floor").as_str()),
            "{failed:?}"
        );
    }
    assert!(failed.contains(&"mass-ratio-estimate"), "{failed:?}");
}

#[test]
fn the_last_place_of_one_number_is_seen() {
    let findings = spoilt(|cell| {
        let own = cell.quantity == 2 && cell.at == 64.0;
        if let (true, Ok(reading)) = (own, &mut cell.told) {
            reading.value = reading.value.next_up();
        }
    });
    assert_eq!(failed(&findings), ["power-of-two-floor"]);
}

#[test]
fn an_estimate_too_small_is_seen_in_every_row() {
    let findings = spoilt(|cell| {
        if let Ok(reading) = &mut cell.told {
            reading.estimate /= 1000.0;
        }
    });
    let failed = failed(&findings);
    for key in QUICK {
        assert!(
            failed.contains(&format!("{key}-estimate").as_str()),
            "{failed:?}"
        );
    }
    assert!(failed.contains(&"estimates"), "{failed:?}");
}

/// A hundred times larger no estimate is wrong, but they say nothing.
#[test]
fn estimates_that_say_nothing_are_seen() {
    let findings = spoilt(|cell| {
        if let Ok(reading) = &mut cell.told {
            reading.estimate *= 100.0;
        }
    });
    assert_eq!(failed(&findings), ["estimates"]);
}

#[test]
fn a_refusal_without_need_is_seen() {
    let findings = spoilt(|cell| {
        if cell.at == 1e-3 {
            cell.told = Err("too hard".to_owned());
        }
    });
    let failed = failed(&findings);
    assert!(failed.contains(&"limit-four-bar-floor"), "{failed:?}");
    // Where the condition is above 1e8 it would be an answer: ½m′ at 1e-3, but not m at 1e-2.
    assert!(failed.contains(&"flat-parallelogram-floor"), "{failed:?}");
}
