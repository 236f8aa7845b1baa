//! Evaluates one position of a trajectory in space after another.

use super::load_forces::LoadForce;
use super::reactions::JointReactions;
use super::totals::Totals;
use crate::explain::describe_coordinate;
use crate::machines::first_uncovered;
use crate::number_format::digits;
use crate::trajectory::compute::{
    Analysis, Quantity, RowEvaluator, StopCause, Trajectory, TrajectorySample,
};
use dwell_geometry::JointId;
use dwell_geometry::space::{
    BodyMotion, Coordinate, CoordinateFunction, Placement, Plan, Pose, Vec3,
};
use dwell_kinetostatics::space::{Model, Workspace};
use dwell_kinetostatics::{InverseDynamics, MachineModel as _};
use dwell_scene::SpaceScene;
use std::f64::consts::TAU;

/// Evaluates all quantities at one position after another.
#[derive(Clone)]
pub(crate) struct SpaceEvaluator<'a> {
    scene: &'a SpaceScene,
    model: &'a Model,
    reactions: &'a JointReactions,
    analysis: Analysis,
    pub(super) pose: Pose,
    pub(super) placements: Vec<Placement>,
    motions: Vec<BodyMotion>,
    /// By body: its rotation as a vector, followed from one position to the next, rad.
    pub(super) rotations: Vec<Vec3>,
    workspace: Workspace<f64>,
    pub(super) results: InverseDynamics<f64>,
    load_forces: Vec<Option<LoadForce>>,
    /// The coordinates that have columns.
    measured: Vec<(Coordinate, CoordinateFunction)>,
    totals: Totals,
}

impl<'a> SpaceEvaluator<'a> {
    pub(crate) fn new(
        scene: &'a SpaceScene,
        (model, reactions): (&'a Model, &'a JointReactions),
        analysis: Analysis,
    ) -> Self {
        let bodies = scene.mechanism.bodies.len();
        Self {
            scene,
            model,
            reactions,
            analysis,
            pose: model.plan().pose(),
            placements: vec![Placement::default(); bodies],
            motions: vec![BodyMotion::default(); bodies],
            rotations: vec![Vec3::ZERO; bodies],
            workspace: model.workspace(),
            results: model.result_buffer(),
            load_forces: LoadForce::of_all(scene, model.plan()),
            measured: measured(scene, model.plan()),
            totals: Totals::new(scene),
        }
    }

    /// The residual of the power balance, and the sum of its absolute terms, W.
    pub(super) fn power_terms(&self) -> [f64; 2] {
        [self.totals.power[3].abs(), self.totals.power_scale]
    }

    /// Where a sample is, in the names of the scene.
    pub(super) fn position_of(
        &self,
        trajectory: &Trajectory<'_>,
        sample: &TrajectorySample,
    ) -> String {
        let timed = trajectory.is_timed();
        let time = timed.then(|| format!("t = {} s", digits(sample.t, 6)));
        let actuators = self.scene.mechanism.actuators.iter().enumerate();
        let coordinates = actuators.map(|(i, actuator)| {
            let is_angle = self.model.is_angle(i);
            describe_coordinate(self.scene, &actuator.name, sample.q[i], is_angle)
        });
        let all: Vec<String> = time.into_iter().chain(coordinates).collect();
        all.join(", ")
    }

    /// Actuator forces, reactions and what they come to.
    fn evaluate_forces(
        &mut self,
        (t, [q, q_dot, q_ddot]): (f64, [&[f64]; 3]),
        given: &[(usize, f64)],
    ) -> Result<(), StopCause> {
        let at = (t, [q, q_dot, q_ddot]);
        let (workspace, results) = (&mut self.workspace, &mut self.results);
        self.totals
            .evaluate_loads(self.model, at, given, workspace, results)?;
        let motion_of = |of| self.model.coordinate_motion(of, &self.workspace);
        if let Some((load, value)) = first_uncovered(self.model, t, motion_of) {
            return Err(StopCause::OffTable { load, value });
        }
        let bodies = (&self.placements[..], &self.motions[..]);
        self.totals
            .compute(self.scene, bodies, (&self.results.tau, q_dot));
        Ok(())
    }
}

impl RowEvaluator for SpaceEvaluator<'_> {
    // Little of it could be left out.
    fn limit_to(&mut self, _: impl Iterator<Item = Quantity>) {}

    fn evaluate(&mut self, sample: &TrajectorySample, t: f64) -> Result<(), StopCause> {
        let rest = vec![0.0; sample.q.len()];
        let [q, q_dot, q_ddot] = sample.state(self.analysis, &rest);
        let plan = self.model.plan();
        plan.positions(q, &mut self.pose)?;
        plan.velocities(q_dot, &mut self.pose);
        plan.accelerations(q_ddot, &mut self.pose);
        for b in 0..self.placements.len() {
            let placement = plan.placement(&self.pose, b);
            self.placements[b] = placement;
            self.motions[b] = plan.body_motion(&self.pose, b);
            self.rotations[b] = followed(placement.rotation.vector(), self.rotations[b]);
        }
        match self.analysis {
            Analysis::Kinematics => Ok(()),
            Analysis::Statics | Analysis::Kinetostatics | Analysis::FreeMotion => {
                self.evaluate_forces((t, [q, q_dot, q_ddot]), &sample.drive_magnitudes)
            }
        }
    }

    // One arm for each quantity.
    fn value(&self, quantity: Quantity, sample: &TrajectorySample) -> f64 {
        let component = |v: Vec3, axis: usize| [v.x, v.y, v.z][axis];
        match quantity {
            Quantity::Time => sample.t,
            // Of a chart of a free motion in another coordinate, the actuator's own.
            Quantity::ActuatorCoordinate(i, order) => match sample.actuator_coordinate {
                Some(own) => own[order],
                None => [&sample.q, &sample.q_dot, &sample.q_ddot][order][i],
            },
            Quantity::MeasuredInSpace(of, order) => {
                let mut all = self.measured.iter();
                let found = all.find(|(coordinate, _)| *coordinate == of);
                let plan = self.model.plan();
                found.map_or(f64::NAN, |(_, f)| plan.coordinate(&self.pose, *f)[order])
            }
            Quantity::ActuatorForce(i) => self.results.tau[i],
            Quantity::PointInSpace(body, at, k) => {
                let (placement, motion) = (&self.placements[body.0], &self.motions[body.0]);
                let arm = placement.rotation.apply(at);
                let vectors = [
                    placement.position + arm,
                    motion.point_velocity(arm),
                    motion.point_acceleration(arm),
                ];
                component(vectors[k / 3], k % 3)
            }
            Quantity::RotationInSpace(body, k) => {
                let motion = &self.motions[body.0];
                let vectors = [
                    self.rotations[body.0],
                    motion.angular_velocity,
                    motion.angular_acceleration,
                ];
                component(vectors[k / 3], k % 3)
            }
            Quantity::Reaction(k) => self.results.reactions[k],
            Quantity::ForceMagnitude(joint) => {
                self.reactions.wrench(joint, &self.results.reactions)[0].norm()
            }
            Quantity::MomentMagnitude(joint) => {
                self.reactions.wrench(joint, &self.results.reactions)[1].norm()
            }
            Quantity::ShakingForce(k) => self.totals.shaking[k],
            Quantity::Power(k) => self.totals.power[k],
            Quantity::LoadForce(k) => {
                let magnitude = self.totals.magnitudes[k];
                let force = self.load_forces[k];
                force.map_or(f64::NAN, |f| f.at(self.model.plan(), &self.pose, magnitude))
            }
            Quantity::LoadPower(k) => self.totals.load_powers[k],
            Quantity::Extra(k) => sample.extra_values[k],
            // The columns of a mechanism in space are none of these.
            Quantity::Measured(..)
            | Quantity::BodyAngle(..)
            | Quantity::VelocityRatio(_)
            | Quantity::MechanicalAdvantage(..)
            | Quantity::Pole(..)
            | Quantity::PointCoordinate(..)
            | Quantity::TransmissionAngle(_)
            | Quantity::KnownReaction(..)
            | Quantity::BodyFrameForce(..)
            | Quantity::ForceDirection(_) => f64::NAN,
        }
    }

    fn angular_velocity(&self, _: Quantity) -> f64 {
        0.0
    }
}

/// The named coordinates and the travels of joints, as a plan evaluates them.
fn measured(scene: &SpaceScene, plan: &Plan) -> Vec<(Coordinate, CoordinateFunction)> {
    let joints = (0..scene.mechanism.joints.len()).map(JointId);
    let named = scene.coordinates.iter().map(|named| named.coordinate);
    let all = named.chain(joints.map(Coordinate::Travel));
    let of = |coordinate| {
        let function = plan.coordinate_function(&scene.mechanism, coordinate);
        Some((coordinate, function.ok()?))
    };
    all.filter_map(of).collect()
}

/// A rotation as a vector with the revolutions that bring it nearest to another.
fn followed(vector: Vec3, last: Vec3) -> Vec3 {
    let Some(axis) = vector.unit().or_else(|| last.unit()) else {
        return vector;
    };
    let revolutions = ((last.dot(axis) - vector.norm()) / TAU).round();
    vector + axis.scaled(TAU * revolutions)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_geometry::space::{Rotation, vec3};

    #[test]
    fn rotations_go_on_beyond_half_a_turn() {
        let axis = vec3(0.6, 0.0, -0.8);
        let mut last = Vec3::ZERO;
        for k in 0..200 {
            let angle = 0.1 * f64::from(k);
            last = followed(Rotation::of_vector(axis.scaled(angle)).vector(), last);
            let off = (last - axis.scaled(angle)).norm();
            assert!(off < 1e-7, "{angle}: {off:.1e}");
        }
    }
}
