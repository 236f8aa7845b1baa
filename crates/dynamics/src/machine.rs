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
//! [`ForceState::solve_friction`] solves for all of them; one that holds at rest is a [contact](crate::contact).
//!
//! The state is [q, q̇ of the free coordinates; currents and integrals of the drives; modes of the contacts; work of the nonconservative
//! sources], so that the energy balance is integrated with the motion.

mod contacts;
mod drives;
mod evaluated_in;
mod impact;
mod on_fit;
mod on_fit_in_space;
mod sliding;
mod state;
mod unloaded;
mod works;
mod workspace;

use crate::contact::{Contact, ContactMode, ContactProblem, Stop};
use crate::drive::{CompiledDrive, DriveError};
use crate::error::{DynamicsError, Result};
use crate::state_switches::StateSwitches;
use dwell_geometry::Mechanism;
use dwell_kinetostatics::{
    Drive, ForceState, KinematicState, Load, LoadError, Magnitude, Model, ModelLoad, Signal,
};
use dwell_laws::{Features, Law};
use dwell_numerics::{Scalar, lu};
pub use evaluated_in::EvaluatedIn;
pub use on_fit::MovingModel;
pub use on_fit_in_space::SpaceFitWindow;
pub use state::MachineState;
use std::sync::Arc;
pub use works::NonconservativeSource;
pub use workspace::{EquationWorkspace, MachineWorkspace};

/// How a coordinate moves.
#[derive(Debug, Clone, PartialEq)]
pub enum CoordinateMode {
    /// Moved by loads and drives.
    Free,
    /// A law of time.
    Prescribed(Law),
}

/// A machine, in the plane or in space: constant, shared between threads.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine<M: MovingModel = Model> {
    pub(crate) model: M,
    modes: Vec<CoordinateMode>,
    free: Vec<usize>,
    pub(crate) drives: Vec<CompiledDrive<M>>,
    /// Where loads, drives and prescribed motions switch and vary in time.
    pub(crate) time_features: Arc<Features>,
    /// Where loads and drives switch as coordinates and speeds move.
    pub(crate) state_switches: StateSwitches,
    /// Number of the drives' states.
    drive_state_count: usize,
    nonconservative_sources: Vec<NonconservativeSource>,
    /// The loads of [`NonconservativeSource::Loads`].
    pub(crate) summed_loads: Vec<usize>,
    /// The windows in which it crosses change points.
    pub(crate) fit_windows: Vec<M::FitWindow>,
    /// Frictions that hold at rest.
    pub(crate) contacts: Vec<Contact<M::CoordinateFunction>>,
    /// The sides of the end stops.
    pub(crate) stops: Vec<Stop>,
    /// By free coordinate: inertia along it in addition to that of the bodies and rotors, kg m² or kg.
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
    /// An end stop whose coordinate is not free, or whose numbers cannot be used.
    #[error(
        "end stop {0}: its coordinate must be free, its limits ascending, its restitution from 0 to 1, its stiffness \
         above zero, its damping not below"
    )]
    Stop(usize),
    /// The number of coordinate modes is not that of the actuators.
    #[error("there must be one coordinate mode, free or prescribed, for each actuator")]
    CoordinateModes,
}

impl<M: MovingModel> Machine<M> {
    /// A machine of a model (with the reactions that its frictions need) under loads and drives, with one mode for
    /// each actuator. The drives become the model's last loads.
    ///
    /// # Errors
    /// [`MachineError`] where they do not fit.
    pub fn new(
        model: M,
        loads: &[ModelLoad<M>],
        modes: Vec<CoordinateMode>,
        drives: &[Drive<M::Coordinate>],
    ) -> Result<Self, MachineError> {
        if modes.len() != model.actuators() {
            return Err(MachineError::CoordinateModes);
        }
        let is_free = |i: &usize| modes[*i] == CoordinateMode::Free;
        let free: Vec<usize> = (0..modes.len()).filter(is_free).collect();
        let mut all = loads.to_vec();
        for (i, drive) in drives.iter().enumerate() {
            let wrong = |what| DriveError { drive: i, what };
            all.push(model.drive_load(drive).map_err(wrong)?);
        }
        let model = model.with_loads(all)?;
        let drives = CompiledDrive::compile_all(&model, drives, loads.len())?;
        let nonconservative = (0..loads.len()).filter(|&l| !model.is_conservative(l));
        let (mut sources, summed_loads) = works::of_loads(nonconservative.collect());
        sources.extend((0..drives.len()).map(NonconservativeSource::Drive));
        let prescribed = (0..modes.len()).filter(|i| !is_free(i));
        sources.extend(prescribed.map(NonconservativeSource::Prescribed));
        Ok(Self {
            time_features: Arc::new(time_features(&model, &drives, &modes)),
            state_switches: drives::state_switches(&model, &drives),
            drive_state_count: drives.iter().filter(|d| d.state.is_some()).count(),
            // Where everything is prescribed nothing can be held.
            contacts: if free.is_empty() {
                Vec::new()
            } else {
                Contact::of_model(&model)
            },
            stops: Vec::new(),
            model,
            flywheels: vec![0.0; free.len()],
            modes,
            free,
            drives,
            nonconservative_sources: sources,
            summed_loads,
            fit_windows: Vec::new(),
        })
    }

    /// The model that moves.
    pub fn model(&self) -> &M {
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

    /// The sum of the works that the loads can do over the size of the mechanism, or over one radian, between two times
    /// (s), J. Of magnitudes that depend on the motion, only functions of time count. Dampers do not count.
    pub fn largest_work(&self, from: f64, to: f64) -> f64 {
        let drives = self.drives.iter().map(|drive| {
            // A voltage or a wanted speed is no force, but of the order of what it makes.
            let kind = self.model.loads()[drive.load].kind;
            (drive.load, kind, &drive.input)
        });
        let loads = self.model.loads().iter().enumerate();
        let loads = loads.map(|(l, load)| (l, load.kind, &load.magnitude));
        let works = loads.chain(drives).map(|(source, kind, magnitude)| {
            let largest = match magnitude {
                Magnitude::Constant(value) => value.abs(),
                Magnitude::Law(Signal::Time, law) => law.largest(from, to),
                Magnitude::Expression(..) => self.time_features.largest(source, from, to),
                Magnitude::Law(..)
                | Magnitude::Function(..)
                | Magnitude::Friction(_)
                | Magnitude::Separating(_)
                | Magnitude::External(_) => 0.0,
            };
            largest * self.model.work_lever(&kind)
        });
        works.sum()
    }

    /// The nonconservative sources, in the order of their works among the states.
    pub fn nonconservative_sources(&self) -> &[NonconservativeSource] {
        &self.nonconservative_sources
    }

    /// Number of states: 2 for each free coordinate, those of the drives, 1 for each friction that holds, 1 for each
    /// nonconservative source.
    pub fn state_count(&self) -> usize {
        self.work_offset() + self.nonconservative_sources.len()
    }

    /// Index of the first work among the states.
    pub fn work_offset(&self) -> usize {
        self.stop_states().end
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

    /// Evaluates the machine at time `t` (s) and state `y`.
    ///
    /// # Errors
    /// [`DynamicsError`] where there is no pose, no inertia, or friction jams.
    pub fn evaluate<'a, T: Scalar>(
        &'a self,
        t: f64,
        y: &[T],
        workspace: &'a mut MachineWorkspace<T, M>,
    ) -> Result<MachineState<'a, T, M>>
    where
        M: EvaluatedIn<T>,
    {
        M::evaluate_machine(self, t, y, workspace)
    }

    /// [`Self::evaluate`], compiled by [`EvaluatedIn`].
    fn evaluate_in<'a, T: Scalar>(
        &'a self,
        t: f64,
        y: &[T],
        workspace: &'a mut MachineWorkspace<T, M>,
    ) -> Result<MachineState<'a, T, M>> {
        let MachineWorkspace {
            inner,
            input_offsets: offsets,
            equation,
        } = workspace;
        let n = self.free.len();
        let drive_states = &y[2 * n..];
        let modes = equation.contacts.modes.iter_mut();
        for (mode, code) in modes.zip(&y[self.contact_states()]) {
            *mode = ContactMode::of_code(code.value());
        }
        if !self.stops.is_empty() {
            self.set_stops(y, equation);
        }
        self.set_actuator_motion(t, y, equation);
        let forces = if let Some(fit) = self.fit_at(equation.q.first()) {
            M::evaluate_on_fit(self, fit, (t, drive_states), (offsets, inner), equation)?
        } else {
            let at = [&equation.q[..], &equation.q_dot[..]];
            let mut state = KinematicState::new(&self.model, at, inner)?.apply_loads(t)?;
            self.evaluate_drives(t, drive_states, offsets, &mut state, equation)?;
            let result = &mut equation.inverse_dynamics;
            let mut state = state.inverse_dynamics(&equation.q_ddot, result)?;
            self.compose_equation(&mut state, equation)?;
            self.solve_accelerations(&mut state, equation)?;
            if self.has_rotors() {
                state.accelerate(&equation.q_ddot);
                self.read_drive_accelerations(&state, equation);
                self.set_net_drive_forces(&mut state, equation)?;
            }
            state
        };
        Ok(MachineState {
            machine: self,
            t,
            forces,
            equation,
        })
    }

    /// The mass matrix and the forces of (1), with rotors and flywheels.
    fn compose_equation<T: Scalar>(
        &self,
        state: &mut ForceState<'_, T, M>,
        equation: &mut EquationWorkspace<T>,
    ) -> Result<()> {
        let n = self.free.len();
        for (&i, column) in self.free.iter().zip(&mut equation.acceleration_responses) {
            state.mass_matrix_column(i, column);
        }
        if self.has_rotors() {
            self.add_rotor_inertia(state, equation)?;
        }
        let columns = equation.acceleration_responses.iter_mut();
        for ((column, &i), &inertia) in columns.zip(&self.free).zip(&self.flywheels) {
            column.tau[i] += T::from_f64(inertia);
        }
        for (k, &i) in self.free.iter().enumerate() {
            equation.free_accelerations[k] = -equation.inverse_dynamics.tau[i];
            for (j, column) in equation.acceleration_responses.iter().enumerate() {
                equation.mass_matrix[k * n + j] = column.tau[i];
            }
        }
        Ok(())
    }

    /// Sets coordinates and speeds of all actuators, and the accelerations of the prescribed ones.
    fn set_actuator_motion<T: Scalar>(&self, t: f64, y: &[T], equation: &mut EquationWorkspace<T>) {
        let n = self.free.len();
        let mut k = 0;
        for (i, mode) in self.modes.iter().enumerate() {
            match mode {
                CoordinateMode::Free => {
                    equation.q[i] = y[k];
                    equation.q_dot[i] = y[n + k];
                    equation.q_ddot[i] = T::from_f64(0.0);
                    k += 1;
                }
                CoordinateMode::Prescribed(law) => {
                    let [q, q_dot, q_ddot, _] = law.eval(t).map(T::from_f64);
                    equation.q[i] = q;
                    equation.q_dot[i] = q_dot;
                    equation.q_ddot[i] = q_ddot;
                }
            }
        }
    }

    /// Solves (1) for the free accelerations, with the frictions.
    // Long because all that the friction depends on is collected in one pass.
    fn solve_accelerations<T: Scalar>(
        &self,
        state: &mut ForceState<'_, T, M>,
        equation: &mut EquationWorkspace<T>,
    ) -> Result<()> {
        let EquationWorkspace {
            q,
            q_ddot,
            inverse_dynamics: result,
            acceleration_responses: columns,
            friction_responses,
            friction_accelerations,
            mass_matrix,
            pivots,
            free_accelerations,
            contacts,
            locked,
            stop_forces,
            ..
        } = equation;
        for (stop, force) in self.stops.iter().zip(stop_forces.iter()) {
            free_accelerations[stop.free] += *force;
        }
        if !self.stops.is_empty() {
            contacts::lock(locked, mass_matrix, free_accelerations);
        }
        let diagonal = mass_matrix.first().map_or(1.0, |m| m.value());
        let factored = lu::factor(mass_matrix, pivots);
        let inertia = factored.determinant_sign > 0.0 && factored.pivot_ratio > 0.0;
        let resists = inertia && diagonal > 0.0 && diagonal.is_finite();
        if !(self.free.is_empty() || resists) {
            return Err(DynamicsError::NoInertia {
                q: q[self.free[0]].value(),
                m: diagonal,
            });
        }
        lu::solve(mass_matrix, pivots, free_accelerations);
        let responses = friction_responses
            .iter_mut()
            .zip(&mut *friction_accelerations);
        for (j, (load, (response, accelerations))) in
            self.model.frictions().zip(responses).enumerate()
        {
            state.unit_load_response(load, response)?;
            for (value, &i) in accelerations.iter_mut().zip(&self.free) {
                *value = -response.tau[i];
            }
            if let Some(row) = contacts.rows.get_mut(j) {
                row.copy_from_slice(accelerations);
            }
            for (value, _) in accelerations
                .iter_mut()
                .zip(locked.iter())
                .filter(|(_, l)| **l)
            {
                *value = T::from_f64(0.0);
            }
            lu::solve(mass_matrix, pivots, accelerations);
            for (column, &q_ddot) in columns.iter().zip(accelerations.iter()) {
                response.add_scaled(column, q_ddot);
            }
        }
        for (column, &q_ddot) in columns.iter().zip(free_accelerations.iter()) {
            result.add_scaled(column, q_ddot);
        }
        if !self.contacts.is_empty() {
            let mut problem = ContactProblem {
                contacts: &self.contacts,
                state,
                workspace: contacts,
                unloaded: &result.reactions,
                responses: friction_responses,
            };
            let freedoms = locked.iter().filter(|locked| !**locked).count();
            problem.solve(free_accelerations, friction_accelerations, freedoms)?;
        } else if self.model.frictions().len() > 0 {
            state.solve_friction(&result.reactions, friction_responses)?;
        }
        let frictions = || self.model.frictions().map(|load| state.magnitudes()[load]);
        for (k, &i) in self.free.iter().enumerate() {
            q_ddot[i] = free_accelerations[k];
            for (accelerations, friction) in friction_accelerations.iter().zip(frictions()) {
                q_ddot[i] += accelerations[k] * friction;
            }
            if contacts.nothing_moves {
                q_ddot[i] = T::from_f64(0.0);
            }
        }
        for (response, friction) in friction_responses.iter().zip(frictions()) {
            result.add_scaled(response, friction);
        }
        Ok(())
    }
}

/// The functions of time of loads (those of the drives last), inputs of drives and prescribed motions; breakpoints of a program's functions.
fn time_features<M: MovingModel>(
    model: &M,
    drives: &[CompiledDrive<M>],
    modes: &[CoordinateMode],
) -> Features {
    let mut features = Features::default();
    let mut add = |source: usize, magnitude: &Magnitude<M::Coordinate>| match magnitude {
        Magnitude::Law(Signal::Time, law) => features.add_law(source, law),
        Magnitude::Expression(expression, signals) => {
            if let Some(time) = signals.iter().position(|s| matches!(s, Signal::Time)) {
                features.add_expression(source, expression, time);
            }
        }
        Magnitude::Function(function, signals) => {
            for (i, at) in function.breakpoints() {
                if matches!(signals.get(i), Some(Signal::Time)) {
                    features.add_knots(at, true);
                }
            }
        }
        Magnitude::Constant(_)
        | Magnitude::Law(..)
        | Magnitude::Friction(_)
        | Magnitude::Separating(_)
        | Magnitude::External(_) => {}
    };
    for (source, load) in model.loads().iter().enumerate() {
        add(source, &load.magnitude);
    }
    for drive in drives {
        add(drive.load, &drive.input);
    }
    for (i, mode) in modes.iter().enumerate() {
        if let CoordinateMode::Prescribed(law) = mode {
            features.add_law(model.loads().len() + i, law);
        }
    }
    features
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
