//! The working memory of a machine.

use super::{EvaluatedIn, Machine, MovingModel};
use crate::change_point_fit::FitWorkspace;
use crate::contact::ContactWorkspace;
use crate::drive::HeldDrive;
use dwell_kinetostatics::{InverseDynamics, Model};
use dwell_numerics::Scalar;

impl<M: MovingModel> Machine<M> {
    /// Working memory for one thread.
    pub fn workspace<T: Scalar>(&self) -> MachineWorkspace<T, M>
    where
        M: EvaluatedIn<T>,
    {
        M::machine_workspace(self)
    }

    /// [`Self::workspace`], compiled by [`EvaluatedIn`].
    pub(super) fn workspace_in<T: Scalar>(&self) -> MachineWorkspace<T, M> {
        let n = self.free.len();
        let zeros = |count| vec![T::from_f64(0.0); count];
        let (actuators, drives) = (self.modes.len(), self.drives.len());
        let frictions = self.model.frictions().len();
        MachineWorkspace {
            inner: self.model.pass_workspace(),
            input_offsets: zeros(drives),
            equation: EquationWorkspace {
                q: zeros(actuators),
                q_dot: zeros(actuators),
                q_ddot: zeros(actuators),
                inverse_dynamics: self.model.result_buffer(),
                acceleration_responses: vec![self.model.result_buffer(); n],
                friction_responses: vec![self.model.result_buffer(); frictions],
                friction_accelerations: vec![zeros(n); frictions],
                mass_matrix: zeros(n * n),
                pivots: vec![0; n],
                free_accelerations: zeros(n),
                drive_forces: zeros(drives),
                drive_accelerations: zeros(drives),
                rotor_response: self.model.result_buffer(),
                drive_state_rates: zeros(self.drive_state_count),
                held_drives: vec![[None; 2]; drives],
                fit_workspace: None,
                locked: vec![false; n],
                stop_forces: zeros(self.stops.len()),
                contacts: ContactWorkspace::new(
                    &self.contacts,
                    n,
                    frictions,
                    &self.model.result_buffer(),
                ),
            },
        }
    }
}

/// Working memory of a machine for one thread.
#[derive(Debug, Clone)]
pub struct MachineWorkspace<T: Scalar = f64, M: MovingModel = Model> {
    pub(super) inner: M::Workspace<T>,
    /// By drive: an offset of its input (force, voltage or reference speed), by which linearisation differentiates;
    /// zero at first.
    pub input_offsets: Vec<T>,
    pub(super) equation: EquationWorkspace<T>,
}

/// The equation of motion at one state.
#[derive(Debug, Clone)]
pub struct EquationWorkspace<T> {
    /// By actuator: coordinate, speed and acceleration, rad or m, per s, per s².
    pub(super) q: Vec<T>,
    pub(super) q_dot: Vec<T>,
    pub(super) q_ddot: Vec<T>,
    /// By drive: its force, N·m or N, before that which accelerates its rotor is taken off.
    pub(super) drive_forces: Vec<T>,
    /// By drive: the acceleration of its coordinate.
    pub(super) drive_accelerations: Vec<T>,
    pub(super) rotor_response: InverseDynamics<T>,
    pub(super) inverse_dynamics: InverseDynamics<T>,
    pub(super) acceleration_responses: Vec<InverseDynamics<T>>,
    pub(super) friction_responses: Vec<InverseDynamics<T>>,
    pub(super) friction_accelerations: Vec<Vec<T>>,
    pub(super) mass_matrix: Vec<T>,
    pub(super) pivots: Vec<usize>,
    pub(super) free_accelerations: Vec<T>,
    pub(super) drive_state_rates: Vec<T>,
    /// By drive: the pieces on which it is held.
    pub(super) held_drives: Vec<HeldDrive>,
    pub(super) fit_workspace: Option<Box<FitWorkspace<T>>>,
    pub(super) contacts: ContactWorkspace<T>,
    /// By free coordinate: whether it rests on an end stop.
    pub(super) locked: Vec<bool>,
    /// By side of an end stop: the force of a compliant stop along its coordinate, N·m or N.
    pub(super) stop_forces: Vec<T>,
}

impl<T: Scalar, M: MovingModel> MachineWorkspace<T, M> {
    /// The contacts at the last state.
    pub(crate) fn contacts(&self) -> &ContactWorkspace<T> {
        &self.equation.contacts
    }

    /// The accelerations of the free coordinates by one unit of a load that depends on reactions, at the last state.
    pub(crate) fn friction_accelerations(&self, index: usize) -> &[T] {
        &self.equation.friction_accelerations[index]
    }
}
