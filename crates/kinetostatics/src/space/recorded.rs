//! The recording of a state of a machine in space.

use super::action::{BodyAction, CompiledKind};
use super::load::LoadKind;
use super::mass::Mass;
use super::model::{Model, Workspace};
use super::pass::PassModel;
use crate::error::PositionResult;
use crate::pass::InverseDynamics;
use crate::recorded::{
    Described, Numbered, RecordableModel, StateInputs, StateRecordingError, first_order,
    signal_coordinates,
};
use dwell_geometry::JointId;
use dwell_geometry::space::{
    Coordinate, CountedRevolutions, Forces, Joint, JointNumbers, Mechanism, Pose, Vec3,
};
use dwell_numerics::{RecordedNumber, Scalar};

/// A machine whose numbers are inputs.
struct RecordedMachine<'a> {
    of: Described<'a, Model>,
    joints: &'a [JointNumbers<RecordedNumber>],
    model: &'a PassModel<RecordedNumber>,
}

impl RecordedMachine<'_> {
    /// A coordinate with its rate and acceleration.
    fn coordinate(
        &self,
        coordinate: Coordinate<RecordedNumber>,
        pose: &Pose<RecordedNumber>,
    ) -> Result<[RecordedNumber; 3], StateRecordingError> {
        let (plan, numbers) = (&self.model.plan, |joint: JointId| self.joints[joint.0]);
        let counted = CountedRevolutions::Always;
        let function = plan.function_of(self.of.mechanism, numbers, coordinate, counted);
        let motion = function.map(|function| plan.coordinate(pose, function));
        motion.map_err(StateRecordingError::Coordinate)
    }

    /// Subtracts the wrenches of the loads, with the inputs of their magnitudes and their numbers, from the required ones.
    fn require_loads(
        &self,
        mut magnitudes: impl Iterator<Item = RecordedNumber>,
        next: &mut impl FnMut(f64) -> RecordedNumber,
        pose: &Pose<RecordedNumber>,
        forces: &mut Forces<RecordedNumber>,
    ) -> Result<(), StateRecordingError> {
        let (plan, mechanism) = (&self.model.plan, self.of.mechanism);
        let numbers = |joint: JointId| self.joints[joint.0];
        for (k, load) in self.of.loads.iter().enumerate() {
            let kind: LoadKind<RecordedNumber> = load.kind.replaced(next);
            let signals = signal_coordinates(&load.magnitude).map(|(signal, is_velocity)| {
                let motion = self.coordinate(signal.replaced(next), pose)?;
                Ok(motion[usize::from(is_velocity)])
            });
            let magnitude = first_order(&mut magnitudes, signals)?;
            let kind = CompiledKind::in_frames(&kind, mechanism, numbers, plan)
                .map_err(StateRecordingError::Coordinate)?;
            let required = &mut forces.required;
            let add = |(body, [arm, force, couple]): BodyAction<RecordedNumber>| {
                required[body][0].add_at(arm, -force, -couple);
            };
            kind.act(magnitude, plan, pose, &self.model.masses, add)
                .ok_or(StateRecordingError::NoDirection(k))?;
        }
        Ok(())
    }
}

impl RecordableModel for Model {
    type Mechanism = Mechanism;
    type Mass = Mass;
    type Point = Vec3;

    fn numbers(&self, of: Described<'_, Self>) -> Option<Vec<f64>> {
        let mut numbers = Vec::new();
        let joints = of.mechanism.joints.iter().map(Joint::numbers);
        joints.for_each(|joint| joint.list(&mut numbers));
        of.masses.iter().for_each(|mass| mass.list(&mut numbers));
        for load in of.loads {
            load.kind.list(&mut numbers);
            let signals = signal_coordinates(&load.magnitude);
            signals.for_each(|(coordinate, _)| coordinate.list(&mut numbers));
        }
        (of.wanted.coordinates.iter()).for_each(|wanted| wanted.list(&mut numbers));
        (of.wanted.points.iter()).for_each(|(_, point)| point.list(&mut numbers));
        Some(numbers)
    }

    fn at_numbers(&self, _: Described<'_, Self>) -> Option<Self> {
        Some(self.clone())
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
        let machine = RecordedMachine {
            of,
            joints: &joints,
            model: &model,
        };
        let magnitudes = at.magnitudes.iter().copied();
        machine.require_loads(magnitudes, &mut next, &pose, &mut forces)?;
        let mut result = InverseDynamics::buffer(plan.actuators(), model.reactions.len());
        model.balance(&pose, &mut forces, &mut result);
        let mut outputs = [result.tau, result.reactions].concat();
        for wanted in &of.wanted.coordinates {
            outputs.extend(machine.coordinate(wanted.replaced(&mut next), &pose)?);
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
