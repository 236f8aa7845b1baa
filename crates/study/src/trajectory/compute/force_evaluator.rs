//! Evaluates the forces at one position of a trajectory in the plane after another.

use crate::explain::table_of;
use crate::machines::first_uncovered;
use crate::trajectory::compute::{Analysis, CouplingMonitor, StopCause, TrajectorySample};
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_geometry::{Motion, Pose};
use dwell_kinetostatics::{EvaluatedState, InverseDynamics, Model, Workspace};
use dwell_scene::PlaneScene;

/// Evaluates the forces at one position after another.
#[derive(Clone)]
pub(crate) struct ForceEvaluator<'a> {
    pub(crate) model: &'a Model,
    analysis: Analysis,
    workspace: Workspace<f64>,
    pub(crate) results: InverseDynamics<f64>,
    pub(super) pose: Pose<f64>,
    /// Whether something is computed from the pose that the forces do not need.
    pub(super) keeps_poses: bool,
    /// Whether forces are computed, or the motion of the bodies alone.
    pub(super) has_forces: bool,
    pub(super) motion_buffer: Motion<f64>,
    /// The bodies at the velocities of the trajectory, whatever the analysis.
    pub(super) body_states: BodyStates,
    couplings: CouplingMonitor<'a, CoordinateFunction>,
    /// Whether the table of a load may be exceeded.
    has_tables: bool,
}

impl<'a> ForceEvaluator<'a> {
    pub(crate) fn new(scene: &'a PlaneScene, model: &'a Model, analysis: Analysis) -> Self {
        Self {
            model,
            analysis,
            workspace: model.workspace(),
            results: model.result_buffer(),
            pose: model.plan().pose(),
            keeps_poses: false,
            has_forces: true,
            motion_buffer: model.plan().motion(),
            body_states: BodyStates::new(model.plan()),
            couplings: CouplingMonitor::new(&scene.mechanism, |variable| {
                CoordinateFunction::find(&scene.mechanism, variable)
            }),
            has_tables: (model.loads().iter()).any(|load| table_of(&load.magnitude).is_some()),
        }
    }

    /// Evaluates the position of a sample, with the loads at time `t`; its state, where forces are computed.
    pub(crate) fn evaluate(
        &mut self,
        sample: &TrajectorySample,
        t: f64,
    ) -> Result<Option<EvaluatedState<'_>>, StopCause> {
        let (model, workspace, results) = (self.model, &mut self.workspace, &mut self.results);
        let (q, q_dot, q_ddot) = (&sample.q, &sample.q_dot, &sample.q_ddot);
        let state = match self.analysis {
            Analysis::Kinematics => {
                model.plan().positions(q, &mut self.pose)?;
                return Ok(None);
            }
            Analysis::Statics => model.statics(t, q, workspace, results)?,
            Analysis::Kinetostatics | Analysis::FreeMotion if !self.has_forces => {
                let mut state = model.kinematic_state(q, q_dot, workspace)?;
                if self.keeps_poses {
                    self.pose.clone_from(state.pose());
                }
                self.body_states.copy_from(state.bodies_at(q_ddot));
                check_tables(model, self.has_tables, t, &self.body_states)?;
                return Ok(None);
            }
            Analysis::Kinetostatics | Analysis::FreeMotion => {
                let mut state = model.kinematic_state(q, q_dot, workspace)?.apply_loads(t)?;
                for &(load, magnitude) in &sample.drive_magnitudes {
                    state.set_magnitude(load, magnitude);
                }
                state.evaluate(q_ddot, results)?
            }
        };
        if self.analysis == Analysis::Statics || self.keeps_poses {
            self.pose.clone_from(state.pose());
        }
        if self.analysis != Analysis::Statics {
            self.body_states.copy_from(state.bodies());
        }
        check_tables(model, self.has_tables, t, state.bodies())?;
        Ok(Some(state))
    }

    /// Computes the states of the bodies at the velocities of the sample, unless the forces were evaluated at them; fails where a
    /// coupling jumps.
    pub(crate) fn fill_states(&mut self, sample: &TrajectorySample) -> Result<(), StopCause> {
        if matches!(self.analysis, Analysis::Statics | Analysis::Kinematics) {
            let (plan, pose) = (self.model.plan(), &self.pose);
            plan.velocities(pose, &sample.q_dot, &mut self.motion_buffer);
            plan.accelerations(pose, &sample.q_ddot, &mut self.motion_buffer);
            self.body_states.fill(plan, pose, &self.motion_buffer);
        }
        let states = &self.body_states;
        self.couplings.check(|of| states.coordinate(of)[0])
    }
}

/// Fails at the first load of a model whose table, if any has one, does not cover the state of the bodies at time `t` (s).
fn check_tables(
    model: &Model,
    has_tables: bool,
    t: f64,
    states: &BodyStates,
) -> Result<(), StopCause> {
    let uncovered = has_tables.then(|| first_uncovered(model, t, |of| states.coordinate(of)));
    match uncovered.flatten() {
        Some((load, value)) => Err(StopCause::OffTable { load, value }),
        None => Ok(()),
    }
}
