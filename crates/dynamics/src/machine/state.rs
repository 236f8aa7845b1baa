//! A machine at one time and state, evaluated.

use super::workspace::EquationWorkspace;
use super::{Machine, MachineWorkspace, MovingModel, NonconservativeSource};
use crate::error::Result;
use dwell_geometry::body_states::BodyStates;
use dwell_kinetostatics::{EvaluatedState, ForceState, InverseDynamics, KinematicState, Model};
use dwell_numerics::Scalar;
use std::ops::Deref;

/// A machine at one time and state: the motion of all actuators, the drives' forces, the equation of motion solved.
#[derive(Debug)]
pub struct MachineState<'a, T: Scalar = f64, M: MovingModel = Model> {
    pub(super) machine: &'a Machine<M>,
    pub(super) t: f64,
    pub(super) forces: ForceState<'a, T, M>,
    pub(super) equation: &'a mut EquationWorkspace<T>,
}

impl<'a, T: Scalar, M: MovingModel> Deref for MachineState<'a, T, M> {
    type Target = KinematicState<'a, T, M>;

    fn deref(&self) -> &Self::Target {
        &self.forces
    }
}

impl<T: Scalar, M: MovingModel> MachineState<'_, T, M> {
    /// By actuator: its coordinate, rad or m.
    pub fn q(&self) -> &[T] {
        &self.equation.q
    }

    /// By actuator: its speed, per s.
    pub fn q_dot(&self) -> &[T] {
        &self.equation.q_dot
    }

    /// By actuator: its acceleration, per s².
    pub fn q_ddot(&self) -> &[T] {
        &self.equation.q_ddot
    }

    /// By drive: its force, N·m or N, before that which accelerates its rotor is taken off.
    pub fn drive_forces(&self) -> &[T] {
        &self.equation.drive_forces
    }

    /// By drive: its force on the bodies, N·m or N, without that which accelerates its rotor.
    pub fn net_drive_forces(&self) -> impl Iterator<Item = T> + '_ {
        let magnitudes = self.forces.magnitudes();
        self.machine
            .drives
            .iter()
            .map(|drive| magnitudes[drive.load])
    }

    /// The magnitudes of the loads, in the units of their kinds.
    pub fn magnitudes(&self) -> &[T] {
        self.forces.magnitudes()
    }

    /// The actuators' forces (zero on free coordinates) and the reactions of the machine's own model; none within the
    /// window of a change-point fit.
    pub fn inverse_dynamics(&self) -> &InverseDynamics<T> {
        &self.equation.inverse_dynamics
    }

    /// A coordinate with its rate and its acceleration, rad or m, per s and s².
    pub fn coordinate_with_acceleration(&mut self, of: M::CoordinateFunction) -> [T; 3] {
        self.accelerate_bodies();
        self.forces.coordinate_motion(of)
    }

    /// Sets the accelerations of the bodies to those of the motion.
    fn accelerate_bodies(&mut self) {
        if self.machine.fit_at(self.equation.q.first()).is_some() {
            // With the accelerations of the fit.
            self.forces.update_bodies();
        } else {
            self.forces.accelerate(&self.equation.q_ddot);
        }
    }

    /// ẏ, into `out` of length [`Machine::state_count`].
    pub fn derivative(&self, out: &mut [T]) {
        let (machine, equation) = (self.machine, &*self.equation);
        let n = machine.free.len();
        for (k, &i) in machine.free.iter().enumerate() {
            out[k] = equation.q_dot[i];
            out[n + k] = equation.q_ddot[i];
        }
        let (drive_state_rates, rest) = out[2 * n..].split_at_mut(machine.drive_state_count);
        let (mode_rates, powers) = rest.split_at_mut(machine.contact_count());
        mode_rates.fill(T::from_f64(0.0));
        drive_state_rates.copy_from_slice(&equation.drive_state_rates);
        for (power, &source) in powers.iter_mut().zip(&machine.nonconservative_sources) {
            *power = match source {
                NonconservativeSource::Load(load) => self.forces.load_power(load),
                NonconservativeSource::Loads => {
                    let powers = machine.summed_loads.iter();
                    let powers = powers.map(|&load| self.forces.load_power(load));
                    powers.fold(T::from_f64(0.0), |sum, power| sum + power)
                }
                NonconservativeSource::Drive(d) => {
                    let [_, speed] = self.coordinate(machine.drives[d].measured);
                    equation.drive_forces[d] * speed
                }
                NonconservativeSource::Stop(stop) => {
                    let sides = machine.stops.iter().zip(&equation.stop_forces);
                    let own = sides.filter(|(side, _)| side.stop == stop);
                    own.fold(T::from_f64(0.0), |sum, (side, force)| {
                        sum + *force * equation.q_dot[side.actuator]
                    })
                }
                NonconservativeSource::Prescribed(i) => {
                    equation.inverse_dynamics.tau[i] * equation.q_dot[i]
                }
            };
        }
    }
}

impl<T: Scalar> MachineState<'_, T> {
    /// The states of the bodies.
    pub fn bodies(&mut self) -> &BodyStates<T> {
        self.accelerate_bodies();
        self.forces.bodies_as_they_are()
    }
}

impl<M: MovingModel> Machine<M> {
    /// [`MachineState::energy`] at time `t` (s) and state `y`, without computing forces.
    ///
    /// # Errors
    /// [`DynamicsError`](crate::DynamicsError) where there is no pose.
    pub fn energy(
        &self,
        t: f64,
        y: &[f64],
        workspace: &mut MachineWorkspace<f64, M>,
    ) -> Result<[f64; 2]> {
        if !self.fit_windows.is_empty() {
            return Ok(self.evaluate(t, y, workspace)?.energy());
        }
        let MachineWorkspace {
            inner, equation, ..
        } = workspace;
        self.set_actuator_motion(t, y, equation);
        let at = [&equation.q[..], &equation.q_dot[..]];
        let state = KinematicState::new(&self.model, at, inner)?;
        Ok(self.energy_of(&state, &equation.q_dot))
    }

    /// The kinetic and the potential energy of a state at speeds of the coordinates, J.
    fn energy_of(&self, state: &KinematicState<'_, f64, M>, q_dot: &[f64]) -> [f64; 2] {
        let rotors = self.drives.iter().map(|drive| {
            let [_, speed] = state.coordinate(drive.measured);
            0.5 * drive.reflected_inertia * speed * speed
        });
        let wheels = self.free.iter().zip(&self.flywheels);
        let wheels = wheels.map(|(&i, inertia)| 0.5 * inertia * q_dot[i] * q_dot[i]);
        let kinetic = state.kinetic_energy() + rotors.sum::<f64>() + wheels.sum::<f64>();
        let loads = 0..self.model.loads().len();
        let potentials = loads.filter_map(|load| state.potential_energy(load));
        [kinetic, potentials.sum()]
    }
}

impl<M: MovingModel> MachineState<'_, f64, M> {
    /// The kinetic energy, with that of rotors and flywheels, and the potential of the conservative loads, J.
    pub fn energy(&self) -> [f64; 2] {
        self.machine.energy_of(&self.forces, &self.equation.q_dot)
    }

    /// The impulses that changes of the free coordinates' speeds take: by actuator, along its coordinate, N·m·s or N·s; by
    /// reaction of the machine's model.
    pub fn impulses(&self, changes: &[f64]) -> InverseDynamics<f64> {
        let mut sum = self.machine.model.result_buffer();
        let columns = self.equation.acceleration_responses.iter();
        for (column, change) in columns.zip(changes) {
            sum.add_scaled(column, *change);
        }
        sum
    }

    /// Evaluates another model of the same mechanism and loads at this state: its reactions are then
    /// in `result`. Within the window of a change-point
    /// fit, a reaction that is not determined at the change point is NaN.
    ///
    /// # Errors
    /// [`DynamicsError`](crate::DynamicsError) as of [`Machine::evaluate`].
    pub fn outputs<'o>(
        &self,
        output_model: &'o M,
        workspace: &'o mut M::Workspace<f64>,
        result: &'o mut InverseDynamics<f64>,
    ) -> Result<EvaluatedState<'o, f64, M>> {
        if let Some(fit) = self.machine.fit_at(self.equation.q.first()) {
            return M::outputs_on_fit(self, fit, output_model, workspace, result);
        }
        let equation = &*self.equation;
        let at = [&equation.q[..], &equation.q_dot[..]];
        let mut state = KinematicState::new(output_model, at, workspace)?.apply_loads(self.t)?;
        for load in self.machine.given_loads() {
            state.set_magnitude(load, self.magnitudes()[load]);
        }
        Ok(state.evaluate(&equation.q_ddot, result)?)
    }
}
