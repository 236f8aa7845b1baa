//! Balances: of power, of each body, of the whole mechanism on its frame.

use crate::scenes::{Case, all};
use dwell_geometry::{BodyId, Vec2};
use dwell_kinetostatics::{Act, By, Ledger, Wrench};

/// Visits every case in all its states, with what acts on its bodies there.
fn each_state(mut check: impl FnMut(&Case, &Ledger, &[Act])) {
    for mut case in all() {
        let ledger = Ledger::new(&case.mechanism, &case.model).expect("every reaction");
        let mut acts = Vec::new();
        for (t, q, q_dot, q_ddot) in case.states() {
            case.run(t, &q, &q_dot, &q_ddot);
            ledger.acts(&case.model, &case.work, &case.actions, &mut acts);
            check(&case, &ledger, &acts);
        }
    }
}

#[test]
fn power_is_balanced() {
    for mut case in all() {
        for (t, q, q_dot, q_ddot) in case.states() {
            case.run(t, &q, &q_dot, &q_ddot);
            let power = case.model.power(&case.work, &case.actions);
            assert!(power.scale > 0.1 && power.loads != 0.0);
            let off = power.residual().abs() / power.scale;
            assert!(off < 1e-13, "{}: {off:e}", case.name);
        }
    }
}

/// Newton's and Euler's equations of every moving body, from what joints, actuators and loads do to
/// it: force and moment about its root.
#[test]
fn every_body_is_balanced() {
    each_state(|case, _, acts| {
        let states = case.work.states();
        for b in 0..case.mechanism.bodies.len() {
            let id = BodyId(b);
            if b == case.mechanism.ground {
                continue;
            }
            let mass = case.masses[b];
            let body = states.body(id);
            let arm = body.arm(mass.center);
            let rate = body.acceleration_at(arm) * mass.mass;
            let mut force = -rate;
            let mut moment = -(arm.cross(rate) + mass.inertia * body.spin_rate);
            let mut scale = [rate.norm(), moment.abs()];
            for act in acts.iter().filter(|a| a.body == id) {
                force += act.force;
                moment += act.moment();
                scale[0] += act.force.norm();
                scale[1] += act.arm.norm() * act.force.norm() + act.couple.abs();
            }
            // Rounding through the tree and the loops of the whole mechanism, against what acts
            // on this body.
            assert!(
                force.norm() < 1e-12 * scale[0],
                "{} {b}: {force:?} {scale:?}",
                case.name
            );
            assert!(
                moment.abs() < 1e-12 * scale[1],
                "{} {b}: {moment} {scale:?}",
                case.name
            );
        }
    });
}

/// Joints do no work; what they do to their two bodies is opposite.
#[test]
fn joints_are_ideal() {
    each_state(|case, _, acts| {
        let states = case.work.states();
        for j in 0..case.mechanism.joints.len() {
            let own = |a: &&Act| a.by == By::Joint(dwell_geometry::JointId(j));
            let (mut power, mut scale) = (0.0, 0.0);
            let mut force = Vec2::ZERO;
            for act in acts.iter().filter(own) {
                power += act.power(states);
                scale += act.power(states).abs() + act.force.norm();
                force += act.force;
            }
            assert_eq!(force, Vec2::ZERO);
            assert!(
                power.abs() < 1e-13 * scale.max(1.0),
                "{} {j}: {power}",
                case.name
            );
        }
    });
}

#[test]
fn the_frame_feels_the_same_by_momentum_and_by_reactions() {
    each_state(|case, ledger, acts| {
        let shaking = ledger.shaking(&case.model, &case.work, acts);
        let [one, two] = [shaking.by_momentum, shaking.by_reactions];
        let states = case.work.states();
        let forces = acts.iter().map(|a| a.force.norm()).sum::<f64>();
        let moment = |a: &Act| a.point(states).norm() * a.force.norm() + a.couple.abs();
        let moments = acts.iter().map(moment).sum::<f64>();
        // Against all that acts anywhere, since the forces within cancel.
        assert!(
            (one.force - two.force).norm() < 1e-13 * forces,
            "{}",
            case.name
        );
        assert!(
            (one.moment - two.moment).abs() < 1e-13 * moments,
            "{}",
            case.name
        );
        assert!(shaking.loads_on_ground != Wrench::default());
    });
}

/// A reaction that was not asked for is missed by name.
#[test]
fn a_ledger_needs_every_reaction() {
    let case = all().remove(0);
    let bare = case.model.without_reactions();
    assert!(Ledger::new(&case.mechanism, &bare).is_err());
    assert!(Ledger::new(&case.mechanism, &case.model).is_ok());
}
