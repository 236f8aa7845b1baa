//! A machine: a mechanism of any number of coordinates under loads and drives, some of them free, the
//! others prescribed.
//!
//! ```text
//! Σⱼ Mᵢⱼ q̈ⱼ + cᵢ(q, q̇) = Qᵢ(t, q, q̇)          i, j free                    (1)
//! ```
//!
//! c − Q is what the loaded run finds at the prescribed accelerations and zero free ones, the columns of
//! M what the inertial runs find. A drive is a load along its coordinate; τ of a free coordinate is zero.
//! A rotor resists with what its channel makes of s̈. Friction depends on the reactions, those on q̈: what
//! each friction does to the accelerations is put into its channel before [`Model::rub`] solves for all.
//!
//! The state is [q, q̇ of the free coordinates; currents and integrals of the drives; work of what has no
//! potential], so that the energy balance is integrated with the motion.

use crate::bridge::{CrossWork, Span};
use crate::drive::{Drive, DriveError, Driven};
use crate::error::DynamicsError;
use dwell_geometry::{Mechanism, Scalar, small};
use dwell_kinetostatics::{Actions, By, Load, LoadError, Model, Signal, Workspace};
use dwell_laws::Law;

/// How a coordinate moves.
#[derive(Debug, Clone, PartialEq)]
pub enum Guidance {
    /// As loads and drives make it.
    Free,
    /// By a law of time.
    Prescribed(Law),
}

/// Something that does work and has no potential.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Worker {
    /// A load, by its place in the model.
    Load(usize),
    /// A drive, by its place in the machine.
    Drive(usize),
    /// The prescribed motion of an actuator.
    Prescribed(usize),
}

/// A machine: constant, shared between threads.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    pub(crate) model: Model,
    guidance: Vec<Guidance>,
    free: Vec<usize>,
    pub(crate) drives: Vec<Driven>,
    /// Number of the drives' states.
    memory: usize,
    workers: Vec<Worker>,
    /// Where it crosses change points.
    pub(crate) bridges: Vec<Span>,
    /// By free coordinate: inertia along it beside that of the bodies and rotors, kg m² or kg.
    pub(crate) flywheels: Vec<f64>,
}

/// Why a machine cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MachineError {
    /// A drive that makes no sense.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// A load that does not fit the mechanism.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// Not one guidance for each actuator.
    #[error("the guidances do not fit the actuators")]
    Guidance,
}

impl Machine {
    /// A machine of a model (with the reactions that its frictions need) under loads, one guidance for
    /// each actuator, and drives. The drives are the model's last loads.
    ///
    /// # Errors
    /// [`MachineError`] where they do not fit.
    pub fn new(
        mechanism: &Mechanism,
        model: Model,
        loads: &[Load],
        guidance: Vec<Guidance>,
        drives: &[Drive],
    ) -> Result<Self, MachineError> {
        if guidance.len() != model.plan().actuators() {
            return Err(MachineError::Guidance);
        }
        let is_free = |i: &usize| guidance[*i] == Guidance::Free;
        let free: Vec<usize> = (0..guidance.len()).filter(is_free).collect();
        let all = all_loads(mechanism, loads, drives)?;
        let model = model.with_loads(mechanism, all)?;
        let drives = Driven::all(mechanism, drives, loads.len())?;
        let lossy = (0..loads.len()).filter(|&l| !model.conservative(l));
        let mut workers: Vec<Worker> = lossy.map(Worker::Load).collect();
        workers.extend((0..drives.len()).map(Worker::Drive));
        let led = (0..guidance.len()).filter(|i| !is_free(i));
        workers.extend(led.map(Worker::Prescribed));
        Ok(Self {
            memory: drives.iter().filter(|d| d.state.is_some()).count(),
            model,
            flywheels: vec![0.0; free.len()],
            guidance,
            free,
            drives,
            workers,
            bridges: Vec::new(),
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

    /// Whether time itself has a say in the motion, beside the state.
    pub fn follows_time(&self) -> bool {
        let led = self.guidance.iter().any(|guidance| match guidance {
            Guidance::Free => false,
            // A law that stands still at two moments is a constant to all that follows.
            Guidance::Prescribed(law) => [0.0, 0.7].iter().any(|&t| law.at(t)[1..] != [0.0; 3]),
        });
        // Those of the drives are among them.
        let mut loads = self.model.loads().iter();
        led || loads.any(|load| load.magnitude.signals().contains(&Signal::Time))
    }

    /// What does work without a potential, in the order of the states.
    pub fn workers(&self) -> &[Worker] {
        &self.workers
    }

    /// Number of states: 2 for each free coordinate, those of the drives, one for each worker.
    pub fn states(&self) -> usize {
        2 * self.free.len() + self.memory + self.workers.len()
    }

    /// The place of the first worker's work among the states.
    pub fn first_work(&self) -> usize {
        2 * self.free.len() + self.memory
    }

    /// A state at rest of the drives with no work done yet, from the coordinates and speeds of all
    /// actuators.
    pub fn start(&self, q: &[f64], q_dot: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.states()];
        for (k, &i) in self.free.iter().enumerate() {
            y[k] = q[i];
            y[self.free.len() + k] = q_dot[i];
        }
        y
    }

    /// Working memory for one thread.
    pub fn work<T: Scalar>(&self) -> MachineWork<T> {
        let n = self.free.len();
        let zeros = |count| vec![T::lift(0.0); count];
        let actuators = self.guidance.len();
        MachineWork {
            inner: self.model.workspace(),
            q: zeros(actuators),
            q_dot: zeros(actuators),
            q_ddot: zeros(actuators),
            base: self.model.actions(),
            units: vec![self.model.actions(); n],
            rubs: vec![self.model.actions(); self.model.frictions().len()],
            answers: vec![zeros(n); self.model.frictions().len()],
            matrix: zeros(n * n),
            pivots: vec![0; n],
            rest: zeros(n),
            action: zeros(self.drives.len()),
            input: zeros(self.drives.len()),
            spin: self.model.actions(),
            memory: zeros(self.memory),
            crossing: None,
        }
    }

    /// Evaluates the machine at time `t` (s) and state `y`: coordinates, speeds and accelerations of all
    /// actuators, the drives' actions and the states of bodies and loads are then in `work`.
    ///
    /// # Errors
    /// [`DynamicsError`] where there is no pose, no inertia, or friction jams.
    pub fn evaluate<T: Scalar>(
        &self,
        t: f64,
        y: &[T],
        work: &mut MachineWork<T>,
    ) -> Result<(), DynamicsError> {
        let n = self.free.len();
        self.guide(t, y, work);
        if let Some(bridge) = self.bridge_at(work.q.first()) {
            return self.cross(bridge, t, &y[2 * n..], work);
        }
        self.model.enter(t, &work.q, &work.q_dot, &mut work.inner)?;
        self.drive(t, &y[2 * n..], work)?;
        self.model
            .loaded(&work.q_ddot, &mut work.inner, &mut work.base)?;
        for (k, &i) in self.free.iter().enumerate() {
            self.model.inertial(i, &mut work.inner, &mut work.units[k]);
        }
        if self.drives.iter().any(|drive| drive.inertia > 0.0) {
            self.spin_up(work)?;
        }
        for ((unit, &i), &inertia) in work.units.iter_mut().zip(&self.free).zip(&self.flywheels) {
            unit.tau[i] += T::lift(inertia);
        }
        for (k, &i) in self.free.iter().enumerate() {
            work.rest[k] = -work.base.tau[i];
            for (column, unit) in work.units.iter().enumerate() {
                work.matrix[k * n + column] = unit.tau[i];
            }
        }
        self.answer(work)?;
        self.settle(work)
    }

    /// The drives' actions at the state entered, from their own states.
    ///
    /// # Errors
    /// [`DynamicsError::Load`] where what a drive is given has no finite value.
    pub(crate) fn drive<T: Scalar>(
        &self,
        t: f64,
        memory: &[T],
        work: &mut MachineWork<T>,
    ) -> Result<(), DynamicsError> {
        for (d, drive) in self.drives.iter().enumerate() {
            let state = drive.state.map(|s| memory[s]);
            let given = self
                .model
                .sense(drive.load, &drive.given, t, &mut work.inner)?;
            let [_, speed, _] = work.inner.states().measure(drive.measured);
            let (action, rate) = drive.act(given + work.input[d], speed, state);
            work.action[d] = action;
            work.inner.give(drive.load, action);
            if let Some(s) = drive.state {
                work.memory[s] = rate;
            }
        }
        Ok(())
    }

    /// Lets the rotors resist: N² J times what their channels make of s̈ = S q̈ + what is left at zero q̈.
    fn spin_up<T: Scalar>(&self, work: &mut MachineWork<T>) -> Result<(), DynamicsError> {
        work.inner.refill(&self.model);
        for drive in self.drives.iter().filter(|drive| drive.inertia > 0.0) {
            let [_, _, rest] = work.inner.states().measure(drive.measured);
            self.model
                .channel(drive.load, &mut work.inner, &mut work.spin)?;
            let inertia = T::lift(drive.inertia);
            add(&mut work.base, &work.spin, -(inertia * rest));
            for (unit, &i) in work.units.iter_mut().zip(&self.free) {
                // S = −τ of the channel: virtual work.
                add(unit, &work.spin, inertia * work.spin.tau[i]);
            }
        }
        Ok(())
    }

    /// The drives' actions less what their rotors take, once the accelerations are known.
    fn settle<T: Scalar>(&self, work: &mut MachineWork<T>) -> Result<(), DynamicsError> {
        if self.drives.iter().all(|drive| drive.inertia == 0.0) {
            return Ok(());
        }
        self.model.accelerate(&work.q_ddot, &mut work.inner);
        self.net(work)
    }

    /// What is left of the drives' actions at the accelerations in `work`.
    pub(crate) fn net<T: Scalar>(&self, work: &mut MachineWork<T>) -> Result<(), DynamicsError> {
        for (drive, &action) in self.drives.iter().zip(&work.action) {
            let [_, _, s_ddot] = work.inner.states().measure(drive.measured);
            let net = action - T::lift(drive.inertia) * s_ddot;
            work.inner.give(drive.load, net);
        }
        Ok(self.model.push(&mut work.inner)?)
    }

    /// Coordinates and speeds of all actuators, and the accelerations of those that are led.
    fn guide<T: Scalar>(&self, t: f64, y: &[T], work: &mut MachineWork<T>) {
        let n = self.free.len();
        let mut k = 0;
        for (i, guidance) in self.guidance.iter().enumerate() {
            match guidance {
                Guidance::Free => {
                    work.q[i] = y[k];
                    work.q_dot[i] = y[n + k];
                    work.q_ddot[i] = T::lift(0.0);
                    k += 1;
                }
                Guidance::Prescribed(law) => {
                    let [q, q_dot, q_ddot, _] = law.at(t).map(T::lift);
                    work.q[i] = q;
                    work.q_dot[i] = q_dot;
                    work.q_ddot[i] = q_ddot;
                }
            }
        }
    }

    /// The free accelerations, by (1), with the frictions.
    fn answer<T: Scalar>(&self, work: &mut MachineWork<T>) -> Result<(), DynamicsError> {
        let MachineWork {
            inner,
            base,
            units,
            rubs,
            answers,
            matrix,
            pivots,
            rest,
            ..
        } = work;
        let diagonal = matrix.first().map_or(1.0, |m| m.value());
        let factored = small::factor(matrix, pivots);
        let inertia = factored.sign > 0.0 && factored.measure > 0.0;
        let resists = inertia && diagonal > 0.0 && diagonal.is_finite();
        if !(self.free.is_empty() || resists) {
            return Err(DynamicsError::NoInertia {
                q: work.q[self.free[0]].value(),
                m: diagonal,
            });
        }
        small::solve(matrix, pivots, rest);
        for (load, (rub, answer)) in self.model.frictions().zip(rubs.iter_mut().zip(answers)) {
            self.model.channel(load, inner, rub)?;
            for (value, &i) in answer.iter_mut().zip(&self.free) {
                *value = -rub.tau[i];
            }
            small::solve(matrix, pivots, answer);
            for (unit, &q_ddot) in units.iter().zip(answer.iter()) {
                add(rub, unit, q_ddot);
            }
        }
        for (unit, &q_ddot) in units.iter().zip(rest.iter()) {
            add(base, unit, q_ddot);
        }
        if self.model.frictions().len() > 0 {
            self.model.rub(&base.reactions, rubs, inner)?;
        }
        for (k, &i) in self.free.iter().enumerate() {
            let mut q_ddot = work.rest[k];
            for (answer, load) in work.answers.iter().zip(self.model.frictions()) {
                q_ddot += answer[k] * work.inner.loads().magnitude[load];
            }
            work.q_ddot[i] = q_ddot;
        }
        for (rub, load) in work.rubs.iter().zip(self.model.frictions()) {
            add(&mut work.base, rub, work.inner.loads().magnitude[load]);
        }
        Ok(())
    }

    /// ẏ of the state last evaluated, into `out` of [`Machine::states`] places.
    pub fn rates<T: Scalar>(&self, work: &MachineWork<T>, out: &mut [T]) {
        let n = self.free.len();
        for (k, &i) in self.free.iter().enumerate() {
            out[k] = work.q_dot[i];
            out[n + k] = work.q_ddot[i];
        }
        let (memory, powers) = out[2 * n..].split_at_mut(self.memory);
        memory.copy_from_slice(&work.memory);
        for (power, &worker) in powers.iter_mut().zip(&self.workers) {
            *power = match worker {
                Worker::Load(load) => {
                    let mut sum = T::lift(0.0);
                    for act in &work.inner.loads().acts {
                        if act.by == By::Load(load) {
                            sum += act.power(work.inner.states());
                        }
                    }
                    sum
                }
                Worker::Drive(d) => {
                    let [_, speed, _] = work.inner.states().measure(self.drives[d].measured);
                    work.action[d] * speed
                }
                Worker::Prescribed(i) => work.base.tau[i] * work.q_dot[i],
            };
        }
    }

    /// All that another model of the same mechanism and loads computes, at the state last evaluated: its
    /// reactions, and what every body and load does, are then in `all` and `actions`. On a bridge, a
    /// reaction that the change point does not determine is not a number.
    ///
    /// # Errors
    /// [`DynamicsError`] as of [`Machine::evaluate`].
    pub fn show(
        &self,
        shown: &Model,
        t: f64,
        work: &MachineWork<f64>,
        all: &mut Workspace<f64>,
        actions: &mut Actions<f64>,
    ) -> Result<(), DynamicsError> {
        for drive in &self.drives {
            all.give(drive.load, work.inner.loads().magnitude[drive.load]);
        }
        if let Some((bridge, x)) = self.bridge_at(work.q.first()) {
            return bridge.show(x, shown, t, work, all, actions);
        }
        Ok(shown.kinetostatics(t, &work.q, &work.q_dot, &work.q_ddot, all, actions)?)
    }

    /// Kinetic energy with that of the rotors and flywheels, and the potential of the conservative loads, J, at the
    /// state last evaluated.
    pub fn energy(&self, work: &MachineWork<f64>) -> [f64; 2] {
        let rotors = self.drives.iter().map(|drive| {
            let [_, speed, _] = work.inner.states().measure(drive.measured);
            0.5 * drive.inertia * speed * speed
        });
        let wheels = self.free.iter().zip(&self.flywheels).map(|(&i, inertia)| {
            let speed = work.q_dot[i];
            0.5 * inertia * speed * speed
        });
        let kinetic = self.model.kinetic(&work.inner) + rotors.sum::<f64>() + wheels.sum::<f64>();
        let potentials = (0..self.model.loads().len())
            .filter_map(|load| self.model.potential(load, &work.inner));
        [kinetic, potentials.sum()]
    }
}

/// Adds some of one run to another.
fn add<T: Scalar>(sum: &mut Actions<T>, run: &Actions<T>, times: T) {
    for (sum, more) in sum.reactions.iter_mut().zip(&run.reactions) {
        *sum += *more * times;
    }
    for (sum, more) in sum.tau.iter_mut().zip(&run.tau) {
        *sum += *more * times;
    }
}

/// The loads with those through which the drives act, in this order.
///
/// # Errors
/// The first drive that acts along nothing.
pub fn all_loads(
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

/// Working memory of a machine for one thread, and what its last evaluation found.
#[derive(Debug, Clone)]
pub struct MachineWork<T = f64> {
    /// The bodies and loads.
    pub inner: Workspace<T>,
    /// By actuator: coordinate, speed and acceleration, rad or m, per s, per s².
    pub q: Vec<T>,
    /// Speeds.
    pub q_dot: Vec<T>,
    /// Accelerations.
    pub q_ddot: Vec<T>,
    /// By drive: its action, N·m or N, without what its rotor's inertia takes.
    pub action: Vec<T>,
    /// By drive: what it is given beside its own action, voltage or speed; zero at first.
    pub input: Vec<T>,
    spin: Actions<T>,
    base: Actions<T>,
    units: Vec<Actions<T>>,
    rubs: Vec<Actions<T>>,
    answers: Vec<Vec<T>>,
    matrix: Vec<T>,
    pivots: Vec<usize>,
    rest: Vec<T>,
    memory: Vec<T>,
    pub(crate) crossing: Option<Box<CrossWork<T>>>,
}

impl<T> MachineWork<T> {
    /// The actuators' actions (zero on free coordinates) and the reactions that the machine's own model
    /// computes, of the last evaluation.
    pub fn actions(&self) -> &Actions<T> {
        &self.base
    }
}
