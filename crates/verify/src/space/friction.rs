//! Dry friction in the joints of a claimed state: its forces from reactions of the dense equations, and from speeds of theirs.
//!
//! ```text
//! R = R⁰ + Σ F_k R^k,    F_j = −φ_j g(R_j)                                                                    (1)
//! N = |f₁| + |f₂|,  f₁ + f₂ = F across u,  ½ L u × (f₁ − f₂) = M across u;  without L:  N = |F across u|       (2)
//! ```
//!
//! with R⁰ the reactions without friction and R^k what a unit of friction k adds: the dense equations are linear in the loads.

use super::DensePose;
use super::state::SpaceCase;
use crate::error::Result;
use dwell_geometry::space::{BodyMotion, Joint, JointKind, Placement, Vec3, Wrench};
use dwell_kinetostatics::LoadShape as _;
use dwell_kinetostatics::space::LoadKind;
use dwell_kinetostatics::{Friction, FrictionContact};

/// Substitutions of (1) in itself at most, and their change that is none.
const MAX_ROUNDS: usize = 400;
const NO_CHANGE: f64 = 1e-16;

/// The loads with the forces of those that are friction, which are given for them by load: in a state at these placements, with speeds and
/// accelerations of the actuators.
///
/// # Errors
/// [`DenseError`](crate::DenseError) where the equations have no singular values.
pub fn with_friction_in_space(
    case: &SpaceCase<'_>,
    placements: &[Placement],
    rates: [&[f64]; 2],
    (loads, frictions): (&[(LoadKind, f64)], &[Option<Friction>]),
) -> Result<Vec<(LoadKind, f64)>> {
    let pose = DensePose::new(case.mechanism, case.masses, placements)?;
    let rest = vec![0.0; rates[0].len()];
    let own = pose.solve(rates, loads);
    let indices = (0..loads.len()).filter(|&load| frictions[load].is_some());
    let indices: Vec<usize> = indices.collect();
    let mass_free = vec![dwell_kinetostatics::space::Mass::default(); case.masses.len()];
    let unloaded = DensePose::new(case.mechanism, &mass_free, placements)?;
    let units: Vec<Vec<Wrench>> = indices
        .iter()
        .map(|&load| {
            let unit = [(loads[load].0, 1.0)];
            unloaded.solve([&rest, &rest], &unit).reactions
        })
        .collect();
    let mut forces = vec![0.0; indices.len()];
    for _ in 0..MAX_ROUNDS {
        let mut change = 0.0_f64;
        for k in 0..indices.len() {
            let Some(friction) = &frictions[indices[k]] else {
                continue;
            };
            let joint = &case.mechanism.joints[friction.joint.0];
            let mut reaction = own.reactions[friction.joint.0];
            for (force, unit) in forces.iter().zip(&units) {
                reaction.force += unit[friction.joint.0].force.scaled(*force);
                reaction.moment += unit[friction.joint.0].moment.scaled(*force);
            }
            let law = Law {
                joint,
                friction,
                placements,
                motions: &own.motions,
            };
            let force = -law.factor(loads[indices[k]].0) * law.press(&reaction);
            change = change.max((force - forces[k]).abs() / force.abs().max(f64::MIN_POSITIVE));
            forces[k] = force;
        }
        if change <= NO_CHANGE {
            break;
        }
    }
    let mut all = loads.to_vec();
    for (load, force) in indices.into_iter().zip(forces) {
        all[load].1 = force;
    }
    Ok(all)
}

/// The rates of the travel along the axis of a friction's joint and of the angle about it, in m/s and rad/s, at speeds of the actuators.
///
/// # Errors
/// As of [`with_friction_in_space`].
pub fn sliding_in_space(
    case: &SpaceCase<'_>,
    placements: &[Placement],
    q_dot: &[f64],
    friction: &Friction,
) -> Result<[f64; 2]> {
    let pose = DensePose::new(case.mechanism, case.masses, placements)?;
    let law = Law {
        joint: &case.mechanism.joints[friction.joint.0],
        friction,
        placements,
        motions: &pose.velocities(q_dot),
    };
    Ok(law.speeds())
}

/// The law of the friction of a joint in a state.
struct Law<'a> {
    joint: &'a Joint,
    friction: &'a Friction,
    placements: &'a [Placement],
    motions: &'a [BodyMotion],
}

impl Law<'_> {
    fn axis(&self) -> Vec3 {
        let body = self.joint.side_body(0).0;
        let axis = self.placements[body]
            .rotation
            .apply(self.joint.sides[0].axis);
        axis.unit().unwrap_or(axis)
    }

    /// The rates of the travel along the axis and of the angle about it.
    fn speeds(&self) -> [f64; 2] {
        let of = |k: usize| {
            let body = self.joint.side_body(k).0;
            let arm = self.placements[body]
                .rotation
                .apply(self.joint.sides[k].point);
            let motion = &self.motions[body];
            (motion.point_velocity(arm), motion.angular_velocity)
        };
        let ((v_a, w_a), (v_b, w_b)) = (of(0), of(1));
        let u = self.axis();
        // Along the axis the points differ by a multiple of it, which the rotation of the first body does not lengthen.
        [u.dot(v_b - v_a), u.dot(w_b - w_a)]
    }

    /// φ g/N: the factor of the bearing force, against the velocity along the load.
    fn factor(&self, kind: LoadKind) -> f64 {
        let [travel, turn] = self.speeds();
        let radius = match self.friction.contact {
            FrictionContact::Bearing { radius, .. } => radius,
            FrictionContact::Guide { .. } | FrictionContact::Pin { .. } => 1.0,
        };
        let is_couple = kind.is_couple();
        let mu = self.friction.coefficient;
        let smoothed = |speed: f64| match self.friction.regularization_speed {
            Some(slow) => (speed / slow).tanh(),
            None if speed == 0.0 => 0.0,
            None => speed.signum(),
        };
        if self.joint.kind == JointKind::Cylindrical {
            let surface = [travel, radius * turn];
            let speed = surface[0].hypot(surface[1]);
            let part = if speed == 0.0 {
                0.0
            } else {
                surface[usize::from(is_couple)] / speed
            };
            let lever = if is_couple { radius } else { 1.0 };
            return mu * smoothed(speed) * part * lever;
        }
        match is_couple {
            true => mu * smoothed(turn) * radius,
            false => mu * smoothed(travel),
        }
    }

    /// N of (2).
    fn press(&self, reaction: &Wrench) -> f64 {
        let u = self.axis();
        let across = |v: Vec3| v - u.scaled(u.dot(v));
        let force = across(reaction.force);
        let distance = match self.friction.contact {
            FrictionContact::Bearing { distance, .. } => distance,
            FrictionContact::Guide { length } => length,
            FrictionContact::Pin { .. } => 0.0,
        };
        if distance == 0.0 {
            return force.norm();
        }
        let difference = across(reaction.moment).cross(u).scaled(2.0 / distance);
        let bearings = [1.0, -1.0].map(|side| (force + difference.scaled(side)).scaled(0.5));
        bearings[0].norm() + bearings[1].norm()
    }
}
