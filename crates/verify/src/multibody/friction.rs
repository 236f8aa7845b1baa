//! Coulomb friction and the separating forces of teeth: each depends on reactions, which depend on all of them.
//!
//! ```text
//! F_j = −µ g(R_j) tanh(v/v₀),    R = R⁰ + Σ F_k R^k
//! g = r √(X² + Y²)  in a pin,    |N/2 + M/l| + |N/2 − M/l|  in a guide of length l
//! S_j = tan α |T_j|  of teeth with the pressure angle α and the tooth force T
//! ```

use super::equations::MultibodyOde;
use super::state::MultibodyState;
use super::{MultibodyError, MultibodySystem, Result};
use crate::body_motion::slide_axis;
use crate::dense::add_scaled;
use crate::loads::reaction_row;
use crate::lu::Lu;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{Component, JointKind};
use dwell_kinetostatics::{
    Friction, FrictionContact, Load, LoadKind, Magnitude, PressureAngle, Strength,
};
use faer::Mat;

const MAX_NEWTON_STEPS: usize = 100;
/// Newton's change of a friction, relative to the largest, that is none.
const CONVERGED_CHANGE: f64 = 1e-15;

/// Whether a load answers to the reactions of its joint.
pub(super) fn depends_on_reactions(magnitude: &Magnitude) -> bool {
    match magnitude {
        Magnitude::Friction(_) | Magnitude::Separating(_) => true,
        Magnitude::Constant(_)
        | Magnitude::Law(..)
        | Magnitude::Expression(..)
        | Magnitude::Function(..)
        | Magnitude::External(_) => false,
    }
}

impl MultibodySystem {
    pub(super) fn check_friction(&self, kind: &LoadKind, friction: &Friction) -> bool {
        let Some(joint) = self.mechanism.joints.get(friction.joint.0) else {
            return false;
        };
        let on_pin = *kind == LoadKind::couple(joint.bodies);
        let on_slide = matches!(
            kind,
            LoadKind::Along(CoordinateFunction::Travel(guide), Strength::Direct) if guide.bodies == joint.bodies
        );
        on_pin && joint.kind == JointKind::Revolute || on_slide && slide_axis(joint.kind).is_some()
    }

    /// Whether a separating force is that of the teeth of its joint.
    pub(super) fn check_teeth(&self, kind: &LoadKind, teeth: &PressureAngle) -> bool {
        let LoadKind::Special(mesh) = kind else {
            return false;
        };
        let joint = self.mechanism.joints.get(teeth.joint.0);
        let fits = joint.is_some_and(|joint| match joint.kind {
            JointKind::Gear { .. } | JointKind::Rack { .. } => {
                (joint.bodies, joint.points) == (mesh.bodies, mesh.points)
            }
            JointKind::Revolute
            | JointKind::Prismatic { .. }
            | JointKind::Slot { .. }
            | JointKind::Weld { .. }
            | JointKind::Rolling { .. }
            | JointKind::Distance { .. }
            | JointKind::Coupling(_) => false,
        });
        fits && teeth.angle.is_finite()
    }

    /// The loads that answer to reactions.
    pub(super) fn frictions(&self) -> Vec<usize> {
        let depends = |load: &usize| depends_on_reactions(&self.loads[*load].magnitude);
        (0..self.loads.len()).filter(depends).collect()
    }

    /// µ sign(v) or µ tanh(v/v₀), or −tan α.
    fn factor(&self, load: &Load, at: &MultibodyState) -> Option<f64> {
        if let Magnitude::Separating(teeth) = &load.magnitude {
            return Some(-teeth.angle.tan());
        }
        let Magnitude::Friction(friction) = &load.magnitude else {
            return None;
        };
        let LoadKind::Along(along, Strength::Direct) = load.kind else {
            return None;
        };
        let [_, velocity] = match along {
            CoordinateFunction::Travel(guide) => {
                at.motion().travel(guide.bodies, guide.points, guide.axis)?
            }
            CoordinateFunction::Angle(bodies) => at.motion().angle(bodies)?,
            CoordinateFunction::Length { .. } => return None,
        };
        let sign = match friction.regularization_speed {
            Some(speed) => (velocity / speed).tanh(),
            None if velocity == 0.0 => 0.0,
            None => velocity.signum(),
        };
        Some(friction.coefficient * sign)
    }

    /// g or |T|, with its derivative by every row that it depends on.
    fn contact_force(&self, load: &Load, reactions: &[f64]) -> (f64, Vec<(usize, f64)>) {
        let row_of = |joint, component| {
            let row = reaction_row(&self.mechanism, joint, component)?;
            Some((row, reactions[row]))
        };
        let magnitude = |(row, force): (usize, f64)| (force.abs(), vec![(row, force.signum())]);
        let none = (f64::NAN, vec![]);
        if let Magnitude::Separating(teeth) = &load.magnitude {
            return row_of(teeth.joint, Component::Tooth).map_or(none, magnitude);
        }
        let Magnitude::Friction(friction) = &load.magnitude else {
            return none;
        };
        let row = |component| row_of(friction.joint, component);
        let size = match friction.contact {
            FrictionContact::Pin { radius: size } | FrictionContact::Guide { length: size } => size,
            // Of a joint in space.
            FrictionContact::Bearing { .. } => return none,
        };
        if let (Some((i, x)), Some((j, y))) = (row(Component::X), row(Component::Y)) {
            let force = x.hypot(y);
            if force == 0.0 {
                return (0.0, vec![]);
            }
            let slope = size / force;
            return (size * force, vec![(i, slope * x), (j, slope * y)]);
        }
        let Some((i, n)) = row(Component::Normal) else {
            return (0.0, vec![]);
        };
        match row(Component::Moment) {
            Some((j, m)) if size > 0.0 => {
                let [near, far] = [1.0, -1.0].map(|side| 0.5 * n + side * m / size);
                let (s, t) = (near.signum(), far.signum());
                let gradient = vec![(i, 0.5 * (s + t)), (j, (s - t) / size)];
                (near.abs() + far.abs(), gradient)
            }
            _ => magnitude((i, n)),
        }
    }
}

impl MultibodyOde<'_> {
    /// The friction forces that agree with the reactions which they cause: those without these loads, and what a
    /// unit of each adds.
    pub(super) fn solve_friction(
        &self,
        frictions: &[usize],
        frictionless: &[f64],
        unit_reactions: &[Vec<f64>],
        at: &MultibodyState,
    ) -> Result<Vec<f64>> {
        let n = frictions.len();
        if n == 0 {
            return Ok(vec![]);
        }
        let self_locking = MultibodyError::SelfLocking(at.t);
        let loads = || frictions.iter().map(|&load| &self.system.loads[load]);
        let factors: Option<Vec<f64>> = loads().map(|load| self.system.factor(load, at)).collect();
        let factors = factors.ok_or(MultibodyError::NotFinite(at.t))?;
        let mut force = vec![0.0_f64; n];
        for _ in 0..MAX_NEWTON_STEPS {
            let mut reactions = frictionless.to_vec();
            for (force, unit) in force.iter().zip(unit_reactions) {
                add_scaled(&mut reactions, *force, unit);
            }
            let mut matrix = Mat::<f64>::identity(n, n);
            let mut step = Mat::zeros(n, 1);
            for (j, (load, factor)) in loads().zip(&factors).enumerate() {
                let (contact_force, gradient) = self.system.contact_force(load, &reactions);
                step[(j, 0)] = -(force[j] + factor * contact_force);
                for (k, unit) in unit_reactions.iter().enumerate() {
                    let sensitivity: f64 = gradient.iter().map(|&(row, s)| s * unit[row]).sum();
                    matrix[(j, k)] += factor * sensitivity;
                }
            }
            let lu = Lu::new(matrix).map_err(|_| self_locking)?;
            lu.solve(&mut step);
            let (mut change, mut largest) = (0.0_f64, 0.0_f64);
            for (j, force) in force.iter_mut().enumerate() {
                *force += step[(j, 0)];
                if !force.is_finite() {
                    return Err(self_locking);
                }
                change = change.max(step[(j, 0)].abs());
                largest = largest.max(force.abs());
            }
            if change <= CONVERGED_CHANGE * largest {
                return Ok(force);
            }
        }
        Err(self_locking)
    }
}
