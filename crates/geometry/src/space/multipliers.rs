//! Multipliers of the loops by the transposed factors, group by group in reverse order, and the forces and moments in the joints.

use super::plan::{JointPlace, Plan, Pose};
use super::tree::Link;
use super::vector::Vec3;
use super::wrench::Wrench;
use crate::mechanism::JointId;
use dwell_numerics::{Constant, Lift, Scalar, map_array};

/// The forces of `N` passes at one pose, for one thread.
#[derive(Debug, Clone, PartialEq)]
pub struct Forces<T = f64, const N: usize = 1> {
    /// By body: the required wrench, that is, inertia minus loads, about the origin of its [evaluation frame](Plan::frame).
    /// The caller sets it.
    pub required: Vec<[Wrench<T>; N]>,
    /// By body: the wrench that its joint of the tree transmits to it and to all bodies that it carries, without the
    /// forces of closures.
    transmitted: Vec<[Wrench<T>; N]>,
    balance: Vec<[T; N]>,
    multipliers: Vec<[T; N]>,
    /// By closure: its force and couple on the second body, at the point of that body.
    closure_actions: Vec<[Wrench<T>; N]>,
    /// The required forces of a group, and then its multipliers.
    scratch: [Vec<T>; N],
}

impl<C: Constant> Plan<C> {
    /// Memory for the forces of `N` passes.
    pub fn forces<T: Scalar, const N: usize>(&self) -> Forces<T, N> {
        let zero = [T::from_f64(0.0); N];
        let bodies = vec![[Wrench::default(); N]; self.tree.internal.len()];
        let largest = self.groups.iter().map(|g| g.rows.len()).max().unwrap_or(0);
        Forces {
            required: bodies.clone(),
            transmitted: bodies,
            balance: vec![zero; self.tree.freedoms.len()],
            multipliers: vec![zero; self.row_and_entry_counts()[0]],
            closure_actions: vec![[Wrench::default(); N]; self.closures.len()],
            scratch: [(); N].map(|()| vec![T::from_f64(0.0); largest]),
        }
    }

    /// The forces in all joints from the wrenches that the bodies require: Jᵀ [λ; τ] = M ẍ + h − f. If redundant constraints
    /// leave multipliers undetermined, the forces are one of the solutions.
    #[inline(always)]
    pub fn balance<T: Lift<C>, const N: usize>(&self, pose: &Pose<T>, forces: &mut Forces<T, N>) {
        self.carry_down(pose, forces);
        for (_, freedom) in &self.tree.driven_lengths {
            forces.balance[*freedom] = [T::from_f64(0.0); N];
        }
        for link in &self.tree.links {
            let wrenches = &forces.transmitted[link.body];
            for f in link.freedoms.clone() {
                let (screw, kind) = (&pose.screws[f], self.tree.freedoms[f]);
                for (balance, wrench) in forces.balance[f].iter_mut().zip(wrenches) {
                    *balance = screw.power_at_origin(kind, wrench);
                }
            }
        }
        self.multipliers(pose, forces);
        self.close_forces(pose, forces);
    }

    /// The forces in the joints from multipliers alone, without required wrenches, as of a
    /// [self-stress](Plan::self_stresses).
    pub fn stress<T: Scalar>(&self, multipliers: &[T], pose: &Pose<T>, forces: &mut Forces<T>) {
        forces.required.fill([Wrench::default()]);
        forces.transmitted.fill([Wrench::default()]);
        forces.balance.fill([T::from_f64(0.0)]);
        for (of_row, multiplier) in forces.multipliers.iter_mut().zip(multipliers) {
            *of_row = [*multiplier];
        }
        for (closure, actions) in self.closures.iter().zip(&mut forces.closure_actions) {
            *actions = [Wrench::default()];
            for r in closure.rows.clone() {
                add_row(actions, &pose.row_wrenches[r], [multipliers[r]]);
            }
        }
    }

    /// Sums the required wrenches from the outermost bodies to the ground.
    #[inline(always)]
    fn carry_down<T: Lift<C>, const N: usize>(&self, pose: &Pose<T>, forces: &mut Forces<T, N>) {
        let wrenches = &mut forces.transmitted;
        wrenches.copy_from_slice(&forces.required);
        for link in self.tree.links.iter().rev() {
            // What the ground carries is read by nobody.
            if link.parent == self.ground {
                continue;
            }
            let carried = wrenches[link.body];
            let arm = pose.frames[link.body].position - pose.frames[link.parent].position;
            for (sum, Wrench { force, moment }) in wrenches[link.parent].iter_mut().zip(carried) {
                sum.add_at(arm, force, moment);
            }
        }
    }

    #[inline(always)]
    fn multipliers<T: Lift<C>, const N: usize>(&self, pose: &Pose<T>, forces: &mut Forces<T, N>) {
        let Forces {
            balance,
            multipliers,
            scratch,
            ..
        } = forces;
        for group in self.groups.iter().rev() {
            for (pass, values) in scratch.iter_mut().enumerate() {
                for (value, freedom) in values.iter_mut().zip(&group.unknowns) {
                    *value = balance[*freedom][pass];
                }
                self.solve_transposed(group, pose, values);
                for (value, row) in values.iter().zip(&group.residuals) {
                    multipliers[*row][pass] = *value;
                }
                for outer in &group.outer {
                    let change = pose.entries[outer.entry] * values[outer.row];
                    balance[outer.freedom][pass] -= change;
                }
            }
        }
    }

    /// The forces of the closures from the multipliers.
    #[inline(always)]
    fn close_forces<T: Lift<C>, const N: usize>(&self, pose: &Pose<T>, forces: &mut Forces<T, N>) {
        forces.closure_actions.fill([Wrench::default(); N]);
        // Rows that nothing moves are in no group.
        for group in &self.groups {
            for (c, rows) in &group.closures {
                let mut actions = forces.closure_actions[*c];
                for &r in &group.residuals[rows.clone()] {
                    add_row(&mut actions, &pose.row_wrenches[r], forces.multipliers[r]);
                }
                forces.closure_actions[*c] = actions;
            }
        }
    }

    /// The action of an actuator, N·m or N, after [`Plan::balance`].
    #[inline(always)]
    pub fn actuator_action<T: Lift<C>, const N: usize>(
        &self,
        forces: &Forces<T, N>,
        actuator: usize,
    ) -> [T; N] {
        let driver = self.drivers[actuator];
        let factor = T::lift(driver.factor);
        map_array(forces.balance[driver.freedom], |action| action * factor)
    }

    /// The wrench that a link transmits to its body, about the origin of that body's frame, including the actions of
    /// its actuators.
    #[inline(always)]
    fn transmitted<T: Lift<C>, const N: usize>(
        &self,
        pose: &Pose<T>,
        forces: &Forces<T, N>,
        link: usize,
    ) -> [Wrench<T>; N] {
        let body = self.tree.links[link].body;
        let mut wrenches = forces.transmitted[body];
        for (closure, actions) in self.closures.iter().zip(&forces.closure_actions) {
            let Some(&(_, sign)) = closure.links.iter().find(|(l, _)| *l == link) else {
                continue;
            };
            // Of a closure between what this link carries and the rest.
            let [_, at, _] = closure.ends(&pose.frames);
            let (arm, by) = (at - pose.frames[body].position, T::from_f64(-sign));
            for (wrench, action) in wrenches.iter_mut().zip(actions) {
                wrench.add_at(arm, action.force.scaled(by), action.moment.scaled(by));
            }
        }
        wrenches
    }

    /// The unit vector from a joint's first point to its second, for a joint that closes a loop, as distances and couplings do.
    #[inline(always)]
    pub fn line<T: Lift<C>>(&self, pose: &Pose<T>, joint: JointId) -> Vec3<T> {
        let JointPlace::Closure(closure) = self.joint_places[joint.0] else {
            return Vec3::zero();
        };
        let [_, _, d] = self.closures[closure].ends(&pose.frames);
        d.scaled(T::from_f64(1.0) / d.dot(d).sqrt())
    }

    /// Subtracts what couplings do along the freedoms of a link, which is within its joint.
    #[inline(always)]
    fn without_couplings<T: Lift<C>, const N: usize>(
        &self,
        pose: &Pose<T>,
        forces: &Forces<T, N>,
        link: &Link<C>,
        wrenches: &mut [Wrench<T>; N],
    ) {
        for closure in &self.closures {
            let Some(coupled) = &closure.coupled else {
                continue;
            };
            let multipliers = forces.multipliers[closure.rows.start];
            for (p, driver) in coupled.coordinates.iter().enumerate() {
                if !link.freedoms.contains(&driver.freedom) {
                    continue;
                }
                let entry = pose.entries[closure.entries + p];
                let along = pose.screws[driver.freedom].axis.scaled(entry);
                for (wrench, multiplier) in wrenches.iter_mut().zip(multipliers) {
                    let action = along
                        .scaled(multiplier * T::lift(driver.factor))
                        .scaled(T::from_f64(link.sign));
                    wrench.subtract(action, driver.is_force);
                }
            }
        }
    }

    /// The action of a joint's first body on the second, about the joint's point on the second, without that of an actuator.
    #[inline(always)]
    pub fn reaction<T: Lift<C>, const N: usize>(
        &self,
        pose: &Pose<T>,
        forces: &Forces<T, N>,
        joint: JointId,
    ) -> [Wrench<T>; N] {
        let index = match self.joint_places[joint.0] {
            // A driven distance transmits the actuator's action alone.
            JointPlace::Closure(closure) if self.closures[closure].is_driven() => {
                return [Wrench::default(); N];
            }
            JointPlace::Closure(closure) => return forces.closure_actions[closure],
            JointPlace::Link(link) => link,
        };
        let link = &self.tree.links[index];
        let mut wrenches = self.transmitted(pose, forces, index);
        self.without_couplings(pose, forces, link, &mut wrenches);
        for (actuator, driver) in self.drivers.iter().enumerate() {
            if !link.freedoms.contains(&driver.freedom) {
                continue;
            }
            let actions = self.actuator_action(forces, actuator);
            let sign = T::from_f64(link.sign);
            for (wrench, action) in wrenches.iter_mut().zip(actions) {
                let action = pose.screws[driver.freedom].axis.scaled(action * sign);
                wrench.subtract(action, driver.is_force);
            }
        }
        if link.sign > 0.0 {
            return wrenches;
        }
        // The first body is carried by the second: what the second does to it, reversed, about the second's point.
        let second = pose.frames[link.parent].point(link.on_parent.position);
        let arm = pose.frames[link.body].position - second;
        map_array(wrenches, |wrench| {
            let mut reversed = Wrench::default();
            reversed.add_at(arm, -wrench.force, -wrench.moment);
            reversed
        })
    }
}

/// Adds the wrench of a row times its multipliers.
#[inline(always)]
fn add_row<T: Scalar, const N: usize>(
    actions: &mut [Wrench<T>; N],
    row: &Wrench<T>,
    multipliers: [T; N],
) {
    for (action, multiplier) in actions.iter_mut().zip(multipliers) {
        action.force += row.force.scaled(multiplier);
        action.moment += row.moment.scaled(multiplier);
    }
}
