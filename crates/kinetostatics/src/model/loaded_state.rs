//! The loads, and inverse dynamics under them.

use super::{EvaluatedState, KinematicState, Workspace};
use crate::error::Result;
use crate::friction::{self, DependentLoad, FrictionState};
use crate::load::{AppliedWrench, ForceSource, Magnitude};
use crate::pass::{GivenMotion, InverseDynamics};
use dwell_geometry::Motion;
use dwell_geometry::body_states::BodyStates;
use dwell_numerics::Scalar;
use std::ops::{Deref, DerefMut};

/// A state whose loads are known: their magnitudes alone, or their wrenches, too.
#[derive(Debug)]
pub struct StateWithLoads<'a, T, const WRENCHES: bool>(pub(super) KinematicState<'a, T>);

/// The magnitudes of the loads are known; friction and separating forces are still zero, and so are external
/// magnitudes until they are set.
pub type LoadedState<'a, T = f64> = StateWithLoads<'a, T, false>;

/// The wrenches of the loads are known, and the accelerations of the mechanism where inverse dynamics led here.
pub type ForceState<'a, T = f64> = StateWithLoads<'a, T, true>;

impl<'a, T, const WRENCHES: bool> Deref for StateWithLoads<'a, T, WRENCHES> {
    type Target = KinematicState<'a, T>;

    #[inline]
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<T, const WRENCHES: bool> DerefMut for StateWithLoads<'_, T, WRENCHES> {
    #[inline]
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

impl<T> KinematicState<'_, T> {
    /// The loads that depend on reactions, and what is known of each.
    fn dependent_loads(&mut self) -> impl Iterator<Item = (&DependentLoad, &mut FrictionState<T>)> {
        let known = &mut self.workspace.friction_workspace.known;
        self.model.dependent_loads.iter().zip(known)
    }
}

impl<'a, T: Scalar> LoadedState<'a, T> {
    /// Sets the magnitude of a load of [`Magnitude::External`], in the unit of its kind; of a friction, the force that
    /// its surfaces have in a motion that was solved for.
    #[inline]
    pub fn set_magnitude(&mut self, load: usize, magnitude: T) {
        self.0.workspace.loads.magnitude[load] = magnitude;
        for (dependent, known) in self.0.dependent_loads() {
            if dependent.load == load {
                *known = FrictionState::Force(magnitude);
            }
        }
    }

    /// A magnitude of the signals of a load of [`Magnitude::External`], such as the voltage of a motor, at time `t` (s).
    ///
    /// # Errors
    /// [`KinetostaticsError::MagnitudeNotFinite`](crate::KinetostaticsError::MagnitudeNotFinite) where it has no finite value.
    #[inline]
    pub fn eval_magnitude(&mut self, load: usize, magnitude: &Magnitude, t: f64) -> Result<T> {
        let Workspace { states, loads, .. } = &mut *self.0.workspace;
        let workspace = &mut loads.signal_workspace;
        let compiled = &self.0.model.loads;
        compiled.eval_magnitude(load, magnitude, t, states, workspace)
    }

    /// The wrenches of the loads, without inverse dynamics.
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`](crate::KinetostaticsError::NoDirection) where the two points of a load coincide.
    pub fn wrenches(mut self) -> Result<ForceState<'a, T>> {
        self.0.update_wrenches()?;
        Ok(StateWithLoads(self.0))
    }

    /// The actuator forces and reactions of inertia and all loads with these accelerations (rad/s² or m/s²), without
    /// friction and separating forces.
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`](crate::KinetostaticsError::NoDirection) where the two points of a load coincide.
    #[inline]
    pub fn inverse_dynamics(
        mut self,
        q_ddot: &[T],
        result: &mut InverseDynamics<T>,
    ) -> Result<ForceState<'a, T>> {
        self.0.update_wrenches()?;
        let (model, workspace) = (&self.0.model.pass_model, &mut *self.0.workspace);
        let Workspace { pose, motion, .. } = workspace;
        model.plan.accelerations(pose, q_ddot, motion);
        let pass = &mut workspace.pass;
        pass.evaluate_loaded(model, pose, GivenMotion(motion), &mut workspace.loads);
        result.read_from(model, pose, pass);
        Ok(StateWithLoads(self.0))
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
    ) -> Result<EvaluatedState<'a, T>> {
        let mut state = self.inverse_dynamics(q_ddot, result)?;
        state.0.fill_accelerations();
        if !state.model.dependent_loads.is_empty() {
            let mut responses = std::mem::take(&mut state.0.workspace.friction_responses);
            let solved = state.solve_prescribed_friction(&mut responses, &result.reactions);
            state.0.workspace.friction_responses = responses;
            solved?;
            state = LoadedState::inverse_dynamics(StateWithLoads(state.0), q_ddot, result)?;
        }
        let state = state.0;
        Ok(EvaluatedState { state, result })
    }
}

impl<T: Scalar> ForceState<'_, T> {
    /// The magnitudes of the loads, in the units of their kinds.
    #[inline]
    pub fn magnitudes(&self) -> &[T] {
        &self.0.workspace.loads.magnitude
    }

    /// Sets magnitudes of loads of [`Magnitude::External`], and the wrenches anew.
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`](crate::KinetostaticsError::NoDirection) where the two points of a load coincide.
    #[inline]
    pub fn set_magnitudes(&mut self, magnitudes: impl Iterator<Item = (usize, T)>) -> Result<()> {
        let loads = &mut self.0.workspace.loads;
        for (load, magnitude) in magnitudes {
            loads.magnitude[load] = magnitude;
        }
        self.0.update_wrenches()
    }

    /// The power of a load, W.
    #[inline]
    pub fn load_power(&self, load: usize) -> T {
        let Workspace { states, loads, .. } = &*self.0.workspace;
        let mut sum = T::from_f64(0.0);
        let source = ForceSource::Load(load);
        for wrench in loads.wrenches.iter().filter(|w| w.source == source) {
            sum += wrench.power(states);
        }
        sum
    }

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
        self.0.fill_accelerations();
        &self.0.workspace.states
    }

    /// The states of the bodies with the motion that `set` stores, accelerations included.
    pub fn bodies_with(&mut self, set: impl FnOnce(&mut Motion<T>)) -> &BodyStates<T> {
        set(&mut self.0.workspace.motion);
        self.0.fill_bodies();
        &self.0.workspace.states
    }

    /// What is known of the loads that depend on reactions, in the order of [`Model::frictions`](crate::Model::frictions),
    /// until the next state of motion.
    pub fn set_friction_states(&mut self, states: impl Iterator<Item = FrictionState<T>>) {
        for ((_, known), state) in self.0.dependent_loads().zip(states) {
            *known = state;
        }
    }

    /// Solves for the [loads that depend on reactions](crate::Model::frictions): `frictionless` are the reactions
    /// without them, and `responses[j]` what a unit of load j adds to each (its
    /// [response](KinematicState::unit_load_response), with that of the free coordinates' accelerations). They
    /// become the magnitudes of their loads, and the loads' wrenches are updated.
    ///
    /// # Errors
    /// [`KinetostaticsError::SelfLocking`](crate::KinetostaticsError::SelfLocking) where there is no unique solution.
    pub fn solve_friction(
        &mut self,
        frictionless: &[T],
        responses: &[InverseDynamics<T>],
    ) -> Result<()> {
        let KinematicState { model, workspace } = &mut self.0;
        let dependent_loads = &model.dependent_loads;
        let solution = &mut workspace.friction_workspace;
        let states = &workspace.states;
        friction::solve(dependent_loads, states, frictionless, responses, solution)?;
        for (dependent, force) in dependent_loads.iter().zip(&solution.force) {
            workspace.loads.magnitude[dependent.load] = *force;
        }
        self.0.update_wrenches()
    }

    /// Solves for the frictions and separating forces of a prescribed motion, from the reactions without them.
    fn solve_prescribed_friction(
        &mut self,
        responses: &mut [InverseDynamics<T>],
        frictionless: &[T],
    ) -> Result<()> {
        for (load, response) in self.model.frictions().zip(&mut *responses) {
            self.unit_load_response(load, response)?;
        }
        self.solve_friction(frictionless, responses)
    }
}
