//! The exact model with every reaction, as the subject of the checks.

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

/// Why there is no claim.
pub(crate) type Refusal = Box<dyn std::error::Error>;

/// What is claimed at coordinates, or why there is nothing.
pub(crate) fn claimed_at<C>(
    q: &[f64],
    claim: impl FnOnce() -> Result<C, Refusal>,
) -> Result<C, SubjectError> {
    claim().map_err(|why| SubjectError {
        q: q.first().copied().unwrap_or(0.0),
        message: why.to_string(),
    })
}

impl Subject for PlanSubject {
    fn poses(&self, q: f64) -> Result<Vec<Pose>, SubjectError> {
        let model = self.exact.model();
        let (plan, mut pose) = (model.plan(), model.plan().pose());
        claimed_at(&[q], || Ok(plan.positions(&[q], &mut pose)?))?;
        Ok(Pose::all_in_plane(
            &plan.body_frames(model.mechanism(), &pose),
        ))
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let mut at = self.exact.model().coefficient_buffer();
        let mut workspace = self.exact.workspace();
        claimed_at(&[q], || {
            Ok(self.exact.coefficients(q, &mut workspace, &mut at)?)
        })?;
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
        claimed_at(&[q], || {
            let (memory, out) = (&mut workspace, &mut out);
            Ok(model.inverse_dynamics(&[q], &[q_dot], &[q_ddot], memory, out)?)
        })?;
        Ok(InverseDynamics {
            tau: out.tau[0],
            reactions: out.reactions,
        })
    }
}
