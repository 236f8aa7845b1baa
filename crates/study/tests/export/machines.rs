//! Machines with loads and drives: accelerations, reactions and energies of the export against those of the exact machine, at
//! states of every speed.

use super::toolchain::request;
use dwell_dynamics::Machine;
use dwell_export::{Evaluator, Precision};
use dwell_scene::PlaneScene;
use dwell_study::models::build_machine;
use dwell_study::{ExportRequest, compute_export};

/// A crank and rocker with a weight, springs, dampers and a geared motor with a rotor and inductance.
const MOTOR: &str = r#"
title = "A motor drives a crank and a rocker"
[bodies.ground]
points = { A = [0, 0], D = [0.4, 0] }
[bodies.crank]
points = { A = [0, 0], B = [0.1, 0] }
mass = 1.0
center = [0.05, 0]
inertia = 0.002
[bodies.coupler]
points = { B = [0, 0], C = [0.35, 0], M = [0.15, 0.1] }
mass = 0.8
center = [0.2, 0.02]
inertia = 0.01
[bodies.rocker]
points = { D = [0, 0], C = [0.25, 0] }
mass = 0.6
center = [0.12, 0]
inertia = 0.004
[joints]
A = { revolute = ["ground.A", "crank.A"] }
B = { revolute = ["crank.B", "coupler.B"] }
C = { revolute = ["coupler.C", "rocker.C"] }
D = { revolute = ["ground.D", "rocker.D"] }
[actuators.phi]
angle = ["ground", "crank"]
[assembly]
coupler = 0.6
rocker = 1.6
[loads]
weight = { gravity = [0, -9.81] }
spring = { spring = ["ground.A", "coupler.C"], stiffness = 50, free-length = 0.3 }
oil = { rotational-damper = ["ground", "rocker"], damping = 0.2 }
wind = { drag = "coupler.M", coefficient = 3 }
fan = { rotational-drag = ["coupler", "crank"], coefficient = 0.02 }
[drives]
motor = { motor = "phi", voltage = 12, torque-constant = 0.05, resistance = 1.2, inductance = 0.01, gear-ratio = 5, inertia = 1e-4 }
[requests]
reactions = ["A", "C", "D"]
[motion]
initial-velocity = { phi = 2.0 }
duration = 1
"#;

fn machine(scene: &PlaneScene) -> Machine {
    let spec = scene.motion.as_ref().unwrap();
    build_machine(scene, spec, &scene.requests.reactions).unwrap()
}

/// Compares rates, reactions and energies over a grid of states, of cells and of the model's own operations.
fn compare(scene: &PlaneScene, states: &[Vec<f64>]) {
    for exact in [false, true] {
        let asked = ExportRequest {
            exact,
            ..request(1e-10, Precision::Double)
        };
        let twin = compute_export(scene, &asked).unwrap().evaluator();
        // Operations err by rounding alone.
        compare_with(scene, states, &twin, if exact { 1e-5 } else { 1.0 });
    }
}

fn compare_with(scene: &PlaneScene, states: &[Vec<f64>], twin: &Evaluator<f64>, part: f64) {
    let machine = machine(scene);
    let mut workspace = machine.workspace::<f64>();
    for y in states {
        let mut full = y.clone();
        full.resize(machine.state_count(), 0.0);
        let state = machine.evaluate(0.0, &full, &mut workspace).unwrap();
        let q_ddot = state.q_ddot()[0];
        let rates = twin.rates(y).unwrap();
        assert!(
            (rates[1] - q_ddot).abs() < part * 1e-7 * (1.0 + q_ddot.abs()),
            "{y:?}: {rates:?} {q_ddot}"
        );
        let reactions = twin.reactions(y, q_ddot).unwrap();
        let exact = state.inverse_dynamics().reactions.clone();
        let largest = exact.iter().fold(1.0_f64, |max, r| max.max(r.abs()));
        for (k, (found, exact)) in reactions.iter().zip(&exact).enumerate() {
            assert!(
                (found - exact).abs() < part * 1e-7 * largest,
                "reaction {k} at {y:?}: {found} {exact}"
            );
        }
        let [kinetic, potential] = state.energy();
        let found = twin.energies(y).unwrap();
        assert!(
            (found[0] - kinetic).abs() < part * 1e-8 * (1.0 + kinetic),
            "{found:?} {kinetic}"
        );
        assert!(
            (found[1] - potential).abs() < part * 1e-8 * (1.0 + potential.abs()),
            "{found:?} {potential}"
        );
    }
}

#[test]
fn a_motor_with_a_rotor_and_a_current() {
    let scene = PlaneScene::parse("motor.toml", MOTOR).unwrap();
    let mut states = Vec::new();
    for i in 0..24 {
        let q = 0.27 * f64::from(i);
        states.push(vec![q, 3.0 * (1.3 * q).cos(), 2.0 * q.sin()]);
    }
    compare(&scene, &states);
}
