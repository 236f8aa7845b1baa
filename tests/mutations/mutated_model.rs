//! The reduced model of a mechanism with a mutation of one operation, as the subject of the checks.

use super::mutating_scalar::{MutatingScalar, with_mutation};
use super::tested_mechanism::OperationMutation;
use super::to_f64::pose_to_f64;
use dwell_kinetostatics::Model;
use dwell_scene::PlaneScene;
use dwell_verify::{Coefficients, InverseDynamics, Pose, Subject, SubjectError};

/// The reduced model of a mechanism with its scene, evaluated in mutating numbers.
pub(super) struct MutatedModel<'a> {
    pub(super) model: &'a Model,
    pub(super) scene: &'a PlaneScene,
    pub(super) mutation: OperationMutation,
}

impl Subject for MutatedModel<'_> {
    fn poses(&self, q: f64) -> Result<Vec<Pose>, SubjectError> {
        let Self { model, scene, .. } = self;
        let mut pose = model.plan().pose();
        with_mutation(self.mutation, || {
            model.plan().positions(&[MutatingScalar::new(q)], &mut pose)
        })
        .map_err(subject_error(q))?;
        let pose = pose_to_f64(model.plan(), &pose);
        Ok(Pose::all_in_plane(
            &model.plan().body_frames(&scene.mechanism, &pose),
        ))
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let model = self.model;
        let (mut workspace, mut at) = (model.workspace(), model.coefficient_buffer());
        with_mutation(self.mutation, || {
            model.reduce(MutatingScalar::new(q), &mut workspace, &mut at)
        })
        .map_err(subject_error(q))?;
        Ok(Coefficients {
            m: at.m.0,
            half_dm: at.half_dm.0,
            a: at.a.iter().map(|v| v.0).collect(),
            b: at.b.iter().map(|v| v.0).collect(),
        })
    }

    fn inverse_dynamics(
        &self,
        q: f64,
        q_dot: f64,
        q_ddot: f64,
    ) -> Result<InverseDynamics, SubjectError> {
        let model = self.model;
        let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
        let [at, v, a] = [q, q_dot, q_ddot].map(|v| [MutatingScalar::new(v)]);
        with_mutation(self.mutation, || {
            model.inverse_dynamics(&at, &v, &a, &mut workspace, &mut result)
        })
        .map_err(subject_error(q))?;
        Ok(InverseDynamics {
            tau: result.tau[0].0,
            reactions: result.reactions.iter().map(|v| v.0).collect(),
        })
    }
}

fn subject_error<E: std::fmt::Display>(q: f64) -> impl Fn(E) -> SubjectError {
    move |e| SubjectError {
        q,
        message: e.to_string(),
    }
}
