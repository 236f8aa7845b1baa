//! The implementation of the trait `MachineModel` for models in space.
//!
//! ```text
//! M(q) q̈ = Q − c(q, q̇)                                                                              (1)
//! ```
//!
//! Column i of M has the actuator forces at unit acceleration of coordinate i from rest; c − Q has those without
//! acceleration, under all loads. All passes share the pose and its factors.

use super::action::{BodyAction, CompiledKind};
use super::compiled_loads::CompiledLoads;
use super::friction::JointFriction;
use super::load::{Load, LoadKind};
use super::model::{Model, Workspace};
use crate::drive::Drive;
use crate::error::{KinetostaticsError, LoadError, PositionResult, Result};
use crate::friction::{self, FrictionState};
use crate::load::{Friction, Magnitude, Signal, Strength};
use crate::model::{EvaluatedState, KinematicState, MachineModel};
use crate::pass::InverseDynamics;
use dwell_geometry::PositionError;
use dwell_geometry::space::{Coordinate, CoordinateFunction, Wrench};
use dwell_laws::HeldPieces;
use dwell_numerics::Scalar;

impl Model {
    /// Positions and velocities at coordinates `q` (rad or m) and their velocities: the first of the
    /// [stages](crate::model::stages).
    ///
    /// # Errors
    /// [`PositionError`] when there is no pose at `q`.
    #[inline]
    pub fn kinematic_state<'a, T: Scalar>(
        &'a self,
        q: &[T],
        q_dot: &[T],
        workspace: &'a mut Workspace<T>,
    ) -> Result<KinematicState<'a, T, Self>, PositionError> {
        KinematicState::new(self, [q, q_dot], workspace)
    }

    /// Kinetostatics under the loads at time `t` (s) for prescribed coordinates, velocities and accelerations (rad or m, per s,
    /// per s²).
    ///
    /// # Errors
    /// [`KinetostaticsError`] when there is no pose at `q`, or a load has no direction or no finite magnitude there.
    pub fn kinetostatics<'a, T: Scalar>(
        &'a self,
        t: f64,
        [q, q_dot, q_ddot]: [&[T]; 3],
        workspace: &'a mut Workspace<T>,
        result: &'a mut InverseDynamics<T>,
    ) -> Result<EvaluatedState<'a, T, Self>> {
        let state = self.kinematic_state(q, q_dot, workspace)?;
        state.apply_loads(t)?.evaluate(q_ddot, result)
    }

    /// The wrench of a load on each body, about the origin of its evaluation frame, goes to `add`.
    fn act<T: Scalar>(
        &self,
        load: usize,
        magnitude: T,
        workspace: &Workspace<T>,
        mut add: impl FnMut(usize, Wrench<T>),
    ) -> Result<()> {
        let Some(kind) = self.loads.kinds.get(load) else {
            return Ok(());
        };
        let (plan, pose) = (self.plan(), &workspace.pose);
        let mut act = |kind: &CompiledKind, magnitude: T| {
            let add_one = |(body, [arm, force, couple]): BodyAction<T>| {
                let mut wrench = Wrench::default();
                wrench.add_at(arm, force, couple);
                add(body, wrench);
            };
            kind.act(magnitude, plan, pose, self.inner_masses(), add_one)
        };
        let acted = match self.surface_friction(load, &workspace.surface_directions) {
            None => act(kind, magnitude),
            Some((surface, direction)) => {
                let mut parts = surface.parts(direction).into_iter();
                parts.try_for_each(|(kind, part)| act(kind, magnitude * part))
            }
        };
        acted.ok_or(KinetostaticsError::NoDirection { load })
    }
}

impl MachineModel for Model {
    type Coordinate = Coordinate;
    type CoordinateFunction = CoordinateFunction;
    type LoadKind = LoadKind;

    fn is_angle(&self, actuator: usize) -> bool {
        self.plan().is_angle(actuator)
    }

    fn size(&self) -> f64 {
        self.plan().size()
    }

    fn total_mass(&self) -> f64 {
        self.inner_masses().iter().map(|m| m.mass).sum()
    }

    fn without_reactions(&self) -> Self {
        self.without_reactions()
    }

    fn coordinate_function(
        &self,
        coordinate: Coordinate,
    ) -> Result<CoordinateFunction, &'static str> {
        self.plan()
            .coordinate_function(self.mechanism(), coordinate)
    }

    fn with_loads(mut self, loads: Vec<Load>) -> Result<Self, LoadError> {
        self.loads = CompiledLoads::compile(self.mechanism(), self.plan(), loads)?;
        self.require_no_idle_moment()?;
        self.compile_surface_frictions()?;
        self.compile_frictions()?;
        Ok(self)
    }

    fn drive_load(&self, drive: &Drive<Coordinate>) -> Result<Load, &'static str> {
        self.coordinate_function(drive.coordinate)?;
        Ok(Load {
            name: drive.name.clone(),
            kind: LoadKind::Along(drive.coordinate, Strength::Direct),
            magnitude: Magnitude::External(drive.kind.input().signals().to_vec()),
        })
    }

    fn loads(&self) -> &[Load] {
        &self.loads.loads
    }

    fn compiled_signals(&self, load: usize) -> &[Signal<CoordinateFunction>] {
        let signals = self.loads.signals.get(load);
        signals.map_or(&[], Vec::as_slice)
    }

    fn frictions(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.frictions.iter().map(|friction| friction.load)
    }

    fn sticking_friction(&self, index: usize) -> Option<(Friction, CoordinateFunction)> {
        self.frictions.get(index)?.sticking()
    }

    #[inline]
    fn update_kinematics<T: Scalar>(
        &self,
        q: &[T],
        q_dot: &[T],
        workspace: &mut Workspace<T>,
    ) -> PositionResult {
        self.plan().positions(q, &mut workspace.pose)?;
        self.plan().velocities(q_dot, &mut workspace.pose);
        if !self.surface_frictions.is_empty() {
            self.update_surface_directions(workspace);
        }
        Ok(())
    }

    #[inline]
    fn coordinate_motion<T: Scalar>(
        &self,
        of: CoordinateFunction,
        workspace: &Workspace<T>,
    ) -> [T; 3] {
        self.plan().coordinate(&workspace.pose, of)
    }

    fn counts_revolutions<T: Scalar>(
        &self,
        of: CoordinateFunction,
        _: &Workspace<T>,
    ) -> Option<bool> {
        matches!(of, CoordinateFunction::Angle { .. }).then_some(true)
    }

    #[inline]
    fn set_accelerations<T: Scalar>(&self, q_ddot: &[T], workspace: &mut Workspace<T>) {
        self.plan().accelerations(q_ddot, &mut workspace.pose);
    }

    #[inline]
    fn update_bodies<T: Scalar>(&self, _: &mut Workspace<T>) {
        // The pose has the accelerations of the inverse dynamics already.
    }

    #[inline]
    fn update_magnitudes<T: Scalar>(&self, t: f64, workspace: &mut Workspace<T>) -> Result<()> {
        if T::LANES > 1 && !self.loads.loads.is_empty() {
            // Laws decide by one value.
            return Err(PositionError::LanesDiverge { q: f64::NAN }.into());
        }
        let known = &mut workspace.friction_workspace.known;
        known.fill(FrictionState::BySpeed);
        for (i, load) in self.loads.loads.iter().enumerate() {
            workspace.magnitudes[i] = match &load.magnitude {
                Magnitude::External(_) | Magnitude::Friction(_) => T::from_f64(0.0),
                magnitude => self.eval_magnitude(i, magnitude, t, workspace)?,
            };
        }
        Ok(())
    }

    #[inline]
    fn magnitudes<T: Scalar>(workspace: &Workspace<T>) -> &[T] {
        &workspace.magnitudes
    }

    #[inline]
    fn magnitudes_mut<T: Scalar>(workspace: &mut Workspace<T>) -> &mut [T] {
        &mut workspace.magnitudes
    }

    #[inline]
    fn eval_magnitude<T: Scalar>(
        &self,
        load: usize,
        magnitude: &Magnitude<Coordinate>,
        t: f64,
        workspace: &mut Workspace<T>,
    ) -> Result<T> {
        let Workspace { pose, signals, .. } = workspace;
        let coordinate = |of| {
            let [value, rate, _] = self.plan().coordinate(pose, of);
            [value, rate]
        };
        let of_load = &self.loads.signals[load];
        signals.eval(load, magnitude, of_load, t, coordinate)
    }

    fn held_pieces<T: Scalar>(workspace: &mut Workspace<T>, load: usize) -> &mut HeldPieces {
        workspace.signals.held_pieces(load)
    }

    #[inline]
    fn update_wrenches<T: Scalar>(&self, workspace: &mut Workspace<T>) -> Result<()> {
        let mut loads = std::mem::take(&mut workspace.load_wrenches);
        loads.fill(Wrench::default());
        let mut done = Ok(());
        for load in 0..self.loads.kinds.len() {
            let magnitude = workspace.magnitudes[load];
            done = done.and(self.act(load, magnitude, workspace, |body, wrench| {
                loads[body].force += wrench.force;
                loads[body].moment += wrench.moment;
            }));
        }
        workspace.load_wrenches = loads;
        done
    }

    #[inline]
    fn loaded_balance<T: Scalar>(
        &self,
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) {
        self.pass_model
            .require_inertia(&workspace.pose, &mut workspace.forces);
        let Workspace {
            forces,
            load_wrenches,
            ..
        } = &mut *workspace;
        for ([required], load) in forces.required.iter_mut().zip(load_wrenches) {
            required.force -= load.force;
            required.moment -= load.moment;
        }
        self.balance(workspace, result);
    }

    #[inline]
    fn mass_matrix_column<T: Scalar>(
        &self,
        i: usize,
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) {
        workspace.rates.fill(T::from_f64(0.0));
        workspace.rates[i] = T::from_f64(1.0);
        let Workspace {
            pose,
            rates,
            virtual_motion,
            ..
        } = &mut *workspace;
        pose.swap_motion(virtual_motion);
        self.plan().velocities(rates, pose);
        self.pass_model
            .require_unit_acceleration(&workspace.pose, &mut workspace.forces);
        self.balance(workspace, result);
        workspace.pose.swap_motion(&mut workspace.virtual_motion);
    }

    fn column_turns(&self, workspace: &Workspace<f64>) -> Vec<[f64; 2]> {
        self.plan()
            .turns(&workspace.pose, &workspace.virtual_motion)
    }

    #[inline]
    fn load_response<T: Scalar>(
        &self,
        load: usize,
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> Result<()> {
        let no_direction = KinetostaticsError::NoDirection { load };
        if let Some((surface, direction)) =
            self.surface_friction(load, &workspace.surface_directions)
        {
            let parts = surface.parts(direction);
            return (self.respond_to(&parts, workspace, result)).ok_or(no_direction);
        }
        self.respond(&self.loads.kinds[load], workspace, result)
            .ok_or(no_direction)
    }

    #[inline]
    fn load_power<T: Scalar>(&self, load: usize, workspace: &Workspace<T>) -> T {
        let mut power = T::from_f64(0.0);
        let plan = self.plan();
        let magnitude = workspace.magnitudes[load];
        let acted = self.act(load, magnitude, workspace, |body, wrench| {
            let state = plan.state(&workspace.pose, body);
            power += wrench.force.dot(state.velocity) + wrench.moment.dot(state.angular_velocity);
        });
        // Its wrenches were computed before: it has a direction.
        acted.map_or(T::from_f64(f64::NAN), |()| power)
    }

    fn kinetic_energy(&self, workspace: &Workspace<f64>) -> f64 {
        let energy = |&b: &usize| {
            let state = self.plan().state(&workspace.pose, b);
            // The momentum is what an acceleration equal to the velocity from rest requires.
            let frame = self.plan().frame(&workspace.pose, b);
            let momentum = self.inner_masses()[b].required(frame, &state.from_rest());
            0.5 * (momentum.force.dot(state.velocity) + momentum.moment.dot(state.angular_velocity))
        };
        self.inertial().iter().map(energy).sum()
    }

    fn potential_energy(&self, load: usize, workspace: &Workspace<f64>) -> Option<f64> {
        let Magnitude::Constant(magnitude) = self.loads.loads.get(load)?.magnitude else {
            return None;
        };
        let kind = self.loads.kinds.get(load)?;
        let unit = kind.potential(self.plan(), &workspace.pose, self.inner_masses())?;
        Some(magnitude * unit)
    }

    fn contact_force<T: Scalar>(&self, index: usize, reactions: &[T]) -> T {
        self.frictions[index].contact_force(reactions)
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
        let Workspace {
            pose,
            friction_workspace: solution,
            magnitudes,
            ..
        } = &mut *workspace;
        let rate = |of| self.plan().coordinate_rate(pose, of);
        let by_speed = |friction: &JointFriction| friction.factor(rate);
        friction::solve(&self.frictions, by_speed, frictionless, responses, solution)?;
        for (friction, force) in self.frictions.iter().zip(&solution.force) {
            magnitudes[friction.load] = *force;
        }
        self.update_wrenches(workspace)
    }
}
