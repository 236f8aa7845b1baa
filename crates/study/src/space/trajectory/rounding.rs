//! The rounding error along a trajectory in space: some positions are evaluated again in 32-digit arithmetic.

use super::reactions::JointReactions;
use crate::estimate::{error_scale, relative};
use crate::trajectory::compute::{Analysis, force_scales};
use dwell_geometry::space::{Plan, Pose, Vec3};
use dwell_kinetostatics::space::{Component, Model, Workspace};
use dwell_kinetostatics::{InverseDynamics, MachineModel as _};
use dwell_numerics::{DoubleDouble, Scalar};

/// Number of positions that are evaluated again, along the whole trajectory.
const POSITIONS: usize = 48;
/// Position, velocity and acceleration of a point and of a rotation.
const KINDS: usize = 6;

/// The largest errors so far.
pub(crate) struct RoundingInSpace<'a> {
    model: &'a Model,
    analysis: Analysis,
    stride: usize,
    /// By kind of number: the largest error and the largest value.
    motion: [[f64; 2]; KINDS],
    /// The same of moments and of forces.
    forces: [[f64; 2]; 2],
    /// By actuator and by reaction: whether it is a force. Of the reactions those that are requested.
    is_force: [Vec<bool>; 2],
    workspace: Workspace<DoubleDouble>,
}

impl<'a> RoundingInSpace<'a> {
    /// For a trajectory of so many positions.
    pub(super) fn new(
        (model, reactions): (&'a Model, &JointReactions),
        (analysis, points): (Analysis, usize),
    ) -> Option<Self> {
        // WebAssembly has no fused multiply–add, on which these numbers are built: the estimate would take most of the time.
        if cfg!(target_family = "wasm") || analysis == Analysis::FreeMotion {
            return None;
        }
        let actuators = (0..model.plan().actuators()).map(|i| !model.is_angle(i));
        let requested = reactions.requested.iter();
        let requested = requested.map(|r| matches!(r.component, Component::Force(..)));
        Some(Self {
            model,
            analysis,
            stride: points.div_ceil(POSITIONS).max(1),
            motion: [[0.0; 2]; KINDS],
            forces: [[0.0; 2]; 2],
            is_force: [actuators.collect(), requested.collect()],
            workspace: model.workspace(),
        })
    }

    /// Adds position `k`, at (t, q, q̇, q̈), if it is one of those evaluated again.
    pub(super) fn add_position(
        &mut self,
        (k, t): (usize, f64),
        at: [&[f64]; 3],
        (pose, results): (&Pose, &InverseDynamics<f64>),
    ) {
        if !k.is_multiple_of(self.stride) {
            return;
        }
        let lift = |values: &[f64]| values.iter().map(|&v| DoubleDouble::from_f64(v)).collect();
        let at: [Vec<DoubleDouble>; 3] = at.map(lift);
        match self.analysis {
            Analysis::Kinematics => self.add_motion(&at, pose),
            _ => self.add_forces(t, &at, results),
        }
    }

    fn add_motion(&mut self, [q, q_dot, q_ddot]: &[Vec<DoubleDouble>; 3], pose: &Pose) {
        let plan = self.model.plan();
        let mut precise = plan.pose::<DoubleDouble>();
        // Next to a limit position there may be a pose in double precision and none in 32 digits.
        if plan.positions(q, &mut precise).is_err() {
            return;
        }
        plan.velocities(q_dot, &mut precise);
        plan.accelerations(q_ddot, &mut precise);
        for body in 0..self.model.mechanism().bodies.len() {
            let both = numbers(plan, pose, body)
                .into_iter()
                .zip(numbers(plan, &precise, body));
            for ([max_error, max_value], (plain, precise)) in self.motion.iter_mut().zip(both) {
                for (value, precise) in plain.into_iter().zip(precise) {
                    let error = (precise - DoubleDouble::from_f64(value)).value().abs();
                    *max_error = max_error.max(error);
                    *max_value = max_value.max(value.abs());
                }
            }
        }
    }

    fn add_forces(
        &mut self,
        t: f64,
        [q, q_dot, q_ddot]: &[Vec<DoubleDouble>; 3],
        results: &InverseDynamics<f64>,
    ) {
        let mut precise = self.model.result_buffer::<DoubleDouble>();
        let workspace = &mut self.workspace;
        let found = self
            .model
            .kinetostatics(t, [q, q_dot, q_ddot], workspace, &mut precise);
        if found.is_err() {
            return;
        }
        let values = [&results.tau, &results.reactions];
        let precise = [&precise.tau, &precise.reactions];
        for ((values, precise), forces) in values.into_iter().zip(precise).zip(&self.is_force) {
            for ((value, precise), &force) in values.iter().zip(precise).zip(forces) {
                let [max_error, max_value] = &mut self.forces[usize::from(force)];
                let error = (*precise - DoubleDouble::from_f64(*value)).value().abs();
                *max_error = max_error.max(error);
                *max_value = max_value.max(value.abs());
            }
        }
    }

    /// The largest error, relative to the largest value of its unit. What does not move has the error of what does.
    pub(super) fn max_relative(&self) -> f64 {
        let size = self.model.plan().size();
        if self.analysis != Analysis::Kinematics {
            let [[moment_error, moment], [force_error, force]] = self.forces;
            let references = force_scales(size, [force, moment], 0.0);
            let forces = relative(force_error, error_scale(force, references[0]));
            return forces.max(relative(moment_error, error_scale(moment, references[1])));
        }
        let [position, orientation, linear @ ..] = self.motion;
        let position = relative(position[0], position[1].max(size));
        let mut largest = position.max(orientation[0]);
        for [[error, value], [angular_error, angular]] in
            [[linear[0], linear[1]], [linear[2], linear[3]]]
        {
            let references = [size * angular, value / size];
            largest = largest
                .max(relative(error, error_scale(value, references[0])))
                .max(relative(angular_error, error_scale(angular, references[1])));
        }
        largest
    }
}

/// The numbers of a body, by kind: position, rotation, velocity, angular velocity, acceleration, angular acceleration.
fn numbers<T: Scalar>(plan: &Plan, pose: &Pose<T>, body: usize) -> [Vec<T>; KINDS] {
    let (frame, motion) = (plan.frame(pose, body), plan.body_motion(pose, body));
    let parts = |v: Vec3<T>| vec![v.x, v.y, v.z];
    [
        parts(frame.position),
        frame.rotation.columns.into_iter().flat_map(parts).collect(),
        parts(motion.velocity),
        parts(motion.angular_velocity),
        parts(motion.acceleration),
        parts(motion.angular_acceleration),
    ]
}
