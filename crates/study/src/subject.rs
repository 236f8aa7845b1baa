//! The exact model as the subject of the checks: every reaction of every joint.

use crate::error::StudyError;
use crate::prepare::model;
use dwell_geometry::{Mechanism, PlaceError};
use dwell_kinetostatics::{Exact, Reduced};
use dwell_scene::Scene;
use dwell_verify::{Actions, Coefficients, Subject, SubjectError};

/// The compiled plan of a scene, with all reactions.
#[derive(Debug)]
pub struct PlanSubject {
    mechanism: Mechanism,
    exact: Exact,
}

impl PlanSubject {
    /// Compiles a scene for all reactions.
    ///
    /// # Errors
    /// As [`crate::Prepared::new`].
    pub fn new(scene: &Scene) -> Result<Self, StudyError> {
        Ok(Self {
            mechanism: scene.mechanism.clone(),
            exact: model(scene, &scene.mechanism.reactions())?,
        })
    }

    /// The model.
    pub fn exact(&self) -> &Exact {
        &self.exact
    }
}

fn refused(q: f64) -> impl Fn(PlaceError) -> SubjectError {
    move |e| SubjectError {
        q,
        message: e.to_string(),
    }
}

impl Subject for PlanSubject {
    fn poses(&self, q: f64) -> Result<Vec<[f64; 3]>, SubjectError> {
        let plan = self.exact.model().plan();
        let mut pose = plan.pose();
        plan.place(&[q], &mut pose).map_err(refused(q))?;
        Ok(plan.body_frames(&self.mechanism, &pose))
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let mut work = self.exact.work();
        let mut at = self.exact.model().coefficients();
        let placed = self.exact.coefficients(q, &mut work, &mut at);
        placed.map_err(refused(q))?;
        Ok(Coefficients {
            m: at.m,
            half_dm: at.half_dm,
            a: at.a,
            b: at.b,
        })
    }

    fn actions(&self, q: f64, q_dot: f64, q_ddot: f64) -> Result<Actions, SubjectError> {
        let model = self.exact.model();
        let mut work = model.workspace();
        let mut actions = model.actions();
        let placed = model.act(&[q], &[q_dot], &[q_ddot], &mut work, &mut actions);
        placed.map_err(refused(q))?;
        Ok(Actions {
            tau: actions.tau[0],
            reactions: actions.reactions,
        })
    }
}
