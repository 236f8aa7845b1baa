//! A model in the plane as a machine takes it.

use super::machine_model::MachineModel;
use super::{Model, Workspace};
use crate::drive::Drive;
use crate::error::{LoadError, PositionResult, Result};
use crate::friction::{self, DependentLoad, FrictionState};
use crate::load::{AppliedWrench, ForceSource, Friction, Load, LoadKind, Magnitude, Signal};
use crate::pass::{AtRest, GivenMotion, InverseDynamics, UnitAcceleration};
use dwell_geometry::Coordinate;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_laws::HeldPieces;
use dwell_numerics::Scalar;

impl MachineModel for Model {
    type Coordinate = Coordinate;
    type CoordinateFunction = CoordinateFunction;
    type LoadKind = LoadKind;

    fn is_angle(&self, actuator: usize) -> bool {
        self.plan().is_angle(actuator)
    }

    fn size(&self) -> f64 {
        self.mechanism().size()
    }

    fn total_mass(&self) -> f64 {
        self.masses().iter().map(|m| m.mass).sum()
    }

    fn without_reactions(&self) -> Self {
        self.without_reactions()
    }

    fn coordinate_function(
        &self,
        coordinate: Coordinate,
    ) -> Result<CoordinateFunction, &'static str> {
        let found = CoordinateFunction::find(self.mechanism(), coordinate);
        found.ok_or("the mechanism does not have its coordinate")
    }

    fn with_loads(self, loads: Vec<Load>) -> Result<Self, LoadError> {
        self.with_loads(loads)
    }

    fn drive_load(&self, drive: &Drive) -> Result<Load, &'static str> {
        drive.load(self.mechanism())
    }

    fn loads(&self) -> &[Load] {
        self.loads()
    }

    fn compiled_signals(&self, load: usize) -> &[Signal<CoordinateFunction>] {
        let signals = self.loads.compiled_signals.get(load);
        signals.map_or(&[], Vec::as_slice)
    }

    fn frictions(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.dependent_loads.iter().map(|dependent| dependent.load)
    }

    fn sticking_friction(&self, index: usize) -> Option<(Friction, CoordinateFunction)> {
        self.dependent_loads.get(index)?.sticking()
    }

    #[inline]
    fn update_kinematics<T: Scalar>(
        &self,
        q: &[T],
        q_dot: &[T],
        workspace: &mut Workspace<T>,
    ) -> PositionResult {
        let plan = self.plan();
        plan.positions(q, &mut workspace.pose)?;
        plan.velocities(&workspace.pose, q_dot, &mut workspace.motion);
        let states = &mut workspace.states;
        states.fill_velocities(plan, &workspace.pose, &workspace.motion);
        workspace.q_dot.copy_from_slice(q_dot);
        Ok(())
    }

    #[inline]
    fn coordinate_motion<T: Scalar>(
        &self,
        of: CoordinateFunction,
        workspace: &Workspace<T>,
    ) -> [T; 3] {
        workspace.states.coordinate(of)
    }

    fn counts_revolutions<T: Scalar>(
        &self,
        of: CoordinateFunction,
        workspace: &Workspace<T>,
    ) -> Option<bool> {
        let counted = |body| workspace.states.body(body).angle.is_some();
        match of {
            CoordinateFunction::Angle(bodies) => Some(bodies.into_iter().all(counted)),
            CoordinateFunction::Travel { .. } | CoordinateFunction::Length { .. } => None,
        }
    }

    #[inline]
    fn set_accelerations<T: Scalar>(&self, q_ddot: &[T], workspace: &mut Workspace<T>) {
        let Workspace { pose, motion, .. } = workspace;
        self.plan().accelerations(pose, q_ddot, motion);
    }

    #[inline]
    fn update_bodies<T: Scalar>(&self, workspace: &mut Workspace<T>) {
        let Workspace {
            pose,
            motion,
            states,
            ..
        } = workspace;
        states.fill_accelerations(self.plan(), pose, motion);
    }

    #[inline]
    fn update_magnitudes<T: Scalar>(&self, t: f64, workspace: &mut Workspace<T>) -> Result<()> {
        workspace
            .friction_workspace
            .known
            .fill(FrictionState::BySpeed);
        let Workspace { states, loads, .. } = workspace;
        self.loads.update_magnitudes(t, states, loads)
    }

    #[inline]
    fn magnitudes<T: Scalar>(workspace: &Workspace<T>) -> &[T] {
        &workspace.loads.magnitude
    }

    #[inline]
    fn magnitudes_mut<T: Scalar>(workspace: &mut Workspace<T>) -> &mut [T] {
        &mut workspace.loads.magnitude
    }

    #[inline]
    fn eval_magnitude<T: Scalar>(
        &self,
        load: usize,
        magnitude: &Magnitude,
        t: f64,
        workspace: &mut Workspace<T>,
    ) -> Result<T> {
        let Workspace { states, loads, .. } = workspace;
        let signals = &mut loads.signal_workspace;
        self.loads
            .eval_magnitude(load, magnitude, t, states, signals)
    }

    fn held_pieces<T: Scalar>(workspace: &mut Workspace<T>, load: usize) -> &mut HeldPieces {
        workspace.loads.signal_workspace.held_pieces(load)
    }

    #[inline]
    fn update_wrenches<T: Scalar>(&self, workspace: &mut Workspace<T>) -> Result<()> {
        let Workspace { states, loads, .. } = workspace;
        self.loads.update_wrenches(states, loads)
    }

    #[inline]
    fn loaded_balance<T: Scalar>(
        &self,
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) {
        let model = &self.pass_model;
        let Workspace {
            pose,
            motion,
            pass,
            loads,
            ..
        } = workspace;
        pass.evaluate_loaded(model, pose, GivenMotion(motion), loads);
        result.read_from(model, pose, pass);
    }

    #[inline]
    fn mass_matrix_column<T: Scalar>(
        &self,
        i: usize,
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) {
        let model = &self.pass_model;
        workspace.set_unit_velocities(&model.plan, &[i]);
        let Workspace { pose, pass, .. } = workspace;
        let unit = UnitAcceleration(&workspace.virtual_motion);
        pass.evaluate(model, pose, unit, None);
        result.read_from(model, pose, pass);
    }

    fn column_turns(&self, workspace: &Workspace<f64>) -> Vec<[f64; 2]> {
        workspace.virtual_motion.turns(&workspace.pose)
    }

    #[inline]
    fn load_response<T: Scalar>(
        &self,
        load: usize,
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> Result<()> {
        let model = &self.pass_model;
        let (loads, single) = (&self.loads, &mut workspace.single_load);
        loads.unit_wrenches(load, &workspace.states, single)?;
        let Workspace { pose, pass, .. } = workspace;
        pass.evaluate_loaded(model, pose, AtRest, single);
        result.read_from(model, pose, pass);
        Ok(())
    }

    #[inline]
    fn load_power<T: Scalar>(&self, load: usize, workspace: &Workspace<T>) -> T {
        let Workspace { states, loads, .. } = workspace;
        // They are in the order of the loads.
        let load_of = |wrench: &AppliedWrench<T>| match wrench.source {
            ForceSource::Load(of) => of,
            ForceSource::Joint(_) | ForceSource::Actuator(_) => usize::MAX,
        };
        let first = loads.wrenches.partition_point(|w| load_of(w) < load);
        let own = loads.wrenches[first..].iter();
        let own = own.take_while(|wrench| load_of(wrench) == load);
        own.fold(T::from_f64(0.0), |sum, wrench| sum + wrench.power(states))
    }

    fn kinetic_energy(&self, workspace: &Workspace<f64>) -> f64 {
        let terms = self.inertia_terms(&workspace.states);
        terms
            .map(|[of_mass, of_inertia, ..]| 0.5 * (of_mass + of_inertia))
            .sum()
    }

    fn potential_energy(&self, load: usize, workspace: &Workspace<f64>) -> Option<f64> {
        self.loads.potential_energy(load, &workspace.states)
    }

    fn contact_force<T: Scalar>(&self, index: usize, reactions: &[T]) -> T {
        self.dependent_loads[index].contact_force(reactions)
    }

    fn friction_states<T: Scalar>(workspace: &mut Workspace<T>) -> &mut [FrictionState<T>] {
        &mut workspace.friction_workspace.known
    }

    fn friction_responses<T: Scalar>(workspace: &mut Workspace<T>) -> &mut Vec<InverseDynamics<T>> {
        &mut workspace.friction_responses
    }

    fn solve_friction<T: Scalar>(
        &self,
        frictionless: &[T],
        responses: &[InverseDynamics<T>],
        workspace: &mut Workspace<T>,
    ) -> Result<()> {
        let dependent_loads = &self.dependent_loads;
        let solution = &mut workspace.friction_workspace;
        let states = &workspace.states;
        let by_speed = |dependent: &DependentLoad| dependent.factor(states);
        friction::solve(dependent_loads, by_speed, frictionless, responses, solution)?;
        for (dependent, force) in dependent_loads.iter().zip(&solution.force) {
            workspace.loads.magnitude[dependent.load] = *force;
        }
        self.update_wrenches(workspace)
    }
}
