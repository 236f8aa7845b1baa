//! Tables of the reduced model: m, ½m′, a, b, w and c as piecewise polynomials of the coordinate, which replace the
//! mechanism.
//!
//! The number of cells follows from the decay of the coefficients of a global series (`sizing`:
//! trigonometric over full revolutions, Chebyshev's over a limited domain); values come from cells of equal
//! size at a constant cost (`piecewise`); the error is measured, not estimated (`bound`).
//!
//! A limited range ends at limit positions, where all coefficients grow without bound, so a table covers an inner part
//! of it. Outside its domain it returns an error. A table from a file has no mechanism to evaluate instead, and a
//! motion that passed from table to mechanism would change its energy.

mod bound;
mod build;
mod file;
mod piecewise;
mod sampler;
mod sizing;

pub use build::{ColumnSampler, SlopeSampler, TableBuilder};
pub use file::{FileError, Labels};
pub use piecewise::{IntegratedCurve, PiecewiseColumns};
pub use sampler::{InertiaSampler, TableModel};

use crate::error::{KinetostaticsError, PositionResult};
use crate::reduced::{Coefficients, ExactModel, Inertia, ReducedModel};
use dwell_geometry::{PositionError, Range};
use dwell_numerics::Dual;
use sampler::ModelSampler;
use std::fmt;
use thiserror::Error;

/// A result that fails with a [`TableError`] unless another error is named.
pub type Result<T, E = TableError> = std::result::Result<T, E>;

/// The domain of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TableDomain {
    /// All revolutions of a mechanism that turns fully; of a limited range all but 2 % of it at each end.
    Full,
    /// The interval between two coordinates, rad or m.
    Between(f64, f64),
}

/// A function of the coordinate that a table may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableQuantity {
    /// m.
    M,
    /// ½m′.
    HalfDm,
    /// The coefficient of q̈ in a reaction.
    A {
        /// Index of the reaction.
        reaction: usize,
    },
    /// The coefficient of q̇² in a reaction.
    B {
        /// Index of the reaction.
        reaction: usize,
    },
    /// The generalised force of one unit of a load.
    W {
        /// Index of the load.
        load: usize,
    },
    /// The reaction to one unit of a load.
    C {
        /// Index of the load.
        load: usize,
        /// Index of the reaction.
        reaction: usize,
    },
    /// V, the potential of all loads that have one.
    V,
    /// ½V′.
    HalfDv,
    /// A coordinate on which loads or drives depend, less its uniform growth with q.
    S {
        /// Its index.
        coordinate: usize,
    },
    /// Its derivative by q.
    Ds {
        /// Its index.
        coordinate: usize,
    },
}

impl fmt::Display for TableQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::M => write!(f, "m"),
            Self::HalfDm => write!(f, "½m′"),
            Self::A { reaction } => write!(f, "a of reaction {reaction}"),
            Self::B { reaction } => write!(f, "b of reaction {reaction}"),
            Self::W { load } => write!(f, "w of load {load}"),
            Self::C { load, reaction } => write!(f, "c of load {load} and reaction {reaction}"),
            Self::V => write!(f, "the potential V"),
            Self::HalfDv => write!(f, "the slope of the potential, ½V′"),
            Self::S { coordinate } => write!(f, "measured coordinate {coordinate}"),
            Self::Ds { coordinate } => write!(f, "the slope of measured coordinate {coordinate}"),
        }
    }
}

/// Why there is no table.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TableError {
    /// An accuracy that double precision cannot reach, or an invalid one.
    #[error("a table's accuracy is between 1e-14 and 1e-2, not {accuracy:e}")]
    Accuracy {
        /// The one requested.
        accuracy: f64,
    },
    /// A domain that is empty, not finite or not inside the range.
    #[error("the interval from {from} to {to} is empty or not within the range")]
    Domain {
        /// Lower end, rad or m.
        from: f64,
        /// Upper end, rad or m.
        to: f64,
    },
    /// The range has no end and the mechanism is not periodic.
    #[error("the range has no ends: give the interval of the table")]
    Unbounded,
    /// A coefficient that is not periodic, such as that of a spring that winds up.
    #[error("{what} is not periodic: give the interval of the table")]
    NotPeriodic {
        /// Which.
        what: TableQuantity,
    },
    /// The coefficients of the series do not fall to the accuracy.
    #[error(
        "not smooth enough for a table over this interval: {points} samples leave an error of {residual:.1e} of the largest value"
    )]
    NotSmooth {
        /// Samples taken.
        points: usize,
        /// The last coefficients, as a part of the largest value.
        residual: f64,
    },
    /// No number of cells reaches the accuracy.
    #[error(
        "no table of accuracy {accuracy:e}: {what} has an error of {reached:.1e} of its largest value"
    )]
    NotReached {
        /// The coefficient that is furthest off.
        what: TableQuantity,
        /// The best bound that was reached, as a part of the scale.
        reached: f64,
        /// The required accuracy.
        accuracy: f64,
    },
    /// A coefficient varies within too small a part of the interval.
    #[error(
        "no table: something varies within so small a part of the interval that {most} cells, all of one width, are too few"
    )]
    TooNarrow {
        /// The most cells that a table has.
        most: usize,
    },
    /// The exact model has no pose, or a load no direction, within the extent.
    #[error(transparent)]
    Exact(#[from] KinetostaticsError),
}

impl From<PositionError> for TableError {
    fn from(error: PositionError) -> Self {
        Self::Exact(error.into())
    }
}

/// The measured error bound of one coefficient of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// The coefficient.
    pub quantity: TableQuantity,
    /// Its scale in its own unit: its largest value, or, if it nearly vanishes, a thousandth of the largest of its
    /// kind.
    pub scale: f64,
    /// The bound of its error, relative to the scale.
    pub error: f64,
}

/// The responses to one unit of each load at one coordinate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UnitLoadResponses {
    /// By load: w.
    pub w: Vec<f64>,
    /// By load, then by reaction: c.
    pub c: Vec<f64>,
}

/// A table of the whole reduced model of one degree of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct TabulatedModel {
    accuracy: f64,
    is_angle: bool,
    inertia: IntegratedCurve,
    reactions: PiecewiseColumns,
    loads: PiecewiseColumns,
    /// How many reactions and loads.
    counts: [usize; 2],
    /// m and ½m′, then a, b, w and c.
    bounds: Vec<Bound>,
}

impl TabulatedModel {
    /// A table of a model with its reactions and loads, in which every coefficient is within `accuracy`
    /// of its largest value.
    ///
    /// # Errors
    /// [`TableError`] for a domain that is empty or unbounded, or an accuracy that cannot be kept.
    pub fn new<M: TableModel>(
        exact: &ExactModel<M>,
        accuracy: f64,
        domain: TableDomain,
    ) -> Result<Self> {
        let mut builder = TableBuilder::new(ReducedModel::range(exact), domain, accuracy)?;
        let mut sampler = ModelSampler::new(exact);
        let model = exact.model();
        let counts = [model.reaction_count(), model.loads().len()];
        let (both, reactions, loads) = table_quantities(counts);
        let inertia = builder.curve(both, &mut exact.inertia_sampler())?;
        let relation = |one, other| sampler::relation(model, one, other);
        let mut columns = |quantities: &[TableQuantity]| {
            let mut sample = |q: f64, out: &mut [Dual]| sampler.sample(quantities, q, out);
            builder.columns(quantities, &relation, &mut sample)
        };
        Ok(Self {
            accuracy,
            is_angle: model.is_angle(0),
            inertia,
            reactions: columns(&reactions)?,
            loads: columns(&loads)?,
            counts,
            bounds: builder.bounds(),
        })
    }

    /// The requested accuracy.
    pub fn accuracy(&self) -> f64 {
        self.accuracy
    }

    /// The revolutions after which it repeats; none of a limited domain.
    pub fn revolutions(&self) -> Option<u32> {
        Some(self.inertia.grid.revolutions).filter(|&revolutions| revolutions > 0)
    }

    /// Its domain, rad or m; one period if the mechanism turns fully.
    pub fn domain(&self) -> [f64; 2] {
        self.inertia.grid.domain()
    }

    /// The error bound of each coefficient: m, ½m′, then a and b of all reactions, w and c of all loads.
    pub fn bounds(&self) -> &[Bound] {
        &self.bounds
    }

    /// The largest of all bounds, as a part of the scale.
    pub fn max_bound(&self) -> f64 {
        self.bounds.iter().fold(0.0, |max, b| max.max(b.error))
    }

    /// The number of cells of m and ½m′, of the reactions, and of the loads; zero without reactions or loads.
    pub fn cells(&self) -> [usize; 3] {
        let (reactions, loads) = (self.reactions.cells(), self.loads.cells());
        [self.inertia.cells(), reactions, loads]
    }

    /// Bytes in memory: of m and ½m′, and of everything.
    pub fn bytes(&self) -> [usize; 2] {
        let inertia = self.inertia.bytes();
        let all = inertia + self.reactions.bytes() + self.loads.bytes();
        [inertia, all]
    }

    /// A buffer for the responses to all loads.
    pub fn response_buffer(&self) -> UnitLoadResponses {
        let [reactions, loads] = self.counts;
        UnitLoadResponses {
            w: vec![0.0; loads],
            c: vec![0.0; loads * reactions],
        }
    }

    /// w and c of all loads at `q` (rad or m).
    ///
    /// # Errors
    /// [`PositionError`] outside the table.
    pub fn unit_load_responses(&self, q: f64, out: &mut UnitLoadResponses) -> PositionResult {
        self.loads.eval(q, &mut out.w, &mut out.c)
    }
}

impl ReducedModel for TabulatedModel {
    type Workspace = ();

    fn workspace(&self) {}

    fn reactions(&self) -> usize {
        self.counts[0]
    }

    fn range(&self) -> Range {
        match (self.revolutions(), self.domain()) {
            (Some(1), _) => Range::Full,
            (Some(revolutions), _) => Range::Revolutions(revolutions),
            // It is unknown beyond its ends, which are no limit positions.
            (None, [from, to]) => Range::Unresolved(from, to),
        }
    }

    #[inline]
    fn inertia(&self, q: f64, (): &mut ()) -> PositionResult<(f64, f64)> {
        self.inertia.eval(q).map(<(f64, f64)>::from)
    }

    fn inertia_derivatives(&self, q: f64, (): &mut ()) -> PositionResult<Inertia> {
        self.inertia.derivatives(q)
    }

    fn coefficients(&self, q: f64, (): &mut (), out: &mut Coefficients) -> PositionResult {
        [out.m, out.half_dm] = self.inertia.eval(q)?;
        self.reactions.eval(q, &mut out.a, &mut out.b)
    }
}

/// The coefficients in their order: m and ½m′, those of the reactions, those of the loads.
fn table_quantities(
    [reactions, loads]: [usize; 2],
) -> ([TableQuantity; 2], Vec<TableQuantity>, Vec<TableQuantity>) {
    let a = (0..reactions).map(|reaction| TableQuantity::A { reaction });
    let b = (0..reactions).map(|reaction| TableQuantity::B { reaction });
    let w = (0..loads).map(|load| TableQuantity::W { load });
    let of_load = |load| (0..reactions).map(move |reaction| TableQuantity::C { load, reaction });
    let c = (0..loads).flat_map(of_load);
    let inertia = [TableQuantity::M, TableQuantity::HalfDm];
    (inertia, a.chain(b).collect(), w.chain(c).collect())
}
