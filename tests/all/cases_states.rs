//! Every case of `validation/`: judged in states of motion, by its reference, and by deliberate
//! faults that must be found.

use dwell_findings::{Check, Finding};
use dwell_geometry::Mechanism;
use dwell_scene::PlaneScene;
use dwell_study::no_progress;
use dwell_tests::fixtures::{case_names, repository_root, scene};
use dwell_validation::{CheckedStates, Validation, check_case, validate};
use dwell_verify::{AssembledMechanism, CheckedMechanism, ClaimedState, check_states};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// The case whose joints repeat each other.
const REDUNDANT: &str = "parallelogram-three-cranks";

/// Cases whose references hold no states: the first two are of the reduced model, the others of motions.
const WITHOUT_STATES: [&str; 8] = [
    "exported-model",
    // Their states are judged by the dense equations alone.
    "expressions",
    "laws",
    "press",
    "crank-rocker",
    "single-dwell",
    "double-pendulum",
    "slider-crank-friction",
];

/// Relative difference that every reference must be met to.
const PROMISED: f64 = 1e-12;

fn folder(case: &str) -> PathBuf {
    repository_root().join("validation").join(case)
}

fn checked_states(scene: &PlaneScene, folder: &Path) -> CheckedStates {
    check_case(scene, folder).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

fn failed(findings: &[Finding]) -> Vec<&str> {
    let failed = findings.iter().filter(|f| !f.pass);
    failed.map(|f| f.key.as_str()).collect()
}

const CHECKS: [&str; 9] = [
    "state-poses",
    "state-branch",
    "state-velocities",
    "state-accelerations",
    "state-reactions",
    "state-newton-euler",
    "state-newton-euler-differences",
    "state-power",
    "state-momentum",
];

#[test]
fn val_every_case_in_states_and_by_its_reference() {
    for case in case_names() {
        let scene = scene(&case);
        let checked = checked_states(&scene, &folder(&case));
        assert!(checked.states.len() >= 100, "{case}");
        for finding in &checked.findings {
            assert!(finding.pass, "{case}: {finding:?}");
        }
        let keys: Vec<&str> = checked.findings.iter().map(|f| f.key.as_str()).collect();
        assert_eq!(keys[..9], CHECKS, "{case}");
        for key in ["state-power", "state-momentum"] {
            let finding = checked.findings.iter().find(|f| f.key == key).expect("it");
            assert!(
                finding.relative_difference <= PROMISED,
                "{case}: {finding:?}"
            );
        }
        if !WITHOUT_STATES.contains(&case.as_str()) {
            for kind in [
                "positions",
                "velocities",
                "accelerations",
                "reactions",
                "actuator-forces",
            ] {
                // None of its reactions is determined.
                if (case.as_str(), kind) == (REDUNDANT, "reactions") {
                    continue;
                }
                let key = format!("reference-{kind}");
                let finding = checked.findings.iter().find(|f| f.key == key);
                let relative = finding
                    .unwrap_or_else(|| panic!("{case}: {key}"))
                    .relative_difference;
                assert!(relative <= PROMISED, "{case}, {key}: {relative:e}");
            }
        }
    }
}

#[test]
fn val_andrews_published_start() {
    let checked = checked_states(&scene("andrews"), &folder("andrews"));
    for kind in ["positions", "accelerations", "reactions"] {
        let key = format!("published-{kind}");
        let finding = checked.findings.iter().find(|f| f.key == key);
        let finding = finding.unwrap_or_else(|| panic!("{key}"));
        assert!(finding.relative_difference <= PROMISED, "{finding:?}");
        assert!(finding.domain.contains("andrews.f"), "{finding:?}");
    }
}

/// Each truth of a case speaks or says why not, passes, and has no slack in its tolerance.
fn assert_all_checks(case: &str, validation: &Validation) {
    let findings = &validation.outcome.findings;
    for check in &Check::ALL[..10] {
        let has_findings = findings.iter().any(|f| f.check == *check);
        let not_applicable = validation.not_applicable.iter().any(|(of, _)| of == check);
        assert!(has_findings != not_applicable, "{case}: check {check}");
        // These can always be held against a case.
        assert!(
            has_findings
                || [
                    Check::ReleasedConstraint,
                    Check::Period,
                    Check::ReferenceValues
                ]
                .contains(check),
            "{case}: check {check}"
        );
    }
    for f in findings {
        assert!(f.pass, "{case}: {f:?}");
        let max = f.max_tolerance();
        assert!(
            !f.is_loose(),
            "{case}, {}: {:e} where {max:e} is the most",
            f.key,
            f.tolerance
        );
    }
}

/// Every case passes with tolerances that are near to what is met, and its rounded text is the committed one.
#[test]
fn regress_reports() {
    for case in case_names() {
        let done = validate(&scene(&case).into(), &folder(&case), None, &no_progress);
        let done = done.unwrap_or_else(|e| panic!("{case}: {e}"));
        assert_all_checks(&case, &done);
        let text = done.snapshot;
        let path = repository_root()
            .join("reports")
            .join(format!("{case}.txt"));
        let committed = std::fs::read_to_string(&path);
        let committed = committed.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        assert!(
            text == committed,
            "{case} is no longer {}:\n{text}",
            path.display()
        );
    }
}

/// Reactions for another inertia do not balance, in whatever body that is.
#[test]
fn an_inertia_off_by_a_millionth_is_found_in_every_case() {
    for case in case_names() {
        let scene = scene(&case);
        let checked = checked_states(&scene, &folder(&case));
        let states = &checked.states;
        let largest = |of: &dyn Fn(usize, usize) -> f64, bodies: usize| {
            let all = (0..states.len()).flat_map(|s| (0..bodies).map(move |b| (s, b)));
            all.map(|(s, b)| of(s, b).abs()).fold(0.0, f64::max)
        };
        let couple = |b: usize| {
            let alpha = |s: usize, _: usize| states[s].accelerations[b].angular.z;
            scene.masses[b].inertia * largest(&alpha, 1)
        };
        let bodies: Vec<usize> = (0..scene.masses.len())
            .filter(|&b| couple(b) > 0.0)
            .collect();
        let strongest = bodies.iter().map(|&b| couple(b)).fold(0.0, f64::max);
        for b in bodies {
            let mut masses = scene.masses.clone();
            masses[b].inertia *= 1.0 + 1e-6;
            let mechanism = CheckedMechanism::Plane(&scene.mechanism, (&masses).into());
            let assembled = AssembledMechanism {
                mechanism,
                ..checked.assembled(&scene)
            };
            let findings = check_states(&assembled, states, 0);
            let failed = failed(&findings);
            // A body that hardly turns shows it where all forces are small, or not at all.
            let shows = couple(b) > 1e-2 * strongest;
            assert!(
                !shows || failed.contains(&"state-newton-euler"),
                "{case}, body {b}"
            );
            // The motion is right, and so is what does not know of inertia.
            for right in &CHECKS[..4] {
                assert!(!failed.contains(right), "{case}, body {b}: {failed:?}");
            }
        }
    }
}

/// Forces that no load determines must balance all the same, and a joint that only repeats others
/// must close.
#[test]
fn what_repeats_is_judged_too() {
    let scene = scene(REDUNDANT);
    let case = checked_states(&scene, &folder(REDUNDANT));
    let check_without = |mechanism: &Mechanism, states: &[ClaimedState]| {
        let assembled = AssembledMechanism {
            mechanism: CheckedMechanism::Plane(mechanism, (&scene.masses).into()),
            ..case.assembled(&scene)
        };
        check_states(&assembled, states, 0)
    };
    let mut states = case.states.clone();
    for state in &mut states {
        state.reactions[10] *= 1.0 + 1e-6;
    }
    let findings = check_without(&scene.mechanism, &states);
    let found = failed(&findings);
    assert!(found.contains(&"state-newton-euler"), "{found:?}");
    // The dense side does not know this reaction by itself.
    assert!(!found.contains(&"state-reactions"), "{found:?}");
    for joint in 0..scene.mechanism.joints.len() {
        let mut mechanism = scene.mechanism.clone();
        mechanism.joints[joint].points[0].x += 1e-8;
        let findings = check_without(&mechanism, &case.states);
        assert_eq!(failed(&findings).len(), 9, "joint {joint}");
        let text = &findings[0].worst_at;
        assert!(text.contains("have a residual"), "joint {joint}: {text}");
    }
}

/// The same in the scene, whose reactions then are those of another machine: only the reference
/// knows better.
#[test]
fn a_wrong_scene_is_found_by_its_reference_alone() {
    for (case, path) in [
        ("andrews", "k3.inertia"),
        ("jansen", "foot.inertia"),
        ("five-bar", "left-rod.inertia"),
    ] {
        let scene = scene(case);
        let value = scene.value(path).expect("a number");
        let other = scene
            .with_value(path, value * (1.0 + 1e-6))
            .expect("a scene");
        let findings = checked_states(&other, &folder(case)).findings;
        let failed = failed(&findings);
        assert!(
            failed.contains(&"reference-reactions"),
            "{case}: {failed:?}"
        );
        assert!(
            failed.contains(&"reference-actuator-forces"),
            "{case}: {failed:?}"
        );
        let known = |key: &&str| key.starts_with("reference-") || key.starts_with("published-");
        assert!(failed.iter().all(known), "{case}: {failed:?}");
    }
}

/// A folder with a changed reference.
struct Changed(PathBuf);

impl Changed {
    fn new(case: &str, change: impl FnOnce(&mut Value)) -> Self {
        let text = std::fs::read_to_string(folder(case).join("case.toml")).expect("a file");
        let mut reference: Value = toml::from_str(&text).expect("TOML");
        change(&mut reference);
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("dwell-changed-{}-{number}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&folder).expect("a folder");
        drop_nulls(&mut reference);
        let text = toml::to_string(&reference).expect("TOML");
        std::fs::write(folder.join("case.toml"), text).expect("a file");
        Self(folder)
    }
}

/// TOML knows no null: what is null is left out.
fn drop_nulls(value: &mut Value) {
    if let Value::Object(fields) = value {
        fields.retain(|_, value| !value.is_null());
    }
    let inside: Vec<&mut Value> = match value {
        Value::Object(fields) => fields.values_mut().collect(),
        Value::Array(entries) => entries.iter_mut().collect(),
        _ => Vec::new(),
    };
    inside.into_iter().for_each(drop_nulls);
}

impl Drop for Changed {
    fn drop(&mut self) {
        // What is left in the temporary folder does no harm.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn number(value: &Value) -> f64 {
    let text = value.as_str().expect("the text of a number");
    text.parse().expect("a number")
}

/// One of the larger values of a kind is put off, and no other finding minds.
#[test]
fn a_reference_value_off_by_a_billionth_is_found() {
    for (case, sample, name, key) in [
        ("andrews", 2, "k7.H.ay", "reference-accelerations"),
        ("andrews", 2, "E-k4.y", "reference-reactions"),
        ("boom", 0, "dig.actuator_force", "reference-actuator-forces"),
        ("cam", 1, "rise.velocity", "reference-velocities"),
        (
            "ellipse-trammel",
            0,
            "x-guide.travel",
            "reference-positions",
        ),
        ("whitworth", 2, "slot.travel", "reference-positions"),
        ("jansen", 1, "foot.angle", "reference-positions"),
        ("rolling-wheel", 1, "track.tangent", "reference-reactions"),
        ("massless-coupler", 1, "joint.moment", "reference-reactions"),
    ] {
        let changed = Changed::new(case, |reference| {
            let values = &mut reference["samples"][sample]["values"];
            let altered = number(&values[name]) * (1.0 + 1e-9);
            values[name] = Value::from(format!("{altered:e}"));
        });
        let findings = checked_states(&scene(case), &changed.0).findings;
        assert_eq!(failed(&findings), [key], "{case}, {name}");
        let finding = findings.iter().find(|f| f.key == key).expect("it");
        assert!(finding.worst_at.starts_with(name), "{finding:?}");
    }
}

/// A published state of a motion is put off by a little more than its tolerance.
#[test]
fn a_published_motion_that_is_put_off_is_found() {
    for (case, name, altered) in [
        ("andrews", "beta", 2e-9),
        ("andrews", "E-k3.x", 2e-9),
        ("double-pendulum", "q.velocity", 2e-9),
        ("n-four-bar-a02", "phi", 2e-10),
        ("pendulum-a01", "A.x", 2e-10),
    ] {
        let changed = Changed::new(case, |reference| {
            let values = &mut reference["free_motion"]["states"][0]["values"];
            let altered = number(&values[name]) * (1.0 + altered);
            values[name] = Value::from(format!("{altered:e}"));
        });
        let done = validate(&scene(case).into(), &changed.0, None, &no_progress).expect("findings");
        let findings = done.outcome.findings;
        assert_eq!(failed(&findings), ["published-motion"], "{case}, {name}");
        let finding = findings.iter().find(|f| !f.pass).expect("it");
        assert_eq!(finding.worst_at, name);
    }
    let changed = Changed::new("andrews", |reference| {
        reference["free_motion"]["states"][0]["values"]["gamma"] = Value::from("1.0");
    });
    let done = validate(&scene("andrews").into(), &changed.0, None, &no_progress);
    let error = done.expect_err("no such name");
    assert!(error.to_string().contains("`gamma`"), "{error}");
}

#[test]
fn a_name_that_is_nothing_fails_and_is_told() {
    for name in [
        "k3.angel",
        "k9.angle",
        "E-k3.z",
        "k3.Q.x",
        "alpha.actuator_force",
        "O.travel",
        "k3",
    ] {
        let changed = Changed::new("andrews", |reference| {
            reference["samples"][0]["values"][name] = Value::from("1.0");
        });
        let findings = checked_states(&scene("andrews"), &changed.0).findings;
        assert_eq!(failed(&findings), ["reference-unknown-names"], "{name}");
        let finding = findings.iter().find(|f| !f.pass).expect("it");
        assert!(
            finding.worst_at.contains(&format!("`{name}`")),
            "{finding:?}"
        );
    }
}

#[test]
fn a_reference_that_cannot_be_read_says_why() {
    type Change = fn(&mut Value);
    let changes: [(Change, &str); 6] = [
        (
            |r| r["samples"][0]["q"]["phi"] = Value::from("1"),
            "no actuator `phi`",
        ),
        (
            |r| r["samples"][1]["q_dot"] = Value::Null,
            "samples[1]: q_dot",
        ),
        (
            |r| r["samples"][1]["values"]["O.x"] = Value::from("x"),
            "`O.x` is not a number",
        ),
        (
            |r| r["samples"][1]["speed"] = Value::from("1"),
            "unknown key `speed`",
        ),
        (
            |r| r["tolerance"]["relative"] = Value::Null,
            "tolerance: `relative` is missing",
        ),
        (
            |r| r["published"]["samples"][0]["q"] = Value::Null,
            "published: samples[0]: q",
        ),
    ];
    for (change, words) in changes {
        let changed = Changed::new("andrews", change);
        let error = check_case(&scene("andrews"), &changed.0).expect_err(words);
        assert!(error.to_string().contains(words), "{error} for {words}");
    }
}
