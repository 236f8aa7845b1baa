//! Dry friction: forces that agree with the reactions that they cause, by Newton's method.
//!
//! ```text
//! F_j = −φ_j (|f₁| + |f₂|),    f = f⁰ + Σ F_k f^k
//! ```
//!
//! with the forces f in the two bearings of the joint of friction j, which are linear in all forces, and φ by the speed. Of a reaction F, M
//! about a point of the axis u, with bearings L apart,
//!
//! ```text
//! f₁ + f₂ = F across u,    ½ L u × (f₁ − f₂) = M across u;    without L:  f₁ = F across u
//! ```

use crate::lu::Lu;
use dwell_geometry::space::{Vec3, Wrench};
use dwell_kinetostatics::{Friction, FrictionContact};
use faer::Mat;

const MAX_NEWTON_STEPS: usize = 100;
/// Newton's change of a friction, relative to the largest, that is none.
const CONVERGED_CHANGE: f64 = 1e-15;

/// The forces in the two bearings of a joint.
pub(crate) type Bearings = [Vec3; 2];

/// The bearing forces under a reaction of a joint with this axis.
pub(crate) fn bearings(friction: &Friction, u: Vec3, reaction: &Wrench) -> Bearings {
    let across = |v: Vec3| v - u.scaled(u.dot(v));
    let force = across(reaction.force);
    let distance = match friction.contact {
        FrictionContact::Bearing { distance, .. } => distance,
        FrictionContact::Guide { length } => length,
        FrictionContact::Pin { .. } => 0.0,
    };
    if distance == 0.0 {
        return [force, Vec3::ZERO];
    }
    let difference = across(reaction.moment).cross(u).scaled(2.0 / distance);
    [1.0, -1.0].map(|side| (force + difference.scaled(side)).scaled(0.5))
}

/// A force that depends on the bearing forces of a joint.
pub(crate) struct Contact {
    /// φ.
    pub(crate) factor: f64,
    /// The bearing forces without all such forces, and the contribution of a unit of each.
    pub(crate) own: Bearings,
    pub(crate) units: Vec<Bearings>,
}

impl Contact {
    fn bearings(&self, forces: &[f64]) -> Bearings {
        let mut all = self.own;
        for (force, unit) in forces.iter().zip(&self.units) {
            for (bearing, unit) in all.iter_mut().zip(unit) {
                *bearing += unit.scaled(*force);
            }
        }
        all
    }
}

/// µ sign(v) or µ tanh(v/v₀).
pub(crate) fn coefficient_at(friction: &Friction, speed: f64) -> f64 {
    let sign = match friction.regularization_speed {
        Some(slow) => (speed / slow).tanh(),
        None if speed == 0.0 => 0.0,
        None => speed.signum(),
    };
    friction.coefficient * sign
}

/// The forces of all contacts; `None` if friction locks itself.
pub(crate) fn contact_forces(contacts: &[Contact]) -> Option<Vec<f64>> {
    let n = contacts.len();
    let mut forces = vec![0.0_f64; n];
    if n == 0 {
        return Some(forces);
    }
    for _ in 0..MAX_NEWTON_STEPS {
        let mut matrix = Mat::<f64>::identity(n, n);
        let mut step = Mat::zeros(n, 1);
        for (j, contact) in contacts.iter().enumerate() {
            let bearings = contact.bearings(&forces);
            let norms = bearings.map(|bearing| bearing.norm());
            step[(j, 0)] = -(forces[j] + contact.factor * (norms[0] + norms[1]));
            for (k, unit) in contact.units.iter().enumerate() {
                for side in [0, 1].into_iter().filter(|&side| norms[side] > 0.0) {
                    let slope = bearings[side].dot(unit[side]) / norms[side];
                    matrix[(j, k)] += contact.factor * slope;
                }
            }
        }
        Lu::new(matrix).ok()?.solve(&mut step);
        let (mut change, mut largest) = (0.0_f64, 0.0_f64);
        for (j, force) in forces.iter_mut().enumerate() {
            *force += step[(j, 0)];
            if !force.is_finite() {
                return None;
            }
            change = change.max(step[(j, 0)].abs());
            largest = largest.max(force.abs());
        }
        if change <= CONVERGED_CHANGE * largest {
            return Some(forces);
        }
    }
    None
}
