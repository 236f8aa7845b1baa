//! Working memory of a model.

use super::Model;
use crate::friction::FrictionWorkspace;
use crate::load::LoadState;
use crate::pass::{InverseDynamics, RecursivePass};
use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{Motion, Plan, Pose};
use dwell_numerics::Scalar;

/// Working memory for evaluations of a model in one thread. Its contents are read through the [stages](super::stages)
/// of an evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Workspace<T> {
    pub(crate) pose: Pose<T>,
    pub(crate) motion: Motion<T>,
    pub(crate) unit_passes: RecursivePass<T, 2>,
    pub(crate) pass: RecursivePass<T, 1>,
    /// For an evaluation with loads: the states of all bodies and loads.
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

impl Model {
    /// Working memory for one thread.
    pub fn workspace<T: Scalar>(&self) -> Workspace<T> {
        let plan = self.plan();
        let rest = vec![T::from_f64(0.0); plan.actuators()];
        let dependent_loads = self.dependent_loads.len();
        Workspace {
            pose: plan.pose(),
            motion: plan.motion(),
            unit_passes: RecursivePass::new(&self.pass_model),
            pass: RecursivePass::new(&self.pass_model),
            states: BodyStates::new(plan),
            loads: self.loads.state(plan),
            single_load: self.loads.state(plan),
            friction_workspace: FrictionWorkspace::new(dependent_loads),
            friction_responses: vec![self.result_buffer(); dependent_loads],
            q_dot: rest.clone(),
            virtual_motion: plan.motion(),
            virtual_states: BodyStates::new(plan),
            unit_velocity: rest,
        }
    }
}

impl<T: Scalar> Workspace<T> {
    /// The virtual motion at the pose, at unit velocity of these coordinates.
    #[inline]
    pub(super) fn set_unit_velocities(&mut self, plan: &Plan, coordinates: &[usize]) {
        self.unit_velocity.fill(T::from_f64(0.0));
        for &i in coordinates {
            self.unit_velocity[i] = T::from_f64(1.0);
        }
        plan.velocities(&self.pose, &self.unit_velocity, &mut self.virtual_motion);
    }
}
