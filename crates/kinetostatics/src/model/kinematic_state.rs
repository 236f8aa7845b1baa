//! Positions and velocities.

use super::loaded_state::StateWithLoads;
use super::{LoadedState, Model, Workspace};
use crate::error::Result;
use crate::friction::FrictionState;

use crate::pass::{AtRest, GivenMotion, InverseDynamics, UnitAcceleration};
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_geometry::{BodyId, Motion, Pose, PositionError};
use dwell_numerics::Scalar;

/// The positions and velocities of all bodies are known. The passes from which the equation of motion and every
/// reaction are composed need no more:
///
/// ```text
/// method                          what is nonzero                  τ                 reaction k
/// LoadedState::inverse_dynamics   q̇, known q̈, all loads           c − Q             R⁰
/// mass_matrix_column              q̈ᵢ = 1                           column i of M     a_k,i
/// unit_load_response              magnitude 1 of one load          −w_ℓ              c_k,ℓ
/// christoffel_terms               q̇ᵢ q̇ⱼ                           Cᵢⱼ               b_k,ij
/// ```
///
/// C are the Christoffel terms: c(q, q̇) = Σ Cᵢⱼ q̇ᵢ q̇ⱼ over i ≤ j. All passes share the pose, its factors and the states
/// of the bodies.
#[derive(Debug)]
pub struct KinematicState<'a, T = f64> {
    pub(crate) model: &'a Model,
    pub(crate) workspace: &'a mut Workspace<T>,
}

impl Model {
    /// Positions and velocities at coordinates `q` (rad or m) and their velocities `q_dot`.
    ///
    /// # Errors
    /// [`PositionError`] when there is no pose at `q`.
    #[inline]
    pub fn kinematic_state<'a, T: Scalar>(
        &'a self,
        q: &[T],
        q_dot: &[T],
        workspace: &'a mut Workspace<T>,
    ) -> Result<KinematicState<'a, T>, PositionError> {
        let plan = self.plan();
        plan.positions(q, &mut workspace.pose)?;
        plan.velocities(&workspace.pose, q_dot, &mut workspace.motion);
        let states = &mut workspace.states;
        states.fill_velocities(plan, &workspace.pose, &workspace.motion);
        workspace.q_dot.copy_from_slice(q_dot);
        let model = self;
        Ok(KinematicState { model, workspace })
    }

    /// Positions and velocities that `set` stores as pose and motion, where they come from elsewhere than
    /// the coordinates: of a change-point fit.
    #[inline]
    pub fn given_kinematic_state<'a, T: Scalar>(
        &'a self,
        q_dot: &[T],
        workspace: &'a mut Workspace<T>,
        set: impl FnOnce(&mut Pose<T>, &mut Motion<T>),
    ) -> KinematicState<'a, T> {
        set(&mut workspace.pose, &mut workspace.motion);
        workspace.q_dot.copy_from_slice(q_dot);
        let model = self;
        let mut state = KinematicState { model, workspace };
        state.fill_bodies();
        state
    }
}

impl<'a, T: Scalar> KinematicState<'a, T> {
    /// The states of the bodies from pose and motion.
    #[inline]
    pub(super) fn fill_bodies(&mut self) {
        let workspace = &mut *self.workspace;
        let states = &mut workspace.states;
        states.fill(self.model.plan(), &workspace.pose, &workspace.motion);
    }

    /// Their accelerations from those of the motion.
    #[inline]
    pub(super) fn fill_accelerations(&mut self) {
        let workspace = &mut *self.workspace;
        let states = &mut workspace.states;
        states.fill_accelerations(self.model.plan(), &workspace.pose, &workspace.motion);
    }

    /// The wrenches of the loads from their magnitudes.
    #[inline]
    pub(super) fn update_wrenches(&mut self) -> Result<()> {
        let Workspace { states, loads, .. } = &mut *self.workspace;
        self.model.loads.update_wrenches(states, loads)
    }

    /// The pose.
    pub fn pose(&self) -> &Pose<T> {
        &self.workspace.pose
    }

    /// The value and the velocity of a coordinate of the mechanism, rad or m, per s.
    #[inline]
    pub fn coordinate(&self, coordinate: CoordinateFunction) -> [T; 2] {
        let states = &self.workspace.states;
        let [value, velocity, _] = states.coordinate(coordinate);
        [value, velocity]
    }

    /// The loads that depend on reactions, as [`Model::frictions`].
    pub fn frictions(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.model.frictions()
    }

    /// Of one of these loads: the force g (N·m or N) that its factor multiplies, at reactions of the model. Of a friction
    /// that factor is the coefficient of friction.
    pub fn contact_force(&self, index: usize, reactions: &[T]) -> T {
        self.model.dependent_loads[index].contact_force(reactions)
    }

    /// Whether the whole revolutions of a body are counted.
    pub fn counts_revolutions(&self, body: BodyId) -> bool {
        let states = &self.workspace.states;
        states.body(body).angle.is_some()
    }

    /// The states of the bodies with the accelerations that follow from those of the coordinates, rad/s² or m/s².
    pub fn bodies_at(&mut self, q_ddot: &[T]) -> &BodyStates<T> {
        let Workspace { pose, motion, .. } = &mut *self.workspace;
        self.model.plan().accelerations(pose, q_ddot, motion);
        self.fill_accelerations();
        &self.workspace.states
    }

    /// The magnitudes of the loads at time `t` (s).
    ///
    /// # Errors
    /// [`KinetostaticsError::MagnitudeNotFinite`](crate::KinetostaticsError::MagnitudeNotFinite) where a load has no finite magnitude.
    #[inline]
    pub fn apply_loads(self, t: f64) -> Result<LoadedState<'a, T>> {
        let workspace = &mut *self.workspace;
        workspace
            .friction_workspace
            .known
            .fill(FrictionState::BySpeed);
        let Workspace { states, loads, .. } = workspace;
        self.model.loads.update_magnitudes(t, states, loads)?;
        Ok(StateWithLoads(self))
    }

    /// Column i of the mass matrix, and a_k,i: q̈ᵢ = 1 (per s²) and nothing else.
    #[inline]
    pub fn mass_matrix_column(&mut self, i: usize, result: &mut InverseDynamics<T>) {
        let (model, workspace) = (&self.model.pass_model, &mut *self.workspace);
        workspace.set_unit_velocities(&model.plan, &[i]);
        let Workspace { pose, pass, .. } = workspace;
        pass.evaluate(
            model,
            pose,
            UnitAcceleration(&workspace.virtual_motion),
            None,
        );
        result.read_from(model, pose, pass);
    }

    /// The response to one load alone of magnitude 1, at rest: τ = −w and the reactions c. Of a damper,
    /// to one unit of its resistance (N or N·m).
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`](crate::KinetostaticsError::NoDirection) where its two points coincide.
    #[inline]
    pub fn unit_load_response(
        &mut self,
        load: usize,
        result: &mut InverseDynamics<T>,
    ) -> Result<()> {
        let (model, workspace) = (&self.model.pass_model, &mut *self.workspace);
        let (loads, single) = (&self.model.loads, &mut workspace.single_load);
        loads.unit_wrenches(load, &workspace.states, single)?;
        let Workspace { pose, pass, .. } = workspace;
        pass.evaluate_loaded(model, pose, AtRest, single);
        result.read_from(model, pose, pass);
        Ok(())
    }

    /// The Christoffel terms of the velocities i and j, for q̇ᵢ q̇ⱼ = 1 per s²: with i = j, the pass at
    /// unit velocity; else the pass at both unit velocities less those at each of them.
    pub fn christoffel_terms(&mut self, [i, j]: [usize; 2], result: &mut InverseDynamics<T>) {
        let (model, workspace) = (&self.model.pass_model, &mut *self.workspace);
        let rest = vec![T::from_f64(0.0); model.plan.actuators()];
        let mut at = |coordinates: &[usize], result: &mut InverseDynamics<T>| {
            workspace.set_unit_velocities(&model.plan, coordinates);
            let (pose, motion) = (&workspace.pose, &mut workspace.virtual_motion);
            model.plan.accelerations(pose, &rest, motion);
            workspace
                .pass
                .evaluate(model, pose, GivenMotion(motion), None);
            result.read_from(model, pose, &workspace.pass);
        };
        if i == j {
            return at(&[i], result);
        }
        let mut single = self.model.result_buffer();
        at(&[i, j], result);
        for k in [i, j] {
            at(&[k], &mut single);
            result.add_scaled(&single, T::from_f64(-1.0));
        }
    }
}

impl KinematicState<'_> {
    /// Kinetic energy ½ Σ m v² + I ω², J.
    pub fn kinetic_energy(&self) -> f64 {
        let terms = self.model.inertia_terms(&self.workspace.states);
        terms
            .map(|[of_mass, of_inertia, ..]| 0.5 * (of_mass + of_inertia))
            .sum()
    }

    /// The potential energy of a load, J; none if it is not [conservative](crate::Load::is_conservative). That of gravity
    /// and of forces is zero at the ground's origin.
    pub fn potential_energy(&self, load: usize) -> Option<f64> {
        let states = &self.workspace.states;
        self.model.loads.potential_energy(load, states)
    }
}
