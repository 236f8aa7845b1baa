//! A machine of one degree of freedom on a table: its equation of motion without the mechanism,
//!
//! ```text
//! m q̈ + ½m′ q̇² = −V′ + Σ wₗ Fₗ(t, q, q̇)                              (1)
//! ```
//!
//! m includes rotors and flywheels and follows from ½m′, the potential V of all conservative loads from ½V′. For each
//! load or drive without a potential, w is the generalised force of one unit of it. The force of a damper is F ds/dt,
//! and w = −ds/dq, so its generalised force is −F w² q̇. A drive along s has w = ds/dq and the speed w q̇. Other
//! coordinates on which magnitudes depend are tabulated as s(q), or as ds/dq where only their speed occurs.
//!
//! V and m are integrals of the terms of (1), piece by piece, so ½ m q̇² + V is constant on the table as on
//! the mechanism: it does not drift, however coarse the table is.
//!
//! Building it takes some hundred to some thousand evaluations of the exact machine in dual numbers: at 1e-9, 0.2 ms
//! for a free four-bar, 1 to 5 ms with loads and drives (docs/performance.md).

mod ode;
mod source;

pub use ode::TabulatedMachineOde;

use crate::drive::CompiledDrive;
use crate::machine::{Machine, NonconservativeSource};
use crate::state_switches::StateSwitches;
use dwell_geometry::PositionError;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_kinetostatics::table::{Bound, IntegratedCurve, PiecewiseColumns, Result, TableBuilder};
use dwell_kinetostatics::{
    CompiledSignal, ExactModel, Load, LoadShape as _, MachineModel as _, Magnitude, Strength,
    TableDomain, TableError, TableQuantity,
};
use dwell_laws::Features;
use source::{AuxiliaryColumns, TotalInertia, TotalPotential};
use std::sync::Arc;
use thiserror::Error;

/// Why a machine has no table.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TabulationError {
    /// The number of coordinates is not one, or the coordinate is prescribed.
    #[error(
        "a tabulated machine needs one actuator, which must be free; this one has {actuators}, {free} of them free"
    )]
    DegreesOfFreedom {
        /// Number of actuators.
        actuators: usize,
        /// How many of them are free.
        free: usize,
    },
    /// Dry friction depends on reactions, and those on q̈.
    #[error("load {load} is dry friction, which depends on the reactions: it has no table")]
    Friction {
        /// The load.
        load: usize,
    },
    /// The machine has end stops.
    #[error("the machine has end stops: it has no table")]
    Stops,
    /// The machine crosses change points.
    #[error(
        "the machine crosses change points, beyond which another branch follows: it has no table"
    )]
    ChangePoints,
    /// The functions of the coordinate have no table.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// A machine of one degree of freedom on a table: constant, shared between threads.
#[derive(Debug, Clone, PartialEq)]
pub struct TabulatedMachine {
    inertia: IntegratedCurve,
    potential: Option<IntegratedCurve>,
    columns: PiecewiseColumns,
    /// Number of columns.
    column_count: usize,
    /// In the order of the works.
    tabulated_loads: Vec<TabulatedLoad>,
    /// By load: the index of its work, or of the sum that contains it, among the works.
    work_places: Vec<usize>,
    work_count: usize,
    /// Number of the drives' states.
    drive_state_count: usize,
    time_features: Arc<Features>,
    state_switches: StateSwitches,
    /// The error bound of each function. Loads are those of the machine's model; measured coordinates are
    /// numbered in the order in which the loads' magnitudes name them.
    pub bounds: Vec<Bound>,
    /// Its domain, rad or m; one period if it is periodic. A motion that leaves it
    /// ends there with [`PositionError::OutOfRange`].
    pub domain: [f64; 2],
    /// The period, rad, if there is one.
    pub period: Option<f64>,
}

/// A load or drive without a potential. Its w is the column of its own index.
#[derive(Debug, Clone, PartialEq)]
struct TabulatedLoad {
    load: usize,
    magnitude: Magnitude,
    signals: Vec<TabulatedSignal>,
    effect: LoadEffect,
}

/// How a magnitude acts.
#[derive(Debug, Clone, PartialEq)]
enum LoadEffect {
    /// By a law on its unit response.
    Load(Strength),
    /// The magnitude is the input of a drive.
    Drive(Box<CompiledDrive>),
}

/// A signal on which a magnitude depends.
#[derive(Debug, Clone, Copy, PartialEq)]
enum TabulatedSignal {
    Time,
    Value(TabulatedCoordinate),
    Speed(TabulatedCoordinate),
}

/// slope · q + offset + a column, of a coordinate; of a speed, the same divided by q̇.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct TabulatedCoordinate {
    slope: f64,
    offset: f64,
    column: Option<usize>,
}

impl TabulatedMachine {
    /// A table of a machine, in which every function of the coordinate is within `accuracy` of its largest
    /// value.
    ///
    /// # Errors
    /// [`TabulationError`] for a machine that has no table, or not such an accurate one.
    pub fn new(
        machine: &Machine,
        accuracy: f64,
        domain: TableDomain,
    ) -> Result<Self, TabulationError> {
        let actuators = machine.model().plan().actuators();
        let free = machine.free().len();
        if (actuators, free) != (1, 1) {
            return Err(TabulationError::DegreesOfFreedom { actuators, free });
        }
        if !machine.stops.is_empty() {
            return Err(TabulationError::Stops);
        }
        if !machine.fit_windows.is_empty() {
            return Err(TabulationError::ChangePoints);
        }
        let dry = |load: &Load| load.friction().is_some();
        if let Some(load) = machine.model().loads().iter().position(dry) {
            return Err(TabulationError::Friction { load });
        }
        let mut builder = TableBuilder::new(machine.model().plan().range(), domain, accuracy)?;
        let exact = ExactModel::new(machine.model().without_reactions())
            .ok_or(TabulationError::DegreesOfFreedom { actuators, free })?;
        let both = [TableQuantity::M, TableQuantity::HalfDm];
        let inertia = builder.curve(both, &mut TotalInertia::new(machine, &exact))?;
        let both = [TableQuantity::V, TableQuantity::HalfDv];
        let potential = TotalPotential::new(machine)
            .map(|mut source| builder.curve(both, &mut source))
            .transpose()?;
        let (loads, work_places) = loads_and_works(machine);
        let mut auxiliary = AuxiliaryColumns::new(machine, &builder, &loads);
        let mut tabulated_loads = Vec::with_capacity(loads.len());
        for &load in &loads {
            tabulated_loads.push(TabulatedLoad::new(machine, load, &mut auxiliary)?);
        }
        let switching = tabulated_loads.iter().enumerate();
        let state_switches =
            StateSwitches::of(switching.map(|(k, load)| (k, &load.magnitude, load.drive())));
        let entries = auxiliary.entries.clone();
        let columns = {
            let mut fill = |q: f64, out: &mut [_]| auxiliary.fill(q, out);
            let relation = |one, other| if one == other { 1.0 } else { 0.0 };
            builder.columns(&entries, &relation, &mut fill)?
        };
        Ok(Self {
            inertia,
            potential,
            columns,
            column_count: entries.len(),
            tabulated_loads,
            work_places,
            work_count: machine.nonconservative_sources().len(),
            drive_state_count: machine.work_offset() - 2,
            domain: builder.domain(),
            period: builder.period(),
            time_features: Arc::clone(&machine.time_features),
            state_switches,
            bounds: builder.bounds(),
        })
    }

    /// The largest of all bounds: every function of the coordinate has an error of at most this part of its
    /// largest value.
    pub fn bound(&self) -> f64 {
        self.bounds.iter().fold(0.0, |max, b| max.max(b.error))
    }

    /// Cells of m, of V, of the columns; zero without columns.
    pub fn cells(&self) -> [usize; 3] {
        let potential = self.potential.as_ref().map_or(0, IntegratedCurve::cells);
        [self.inertia.cells(), potential, self.columns.cells()]
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        let potential = self.potential.as_ref().map_or(0, IntegratedCurve::bytes);
        self.inertia.bytes() + potential + self.columns.bytes()
    }

    /// m (with rotors and flywheel) and ½m′ at `q`, kg m² or kg.
    ///
    /// # Errors
    /// [`PositionError`] outside the table.
    pub fn inertia(&self, q: f64) -> Result<[f64; 2], PositionError> {
        self.inertia.eval(q)
    }

    /// V, J, and ½V′, N·m or N, at `q`: zero without conservative loads.
    ///
    /// # Errors
    /// [`PositionError`] outside the table.
    pub fn potential(&self, q: f64) -> Result<[f64; 2], PositionError> {
        self.potential.as_ref().map_or(Ok([0.0; 2]), |v| v.eval(q))
    }

    /// Kinetic energy ½ m q̇² and potential V, J, as [`MachineState::energy`](crate::MachineState::energy).
    ///
    /// # Errors
    /// [`PositionError`] outside the table.
    pub fn energy(&self, q: f64, q_dot: f64) -> Result<[f64; 2], PositionError> {
        let [m, _] = self.inertia(q)?;
        let [potential, _] = self.potential(q)?;
        Ok([0.5 * m * q_dot * q_dot, potential])
    }
}

/// The loads that do work, and, by load, the index of its work.
fn loads_and_works(machine: &Machine) -> (Vec<usize>, Vec<usize>) {
    let (mut loads, mut places) = (Vec::new(), Vec::new());
    for (place, &source) in machine.nonconservative_sources().iter().enumerate() {
        loads.extend(loads_of(machine, source));
        places.resize(loads.len(), place);
    }
    (loads, places)
}

/// The loads of a nonconservative source.
fn loads_of(machine: &Machine, source: NonconservativeSource) -> Vec<usize> {
    match source {
        NonconservativeSource::Load(load) => vec![load],
        NonconservativeSource::Loads => machine.summed_loads.clone(),
        NonconservativeSource::Drive(drive) => vec![machine.drives[drive].load],
        NonconservativeSource::Prescribed(_) | NonconservativeSource::Stop(_) => Vec::new(),
    }
}

impl TabulatedLoad {
    fn drive(&self) -> Option<&CompiledDrive> {
        match &self.effect {
            LoadEffect::Drive(drive) => Some(drive),
            LoadEffect::Load(_) => None,
        }
    }

    fn new(machine: &Machine, load: usize, auxiliary: &mut AuxiliaryColumns) -> Result<Self> {
        let model = machine.model();
        let drive = machine.drives.iter().find(|drive| drive.load == load);
        let found = &model.loads()[load];
        let (effect, magnitude) = match drive {
            Some(drive) => (LoadEffect::Drive(Box::new(drive.clone())), &drive.input),
            None => (LoadEffect::Load(found.kind.strength()), &found.magnitude),
        };
        let signals = model.compiled_signals(load).iter().map(|signal| {
            Ok(match *signal {
                CompiledSignal::Time => TabulatedSignal::Time,
                CompiledSignal::Value(of) => TabulatedSignal::Value(auxiliary.value(of)?),
                CompiledSignal::Velocity(of) => TabulatedSignal::Speed(auxiliary.speed(of)?),
            })
        });
        Ok(Self {
            load,
            magnitude: magnitude.clone(),
            signals: signals.collect::<Result<_>>()?,
            effect,
        })
    }
}
