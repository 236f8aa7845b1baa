//! Machines of several degrees of freedom as C: compiled, and held against the machine that integrates.

use super::toolchain::{Scratch, c_compiler, case, cases, compile, request, run};
use dwell_export::{Precision, SeveralFreedomsEvaluator, c_files_of_several_freedoms};
use dwell_scene::PlaneScene;
use dwell_study::models::build_machine;
use dwell_study::{ExportTarget, compute_export_of_several_freedoms, export};

/// The cases of several freedoms, and the largest errors of their operations in double and in single precision.
const CASES: [(&str, [f64; 2]); 5] = [
    // 3.2e-12 and 3.8e-3 of reactions, which the cylinder that stands flat enlarges.
    ("boom", [1e-11, 2e-2]),
    ("double-pendulum", [1e-14, 5e-6]),
    ("expressions", [1e-14, 5e-6]),
    ("five-bar", [5e-14, 1e-5]),
    ("laws", [1e-14, 5e-6]),
];

/// A five-bar with every kind of load and drive that an export has.
const FIVE_BAR: &str = r#"
title = "Five-bar with a motor, a servo, springs and dampers"
[bodies.ground]
points = { A = [-0.1, 0], E = [0.1, 0], S = [0, -0.3] }
[bodies.left]
points = { A = [0, 0], B = [0.25, 0] }
mass = 0.8
center = [0.11, 0.01]
inertia = 0.0045
[bodies.left-rod]
points = { B = [0, 0], C = [0.35, 0], tip = [0.42, 0.03] }
mass = 0.7
center = [0.19, 0.004]
inertia = 0.0095
[bodies.right-rod]
points = { D = [0, 0], C = [0.35, 0] }
mass = 0.5
center = [0.17, -0.006]
inertia = 0.0052
[bodies.right]
points = { E = [0, 0], D = [0.25, 0] }
mass = 0.8
center = [0.12, -0.01]
inertia = 0.0045
[joints]
A = { revolute = ["ground.A", "left.A"] }
B = { revolute = ["left.B", "left-rod.B"] }
C = { revolute = ["left-rod.C", "right-rod.C"] }
D = { revolute = ["right.D", "right-rod.D"] }
E = { revolute = ["ground.E", "right.E"] }
[actuators]
alpha = { angle = ["ground", "left"] }
beta = { angle = ["ground", "right"] }
[assembly]
alpha = 2.2
beta = 0.9
left-rod = 0.7
right-rod = 2.4
[loads]
weight = { gravity = [0, -9.81] }
push = { force = "left-rod.tip", direction = [1, 0], frame = "body", magnitude = -25 }
spring = { spring = ["ground.S", "left-rod.tip"], stiffness = 80, free-length = 0.4 }
shock = { damper = ["ground.S", "right-rod.C"], damping = 3 }
oil = { rotational-damper = ["ground", "left"], damping = 0.35 }
[drives]
motor = { motor = "alpha", voltage = 12, torque-constant = 0.05, resistance = 1.2, inductance = 0.01, gear-ratio = 5, inertia = 1e-4 }
quick = { motor = "beta", voltage = 6, torque-constant = 0.04, resistance = 0.8, gear-ratio = 3, inertia = 2e-4 }
servo = { applied-force = "beta", magnitude = 2.5 }
[motion]
initial-velocity = { alpha = 0.4, beta = -0.3 }
duration = 1
"#;

#[test]
fn every_case_of_several_freedoms_compiles_and_passes_its_self_test() {
    for (name, allowed) in CASES {
        for (precision, allowed) in [Precision::Double, Precision::Float]
            .into_iter()
            .zip(allowed)
        {
            let found = compute_export_of_several_freedoms(&case(name), &request(1e-9, precision));
            let export = found.unwrap();
            let error = export.errors.max();
            assert!(
                error <= allowed,
                "{name} {precision:?}: {:?}",
                export.errors
            );
            let Some(compiler) = c_compiler() else {
                continue;
            };
            let scratch = Scratch::new();
            let files = c_files_of_several_freedoms(&export);
            scratch.write(&files);
            let stem = files[0].0.trim_end_matches(".h").to_uppercase();
            let define = format!("-D{stem}_SELF_TEST");
            let sanitised = "-fsanitize=undefined,address";
            for more in [&["-O1", sanitised][..], &["-O2"][..]] {
                let all = [
                    &[define.as_str()],
                    more,
                    &[&files[1].0, "-lm", "-o", "program"],
                ];
                compile(&scratch.0, compiler, &all.concat());
                run(&scratch.0, "./program", &[]);
            }
        }
    }
}

/// Rates, reactions and energies of the exported code are those of the machine that `simulate` integrates.
#[test]
fn loads_drives_and_reactions_are_those_of_the_machine() {
    let scene = PlaneScene::parse("five-bar.toml", FIVE_BAR).unwrap();
    let asked = request(1e-9, Precision::Double);
    let export = compute_export_of_several_freedoms(&scene, &asked).unwrap();
    let twin = SeveralFreedomsEvaluator::new(&export.machine, &export.code);
    let spec = scene.motion.as_ref().unwrap();
    let machine = build_machine(&scene, spec, &scene.requests.reactions).unwrap();
    let mut workspace = machine.workspace::<f64>();
    for k in 0..24 {
        let x = f64::from(k);
        let q = [2.2 + 0.3 * (0.7 * x).sin(), 0.9 + 0.25 * (1.1 * x).cos()];
        let q_dot = [2.0 * (1.3 * x).cos(), -3.0 * (0.4 * x).sin()];
        let current = 1.5 * (0.9 * x).sin();
        let mut full = machine.initial_state(&q, &q_dot);
        full[4] = current;
        let state = machine.evaluate(0.0, &full, &mut workspace).unwrap();
        let y = [&q[..], &q_dot, &[current]].concat();
        let rates = twin.rates(&y).unwrap();
        let close = |found: &[f64], exact: &[f64], what: &str| {
            let size = exact.iter().fold(1e-3_f64, |max, x| max.max(x.abs()));
            for (found, exact) in found.iter().zip(exact) {
                let error = (found - exact).abs() / size;
                // 2.8e-15 is measured.
                assert!(error < 2e-13, "{what} at {y:?}: {found} {exact}");
            }
        };
        let q_ddot = state.q_ddot().to_vec();
        close(&rates[2..4], &q_ddot, "accelerations");
        let reactions = twin.reactions(&y, &q_ddot).unwrap();
        let exact = state.inverse_dynamics().reactions.clone();
        assert_eq!(reactions.len(), exact.len());
        close(&reactions, &exact, "reactions");
        close(&twin.energies(&y).unwrap(), &state.energy(), "energies");
        // With these accelerations nothing more must act: 8e-15 N m are left.
        let required = twin.required_forces(&y, &q_ddot).unwrap();
        assert!(
            required.iter().all(|force| force.abs() < 5e-13),
            "{required:?}"
        );
        // L di/dt = u − R i − k N φ̇
        let voltage = 12.0 - 1.2 * current - 5.0 * 0.05 * q_dot[0];
        assert!((rates[4] - voltage / 0.01).abs() < 1e-11);
    }
}

/// Runge–Kutta's method keeps the energy of a double pendulum to the fourth power of its step.
#[test]
fn steps_keep_the_energy() {
    let scene = case("double-pendulum");
    let asked = request(1e-9, Precision::Double);
    let export = compute_export_of_several_freedoms(&scene, &asked).unwrap();
    let twin = SeveralFreedomsEvaluator::new(&export.machine, &export.code);
    let start: Vec<f64> = [0, 1]
        .iter()
        .flat_map(|&k| export.machine.coordinates.iter().map(move |c| c.initial[k]))
        .collect();
    let drift = |h: f64, steps: usize| {
        let mut y = start.clone();
        (0..steps).for_each(|_| twin.step(h, &mut y).unwrap());
        let [before, after] = [&start, &y].map(|y| twin.energies(y).unwrap().iter().sum::<f64>());
        (after - before).abs()
    };
    let [coarse, fine] = [drift(4e-3, 500), drift(2e-3, 1000)];
    assert!(fine < 1e-7 && coarse / fine > 10.0, "{coarse:e} {fine:e}");
}

/// A pendulum beside a mechanism that is closed by Newton's method.
#[test]
fn what_is_searched_is_refused_by_name() {
    let text = std::fs::read_to_string(cases().join("class-three-six-bar/scene.toml")).unwrap();
    let bob = r#"[bodies.bob]
points = { O = [0, 0] }
mass = 1.0
center = [0.1, 0]
inertia = 0.01

[joints]
hinge = { revolute = ["ground.A", "bob.O"] }
"#;
    let swing = r#"[actuators.swing]
angle = ["ground", "bob"]

[assembly]
swing = 0.3
"#;
    let text = text
        .replacen("[joints]\n", bob, 1)
        .replacen("[assembly]\n", swing, 1);
    let scene = PlaneScene::parse("two.toml", &text).unwrap();
    let asked = request(1e-9, Precision::Double);
    let found = export(&scene, ExportTarget::C, &asked).unwrap_err();
    let found = found.to_string();
    assert!(
        found.contains("no export") && found.contains("Newton's method"),
        "{found}"
    );
}

#[test]
fn other_targets_and_intervals_are_refused_by_name() {
    let scene = case("five-bar");
    let asked = request(1e-9, Precision::Double);
    let found = export(&scene, ExportTarget::Rust, &asked).unwrap_err();
    let found = found.to_string();
    assert!(
        found.contains("2 actuators") && found.contains("as C alone"),
        "{found}"
    );
    let mut within = asked;
    within.interval = Some((0.0, 1.0));
    let found = export(&scene, ExportTarget::C, &within).unwrap_err();
    assert!(found.to_string().contains("one coordinate"), "{found}");
    let friction = FIVE_BAR.replace(
        "[drives]",
        "[friction]\nA = { coefficient = 0.2, radius = 0.01 }\n[drives]",
    );
    let scene = PlaneScene::parse("five-bar.toml", &friction).unwrap();
    let found = export(&scene, ExportTarget::C, &asked).unwrap_err();
    assert!(found.to_string().contains("dry friction"), "{found}");
}
