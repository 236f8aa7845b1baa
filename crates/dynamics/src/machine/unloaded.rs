//! A machine of one coordinate without loads:
//!
//! ```text
//! q̈ = −½m′ q̇² / (m + J)                                        (1)
//! ```
//!
//! with the inertia J of a flywheel along the coordinate. m and ½m′ come from the two unit runs, which take 2100 instructions for
//! the single-dwell instead of 4700 for inverse dynamics and a column of the mass matrix.

use super::{EvaluatedIn, Machine, MachineWorkspace, MovingModel};
use crate::error::Result;
use dwell_numerics::Scalar;

impl<M: MovingModel> Machine<M> {
    /// The derivatives of the state [q, q̇] by (1). Returns false if (1) does not describe the machine, or it has no
    /// inertia; [`Machine::evaluate`] handles these cases.
    ///
    /// # Errors
    /// [`DynamicsError::Position`](crate::DynamicsError::Position) where there is no pose.
    pub(crate) fn unloaded_derivative<T: Scalar>(
        &self,
        y: &[T],
        workspace: &mut MachineWorkspace<T, M>,
        out: &mut [T],
    ) -> Result<bool>
    where
        M: EvaluatedIn<T>,
    {
        M::unloaded_derivative(self, y, workspace, out)
    }

    /// [`Self::unloaded_derivative`], compiled by [`EvaluatedIn`].
    pub(super) fn unloaded_derivative_in<T: Scalar>(
        &self,
        y: &[T],
        workspace: &mut MachineWorkspace<T, M>,
        out: &mut [T],
    ) -> Result<bool> {
        let ([q, q_dot], [flywheel]) = (y, &self.flywheels[..]) else {
            return Ok(false);
        };
        let is_loaded = !self.model.loads().is_empty() || !self.stops.is_empty();
        let is_single = self.modes.len() == 1 && self.fit_windows.is_empty();
        let has_reactions = !workspace.equation.inverse_dynamics.reactions.is_empty();
        if is_loaded || !is_single || has_reactions {
            return Ok(false);
        }
        let [m, half_dm] = self.model.reduced_inertia(*q, &mut workspace.inner)?;
        let inertia = m + T::from_f64(*flywheel);
        if !(m.value() > 0.0 && inertia.value().is_finite()) {
            return Ok(false);
        }
        out.copy_from_slice(&[*q_dot, -(half_dm * *q_dot * *q_dot) / inertia]);
        Ok(true)
    }
}
