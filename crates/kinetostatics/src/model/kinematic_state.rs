//! Positions and velocities.

use super::loaded_state::StateWithLoads;
use super::{LoadedState, MachineModel, Model, Workspace};
use crate::error::Result;
use crate::pass::{GivenMotion, InverseDynamics};
use dwell_geometry::body_states::BodyStates;
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
pub struct KinematicState<'a, T: Scalar = f64, M: MachineModel = Model> {
    pub(crate) model: &'a M,
    pub(crate) workspace: &'a mut M::Workspace<T>,
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
        KinematicState::new(self, [q, q_dot], workspace)
    }

    /// A state whose positions and velocities do not follow from the coordinates, as on a change-point fit: `set`
    /// stores pose and motion.
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

impl<'a, T: Scalar, M: MachineModel> KinematicState<'a, T, M> {
    /// Positions and velocities of a model at coordinates (rad or m) and their velocities.
    ///
    /// # Errors
    /// [`PositionError`] when there is no pose at `q`.
    #[inline]
    pub fn new(
        model: &'a M,
        [q, q_dot]: [&[T]; 2],
        workspace: &'a mut M::Workspace<T>,
    ) -> Result<Self, PositionError> {
        model.update_kinematics(q, q_dot, workspace)?;
        Ok(KinematicState { model, workspace })
    }

    /// The value and the velocity of a coordinate of the mechanism, rad or m, per s.
    #[inline]
    pub fn coordinate(&self, coordinate: M::CoordinateFunction) -> [T; 2] {
        let [value, velocity, _] = self.coordinate_motion(coordinate);
        [value, velocity]
    }

    /// Value, velocity and acceleration of a coordinate. The accelerations of the bodies must be known.
    #[inline]
    pub fn coordinate_motion(&self, coordinate: M::CoordinateFunction) -> [T; 3] {
        self.model.coordinate_motion(coordinate, self.workspace)
    }

    /// Whether the whole revolutions of an angle are counted.
    pub fn counts_revolutions_of(&self, coordinate: M::CoordinateFunction) -> Option<bool> {
        self.model.counts_revolutions(coordinate, self.workspace)
    }

    /// The loads that depend on reactions, as [`MachineModel::frictions`].
    pub fn frictions(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.model.frictions()
    }

    /// The force g (N·m or N) that the factor of one of these loads multiplies, from the reactions of the model. The
    /// factor of a friction is the coefficient of friction.
    pub fn contact_force(&self, index: usize, reactions: &[T]) -> T {
        self.model.contact_force(index, reactions)
    }

    /// Sets the accelerations of the bodies from those of the coordinates, rad/s² or m/s².
    #[inline]
    pub fn accelerate(&mut self, q_ddot: &[T]) {
        self.model.update_accelerations(q_ddot, self.workspace);
    }

    /// The magnitudes of the loads at time `t` (s).
    ///
    /// # Errors
    /// [`KinetostaticsError::MagnitudeNotFinite`](crate::KinetostaticsError::MagnitudeNotFinite) where a load has no finite magnitude.
    #[inline]
    pub fn apply_loads(self, t: f64) -> Result<LoadedState<'a, T, M>> {
        self.model.update_magnitudes(t, self.workspace)?;
        Ok(StateWithLoads(self))
    }

    /// Column i of the mass matrix, and a_k,i: q̈ᵢ = 1 (per s²), all other accelerations and all velocities zero.
    #[inline]
    pub fn mass_matrix_column(&mut self, i: usize, result: &mut InverseDynamics<T>) {
        self.model.mass_matrix_column(i, self.workspace, result);
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
        self.model.load_response(load, self.workspace, result)
    }
}

impl<M: MachineModel> KinematicState<'_, f64, M> {
    /// Kinetic energy ½ Σ m v² + ω·Iω, J.
    pub fn kinetic_energy(&self) -> f64 {
        self.model.kinetic_energy(self.workspace)
    }

    /// The potential energy of a load, J; `None` if it is not [conservative](crate::Load::is_conservative). The potential
    /// energy of gravity and of forces is zero at the ground's origin.
    pub fn potential_energy(&self, load: usize) -> Option<f64> {
        self.model.potential_energy(load, self.workspace)
    }
}

impl<T: Scalar> KinematicState<'_, T> {
    /// The states of the bodies from pose and motion.
    #[inline]
    pub(super) fn fill_bodies(&mut self) {
        let workspace = &mut *self.workspace;
        let states = &mut workspace.states;
        states.fill(self.model.plan(), &workspace.pose, &workspace.motion);
    }

    /// The pose.
    pub fn pose(&self) -> &Pose<T> {
        &self.workspace.pose
    }

    /// [`Self::potential_energy`] in any kind of number, J.
    pub fn potential(&self, load: usize) -> Option<T> {
        let loads = &self.model.loads;
        loads.potential_energy(load, &self.workspace.states)
    }

    /// Whether the whole revolutions of a body are counted.
    pub fn counts_revolutions(&self, body: BodyId) -> bool {
        let states = &self.workspace.states;
        states.body(body).angle.is_some()
    }

    /// The states of the bodies with the accelerations that follow from those of the coordinates, rad/s² or m/s².
    pub fn bodies_at(&mut self, q_ddot: &[T]) -> &BodyStates<T> {
        self.accelerate(q_ddot);
        &self.workspace.states
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
