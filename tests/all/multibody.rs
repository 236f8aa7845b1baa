//! Every motion of `validation/` against the full multibody equations and published values, and by
//! deliberate faults that must be found.

use dwell_findings::Finding;
use dwell_scene::PlaneScene;
use dwell_tests::fixtures::{case_names, repository_root, scene};
use dwell_validation::{FreeMotionRun, free_motion_run};
use std::time::Instant;

/// The cases that have a motion, and what is special about it.
const CASES_WITH_MOTION: [&str; 15] = [
    "andrews",               // a constant torque, a spring
    "boom",                  // one cylinder led, one free
    "crank-rocker",          // no loads
    "double-pendulum",       // two freedoms
    "exported-model",        // a varying inertia
    "expressions",           // loads and a law by expressions
    "five-bar",              // two freedoms with servos
    "four-bar",              // a motor with inductance against loads
    "n-four-bar-a02",        // constraints that repeat each other at its flats
    "pendulum-a01",          // a swing
    "press",                 // a motor by its line, a table
    "single-dwell",          // no loads
    "slider-crank-friction", // friction in pins and guide, a motor
    "slotted-rocker",        // no loads
    "whitworth",             // a regulator
];
/// Of them, those over which energy is given or taken.
const NONCONSERVATIVE: [&str; 8] = [
    "andrews",
    "boom",
    "expressions",
    "five-bar",
    "four-bar",
    "press",
    "slider-crank-friction",
    "whitworth",
];

const KEYS: [&str; 5] = [
    "motion-poses",
    "motion-velocities",
    "motion-reactions",
    "motion-actuator-forces",
    "motion-energy",
];

fn run(scene: &PlaneScene) -> FreeMotionRun {
    let run = free_motion_run(scene).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    run.unwrap_or_else(|| panic!("{} has no motion", scene.name))
}

fn failed(findings: &[Finding]) -> bool {
    findings.iter().any(|f| !f.pass)
}

#[test]
fn val_every_motion_by_the_multibody_equations() {
    let dynamic: Vec<String> = case_names()
        .into_iter()
        .filter(|case| scene(case).motion.is_some())
        .collect();
    assert_eq!(dynamic, CASES_WITH_MOTION);
    for case in CASES_WITH_MOTION {
        let scene = scene(case);
        let run = run(&scene);
        assert_eq!(run.stop_reason, None, "{case}");
        let findings = run.check(&scene);
        let keys: Vec<&str> = findings.iter().map(|f| f.key.as_str()).collect();
        assert_eq!(keys, KEYS, "{case}");
        for finding in &findings {
            // What is promised of every motion, whatever tolerance its findings have.
            let promised = if finding.key == "motion-energy" {
                1e-9
            } else {
                1e-8
            };
            assert!(finding.pass, "{case}: {finding:?}");
            assert!(
                finding.relative_difference <= promised,
                "{case}: {finding:?}"
            );
        }
        let work = run
            .steps
            .iter()
            .fold(0.0_f64, |max, s| max.max(s.work.abs()));
        assert_eq!(
            work > 0.1,
            NONCONSERVATIVE.contains(&case),
            "{case}: {work} J"
        );
    }
}

/// Everything depends on the heaviest body, if by nothing but the reactions.
#[test]
fn a_mass_off_by_a_hundred_thousandth_is_found_in_every_motion() {
    for case in CASES_WITH_MOTION {
        let right = scene(case);
        // Its only body has a varying inertia and no mass: the next test alters it.
        if case == "exported-model" {
            assert!(right.masses.iter().all(|body| body.mass == 0.0));
            continue;
        }
        let run = run(&right);
        let ground = right.mechanism.ground;
        let mass = |b: &usize| right.masses[*b].mass;
        let moving = (0..right.masses.len()).filter(|&b| b != ground);
        let heaviest = moving
            .max_by(|a, b| mass(a).total_cmp(&mass(b)))
            .expect("a body");
        let mut wrong = right.clone();
        // Both: the mass of a wheel about its own centre has no effect without weight.
        wrong.masses[heaviest].mass *= 1.0 + 1e-5;
        wrong.masses[heaviest].inertia *= 1.0 + 1e-5;
        assert!(failed(&run.check(&wrong)), "{case}");
    }
}

/// A law, a drive or a friction that is not the claimed one is found.
#[test]
fn what_moves_a_machine_is_judged_too() {
    type Change = fn(&str) -> String;
    let changes: [(&str, Change); 5] = [
        ("boom", |text| {
            text.replace("1.5e4*dig.velocity", "1.50001e4*dig.velocity")
        }),
        ("four-bar", |text| {
            text.replace("inductance = 0.002", "inductance = 0.00200001")
        }),
        ("slider-crank-friction", |text| {
            text.replace("coefficient = 0.1,", "coefficient = 0.10001,")
        }),
        ("whitworth", |text| {
            text.replace("integral = 200", "integral = 200.01")
        }),
        ("exported-model", |text| {
            text.replace("1.032227550952006", "1.032327550952006")
        }),
    ];
    for (case, change) in changes {
        let right = scene(case);
        let path = repository_root()
            .join("validation")
            .join(case)
            .join("scene.toml");
        let text = std::fs::read_to_string(path).expect("a scene");
        let changed = change(&text);
        assert_ne!(text, changed, "{case}");
        let wrong = PlaneScene::parse("scene.toml", &changed).expect("a scene");
        assert!(failed(&run(&right).check(&wrong)), "{case}");
    }
}

/// Andrews' squeezer at 0.03 s: the multipliers of the test set, by an energy quadrature at 40 digits.
#[test]
fn val_squeezer_multipliers() {
    let scene = scene("andrews");
    let initial_state = Instant::now();
    let run = run(&scene);
    println!(
        "followed in {:.3} s, {} steps",
        initial_state.elapsed().as_secs_f64(),
        run.steps.len() - 1
    );
    let last = run.steps.last().expect("an end");
    assert_eq!(last.t, 0.03);
    let expected = [
        ("E-k3.x", 199.175_348_104_538_63_f64),
        ("E-k3.y", -29.755_309_974_971_763),
        ("E-k4.x", 23.066_543_612_162_15),
        ("E-k4.y", 31.452_725_275_771_137),
        ("E-k6.x", 22.642_494_786_394_38),
        ("E-k6.y", 11.617_392_352_611_256),
    ];
    let reactions = scene.mechanism.reactions();
    for (name, expected) in expected {
        let named = |&r: &dwell_geometry::Reaction| scene.mechanism.reaction_name(r) == name;
        let found = last.reactions[reactions.iter().position(named).expect(name)];
        let relative_error = found / expected - 1.0;
        println!("{name} {found:.12} {relative_error:.1e}");
        // Of speeds of 10³ rad/s, known to 1e-11, accelerations of 10⁶ are known to a few parts in 1e10.
        assert!(
            relative_error.abs() < 1e-7,
            "{name}: {found} is not {expected}"
        );
    }
    let [beta, speed] = run.coordinates.last().expect("an end")[0];
    // The integration's error, of a motion of sixteen radians.
    assert!((beta - 15.810_771_195_153_707).abs() < 1e-9, "{beta}");
    assert!(
        (speed / 1_139.920_302_259_106 - 1.0).abs() < 1e-8,
        "{speed}"
    );
}
