//! The study of extremes sees what it is there to see.

use dwell_findings::Finding;
use dwell_validation::extremes::{SeriesResult, all_series, check, evaluate};
use std::sync::LazyLock;

/// Rows that take little time, of every family.
const QUICK: [&str; 13] = [
    "limit-four-bar",
    "flat-parallelogram",
    "mass-ratio",
    "power-of-two",
    "speed",
    "tolerance-tsit45",
    "stiffness",
    "light-crank",
    "rotation",
    "short-crank",
    "peak-between-rows",
    "gear-ratio",
    "jamming",
];

static RESULTS: LazyLock<Vec<SeriesResult>> = LazyLock::new(evaluated);

fn evaluated() -> Vec<SeriesResult> {
    let quick = all_series(false).into_iter();
    evaluate(
        quick
            .filter(|series| QUICK.contains(&series.key.as_str()))
            .collect(),
    )
}

/// The rows again, each with some of its cells changed.
fn findings_with(change: impl Fn(&mut dwell_validation::extremes::ResultCell)) -> Vec<Finding> {
    let cells = RESULTS.iter().map(|m| m.cells.clone());
    let all_series = all_series(false).into_iter();
    let all_series = all_series.filter(|series| QUICK.contains(&series.key.as_str()));
    let mut results: Vec<SeriesResult> = all_series
        .zip(cells)
        .map(|(series, cells)| SeriesResult { series, cells })
        .collect();
    results
        .iter_mut()
        .flat_map(|m| &mut m.cells)
        .for_each(change);
    check(&results)
}

fn failed(findings: &[Finding]) -> Vec<&str> {
    let failed = findings.iter().filter(|f| !f.pass);
    failed.map(|f| f.key.as_str()).collect()
}

/// Of slow motions, light cranks and pendulums near the separatrix too, in which the workbench once had no
/// digits or no answer.
#[test]
fn val_the_floors_and_the_estimates_hold() {
    let findings = check(&RESULTS);
    assert_eq!(findings.len(), 2 * QUICK.len() + 1);
    assert_eq!(failed(&findings), Vec::<&str>::new());
}

/// Seven digits instead of sixteen: every row that promises more is below its floor, and every estimate is
/// below the error.
#[test]
fn the_noise_of_short_numbers_is_seen() {
    let findings = findings_with(|cell| {
        if let Ok(value) = &mut cell.result {
            value.value = f64::from(value.value as f32 * (1.0 + f32::EPSILON));
        }
    });
    let failed = failed(&findings);
    for key in [
        "limit-four-bar",
        "mass-ratio",
        "power-of-two",
        "stiffness",
        "rotation",
    ] {
        assert!(
            failed.contains(&format!("{key}-digits").as_str()),
            "{failed:?}"
        );
    }
    assert!(failed.contains(&"mass-ratio-error-estimate"), "{failed:?}");
}

#[test]
fn the_last_place_of_one_number_is_seen() {
    let findings = findings_with(|cell| {
        let is_target = cell.quantity == 2 && cell.parameter == 64.0;
        if let (true, Ok(value)) = (is_target, &mut cell.result) {
            value.value = value.value.next_up();
        }
    });
    assert_eq!(failed(&findings), ["power-of-two-digits"]);
}

#[test]
fn an_estimate_too_small_is_seen_in_every_row() {
    let findings = findings_with(|cell| {
        if let Ok(value) = &mut cell.result {
            value.error_estimate /= 1000.0;
        }
    });
    let failed = failed(&findings);
    for key in QUICK {
        assert!(
            failed.contains(&format!("{key}-error-estimate").as_str()),
            "{failed:?}"
        );
    }
    assert!(failed.contains(&"error-estimates"), "{failed:?}");
}

/// A hundred times larger no estimate is wrong, but they say nothing.
#[test]
fn estimates_that_say_nothing_are_seen() {
    let findings = findings_with(|cell| {
        if let Ok(value) = &mut cell.result {
            value.error_estimate *= 100.0;
        }
    });
    assert_eq!(failed(&findings), ["error-estimates"]);
}

#[test]
fn a_refusal_without_need_is_seen() {
    let findings = findings_with(|cell| {
        if cell.parameter == 1e-3 {
            cell.result = Err("too hard".to_owned());
        }
    });
    let failed = failed(&findings);
    assert!(failed.contains(&"limit-four-bar-digits"), "{failed:?}");
    // Where the condition is above 1e8 it would be an answer: ½m′ at 1e-3, but not m at 1e-2.
    assert!(failed.contains(&"flat-parallelogram-digits"), "{failed:?}");
}

/// A linkage 1e9 crank lengths away is the linkage at the origin, in double and in single precision.
#[test]
fn places_in_space_do_not_matter() {
    let all = all_series(false).into_iter();
    let results = evaluate(
        all.filter(|s| s.key.starts_with("place-in-space"))
            .collect(),
    );
    let digits = |result: &SeriesResult| {
        let digits = result.cells.iter().filter_map(|cell| cell.digits());
        digits.fold(f64::INFINITY, f64::min)
    };
    let fewest: Vec<f64> = results.iter().map(digits).collect();
    println!("fewest digits: {fewest:?}");
    assert_eq!(failed(&check(&results)), Vec::<&str>::new(), "{fewest:?}");
    let [double, single] = fewest[..] else {
        panic!("{fewest:?}");
    };
    assert!(double > 13.0 && single > 4.0, "{fewest:?}");
}
