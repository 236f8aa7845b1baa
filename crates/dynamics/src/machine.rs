//! A machine: a mechanism of any number of coordinates under loads and drives, some of them free, the
//! others prescribed functions of time.
//!
//! ```text
//! Σⱼ Mᵢⱼ q̈ⱼ + cᵢ(q, q̇) = Qᵢ(t, q, q̇)          i, j free                    (1)
//! ```
//!
//! c − Q is the inverse dynamics under all loads with the prescribed accelerations and zero free ones; the columns
//! of M are the responses to unit accelerations. A drive is a load along its coordinate s, and a rotor resists s̈
//! through the drive's unit-load response. τ of a free coordinate is zero. Friction depends on the reactions, and
//! these on q̈: the effect of each friction on the accelerations is added to its unit-load response before
//! [`Model::solve_friction`] solves for all of them.
//!
//! The state is [q, q̇ of the free coordinates; currents and integrals of the drives; work of the nonconservative
//! sources], so that the energy balance is integrated with the motion.

mod drives;
mod on_fit;
mod workspace;

use crate::change_point_fit::FitWindow;
use crate::drive::{CompiledDrive, DriveError};
use crate::error::DynamicsError;
use dwell_geometry::Mechanism;
use dwell_kinetostatics::{
    Drive, ForceSource, InverseDynamics, Load, LoadError, Model, Signal, Workspace,
};
use dwell_laws::Law;
use dwell_numerics::{Scalar, lu};
pub use workspace::MachineWorkspace;

/// How a coordinate moves.
#[derive(Debug, Clone, PartialEq)]
pub enum CoordinateMode {
    /// Moved by loads and drives.
    Free,
    /// A law of time.
    Prescribed(Law),
}

/// Something that does work for which no potential accounts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NonconservativeSource {
    /// A load, by its index in the model.
    Load(usize),
    /// A drive, by its index in the machine.
    Drive(usize),
    /// The prescribed motion of an actuator.
    Prescribed(usize),
}

/// A machine: constant, shared between threads.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    pub(crate) model: Model,
    modes: Vec<CoordinateMode>,
    free: Vec<usize>,
    pub(crate) drives: Vec<CompiledDrive>,
    /// Number of the drives' states.
    drive_state_count: usize,
    nonconservative_sources: Vec<NonconservativeSource>,
    /// Where it crosses change points.
    pub(crate) fit_windows: Vec<FitWindow>,
    /// By free coordinate: inertia along it beside that of the bodies and rotors, kg m² or kg.
    pub(crate) flywheels: Vec<f64>,
}

/// Why a machine cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MachineError {
    /// A drive that cannot be used.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// A load that does not fit the mechanism.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The number of coordinate modes is not that of the actuators.
    #[error("there must be one coordinate mode, free or prescribed, for each actuator")]
    CoordinateModes,
}

impl Machine {
    /// A machine of a model (with the reactions that its frictions need) under loads and drives, with one mode for
    /// each actuator. The drives become the model's last loads.
    ///
    /// # Errors
    /// [`MachineError`] where they do not fit.
    pub fn new(
        model: Model,
        loads: &[Load],
        modes: Vec<CoordinateMode>,
        drives: &[Drive],
    ) -> Result<Self, MachineError> {
        if modes.len() != model.plan().actuators() {
            return Err(MachineError::CoordinateModes);
        }
        let is_free = |i: &usize| modes[*i] == CoordinateMode::Free;
        let free: Vec<usize> = (0..modes.len()).filter(is_free).collect();
        let all = loads_with_drives(model.mechanism(), loads, drives)?;
        let model = model.with_loads(all)?;
        let drives = CompiledDrive::compile_all(model.mechanism(), drives, loads.len())?;
        let nonconservative = (0..loads.len()).filter(|&l| !model.is_conservative(l));
        let mut sources: Vec<NonconservativeSource> =
            nonconservative.map(NonconservativeSource::Load).collect();
        sources.extend((0..drives.len()).map(NonconservativeSource::Drive));
        let prescribed = (0..modes.len()).filter(|i| !is_free(i));
        sources.extend(prescribed.map(NonconservativeSource::Prescribed));
        Ok(Self {
            drive_state_count: drives.iter().filter(|d| d.state.is_some()).count(),
            model,
            flywheels: vec![0.0; free.len()],
            modes,
            free,
            drives,
            nonconservative_sources: sources,
            fit_windows: Vec::new(),
        })
    }

    /// The model that moves.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The free coordinates, by actuator.
    pub fn free(&self) -> &[usize] {
        &self.free
    }

    /// Number of drives.
    pub fn drives(&self) -> usize {
        self.drives.len()
    }

    /// Whether the equation of motion depends on time explicitly.
    pub fn depends_on_time(&self) -> bool {
        let is_prescribed_in_time = self.modes.iter().any(|mode| match mode {
            CoordinateMode::Free => false,
            // A law whose derivatives are zero at two times counts as constant.
            CoordinateMode::Prescribed(law) => {
                [0.0, 0.7].iter().any(|&t| law.eval(t)[1..] != [0.0; 3])
            }
        });
        // The drives are among the loads.
        let mut loads = self.model.loads().iter();
        is_prescribed_in_time || loads.any(|load| load.magnitude.signals().contains(&Signal::Time))
    }

    /// The nonconservative sources, in the order of their works among the states.
    pub fn nonconservative_sources(&self) -> &[NonconservativeSource] {
        &self.nonconservative_sources
    }

    /// Number of states: 2 for each free coordinate, those of the drives, 1 for each nonconservative source.
    pub fn state_count(&self) -> usize {
        2 * self.free.len() + self.drive_state_count + self.nonconservative_sources.len()
    }

    /// Index of the first work among the states.
    pub fn work_offset(&self) -> usize {
        2 * self.free.len() + self.drive_state_count
    }

    /// An initial state from the coordinates and speeds of all actuators (rad or m, per s), with zero drive states
    /// and zero works.
    pub fn initial_state(&self, q: &[f64], q_dot: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.state_count()];
        for (k, &i) in self.free.iter().enumerate() {
            y[k] = q[i];
            y[self.free.len() + k] = q_dot[i];
        }
        y
    }

    /// Evaluates the machine at time `t` (s) and state `y`: coordinates, speeds and accelerations of all
    /// actuators, the drives' forces and the states of bodies and loads are then in `workspace`.
    ///
    /// # Errors
    /// [`DynamicsError`] where there is no pose, no inertia, or friction jams.
    pub fn evaluate<T: Scalar>(
        &self,
        t: f64,
        y: &[T],
        workspace: &mut MachineWorkspace<T>,
    ) -> Result<(), DynamicsError> {
        let n = self.free.len();
        self.set_actuator_motion(t, y, workspace);
        if let Some(fit) = self.fit_at(workspace.q.first()) {
            return self.evaluate_on_fit(fit, t, &y[2 * n..], workspace);
        }
        self.model
            .set_state(t, &workspace.q, &workspace.q_dot, &mut workspace.inner)?;
        self.evaluate_drives(t, &y[2 * n..], workspace)?;
        self.model.loaded_inverse_dynamics(
            &workspace.q_ddot,
            &mut workspace.inner,
            &mut workspace.inverse_dynamics,
        )?;
        for (k, &i) in self.free.iter().enumerate() {
            self.model.mass_matrix_column(
                i,
                &mut workspace.inner,
                &mut workspace.acceleration_responses[k],
            );
        }
        if self
            .drives
            .iter()
            .any(|drive| drive.reflected_inertia > 0.0)
        {
            self.add_rotor_inertia(workspace)?;
        }
        for ((acceleration_response, &i), &inertia) in workspace
            .acceleration_responses
            .iter_mut()
            .zip(&self.free)
            .zip(&self.flywheels)
        {
            acceleration_response.tau[i] += T::from_f64(inertia);
        }
        for (k, &i) in self.free.iter().enumerate() {
            workspace.free_accelerations[k] = -workspace.inverse_dynamics.tau[i];
            for (column, acceleration_response) in
                workspace.acceleration_responses.iter().enumerate()
            {
                workspace.mass_matrix[k * n + column] = acceleration_response.tau[i];
            }
        }
        self.solve_accelerations(workspace)?;
        self.resolve_drive_forces(workspace)
    }

    /// Sets coordinates and speeds of all actuators, and the accelerations of the prescribed ones.
    fn set_actuator_motion<T: Scalar>(&self, t: f64, y: &[T], workspace: &mut MachineWorkspace<T>) {
        let n = self.free.len();
        let mut k = 0;
        for (i, mode) in self.modes.iter().enumerate() {
            match mode {
                CoordinateMode::Free => {
                    workspace.q[i] = y[k];
                    workspace.q_dot[i] = y[n + k];
                    workspace.q_ddot[i] = T::from_f64(0.0);
                    k += 1;
                }
                CoordinateMode::Prescribed(law) => {
                    let [q, q_dot, q_ddot, _] = law.eval(t).map(T::from_f64);
                    workspace.q[i] = q;
                    workspace.q_dot[i] = q_dot;
                    workspace.q_ddot[i] = q_ddot;
                }
            }
        }
    }

    /// Solves (1) for the free accelerations, with the frictions.
    fn solve_accelerations<T: Scalar>(
        &self,
        workspace: &mut MachineWorkspace<T>,
    ) -> Result<(), DynamicsError> {
        let MachineWorkspace {
            inner,
            inverse_dynamics: result,
            acceleration_responses,
            friction_responses,
            friction_accelerations,
            mass_matrix,
            pivots,
            free_accelerations,
            ..
        } = workspace;
        let diagonal = mass_matrix.first().map_or(1.0, |m| m.value());
        let factored = lu::factor(mass_matrix, pivots);
        let inertia = factored.determinant_sign > 0.0 && factored.pivot_ratio > 0.0;
        let resists = inertia && diagonal > 0.0 && diagonal.is_finite();
        if !(self.free.is_empty() || resists) {
            return Err(DynamicsError::NoInertia {
                q: workspace.q[self.free[0]].value(),
                m: diagonal,
            });
        }
        lu::solve(mass_matrix, pivots, free_accelerations);
        for (load, (friction_response, unit_accelerations)) in self
            .model
            .frictions()
            .zip(friction_responses.iter_mut().zip(friction_accelerations))
        {
            self.model
                .unit_load_response(load, inner, friction_response)?;
            for (value, &i) in unit_accelerations.iter_mut().zip(&self.free) {
                *value = -friction_response.tau[i];
            }
            lu::solve(mass_matrix, pivots, unit_accelerations);
            for (acceleration_response, &q_ddot) in
                acceleration_responses.iter().zip(unit_accelerations.iter())
            {
                add_scaled(friction_response, acceleration_response, q_ddot);
            }
        }
        for (acceleration_response, &q_ddot) in
            acceleration_responses.iter().zip(free_accelerations.iter())
        {
            add_scaled(result, acceleration_response, q_ddot);
        }
        if self.model.frictions().len() > 0 {
            self.model
                .solve_friction(&result.reactions, friction_responses, inner)?;
        }
        for (k, &i) in self.free.iter().enumerate() {
            let mut q_ddot = workspace.free_accelerations[k];
            for (unit_accelerations, load) in workspace
                .friction_accelerations
                .iter()
                .zip(self.model.frictions())
            {
                q_ddot += unit_accelerations[k] * workspace.inner.loads().magnitude[load];
            }
            workspace.q_ddot[i] = q_ddot;
        }
        for (friction_response, load) in workspace
            .friction_responses
            .iter()
            .zip(self.model.frictions())
        {
            add_scaled(
                &mut workspace.inverse_dynamics,
                friction_response,
                workspace.inner.loads().magnitude[load],
            );
        }
        Ok(())
    }

    /// ẏ of the state evaluated last, into `out` of length [`Machine::state_count`].
    pub fn state_derivative<T: Scalar>(&self, workspace: &MachineWorkspace<T>, out: &mut [T]) {
        let n = self.free.len();
        for (k, &i) in self.free.iter().enumerate() {
            out[k] = workspace.q_dot[i];
            out[n + k] = workspace.q_ddot[i];
        }
        let (drive_state_rates, powers) = out[2 * n..].split_at_mut(self.drive_state_count);
        drive_state_rates.copy_from_slice(&workspace.drive_state_rates);
        for (power, &source) in powers.iter_mut().zip(&self.nonconservative_sources) {
            *power = match source {
                NonconservativeSource::Load(load) => {
                    let mut sum = T::from_f64(0.0);
                    for wrench in &workspace.inner.loads().wrenches {
                        if wrench.source == ForceSource::Load(load) {
                            sum += wrench.power(workspace.inner.states());
                        }
                    }
                    sum
                }
                NonconservativeSource::Drive(d) => {
                    let [_, speed, _] =
                        workspace.inner.states().coordinate(self.drives[d].measured);
                    workspace.drive_forces[d] * speed
                }
                NonconservativeSource::Prescribed(i) => {
                    workspace.inverse_dynamics.tau[i] * workspace.q_dot[i]
                }
            };
        }
    }

    /// Evaluates another model of the same mechanism and loads at the state evaluated last: its reactions are then
    /// in `result`, the states of its bodies and loads in `output_workspace`. Within the window of a change-point
    /// fit, a reaction that is not determined at the change point is not a number.
    ///
    /// # Errors
    /// [`DynamicsError`] as of [`Machine::evaluate`].
    pub fn evaluate_outputs(
        &self,
        output_model: &Model,
        t: f64,
        workspace: &MachineWorkspace<f64>,
        output_workspace: &mut Workspace<f64>,
        result: &mut InverseDynamics<f64>,
    ) -> Result<(), DynamicsError> {
        for drive in &self.drives {
            output_workspace
                .set_magnitude(drive.load, workspace.inner.loads().magnitude[drive.load]);
        }
        if let Some((fit, x)) = self.fit_at(workspace.q.first()) {
            return on_fit::evaluate_outputs(
                (fit, x),
                output_model,
                t,
                workspace,
                output_workspace,
                result,
            );
        }
        Ok(output_model.kinetostatics(
            t,
            &workspace.q,
            &workspace.q_dot,
            &workspace.q_ddot,
            output_workspace,
            result,
        )?)
    }

    /// The kinetic energy, with that of rotors and flywheels, and the potential of the conservative loads, J, at the
    /// state evaluated last.
    pub fn energy(&self, workspace: &MachineWorkspace<f64>) -> [f64; 2] {
        let rotors = self.drives.iter().map(|drive| {
            let [_, speed, _] = workspace.inner.states().coordinate(drive.measured);
            0.5 * drive.reflected_inertia * speed * speed
        });
        let wheels = self.free.iter().zip(&self.flywheels).map(|(&i, inertia)| {
            let speed = workspace.q_dot[i];
            0.5 * inertia * speed * speed
        });
        let kinetic =
            self.model.kinetic_energy(&workspace.inner) + rotors.sum::<f64>() + wheels.sum::<f64>();
        let potentials = (0..self.model.loads().len())
            .filter_map(|load| self.model.potential_energy(load, &workspace.inner));
        [kinetic, potentials.sum()]
    }
}

/// Adds a multiple of one response to another.
fn add_scaled<T: Scalar>(sum: &mut InverseDynamics<T>, other: &InverseDynamics<T>, factor: T) {
    for (sum, more) in sum.reactions.iter_mut().zip(&other.reactions) {
        *sum += *more * factor;
    }
    for (sum, more) in sum.tau.iter_mut().zip(&other.tau) {
        *sum += *more * factor;
    }
}

/// The loads, followed by those by which the drives act.
///
/// # Errors
/// The first drive whose coordinate the mechanism does not have.
pub fn loads_with_drives(
    mechanism: &Mechanism,
    loads: &[Load],
    drives: &[Drive],
) -> Result<Vec<Load>, DriveError> {
    let mut all = loads.to_vec();
    for (i, drive) in drives.iter().enumerate() {
        let wrong = |what| DriveError { drive: i, what };
        all.push(drive.load(mechanism).map_err(wrong)?);
    }
    Ok(all)
}
