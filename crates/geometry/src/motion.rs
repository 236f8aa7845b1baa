//! Velocities, accelerations and the multipliers of the loops: three uses of the same factors.
//!
//! With J the Jacobian of a group's loops by its unknowns u, velocities solve J u̇ = −(velocities of the gaps with u at
//! rest), accelerations the same with the centripetal and Coriolis terms, multipliers Jᵀλ = (generalised forces on u);
//! group by group, the last in reverse order.

mod multipliers;

use crate::plan::{ActuatedFrame, AssurGroup, FactoredGroup, GroupKind, LoopClosure, Plan, Pose};
use crate::plane::Vec2;
use crate::structure::groups::Unknown;
use dwell_numerics::Scalar;
pub use multipliers::ForceBalance;

/// Rates of every frame and slide at a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion<T> {
    /// By frame: angular velocity, rad/s.
    pub angular_velocity: Vec<T>,
    /// By slide: its speed, m/s.
    pub slide_velocity: Vec<T>,
    /// By frame: angular acceleration, rad/s².
    pub angular_acceleration: Vec<T>,
    /// By slide: its acceleration, m/s².
    pub slide_acceleration: Vec<T>,
    workspace: Vec<T>,
}

impl Plan {
    /// A motion with the right sizes.
    pub fn motion<T: Scalar>(&self) -> Motion<T> {
        let zero = T::from_f64(0.0);
        Motion {
            angular_velocity: vec![zero; self.frames.frames.len()],
            slide_velocity: vec![zero; self.tree.slide_pairs.len()],
            angular_acceleration: vec![zero; self.frames.frames.len()],
            slide_acceleration: vec![zero; self.tree.slide_pairs.len()],
            workspace: self.workspace(),
        }
    }

    fn workspace<T: Scalar>(&self) -> Vec<T> {
        let max_rows = self.groups.iter().map(|g| g.group.rows).max();
        vec![T::from_f64(0.0); max_rows.unwrap_or(0)]
    }

    /// Velocities for the actuators' speeds `q_dot` (rad/s).
    #[inline(always)]
    pub fn velocities<T: Scalar>(&self, pose: &Pose<T>, q_dot: &[T], motion: &mut Motion<T>) {
        self.actuated_velocities(q_dot, motion);
        for (assur, &inverse) in self.groups.iter().zip(&pose.inverse_determinant) {
            if !assur.pruned {
                self.group_velocities((assur, inverse), pose, q_dot, motion);
            }
        }
    }

    /// The velocities that the actuators alone determine.
    #[inline(always)]
    pub(crate) fn actuated_velocities<T: Scalar>(&self, q_dot: &[T], motion: &mut Motion<T>) {
        propagate_actuated(&self.actuated_frames, q_dot, &mut motion.angular_velocity);
        self.set_actuated_slides(q_dot, &mut motion.slide_velocity);
    }

    /// The velocities of a group, after those before it; `inverse` is one over the determinant of a closed form.
    #[inline(always)]
    pub(crate) fn group_velocities<T: Scalar>(
        &self,
        (assur, inverse): (&AssurGroup, T),
        pose: &Pose<T>,
        q_dot: &[T],
        motion: &mut Motion<T>,
    ) {
        match &assur.kind {
            GroupKind::RrrDyad(dyad) => {
                let rate = vector_velocity(&dyad.known, pose, motion);
                let [r1, r2] = dyad.vectors.map(|a| pose.vector[a]);
                motion.angular_velocity[dyad.frames[0]] = -(rate.dot(r2) * inverse);
                motion.angular_velocity[dyad.frames[1]] = rate.dot(r1) * inverse;
            }
            GroupKind::GuidedPoint(guided) => {
                motion.angular_velocity[guided.frame] = T::from_f64(0.0);
                let rate = vector_velocity(&guided.vectors, pose, motion);
                let travel = pose.closure_travel[guided.closure];
                let rate = normal_gap_velocity(rate, guided.axis, travel, pose, motion);
                motion.angular_velocity[guided.frame] = -(rate * inverse);
            }
            GroupKind::Factored(factored_group) => {
                self.factored_velocities(assur, factored_group, pose, q_dot, motion);
            }
        }
        propagate_actuated(&assur.actuated_frames, q_dot, &mut motion.angular_velocity);
    }

    /// Accelerations for the actuators' accelerations `q_ddot` (rad/s²), at the velocities that
    /// [`Plan::velocities`] left in `motion`.
    #[inline(always)]
    pub fn accelerations<T: Scalar>(&self, pose: &Pose<T>, q_ddot: &[T], motion: &mut Motion<T>) {
        propagate_actuated(
            &self.actuated_frames,
            q_ddot,
            &mut motion.angular_acceleration,
        );
        self.set_actuated_slides(q_ddot, &mut motion.slide_acceleration);
        for (assur, &inverse) in self.groups.iter().zip(&pose.inverse_determinant) {
            if assur.pruned {
                continue;
            }
            match &assur.kind {
                GroupKind::RrrDyad(dyad) => {
                    let (_, known) = vector_velocity_and_acceleration(&dyad.known, pose, motion);
                    let [r1, r2] = dyad.vectors.map(|a| pose.vector[a]);
                    let [w1, w2] = dyad.frames.map(|f| motion.angular_velocity[f]);
                    let rest = known - (r1 * (w1 * w1) + r2 * (w2 * w2));
                    motion.angular_acceleration[dyad.frames[0]] = -(rest.dot(r2) * inverse);
                    motion.angular_acceleration[dyad.frames[1]] = rest.dot(r1) * inverse;
                }
                GroupKind::GuidedPoint(guided) => {
                    motion.angular_acceleration[guided.frame] = T::from_f64(0.0);
                    let rates = vector_velocity_and_acceleration(&guided.vectors, pose, motion);
                    let travel = pose.closure_travel[guided.closure];
                    let rate = normal_gap_acceleration(rates, guided.axis, travel, pose, motion);
                    motion.angular_acceleration[guided.frame] = -(rate * inverse);
                }
                GroupKind::Factored(factored_group) => {
                    self.factored_accelerations(assur, factored_group, pose, q_ddot, motion);
                }
            }
            propagate_actuated(
                &assur.actuated_frames,
                q_ddot,
                &mut motion.angular_acceleration,
            );
        }
    }

    // The stages of a group solved by its factors are functions of their own: inlined, they would take registers
    // from the closed forms.

    #[inline(never)]
    fn factored_velocities<T: Scalar>(
        &self,
        assur: &AssurGroup,
        factored_group: &FactoredGroup,
        pose: &Pose<T>,
        q_dot: &[T],
        motion: &mut Motion<T>,
    ) {
        self.zero_unknowns(
            assur,
            &mut motion.angular_velocity,
            &mut motion.slide_velocity,
        );
        propagate_actuated(&assur.actuated_frames, q_dot, &mut motion.angular_velocity);
        let mut workspace = std::mem::take(&mut motion.workspace);
        let mut row = 0;
        for &l in &assur.group.loops {
            let rate = gap_velocity(&self.loop_closures[l], pose, motion);
            if let Some(axis) = self.loop_closures[l].axis {
                workspace[row] =
                    -normal_gap_velocity(rate, axis, pose.closure_travel[l], pose, motion);
                row += 1;
            } else {
                workspace[row] = -rate.x;
                workspace[row + 1] = -rate.y;
                row += 2;
            }
        }
        for &r in &assur.group.couplings {
            let rate = self.couplings[r].rate(
                &pose.angle,
                &pose.slide_travel,
                &motion.angular_velocity,
                &motion.slide_velocity,
            );
            workspace[row] = -rate * assur.coupling_weight::<T>(&self.couplings[r]);
            row += 1;
        }
        factored_group.solve(pose, &mut workspace[..row]);
        self.store_solution(
            assur,
            &workspace,
            &mut motion.angular_velocity,
            &mut motion.slide_velocity,
        );
        motion.workspace = workspace;
    }

    #[inline(never)]
    fn factored_accelerations<T: Scalar>(
        &self,
        assur: &AssurGroup,
        factored_group: &FactoredGroup,
        pose: &Pose<T>,
        q_ddot: &[T],
        motion: &mut Motion<T>,
    ) {
        self.zero_unknowns(
            assur,
            &mut motion.angular_acceleration,
            &mut motion.slide_acceleration,
        );
        propagate_actuated(
            &assur.actuated_frames,
            q_ddot,
            &mut motion.angular_acceleration,
        );
        let mut workspace = std::mem::take(&mut motion.workspace);
        let mut row = 0;
        for &l in &assur.group.loops {
            let rates = gap_velocity_and_acceleration(&self.loop_closures[l], pose, motion);
            if let Some(axis) = self.loop_closures[l].axis {
                workspace[row] =
                    -normal_gap_acceleration(rates, axis, pose.closure_travel[l], pose, motion);
                row += 1;
            } else {
                workspace[row] = -rates.1.x;
                workspace[row + 1] = -rates.1.y;
                row += 2;
            }
        }
        for &r in &assur.group.couplings {
            let value = self.couplings[r].acceleration(
                &pose.angle,
                &pose.slide_travel,
                (&motion.angular_velocity, &motion.slide_velocity),
                (&motion.angular_acceleration, &motion.slide_acceleration),
            );
            workspace[row] = -value * assur.coupling_weight::<T>(&self.couplings[r]);
            row += 1;
        }
        factored_group.solve(pose, &mut workspace[..row]);
        self.store_solution(
            assur,
            &workspace,
            &mut motion.angular_acceleration,
            &mut motion.slide_acceleration,
        );
        motion.workspace = workspace;
    }

    /// Sets the rates of the slides that actuators drive.
    #[inline(always)]
    fn set_actuated_slides<T: Scalar>(&self, rate: &[T], slide: &mut [T]) {
        for (value, actuated) in slide.iter_mut().zip(&self.actuated_slides) {
            if let Some(actuator) = *actuated {
                *value = rate[actuator];
            }
        }
    }

    /// Sets the rates of a group's unknowns to zero, so that a gap's rate is that of the known frames alone.
    fn zero_unknowns<T: Scalar>(
        &self,
        assur: &AssurGroup,
        angular_rate: &mut [T],
        slide_rate: &mut [T],
    ) {
        for &unknown in &assur.group.unknowns {
            match unknown {
                Unknown::ClassAngle(c) => angular_rate[self.class_frame(c)] = T::from_f64(0.0),
                Unknown::SlideTravel(s) => slide_rate[s] = T::from_f64(0.0),
            }
        }
    }

    fn store_solution<T: Scalar>(
        &self,
        assur: &AssurGroup,
        solution: &[T],
        angular_rate: &mut [T],
        slide_rate: &mut [T],
    ) {
        for (&unknown, &value) in assur.group.unknowns.iter().zip(solution) {
            match unknown {
                Unknown::ClassAngle(c) => angular_rate[self.class_frame(c)] = value,
                Unknown::SlideTravel(s) => slide_rate[s] = value * T::from_f64(assur.scale),
            }
        }
    }
}

/// Sets the rates of actuated frames from the frame each is turned from.
#[inline(always)]
fn propagate_actuated<T: Scalar>(
    actuated_frames: &[ActuatedFrame],
    rate: &[T],
    angular_rate: &mut [T],
) {
    for one in actuated_frames {
        angular_rate[one.frame] =
            angular_rate[one.parent] + T::from_f64(one.sign) * rate[one.actuator];
    }
}

/// d/dt of n·L, with n the normal of a prismatic loop joint: n·L̇ − ω_n travel.
#[inline(always)]
fn normal_gap_velocity<T: Scalar>(
    velocity: Vec2<T>,
    (axis, frame): (usize, usize),
    travel: T,
    pose: &Pose<T>,
    motion: &Motion<T>,
) -> T {
    pose.vector[axis].perp().dot(velocity) - motion.angular_velocity[frame] * travel
}

/// d²/dt² of n·L: n·L̈ − 2 ω_n (axis·L̇) − α_n travel.
#[inline(always)]
fn normal_gap_acceleration<T: Scalar>(
    (velocity, acceleration): (Vec2<T>, Vec2<T>),
    (axis, frame): (usize, usize),
    travel: T,
    pose: &Pose<T>,
    motion: &Motion<T>,
) -> T {
    let along = pose.vector[axis];
    let coriolis = T::from_f64(2.0) * motion.angular_velocity[frame] * along.dot(velocity);
    along.perp().dot(acceleration) - coriolis - motion.angular_acceleration[frame] * travel
}

/// Σ ω ẑ×vector.
#[inline(always)]
fn vector_velocity<T: Scalar>(
    vectors: &[(usize, usize)],
    pose: &Pose<T>,
    motion: &Motion<T>,
) -> Vec2<T> {
    let mut sum = Vec2::zero();
    for &(vector, frame) in vectors {
        sum += pose.vector[vector].perp() * motion.angular_velocity[frame];
    }
    sum
}

/// Σ ω ẑ×vector and its derivative, Σ α ẑ×vector − ω² vector.
#[inline(always)]
fn vector_velocity_and_acceleration<T: Scalar>(
    vectors: &[(usize, usize)],
    pose: &Pose<T>,
    motion: &Motion<T>,
) -> (Vec2<T>, Vec2<T>) {
    let (mut first, mut second) = (Vec2::zero(), Vec2::zero());
    for &(vector, frame) in vectors {
        let (r, w) = (pose.vector[vector], motion.angular_velocity[frame]);
        first += r.perp() * w;
        second += r.perp() * motion.angular_acceleration[frame] - r * (w * w);
    }
    (first, second)
}

/// L̇ = Σ ω ẑ×vector + Σ (speed · direction + ω ẑ×travel).
fn gap_velocity<T: Scalar>(closure: &LoopClosure, pose: &Pose<T>, motion: &Motion<T>) -> Vec2<T> {
    let mut sum = vector_velocity(&closure.vectors, pose, motion);
    for &(s, vector, frame) in &closure.slides {
        let along = pose.vector[vector];
        sum += along * motion.slide_velocity[s]
            + along.perp() * (pose.slide_travel[s] * motion.angular_velocity[frame]);
    }
    sum
}

/// L̇ and L̈, the latter with the centripetal and Coriolis terms.
fn gap_velocity_and_acceleration<T: Scalar>(
    closure: &LoopClosure,
    pose: &Pose<T>,
    motion: &Motion<T>,
) -> (Vec2<T>, Vec2<T>) {
    let (mut first, mut second) = vector_velocity_and_acceleration(&closure.vectors, pose, motion);
    for &(s, vector, frame) in &closure.slides {
        let (along, w) = (pose.vector[vector], motion.angular_velocity[frame]);
        let travel_vector = along * pose.slide_travel[s];
        first += along * motion.slide_velocity[s] + travel_vector.perp() * w;
        second +=
            travel_vector.perp() * motion.angular_acceleration[frame] - travel_vector * (w * w);
        let coriolis = T::from_f64(2.0) * w * motion.slide_velocity[s];
        second += along * motion.slide_acceleration[s] + along.perp() * coriolis;
    }
    (first, second)
}
