//! Coulomb friction and the separating forces of teeth as contacts: each depends on reactions, which depend on all of them.
//!
//! ```text
//! F = −µ g(R) tanh(v/v₀)
//! g = r √(X² + Y²)  in a pin,    |N/2 + M/l| + |N/2 − M/l|  in a guide of length l
//! S = tan α |T|  of teeth with the pressure angle α and the tooth force T
//! ```

use super::equations::MultibodyOde;
use super::state::MultibodyState;
use super::{MultibodyError, MultibodySystem, Result};
use crate::body_motion::slide_axis;
use crate::friction::{Bearings, Contact, bearings, coefficient_at, contact_forces};
use crate::loads::reaction_row;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::space::{Vec3, Wrench, vec3};
use dwell_geometry::{Component, JointKind};
use dwell_kinetostatics::{
    Friction, FrictionContact, Load, LoadKind, Magnitude, PressureAngle, Strength,
};

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
        let fits = joint.is_some_and(|joint| {
            let has_teeth = matches!(joint.kind, JointKind::Gear { .. } | JointKind::Rack { .. });
            has_teeth && (joint.bodies, joint.points) == (mesh.bodies, mesh.points)
        });
        fits && teeth.angle.is_finite()
    }

    /// The loads that answer to reactions.
    pub(super) fn frictions(&self) -> Vec<usize> {
        let depends = |load: &usize| depends_on_reactions(&self.loads[*load].magnitude);
        (0..self.loads.len()).filter(depends).collect()
    }

    /// φ: µ sign(v) or µ tanh(v/v₀), in a pin times its radius; or −tan α.
    fn factor(&self, load: &Load, at: &MultibodyState) -> Option<f64> {
        if let Magnitude::Separating(teeth) = &load.magnitude {
            return Some(-teeth.angle.tan());
        }
        let friction = load.friction()?;
        let LoadKind::Along(along, Strength::Direct) = load.kind else {
            return None;
        };
        let (lever, [_, speed]) = match along {
            CoordinateFunction::Travel(guide) => (
                1.0,
                at.motion().travel(guide.bodies, guide.points, guide.axis)?,
            ),
            CoordinateFunction::Angle(bodies) => match friction.contact {
                FrictionContact::Pin { radius } => (radius, at.motion().angle(bodies)?),
                // Of a guide, or of a joint in space.
                FrictionContact::Guide { .. } | FrictionContact::Bearing { .. } => return None,
            },
            CoordinateFunction::Length { .. } => return None,
        };
        Some(coefficient_at(&friction, speed) * lever)
    }

    /// The forces in the bearings of a load's joint under some reactions, in axes of the joint.
    fn bearings(&self, load: &Load, reactions: &[f64]) -> Bearings {
        let of = |joint, component| {
            let row = reaction_row(&self.mechanism, joint, component);
            row.map(|row| reactions[row])
        };
        if let Magnitude::Separating(teeth) = &load.magnitude {
            let force = of(teeth.joint, Component::Tooth).unwrap_or(f64::NAN);
            return [vec3(force, 0.0, 0.0), Vec3::ZERO];
        }
        let Some(friction) = load.friction() else {
            return Bearings::default();
        };
        let part = |component| of(friction.joint, component);
        let mut reaction = Wrench::default();
        if let (Some(x), Some(y)) = (part(Component::X), part(Component::Y)) {
            reaction.force = vec3(x, y, 0.0);
            return bearings(&friction, Vec3::AXES[2], &reaction);
        }
        // The axis of a slide is x there.
        reaction.force.y = part(Component::Normal).unwrap_or(0.0);
        reaction.moment.z = part(Component::Moment).unwrap_or(0.0);
        bearings(&friction, Vec3::AXES[0], &reaction)
    }
}

impl MultibodyOde<'_> {
    /// The friction forces that are consistent with the reactions that they cause, from the reactions without these
    /// loads and the contribution of a unit of each.
    pub(super) fn solve_friction(
        &self,
        frictions: &[usize],
        frictionless: &[f64],
        unit_reactions: &[Vec<f64>],
        at: &MultibodyState,
    ) -> Result<Vec<f64>> {
        let contact = |&load: &usize| {
            let load = &self.system.loads[load];
            let units = unit_reactions.iter();
            Some(Contact {
                factor: self.system.factor(load, at)?,
                own: self.system.bearings(load, frictionless),
                units: units.map(|unit| self.system.bearings(load, unit)).collect(),
            })
        };
        let contacts: Option<Vec<Contact>> = frictions.iter().map(contact).collect();
        let contacts = contacts.ok_or(MultibodyError::NotFinite(at.t))?;
        contact_forces(&contacts).ok_or(MultibodyError::SelfLocking(at.t))
    }
}
