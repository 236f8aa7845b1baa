//! Multipliers of the loops by the transposed factors, group by group in reverse order, and the forces and moments in the joints.

use super::plan::{JointPlace, Plan, Pose};
use super::wrench::Wrench;
use crate::mechanism::JointId;
use dwell_numerics::{Scalar, qr};

/// The forces of one pass, for one thread.
#[derive(Debug, Clone, PartialEq)]
pub struct Forces<T = f64> {
    /// By body: what moves it less the loads on it, about its [evaluation frame](Plan::frame)'s origin. The caller sets it.
    pub required: Vec<Wrench<T>>,
    /// By body: what the joint of the tree transmits to it and all that it carries.
    transmitted: Vec<Wrench<T>>,
    balance: Vec<T>,
    multipliers: Vec<T>,
    /// By closure: its force and couple on the second body, at the point of that body.
    closure_actions: Vec<Wrench<T>>,
}

impl Plan {
    /// Memory for the forces of one pass.
    pub fn forces<T: Scalar>(&self) -> Forces<T> {
        let zero = T::from_f64(0.0);
        Forces {
            required: vec![Wrench::default(); self.tree.internal.len()],
            transmitted: vec![Wrench::default(); self.tree.internal.len()],
            balance: vec![zero; self.tree.freedoms.len()],
            multipliers: vec![zero; self.closures.last().map_or(0, |c| c.rows.end)],
            closure_actions: vec![Wrench::default(); self.closures.len()],
        }
    }

    /// The forces in all joints from the wrenches that the bodies require: Jᵀ [λ; τ] = M ẍ + h − f. Where redundant constraints
    /// leave multipliers open, they are the smallest.
    pub fn balance<T: Scalar>(&self, pose: &mut Pose<T>, forces: &mut Forces<T>) {
        forces.transmitted.copy_from_slice(&forces.required);
        self.carry_down(pose, &mut forces.transmitted);
        for link in &self.tree.links {
            let wrench = &forces.transmitted[link.body];
            let at = pose.frames[link.body].origin;
            for f in link.freedoms.clone() {
                let kind = self.tree.freedoms[f];
                forces.balance[f] = pose.screws[f].power(kind, *wrench, at);
            }
        }
        self.multipliers(pose, forces);
        self.transmit(pose, forces);
    }

    /// The forces in the joints of multipliers alone, with nothing required: of a [self-stress](Plan::self_stresses).
    pub fn stress<T: Scalar>(&self, multipliers: &[T], pose: &mut Pose<T>, forces: &mut Forces<T>) {
        forces.required.fill(Wrench::default());
        forces.balance.fill(T::from_f64(0.0));
        forces.multipliers.copy_from_slice(multipliers);
        self.transmit(pose, forces);
    }

    /// Sums the wrenches from the outermost bodies to the ground.
    fn carry_down<T: Scalar>(&self, pose: &Pose<T>, wrenches: &mut [Wrench<T>]) {
        for link in self.tree.links.iter().rev() {
            let Wrench { force, moment } = wrenches[link.body];
            let arm = pose.frames[link.body].origin - pose.frames[link.parent].origin;
            wrenches[link.parent].add_at(arm, force, moment);
        }
    }

    fn multipliers<T: Scalar>(&self, pose: &mut Pose<T>, forces: &mut Forces<T>) {
        let Forces {
            balance,
            multipliers,
            ..
        } = forces;
        for group in self.groups.iter().rev() {
            let (m, n) = (group.rows.len(), group.unknowns.len());
            let Pose {
                scratch,
                factors,
                heads,
                entries,
                ..
            } = &mut *pose;
            for (j, (&freedom, scale)) in
                group.unknowns.iter().zip(&group.column_scales).enumerate()
            {
                scratch[j] = balance[freedom] * T::from_f64(*scale);
            }
            let (factors, heads) = (
                &factors[group.factors..][..m * n],
                &heads[group.heads..][..n],
            );
            qr::solve_transposed(factors, heads, m, &mut scratch[..m]);
            for (i, (&(c, k), scale)) in group.rows.iter().zip(&group.row_scales).enumerate() {
                scratch[i] = scratch[i] * T::from_f64(*scale);
                multipliers[self.closures[c].rows.start + k] = scratch[i];
            }
            for outer in &group.outer {
                let change = entries[outer.entry] * scratch[outer.row];
                balance[outer.freedom] -= change;
            }
        }
    }

    /// What all joints transmit, from what is required and from the multipliers.
    fn transmit<T: Scalar>(&self, pose: &Pose<T>, forces: &mut Forces<T>) {
        forces.transmitted.copy_from_slice(&forces.required);
        for (closure, action) in self.closures.iter().zip(&mut forces.closure_actions) {
            let [_, at, _] = closure.ends(&pose.frames);
            *action = Wrench::default();
            for r in closure.rows.clone() {
                let (row, multiplier) = (&pose.row_wrenches[r], forces.multipliers[r]);
                action.force += row.force.scaled(multiplier);
                action.moment += row.moment.scaled(multiplier);
            }
            let [first, second] = closure.bodies;
            forces.transmitted[first].add_at(
                at - pose.frames[first].origin,
                action.force,
                action.moment,
            );
            forces.transmitted[second].add_at(
                at - pose.frames[second].origin,
                -action.force,
                -action.moment,
            );
        }
        self.carry_down(pose, &mut forces.transmitted);
    }

    /// The action of an actuator, N·m or N, after [`Plan::balance`].
    pub fn actuator_action<T: Scalar>(&self, forces: &Forces<T>, actuator: usize) -> T {
        let (freedom, sign) = self.drivers[actuator];
        forces.balance[freedom] * T::from_f64(sign)
    }

    /// The action of a joint's first body on the second, about the joint's point on the second, without that of an actuator.
    pub fn reaction<T: Scalar>(
        &self,
        pose: &Pose<T>,
        forces: &Forces<T>,
        joint: JointId,
    ) -> Wrench<T> {
        let link = match self.joint_places[joint.0] {
            JointPlace::Closure(closure) => return forces.closure_actions[closure],
            JointPlace::Link(link) => &self.tree.links[link],
        };
        let mut wrench = forces.transmitted[link.body];
        for &(freedom, _) in self
            .drivers
            .iter()
            .filter(|(f, _)| link.freedoms.contains(f))
        {
            let action = pose.screws[freedom].axis.scaled(forces.balance[freedom]);
            match self.tree.freedoms[freedom].parts() {
                (0.0, _) => wrench.force -= action,
                _ => wrench.moment -= action,
            }
        }
        if link.sign > 0.0 {
            return wrench;
        }
        // The first body is carried by the second: what the second does to it, reversed, about the second's point.
        let second = pose.frames[link.parent].point(link.on_parent.position);
        let mut reversed = Wrench::default();
        let arm = pose.frames[link.body].origin - second;
        reversed.add_at(arm, -wrench.force, -wrench.moment);
        reversed
    }
}
