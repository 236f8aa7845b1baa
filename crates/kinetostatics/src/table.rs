//! Tables of the reduced model: m, ½m′, a, b, w and c as piecewise polynomials of the coordinate, in place
//! of the mechanism.
//!
//! How many cells a table has follows from how fast the coefficients of a global series fall ([`fit`]:
//! trigonometric over full turns, Chebyshev's over a limited extent); its values come from cells of equal
//! size at a constant cost ([`pieces`]); how far it is off is measured, not estimated ([`bound`]).
//!
//! A limited range ends at limit positions, where everything grows without bound, so a table covers an inner
//! part of it. Outside there is an error and no value: a table that is read from a file has no mechanism to
//! fall back on, and a motion that changed from one to the other would change its energy.

mod bound;
mod file;
mod fit;
mod make;
mod pieces;
mod source;

pub use file::{FileError, Labels};
pub use make::{Fill, Maker, Slopes};
pub use pieces::{Columns, Curve};
pub use source::Inertias;

use crate::kinetostatics::KinetostaticsError;
use crate::reduced::{Coefficients, Exact, Inertia, Reduced};
use dwell_geometry::{Dual, PlaceError, Range};
use pieces::Grid;
use source::Source;
use std::fmt;
use thiserror::Error;

/// Over which coordinates a table reaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// All turns of a mechanism that turns fully; of a limited range all but 2 % of it at each end.
    Whole,
    /// From one coordinate to another, rad or m.
    Between(f64, f64),
}

/// A function of the coordinate that a table may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Entry {
    /// m.
    M,
    /// ½m′.
    HalfDm,
    /// What multiplies q̈ in a reaction.
    A {
        /// Index of the reaction.
        reaction: usize,
    },
    /// What multiplies q̇² in a reaction.
    B {
        /// Index of the reaction.
        reaction: usize,
    },
    /// What one unit of a load gives the coordinate.
    W {
        /// Index of the load.
        load: usize,
    },
    /// What one unit of a load gives a reaction.
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
    /// Something measured that loads or drives depend on, less what it gains evenly with q.
    S {
        /// Its index.
        measured: usize,
    },
    /// Its derivative by q.
    Ds {
        /// Its index.
        measured: usize,
    },
}

impl fmt::Display for Entry {
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
            Self::S { measured } => write!(f, "measured coordinate {measured}"),
            Self::Ds { measured } => write!(f, "the slope of measured coordinate {measured}"),
        }
    }
}

/// Why there is no table.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TableError {
    /// An accuracy that cannot be kept in double precision, or none at all.
    #[error("a table's accuracy is between 1e-14 and 1e-2, not {accuracy:e}")]
    Accuracy {
        /// What was asked for.
        accuracy: f64,
    },
    /// An extent that is empty, not finite or not inside the range.
    #[error("a table cannot reach from {from} to {to}: that is empty, or leaves the range")]
    Extent {
        /// Lower end, rad or m.
        from: f64,
        /// Upper end, rad or m.
        to: f64,
    },
    /// The range has no end and the mechanism does not come back.
    #[error("the range has no ends: say from where to where the table is to reach")]
    Endless,
    /// A coefficient that is not the same a period later, such as that of a spring that winds up.
    #[error(
        "{what} does not come back after a turn: say from where to where the table is to reach"
    )]
    NotPeriodic {
        /// Which.
        what: Entry,
    },
    /// The coefficients of the series do not fall to the accuracy.
    #[error(
        "not smooth enough for a table over so much: {points} samples leave {left:.1e} of the largest value"
    )]
    NotSmooth {
        /// Samples taken.
        points: usize,
        /// The last coefficients, as a part of the largest value.
        left: f64,
    },
    /// No number of cells reaches the accuracy.
    #[error("no table of {accuracy:e}: {what} is known to {reached:.1e} of its largest value")]
    NotReached {
        /// The coefficient that is furthest off.
        what: Entry,
        /// The best bound that was reached, as a part of the scale.
        reached: f64,
        /// What was asked for.
        accuracy: f64,
    },
    /// The exact model has no pose, or a load no direction, within the extent.
    #[error(transparent)]
    Exact(#[from] KinetostaticsError),
}

impl From<PlaceError> for TableError {
    fn from(error: PlaceError) -> Self {
        Self::Exact(error.into())
    }
}

/// What is known of one coefficient of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Which.
    pub of: Entry,
    /// What it is measured by: its largest value (for one that nearly vanishes, a thousandth of the
    /// largest of its kind), in its own unit.
    pub scale: f64,
    /// It is off by no more than this part of the scale.
    pub error: f64,
}

/// What the loads do at one coordinate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Channels {
    /// By load: w.
    pub w: Vec<f64>,
    /// By load, then by reaction: c.
    pub c: Vec<f64>,
}

/// A table of the whole reduced model of one degree of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    accuracy: f64,
    angle: bool,
    inertia: Curve,
    reactions: Columns,
    loads: Columns,
    /// How many reactions and loads.
    counts: [usize; 2],
    /// m and ½m′, then a, b, w and c.
    bounds: Vec<Bound>,
}

impl Table {
    /// A table of a model with its reactions and loads, in which every coefficient is within `accuracy`
    /// of its largest value.
    ///
    /// # Errors
    /// [`TableError`] when there is nothing to reach over, or the accuracy cannot be kept.
    pub fn new(exact: &Exact, accuracy: f64, extent: Extent) -> Result<Self, TableError> {
        let mut maker = Maker::new(exact.range(), extent, accuracy)?;
        let mut source = Source::new(exact);
        let model = exact.model();
        let counts = [model.reactions().len(), model.loads().len()];
        let (both, reactions, loads) = entries(counts);
        let inertia = maker.curve(both, &mut exact.slopes())?;
        let alike = |one, other| source::alike(exact, one, other);
        let mut columns = |which: &[Entry]| {
            let mut fill = |q: f64, out: &mut [Dual]| source.fill(which, q, out);
            maker.columns(which, &alike, &mut fill)
        };
        Ok(Self {
            accuracy,
            angle: model.plan().is_angle(0),
            inertia,
            reactions: columns(&reactions)?,
            loads: columns(&loads)?,
            counts,
            bounds: maker.bounds(),
        })
    }

    /// The accuracy asked for.
    pub fn accuracy(&self) -> f64 {
        self.accuracy
    }

    /// The turns after which it repeats itself; none of a limited extent.
    pub fn turns(&self) -> Option<u32> {
        Some(self.inertia.grid.turns).filter(|&turns| turns > 0)
    }

    /// From where to where it reaches, rad or m; of a mechanism that turns fully, one period.
    pub fn extent(&self) -> [f64; 2] {
        let Grid { from, length, .. } = self.inertia.grid;
        [from, from + length]
    }

    /// How far each coefficient may be off: m, ½m′, then a and b of all reactions, w and c of all loads.
    pub fn bounds(&self) -> &[Bound] {
        &self.bounds
    }

    /// The largest of all bounds, as a part of the scale.
    pub fn bound(&self) -> f64 {
        self.bounds.iter().fold(0.0, |most, b| most.max(b.error))
    }

    /// Cells of m and ½m′, of the reactions, of the loads; none where there are none.
    pub fn cells(&self) -> [usize; 3] {
        [
            self.inertia.cells(),
            self.reactions.cells(),
            self.loads.cells(),
        ]
    }

    /// Bytes in memory: of m and ½m′, and of everything.
    pub fn bytes(&self) -> [usize; 2] {
        let inertia = self.inertia.bytes();
        [
            inertia,
            inertia + self.reactions.bytes() + self.loads.bytes(),
        ]
    }

    /// Room for the channels of all loads.
    pub fn channel_room(&self) -> Channels {
        let [reactions, loads] = self.counts;
        Channels {
            w: vec![0.0; loads],
            c: vec![0.0; loads * reactions],
        }
    }

    /// w and c of all loads at `q` (rad or m).
    ///
    /// # Errors
    /// [`PlaceError`] outside the table.
    pub fn channels(&self, q: f64, out: &mut Channels) -> Result<(), PlaceError> {
        self.loads.at(q, &mut out.w, &mut out.c)
    }
}

impl Reduced for Table {
    type Work = ();

    fn work(&self) {}

    fn reactions(&self) -> usize {
        self.counts[0]
    }

    fn range(&self) -> Range {
        match (self.turns(), self.extent()) {
            (Some(1), _) => Range::Full,
            (Some(turns), _) => Range::Turns(turns),
            // Nothing is known beyond; where a limit position is, the table has not come to.
            (None, [from, to]) => Range::Followed(from, to),
        }
    }

    #[inline]
    fn inertia(&self, q: f64, (): &mut ()) -> Result<(f64, f64), PlaceError> {
        self.inertia.at(q).map(<(f64, f64)>::from)
    }

    fn curvature(&self, q: f64, (): &mut ()) -> Result<Inertia, PlaceError> {
        self.inertia.curvature(q)
    }

    fn coefficients(&self, q: f64, (): &mut (), out: &mut Coefficients) -> Result<(), PlaceError> {
        [out.m, out.half_dm] = self.inertia.at(q)?;
        self.reactions.at(q, &mut out.a, &mut out.b)
    }
}

/// The coefficients in their order: m and ½m′, those of the reactions, those of the loads.
fn entries([reactions, loads]: [usize; 2]) -> ([Entry; 2], Vec<Entry>, Vec<Entry>) {
    let a = (0..reactions).map(|reaction| Entry::A { reaction });
    let b = (0..reactions).map(|reaction| Entry::B { reaction });
    let w = (0..loads).map(|load| Entry::W { load });
    let c =
        (0..loads).flat_map(|load| (0..reactions).map(move |reaction| Entry::C { load, reaction }));
    let inertia = [Entry::M, Entry::HalfDm];
    (inertia, a.chain(b).collect(), w.chain(c).collect())
}
