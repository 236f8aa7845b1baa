//! Redundant joints, revolutions, a slot with friction, many bodies.

use crate::machines::{describe, findings_for};
use crate::plant::{DOWN, GROUND, Plant};
use dwell_findings::all_pass;
use dwell_geometry::{ActuatorKind, Coordinate, JointKind, vec2};
use dwell_kinetostatics::{Friction, FrictionContact, Guide, LoadKind, Magnitude, Signal};
use dwell_laws::{Law, Polynomial};

const G: f64 = 9.81;

#[track_caller]
fn check(plant: &Plant, until: f64, count: usize) {
    let claimed_motion = plant.model_motion(until, count);
    let findings = findings_for(plant, &claimed_motion);
    assert!(all_pass(&findings), "{}", describe(&findings));
}

/// A coupler on three equal cranks: some reactions are not determined, the others are checked.
#[test]
fn val_joints_that_repeat_each_other() {
    let mut plant = Plant::new();
    let table = plant.bar("table", 2.0, 2.0, Some(0.0));
    let mut cranks = vec![];
    for (i, x) in [0.0, 1.0, 2.0].into_iter().enumerate() {
        let crank = plant.bar(&format!("crank {i}"), 0.5, 0.4, Some(0.7));
        plant.pin(&format!("low {i}"), (GROUND, [x, 0.0]), (crank, [0.0, 0.0]));
        plant.pin(&format!("high {i}"), (crank, [0.4, 0.0]), (table, [x, 0.0]));
        cranks.push(crank);
    }
    let bob = plant.bar("bob", 0.3, 0.5, Some(-1.0));
    plant.pin("hung", (table, [0.5, 0.0]), (bob, [0.0, 0.0]));
    plant.constant("weight", DOWN, G);
    plant.free([GROUND, cranks[0]], ActuatorKind::Angle, [0.7, 1.0]);
    plant.free([table, bob], ActuatorKind::Angle, [-1.0, 0.0]);
    // Well before the cranks come in line.
    check(&plant, 0.15, 3);
}

/// A drag link: its follower rotates on and on, against a spiral spring and a law of its angle.
#[test]
fn val_turns_are_counted() {
    let mut plant = Plant::new();
    let crank = plant.bar("crank", 5.0, 0.5, None);
    let coupler = plant.bar("coupler", 0.4, 0.6, Some(1.2));
    let follower = plant.bar("follower", 5.0, 0.6, Some(1.5));
    plant.pin("A", (GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
    plant.pin("B", (crank, [0.5, 0.0]), (coupler, [0.0, 0.0]));
    plant.pin("C", (coupler, [0.6, 0.0]), (follower, [0.6, 0.0]));
    plant.pin("D", (GROUND, [0.1, 0.0]), (follower, [0.0, 0.0]));
    let bodies = [GROUND, follower];
    plant.constant("spiral", LoadKind::torsion_spring(bodies, 0.0), 0.2);
    let law = Law::Polynomial(Polynomial {
        coefficients: vec![0.5, 0.3],
    });
    let angle = Signal::Value(Coordinate::Angle(bodies));
    plant.load("law", LoadKind::couple(bodies), Magnitude::Law(angle, law));
    plant.free([GROUND, crank], ActuatorKind::Angle, [0.4, 9.0]);
    assert!(plant.model_motion(1.0, 1)[1].poses[1][2] > 9.0);
    check(&plant, 1.0, 5);
}

/// A led crank's pin rubs in a lever's slot, and the lever carries a free one.
#[test]
fn val_a_slot_that_rubs() {
    let mut plant = Plant::new();
    let crank = plant.bar("crank", 0.5, 0.2, None);
    let lever = plant.bar("lever", 1.5, 0.9, Some(0.5));
    let bob = plant.bar("bob", 0.3, 0.5, Some(-1.0));
    plant.pin("A", (GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
    let l = plant.pin("L", (lever, [0.0, 0.0]), (GROUND, [-0.5, 0.0]));
    let axis = vec2(1.0, 0.0);
    let slot = plant.joint(
        "slot",
        (lever, [0.0, 0.05]),
        (crank, [0.2, 0.0]),
        JointKind::Slot { axis },
    );
    plant.pin("hung", (lever, [0.9, 0.0]), (bob, [0.0, 0.0]));
    plant.constant("weight", DOWN, G);
    let along = Guide {
        bodies: [lever, crank],
        points: [vec2(0.0, 0.05), vec2(0.2, 0.0)],
        axis,
    };
    let friction = |joint, contact| {
        Magnitude::Friction(Friction {
            joint,
            coefficient: 0.2,
            static_coefficient: 0.2,
            contact,
            regularization_speed: Some(0.5),
        })
    };
    plant.load(
        "slot rubs",
        LoadKind::slide_force(along),
        friction(slot, FrictionContact::Guide { length: 0.0 }),
    );
    let bodies = [lever, GROUND];
    plant.load(
        "L rubs",
        LoadKind::couple(bodies),
        friction(l, FrictionContact::Pin { radius: 0.03 }),
    );
    let law = Law::Polynomial(Polynomial::motion(0.4, 5.0, 2.0));
    plant.prescribed([GROUND, crank], law);
    plant.free([lever, bob], ActuatorKind::Angle, [-1.5, 0.0]);
    check(&plant, 0.5, 5);
}

/// A crank-rocker with six dyads on it, one after the other.
#[test]
fn val_many_bodies() {
    let mut plant = Plant::new();
    let crank = plant.bar("crank", 5.0, 0.1, None);
    plant.pin("A", (GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
    let mut last = (crank, [0.1, 0.0]);
    for i in 0..7 {
        let x = 1.0 + 0.9 * f64::from(i);
        let link = plant.bar(&format!("link {i}"), 0.3, 1.0, Some(0.5));
        let rocker = plant.bar(&format!("rocker {i}"), 0.4, 0.7, Some(1.6));
        plant.pin(&format!("near {i}"), last, (link, [0.0, 0.0]));
        plant.pin(
            &format!("top {i}"),
            (link, [1.0, 0.0]),
            (rocker, [0.7, 0.0]),
        );
        plant.pin(
            &format!("foot {i}"),
            (GROUND, [x, 0.0]),
            (rocker, [0.0, 0.0]),
        );
        last = (rocker, [0.6, 0.05]);
    }
    plant.constant("weight", DOWN, G);
    plant.free([GROUND, crank], ActuatorKind::Angle, [0.4, 12.0]);
    check(&plant, 1.2, 20);
}
