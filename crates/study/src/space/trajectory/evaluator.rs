//! Evaluates one position of a trajectory in space after another.

use super::load_forces::LoadForce;
use super::reactions::SpaceRows;
use super::totals::Totals;
use crate::machines::first_uncovered;
use crate::space::assembled::SpaceStates;
use crate::trajectory::compute::{
    Analysis, BodyNumbers, CouplingMonitor, LargestErrors, Quantity, RowEvaluator, RowScene as _,
    StopCause, TrajectorySample,
};
use dwell_geometry::BodyId;
use dwell_geometry::space::{CoordinateFunction, Placement, Plan, Pose, Vec3};
use dwell_kinetostatics::space::{Model, Workspace};
use dwell_kinetostatics::{InverseDynamics, MachineModel as _};
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::SpaceScene;
use std::f64::consts::TAU;

/// Evaluates all quantities at one position after another.
#[derive(Clone)]
pub struct SpaceEvaluator<'a> {
    scene: &'a SpaceScene,
    rows: &'a SpaceRows,
    analysis: Analysis,
    pose: Pose,
    bodies: SpaceStates,
    /// By body: its rotation as a vector, followed from one position to the next, rad.
    rotations: Vec<Vec3>,
    workspace: Workspace<f64>,
    results: InverseDynamics<f64>,
    load_forces: Vec<Option<LoadForce>>,
    measured: Vec<Option<CoordinateFunction>>,
    totals: Totals,
    couplings: CouplingMonitor<'a, CoordinateFunction>,
}

impl<'a> SpaceEvaluator<'a> {
    pub(crate) fn new(scene: &'a SpaceScene, rows: &'a SpaceRows, analysis: Analysis) -> Self {
        let (model, bodies) = (&rows.model, scene.mechanism.bodies.len());
        let measured = scene.measured(model).into_iter();
        Self {
            scene,
            rows,
            analysis,
            pose: model.plan().pose(),
            bodies: SpaceStates(vec![Default::default(); bodies]),
            rotations: vec![Vec3::ZERO; bodies],
            workspace: model.workspace(),
            results: model.result_buffer(),
            load_forces: LoadForce::of_all(scene, model.plan()),
            measured: measured.map(|of| of.function).collect(),
            totals: Totals::new(scene),
            couplings: CouplingMonitor::new(&scene.mechanism, |variable| {
                let plan = model.plan();
                plan.coordinate_function(&scene.mechanism, variable).ok()
            }),
        }
    }

    /// The placements of the bodies.
    pub(super) fn placements(&self) -> Vec<Placement> {
        self.bodies
            .0
            .iter()
            .map(|(placement, _)| *placement)
            .collect()
    }

    /// Evaluates actuator forces, reactions and their sums.
    fn evaluate_forces(
        &mut self,
        t: f64,
        state: [&[f64]; 3],
        given: &[(usize, f64)],
    ) -> Result<(), StopCause> {
        let (model, workspace, results) =
            (&self.rows.model, &mut self.workspace, &mut self.results);
        self.totals
            .evaluate_loads(model, t, state, given, workspace, results)?;
        let motion_of = |of| model.coordinate_motion(of, &self.workspace);
        if let Some((load, value)) = first_uncovered(model, t, motion_of) {
            return Err(StopCause::OffTable { load, value });
        }
        let [_, q_dot, _] = state;
        self.totals
            .compute(self.scene, &self.bodies.0, &self.results.tau, q_dot);
        Ok(())
    }
}

impl RowEvaluator for SpaceEvaluator<'_> {
    type Model = Model;

    fn model(&self) -> &Model {
        &self.rows.model
    }

    fn continue_from(&mut self, other: &Self) {
        self.rotations.clone_from(&other.rotations);
    }

    fn evaluate(&mut self, sample: &TrajectorySample, t: f64) -> Result<(), StopCause> {
        let rest = vec![0.0; sample.q.len()];
        let state = sample.state(self.analysis, &rest);
        let [q, q_dot, q_ddot] = state;
        let plan = self.rows.model.plan();
        plan.positions(q, &mut self.pose)?;
        plan.velocities(q_dot, &mut self.pose);
        plan.accelerations(q_ddot, &mut self.pose);
        let pose = &self.pose;
        self.couplings.check(|of| plan.coordinate(pose, of)[0])?;
        for (b, body) in self.bodies.0.iter_mut().enumerate() {
            let placement = plan.placement(&self.pose, b);
            *body = (placement, plan.body_motion(&self.pose, b));
            self.rotations[b] = followed(placement.rotation.vector(), self.rotations[b]);
        }
        match self.analysis {
            Analysis::Kinematics => Ok(()),
            Analysis::Statics | Analysis::Kinetostatics | Analysis::FreeMotion => {
                self.evaluate_forces(t, state, &sample.drive_magnitudes)
            }
        }
    }

    fn forces(&self) -> &InverseDynamics<f64> {
        &self.results
    }

    fn bodies(&self) -> &impl crate::assembled::BodyStates {
        &self.bodies
    }

    fn rotation(&self, body: BodyId) -> [f64; 3] {
        let Vec3 { x, y, z } = self.rotations[body.0];
        [x, y, z]
    }

    fn measured(&self, k: usize) -> [f64; 3] {
        let plan = self.rows.model.plan();
        let found = self.measured[k].map(|of| plan.coordinate(&self.pose, of));
        found.unwrap_or([f64::NAN; 3])
    }

    fn power(&self) -> [f64; 5] {
        self.totals.power
    }

    fn power_scale(&self) -> f64 {
        self.totals.power_scale
    }

    fn load_power(&self, load: usize) -> f64 {
        self.totals.load_powers[load]
    }

    fn other(&self, quantity: Quantity) -> f64 {
        let wrench = |joint| self.rows.wrench(joint, &self.results.reactions);
        match quantity {
            Quantity::ForceMagnitude(joint) => wrench(joint)[0].norm(),
            Quantity::MomentMagnitude(joint) => wrench(joint)[1].norm(),
            Quantity::ShakingForce(k) => self.totals.shaking[k],
            Quantity::LeastDeterminant => {
                let plan = self.rows.model.plan();
                plan.least_relative_determinant(&self.pose)
            }
            Quantity::LoadForce(k) => {
                let (plan, magnitude) = (self.rows.model.plan(), self.totals.magnitudes[k]);
                let force = self.load_forces[k].map(|f| f.at(plan, &self.pose, magnitude));
                force.unwrap_or(f64::NAN)
            }
            _ => f64::NAN,
        }
    }

    /// The number of requested reactions.
    fn result_reactions(&self) -> usize {
        self.rows.requested.len()
    }

    fn add_rounding(
        &self,
        t: f64,
        at: [&[f64]; 3],
        workspace: &mut Workspace<DoubleDouble>,
        largest: &mut LargestErrors,
    ) {
        let lift = |values: &[f64]| values.iter().map(|&v| DoubleDouble::from_f64(v)).collect();
        let [q, q_dot, q_ddot]: [Vec<DoubleDouble>; 3] = at.map(lift);
        let (model, plan) = (&self.rows.model, self.rows.model.plan());
        if largest.analysis != Analysis::Kinematics {
            let mut precise = model.result_buffer::<DoubleDouble>();
            let at = [&q[..], &q_dot, &q_ddot];
            if model.kinetostatics(t, at, workspace, &mut precise).is_ok() {
                let found = &self.results;
                let tau = errors(&found.tau, &precise.tau);
                let reactions = errors(&found.reactions, &precise.reactions);
                largest.add_forces(found, [&tau, &reactions]);
            }
            return;
        }
        let mut precise = plan.pose::<DoubleDouble>();
        // Next to a limit position there may be a pose in double precision and none in 32 digits.
        if plan.positions(&q, &mut precise).is_err() {
            return;
        }
        plan.velocities(&q_dot, &mut precise);
        plan.accelerations(&q_ddot, &mut precise);
        for body in 0..self.bodies.0.len() {
            let precise = numbers(plan, &precise, body);
            largest.add_body(numbers(plan, &self.pose, body), precise);
        }
    }
}

/// The differences of values from more precise ones.
fn errors(values: &[f64], precise: &[DoubleDouble]) -> Vec<f64> {
    let pairs = values.iter().zip(precise);
    let error = |(v, p): (&f64, &DoubleDouble)| (*p - DoubleDouble::from_f64(*v)).value().abs();
    pairs.map(error).collect()
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
