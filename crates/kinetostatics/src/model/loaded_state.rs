//! The loads, and inverse dynamics under them.

use super::{EvaluatedState, KinematicState, MachineModel, Model};
use crate::error::Result;
use crate::friction::FrictionState;
use crate::load::{AppliedWrench, Magnitude};
use crate::pass::InverseDynamics;
use dwell_geometry::Motion;
use dwell_geometry::body_states::BodyStates;
use dwell_numerics::Scalar;
use std::ops::{Deref, DerefMut};

/// A state whose loads are known: their magnitudes alone, or their wrenches, too.
#[derive(Debug)]
pub struct StateWithLoads<'a, T: Scalar, const WRENCHES: bool, M: MachineModel = Model>(
    pub(super) KinematicState<'a, T, M>,
);

/// The magnitudes of the loads are known; friction and separating forces are still zero, and so are external
/// magnitudes until they are set.
pub type LoadedState<'a, T = f64, M = Model> = StateWithLoads<'a, T, false, M>;

/// The wrenches of the loads are known, and the accelerations of the mechanism where inverse dynamics led here.
pub type ForceState<'a, T = f64, M = Model> = StateWithLoads<'a, T, true, M>;

impl<'a, T: Scalar, const WRENCHES: bool, M: MachineModel> Deref
    for StateWithLoads<'a, T, WRENCHES, M>
{
    type Target = KinematicState<'a, T, M>;

    #[inline]
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<T: Scalar, const WRENCHES: bool, M: MachineModel> DerefMut
    for StateWithLoads<'_, T, WRENCHES, M>
{
    #[inline]
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

impl<'a, T: Scalar, M: MachineModel> LoadedState<'a, T, M> {
    /// Sets the magnitude of a load of [`Magnitude::External`], in the unit of its kind; of a friction, the force that
    /// its surfaces have in a motion that was solved for.
    #[inline]
    pub fn set_magnitude(&mut self, load: usize, magnitude: T) {
        let KinematicState { model, workspace } = &mut self.0;
        M::magnitudes_mut(workspace)[load] = magnitude;
        let known = M::friction_states(workspace);
        for (dependent, known) in model.frictions().zip(known) {
            if dependent == load {
                *known = FrictionState::Force(magnitude);
            }
        }
    }

    /// A magnitude of the signals of a load of [`Magnitude::External`], such as the voltage of a motor, at time `t` (s).
    ///
    /// # Errors
    /// [`KinetostaticsError::MagnitudeNotFinite`](crate::KinetostaticsError::MagnitudeNotFinite) where it has no finite value.
    #[inline]
    pub fn eval_magnitude(
        &mut self,
        load: usize,
        magnitude: &Magnitude<M::Coordinate>,
        t: f64,
    ) -> Result<T> {
        let KinematicState { model, workspace } = &mut self.0;
        model.eval_magnitude(load, magnitude, t, workspace)
    }

    /// The wrenches of the loads, without inverse dynamics.
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`](crate::KinetostaticsError::NoDirection) where the two points of a load coincide.
    pub fn wrenches(self) -> Result<ForceState<'a, T, M>> {
        self.0.model.update_wrenches(self.0.workspace)?;
        Ok(StateWithLoads(self.0))
    }

    /// The actuator forces and reactions of inertia and all loads with these accelerations (rad/s² or m/s²), without
    /// friction and separating forces.
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`](crate::KinetostaticsError::NoDirection) where the two points of a load coincide.
    #[inline]
    pub fn inverse_dynamics(
        self,
        q_ddot: &[T],
        result: &mut InverseDynamics<T>,
    ) -> Result<ForceState<'a, T, M>> {
        let KinematicState { model, workspace } = self.0;
        model.update_wrenches(workspace)?;
        model.set_accelerations(q_ddot, workspace);
        model.loaded_balance(workspace, result);
        Ok(StateWithLoads(KinematicState { model, workspace }))
    }

    /// The actuator forces and reactions of inertia and all loads with these accelerations (rad/s² or m/s²), with
    /// friction and separating forces: Jᵀ[λ; τ] = M ẍ + h − f.
    ///
    /// # Errors
    /// [`KinetostaticsError`](crate::KinetostaticsError) where a load has no direction, or friction jams the mechanism.
    pub fn evaluate(
        self,
        q_ddot: &[T],
        result: &'a mut InverseDynamics<T>,
    ) -> Result<EvaluatedState<'a, T, M>> {
        let state = self.inverse_dynamics(q_ddot, result)?.0;
        let KinematicState { model, workspace } = state;
        model.update_bodies(workspace);
        model.solve_prescribed_friction(workspace, result)?;
        let state = KinematicState { model, workspace };
        Ok(EvaluatedState { state, result })
    }
}

impl<T: Scalar, M: MachineModel> ForceState<'_, T, M> {
    /// The magnitudes of the loads, in the units of their kinds.
    #[inline]
    pub fn magnitudes(&self) -> &[T] {
        M::magnitudes(self.0.workspace)
    }

    /// Sets magnitudes of loads of [`Magnitude::External`], and updates the wrenches.
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`](crate::KinetostaticsError::NoDirection) where the two points of a load coincide.
    #[inline]
    pub fn set_magnitudes(&mut self, magnitudes: impl Iterator<Item = (usize, T)>) -> Result<()> {
        let KinematicState { model, workspace } = &mut self.0;
        let of_loads = M::magnitudes_mut(workspace);
        for (load, magnitude) in magnitudes {
            of_loads[load] = magnitude;
        }
        model.update_wrenches(workspace)
    }

    /// The power of a load, W.
    #[inline]
    pub fn load_power(&self, load: usize) -> T {
        self.0.model.load_power(load, self.0.workspace)
    }

    /// Sets the accelerations of the bodies to those of the inverse dynamics.
    #[inline]
    pub fn update_bodies(&mut self) {
        self.0.model.update_bodies(self.0.workspace);
    }

    /// Sets the states of the loads that depend on reactions, in the order of [`MachineModel::frictions`], until the
    /// next state of motion.
    pub fn set_friction_states(&mut self, states: impl Iterator<Item = FrictionState<T>>) {
        for (known, state) in M::friction_states(self.0.workspace).iter_mut().zip(states) {
            *known = state;
        }
    }

    /// Solves for the [loads that depend on reactions](MachineModel::frictions): `frictionless` are the reactions
    /// without them, and `responses[j]` the contribution of a unit of load j to each (its
    /// [response](KinematicState::unit_load_response), including the accelerations of the free coordinates). The
    /// solution sets the magnitudes of these loads and updates their wrenches.
    ///
    /// # Errors
    /// [`KinetostaticsError::SelfLocking`](crate::KinetostaticsError::SelfLocking) where there is no unique solution.
    pub fn solve_friction(
        &mut self,
        frictionless: &[T],
        responses: &[InverseDynamics<T>],
    ) -> Result<()> {
        let KinematicState { model, workspace } = &mut self.0;
        model.solve_friction(frictionless, responses, workspace)
    }
}

impl<T: Scalar> ForceState<'_, T> {
    /// The wrenches of the loads on the bodies.
    pub fn wrenches(&self) -> &[AppliedWrench<T>] {
        &self.0.workspace.loads.wrenches
    }

    /// The motion of frames and slides.
    pub fn motion(&self) -> &Motion<T> {
        &self.0.workspace.motion
    }

    /// The states of the bodies with the accelerations of the inverse dynamics.
    pub fn bodies(&mut self) -> &BodyStates<T> {
        self.update_bodies();
        &self.0.workspace.states
    }

    /// The states of the bodies with the accelerations that were last computed.
    pub fn bodies_as_they_are(&self) -> &BodyStates<T> {
        &self.0.workspace.states
    }

    /// The states of the bodies with the motion that `set` stores, accelerations included.
    pub fn bodies_with(&mut self, set: impl FnOnce(&mut Motion<T>)) -> &BodyStates<T> {
        set(&mut self.0.workspace.motion);
        self.0.fill_bodies();
        &self.0.workspace.states
    }
}
