//! Gear pairs, screws and driven lengths in space against values derived by hand; an evaluation allocates nothing.
#![allow(clippy::expect_used, reason = "a test")]

use allocation_counter::measure;
use dwell_geometry::space::{
    Actuator, ActuatorKind, Assembly, Joint, JointKind, Mechanism, Placement, Rotation, Side, vec3,
};
use dwell_geometry::{Body, JointId};
use dwell_kinetostatics::space::{Axes, Component, LoadKind, Mass, Model, Reaction};
use dwell_scene::SpaceScene;
use std::f64::consts::TAU;

/// Rounding of sums of a few terms, relative to the largest.
const ROUNDING: f64 = 1e-14;

fn scene(name: &str) -> SpaceScene {
    let home = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation/spatial");
    SpaceScene::read(format!("{home}/{name}.toml")).expect("a scene")
}

fn model(scene: &SpaceScene, reactions: &[(&str, Component)]) -> Model {
    let compile = |&(name, component): &(&str, Component)| {
        let joint = scene.mechanism.joints.iter().position(|j| j.name == name);
        Reaction {
            joint: JointId(joint.expect("a joint")),
            component,
        }
    };
    let reactions: Vec<Reaction> = reactions.iter().map(compile).collect();
    let model = Model::new(&scene.mechanism, &scene.masses, &scene.assembly, &reactions);
    model.expect("a model")
}

fn close(found: f64, wanted: f64, scale: f64) {
    assert!(
        (found - wanted).abs() <= ROUNDING * scale,
        "{found} for {wanted}"
    );
}

const AXIAL: Component = Component::Force(Axes::Joint, 2);
/// Pitch radii of planet and side gears, and the planet's distance from the axis, m.
const RADII: [f64; 3] = [0.03, 0.04, 0.05];
/// About the axis: of the left and the right side gear, and of the cage with the planet turning with it (kg m²):
/// A = I_c + m_p h² + I_t.
const INERTIAS: [f64; 3] = [0.0011, 0.0013, 0.004 + 0.3 * 0.05 * 0.05 + 0.0002];
/// Moment of inertia of the planet about its own axis, kg m².
const PLANET: f64 = 0.0003;

/// θ_c = (l + r)/2 and θ_p = (l − r) b/2a, so T = ½ I_l l̇² + ½ I_r ṙ² + ½ A θ̇_c² + ½ I_p θ̇_p².
#[test]
fn a_bevel_differential_adds_its_inputs() {
    let scene = scene("bevel-differential");
    let model = model(&scene, &[]);
    let [a, b, _] = RADII;
    let [left, right, cage] = INERTIAS;
    let [quarter, planet] = [cage / 4.0, PLANET * (b / a).powi(2) / 4.0];
    let wanted = [
        left + quarter + planet,
        quarter - planet,
        quarter - planet,
        right + quarter + planet,
    ];
    let (mut workspace, mut found) = (model.workspace(), model.result_buffer());
    let body = |name: &str| {
        let bodies = &scene.mechanism.bodies;
        bodies.iter().position(|b| b.name == name).expect("a body")
    };
    for q in [[0.3, -0.1], [1.4, 0.9], [-2.0, 2.5]] {
        let mut forces_at = |q_dot: [f64; 2], q_ddot: [f64; 2]| {
            model
                .inverse_dynamics(&q, &q_dot, &q_ddot, &mut workspace, &mut found)
                .expect("a pose");
            [found.tau[0], found.tau[1]]
        };
        let [first, second] = [[1.0, 0.0], [0.0, 1.0]].map(|unit| forces_at([0.0; 2], unit));
        for (found, wanted) in first.into_iter().chain(second).zip(wanted) {
            close(found, wanted, wanted);
        }
        // The mass matrix is constant: no velocity makes a force.
        let of_speeds = forces_at([1.3, -0.4], [0.0; 2]);
        of_speeds.iter().for_each(|f| close(*f, 0.0, wanted[0]));
        let mut pose = model.plan().pose();
        model.plan().positions(&q, &mut pose).expect("a pose");
        let turned = model.plan().placement(&pose, body("carrier")).rotation;
        close(turned.vector().x, (q[0] + q[1]) / 2.0, 1.0);
        let planet = model.plan().placement(&pose, body("planet")).rotation;
        let own = turned.inverse().after(&planet).vector();
        close(own.y, (q[0] - q[1]) * b / (2.0 * a), 4.0);
    }
}

/// With one side held the cage turns half as fast as the other. The teeth carry ±F on the left and the right of the planet, with
/// a (F_l − F_r) = I_p θ̈_p and b (F_l + F_r) = A θ̈_c; at constant speed the bearing of the planet turns its spin: θ̇_c × I_p θ̇_p.
#[test]
fn the_teeth_of_a_held_differential_carry_what_moves_the_planet() {
    let scene = scene("bevel-differential-held");
    let bearing_moment = Component::Moment(Axes::Joint, 1);
    let model = model(
        &scene,
        &[
            ("left-teeth", AXIAL),
            ("right-teeth", AXIAL),
            ("planet", AXIAL),
            ("planet", bearing_moment),
        ],
    );
    let [a, b, h] = RADII;
    let [left, _, cage] = INERTIAS;
    let spin = b / (2.0 * a);
    let (sum, difference) = (0.5 * cage / b, PLANET * spin / a);
    let m = left + cage / 4.0 + PLANET * spin * spin;
    let (mut workspace, mut out) = (model.workspace(), model.coefficient_buffer());
    for k in 0..40 {
        let q = 0.31 * f64::from(k) - 5.0;
        model.reduce(q, &mut workspace, &mut out).expect("a pose");
        close(out.m, m, m);
        close(out.half_dm, 0.0, m);
        let forces = [(sum + difference) / 2.0, (sum - difference) / 2.0];
        close(out.a[0], forces[0], sum);
        close(out.a[1], forces[1], sum);
        close(out.b[0], 0.0, sum);
        close(out.b[1], 0.0, sum);
        // Toward the axis; and about z, where the joint's own direction across is −z.
        close(out.b[2], -0.3 * h / 4.0, sum);
        close(out.b[3], -PLANET * spin / 2.0, sum);
    }
}

/// The nut rises by h = pitch/2π for a unit of the angle: m = I + M h², w = −M h, and the thread carries the weight M.
#[test]
fn a_screw_jack_lifts_its_load() {
    let mut scene = scene("screw-jack");
    let [thread, moment] = [AXIAL, Component::Moment(Axes::Joint, 2)].map(|c| ("thread", c));
    let (inertia, mass, h) = (0.00004, 25.0, 0.006 / TAU);
    let m = inertia + mass * h * h;
    let gravity = LoadKind::Gravity {
        direction: vec3(0.0, 0.0, -1.0),
    };
    for by_travel in [false, true] {
        // The travel of the spindle's thread in the nut is −h for a unit of the angle.
        let unit = if by_travel { -1.0 / h } else { 1.0 };
        if by_travel {
            scene.mechanism.actuators[0].kind = ActuatorKind::Travel(JointId(1));
        }
        let model = model(&scene, &[thread, moment]);
        let (mut workspace, mut out) = (model.workspace(), model.coefficient_buffer());
        let mut response = model.result_buffer();
        for turns in [0.0, 0.3, 2.4, -1.7] {
            let q = TAU * turns / unit;
            model.reduce(q, &mut workspace, &mut out).expect("a pose");
            close(out.m, m * unit * unit, m * unit * unit);
            close(out.half_dm, 0.0, m * unit * unit);
            let load = &gravity;
            model
                .unit_load_response(&[q], load, &mut workspace, &mut response)
                .expect("a pose");
            close(response.tau[0], mass * h * unit, mass * h * unit.abs());
            // Where the travel is driven the actuator pushes alone.
            let carried = if by_travel { 0.0 } else { -mass };
            close(response.reactions[0], carried, mass);
            close(response.reactions[1], carried * h, mass * h);
            let mut pose = model.plan().pose();
            model.plan().positions(&[q], &mut pose).expect("a pose");
            let nut = model.plan().placement(&pose, 2).position;
            close(nut.z, 0.1 + h * TAU * turns, 0.1);
        }
    }
}

/// An arm of length b that a cylinder between two points turns: l² = a² + b² − 2ab cos φ, so φ′ = l/(ab sin φ), m = I φ′².
#[test]
fn a_cylinder_turns_an_arm() {
    let (a, b, inertia) = (0.5, 0.3, 0.02);
    let at = |x: f64| Side {
        point: vec3(x, 0.0, 0.0),
        ..Side::default()
    };
    let mechanism = Mechanism {
        bodies: ["ground", "arm"].map(Body::named).into(),
        ground: 0,
        joints: vec![
            Joint::new("O", [0, 1], JointKind::Revolute, [at(0.0), at(0.0)]),
            Joint::new(
                "rod",
                [0, 1],
                JointKind::Distance { length: 0.0 },
                [at(a), at(b)],
            ),
        ],
        actuators: vec![Actuator::length("l", 1)],
        couplings: Vec::new(),
    };
    let masses = [
        Mass::default(),
        Mass {
            inertia: [0.0, 0.0, inertia, 0.0, 0.0, 0.0],
            ..Mass::default()
        },
    ];
    let placements = vec![
        Placement::default(),
        Placement {
            rotation: Rotation::of_vector(vec3(0.0, 0.0, 1.0)),
            ..Placement::default()
        },
    ];
    let assembly = Assembly {
        q: vec![0.42],
        placements,
    };
    let pin = Reaction {
        joint: JointId(0),
        component: Component::Force(Axes::Ground, 0),
    };
    let model = Model::new(&mechanism, &masses, &assembly, &[pin]).expect("a model");
    assert!(!model.plan().is_angle(0));
    let (mut workspace, mut out) = (model.workspace(), model.coefficient_buffer());
    for l in [0.25, 0.42, 0.55, 0.74] {
        model.reduce(l, &mut workspace, &mut out).expect("a pose");
        let cos = (a * a + b * b - l * l) / (2.0 * a * b);
        let sin = (1.0 - cos * cos).sqrt();
        let first = l / (a * b * sin);
        // φ″ = (1 − ab cos φ φ′²)/(ab sin φ)
        let second = (1.0 - a * b * cos * first * first) / (a * b * sin);
        let m = inertia * first * first;
        close(out.m, m, 10.0 * m);
        close(out.half_dm, inertia * first * second, 100.0 * m);
        // The pin carries what the cylinder does, along it: the action m on the arm, from the ground's point to the arm's.
        let along = (b * cos - a) / l;
        close(out.a[0], -m * along, 10.0 * m);
    }
    let limits = model.plan().range().limits().expect("a stroke");
    assert!((limits.0 - (a - b)).abs() < 1e-6 && (limits.1 - (a + b)).abs() < 1e-6);
}

#[test]
fn an_evaluation_in_space_allocates_nothing() {
    for name in [
        "rssr",
        "bricard-a04",
        "bevel-differential-held",
        "screw-jack",
    ] {
        let scene = scene(name);
        let model = Model::new(
            &scene.mechanism,
            &scene.masses,
            &scene.assembly,
            &scene.requests.reactions,
        );
        let model = model.expect("a model");
        assert!(model.reactions().len() > 0);
        let (mut workspace, mut out) = (model.workspace(), model.coefficient_buffer());
        for k in 0..20 {
            let q = 0.05 * f64::from(k);
            let mut done = false;
            let spent = measure(|| done = model.reduce(q, &mut workspace, &mut out).is_ok());
            assert!(done, "{name} at {q}");
            assert_eq!(spent.count_total, 0, "{name} at {q}");
        }
    }
    // What allocates is counted.
    let scene = scene("rssr");
    let spent = measure(|| drop(model(&scene, &[])));
    assert!(spent.count_total > 0);
}
