//! Everything at one state.

use super::{KinematicState, MachineModel, Model, Workspace};
use crate::error::Result;
use crate::load::{ForceSource, LoadState};

use crate::pass::InverseDynamics;
use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{Motion, Pose};
use dwell_numerics::Scalar;
use std::ops::Deref;

/// Everything is known: the accelerations of the bodies, all loads with friction, actuator forces and reactions.
#[derive(Debug)]
pub struct EvaluatedState<'a, T: Scalar = f64, M: MachineModel = Model> {
    pub(crate) state: KinematicState<'a, T, M>,
    pub(crate) result: &'a InverseDynamics<T>,
}

/// To read only: other accelerations would not fit the forces.
impl<'a, T: Scalar, M: MachineModel> Deref for EvaluatedState<'a, T, M> {
    type Target = KinematicState<'a, T, M>;

    fn deref(&self) -> &Self::Target {
        &self.state
    }
}

impl Model {
    /// A state whose pose and motion (with accelerations) `set` stores, and whose magnitudes of loads, actuator forces
    /// and reactions are given.
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`](crate::KinetostaticsError::NoDirection) where the two points of a load coincide.
    pub fn given_state<'a, T: Scalar>(
        &'a self,
        q_dot: &[T],
        magnitudes: &[T],
        workspace: &'a mut Workspace<T>,
        result: &'a InverseDynamics<T>,
        set: impl FnOnce(&mut Pose<T>, &mut Motion<T>),
    ) -> Result<EvaluatedState<'a, T>> {
        let state = self.given_kinematic_state(q_dot, workspace, set);
        let loads = &mut state.workspace.loads;
        loads.magnitude.copy_from_slice(magnitudes);
        self.update_wrenches(state.workspace)?;
        Ok(EvaluatedState { state, result })
    }
}

impl<'a, T: Scalar, M: MachineModel> EvaluatedState<'a, T, M> {
    /// The positions and velocities alone, for further evaluations there.
    pub fn into_kinematic_state(self) -> KinematicState<'a, T, M> {
        self.state
    }

    /// The model.
    pub fn model(&self) -> &M {
        self.model
    }

    /// The power of a load, W.
    pub fn load_power(&self, load: usize) -> T {
        self.state.model.load_power(load, self.state.workspace)
    }

    /// The magnitudes of the loads, in the units of their kinds.
    pub fn magnitudes(&self) -> &[T] {
        M::magnitudes(self.state.workspace)
    }

    /// The actuator forces and reactions.
    pub fn inverse_dynamics(&self) -> &'a InverseDynamics<T> {
        self.result
    }
}

impl<T: Scalar> EvaluatedState<'_, T> {
    /// The states of the bodies.
    pub fn bodies(&self) -> &BodyStates<T> {
        &self.workspace.states
    }

    /// The loads: their magnitudes and wrenches.
    pub fn loads(&self) -> &LoadState<T> {
        &self.workspace.loads
    }
}

impl EvaluatedState<'_> {
    /// Each load's generalised force by virtual work: `forces[load × actuators + i]` is the
    /// sum of F·∂v/∂q̇ᵢ + M ∂ω/∂q̇ᵢ over its wrenches, N·m (or N if the coordinate is a length).
    pub fn generalised_forces(&mut self, forces: &mut [f64]) {
        let workspace = &mut *self.state.workspace;
        let plan = self.state.model.plan();
        forces.fill(0.0);
        let n = plan.actuators();
        for i in 0..n {
            workspace.set_unit_velocities(plan, &[i]);
            let states = &mut workspace.virtual_states;
            states.fill(plan, &workspace.pose, &workspace.virtual_motion);
            for wrench in &workspace.loads.wrenches {
                if let ForceSource::Load(load) = wrench.source {
                    forces[load * n + i] += wrench.power(states);
                }
            }
        }
    }
}
