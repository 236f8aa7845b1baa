//! The findings of `dwell validate` on every case: verdicts and digits, and how far within them the numbers are.

use dwell_findings::{Finding, all_pass};
use dwell_scene::Scene;
use dwell_study::no_progress;
use dwell_tests::fixtures::{case_names, repository_root, scene, space_case_names, space_scene};
use dwell_validation::{Validation, validate};
use serde_json::Value;
use std::fmt::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The validation of a scene with the reference of a case.
fn validated(scene: impl Into<Scene>, case: &str) -> Validation {
    let scene = scene.into();
    let folder = repository_root().join("validation").join(match scene {
        Scene::Plane(_) => case,
        Scene::Space(_) => "spatial",
    });
    validate(&scene, &folder, None, &no_progress).unwrap_or_else(|e| panic!("{case}: {e}"))
}

/// Digits that every machine reproduces, in steps of three: the difference, four times as large (its last bits are a machine's
/// own), is within them. More than twelve are nobody's business; where the tolerance is wider than 1e-12 the
/// difference is that of an approximation, which has nine at the most.
fn digits(finding: &Finding) -> usize {
    let limit = if finding.tolerance <= 1.5e-12 { 12 } else { 9 };
    let holds = |n: &usize| 4.0 * finding.relative_difference <= 10f64.powi(-(*n as i32));
    let mut steps = [12, 9, 6, 3].into_iter().filter(|n| *n <= limit);
    steps.find(holds).unwrap_or(0)
}

fn describe(findings: &[Finding]) -> String {
    findings.iter().fold(String::new(), |mut text, f| {
        let status = if f.pass { "pass" } else { "FAIL" };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{status}  {:2} digits  {}  [{}]",
            digits(f),
            f.key,
            f.check
        );
        text
    })
}

/// A case against its snapshot, and its values against the committed report.
fn assert_snapshot(case: &str, validation: &Validation) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    let findings = describe(&validation.outcome.findings);
    settings.bind(|| insta::assert_snapshot!(format!("findings-{case}"), findings));
    assert!(all_pass(&validation.outcome.findings), "{case}: {findings}");
    let report = repository_root()
        .join("reports")
        .join(format!("{case}.txt"));
    let committed = std::fs::read_to_string(report).unwrap_or_default();
    assert!(
        committed.replace("\r\n", "\n") == validation.snapshot,
        "{case}: reports/{case}.txt is another; `dwell validate {case}` writes it anew, `git diff` shows what changed"
    );
}

#[test]
fn val_every_case_has_the_verdicts_digits_and_values_it_had() {
    let planar = case_names();
    let in_space = space_case_names();
    assert!(planar.len() >= 27 && in_space.len() >= 20, "{planar:?}");
    // All of them, so that one run tells everything that changed.
    let of_case = |case: &String| {
        let done = || match in_space.contains(case) {
            true => validated(space_scene(case), case),
            false => validated(scene(case), case),
        };
        catch_unwind(AssertUnwindSafe(|| assert_snapshot(case, &done()))).is_err()
    };
    let all = planar.iter().chain(&in_space);
    let changed: Vec<&String> = all.filter(|case| of_case(case)).collect();
    assert!(changed.is_empty(), "{changed:?}");
}

#[test]
fn scenes_of_the_project_warn_of_nothing() {
    let planar = case_names()
        .into_iter()
        .map(|case| Scene::from(scene(&case)));
    let in_space = space_case_names().into_iter();
    let in_space = in_space.map(|case| Scene::from(space_scene(&case)));
    for scene in planar.chain(in_space) {
        assert!(
            scene.warnings.is_empty(),
            "{}: {:?}",
            scene.name,
            scene.warnings
        );
    }
}

#[test]
fn digits_are_rounded_down_with_room_and_never_more_than_asked() {
    let done = validated(scene("pendulum-a01"), "pendulum-a01");
    let finding = |relative: f64, tolerance: f64| {
        let some = done.outcome.findings[0].clone();
        digits(&Finding {
            relative_difference: relative,
            tolerance,
            ..some
        })
    };
    assert_eq!(finding(3e-16, 1e-12), 12);
    assert_eq!(finding(2e-13, 1e-12), 12);
    assert_eq!(finding(3e-13, 1e-12), 9);
    assert_eq!(finding(3e-16, 1e-11), 9);
    assert_eq!(finding(0.3, 1.0), 0);
    assert_eq!(finding(f64::NAN, 1.0), 0);
}

/// The single-dwell reaches what the project promises of it, whatever tolerance its findings have.
#[test]
fn val_single_dwell_reaches_what_is_promised() {
    let done = validated(scene("single-dwell"), "single-dwell");
    let findings = &done.outcome.findings;
    let docs = repository_root().join("docs/first-study.md");
    let docs = std::fs::read_to_string(docs).expect("the study");
    let count = format!("has {} findings about its results", findings.len());
    assert!(docs.contains(&count), "first-study.md: {count}");
    let finding = |key: &str| {
        let found = findings.iter().find(|f| f.key == key);
        found.unwrap_or_else(|| panic!("no finding {key}"))
    };
    for (key, max) in [
        ("m-energy", 1e-14),
        ("half-dm-differences", 1e-11),
        ("half-dm-spectral", 1e-12),
        ("a-released", 1e-10),
        ("b-released", 1e-10),
        ("energy-bdf", 1e-9),
    ] {
        let reached = finding(key).relative_difference;
        assert!(reached <= max, "{key}: {reached:e}, promised {max:e}");
    }
    let bdf = finding("period-bdf");
    assert_eq!(bdf.unit, "s");
    assert!(
        bdf.absolute_difference <= 1e-9,
        "period by BDF: off by {:e} s",
        bdf.absolute_difference
    );
    let json = done
        .outcome
        .files
        .iter()
        .find(|(p, _)| p.ends_with("single-dwell.json"));
    let numbers: Value = serde_json::from_slice(json.expect("the numbers").1).expect("JSON");
    let number = |key: &str| numbers[key].as_f64().expect("a number");
    let period = number("period_s");
    assert!((period - 5.419_662_677_064_27).abs() <= 1e-11, "{period}");
    assert!(number("convergence_slope") >= 0.6);
    assert_eq!(numbers["passed"], Value::Bool(true));
}

/// A scene that is not the published one fails where it is held against published values, however
/// little it differs; what it is held against itself still agrees.
fn assert_detected(path: &str) {
    let scene = scene("single-dwell");
    let value = scene.value(path).expect("a number");
    let other = scene.with_value(path, value * (1.0 + 1e-9));
    let validation = validated(other.expect("a scene"), "single-dwell");
    assert!(!all_pass(&validation.outcome.findings));
    let failed = validation.outcome.findings.iter().filter(|f| !f.pass);
    let keys: Vec<&str> = failed.map(|f| f.key.as_str()).collect();
    assert!(keys.contains(&"published-m"), "{path}: {keys:?}");
    let of_reference = |key: &&str| key.starts_with("published-") || **key == *"period-quadrature";
    assert!(keys.iter().all(of_reference), "{path}: {keys:?}");
    assert!(validation.outcome.summary.contains("FAIL published-m"));
    assert!(validation.snapshot.contains("FAIL  published-m"));
}

#[test]
fn a_mass_off_by_a_billionth_is_caught() {
    assert_detected("coupler.mass");
}

#[test]
fn an_inertia_off_by_a_billionth_is_caught() {
    assert_detected("crank.inertia");
}

#[test]
fn a_length_off_by_a_billionth_is_caught() {
    assert_detected("crank.points.B[0]");
}
