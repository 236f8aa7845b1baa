//! Drives and their rotors in the equation of motion.

use super::{Machine, MachineWorkspace, add_scaled};
use crate::error::DynamicsError;
use dwell_numerics::Scalar;

impl Machine {
    /// Evaluates the drives' forces and the rates of their states at the state of the bodies in `workspace`.
    ///
    /// # Errors
    /// [`DynamicsError::Load`] where a drive's input has no finite value.
    pub(super) fn evaluate_drives<T: Scalar>(
        &self,
        t: f64,
        drive_states: &[T],
        workspace: &mut MachineWorkspace<T>,
    ) -> Result<(), DynamicsError> {
        for (d, drive) in self.drives.iter().enumerate() {
            let state = drive.state.map(|s| drive_states[s]);
            let input =
                self.model
                    .eval_magnitude(drive.load, &drive.input, t, &mut workspace.inner)?;
            let [_, speed, _] = workspace.inner.states().coordinate(drive.measured);
            let (force, rate) = drive.eval(input + workspace.input_offsets[d], speed, state);
            workspace.drive_forces[d] = force;
            workspace.inner.set_magnitude(drive.load, force);
            if let Some(s) = drive.state {
                workspace.drive_state_rates[s] = rate;
            }
        }
        Ok(())
    }

    /// Adds the rotors: N² J times the unit-load responses of their drives and s̈ = S q̈ + bias acceleration.
    pub(super) fn add_rotor_inertia<T: Scalar>(
        &self,
        workspace: &mut MachineWorkspace<T>,
    ) -> Result<(), DynamicsError> {
        workspace.inner.update_body_accelerations(&self.model);
        for drive in self
            .drives
            .iter()
            .filter(|drive| drive.reflected_inertia > 0.0)
        {
            let [_, _, bias_acceleration] = workspace.inner.states().coordinate(drive.measured);
            self.model.unit_load_response(
                drive.load,
                &mut workspace.inner,
                &mut workspace.rotor_response,
            )?;
            let inertia = T::from_f64(drive.reflected_inertia);
            add_scaled(
                &mut workspace.inverse_dynamics,
                &workspace.rotor_response,
                -(inertia * bias_acceleration),
            );
            for (acceleration_response, &i) in
                workspace.acceleration_responses.iter_mut().zip(&self.free)
            {
                // S = −τ of the unit-load response: virtual work.
                add_scaled(
                    acceleration_response,
                    &workspace.rotor_response,
                    inertia * workspace.rotor_response.tau[i],
                );
            }
        }
        Ok(())
    }

    /// The drives' forces without those that accelerate their rotors, once the accelerations are known.
    pub(super) fn resolve_drive_forces<T: Scalar>(
        &self,
        workspace: &mut MachineWorkspace<T>,
    ) -> Result<(), DynamicsError> {
        if self
            .drives
            .iter()
            .all(|drive| drive.reflected_inertia == 0.0)
        {
            return Ok(());
        }
        self.model
            .set_accelerations(&workspace.q_ddot, &mut workspace.inner);
        self.set_net_drive_forces(workspace)
    }

    /// Sets the drives' forces less N² J s̈ at the accelerations in `workspace`.
    pub(super) fn set_net_drive_forces<T: Scalar>(
        &self,
        workspace: &mut MachineWorkspace<T>,
    ) -> Result<(), DynamicsError> {
        for (drive, &force) in self.drives.iter().zip(&workspace.drive_forces) {
            let [_, _, s_ddot] = workspace.inner.states().coordinate(drive.measured);
            let net_force = force - T::from_f64(drive.reflected_inertia) * s_ddot;
            workspace.inner.set_magnitude(drive.load, net_force);
        }
        Ok(self.model.update_load_wrenches(&mut workspace.inner)?)
    }
}
