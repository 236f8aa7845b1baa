//! Inverse dynamics with loads: Jᵀ[λ; τ] = M ẍ + h − f, for a prescribed motion at a given time.

use super::stages::EvaluatedState;
use super::{Model, Workspace};
use crate::error::{LoadError, Result};
use crate::load::{CompiledLoads, Load};
use crate::pass::InverseDynamics;
use dwell_numerics::Scalar;

impl Model {
    /// This model under these loads, which replace its own. They act in [`Model::kinetostatics`] and [`Model::statics`]
    /// alone: the reduced inertia does not depend on them. The reactions on which their friction depends are added to
    /// [`Model::reactions`].
    ///
    /// If they depend on an angle (a torsional spring, a signal of a magnitude), its whole revolutions are counted from
    /// the initial guess of the assembly. Without a guess the angle starts within half a revolution of the other body.
    /// Groups that [`Model::pruned_for`] left out may be restored for this.
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
            let is_tooth_force = |k: usize| Some(reactions[k]) == tooth_force;
            (0..reactions.len()).any(|k| is_tooth_force(k) && !self.plan().is_determinate(k))
        };
        let what = "its tooth force is statically indeterminate (redundant constraints share the load), so its separating force has no value";
        let found = self.loads().iter().position(is_indeterminate);
        found.map_or(Ok(()), |load| Err(LoadError { load, what }))
    }

    /// The loads, in their order.
    pub fn loads(&self) -> &[Load] {
        &self.loads.loads
    }

    /// Kinetostatics under the loads: the actuators' actions and the reactions at time `t` (s) for
    /// prescribed coordinates `q`, velocities and accelerations (rad or m, per s, per s²):
    /// Jᵀ[λ; τ] = M ẍ + h − f. All [stages](super::stages) at once.
    ///
    /// # Errors
    /// [`KinetostaticsError`](crate::KinetostaticsError) when there is no pose at `q`, or a load has no direction or no finite
    /// magnitude there, or friction jams the mechanism.
    pub fn kinetostatics<'a, T: Scalar>(
        &'a self,
        t: f64,
        q: &[T],
        q_dot: &[T],
        q_ddot: &[T],
        workspace: &'a mut Workspace<T>,
        result: &'a mut InverseDynamics<T>,
    ) -> Result<EvaluatedState<'a, T>> {
        let state = self.kinematic_state(q, q_dot, workspace)?;
        state.apply_loads(t)?.evaluate(q_ddot, result)
    }

    /// Statics under the loads: [`Model::kinetostatics`] at rest.
    ///
    /// # Errors
    /// As [`Model::kinetostatics`].
    pub fn statics<'a>(
        &'a self,
        t: f64,
        q: &[f64],
        workspace: &'a mut Workspace<f64>,
        result: &'a mut InverseDynamics<f64>,
    ) -> Result<EvaluatedState<'a>> {
        self.kinetostatics(t, q, &self.rest, &self.rest, workspace, result)
    }
}
