//! Loads of scenes in space against the dense equations in body coordinates, by virtual work and by their potentials.

use dwell_dynamics::{CoordinateMode, Machine};
use dwell_geometry::space::{Coordinate, Placement};
use dwell_geometry::{BodyId, JointId};
use dwell_kinetostatics::MachineModel;
use dwell_kinetostatics::space::{Axes, Component, Model};
use dwell_scene::SpaceScene;
use dwell_verify::space::DenseSpace;

/// Springs, dampers and laws on the spatial slider-crank.
const ON_SLIDER_CRANK: &str = r#"
spring = { spring = ["ground.A", "slider.C"], stiffness = 31.0, free-length = 0.15 }
soft = { spring = ["ground.D", "rod.B"], stiffness = "20 + 5*q", free-length = 0 }
damper = { damper = ["ground.A", "rod.C"], damping = 2.5 }
coil = { torsion-spring = "A", stiffness = 0.7, free-angle = 0.4 }
drag = { rotational-damper = "A", damping = "0.02 + 0.01*s^2" }
push = { slide-force = "D", magnitude = "3*sin(2*t) - 4*s" }
rub = { slide-damper = "D", damping = 1.5 }
motor = { joint-torque = "A", magnitude = "0.3 - 0.05*q.velocity" }
follower = { force = "rod.C", direction = [0.6, 0, 0.8], frame = "body", magnitude = { table = [[-1, 2], [0, 3], [9, 1]], of = "d" } }
between = { point-to-point-force = ["crank.B", "slider.D"], magnitude = 1.7 }
twist = { torque = ["crank", "rod"], axis = [0, 0.6, 0.8], magnitude = 0.11 }
[coordinates]
s = { travel = "D" }
d = { length = ["ground.A", "slider.C"] }
"#;

/// A spring and a damper about joints of the Bricard linkage, one of which closes the loop.
const ON_BRICARD: &str = r#"
first = { torsion-spring = "P3", stiffness = 2.1, free-angle = 0.2 }
second = { torsion-spring = "P1", stiffness = 1.3, free-angle = -0.1 }
third = { rotational-damper = "P4", damping = 0.4 }
fourth = { joint-torque = "P2", magnitude = "0.3*x" }
fifth = { torsion-spring = "P5", stiffness = 0.9, free-angle = 0.3 }
[coordinates]
x = { angle = "P3" }
"#;

fn scene(name: &str, loads: &str) -> SpaceScene {
    let path = format!(
        "{}/../validation/spatial/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let mut text = std::fs::read_to_string(path).expect("the file");
    text.push_str(loads);
    SpaceScene::parse(name, &text).unwrap_or_else(|e| panic!("{name}: {e:?}"))
}

fn model(scene: &SpaceScene) -> Model {
    let reactions = &scene.requests.reactions;
    let model = Model::new(&scene.mechanism, &scene.masses, &scene.assembly, reactions);
    let model = model.expect("a model");
    model.with_loads(scene.loads.clone()).expect("loads")
}

/// Coordinates, speeds and accelerations.
const STATES: [[f64; 3]; 4] = [
    [0.3, 2.0, -3.0],
    [-0.4, -1.1, 4.0],
    [0.9, 0.0, 0.0],
    [0.05, 5.0, 1.0],
];

/// Actuator actions and the reactions that are determined agree with the dense equations to 1e-11 of the largest.
#[test]
fn loads_in_space_act_as_in_the_dense_equations() {
    for (name, loads, kinds) in [
        ("slider-crank-haug", ON_SLIDER_CRANK, 12),
        ("bricard-a04", ON_BRICARD, 6),
    ] {
        let scene = scene(name, loads);
        assert_eq!(scene.loads.len(), kinds);
        let model = model(&scene);
        let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
        let determined = model
            .determined(&[0.37], &mut model.workspace())
            .expect("a pose");
        let mut compared = 0;
        for [q, q_dot, q_ddot] in STATES {
            let t = 0.3 + q;
            let at = [&[q][..], &[q_dot][..], &[q_ddot][..]];
            let state = model.kinetostatics(t, at, &mut workspace, &mut result);
            let state = state.expect("a state");
            let magnitudes: Vec<f64> = state.magnitudes().to_vec();
            let mut pose = model.plan().pose();
            model.plan().positions(&[q], &mut pose).expect("a pose");
            let placements: Vec<Placement> = (0..scene.mechanism.bodies.len())
                .map(|b| model.plan().placement(&pose, b))
                .collect();
            let kinds = scene.loads.iter().map(|load| load.kind);
            let loads: Vec<_> = kinds.zip(magnitudes).collect();
            let masses = &scene.masses;
            let dense = DenseSpace::new(
                &scene.mechanism,
                masses,
                &placements,
                [&[q_dot], &[q_ddot]],
                &loads,
            )
            .expect("equations");
            let scale = result.reactions.iter().fold(1.0_f64, |s, r| s.max(r.abs()));
            let off = (result.tau[0] - dense.actuator_actions[0]).abs();
            assert!(off < 1e-11 * scale, "{name}: {off:.1e} of {scale}");
            for ((found, reaction), determined) in result
                .reactions
                .iter()
                .zip(model.reactions())
                .zip(&determined)
            {
                let wrench = dense.reactions[reaction.joint.0];
                let (vector, k) = match reaction.component {
                    Component::Force(Axes::Ground, k) => (wrench.force, k),
                    Component::Moment(Axes::Ground, k) => (wrench.moment, k),
                    _ => continue,
                };
                if *determined {
                    let wanted = [vector.x, vector.y, vector.z][k];
                    assert!(
                        (found - wanted).abs() < 1e-10 * scale,
                        "{name}: {found} for {wanted}"
                    );
                    compared += 1;
                }
            }
        }
        println!("{name}: {compared} reactions");
        assert!(compared > 4, "{compared}");
    }
}

/// The power of each load is that of its part of the actuator's action; a potential falls by the work of its load.
#[test]
fn loads_in_space_work_as_they_push_the_coordinate() {
    for (name, loads, conservative) in [
        ("slider-crank-haug", ON_SLIDER_CRANK, 3),
        ("bricard-a04", ON_BRICARD, 4),
    ] {
        let scene = scene(name, loads);
        let model = model(&scene);
        let machine = Machine::new(model.clone(), &scene.loads, vec![CoordinateMode::Free], &[]);
        let machine = machine.expect("a machine");
        let mut workspace = machine.workspace();
        let mut with_potential = 0;
        for [q, q_dot, _] in STATES {
            let mut y = machine.initial_state(&[q], &[q_dot]);
            y[0] = q;
            let state = machine.evaluate(0.2, &y, &mut workspace).expect("a state");
            let mut rates = vec![0.0; y.len()];
            state.derivative(&mut rates);
            // dT/dt − dV/dt … : the energy changes by the works.
            let h = 1e-5;
            let energies = [-2.0, -1.0, 1.0, 2.0].map(|k: f64| {
                // Along the motion, to third order.
                let mut work = machine.workspace();
                let near: Vec<f64> = vec![
                    q + k * h * q_dot + 0.5 * (k * h) * (k * h) * rates[1],
                    q_dot + k * h * rates[1],
                ];
                let mut y = machine.initial_state(&[0.0], &[0.0]);
                y[..2].copy_from_slice(&near);
                let at = machine.evaluate(0.2, &y, &mut work).expect("a state");
                at.energy().iter().sum::<f64>()
            });
            let slope =
                (energies[0] - 8.0 * energies[1] + 8.0 * energies[2] - energies[3]) / (12.0 * h);
            let powers: f64 = rates[machine.work_offset()..].iter().sum();
            let scale = powers.abs() + energies[0].abs();
            assert!(
                (slope - powers).abs() < 1e-8 * scale.max(1.0),
                "{name}: {slope} for {powers}"
            );
            with_potential = (0..scene.loads.len())
                .filter(|&k| model.is_conservative(k))
                .count();
        }
        assert_eq!(with_potential, conservative, "{name}");
    }
}

/// The angles of all joints of a loop go on over several revolutions, and change at their rates.
#[test]
fn angles_of_joints_in_space_count_revolutions() {
    let mut closing = 0;
    for name in [
        "bricard-a04",
        "slider-crank-haug",
        "bennett",
        "double-hooke",
    ] {
        let scene = scene(name, "");
        let model = model(&scene);
        let ranges = model.plan().range();
        let (from, to) = ranges.limits().unwrap_or((-9.0, 9.0));
        for joint in 0..scene.mechanism.joints.len() {
            let Ok(angle) = model.coordinate_function(Coordinate::Angle(JointId(joint))) else {
                continue;
            };
            closing += 1;
            let mut workspace = model.workspace();
            let (mut last, n) = (None::<[f64; 2]>, 4001);
            for k in 1..n {
                let q = from + (to - from) * f64::from(k) / f64::from(n);
                let state = model.kinematic_state(&[q], &[1.0], &mut workspace);
                let Ok(state) = state else { continue };
                let [value, rate] = state.coordinate(angle);
                if let Some([before, rate_before]) = last {
                    let step = (to - from) / f64::from(n);
                    let expected = 0.5 * (rate + rate_before) * step;
                    let off = (value - before - expected).abs();
                    assert!(
                        off < 0.05 * (expected.abs() + step),
                        "{name}, joint {joint} at {q}: {off}"
                    );
                }
                last = Some([value, rate]);
            }
        }
    }
    assert!(closing >= 12, "{closing}");
}

/// Distances and travels have the rates and accelerations of their differences.
#[test]
fn coordinates_in_space_change_at_their_rates() {
    let scene = scene("slider-crank-haug", "");
    let model = model(&scene);
    let point = |body: usize, k: usize| scene.points[body][k].1;
    let distance = Coordinate::Distance {
        bodies: [BodyId(1), BodyId(3)],
        points: [point(1, 1), point(3, 0)],
    };
    for of in [
        Coordinate::Travel(JointId(3)),
        Coordinate::Angle(JointId(0)),
        distance,
    ] {
        let of = model.coordinate_function(of).expect("a coordinate");
        let mut workspace = model.workspace();
        let mut at = |t: f64| {
            let (q, q_dot) = (0.4 + 1.5 * t - t * t, 1.5 - 2.0 * t);
            let state = model.kinematic_state(&[q], &[q_dot], &mut workspace);
            let mut state = state.expect("a pose");
            state.accelerate(&[-2.0]);
            state.coordinate_motion(of)
        };
        let h = 1e-4;
        let near = [-2.0, -1.0, 1.0, 2.0].map(|k| at(k * h));
        let slope =
            |k: usize| (near[0][k] - 8.0 * near[1][k] + 8.0 * near[2][k] - near[3][k]) / (12.0 * h);
        let found = at(0.0);
        for k in [0, 1] {
            assert!(
                (slope(k) - found[k + 1]).abs() < 1e-9,
                "{of:?}: {} for {found:?}",
                slope(k)
            );
        }
    }
}
