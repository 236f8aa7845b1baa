//! The recording of a state of a machine in space.

use super::action::{BodyAction, CompiledKind};
use super::load::LoadKind;
use super::mass::Mass;
use super::model::{Model, Workspace};
use crate::error::PositionResult;
use crate::pass::InverseDynamics;
use crate::recorded::{Described, Numbered, RecordableModel, StateInputs, StateRecordingError};
use dwell_geometry::JointId;
use dwell_geometry::space::{CountedRevolutions, Joint, JointNumbers, Mechanism, Vec3};
use dwell_numerics::{RecordedNumber, Scalar};

impl RecordableModel for Model {
    type Mechanism = Mechanism;
    type Mass = Mass;
    type Point = Vec3;

    fn numbers(&self, of: Described<'_, Self>) -> Option<Vec<f64>> {
        let mut numbers = Vec::new();
        let joints = of.mechanism.joints.iter().map(Joint::numbers);
        joints.for_each(|joint| joint.list(&mut numbers));
        of.masses.iter().for_each(|mass| mass.list(&mut numbers));
        of.loads
            .iter()
            .for_each(|load| load.kind.list(&mut numbers));
        (of.wanted.coordinates.iter()).for_each(|wanted| wanted.list(&mut numbers));
        (of.wanted.points.iter()).for_each(|(_, point)| point.list(&mut numbers));
        Some(numbers)
    }

    fn solution(&self, q: &[f64], workspace: &mut Workspace) -> PositionResult<Vec<f64>> {
        self.plan().positions(q, &mut workspace.pose)?;
        Ok(self.plan().solution(&workspace.pose))
    }

    fn outputs(
        &self,
        of: Described<'_, Self>,
        at: &StateInputs<'_>,
    ) -> Result<Vec<RecordedNumber>, StateRecordingError> {
        let mut numbers = at.numbers.iter().copied();
        let mut next = |value: f64| numbers.next().unwrap_or(Scalar::from_f64(value));
        let joints = of.mechanism.joints.iter().map(Joint::numbers);
        let joints: Vec<JointNumbers<RecordedNumber>> =
            joints.map(|joint| joint.replaced(&mut next)).collect();
        let masses: Vec<Mass<RecordedNumber>> = of
            .masses
            .iter()
            .map(|mass| mass.replaced(&mut next))
            .collect();
        let model = self.pass_model.with_numbers(of.mechanism, &joints, &masses);
        let model = model.ok_or(StateRecordingError::Structure)?;
        let plan = &model.plan;
        let (mut pose, mut forces) = (plan.pose(), plan.forces());
        plan.positions_at_solution(at.q, at.solution, &mut pose)?;
        plan.velocities(at.q_dot, &mut pose);
        plan.accelerations(at.q_ddot, &mut pose);
        model.require_inertia(&pose, &mut forces);
        let of_joint = |joint: JointId| joints[joint.0];
        for (k, (load, &magnitude)) in of.loads.iter().zip(at.magnitudes).enumerate() {
            let kind: LoadKind<RecordedNumber> = load.kind.replaced(&mut next);
            let kind = CompiledKind::in_frames(&kind, of.mechanism, of_joint, plan)
                .map_err(StateRecordingError::Coordinate)?;
            let required = &mut forces.required;
            let add = |(body, [arm, force, couple]): BodyAction<RecordedNumber>| {
                required[body][0].add_at(arm, -force, -couple);
            };
            kind.act(magnitude, plan, &pose, &model.masses, add)
                .ok_or(StateRecordingError::NoDirection(k))?;
        }
        let mut result = InverseDynamics::buffer(plan.actuators(), model.reactions.len());
        model.balance(&pose, &mut forces, &mut result);
        let mut outputs = [result.tau, result.reactions].concat();
        for wanted in &of.wanted.coordinates {
            let (coordinate, revolutions) =
                (wanted.replaced(&mut next), CountedRevolutions::Always);
            let function = plan.function_of(of.mechanism, of_joint, coordinate, revolutions);
            let function = function.map_err(StateRecordingError::Coordinate)?;
            outputs.extend(plan.coordinate(&pose, function));
        }
        for (body, point) in &of.wanted.points {
            let inner = (plan.evaluation_frame(body.0)).inner_point(point.replaced(&mut next));
            let (frame, motion) = (plan.frame(&pose, body.0), plan.state(&pose, body.0));
            let arm = frame.rotation.apply(inner);
            let position = plan.origin() + frame.position + arm;
            let vectors = [
                position,
                motion.point_velocity(arm),
                motion.point_acceleration(arm),
            ];
            outputs.extend(vectors.into_iter().flat_map(|v| [v.x, v.y, v.z]));
        }
        Ok(outputs)
    }
}
