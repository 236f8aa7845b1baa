//! Inverse dynamics with loads: Jᵀ[λ; τ] = M ẍ + h − f, for a prescribed motion at a given time.

use super::workspace::LoadWorkspace;
use super::{Model, Workspace};
use crate::error::{KinetostaticsError, LoadError};
use crate::friction;
use crate::load::{CompiledLoads, CompiledSignal, ForceSource, Load, Magnitude};
use crate::pass::InverseDynamics;
use dwell_numerics::Scalar;

impl Model {
    /// The same model under these loads, in place of any it had. They act in [`Model::kinetostatics`] and
    /// [`Model::statics`] alone: the reduced inertia does not depend on them. The reactions on which their friction
    /// depends are added to [`Model::reactions`].
    ///
    /// Where they depend on an angle (a torsional spring, a signal of a magnitude), its whole revolutions are counted
    /// from the initial guess of the assembly, or else from within half a revolution of the other body. Groups
    /// that [`Model::pruned_for`] left out may come back for that.
    ///
    /// # Errors
    /// [`LoadError`] when a load does not fit the mechanism, or depends on an angle whose revolutions cannot be
    /// counted over the range.
    pub fn with_loads(mut self, loads: Vec<Load>) -> Result<Self, LoadError> {
        let plan = &self.pass_model.plan;
        self.loads = CompiledLoads::compile(&self.mechanism, plan, &self.masses, loads)?;
        self.require_determinate_teeth()?;
        self.count_load_angles()?;
        let requested = self.reactions[..self.requested].to_vec();
        self.compile_reactions(&requested);
        Ok(self)
    }

    /// Refuses a separating force whose tooth force is statically indeterminate: it has no value.
    fn require_determinate_teeth(&self) -> Result<(), LoadError> {
        let reactions = self.mechanism.reactions();
        let is_indeterminate = |load: &Load| {
            let tooth_force = load.pressure_angle().map(|teeth| teeth.tooth_force());
            let mut found = (0..reactions.len()).filter(|&k| Some(reactions[k]) == tooth_force);
            found.any(|k| !self.pass_model.plan.is_determinate(k))
        };
        match self.loads().iter().position(is_indeterminate) {
            Some(load) => Err(LoadError {
                load,
                what: "its tooth force is statically indeterminate (redundant constraints share the load), so its separating force has no value",
            }),
            None => Ok(()),
        }
    }

    /// The compiled signals of a load's magnitude, in the order of its [signals](Magnitude::signals).
    pub fn compiled_signals(&self, load: usize) -> &[CompiledSignal] {
        self.loads
            .compiled_signals
            .get(load)
            .map_or(&[], Vec::as_slice)
    }

    /// A magnitude of the signals of a load of [`Magnitude::External`], such as the voltage of a motor, at time `t` (s)
    /// and the state set.
    ///
    /// # Errors
    /// [`KinetostaticsError::MagnitudeNotFinite`] where it has no finite value.
    pub fn eval_magnitude<T: Scalar>(
        &self,
        load: usize,
        magnitude: &Magnitude,
        t: f64,
        workspace: &mut Workspace<T>,
    ) -> Result<T, KinetostaticsError> {
        let LoadWorkspace { states, loads, .. } = &mut workspace.load_workspace;
        let value = magnitude.eval_at_state(
            t,
            &self.loads.compiled_signals[load],
            states,
            &mut loads.signal_workspace,
        );
        if value.value().is_finite() {
            Ok(value)
        } else {
            Err(KinetostaticsError::MagnitudeNotFinite { load })
        }
    }

    /// The loads, in their order.
    pub fn loads(&self) -> &[Load] {
        &self.loads.loads
    }

    /// Kinetostatics under the loads: the actuators' actions and the reactions at time `t` (s) for
    /// prescribed coordinates `q`, velocities and accelerations (rad or m, per s, per s²):
    /// Jᵀ[λ; τ] = M ẍ + h − f. The workspace then holds the states of the bodies and of the loads.
    ///
    /// # Errors
    /// [`KinetostaticsError`] when there is no pose at `q`, or a load has no direction or no finite
    /// magnitude there, or friction jams the mechanism.
    pub fn kinetostatics<T: Scalar>(
        &self,
        t: f64,
        q: &[T],
        q_dot: &[T],
        q_ddot: &[T],
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> Result<(), KinetostaticsError> {
        self.set_state(t, q, q_dot, workspace)?;
        self.loaded_inverse_dynamics(q_ddot, workspace, result)?;
        workspace.update_body_accelerations(self);
        if self.dependent_loads.is_empty() {
            return Ok(());
        }
        let mut responses = std::mem::take(&mut workspace.load_workspace.friction_responses);
        let solved = self.solve_prescribed_friction(&mut responses, &result.reactions, workspace);
        workspace.load_workspace.friction_responses = responses;
        solved?;
        self.loaded_inverse_dynamics(q_ddot, workspace, result)
    }

    /// Solves for the frictions and separating forces of a prescribed motion, from the reactions without them.
    fn solve_prescribed_friction<T: Scalar>(
        &self,
        responses: &mut [InverseDynamics<T>],
        frictionless: &[T],
        workspace: &mut Workspace<T>,
    ) -> Result<(), KinetostaticsError> {
        for (response, dependent) in responses.iter_mut().zip(&self.dependent_loads) {
            self.unit_load_response(dependent.load, workspace, response)?;
        }
        self.solve_friction(frictionless, responses, workspace)
    }

    /// The loads that depend on reactions (frictions, and separating forces where a reaction is computed), by their
    /// indices in [`Model::loads`].
    pub fn frictions(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.dependent_loads.iter().map(|dependent| dependent.load)
    }

    /// Solves for the [loads that depend on reactions](Model::frictions) at the state set last: `frictionless` are the
    /// reactions without them, and `responses[j]` what a unit of load j adds to each (its [response](Model::unit_load_response), with that of
    /// the free coordinates' accelerations). They become the magnitudes of their loads, and the loads'
    /// wrenches are updated.
    ///
    /// # Errors
    /// [`KinetostaticsError::SelfLocking`] where there is no unique solution.
    pub fn solve_friction<T: Scalar>(
        &self,
        frictionless: &[T],
        responses: &[InverseDynamics<T>],
        workspace: &mut Workspace<T>,
    ) -> Result<(), KinetostaticsError> {
        let LoadWorkspace {
            states,
            loads,
            friction_workspace,
            ..
        } = &mut workspace.load_workspace;
        friction::solve(
            &self.dependent_loads,
            states,
            frictionless,
            responses,
            friction_workspace,
        )?;
        for (dependent, force) in self.dependent_loads.iter().zip(&friction_workspace.force) {
            loads.magnitude[dependent.load] = *force;
        }
        self.loads.update_wrenches(states, loads)
    }

    /// Statics under the loads: [`Model::kinetostatics`] at rest.
    ///
    /// # Errors
    /// As [`Model::kinetostatics`].
    pub fn statics(
        &self,
        t: f64,
        q: &[f64],
        workspace: &mut Workspace<f64>,
        result: &mut InverseDynamics<f64>,
    ) -> Result<(), KinetostaticsError> {
        let mut rest = std::mem::take(&mut workspace.load_workspace.unit_velocity);
        rest.fill(0.0);
        let done = self.kinetostatics(t, q, &rest, &rest, workspace, result);
        workspace.load_workspace.unit_velocity = rest;
        done
    }

    /// Each load's generalised force by virtual work, at the state last evaluated: `forces[load × actuators + i]` is the
    /// sum of F·∂v/∂q̇ᵢ + M ∂ω/∂q̇ᵢ over its wrenches, N·m (or N if the coordinate is a length).
    pub fn generalised_forces(&self, workspace: &mut Workspace<f64>, forces: &mut [f64]) {
        let Workspace {
            pose,
            load_workspace: loaded,
            ..
        } = workspace;
        let LoadWorkspace {
            loads,
            virtual_motion,
            virtual_states,
            unit_velocity,
            ..
        } = loaded;
        forces.fill(0.0);
        let n = self.pass_model.plan.actuators();
        for i in 0..n {
            unit_velocity.fill(0.0);
            unit_velocity[i] = 1.0;
            self.pass_model
                .plan
                .velocities(pose, unit_velocity, virtual_motion);
            virtual_states.fill(&self.pass_model.plan, pose, virtual_motion);
            for wrench in &loads.wrenches {
                if let ForceSource::Load(load) = wrench.source {
                    forces[load * n + i] += wrench.power(virtual_states);
                }
            }
        }
    }

    /// Whether a load has a potential energy.
    pub fn is_conservative(&self, load: usize) -> bool {
        self.loads
            .loads
            .get(load)
            .is_some_and(Load::is_conservative)
    }

    /// The potential energy of a load at the state last evaluated, J; none if it is not
    /// [conservative](Load::is_conservative). That of gravity and of forces is zero at the ground's origin.
    pub fn potential_energy(&self, load: usize, workspace: &Workspace<f64>) -> Option<f64> {
        self.loads.potential_energy(load, workspace.states())
    }
}
