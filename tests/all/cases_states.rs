//! Every case of `validation/`: judged in states of motion, by its reference, and by deliberate
//! faults that must be found.

use crate::world::{cases, home, scene};
use dwell_findings::Finding;
use dwell_geometry::Mechanism;
use dwell_scene::Scene;
use dwell_study::{Judged, Validation, judge_case, silent, validate};
use dwell_verify::{State, judge_states};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// The case whose joints repeat each other.
const REPEATED: &str = "parallelogram-three-cranks";

/// Cases whose references hold no states: the first two are of the reduced model, the others of motions.
const WITHOUT_STATES: [&str; 4] = [
    "crank-rocker",
    "single-dwell",
    "double-pendulum",
    "slider-crank-friction",
];

/// Relative difference that every reference must be met to.
const PROMISED: f64 = 1e-12;

fn folder(case: &str) -> PathBuf {
    home().join("validation").join(case)
}

fn judged(scene: &Scene, folder: &Path) -> Judged {
    judge_case(scene, folder).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

fn failed(findings: &[Finding]) -> Vec<&str> {
    let failed = findings.iter().filter(|f| !f.pass);
    failed.map(|f| f.key.as_str()).collect()
}

const TRUTHS: [&str; 9] = [
    "state-poses",
    "state-branch",
    "state-velocities",
    "state-accelerations",
    "state-reactions",
    "state-newton",
    "state-differenced",
    "state-power",
    "state-balance",
];

#[test]
fn val_every_case_in_states_and_by_its_reference() {
    for case in cases() {
        let scene = scene(&case);
        let judged = judged(&scene, &folder(&case));
        assert!(judged.states.len() >= 100, "{case}");
        for finding in &judged.findings {
            assert!(finding.pass, "{case}: {finding:?}");
        }
        let keys: Vec<&str> = judged.findings.iter().map(|f| f.key.as_str()).collect();
        assert_eq!(keys[..9], TRUTHS, "{case}");
        for key in ["state-power", "state-balance"] {
            let finding = judged.findings.iter().find(|f| f.key == key).expect("it");
            assert!(finding.relative <= PROMISED, "{case}: {finding:?}");
        }
        if !WITHOUT_STATES.contains(&case.as_str()) {
            for kind in [
                "positions",
                "velocities",
                "accelerations",
                "reactions",
                "actions",
            ] {
                // None of its reactions is determined.
                if (case.as_str(), kind) == (REPEATED, "reactions") {
                    continue;
                }
                let key = format!("reference-{kind}");
                let finding = judged.findings.iter().find(|f| f.key == key);
                let relative = finding.unwrap_or_else(|| panic!("{case}: {key}")).relative;
                assert!(relative <= PROMISED, "{case}, {key}: {relative:e}");
            }
        }
    }
}

#[test]
fn val_andrews_published_start() {
    let judged = judged(&scene("andrews"), &folder("andrews"));
    for kind in ["positions", "accelerations", "reactions"] {
        let key = format!("published-{kind}");
        let finding = judged.findings.iter().find(|f| f.key == key);
        let finding = finding.unwrap_or_else(|| panic!("{key}"));
        assert!(finding.relative <= PROMISED, "{finding:?}");
        assert!(finding.over.contains("andrews.f"), "{finding:?}");
    }
}

/// Each truth of a case speaks or says why not, passes, and has no slack in its tolerance.
fn speaks(case: &str, done: &Validation) {
    let findings = &done.outcome.findings;
    for number in 0..=9 {
        let spoken = findings.iter().any(|f| f.number() == Some(number));
        let silent = done.silent.iter().any(|(silent, _)| *silent == number);
        assert!(spoken != silent, "{case}: truth {number}");
        // These can always be held against a case.
        assert!(
            spoken || [3, 5, 9].contains(&number),
            "{case}: truth {number}"
        );
    }
    for f in findings {
        assert!(f.pass && f.number().is_some(), "{case}: {f:?}");
        let most = f.most();
        assert!(
            !f.slack(),
            "{case}, {}: {:e} where {most:e} is the most",
            f.key,
            f.tolerance
        );
    }
}

/// Every case passes with tolerances that are near to what is met, and its rounded text is the committed one.
#[test]
fn regress_reports() {
    for case in cases() {
        let done = validate(&scene(&case), &folder(&case), &silent);
        let done = done.unwrap_or_else(|e| panic!("{case}: {e}"));
        speaks(&case, &done);
        let text = done.snapshot;
        let path = home().join("reports").join(format!("{case}.txt"));
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
    for case in cases() {
        let scene = scene(&case);
        let Judged { start, states, .. } = judged(&scene, &folder(&case));
        let largest = |of: &dyn Fn(usize, usize) -> f64, bodies: usize| {
            let all = (0..states.len()).flat_map(|s| (0..bodies).map(move |b| (s, b)));
            all.map(|(s, b)| of(s, b).abs()).fold(0.0, f64::max)
        };
        let couple = |b: usize| {
            let alpha = |s: usize, _: usize| states[s].acceleration[b][2];
            scene.masses[b].inertia * largest(&alpha, 1)
        };
        let bodies: Vec<usize> = (0..scene.masses.len())
            .filter(|&b| couple(b) > 0.0)
            .collect();
        let strongest = bodies.iter().map(|&b| couple(b)).fold(0.0, f64::max);
        for b in bodies {
            let mut masses = scene.masses.clone();
            masses[b].inertia *= 1.0 + 1e-6;
            let findings = judge_states(&scene.mechanism, &masses, &start, &states);
            let failed = failed(&findings);
            // A body that hardly turns shows it where all forces are small, or not at all.
            let shows = couple(b) > 1e-2 * strongest;
            assert!(
                !shows || failed.contains(&"state-newton"),
                "{case}, body {b}"
            );
            // The motion is right, and so is what does not know of inertia.
            for right in &TRUTHS[..4] {
                assert!(!failed.contains(right), "{case}, body {b}: {failed:?}");
            }
        }
    }
}

/// Forces that no load determines must balance all the same, and a joint that only repeats others
/// must close.
#[test]
fn what_repeats_is_judged_too() {
    let scene = scene(REPEATED);
    let case = judged(&scene, &folder(REPEATED));
    let judge = |mechanism: &Mechanism, states: &[State]| {
        judge_states(mechanism, &scene.masses, &case.start, states)
    };
    let mut states = case.states.clone();
    for state in &mut states {
        state.reactions[10] *= 1.0 + 1e-6;
    }
    let findings = judge(&scene.mechanism, &states);
    let found = failed(&findings);
    assert!(found.contains(&"state-newton"), "{found:?}");
    // The dense side does not know this reaction by itself.
    assert!(!found.contains(&"state-reactions"), "{found:?}");
    for joint in 0..scene.mechanism.joints.len() {
        let mut mechanism = scene.mechanism.clone();
        mechanism.joints[joint].points[0].x += 1e-8;
        let findings = judge(&mechanism, &case.states);
        assert_eq!(failed(&findings).len(), 9, "joint {joint}");
        let words = &findings[0].worst;
        assert!(words.contains("stay open"), "joint {joint}: {words}");
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
        let findings = judged(&other, &folder(case)).findings;
        let failed = failed(&findings);
        assert!(
            failed.contains(&"reference-reactions"),
            "{case}: {failed:?}"
        );
        assert!(failed.contains(&"reference-actions"), "{case}: {failed:?}");
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
        ("boom", 0, "dig.action", "reference-actions"),
        ("cam", 1, "rise.speed", "reference-velocities"),
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
            let off = number(&values[name]) * (1.0 + 1e-9);
            values[name] = Value::from(format!("{off:e}"));
        });
        let findings = judged(&scene(case), &changed.0).findings;
        assert_eq!(failed(&findings), [key], "{case}, {name}");
        let finding = findings.iter().find(|f| f.key == key).expect("it");
        assert!(finding.worst.starts_with(name), "{finding:?}");
    }
}

/// A published state of a motion is put off by a little more than its tolerance.
#[test]
fn a_published_motion_that_is_put_off_is_found() {
    for (case, name, off) in [
        ("andrews", "beta", 2e-9),
        ("andrews", "E-k3.x", 2e-9),
        ("double-pendulum", "q.speed", 2e-9),
        ("n-four-bar-a02", "phi", 2e-10),
        ("pendulum-a01", "A.x", 2e-10),
    ] {
        let changed = Changed::new(case, |reference| {
            let values = &mut reference["free_motion"]["states"][0]["values"];
            let off = number(&values[name]) * (1.0 + off);
            values[name] = Value::from(format!("{off:e}"));
        });
        let done = validate(&scene(case), &changed.0, &silent).expect("findings");
        let findings = done.outcome.findings;
        assert_eq!(failed(&findings), ["published-motion"], "{case}, {name}");
        let finding = findings.iter().find(|f| !f.pass).expect("it");
        assert_eq!(finding.worst, name);
    }
    let changed = Changed::new("andrews", |reference| {
        reference["free_motion"]["states"][0]["values"]["gamma"] = Value::from("1.0");
    });
    let error = validate(&scene("andrews"), &changed.0, &silent).expect_err("no such name");
    assert!(error.to_string().contains("`gamma`"), "{error}");
}

#[test]
fn a_name_that_is_nothing_fails_and_is_told() {
    for name in [
        "k3.angel",
        "k9.angle",
        "E-k3.z",
        "k3.Q.x",
        "alpha.action",
        "O.travel",
        "k3",
    ] {
        let changed = Changed::new("andrews", |reference| {
            reference["samples"][0]["values"][name] = Value::from("1.0");
        });
        let findings = judged(&scene("andrews"), &changed.0).findings;
        assert_eq!(failed(&findings), ["reference-names"], "{name}");
        let finding = findings.iter().find(|f| !f.pass).expect("it");
        assert!(finding.worst.contains(&format!("`{name}`")), "{finding:?}");
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
        let error = judge_case(&scene("andrews"), &changed.0).expect_err(words);
        assert!(error.to_string().contains(words), "{error} for {words}");
    }
}
