//! Every joint and every drive in free motion: the mechanisms of the kinetostatic states, let go.

use crate::machines::{describe, findings_for};
use crate::plant::{GROUND, Plant};
use crate::setup::Setup;
use dwell_findings::all_pass;
use dwell_geometry::{Actuator, BodyId, Coordinate, Joint, JointId, JointKind, Vec2, vec2};
use dwell_kinetostatics::{DriveKind, Load, Magnitude, Motor};
use dwell_laws::{Law, Polynomial};
use dwell_verify::MotionSample;

/// Let go at the coordinates of the start, with the actuators before `led` prescribed.
fn let_go(setup: &Setup, prescribed_count: usize) -> Plant {
    let mut plant = Plant::new();
    plant.mechanism = setup.mechanism.clone();
    let actuators = std::mem::take(&mut plant.mechanism.actuators);
    plant.masses = setup.masses.clone();
    plant.initial_guess = setup
        .assembly_poses
        .iter()
        .map(|pose| Some(pose[2]))
        .collect();
    for (i, (kind, magnitude)) in setup.loads.iter().enumerate() {
        plant.constant(&format!("load {i}"), *kind, *magnitude);
    }
    // Two bars may close in two positions without rotating a body.
    plant.branch_hints = distance_hints(setup);
    // The last motion is at the start itself.
    let [q, _, _] = setup.motions.last().unwrap();
    let velocities = [0.5, -0.3];
    for (
        i,
        Actuator {
            bodies,
            kind: drive,
            ..
        },
    ) in actuators.into_iter().enumerate()
    {
        if i < prescribed_count {
            let law = Law::Polynomial(Polynomial::motion(q[i], velocities[i], 0.8));
            plant.prescribed_along(bodies, drive, law);
        } else {
            plant.free(bodies, drive, [q[i], velocities[i]]);
        }
    }
    plant
}

/// The directions of the distances.
fn distance_hints(setup: &Setup) -> Vec<Option<f64>> {
    let direction = |joint: &Joint| {
        let [one, two] = [0, 1].map(|i| {
            let [x, y, angle] = setup.assembly_poses[joint.bodies[i].0];
            vec2(x, y) + joint.points[i].rotate(Vec2::from_angle(angle))
        });
        let is_distance = matches!(joint.kind, JointKind::Distance { .. });
        is_distance.then(|| (two - one).angle())
    };
    setup.mechanism.joints.iter().map(direction).collect()
}

fn motor() -> DriveKind {
    DriveKind::Motor(Motor {
        voltage: Magnitude::Constant(20.0),
        torque_constant: 0.3,
        resistance: 0.5,
        inductance: 0.02,
        gear_ratio: 3.0,
        rotor_inertia: 0.05,
        is_torque_speed_line: false,
    })
}

fn check(plant: &Plant, name: &str) {
    let claimed_motion = plant.model_motion(0.2, 4);
    let findings = findings_for(plant, &claimed_motion);
    println!("{name}\n{}", describe(&findings));
    assert!(all_pass(&findings), "{name}\n{}", describe(&findings));
}

#[test]
fn val_every_joint_in_free_motion() {
    for setup in crate::mechanisms::all() {
        for prescribed_count in 0..setup.mechanism.actuators.len() {
            check(&let_go(&setup, prescribed_count), setup.name);
        }
    }
}

/// The mechanism a few kilometres away: differences of large numbers must not cost digits on either side.
#[test]
fn val_every_joint_far_away() {
    for setup in crate::mechanisms::all() {
        let setup = setup.moved(vec2(3e3, -2e3));
        check(&let_go(&setup, 0), setup.name);
    }
}

/// Motors along coordinates that no actuator has: of every body against the ground.
#[test]
fn val_motors_along_any_coordinate() {
    for setup in crate::mechanisms::all() {
        for prescribed_count in 0..setup.mechanism.actuators.len() {
            let mut plant = let_go(&setup, prescribed_count);
            let last = BodyId(setup.masses.len() - 1);
            plant.drive_along(Coordinate::Angle([last, GROUND]), motor());
            let points = [vec2(-2.0, 3.0), vec2(0.3, 0.2)];
            let bodies = [GROUND, last];
            plant.drive_along(Coordinate::Length { bodies, points }, motor());
            check(&plant, setup.name);
        }
    }
}

#[test]
fn val_motors_on_led_coordinates() {
    for setup in crate::mechanisms::all() {
        if setup.mechanism.actuators.len() > 1 {
            let mut plant = let_go(&setup, 1);
            let along = plant.mechanism.actuators[0].coordinate();
            plant.drive_along(along, motor());
            check(&plant, setup.name);
        }
    }
}

/// The teeth of every gear and rack push each other apart. The motion is the same: both sides must find the reactions
/// of the bearings.
#[test]
fn val_teeth_with_a_pressure_angle() {
    let mut count = 0;
    for setup in crate::mechanisms::all() {
        let joints = setup.mechanism.joints.iter().enumerate();
        let separating = joints.filter_map(|(j, joint)| Load::separating(joint, JointId(j), 0.4));
        let separating: Vec<Load> = separating.collect();
        if separating.is_empty() {
            continue;
        }
        count += separating.len();
        let mut plant = let_go(&setup, 0);
        let plain = plant.model_motion(0.2, 4);
        for load in separating {
            plant.load(&load.name, load.kind, load.magnitude);
        }
        check(&plant, setup.name);
        let reactions = |motion: &[MotionSample]| motion.last().map(|s| s.reactions.clone());
        assert_ne!(reactions(&plain), reactions(&plant.model_motion(0.2, 4)));
    }
    assert!(count >= 3, "{count}");
}
