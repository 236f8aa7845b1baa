//! Every joint and every drive in free motion: the mechanisms of the kinetostatic states, let go.

use crate::machines::{judged, told};
use crate::plant::{GROUND, Plant};
use crate::setup::Setup;
use dwell_dynamics::{DriveKind, Motor};
use dwell_findings::all_pass;
use dwell_geometry::{Actuator, BodyId, Coordinate, Joint, JointKind, Vec2, vec2};
use dwell_kinetostatics::Magnitude;
use dwell_laws::{Law, Polynomial};

/// Let go at the coordinates of the start, with the actuators before `led` prescribed.
fn let_go(setup: &Setup, led: usize) -> Plant {
    let mut plant = Plant::new();
    plant.mechanism = setup.mechanism.clone();
    let actuators = std::mem::take(&mut plant.mechanism.actuators);
    plant.masses = setup.masses.clone();
    plant.rough = setup.start.iter().map(|pose| Some(pose[2])).collect();
    for (i, (kind, magnitude)) in setup.loads.iter().enumerate() {
        plant.constant(&format!("load {i}"), *kind, *magnitude);
    }
    // Two bars may close in two ways that turn no body.
    plant.told = told_distances(setup);
    // The last motion is at the start itself.
    let [q, _, _] = setup.motions.last().unwrap();
    let speeds = [0.5, -0.3];
    for (i, Actuator { bodies, drive, .. }) in actuators.into_iter().enumerate() {
        if i < led {
            let law = Law::Polynomial(Polynomial::motion(q[i], speeds[i], 0.8));
            plant.led_along(bodies, drive, law);
        } else {
            plant.free(bodies, drive, [q[i], speeds[i]]);
        }
    }
    plant
}

/// The directions of the distances.
fn told_distances(setup: &Setup) -> Vec<Option<f64>> {
    let direction = |joint: &Joint| {
        let [one, two] = [0, 1].map(|i| {
            let [x, y, angle] = setup.start[joint.bodies[i].0];
            vec2(x, y) + joint.points[i].turn(Vec2::from_angle(angle))
        });
        let told = matches!(joint.kind, JointKind::Distance { .. });
        told.then(|| (two - one).angle())
    };
    setup.mechanism.joints.iter().map(direction).collect()
}

fn motor() -> DriveKind {
    DriveKind::Motor(Motor {
        voltage: Magnitude::Constant(20.0),
        constant: 0.3,
        resistance: 0.5,
        inductance: 0.02,
        ratio: 3.0,
        inertia: 0.05,
    })
}

fn check(plant: &Plant, name: &str) {
    let claims = plant.claims(0.2, 4);
    let findings = judged(plant, &claims);
    println!("{name}\n{}", told(&findings));
    assert!(all_pass(&findings), "{name}\n{}", told(&findings));
}

#[test]
fn val_every_joint_in_free_motion() {
    for setup in crate::mechanisms::all() {
        for led in 0..setup.mechanism.actuators.len() {
            check(&let_go(&setup, led), setup.name);
        }
    }
}

/// The same a few kilometres away: differences of large numbers must cost neither side its digits.
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
        for led in 0..setup.mechanism.actuators.len() {
            let mut plant = let_go(&setup, led);
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
