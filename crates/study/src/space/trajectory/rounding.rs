//! The rounding error along a trajectory in space: some positions are evaluated again in 32-digit arithmetic.

use super::reactions::JointReactions;
use crate::trajectory::compute::{Analysis, BodyNumbers, LargestErrors};
use dwell_geometry::space::{Plan, Pose, Vec3};
use dwell_kinetostatics::space::{Component, Model, Workspace};
use dwell_kinetostatics::{InverseDynamics, MachineModel as _};
use dwell_numerics::{DoubleDouble, Scalar};

/// The largest errors so far.
pub(crate) struct RoundingInSpace<'a> {
    model: &'a Model,
    largest: LargestErrors,
    workspace: Workspace<DoubleDouble>,
}

impl<'a> RoundingInSpace<'a> {
    /// For a trajectory of so many positions.
    pub(super) fn new(
        (model, reactions): (&'a Model, &JointReactions),
        of: (Analysis, usize),
    ) -> Option<Self> {
        let actuators = (0..model.plan().actuators()).map(|i| !model.is_angle(i));
        // Of the reactions those that are requested.
        let requested = reactions.requested.iter();
        let requested = requested.map(|r| matches!(r.component, Component::Force(..)));
        let is_force = [actuators.collect(), requested.collect()];
        Some(Self {
            model,
            largest: LargestErrors::new(of, model.plan().size(), is_force)?,
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
        if !self.largest.include(k) {
            return;
        }
        let lift = |values: &[f64]| values.iter().map(|&v| DoubleDouble::from_f64(v)).collect();
        let at: [Vec<DoubleDouble>; 3] = at.map(lift);
        match self.largest.analysis {
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
            let precise = numbers(plan, &precise, body);
            self.largest.add_body(numbers(plan, pose, body), precise);
        }
    }

    fn add_forces(
        &mut self,
        t: f64,
        [q, q_dot, q_ddot]: &[Vec<DoubleDouble>; 3],
        found: &InverseDynamics<f64>,
    ) {
        let mut precise = self.model.result_buffer::<DoubleDouble>();
        let (at, workspace) = ([&q[..], q_dot, q_ddot], &mut self.workspace);
        let evaluated = self.model.kinetostatics(t, at, workspace, &mut precise);
        if evaluated.is_err() {
            return;
        }
        let errors = |values: &[f64], precise: &[DoubleDouble]| -> Vec<f64> {
            let pairs = values.iter().zip(precise);
            let error =
                |(v, p): (&f64, &DoubleDouble)| (*p - DoubleDouble::from_f64(*v)).value().abs();
            pairs.map(error).collect()
        };
        let of_actuators = errors(&found.tau, &precise.tau);
        let of_reactions = errors(&found.reactions, &precise.reactions);
        self.largest
            .add_forces(found, [&of_actuators, &of_reactions]);
    }

    /// The largest error, relative to the largest value of its unit.
    pub(super) fn max_relative(&self) -> f64 {
        self.largest.max_relative()
    }
}

/// The numbers of a body, by kind.
fn numbers<T: Scalar>(plan: &Plan, pose: &Pose<T>, body: usize) -> BodyNumbers<T> {
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
