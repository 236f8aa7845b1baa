//! Velocities, accelerations and the multipliers of the loops: three uses of the same factors.
//!
//! With J the Jacobian of a group's loops by its unknowns u, velocities solve J u̇ = −(velocities of the gaps with u at
//! rest), accelerations the same with the centripetal and Coriolis terms, multipliers Jᵀλ = (generalised forces on u);
//! group by group, the last in reverse order.

mod multipliers;

use crate::plan::{ActuatedFrame, AssurGroup, FactoredGroup, GroupKind, LoopClosure, Plan, Pose};
use crate::plane::{Vec2, vec2};
use crate::rates::Rates;
use crate::structure::coupling::CouplingEquation;
use crate::structure::groups::Unknown;
use dwell_numerics::{Constant, Scalar};
pub use multipliers::ForceBalance;

/// Velocities and accelerations at a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion<T> {
    /// The velocities.
    pub velocity: Rates<T>,
    /// The accelerations.
    pub acceleration: Rates<T>,
    workspace: Vec<T>,
}

impl Motion<f64> {
    /// For each frame: its angle at a pose (rad, whole revolutions left out) and its angular velocity, rad/s.
    pub fn turns(&self, pose: &Pose<f64>) -> Vec<[f64; 2]> {
        let frames = pose.rotation.iter().zip(&self.velocity.angular);
        let turn = |(rotation, &rate): (&Vec2, _)| [rotation.y.atan2(rotation.x), rate];
        frames.map(turn).collect()
    }
}

impl<C: Constant> Plan<C> {
    /// A motion with the right sizes.
    pub fn motion<T: Scalar>(&self) -> Motion<T> {
        let zero = T::from_f64(0.0);
        let rest = Rates {
            angular: vec![zero; self.frames.frames.len()],
            slide: vec![zero; self.tree.slide_pairs.len()],
        };
        Motion {
            velocity: rest.clone(),
            acceleration: rest,
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
        self.set_actuated(q_dot, &mut motion.velocity);
        for (assur, &inverse) in self.groups.iter().zip(&pose.inverse_determinant) {
            if !assur.pruned {
                self.group_velocities(assur, inverse, pose, q_dot, motion);
            }
        }
    }

    /// Sets the rates that those of the actuators alone determine.
    #[inline(always)]
    pub(crate) fn set_actuated<T: Scalar>(&self, rate: &[T], rates: &mut Rates<T>) {
        propagate_actuated(&self.actuated_frames, rate, &mut rates.angular);
        for (value, actuated) in rates.slide.iter_mut().zip(&self.actuated_slides) {
            if let Some(actuator) = *actuated {
                *value = rate[actuator];
            }
        }
    }

    /// The velocities of a group, after those before it; `inverse` is one over the determinant of a closed form.
    #[inline(always)]
    pub(crate) fn group_velocities<T: Scalar>(
        &self,
        assur: &AssurGroup<C>,
        inverse: T,
        pose: &Pose<T>,
        q_dot: &[T],
        motion: &mut Motion<T>,
    ) {
        match &assur.kind {
            GroupKind::RrrDyad(dyad) => {
                let rate = vector_velocity(&dyad.known, pose, motion);
                let [r1, r2] = dyad.vectors.map(|a| pose.vector[a]);
                motion.velocity.angular[dyad.frames[0]] = -(rate.dot(r2) * inverse);
                motion.velocity.angular[dyad.frames[1]] = rate.dot(r1) * inverse;
            }
            GroupKind::GuidedPoint(guided) => {
                motion.velocity.angular[guided.frame] = T::from_f64(0.0);
                let rate = vector_velocity(&guided.vectors, pose, motion);
                let travel = pose.closure_travel[guided.closure];
                let rate = normal_gap_velocity(rate, guided.axis, travel, pose, motion);
                motion.velocity.angular[guided.frame] = -(rate * inverse);
            }
            GroupKind::Factored(factored_group) => {
                self.factored_velocities(assur, factored_group, pose, q_dot, motion);
            }
        }
        propagate_actuated(&assur.actuated_frames, q_dot, &mut motion.velocity.angular);
    }

    /// Accelerations for the actuators' accelerations `q_ddot` (rad/s²), at the velocities that
    /// [`Plan::velocities`] left in `motion`.
    #[inline(always)]
    pub fn accelerations<T: Scalar>(&self, pose: &Pose<T>, q_ddot: &[T], motion: &mut Motion<T>) {
        self.set_actuated(q_ddot, &mut motion.acceleration);
        for (assur, &inverse) in self.groups.iter().zip(&pose.inverse_determinant) {
            if assur.pruned {
                continue;
            }
            match &assur.kind {
                GroupKind::RrrDyad(dyad) => {
                    let (_, known) = vector_velocity_and_acceleration(&dyad.known, pose, motion);
                    let [r1, r2] = dyad.vectors.map(|a| pose.vector[a]);
                    let [w1, w2] = dyad.frames.map(|f| motion.velocity.angular[f]);
                    let rest = known - (r1 * (w1 * w1) + r2 * (w2 * w2));
                    motion.acceleration.angular[dyad.frames[0]] = -(rest.dot(r2) * inverse);
                    motion.acceleration.angular[dyad.frames[1]] = rest.dot(r1) * inverse;
                }
                GroupKind::GuidedPoint(guided) => {
                    motion.acceleration.angular[guided.frame] = T::from_f64(0.0);
                    let (first, second) =
                        vector_velocity_and_acceleration(&guided.vectors, pose, motion);
                    let (axis, travel) = (guided.axis, pose.closure_travel[guided.closure]);
                    let rate = normal_gap_acceleration(first, second, axis, travel, pose, motion);
                    motion.acceleration.angular[guided.frame] = -(rate * inverse);
                }
                GroupKind::Factored(factored_group) => {
                    self.factored_accelerations(assur, factored_group, pose, q_ddot, motion);
                }
            }
            let angular = &mut motion.acceleration.angular;
            propagate_actuated(&assur.actuated_frames, q_ddot, angular);
        }
    }

    // The stages of a group solved by its factors are functions of their own: inlined, they would take registers
    // from the closed forms.

    #[inline(never)]
    fn factored_velocities<T: Scalar>(
        &self,
        assur: &AssurGroup<C>,
        factored_group: &FactoredGroup,
        pose: &Pose<T>,
        q_dot: &[T],
        motion: &mut Motion<T>,
    ) {
        self.start_rates(assur, q_dot, &mut motion.velocity);
        let mut workspace = std::mem::take(&mut motion.workspace);
        let loop_rate = |l: usize| {
            let rate = gap_velocity(&self.loop_closures[l], pose, motion);
            let travel = pose.closure_travel[l];
            let normal = |axis| normal_gap_velocity(rate, axis, travel, pose, motion);
            let along_normal = self.loop_closures[l].axis.map(normal);
            along_normal.map_or(rate, |rate| vec2(rate, T::from_f64(0.0)))
        };
        let coupling_rate = |coupling: &CouplingEquation| {
            coupling.rate(&pose.angle, &pose.slide_travel, &motion.velocity)
        };
        self.fill_rates(assur, loop_rate, coupling_rate, &mut workspace);
        factored_group.solve(pose, &mut workspace[..factored_group.rows]);
        self.store_solution(assur, &workspace, &mut motion.velocity);
        motion.workspace = workspace;
    }

    #[inline(never)]
    fn factored_accelerations<T: Scalar>(
        &self,
        assur: &AssurGroup<C>,
        factored_group: &FactoredGroup,
        pose: &Pose<T>,
        q_ddot: &[T],
        motion: &mut Motion<T>,
    ) {
        self.start_rates(assur, q_ddot, &mut motion.acceleration);
        let mut workspace = std::mem::take(&mut motion.workspace);
        let loop_rate = |l: usize| {
            let (first, second) =
                gap_velocity_and_acceleration(&self.loop_closures[l], pose, motion);
            let travel = pose.closure_travel[l];
            let normal = |axis| normal_gap_acceleration(first, second, axis, travel, pose, motion);
            let along_normal = self.loop_closures[l].axis.map(normal);
            along_normal.map_or(second, |rate| vec2(rate, T::from_f64(0.0)))
        };
        let coupling_rate = |coupling: &CouplingEquation| {
            let (first, second) = (&motion.velocity, &motion.acceleration);
            coupling.acceleration(&pose.angle, &pose.slide_travel, first, second)
        };
        self.fill_rates(assur, loop_rate, coupling_rate, &mut workspace);
        factored_group.solve(pose, &mut workspace[..factored_group.rows]);
        self.store_solution(assur, &workspace, &mut motion.acceleration);
        motion.workspace = workspace;
    }

    /// Writes the rates of a group's equations with its unknowns at rest, with opposite sign: of a loop both components,
    /// or the first alone where it has an axis, and of a coupling.
    #[inline(always)]
    fn fill_rates<T: Scalar>(
        &self,
        assur: &AssurGroup<C>,
        loop_rate: impl Fn(usize) -> Vec2<T>,
        coupling_rate: impl Fn(&CouplingEquation) -> T,
        rates: &mut [T],
    ) {
        let mut row = 0;
        for &l in &assur.group.loops {
            let rate = loop_rate(l);
            rates[row] = -rate.x;
            row += 1;
            if self.loop_closures[l].axis.is_none() {
                rates[row] = -rate.y;
                row += 1;
            }
        }
        for &r in &assur.group.couplings {
            let coupling = &self.couplings[r];
            rates[row] = -coupling_rate(coupling) * assur.coupling_weight::<T>(coupling);
            row += 1;
        }
    }

    /// Sets the rates of a group's unknowns to zero, so that a gap's rate is that of the known frames alone.
    fn start_rates<T: Scalar>(&self, assur: &AssurGroup<C>, rate: &[T], rates: &mut Rates<T>) {
        for &unknown in &assur.group.unknowns {
            match unknown {
                Unknown::ClassAngle(c) => rates.angular[self.class_frame(c)] = T::from_f64(0.0),
                Unknown::SlideTravel(s) => rates.slide[s] = T::from_f64(0.0),
            }
        }
        propagate_actuated(&assur.actuated_frames, rate, &mut rates.angular);
    }

    fn store_solution<T: Scalar>(
        &self,
        assur: &AssurGroup<C>,
        solution: &[T],
        rates: &mut Rates<T>,
    ) {
        for (&unknown, &value) in assur.group.unknowns.iter().zip(solution) {
            match unknown {
                Unknown::ClassAngle(c) => rates.angular[self.class_frame(c)] = value,
                Unknown::SlideTravel(s) => rates.slide[s] = value * T::from_f64(assur.scale),
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
    pose.vector[axis].perp().dot(velocity) - motion.velocity.angular[frame] * travel
}

/// d²/dt² of n·L: n·L̈ − 2 ω_n (axis·L̇) − α_n travel.
#[inline(always)]
fn normal_gap_acceleration<T: Scalar>(
    velocity: Vec2<T>,
    acceleration: Vec2<T>,
    (axis, frame): (usize, usize),
    travel: T,
    pose: &Pose<T>,
    motion: &Motion<T>,
) -> T {
    let along = pose.vector[axis];
    let coriolis = T::from_f64(2.0) * motion.velocity.angular[frame] * along.dot(velocity);
    along.perp().dot(acceleration) - coriolis - motion.acceleration.angular[frame] * travel
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
        sum += pose.vector[vector].perp() * motion.velocity.angular[frame];
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
        let (r, w) = (pose.vector[vector], motion.velocity.angular[frame]);
        first += r.perp() * w;
        second += r.perp() * motion.acceleration.angular[frame] - r * (w * w);
    }
    (first, second)
}

/// L̇ = Σ ω ẑ×vector + Σ (speed · direction + ω ẑ×travel).
fn gap_velocity<C, T: Scalar>(
    closure: &LoopClosure<C>,
    pose: &Pose<T>,
    motion: &Motion<T>,
) -> Vec2<T> {
    let mut sum = vector_velocity(&closure.vectors, pose, motion);
    for &(s, vector, frame) in &closure.slides {
        let along = pose.vector[vector];
        sum += along * motion.velocity.slide[s]
            + along.perp() * (pose.slide_travel[s] * motion.velocity.angular[frame]);
    }
    sum
}

/// L̇ and L̈, the latter with the centripetal and Coriolis terms.
fn gap_velocity_and_acceleration<C, T: Scalar>(
    closure: &LoopClosure<C>,
    pose: &Pose<T>,
    motion: &Motion<T>,
) -> (Vec2<T>, Vec2<T>) {
    let (mut first, mut second) = vector_velocity_and_acceleration(&closure.vectors, pose, motion);
    for &(s, vector, frame) in &closure.slides {
        let (along, w) = (pose.vector[vector], motion.velocity.angular[frame]);
        let travel_vector = along * pose.slide_travel[s];
        first += along * motion.velocity.slide[s] + travel_vector.perp() * w;
        second +=
            travel_vector.perp() * motion.acceleration.angular[frame] - travel_vector * (w * w);
        let coriolis = T::from_f64(2.0) * w * motion.velocity.slide[s];
        second += along * motion.acceleration.slide[s] + along.perp() * coriolis;
    }
    (first, second)
}
