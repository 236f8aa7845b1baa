//! The trait of a mechanism's model, in the plane or in space. The [stages](super::stages) and the equations of motion
//! use a model only through this trait.

use crate::drive::Drive;
use crate::error::{LoadError, PositionResult, Result};
use crate::friction::FrictionState;
use crate::load::{Friction, Load, LoadShape, Magnitude, Signal};
use crate::pass::InverseDynamics;
use crate::reducible_model::ReducibleModel;
use dwell_laws::HeldPieces;
use dwell_numerics::Scalar;
use std::fmt::Debug;

/// A mechanism with masses and loads that can be evaluated at a state of motion. The methods with a workspace are the steps
/// of the [stages](super::stages), which call them in the right order: kinematics, magnitudes of loads, forces.
pub trait MachineModel: ReducibleModel + Debug + Clone + PartialEq + Send + 'static {
    /// How a coordinate of the mechanism is described.
    type Coordinate: Debug + Copy + PartialEq + Send + Sync + 'static;
    /// A coordinate of a compiled mechanism.
    type CoordinateFunction: Debug + Copy + PartialEq + Send + Sync + 'static;
    /// The kind of a load.
    type LoadKind: LoadShape;

    /// Whether an actuator drives an angle; otherwise it drives a length.
    fn is_angle(&self, actuator: usize) -> bool;

    /// A length of the order of the mechanism, m.
    fn size(&self) -> f64;

    /// The mass of all bodies, kg.
    fn total_mass(&self) -> f64;

    /// This model without the reactions on which nothing depends.
    #[must_use]
    fn without_reactions(&self) -> Self;

    /// A coordinate, ready to be evaluated.
    ///
    /// # Errors
    /// Why there is none.
    fn coordinate_function(
        &self,
        coordinate: Self::Coordinate,
    ) -> Result<Self::CoordinateFunction, &'static str>;

    /// This model under these loads, which replace its own.
    ///
    /// # Errors
    /// [`LoadError`] when a load does not fit the mechanism.
    fn with_loads(self, loads: Vec<ModelLoad<Self>>) -> Result<Self, LoadError>;

    /// The load by which a drive acts on the mechanism.
    ///
    /// # Errors
    /// A message if the mechanism does not have its coordinate.
    fn drive_load(&self, drive: &Drive<Self::Coordinate>) -> Result<ModelLoad<Self>, &'static str>;

    /// The loads, in their order.
    fn loads(&self) -> &[ModelLoad<Self>];

    /// The compiled signals of a load's magnitude, in the order of its [signals](Magnitude::signals).
    fn compiled_signals(&self, load: usize) -> &[Signal<Self::CoordinateFunction>];

    /// Whether a load has a potential energy.
    fn is_conservative(&self, load: usize) -> bool {
        self.loads().get(load).is_some_and(Load::is_conservative)
    }

    /// The work of a unit of a load, as of [`LoadShape::work_lever`].
    fn work_lever(&self, kind: &Self::LoadKind) -> f64 {
        kind.work_lever(self.size(), self.total_mass())
    }

    /// The loads that depend on reactions (frictions and separating forces), by their indices.
    fn frictions(&self) -> impl ExactSizeIterator<Item = usize> + '_;

    /// One of these loads that holds its surfaces at rest: its numbers, and the coordinate whose speed is that of the surfaces.
    fn sticking_friction(&self, index: usize) -> Option<(Friction, Self::CoordinateFunction)>;

    /// Positions and velocities.
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at `q`.
    fn update_kinematics<T: Scalar>(
        &self,
        q: &[T],
        q_dot: &[T],
        workspace: &mut Self::Workspace<T>,
    ) -> PositionResult;

    /// A coordinate with its rate and acceleration, rad or m, per s and s².
    fn coordinate_motion<T: Scalar>(
        &self,
        of: Self::CoordinateFunction,
        workspace: &Self::Workspace<T>,
    ) -> [T; 3];

    /// Whether the whole revolutions of an angle are counted.
    fn counts_revolutions<T: Scalar>(
        &self,
        of: Self::CoordinateFunction,
        workspace: &Self::Workspace<T>,
    ) -> Option<bool>;

    /// Sets the accelerations of the motion from those of the coordinates.
    fn set_accelerations<T: Scalar>(&self, q_ddot: &[T], workspace: &mut Self::Workspace<T>);

    /// Sets the accelerations of the bodies from those of the motion, that is, of the last inverse dynamics.
    fn update_bodies<T: Scalar>(&self, workspace: &mut Self::Workspace<T>);

    /// Sets the accelerations of the bodies from those of the coordinates.
    #[inline]
    fn update_accelerations<T: Scalar>(&self, q_ddot: &[T], workspace: &mut Self::Workspace<T>) {
        self.set_accelerations(q_ddot, workspace);
        self.update_bodies(workspace);
    }

    /// Computes the magnitudes of the loads at time `t` (s); frictions and external magnitudes are set to zero.
    ///
    /// # Errors
    /// [`MagnitudeNotFinite`](crate::KinetostaticsError::MagnitudeNotFinite).
    fn update_magnitudes<T: Scalar>(
        &self,
        t: f64,
        workspace: &mut Self::Workspace<T>,
    ) -> Result<()>;

    /// The magnitudes of the loads.
    fn magnitudes<T: Scalar>(workspace: &Self::Workspace<T>) -> &[T];

    /// The magnitudes, mutable.
    fn magnitudes_mut<T: Scalar>(workspace: &mut Self::Workspace<T>) -> &mut [T];

    /// A magnitude of the signals of a load at time `t` (s).
    ///
    /// # Errors
    /// [`MagnitudeNotFinite`](crate::KinetostaticsError::MagnitudeNotFinite).
    fn eval_magnitude<T: Scalar>(
        &self,
        load: usize,
        magnitude: &Magnitude<Self::Coordinate>,
        t: f64,
        workspace: &mut Self::Workspace<T>,
    ) -> Result<T>;

    /// The pieces on which the magnitude of a load is held.
    fn held_pieces<T: Scalar>(workspace: &mut Self::Workspace<T>, load: usize) -> &mut HeldPieces;

    /// The forces of the loads at their magnitudes.
    ///
    /// # Errors
    /// [`NoDirection`](crate::KinetostaticsError::NoDirection).
    fn update_wrenches<T: Scalar>(&self, workspace: &mut Self::Workspace<T>) -> Result<()>;

    /// The actuators' actions and the reactions of inertia and of the loads at the accelerations of the motion.
    fn loaded_balance<T: Scalar>(
        &self,
        workspace: &mut Self::Workspace<T>,
        result: &mut InverseDynamics<T>,
    );

    /// Column i of the mass matrix with the reactions.
    fn mass_matrix_column<T: Scalar>(
        &self,
        i: usize,
        workspace: &mut Self::Workspace<T>,
        result: &mut InverseDynamics<T>,
    );

    /// The turns, as of [`ReducibleModel::unit_turns`], in the motion of the last column of the mass matrix.
    fn column_turns(&self, workspace: &Self::Workspace<f64>) -> Vec<[f64; 2]>;

    /// The response to a load alone of magnitude 1, at rest; of a damper, to a unit of its resistance.
    ///
    /// # Errors
    /// [`NoDirection`](crate::KinetostaticsError::NoDirection).
    fn load_response<T: Scalar>(
        &self,
        load: usize,
        workspace: &mut Self::Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> Result<()>;

    /// The power of a load, W.
    fn load_power<T: Scalar>(&self, load: usize, workspace: &Self::Workspace<T>) -> T;

    /// Kinetic energy, J.
    fn kinetic_energy(&self, workspace: &Self::Workspace<f64>) -> f64;

    /// The potential energy of a load, J; none if it is not conservative.
    fn potential_energy(&self, load: usize, workspace: &Self::Workspace<f64>) -> Option<f64>;

    /// The force that the factor of a load that depends on reactions multiplies, N·m or N.
    fn contact_force<T: Scalar>(&self, index: usize, reactions: &[T]) -> T;

    /// The states of the loads that depend on reactions.
    fn friction_states<T: Scalar>(workspace: &mut Self::Workspace<T>) -> &mut [FrictionState<T>];

    /// Memory for the responses to a unit of each of them.
    fn friction_responses<T: Scalar>(
        workspace: &mut Self::Workspace<T>,
    ) -> &mut Vec<InverseDynamics<T>>;

    /// Solves for the loads that depend on reactions, as described at
    /// [`ForceState::solve_friction`](super::ForceState::solve_friction).
    ///
    /// # Errors
    /// [`SelfLocking`](crate::KinetostaticsError::SelfLocking).
    fn solve_friction<T: Scalar>(
        &self,
        frictionless: &[T],
        responses: &[InverseDynamics<T>],
        workspace: &mut Self::Workspace<T>,
    ) -> Result<()>;

    /// Where loads depend on reactions, solves for them in a prescribed motion, whose reactions without them are in `result`.
    ///
    /// # Errors
    /// As [`MachineModel::solve_friction`].
    fn solve_prescribed_friction<T: Scalar>(
        &self,
        workspace: &mut Self::Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> Result<()> {
        if self.frictions().len() == 0 {
            return Ok(());
        }
        let mut responses = std::mem::take(Self::friction_responses(workspace));
        let mut respond = || -> Result<()> {
            for (load, response) in self.frictions().zip(&mut responses) {
                self.load_response(load, workspace, response)?;
            }
            self.solve_friction(&result.reactions, &responses, workspace)
        };
        let solved = respond();
        *Self::friction_responses(workspace) = responses;
        solved?;
        self.loaded_balance(workspace, result);
        Ok(())
    }
}

/// A load of a mechanism that is known by its model.
pub type ModelLoad<M> = Load<<M as MachineModel>::LoadKind, <M as MachineModel>::Coordinate>;
