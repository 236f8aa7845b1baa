//! A reduced model in space with all reactions, as the subject of the checks.

use super::claims::all_reactions;
use dwell_geometry::PositionError;
use dwell_kinetostatics::space::{Axes, Model};
use dwell_study::{PreparedSpaceScene, StudyError};
use dwell_verify::{Coefficients, InverseDynamics, Pose, Subject, SubjectError};

/// The model with all components of all joints in the axes of the ground.
pub(super) struct SpatialSubject {
    pub(super) model: Model,
    bodies: usize,
}

impl SpatialSubject {
    pub(super) fn new(prepared: &PreparedSpaceScene<'_>) -> Result<Self, StudyError> {
        let all = all_reactions(prepared.scene, &[Axes::Ground]);
        Ok(Self {
            model: prepared.model_for(&all)?,
            bodies: prepared.scene.mechanism.bodies.len(),
        })
    }
}

fn refused(q: f64) -> impl Fn(PositionError) -> SubjectError {
    move |error| SubjectError {
        q,
        message: error.to_string(),
    }
}

impl Subject for SpatialSubject {
    fn poses(&self, q: f64) -> Result<Vec<Pose>, SubjectError> {
        let (plan, mut pose) = (self.model.plan(), self.model.plan().pose());
        plan.positions(&[q], &mut pose).map_err(refused(q))?;
        let bodies = 0..self.bodies;
        Ok(bodies.map(|b| plan.placement(&pose, b).into()).collect())
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let (mut workspace, mut at) = (self.model.workspace(), self.model.coefficient_buffer());
        let done = self.model.reduce(q, &mut workspace, &mut at);
        done.map_err(refused(q))?;
        Ok(at)
    }

    fn inverse_dynamics(
        &self,
        q: f64,
        q_dot: f64,
        q_ddot: f64,
    ) -> Result<InverseDynamics, SubjectError> {
        let (mut workspace, mut found) = (self.model.workspace(), self.model.result_buffer());
        let rates = [[q_dot], [q_ddot]];
        let done =
            self.model
                .inverse_dynamics(&[q], &rates[0], &rates[1], &mut workspace, &mut found);
        done.map_err(refused(q))?;
        Ok(InverseDynamics {
            tau: found.tau[0],
            reactions: found.reactions,
        })
    }
}
