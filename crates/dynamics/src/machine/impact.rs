//! The effect of an impact on an end stop on a machine: speeds and works.

use super::{Machine, MachineWorkspace, MovingModel, NonconservativeSource};
use crate::contact::Stop;
use crate::error::{DynamicsError, Result};
use dwell_numerics::lu;

impl<M: MovingModel> MachineWorkspace<f64, M> {
    /// The changes of the free coordinates' speeds by a unit of impulse along one of them, at the last state.
    pub(crate) fn unit_impulse(&self, free: usize) -> Vec<f64> {
        let equation = &self.equation;
        let mut changes = vec![0.0; equation.pivots.len()];
        changes[free] = 1.0;
        lu::solve(&equation.mass_matrix, &equation.pivots, &mut changes);
        changes
    }

    /// The acceleration of an actuator at the last state.
    pub(crate) fn acceleration(&self, actuator: usize) -> f64 {
        self.equation.q_ddot[actuator]
    }

    /// The force that an actuator's coordinate takes, at the last state.
    pub(crate) fn actuator_force(&self, actuator: usize) -> f64 {
        self.equation.inverse_dynamics.tau[actuator]
    }

    /// Number of free coordinates that rest on their stops, at the last state.
    pub(crate) fn locked(&self) -> usize {
        self.equation
            .locked
            .iter()
            .filter(|locked| **locked)
            .count()
    }
}

impl<M: MovingModel> Machine<M> {
    /// Refuses a state beyond an end stop, by more than a rounding.
    pub(crate) fn check_start(&self, y: &[f64]) -> Result<()> {
        let beyond = |stop: &&Stop| {
            let rounding = 4.0 * f64::EPSILON * stop.at.abs();
            stop.yielding.is_none() && stop.side * (y[stop.free] - stop.at) < -rounding
        };
        self.stops.iter().find(beyond).map_or(Ok(()), |stop| {
            Err(DynamicsError::BeyondStop {
                stop: stop.stop,
                q: y[stop.free],
            })
        })
    }

    /// Adds the works of an impact on a stop, with its impulse, to those among the states: the stop's, and those of the
    /// actuators whose motion is prescribed. `changes` are those of the free speeds.
    pub(crate) fn add_impact_works(
        &self,
        workspace: &MachineWorkspace<f64, M>,
        y: &mut [f64],
        stop: &Stop,
        impulse: f64,
        changes: &[f64],
    ) {
        let n = self.free.len();
        let equation = &workspace.equation;
        let mean = y[n + stop.free] + 0.5 * changes[stop.free];
        let works = &mut y[self.work_offset()..];
        for (work, &source) in works.iter_mut().zip(&self.nonconservative_sources) {
            match source {
                NonconservativeSource::Stop(k) if k == stop.stop => *work += impulse * mean,
                NonconservativeSource::Prescribed(i) => {
                    let columns = equation.acceleration_responses.iter().zip(changes);
                    let own: f64 = columns.map(|(column, change)| column.tau[i] * change).sum();
                    *work += own * equation.q_dot[i];
                }
                NonconservativeSource::Stop(_)
                | NonconservativeSource::Load(_)
                | NonconservativeSource::Loads
                | NonconservativeSource::Drive(_) => {}
            }
        }
    }
}
