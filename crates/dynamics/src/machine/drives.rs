//! Drives and their rotors in the equation of motion.

use super::workspace::EquationWorkspace;
use super::{Machine, MachineState, MachineWorkspace, MovingModel};
use crate::drive::CompiledDrive;
use crate::error::Result;
use crate::state_switches::{HeldSource, SourceState, StateSwitches, signal_value};
use dwell_kinetostatics::{ForceState, KinematicState, KinetostaticsError, LoadedState, Signal};
use dwell_numerics::Scalar;

/// The switches of all loads and drives.
pub(super) fn state_switches<M: MovingModel>(
    model: &M,
    drives: &[CompiledDrive<M>],
) -> StateSwitches {
    let loads = model.loads().iter().enumerate();
    let loads = loads.map(|(l, load)| (l, &load.magnitude, None));
    let drives = drives.iter();
    StateSwitches::of(loads.chain(drives.map(|d| (d.load, &d.input, Some(d)))))
}

impl<M: MovingModel> Machine<M> {
    /// The values of all switching functions on the pieces that are held, and the variables of the loads: for them no force is computed.
    pub(crate) fn switch_values(
        &self,
        t: f64,
        y: &[f64],
        workspace: &mut MachineWorkspace<f64, M>,
        held: &[HeldSource],
        seen: &mut Vec<f64>,
        out: &mut [f64],
    ) -> Result<()> {
        let mut values = |state: &KinematicState<'_, f64, M>| {
            let source_state = |load: usize, signals: &mut Vec<f64>| {
                let of_load = self.model.compiled_signals(load).iter();
                let value = |&signal| signal_value(signal, t, |c| state.coordinate(c));
                signals.extend(of_load.map(value));
                self.source_state(load, state, y)
            };
            self.state_switches.values(held, seen, source_state, out);
        };
        self.set_actuator_motion(t, y, &mut workspace.equation);
        if self.fit_at(workspace.equation.q.first()).is_some() {
            values(&*self.evaluate(t, y, workspace)?);
            return Ok(());
        }
        let MachineWorkspace {
            inner, equation, ..
        } = workspace;
        let at = [&equation.q[..], &equation.q_dot[..]];
        values(&KinematicState::new(&self.model, at, inner)?);
        Ok(())
    }

    /// A load, or the drive that acts by it, at a state.
    fn source_state(
        &self,
        load: usize,
        state: &KinematicState<'_, f64, M>,
        y: &[f64],
    ) -> SourceState<'_, M> {
        let drive = self.drives.iter().find(|drive| drive.load == load);
        let magnitude = match drive {
            Some(drive) => &drive.input,
            None => &self.model.loads()[load].magnitude,
        };
        let drive_states = &y[2 * self.free.len()..];
        let drive = drive.map(|drive| {
            let [_, speed] = state.coordinate(drive.measured);
            (drive, speed, drive.state.map(|s| drive_states[s]))
        });
        SourceState { magnitude, drive }
    }

    /// The values and rates of all switching functions where the states have these rates, on the pieces that are held in
    /// the workspace and in `held`.
    pub(crate) fn switch_rates(
        &self,
        t: f64,
        y: &[f64],
        rates: &[f64],
        workspace: &mut MachineWorkspace<f64, M>,
        held: &[HeldSource],
        out: &mut [[f64; 2]],
    ) -> Result<()> {
        let mut state = self.evaluate(t, y, workspace)?;
        let of_drives = 2 * self.free.len();
        let moving =
            |state: &mut MachineState<'_, f64, M>, of| state.coordinate_with_acceleration(of);
        let source_state = |load: usize, signals: &mut Vec<[f64; 2]>| {
            for signal in self.model.compiled_signals(load) {
                signals.push(match *signal {
                    Signal::Time => [t, 1.0],
                    Signal::Value(of) => {
                        let [value, speed, _] = moving(&mut state, of);
                        [value, speed]
                    }
                    Signal::Velocity(of) => {
                        let [_, speed, acceleration] = moving(&mut state, of);
                        [speed, acceleration]
                    }
                });
            }
            let mut of_drive = [0.0; 2];
            if let Some(drive) = self.drives.iter().find(|drive| drive.load == load) {
                let [_, _, acceleration] = moving(&mut state, drive.measured);
                let state_rate = drive.state.map_or(0.0, |s| rates[of_drives + s]);
                of_drive = [acceleration, state_rate];
            }
            (self.source_state(load, &state, y), of_drive)
        };
        self.state_switches.rates(held, source_state, out);
        Ok(())
    }

    /// Holds a load and its drive on their pieces.
    pub(crate) fn hold_source<T: Scalar>(
        &self,
        load: usize,
        held: &HeldSource,
        workspace: &mut MachineWorkspace<T, M>,
    ) {
        M::held_pieces(&mut workspace.inner, load).clone_from(&held.magnitude);
        if let Some(d) = self.drives.iter().position(|drive| drive.load == load) {
            workspace.equation.held_drives[d] = held.drive;
        }
    }

    /// Whether a drive has a rotor, whose inertia resists.
    pub(super) fn has_rotors(&self) -> bool {
        let mut drives = self.drives.iter();
        drives.any(|drive| drive.reflected_inertia > 0.0)
    }

    /// Evaluates the drives' forces and the rates of their states.
    ///
    /// # Errors
    /// [`DynamicsError::Load`](crate::DynamicsError::Load) where a drive's input has no finite value.
    pub(super) fn evaluate_drives<T: Scalar>(
        &self,
        t: f64,
        drive_states: &[T],
        input_offsets: &[T],
        state: &mut LoadedState<'_, T, M>,
        equation: &mut EquationWorkspace<T>,
    ) -> Result<()> {
        for (d, drive) in self.drives.iter().enumerate() {
            let drive_state = drive.state.map(|s| drive_states[s]);
            let input = state.eval_magnitude(drive.load, &drive.input, t)?;
            let [_, speed] = state.coordinate(drive.measured);
            let held = equation.held_drives[d];
            let (force, rate) = drive.eval(input + input_offsets[d], speed, drive_state, held);
            equation.drive_forces[d] = force;
            state.set_magnitude(drive.load, force);
            if let Some(s) = drive.state {
                equation.drive_state_rates[s] = rate;
            }
        }
        Ok(())
    }

    /// Reads the accelerations of the drives' coordinates.
    pub(super) fn read_drive_accelerations<T: Scalar>(
        &self,
        state: &KinematicState<'_, T, M>,
        equation: &mut EquationWorkspace<T>,
    ) {
        for (drive, acceleration) in self.drives.iter().zip(&mut equation.drive_accelerations) {
            [_, _, *acceleration] = state.coordinate_motion(drive.measured);
        }
    }

    /// Adds the rotors: N² J times the unit-load responses of their drives and s̈ = S q̈ + bias acceleration.
    pub(super) fn add_rotor_inertia<T: Scalar>(
        &self,
        state: &mut ForceState<'_, T, M>,
        equation: &mut EquationWorkspace<T>,
    ) -> Result<()> {
        state.update_bodies();
        self.read_drive_accelerations(state, equation);
        for (drive, &bias) in self.drives.iter().zip(&equation.drive_accelerations) {
            if drive.reflected_inertia <= 0.0 {
                continue;
            }
            let response = &mut equation.rotor_response;
            state.unit_load_response(drive.load, response)?;
            let inertia = T::from_f64(drive.reflected_inertia);
            let result = &mut equation.inverse_dynamics;
            result.add_scaled(response, -(inertia * bias));
            for (column, &i) in equation.acceleration_responses.iter_mut().zip(&self.free) {
                // S = −τ of the unit-load response: virtual work.
                column.add_scaled(response, inertia * response.tau[i]);
            }
        }
        Ok(())
    }

    /// The drives' forces without those that accelerate their rotors, at `drive_accelerations`.
    pub(super) fn set_net_drive_forces<T: Scalar>(
        &self,
        state: &mut ForceState<'_, T, M>,
        equation: &EquationWorkspace<T>,
    ) -> Result<(), KinetostaticsError> {
        let drives = self.drives.iter().zip(&equation.drive_forces);
        let drives = drives.zip(&equation.drive_accelerations);
        state.set_magnitudes(drives.map(|((drive, &force), &s_ddot)| {
            let inertia = T::from_f64(drive.reflected_inertia);
            (drive.load, force - inertia * s_ddot)
        }))
    }
}
