//! The quantities of a moving system that events are functions of.

use crate::error::Result;
use crate::machine::{Machine, MachineWorkspace, MovingModel};
use crate::modes::{EventSide, SharedModes};
use crate::ode::OdeState;
use dwell_kinetostatics::{InverseDynamics, Model};

/// A moving system whose coordinates and reactions can be evaluated at any state.
pub trait Observed {
    /// The name of a coordinate.
    type Coordinate: Copy;

    /// A coordinate at a state.
    ///
    /// # Errors
    /// [`DynamicsError`](crate::DynamicsError) where the state cannot be evaluated.
    fn coordinate(&mut self, coordinate: Self::Coordinate, at: &OdeState) -> Result<ObservedValue>;

    /// A reaction by its index, N or N·m, at a state.
    ///
    /// # Errors
    /// [`DynamicsError`](crate::DynamicsError) where the state cannot be evaluated.
    fn reaction(&mut self, index: usize, at: &OdeState) -> Result<f64>;

    /// The largest change of one of its angles from one state to another, rad: events are searched for at points that
    /// are near each other in it.
    fn angle_between(&self, from: &OdeState, to: &OdeState) -> f64;
}

/// A value and its rate of change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObservedValue {
    /// The value, rad, m, N or N·m.
    pub value: f64,
    /// Its rate, per s.
    pub rate: f64,
    /// For an angle: whether it counts whole revolutions.
    pub revolutions_counted: Option<bool>,
}

/// A machine, with the model of it whose reactions events can be about.
#[derive(Debug)]
pub struct ObservedMachine<'m, M: MovingModel = Model> {
    machine: &'m Machine<M>,
    output_model: &'m M,
    workspace: MachineWorkspace<f64, M>,
    output_workspace: M::Workspace<f64>,
    inverse_dynamics: InverseDynamics<f64>,
    /// The modes of the motion, if it has any.
    modes: SharedModes,
}

impl<'m, M: MovingModel> ObservedMachine<'m, M> {
    /// A machine with its output model: the same mechanism with the same loads (those of the drives last) and
    /// the reactions that events name.
    pub fn new(machine: &'m Machine<M>, output_model: &'m M) -> Self {
        Self {
            machine,
            output_model,
            workspace: machine.workspace(),
            output_workspace: output_model.pass_workspace(),
            inverse_dynamics: output_model.result_buffer(),
            modes: SharedModes::default(),
        }
    }

    /// This machine in the modes of a motion that is being integrated.
    #[must_use]
    pub fn in_modes(mut self, modes: &SharedModes) -> Self {
        self.modes = modes.clone();
        self
    }
}

impl<M: MovingModel> Observed for ObservedMachine<'_, M> {
    type Coordinate = M::CoordinateFunction;

    fn coordinate(
        &mut self,
        coordinate: M::CoordinateFunction,
        at: &OdeState,
    ) -> Result<ObservedValue> {
        let state = self.machine.evaluate(at.t, &at.y, &mut self.workspace)?;
        let [value, rate] = state.coordinate(coordinate);
        Ok(ObservedValue {
            value,
            rate,
            revolutions_counted: state.counts_revolutions_of(coordinate),
        })
    }

    fn reaction(&mut self, index: usize, at: &OdeState) -> Result<f64> {
        let modes = self.modes.get();
        let along = (&*modes, EventSide::After);
        let state = self
            .machine
            .evaluate_along(along, at, &mut self.workspace)?;
        let (workspace, result) = (&mut self.output_workspace, &mut self.inverse_dynamics);
        let outputs = state.outputs(self.output_model, workspace, result)?;
        Ok(outputs.inverse_dynamics().reactions[index])
    }

    fn angle_between(&self, from: &OdeState, to: &OdeState) -> f64 {
        let free = self.machine.free().iter().enumerate();
        let angles = free.filter(|(_, actuator)| self.machine.model().is_angle(**actuator));
        let changes = angles.map(|(k, _)| (to.y[k] - from.y[k]).abs());
        changes.fold(0.0, f64::max)
    }
}
