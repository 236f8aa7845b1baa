//! Verdicts and tables of invented findings.
#![allow(clippy::expect_used, reason = "tests")]

use super::*;
use crate::cases::reference::SourceKinds;
use dwell_findings::Finding;

fn finding(check: Check, relative: f64, tolerance: f64) -> Finding {
    Finding {
        key: format!("key-{}", check.number()),
        check,
        comparison: "m with 2 E_c".into(),
        domain: "24 positions".into(),
        absolute_difference: 2.0 * relative,
        unit: "kg m2".into(),
        relative_difference: relative,
        scale: "the largest m".into(),
        worst_at: "phi = 1 rad".into(),
        tolerance,
        pass: relative <= tolerance,
        ..Finding::default()
    }
}

fn validation(findings: Vec<Finding>) -> Validation {
    let mut done = Validation {
        source_kinds: SourceKinds::default(),
        not_applicable: vec![(Check::Period, "driven")],
        ..Validation::default()
    };
    done.outcome.findings = findings;
    done
}

#[test]
fn a_check_has_its_nearest_finding_or_the_reason_for_none() {
    let done = validation(vec![
        finding(Check::KineticEnergy, 1e-15, 1e-14),
        finding(Check::KineticEnergy, 1e-13, 2e-13),
        finding(Check::EnergySlope, 0.0, 1e-12),
        finding(Check::ReleasedConstraint, 1e-9, 1e-12),
        finding(Check::ReleasedConstraint, 1e-15, 1e-12),
    ]);
    let cells = check_cells(&done);
    assert_eq!(cells[0], CheckCell::NotApplicable("nothing"));
    let texts = cells.map(|cell| match cell {
        CheckCell::Nearest(f) => (f.pass, margin_text(margin(f))),
        CheckCell::NotApplicable(why) => (true, why.to_owned()),
    });
    assert_eq!(texts[1], (true, "2.0".to_owned()));
    assert_eq!(texts[2], (true, "=".to_owned()));
    assert_eq!(texts[3], (false, "0.0".to_owned()));
    assert_eq!(texts[5], (true, "driven".to_owned()));
}

#[test]
fn margins_have_four_letters_at_most() {
    let texts = [1.04, 9.96, 37.2, 999.4, 1000.0, 3.2e12].map(margin_text);
    assert_eq!(texts, ["1.0", "10", "37", "999", "10³", "10¹²"]);
}

#[test]
fn a_failure_names_the_equation_the_place_and_the_difference() {
    let [equation, location, difference] =
        describe_failure(&finding(Check::KineticEnergy, 3e-9, 1e-12));
    assert_eq!(equation, "check 1 kinetic energy, m with 2 E_c");
    assert_eq!(location, "at phi = 1 rad, of 24 positions");
    assert_eq!(
        difference,
        "difference 6.00e-9 kg m2, 3.0e-9 of the largest m; tolerance 1.0e-12"
    );
    let [.., difference] = describe_failure(&finding(Check::KineticEnergy, f64::NAN, 1e-12));
    assert_eq!(difference, "difference none could be taken");
}

/// A case in the plane.
fn judged<'a>(name: &'a str, result: Result<&'a Validation, String>) -> ValidatedCase<'a> {
    ValidatedCase {
        name,
        title: "A bar",
        in_space: false,
        result,
    }
}

fn text(of: &Outcome, name: &str) -> String {
    let file = of.files.iter().find(|(path, _)| path.ends_with(name));
    String::from_utf8(file.expect("a file").1.to_vec()).expect("text")
}

#[test]
fn the_index_shows_failures_loose_tolerances_and_cases_that_were_not_validated() {
    let done = validation(vec![
        finding(Check::KineticEnergy, 1e-16, 1e-9),
        finding(Check::EnergySlope, 1e-9, 1e-12),
    ]);
    let lost = Err("it cannot be read".to_owned());
    let all = ValidationRun {
        cases: vec![judged("bar", Ok(&done)), judged("cases/lost", lost)],
        studies: Vec::new(),
        no_reader: None,
        manual: Some([3, 3]),
    };
    let outcome = index(&all);
    let tables = text(&outcome, "cases.md");
    for part in [
        "| 10⁷ | **FAIL** key-2 |",
        "| driven |",
        "- `bar` key-2: check 2 energy slope, m with 2 E_c; at phi = 1 rad, of 24 positions; difference 2.00e-9 kg m2",
        "| 1 of 2 | 0.0 of key-2 | key-1 |",
        "| `cases/lost` | **not validated** |",
        "- `cases/lost`: it cannot be read",
    ] {
        assert!(tables.contains(part), "{part}\n{tables}");
    }
    let verdict = text(&outcome, "index.md");
    let lines: Vec<&str> = verdict.lines().collect();
    assert_eq!(lines[0], "# FAIL: bar, check 2 energy slope, key-2");
    assert!(
        lines[2].starts_with("Worst: **bar**, check 2 energy slope, `key-2`"),
        "{verdict}"
    );
    assert!(
        verdict.contains("| cases in the plane | **FAIL** | 0 of 2 |"),
        "{verdict}"
    );
    let page = text(&outcome, "index.html");
    for part in [
        "<h1>FAIL: bar, check 2 energy slope, key-2</h1>",
        "<a href=\"bar.html#check=1\" title=\"key-1: 1.0e-16, tolerance 1.0e-9\">10⁷</a>",
        "title=\"key-2: 1.0e-9, tolerance 1.0e-12\">FAIL key-2</a>",
        "<td class=\"none\" title=\"driven\">",
        "not validated: it cannot be read",
    ] {
        assert!(page.contains(part), "{part}\n{page}");
    }
    assert!(
        outcome
            .pictures
            .iter()
            .any(|picture| picture.path == "index.png")
    );
}

#[test]
fn the_verdict_has_twenty_lines_and_names_what_is_nearest_to_its_tolerance() {
    let near = validation(vec![
        finding(Check::Power, 1e-13, 1.5e-13),
        finding(Check::Momentum, 0.0, 1e-12),
    ]);
    let far = [finding(Check::ClosedForms, 1e-15, 1e-12)];
    let all = ValidationRun {
        cases: vec![judged("bar", Ok(&near))],
        studies: vec![("extremes", &far)],
        no_reader: None,
        manual: Some([3, 3]),
    };
    let verdict = text(&index(&all), "index.md");
    let lines: Vec<&str> = verdict.lines().collect();
    assert_eq!(
        lines[0],
        "# PASS: 1 of 1 cases in the plane, 1 of 1 extremes"
    );
    assert!(
        lines[2].contains("**bar**, check 4 power, `key-4`: margin **1.5**"),
        "{verdict}"
    );
    assert!(lines.len() <= 20, "{verdict}");
    // An incomplete run does not pass.
    let verdict = text(
        &index(&ValidationRun {
            no_reader: None,
            manual: Some([2, 3]),
            ..all
        }),
        "index.md",
    );
    assert!(verdict.starts_with("# FAIL: 2 of 3 manual"), "{verdict}");
}
