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

mod moving;
mod source;

pub use moving::OnTable;

use crate::drive::Driven;
use crate::machine::{Machine, Worker};
use dwell_geometry::PlaceError;
use dwell_geometry::measure::Measured;
use dwell_kinetostatics::table::{Bound, Columns, Curve, Maker};
use dwell_kinetostatics::{Entry, Exact, Extent, Load, LoadKind, Magnitude, Sense, TableError};
use source::{Inertial, Others, Potential};
use thiserror::Error;

/// Why a machine has no table.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum NotTabled {
    /// More or less than one coordinate, or one that is prescribed.
    #[error("a table is of one coordinate, which is free, not of {free} free ones of {actuators}")]
    Freedoms {
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
    Bridged,
    /// The functions of the coordinate have no table.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// A machine of one freedom on a table: constant, shared between threads.
#[derive(Debug, Clone, PartialEq)]
pub struct Tabled {
    inertia: Curve,
    potential: Option<Curve>,
    columns: Columns,
    /// How many columns there are.
    width: usize,
    /// In the order of the works.
    actors: Vec<Actor>,
    /// Number of the drives' states.
    memory: usize,
    bounds: Vec<Bound>,
    extent: [f64; 2],
    period: Option<f64>,
}

/// A load or drive without a potential. Its w is the column of its own place.
#[derive(Debug, Clone, PartialEq)]
struct Actor {
    load: usize,
    magnitude: Magnitude,
    signals: Vec<Signal>,
    how: How,
}

/// What a magnitude is of.
#[derive(Debug, Clone, PartialEq)]
enum How {
    /// F itself acts.
    Acts,
    /// F resists in proportion to the speed.
    Damps,
    /// A drive makes an action of it.
    Drives(Box<Driven>),
}

/// What a magnitude depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Signal {
    Time,
    Value(Felt),
    Speed(Felt),
}

/// slope · q + offset and what a column adds, of a coordinate; of a speed, that by q̇.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Felt {
    slope: f64,
    offset: f64,
    column: Option<usize>,
}

impl Tabled {
    /// A table of a machine, in which every function of the coordinate is within `accuracy` of its largest
    /// value.
    ///
    /// # Errors
    /// [`NotTabled`] for a machine that has no table, or not such an accurate one.
    pub fn new(machine: &Machine, accuracy: f64, extent: Extent) -> Result<Self, NotTabled> {
        let actuators = machine.model().plan().actuators();
        let free = machine.free().len();
        if (actuators, free) != (1, 1) {
            return Err(NotTabled::Freedoms { actuators, free });
        }
        if !machine.bridges.is_empty() {
            return Err(NotTabled::Bridged);
        }
        let dry = |load: &Load| matches!(load.magnitude, Magnitude::Friction(_));
        if let Some(load) = machine.model().loads().iter().position(dry) {
            return Err(NotTabled::Friction { load });
        }
        let mut maker = Maker::new(machine.model().plan().range(), extent, accuracy)?;
        let exact = Exact::new(machine.model().without_reactions());
        let exact = exact.ok_or(NotTabled::Freedoms { actuators, free })?;
        let mut bodies = Inertial::new(machine, &exact);
        let inertia = maker.curve([Entry::M, Entry::HalfDm], &mut bodies)?;
        let potential = match Potential::new(machine) {
            Some(mut source) => Some(maker.curve([Entry::V, Entry::HalfDv], &mut source)?),
            None => None,
        };
        let workers = machine.workers().iter();
        let loads: Vec<usize> = workers
            .filter_map(|&worker| load_of(machine, worker))
            .collect();
        let mut others = Others::new(machine, &maker, &loads);
        let mut actors = Vec::with_capacity(loads.len());
        for &load in &loads {
            actors.push(Actor::new(machine, load, &mut others)?);
        }
        let entries = others.entries().to_vec();
        let columns = {
            let mut fill = |q: f64, out: &mut [_]| others.fill(q, out);
            maker.columns(&entries, &|one, other| one == other, &mut fill)?
        };
        Ok(Self {
            inertia,
            potential,
            columns,
            width: entries.len(),
            actors,
            memory: machine.first_work() - 2,
            extent: maker.extent(),
            period: maker.period(),
            bounds: maker.bounds(),
        })
    }

    /// The largest of all bounds: every function of the coordinate is off by no more than this part of its
    /// largest value.
    pub fn bound(&self) -> f64 {
        self.bounds.iter().fold(0.0, |most, b| most.max(b.error))
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
            self.potential.as_ref().map_or(0, Curve::cells),
            self.columns.cells(),
        ]
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        let potential = self.potential.as_ref().map_or(0, Curve::bytes);
        self.inertia.bytes() + potential + self.columns.bytes()
    }

    /// From where to where it reaches, rad or m; of one that comes back, one period. A motion that leaves it
    /// ends there with [`PlaceError::OutOfRange`].
    pub fn extent(&self) -> [f64; 2] {
        self.extent
    }

    /// After how many radians everything comes back, if it does.
    pub fn period(&self) -> Option<f64> {
        self.period
    }

    /// m (with rotors and flywheel) and ½m′ at `q`, kg m² or kg.
    ///
    /// # Errors
    /// [`PlaceError`] outside the table.
    pub fn inertia(&self, q: f64) -> Result<[f64; 2], PlaceError> {
        self.inertia.at(q)
    }

    /// V, J, and ½V′, N·m or N, at `q`: zero without conservative loads.
    ///
    /// # Errors
    /// [`PlaceError`] outside the table.
    pub fn potential(&self, q: f64) -> Result<[f64; 2], PlaceError> {
        self.potential.as_ref().map_or(Ok([0.0; 2]), |v| v.at(q))
    }

    /// Kinetic energy ½ m q̇² and potential V, J, as [`Machine::energy`].
    ///
    /// # Errors
    /// [`PlaceError`] outside the table.
    pub fn energy(&self, q: f64, q_dot: f64) -> Result<[f64; 2], PlaceError> {
        let [m, _] = self.inertia(q)?;
        let [potential, _] = self.potential(q)?;
        Ok([0.5 * m * q_dot * q_dot, potential])
    }
}

/// The load through which something works.
fn load_of(machine: &Machine, worker: Worker) -> Option<usize> {
    match worker {
        Worker::Load(load) => Some(load),
        Worker::Drive(drive) => machine.drives.get(drive).map(|drive| drive.load),
        Worker::Prescribed(_) => None,
    }
}

impl Actor {
    fn new(machine: &Machine, load: usize, others: &mut Others) -> Result<Self, TableError> {
        let model = machine.model();
        let drive = machine.drives.iter().find(|drive| drive.load == load);
        let (how, magnitude) = match (drive, &model.loads()[load]) {
            (Some(drive), _) => (How::Drives(Box::new(drive.clone())), drive.given.clone()),
            (None, found) => {
                let damps = matches!(
                    found.kind,
                    LoadKind::Damper { .. }
                        | LoadKind::TorsionDamper { .. }
                        | LoadKind::SlideDamper(_)
                );
                let how = if damps { How::Damps } else { How::Acts };
                (how, found.magnitude.clone())
            }
        };
        let mut signals = Vec::new();
        for &sense in model.senses(load) {
            signals.push(match sense {
                Sense::Time => Signal::Time,
                Sense::Value(measured) => Signal::Value(others.value(measured)?),
                Sense::Speed(measured) => Signal::Speed(others.speed(measured)?),
            });
        }
        Ok(Self {
            load,
            magnitude,
            signals,
            how,
        })
    }
}
