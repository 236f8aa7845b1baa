//! The quantities of a moving system that events are functions of.

use crate::error::Result;
use crate::machine::{Machine, MachineWorkspace};
use crate::ode::OdeState;
use dwell_geometry::BodyId;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_kinetostatics::{InverseDynamics, Model, Workspace};

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

    /// The largest change of one of its angles from one state to another, rad: events are looked for at points that
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
    /// Of an angle: whether it counts whole revolutions.
    pub revolutions_counted: Option<bool>,
}

/// A machine, with the model of it whose reactions events can be about.
#[derive(Debug)]
pub struct ObservedMachine<'m> {
    machine: &'m Machine,
    output_model: &'m Model,
    workspace: MachineWorkspace<f64>,
    output_workspace: Workspace<f64>,
    inverse_dynamics: InverseDynamics<f64>,
}

impl<'m> ObservedMachine<'m> {
    /// A machine with its output model: the same mechanism with the same loads (those of the drives last) and
    /// the reactions that events name.
    pub fn new(machine: &'m Machine, output_model: &'m Model) -> Self {
        Self {
            machine,
            output_model,
            workspace: machine.workspace(),
            output_workspace: output_model.workspace(),
            inverse_dynamics: output_model.result_buffer(),
        }
    }
}

impl Observed for ObservedMachine<'_> {
    type Coordinate = CoordinateFunction;

    fn coordinate(
        &mut self,
        coordinate: CoordinateFunction,
        at: &OdeState,
    ) -> Result<ObservedValue> {
        let state = self.machine.evaluate(at.t, &at.y, &mut self.workspace)?;
        let [value, rate] = state.coordinate(coordinate);
        let counted = |b: BodyId| state.counts_revolutions(b);
        Ok(ObservedValue {
            value,
            rate,
            revolutions_counted: match coordinate {
                CoordinateFunction::Angle(bodies) => Some(bodies.into_iter().all(counted)),
                _ => None,
            },
        })
    }

    fn reaction(&mut self, index: usize, at: &OdeState) -> Result<f64> {
        let state = self.machine.evaluate(at.t, &at.y, &mut self.workspace)?;
        let (workspace, result) = (&mut self.output_workspace, &mut self.inverse_dynamics);
        let outputs = state.outputs(self.output_model, workspace, result)?;
        Ok(outputs.inverse_dynamics().reactions[index])
    }

    fn angle_between(&self, from: &OdeState, to: &OdeState) -> f64 {
        let plan = self.machine.model().plan();
        let free = self.machine.free().iter().enumerate();
        let angles = free.filter(|(_, coordinate)| plan.is_angle(**coordinate));
        let changes = angles.map(|(k, _)| (to.y[k] - from.y[k]).abs());
        changes.fold(0.0, f64::max)
    }
}
