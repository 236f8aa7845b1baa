//! The working memory of a machine.

use super::Machine;
use crate::change_point_fit::FitWorkspace;
use dwell_kinetostatics::{InverseDynamics, Workspace};
use dwell_numerics::Scalar;

impl Machine {
    /// Working memory for one thread.
    pub fn workspace<T: Scalar>(&self) -> MachineWorkspace<T> {
        let n = self.free.len();
        let zeros = |count| vec![T::from_f64(0.0); count];
        let actuators = self.modes.len();
        MachineWorkspace {
            inner: self.model.workspace(),
            q: zeros(actuators),
            q_dot: zeros(actuators),
            q_ddot: zeros(actuators),
            inverse_dynamics: self.model.result_buffer(),
            acceleration_responses: vec![self.model.result_buffer(); n],
            friction_responses: vec![self.model.result_buffer(); self.model.frictions().len()],
            friction_accelerations: vec![zeros(n); self.model.frictions().len()],
            mass_matrix: zeros(n * n),
            pivots: vec![0; n],
            free_accelerations: zeros(n),
            drive_forces: zeros(self.drives.len()),
            input_offsets: zeros(self.drives.len()),
            rotor_response: self.model.result_buffer(),
            drive_state_rates: zeros(self.drive_state_count),
            fit_workspace: None,
        }
    }
}

/// Working memory of a machine for one thread, with the results of the last evaluation.
#[derive(Debug, Clone)]
pub struct MachineWorkspace<T = f64> {
    /// The bodies and loads.
    pub inner: Workspace<T>,
    /// By actuator: coordinate, speed and acceleration, rad or m, per s, per s².
    pub q: Vec<T>,
    /// Speeds.
    pub q_dot: Vec<T>,
    /// Accelerations.
    pub q_ddot: Vec<T>,
    /// By drive: its force, N·m or N, before that which accelerates its rotor is taken off.
    pub drive_forces: Vec<T>,
    /// By drive: an offset of its input (force, voltage or reference speed), by which linearisation differentiates;
    /// zero at first.
    pub input_offsets: Vec<T>,
    pub(super) rotor_response: InverseDynamics<T>,
    pub(super) inverse_dynamics: InverseDynamics<T>,
    pub(super) acceleration_responses: Vec<InverseDynamics<T>>,
    pub(super) friction_responses: Vec<InverseDynamics<T>>,
    pub(super) friction_accelerations: Vec<Vec<T>>,
    pub(super) mass_matrix: Vec<T>,
    pub(super) pivots: Vec<usize>,
    pub(super) free_accelerations: Vec<T>,
    pub(super) drive_state_rates: Vec<T>,
    pub(crate) fit_workspace: Option<Box<FitWorkspace<T>>>,
}

impl<T> MachineWorkspace<T> {
    /// The actuators' forces (zero on free coordinates) and the reactions of the machine's own model, from the last
    /// evaluation.
    pub fn inverse_dynamics(&self) -> &InverseDynamics<T> {
        &self.inverse_dynamics
    }
}
