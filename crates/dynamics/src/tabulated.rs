//! A machine of one freedom on a table: its equation of motion without the mechanism,
//!
//! ```text
//! m q̈ + ½m′ q̇² = −V′ + Σ wₗ Fₗ(t, q, q̇)                              (1)
//! ```
//!
//! m with that of rotors and flywheels, from ½m′; the potential V of all loads that have one, from ½V′; and
//! by load or drive without a potential w, what one unit of it gives the coordinate. Of a damper the force is
//! F ds/dt, and w = −ds/dq, so it takes F w² q̇. A drive along s has w = ds/dq, and sees the speed w q̇. What
//! else magnitudes depend on is tabulated as s(q), or as ds/dq where its speed is meant.
//!
//! V and m are integrals of what stands in (1), piece by piece, so ½ m q̇² + V is kept on the table as on
//! the mechanism: it does not drift, however coarse the table is.
//!
//! Making it costs some hundred to some thousand evaluations of the exact machine in dual numbers: at 1e-9 0.2 ms
//! for a free four-bar, 1 to 5 ms with loads and drives (docs/performance.md).

mod ode;
mod source;

pub use ode::TabulatedMachineOde;

use crate::drive::CompiledDrive;
use crate::machine::{Machine, NonconservativeSource};
use dwell_geometry::PositionError;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_kinetostatics::table::{Bound, IntegratedCurve, PiecewiseColumns, TableBuilder};
use dwell_kinetostatics::{
    CompiledSignal, ExactModel, Load, LoadKind, Magnitude, TableDomain, TableError, TableQuantity,
};
use source::{AuxiliaryColumns, TotalInertia, TotalPotential};
use thiserror::Error;

/// Why a machine has no table.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TabulationError {
    /// More or less than one coordinate, or one that is prescribed.
    #[error("a table is of one coordinate, which is free, not of {free} free ones of {actuators}")]
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
    /// The machine crosses change points.
    #[error(
        "the machine crosses change points, beyond which another branch follows: it has no table"
    )]
    ChangePoints,
    /// The functions of the coordinate have no table.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// A machine of one freedom on a table: constant, shared between threads.
#[derive(Debug, Clone, PartialEq)]
pub struct TabulatedMachine {
    inertia: IntegratedCurve,
    potential: Option<IntegratedCurve>,
    columns: PiecewiseColumns,
    /// How many columns there are.
    column_count: usize,
    /// In the order of the works.
    tabulated_loads: Vec<TabulatedLoad>,
    /// Number of the drives' states.
    drive_state_count: usize,
    bounds: Vec<Bound>,
    domain: [f64; 2],
    period: Option<f64>,
}

/// A load or drive without a potential. Its w is the column of its own place.
#[derive(Debug, Clone, PartialEq)]
struct TabulatedLoad {
    load: usize,
    magnitude: Magnitude,
    signals: Vec<TabulatedSignal>,
    effect: LoadEffect,
}

/// What a magnitude is of.
#[derive(Debug, Clone, PartialEq)]
enum LoadEffect {
    /// F itself acts.
    Force,
    /// F resists in proportion to the speed.
    Damper,
    /// A drive makes an action of it.
    Drive(Box<CompiledDrive>),
}

/// What a magnitude depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum TabulatedSignal {
    Time,
    Value(TabulatedCoordinate),
    Speed(TabulatedCoordinate),
}

/// slope · q + offset and what a column adds, of a coordinate; of a speed, that by q̇.
#[derive(Debug, Clone, Copy, PartialEq)]
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
        if !machine.fit_windows.is_empty() {
            return Err(TabulationError::ChangePoints);
        }
        let dry = |load: &Load| load.friction().is_some();
        if let Some(load) = machine.model().loads().iter().position(dry) {
            return Err(TabulationError::Friction { load });
        }
        let mut maker = TableBuilder::new(machine.model().plan().range(), domain, accuracy)?;
        let exact = ExactModel::new(machine.model().without_reactions());
        let exact = exact.ok_or(TabulationError::DegreesOfFreedom { actuators, free })?;
        let mut total_inertia = TotalInertia::new(machine, &exact);
        let inertia = maker.curve(
            [TableQuantity::M, TableQuantity::HalfDm],
            &mut total_inertia,
        )?;
        let potential = match TotalPotential::new(machine) {
            Some(mut source) => {
                Some(maker.curve([TableQuantity::V, TableQuantity::HalfDv], &mut source)?)
            }
            None => None,
        };
        let sources = machine.nonconservative_sources().iter();
        let loads: Vec<usize> = sources
            .filter_map(|&source| load_of(machine, source))
            .collect();
        let mut auxiliary = AuxiliaryColumns::new(machine, &maker, &loads);
        let mut tabulated_loads = Vec::with_capacity(loads.len());
        for &load in &loads {
            tabulated_loads.push(TabulatedLoad::new(machine, load, &mut auxiliary)?);
        }
        let entries = auxiliary.entries().to_vec();
        let columns = {
            let mut fill = |q: f64, out: &mut [_]| auxiliary.fill(q, out);
            maker.columns(&entries, &|one, other| one == other, &mut fill)?
        };
        Ok(Self {
            inertia,
            potential,
            columns,
            column_count: entries.len(),
            tabulated_loads,
            drive_state_count: machine.work_offset() - 2,
            domain: maker.domain(),
            period: maker.period(),
            bounds: maker.bounds(),
        })
    }

    /// The largest of all bounds: every function of the coordinate is off by no more than this part of its
    /// largest value.
    pub fn bound(&self) -> f64 {
        self.bounds.iter().fold(0.0, |max, b| max.max(b.error))
    }

    /// How far each function may be off. Loads are those of the machine's model; measured coordinates are
    /// counted as they are met in the loads' magnitudes.
    pub fn bounds(&self) -> &[Bound] {
        &self.bounds
    }

    /// Cells of m, of V, of all else; none where there is nothing.
    pub fn cells(&self) -> [usize; 3] {
        [
            self.inertia.cells(),
            self.potential.as_ref().map_or(0, IntegratedCurve::cells),
            self.columns.cells(),
        ]
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        let potential = self.potential.as_ref().map_or(0, IntegratedCurve::bytes);
        self.inertia.bytes() + potential + self.columns.bytes()
    }

    /// From where to where it reaches, rad or m; of one that comes back, one period. A motion that leaves it
    /// ends there with [`PositionError::OutOfRange`].
    pub fn domain(&self) -> [f64; 2] {
        self.domain
    }

    /// After how many radians everything comes back, if it does.
    pub fn period(&self) -> Option<f64> {
        self.period
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

    /// Kinetic energy ½ m q̇² and potential V, J, as [`Machine::energy`].
    ///
    /// # Errors
    /// [`PositionError`] outside the table.
    pub fn energy(&self, q: f64, q_dot: f64) -> Result<[f64; 2], PositionError> {
        let [m, _] = self.inertia(q)?;
        let [potential, _] = self.potential(q)?;
        Ok([0.5 * m * q_dot * q_dot, potential])
    }
}

/// The load through which something works.
fn load_of(machine: &Machine, source: NonconservativeSource) -> Option<usize> {
    match source {
        NonconservativeSource::Load(load) => Some(load),
        NonconservativeSource::Drive(drive) => machine.drives.get(drive).map(|drive| drive.load),
        NonconservativeSource::Prescribed(_) => None,
    }
}

impl TabulatedLoad {
    fn new(
        machine: &Machine,
        load: usize,
        auxiliary: &mut AuxiliaryColumns,
    ) -> Result<Self, TableError> {
        let model = machine.model();
        let drive = machine.drives.iter().find(|drive| drive.load == load);
        let (effect, magnitude) = match (drive, &model.loads()[load]) {
            (Some(drive), _) => (
                LoadEffect::Drive(Box::new(drive.clone())),
                drive.input.clone(),
            ),
            (None, found) => {
                let is_damper = matches!(
                    found.kind,
                    LoadKind::Damper { .. }
                        | LoadKind::RotationalDamper { .. }
                        | LoadKind::SlideDamper(_)
                );
                let effect = if is_damper {
                    LoadEffect::Damper
                } else {
                    LoadEffect::Force
                };
                (effect, found.magnitude.clone())
            }
        };
        let mut signals = Vec::new();
        for &sense in model.compiled_signals(load) {
            signals.push(match sense {
                CompiledSignal::Time => TabulatedSignal::Time,
                CompiledSignal::Value(measured) => {
                    TabulatedSignal::Value(auxiliary.value(measured)?)
                }
                CompiledSignal::Velocity(measured) => {
                    TabulatedSignal::Speed(auxiliary.speed(measured)?)
                }
            });
        }
        Ok(Self {
            load,
            magnitude,
            signals,
            effect,
        })
    }
}
