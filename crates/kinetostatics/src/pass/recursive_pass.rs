//! `N` passes side by side at one pose: from the accelerations of every frame to inertia forces, multipliers,
//! actuator forces and reactions. All of them share the pose and its factors.

use super::PassModel;
use super::acceleration::AccelerationInput;
use crate::load::LoadState;
use dwell_geometry::{ForceBalance, Pose, Vec2};
use dwell_numerics::{Constant, Lift, Scalar, map_array};

/// The results of `N` passes, and their working memory.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RecursivePass<T, const N: usize> {
    /// By accelerated body: acceleration of its origin, m/s².
    origin_acceleration: Vec<[Vec2<T>; N]>,
    /// By accelerated body: m a of it and of all that it carries, N.
    inertia_force: Vec<[Vec2<T>; N]>,
    pub(crate) balance: ForceBalance<T, N>,
    /// By moving body: the force that the joint that carries it exerts on it, N.
    pub(crate) joint_forces: Vec<[Vec2<T>; N]>,
    /// By body: the couple that prismatic joints and actuators must exert on it, N·m.
    pub(crate) joint_moments: Vec<[T; N]>,
}

#[inline(always)]
#[track_caller]
fn add<V: std::ops::AddAssign, const N: usize>(sum: &mut [V; N], more: [V; N]) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += more;
    }
}

#[inline(always)]
#[track_caller]
fn subtract<V: std::ops::SubAssign + Copy, const N: usize>(sum: &mut [V; N], less: V) {
    for sum in sum {
        *sum -= less;
    }
}

impl<T: Scalar, const N: usize> RecursivePass<T, N> {
    pub(crate) fn new<C: Constant>(model: &PassModel<C>) -> Self {
        let bodies = model.plan.moving_bodies().len();
        let accelerated = model.accelerated_bodies.len();
        let vector = [Vec2::zero(); N];
        Self {
            origin_acceleration: vec![vector; accelerated],
            inertia_force: vec![vector; accelerated],
            balance: model.plan.force_balance(),
            joint_forces: vec![vector; bodies],
            joint_moments: vec![[T::from_f64(0.0); N]; bodies + 1],
        }
    }

    /// [`RecursivePass::evaluate`] with the loads' forces and moments on every body.
    // Not inlined, so that an evaluation without loads does not contain it.
    #[inline(never)]
    pub(crate) fn evaluate_loaded<C: Constant>(
        &mut self,
        model: &PassModel<C>,
        pose: &Pose<T>,
        accelerations: impl AccelerationInput<T, N>,
        loads: &mut LoadState<T>,
    ) where
        T: Lift<C>,
    {
        self.evaluate(model, pose, accelerations, Some(loads));
    }

    /// Inertia forces, then multipliers, then (where requested reactions need them) the forces and moments in the
    /// joints of the tree.
    #[inline(always)]
    pub(crate) fn evaluate<C: Constant>(
        &mut self,
        model: &PassModel<C>,
        pose: &Pose<T>,
        accelerations: impl AccelerationInput<T, N>,
        mut loads: Option<&mut LoadState<T>>,
    ) where
        T: Lift<C>,
    {
        self.forward_pass(model, pose, accelerations);
        if model.reaction_sources.needs_joint_forces {
            self.store_inertia_forces(model, pose, accelerations);
        }
        self.backward_pass(model, pose);
        if let Some(loads) = loads.as_deref_mut() {
            self.propagate_loads(model, pose, loads);
        }
        model.plan.multipliers(pose, &mut self.balance);
        if model.reaction_sources.needs_joint_forces {
            self.accumulate_joint_forces(model, pose);
        }
        if model.reaction_sources.needs_joint_moments {
            self.accumulate_joint_moments(model, pose, accelerations);
            if let Some(loads) = loads {
                for (couple, &moment) in self.joint_moments.iter_mut().zip(&loads.moment) {
                    subtract(couple, moment);
                }
            }
            // Each couple is transferred to the body against which the constrained body is held.
            for constraint in model.plan.frames().angular_constraints.iter().rev() {
                let couple = self.joint_moments[constraint.body];
                add(&mut self.joint_moments[constraint.reference_body], couple);
            }
        }
    }

    /// Accelerations of the origins, and each body's own inertia force and its moment about its
    /// origin: Σ m r×a = I α + (Σ m r)×(the origin's acceleration).
    #[inline(always)]
    fn forward_pass<C: Constant>(
        &mut self,
        model: &PassModel<C>,
        pose: &Pose<T>,
        accelerations: impl AccelerationInput<T, N>,
    ) where
        T: Lift<C>,
    {
        let moments = self.balance.moment.iter_mut().zip(&model.frame_inertia);
        for (frame, (moment, &inertia)) in moments.enumerate() {
            let rates = accelerations.angular_acceleration(frame);
            *moment = map_array(rates, |rate| rate * T::lift(inertia));
        }
        if !model.varying_inertias.is_empty() {
            self.add_varying_inertias(model, pose, accelerations);
        }
        for (i, accelerated) in model.accelerated_bodies.iter().enumerate() {
            let of_parent = |parent: usize| self.origin_acceleration[parent];
            let mut acceleration = accelerated.parent.map_or([Vec2::zero(); N], of_parent);
            if let Some((vector, frame)) = accelerated.joint_vector {
                let more = accelerations.vector_acceleration(frame, pose.vector[vector]);
                add(&mut acceleration, more);
            }
            if let Some((slide, direction)) = accelerated.slide {
                let along = pose.vector[direction];
                let more = accelerations.slide_acceleration(slide, accelerated.frame, along);
                add(&mut acceleration, more);
                let more = accelerations
                    .vector_acceleration(accelerated.frame, along * pose.slide_travel[slide]);
                add(&mut acceleration, more);
            }
            let mut force = map_array(acceleration, |a| a * T::lift(accelerated.mass));
            if let Some(first_moment) = accelerated.first_moment {
                let first_moment = first_moment.cast().rotate(pose.rotation[accelerated.frame]);
                let more = accelerations.vector_acceleration(accelerated.frame, first_moment);
                add(&mut force, more);
                let more = map_array(acceleration, |a| first_moment.cross(a));
                add(&mut self.balance.moment[accelerated.frame], more);
            }
            self.origin_acceleration[i] = acceleration;
            self.inertia_force[i] = force;
        }
    }

    /// Adds I α + ½ I′ ω² of the bodies whose inertia varies with their angle.
    // Not inlined, so that an evaluation without such bodies does not contain it.
    #[inline(never)]
    fn add_varying_inertias<C: Constant>(
        &mut self,
        model: &PassModel<C>,
        pose: &Pose<T>,
        accelerations: impl AccelerationInput<T, N>,
    ) {
        for varying in &model.varying_inertias {
            let more = varying.moments(
                pose,
                accelerations.angular_acceleration(varying.frame),
                accelerations.squared_angular_velocity(varying.frame),
            );
            add(&mut self.balance.moment[varying.frame], more);
        }
    }

    /// Carries the inertia forces down the tree: moments on the frames, forces along the slides.
    #[inline(always)]
    fn backward_pass<C: Constant>(&mut self, model: &PassModel<C>, pose: &Pose<T>) {
        let ForceBalance {
            moment,
            slide_force,
            ..
        } = &mut self.balance;
        slide_force.fill([T::from_f64(0.0); N]);
        for (i, accelerated) in model.accelerated_bodies.iter().enumerate().rev() {
            let force = self.inertia_force[i];
            if let Some(parent) = accelerated.parent {
                add(&mut self.inertia_force[parent], force);
            }
            if let Some((vector, frame)) = accelerated.joint_vector {
                let vector = pose.vector[vector];
                add(&mut moment[frame], map_array(force, |f| vector.cross(f)));
            }
            if let Some((slide, direction)) = accelerated.slide {
                let along = pose.vector[direction];
                let offset = along * pose.slide_travel[slide];
                slide_force[slide] = map_array(force, |f| along.dot(f));
                let more = map_array(force, |f| offset.cross(f));
                add(&mut moment[accelerated.frame], more);
            }
        }
    }

    /// Subtracts the loads from the forces that the mechanism must balance, from the outermost body inwards: moments
    /// from those on the frames, forces from those on the slides, and, if needed, the load on each body from the force
    /// of its joint. This includes bodies without mass and bodies at rest.
    #[inline(never)]
    fn propagate_loads<C: Constant>(
        &mut self,
        model: &PassModel<C>,
        pose: &Pose<T>,
        loads: &mut LoadState<T>,
    ) {
        let moving_bodies = model.plan.moving_bodies();
        for (i, body) in moving_bodies.iter().enumerate() {
            let force = loads.force[body.body];
            loads.subtree_force[i] = force;
            let moment = loads.moment[body.body];
            subtract(&mut self.balance.moment[body.frame], moment);
            if model.reaction_sources.needs_joint_forces {
                subtract(&mut self.joint_forces[i], force);
            }
        }
        for (i, body) in moving_bodies.iter().enumerate().rev() {
            let force = loads.subtree_force[i];
            if let Some(parent) = body.parent {
                loads.subtree_force[parent] += force;
            }
            if let Some(vector) = body.joint_vector {
                let moment = pose.vector[vector].cross(force);
                subtract(&mut self.balance.moment[body.parent_frame], moment);
            }
            if let Some((slide, direction)) = body.slide {
                let along = pose.vector[direction];
                subtract(&mut self.balance.slide_force[slide], along.dot(force));
                let offset = along * pose.slide_travel[slide];
                subtract(&mut self.balance.moment[body.frame], offset.cross(force));
            }
        }
    }

    // The rest is for reactions in the tree's joints, and only for the bodies that the requested ones depend on.

    /// Stores each body's own inertia force: the first part of the force that its joint must exert on it.
    #[inline(always)]
    fn store_inertia_forces<C: Constant>(
        &mut self,
        model: &PassModel<C>,
        pose: &Pose<T>,
        accelerations: impl AccelerationInput<T, N>,
    ) where
        T: Lift<C>,
    {
        let needed = &model.reaction_sources.joint_force_needed;
        self.joint_forces.fill([Vec2::zero(); N]);
        for (accelerated, force) in model.accelerated_bodies.iter().zip(&self.inertia_force) {
            self.joint_forces[accelerated.moving_body] = *force;
        }
        for body in &model.inertial_bodies {
            let required = body.fixed_origin && needed[body.moving_body];
            if let (true, Some(first_moment)) = (required, body.first_moment) {
                let first_moment = first_moment.cast().rotate(pose.rotation[body.frame]);
                self.joint_forces[body.moving_body] =
                    accelerations.vector_acceleration(body.frame, first_moment);
            }
        }
    }

    /// The force that each joint of the tree exerts on the body it carries, where that is needed: the inertia
    /// forces of all bodies that it carries, less the forces of the loop joints on them.
    #[inline(always)]
    fn accumulate_joint_forces<C: Constant>(&mut self, model: &PassModel<C>, pose: &Pose<T>) {
        let sources = &model.reaction_sources;
        for (c, ends) in sources.loop_joint_ends.iter().enumerate() {
            for (end, sign) in ends.iter().zip([1.0, -1.0]) {
                let needed = |&body: &usize| sources.joint_force_needed[body];
                if let Some(body) = end.moving_body.filter(needed) {
                    let force = self.loop_joint_force(model, pose, c);
                    let more = map_array(force, |f| f * T::from_f64(sign));
                    add(&mut self.joint_forces[body], more);
                }
            }
        }
        for (i, body) in model.plan.moving_bodies().iter().enumerate().rev() {
            if let Some(parent) = body.parent
                && sources.joint_force_needed[parent]
            {
                let force = self.joint_forces[i];
                add(&mut self.joint_forces[parent], force);
            }
        }
    }

    /// The force of a loop joint's first body on its second, in ground axes.
    #[inline(always)]
    fn loop_joint_force<C: Constant>(
        &self,
        model: &PassModel<C>,
        pose: &Pose<T>,
        closure: usize,
    ) -> [Vec2<T>; N] {
        let multiplier = self.balance.loop_multiplier[closure];
        match model.plan.loop_closures[closure].axis {
            None => multiplier,
            Some((axis, _)) => {
                let normal = pose.vector[axis].perp();
                map_array(multiplier, |m| normal * m.x)
            }
        }
    }

    /// The couples that prismatic joints and actuators exert, if they are needed: each body's moment balance
    /// about its origin, before they are transferred.
    // Long because it is inlined whole, and each part needs the same sources.
    #[inline(always)]
    fn accumulate_joint_moments<C: Constant>(
        &mut self,
        model: &PassModel<C>,
        pose: &Pose<T>,
        accelerations: impl AccelerationInput<T, N>,
    ) where
        T: Lift<C>,
    {
        self.joint_moments.fill([T::from_f64(0.0); N]);
        let sources = &model.reaction_sources;
        let moving_bodies = model.plan.moving_bodies();
        let needed = &sources.joint_moment_needed;
        for body in model.inertial_bodies.iter().filter(|m| needed[m.body]) {
            let inertia = T::lift(body.inertia_about_joint);
            let rates = accelerations.angular_acceleration(body.frame);
            self.joint_moments[body.body] = map_array(rates, |rate| rate * inertia);
        }
        for varying in model.varying_inertias.iter().filter(|v| needed[v.body]) {
            let more = varying.moments(
                pose,
                accelerations.angular_acceleration(varying.frame),
                accelerations.squared_angular_velocity(varying.frame),
            );
            add(&mut self.joint_moments[varying.body], more);
        }
        let accelerated_bodies = model.accelerated_bodies.iter();
        for (accelerated, &acceleration) in accelerated_bodies.zip(&self.origin_acceleration) {
            let body = moving_bodies[accelerated.moving_body].body;
            if let (true, Some(first_moment)) = (needed[body], accelerated.first_moment) {
                let first_moment = first_moment.cast().rotate(pose.rotation[accelerated.frame]);
                let more = map_array(acceleration, |a| first_moment.cross(a));
                add(&mut self.joint_moments[body], more);
            }
        }
        for (c, ends) in sources.loop_joint_ends.iter().enumerate() {
            for (end, sign) in ends.iter().zip([1.0, -1.0]) {
                if !needed[end.body] {
                    continue;
                }
                let turned = |arm: Vec2<C>| arm.cast().rotate(pose.rotation[end.frame]);
                let mut moment_arm = end.moment_arm.map_or(Vec2::zero(), turned);
                if let (true, Some((axis, _))) = (sign > 0.0, model.plan.loop_closures[c].axis) {
                    // The force acts at the second body's point on both.
                    moment_arm += pose.vector[axis] * pose.closure_travel[c];
                }
                let force = self.loop_joint_force(model, pose, c);
                let moment = map_array(force, |f| moment_arm.cross(f) * T::from_f64(sign));
                add(&mut self.joint_moments[end.body], moment);
            }
        }
        for r in 0..model.plan.couplings.len() {
            let multiplier = self.balance.coupling_multiplier[r];
            let add_moment = |body: usize, factor: T| {
                let more = map_array(multiplier, |m| -(factor * m));
                add(&mut self.joint_moments[body], more);
            };
            model.plan.coupling_angle_derivatives(r, pose, add_moment);
        }
        for (i, body) in moving_bodies.iter().enumerate() {
            let force = self.joint_forces[i];
            let parent = sources.parent_body[i];
            if let (true, Some(moment_arm)) = (needed[parent], body.joint_vector) {
                let moment_arm = pose.vector[moment_arm];
                let more = map_array(force, |f| moment_arm.cross(f));
                add(&mut self.joint_moments[parent], more);
            }
            if let Some((slide, direction)) = body.slide {
                // The force acts at the second body's point: the origin of the body itself, or
                // the joint's point on the one that carries it.
                let on = if sources.child_is_second[i] {
                    parent
                } else {
                    body.body
                };
                if needed[on] {
                    let offset = pose.vector[direction] * pose.slide_travel[slide];
                    let more = map_array(force, |f| offset.cross(f));
                    add(&mut self.joint_moments[on], more);
                }
            }
        }
    }

    /// An actuator's force on its second body: the sum of the moments on the frames that it turns.
    #[inline(always)]
    pub(crate) fn tau<C: Constant>(&self, model: &PassModel<C>, actuator: usize) -> [T; N] {
        if let Some(slide) = model.reaction_sources.actuated_slides[actuator] {
            return self.balance.slide_force[slide];
        }
        let mut sum = [T::from_f64(0.0); N];
        for &(frame, sign) in &model.reaction_sources.actuated_frames[actuator] {
            let more = map_array(self.balance.moment[frame], |m| m * T::from_f64(sign));
            add(&mut sum, more);
        }
        sum
    }
}

/// The actuators' actions and the requested reactions in one state of motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InverseDynamics<T> {
    /// By actuator: its force on its second body, N·m; of a length, N, positive when it pushes apart.
    pub tau: Vec<T>,
    /// By requested reaction: N or N·m.
    pub reactions: Vec<T>,
}

impl<T: Scalar> InverseDynamics<T> {
    /// A buffer for the given numbers of actuators and reactions.
    pub(crate) fn buffer(actuators: usize, reactions: usize) -> Self {
        Self {
            tau: vec![T::from_f64(0.0); actuators],
            reactions: vec![T::from_f64(0.0); reactions],
        }
    }

    /// Adds a multiple of other results of the same model.
    pub fn add_scaled(&mut self, other: &Self, factor: T) {
        for (sum, more) in self.reactions.iter_mut().zip(&other.reactions) {
            *sum += *more * factor;
        }
        for (sum, more) in self.tau.iter_mut().zip(&other.tau) {
            *sum += *more * factor;
        }
    }

    /// Copies them from a pass.
    pub(crate) fn read_from<C: Constant>(
        &mut self,
        model: &PassModel<C>,
        pose: &Pose<T>,
        pass: &RecursivePass<T, 1>,
    ) {
        for (i, tau) in self.tau.iter_mut().enumerate() {
            *tau = pass.tau(model, i)[0];
        }
        for (k, value) in self.reactions.iter_mut().enumerate() {
            *value = pass.reaction(model, pose, k)[0];
        }
    }
}
