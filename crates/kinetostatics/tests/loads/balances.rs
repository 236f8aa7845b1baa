//! Balances: of power, of each body, of the whole mechanism on its frame.

use crate::scenes::{Case, all};
use dwell_geometry::{BodyId, Vec2};
use dwell_kinetostatics::{AppliedWrench, EvaluatedState, ForceSource, FreeBodyForces, Wrench};

/// Visits every case in all its states, with the forces on its bodies there.
fn each_state(check: impl Fn(&Case, &EvaluatedState<'_>, &FreeBodyForces, &[AppliedWrench])) {
    for case in all() {
        let free_body_forces = FreeBodyForces::new(&case.model).expect("every reaction");
        let (mut memory, mut wrenches) = (case.memory(), Vec::new());
        for (t, q, q_dot, q_ddot) in case.states() {
            let state = case.evaluate(&mut memory, t, &q, &q_dot, &q_ddot);
            free_body_forces.wrenches(&state, &mut wrenches);
            check(&case, &state, &free_body_forces, &wrenches);
        }
    }
}

#[test]
fn power_is_balanced() {
    each_state(|case, state, _, _| {
        let power = state.power_balance();
        assert!(power.scale > 0.1 && power.loads != 0.0);
        let difference = power.residual().abs() / power.scale;
        assert!(difference < 1e-13, "{}: {difference:e}", case.name);
    });
}

/// Newton's and Euler's equations of every moving body, from the wrenches of joints, actuators and loads on it: force
/// and moment about its root.
#[test]
fn every_body_is_balanced() {
    each_state(|case, state, _, wrenches| {
        let states = state.bodies();
        for b in 0..case.mechanism.bodies.len() {
            let id = BodyId(b);
            if b == case.mechanism.ground {
                continue;
            }
            let mass = case.masses[b];
            let body = states.body(id);
            let center_offset = body.moment_arm(mass.center);
            let rate = body.acceleration_at(center_offset) * mass.mass;
            let mut force = -rate;
            let mut moment =
                -(center_offset.cross(rate) + mass.inertia * body.angular_acceleration);
            let mut scale = [rate.norm(), moment.abs()];
            for wrench in wrenches.iter().filter(|a| a.body == id) {
                force += wrench.force;
                moment += wrench.moment();
                scale[0] += wrench.force.norm();
                scale[1] += wrench.moment_arm.norm() * wrench.force.norm() + wrench.couple.abs();
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

/// Joints do no work; their actions on the two bodies are opposite.
#[test]
fn joints_are_ideal() {
    each_state(|case, state, _, wrenches| {
        let states = state.bodies();
        for j in 0..case.mechanism.joints.len() {
            let of_joint =
                |a: &&AppliedWrench| a.source == ForceSource::Joint(dwell_geometry::JointId(j));
            let (mut power, mut scale) = (0.0, 0.0);
            let mut force = Vec2::ZERO;
            for wrench in wrenches.iter().filter(of_joint) {
                power += wrench.power(states);
                scale += wrench.power(states).abs() + wrench.force.norm();
                force += wrench.force;
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
    each_state(|case, state, free_body_forces, wrenches| {
        let shaking = free_body_forces.shaking_force(state, wrenches);
        let [one, two] = [shaking.from_momentum, shaking.from_reactions];
        let states = state.bodies();
        let forces = wrenches.iter().map(|a| a.force.norm()).sum::<f64>();
        let moment = |a: &AppliedWrench| a.point(states).norm() * a.force.norm() + a.couple.abs();
        let moments = wrenches.iter().map(moment).sum::<f64>();
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

/// The error names a reaction that was not requested.
#[test]
fn a_ledger_needs_every_reaction() {
    let case = all().remove(0);
    let without_reactions = case.model.without_reactions();
    assert!(FreeBodyForces::new(&without_reactions).is_err());
    assert!(FreeBodyForces::new(&case.model).is_ok());
}
