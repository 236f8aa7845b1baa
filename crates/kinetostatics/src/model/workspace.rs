//! Working memory of a model.

use super::Model;
use crate::friction::FrictionWorkspace;
use crate::load::LoadState;
use crate::pass::{InverseDynamics, RecursivePass};
use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{Motion, Pose};
use dwell_numerics::Scalar;

/// Working memory for evaluations of a model in one thread.
#[derive(Debug, Clone, PartialEq)]
pub struct Workspace<T> {
    /// The last pose.
    pub pose: Pose<T>,
    /// The last motion.
    pub motion: Motion<T>,
    pub(crate) unit_passes: RecursivePass<T, 2>,
    pub(crate) pass: RecursivePass<T, 1>,
    pub(crate) load_workspace: LoadWorkspace<T>,
}

/// Working memory of an evaluation with loads: the states of all bodies and loads.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LoadWorkspace<T> {
    pub(crate) states: BodyStates<T>,
    pub(crate) loads: LoadState<T>,
    pub(crate) q_dot: Vec<T>,
    /// One load alone.
    pub(crate) single_load: LoadState<T>,
    pub(crate) friction_workspace: FrictionWorkspace<T>,
    /// By friction: the response to one unit of it.
    pub(crate) friction_responses: Vec<InverseDynamics<T>>,
    /// A motion at unit velocity of one coordinate, with its states: a virtual displacement.
    pub(crate) virtual_motion: Motion<T>,
    pub(crate) virtual_states: BodyStates<T>,
    pub(crate) unit_velocity: Vec<T>,
}

impl<T: Scalar> LoadWorkspace<T> {
    pub(crate) fn new(model: &Model) -> Self {
        let plan = &model.pass_model.plan;
        let rest = vec![T::from_f64(0.0); plan.actuators()];
        Self {
            states: BodyStates::new(plan),
            loads: model.loads.state(plan),
            single_load: model.loads.state(plan),
            friction_workspace: FrictionWorkspace::new(model.dependent_loads.len()),
            friction_responses: vec![model.result_buffer(); model.dependent_loads.len()],
            q_dot: rest.clone(),
            virtual_motion: plan.motion(),
            virtual_states: BodyStates::new(plan),
            unit_velocity: rest,
        }
    }
}

impl<T: Scalar> Workspace<T> {
    /// Updates the states of the bodies from the last pose and motion, with the accelerations of the last evaluation.
    pub fn update_body_accelerations(&mut self, model: &Model) {
        let Self {
            pose,
            motion,
            load_workspace: loaded,
            ..
        } = self;
        loaded.states.fill(&model.pass_model.plan, pose, motion);
    }

    /// Sets the magnitude of a load of [`Magnitude::External`](crate::Magnitude::External) until it is set again.
    pub fn set_magnitude(&mut self, load: usize, magnitude: T) {
        self.load_workspace.loads.magnitude[load] = magnitude;
    }

    /// The states of the bodies that were evaluated last.
    pub fn states(&self) -> &BodyStates<T> {
        &self.load_workspace.states
    }

    /// The loads at the state that was evaluated last.
    pub fn loads(&self) -> &LoadState<T> {
        &self.load_workspace.loads
    }
}

impl Model {
    /// Working memory for one thread.
    pub fn workspace<T: Scalar>(&self) -> Workspace<T> {
        Workspace {
            pose: self.plan().pose(),
            motion: self.plan().motion(),
            unit_passes: RecursivePass::new(&self.pass_model),
            pass: RecursivePass::new(&self.pass_model),
            load_workspace: LoadWorkspace::new(self),
        }
    }
}
