//! The planar cases, placed obliquely in space and evaluated as mechanisms in space: the same m, ½m′ and w.

use dwell_geometry::space::{
    Actuator, Assembly, Joint, JointKind, Mechanism, Placement, Rotation, Side, Vec3, vec3,
};
use dwell_geometry::{self as plane, ActuatorKind, BodyId, Vec2};
use dwell_kinetostatics::space::{LoadKind, Mass, Model};
use dwell_scene::Scene;
use dwell_study::models::loaded_model;
use std::path::Path;

/// The plane's frame in space.
fn tilt() -> Placement {
    Placement {
        position: vec3(0.7, -0.3, 1.1),
        rotation: Rotation::of_vector(vec3(0.9, -1.3, 0.4)),
    }
}

fn lifted(v: Vec2) -> Vec3 {
    vec3(v.x, v.y, 0.0)
}

/// A joint in space with its axes in or across the plane; none of a kind that has no counterpart.
fn joint(joint: &plane::Joint, ground: usize) -> Option<Joint> {
    let (z, x) = (vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0));
    let (kind, directions) = match joint.kind {
        plane::JointKind::Revolute => (JointKind::Revolute, [[z, x]; 2]),
        plane::JointKind::Prismatic { axes } => {
            (JointKind::Prismatic, axes.map(|axis| [lifted(axis), z]))
        }
        plane::JointKind::Distance { length } => (JointKind::Distance { length }, [[z, x]; 2]),
        plane::JointKind::Weld { angle } => {
            // The second body's frame is turned, so that the first's x has this direction in it.
            let (sin, cos) = angle.sin_cos();
            (JointKind::Weld, [[z, x], [z, vec3(cos, -sin, 0.0)]])
        }
        _ => return None,
    };
    let side = |k: usize| {
        let [axis, normal] = directions[k];
        let point = lifted(joint.points[k]);
        // The ground's frame is that of the scene: what is on the ground is tilted.
        let frame = if joint.bodies[k].0 == ground {
            tilt()
        } else {
            Placement::default()
        };
        Side {
            point: frame.position + frame.rotation.apply(point),
            axis: frame.rotation.apply(axis),
            normal: frame.rotation.apply(normal),
        }
    };
    Some(Joint::new(
        joint.name.clone(),
        joint.bodies,
        kind,
        [side(0), side(1)],
    ))
}

/// The mechanism in space; none where a joint or the actuator has no counterpart.
fn in_space(scene: &Scene) -> Option<Mechanism> {
    let planar = &scene.mechanism;
    let joints: Option<Vec<Joint>> = planar
        .joints
        .iter()
        .map(|j| joint(j, planar.ground))
        .collect();
    let [actuator] = &planar.actuators[..] else {
        return None;
    };
    let ActuatorKind::Angle = actuator.kind else {
        return None;
    };
    let driven = planar.joints.iter().position(|j| {
        j.bodies == actuator.bodies && matches!(j.kind, plane::JointKind::Revolute)
    })?;
    Some(Mechanism {
        bodies: planar.bodies.clone(),
        ground: planar.ground,
        joints: joints?,
        actuators: vec![Actuator::angle(actuator.name.clone(), driven)],
    })
}

/// Where the bodies of a planar model are in space at a coordinate.
fn placements(
    model: &dwell_kinetostatics::Model,
    q: f64,
    bodies: usize,
    ground: usize,
) -> Vec<Placement> {
    let mut workspace = model.workspace();
    let mut state = model
        .kinematic_state(&[q], &[1.0], &mut workspace)
        .expect("a pose");
    let states = state.bodies_at(&[0.0]);
    let place = |b: usize| {
        if b == ground {
            return Placement::default();
        }
        let rotation = states.body(BodyId(b)).rotation;
        let at = states.point(BodyId(b), Vec2::ZERO).position;
        let tilt = tilt();
        let turn = Rotation::of_vector(vec3(0.0, 0.0, rotation.y.atan2(rotation.x)));
        Placement {
            position: tilt.position + tilt.rotation.apply(lifted(at)),
            rotation: tilt.rotation.after(&turn),
        }
    };
    (0..bodies).map(place).collect()
}

#[test]
fn planar_cases_have_the_same_reduced_parameters_in_space() {
    let home = Path::new(env!("CARGO_MANIFEST_DIR")).join("../validation");
    let (mut compared, mut largest) = (Vec::new(), [0.0_f64; 3]);
    for entry in std::fs::read_dir(home).expect("the cases").flatten() {
        let path = entry.path().join("scene.toml");
        let Ok(scene) = Scene::read(&path) else {
            continue;
        };
        let Some(mechanism) = in_space(&scene).filter(|_| scene.varying_inertias.is_empty()) else {
            continue;
        };
        let planar = loaded_model(&scene).expect("a model");
        let start = scene.assembly.coordinates[0];
        let masses = scene.masses.iter().map(|m| Mass {
            mass: m.mass,
            center: lifted(m.center),
            inertia: [0.0, 0.0, m.inertia, 0.0, 0.0, 0.0],
        });
        let masses: Vec<Mass> = masses.collect();
        let assembly = Assembly {
            q: vec![start],
            placements: placements(&planar, start, masses.len(), mechanism.ground),
        };
        let model = Model::new(&mechanism, &masses, &assembly, &[]);
        let model = model.unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        let gravity = LoadKind::Gravity(tilt().rotation.apply(vec3(0.6, -0.8, 0.0)));
        let weighted = planar.with_loads(vec![dwell_kinetostatics::Load {
            name: "weight".to_owned(),
            kind: dwell_kinetostatics::LoadKind::Gravity {
                direction: plane::vec2(0.6, -0.8),
            },
            magnitude: dwell_kinetostatics::Magnitude::Constant(1.0),
        }]);
        let planar = weighted.expect("a load").without_reactions();
        let (mut one, mut other) = (planar.workspace(), model.workspace());
        let (mut wanted, mut found) = (
            planar.coefficient_buffer::<f64>(),
            model.coefficient_buffer::<f64>(),
        );
        let (mut load, mut response) = (planar.result_buffer(), model.result_buffer());
        let (from, width) = match planar.plan().range().limits() {
            None => (start, std::f64::consts::TAU),
            Some((from, to)) => (from + 0.1 * (to - from), 0.8 * (to - from)),
        };
        let (mut differences, mut scales) = ([0.0_f64; 3], [0.0_f64; 2]);
        for k in 0..24 {
            // Not at the change points of a parallelogram.
            let q = from + width * (f64::from(k) + 0.37) / 24.0;
            planar.reduce(q, &mut one, &mut wanted).expect("a pose");
            model
                .reduce(q, &mut other, &mut found)
                .unwrap_or_else(|e| panic!("{} at {q}: {e}", scene.name));
            let mut state = planar
                .kinematic_state(&[q], &[1.0], &mut one)
                .expect("a pose");
            state.unit_load_response(0, &mut load).expect("a response");
            model
                .unit_load_response(&[q], &gravity, &mut other, &mut response)
                .expect("a pose");
            scales = [scales[0].max(wanted.m), scales[1].max(load.tau[0].abs())];
            let all = [
                found.m - wanted.m,
                found.half_dm - wanted.half_dm,
                response.tau[0] - load.tau[0],
            ];
            for (difference, of) in differences.iter_mut().zip(all) {
                *difference = difference.max(of.abs());
            }
        }
        let parts = [
            differences[0] / scales[0],
            differences[1] / scales[0],
            differences[2] / scales[1].max(1e-9),
        ];
        for (largest, part) in largest.iter_mut().zip(parts) {
            *largest = largest.max(part);
        }
        println!("{}: {parts:?}", scene.name);
        compared.push(scene.name.clone());
    }
    assert!(compared.len() >= 8, "{compared:?}");
    assert!(largest.iter().all(|part| *part < 1e-12), "{largest:?}");
}
