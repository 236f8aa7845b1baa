//! The exact model with every reaction, as the subject of the checks.

use dwell_geometry::PositionError;
use dwell_kinetostatics::{ExactModel, ReducedModel};
use dwell_scene::PlaneScene;
use dwell_study::StudyError;
use dwell_study::models::reduced_model;
use dwell_verify::{Coefficients, InverseDynamics, Pose, Subject, SubjectError};

/// The compiled model of a scene with all reactions.
#[derive(Debug)]
pub struct PlanSubject {
    exact: ExactModel,
}

impl PlanSubject {
    /// Compiles a scene for all reactions.
    ///
    /// # Errors
    /// As [`reduced_model`].
    pub fn new(scene: &PlaneScene) -> Result<Self, StudyError> {
        Ok(Self {
            exact: reduced_model(scene, &scene.mechanism.reactions())?,
        })
    }

    /// The model.
    pub fn exact(&self) -> &ExactModel {
        &self.exact
    }
}

fn subject_error(q: f64) -> impl Fn(PositionError) -> SubjectError {
    move |e| SubjectError {
        q,
        message: e.to_string(),
    }
}

impl Subject for PlanSubject {
    fn poses(&self, q: f64) -> Result<Vec<Pose>, SubjectError> {
        let model = self.exact.model();
        let (plan, mut pose) = (model.plan(), model.plan().pose());
        plan.positions(&[q], &mut pose).map_err(subject_error(q))?;
        Ok(Pose::all_in_plane(
            &plan.body_frames(model.mechanism(), &pose),
        ))
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let mut at = self.exact.model().coefficient_buffer();
        let mut workspace = self.exact.workspace();
        let evaluated = self.exact.coefficients(q, &mut workspace, &mut at);
        evaluated.map_err(subject_error(q))?;
        Ok(at)
    }

    fn inverse_dynamics(
        &self,
        q: f64,
        q_dot: f64,
        q_ddot: f64,
    ) -> Result<InverseDynamics, SubjectError> {
        let model = self.exact.model();
        let (mut workspace, mut out) = (model.workspace(), model.result_buffer());
        let done = model.inverse_dynamics(&[q], &[q_dot], &[q_ddot], &mut workspace, &mut out);
        done.map_err(subject_error(q))?;
        Ok(InverseDynamics {
            tau: out.tau[0],
            reactions: out.reactions,
        })
    }
}
