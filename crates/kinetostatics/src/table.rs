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
mod pieces;
mod source;

pub use file::{FileError, Labels};

use crate::kinetostatics::KinetostaticsError;
use crate::reduced::{Coefficients, Exact, Inertia, Reduced};
use dwell_geometry::{Dual, PlaceError, Range};
use fit::Fit;
use pieces::{Columns, Grid, Inertias};
use source::Source;
use std::f64::consts::TAU;
use std::fmt;
use thiserror::Error;

/// Part of a limited range that is left out at each end, if no extent is given: the inertia grows as one
/// over the distance to a limit position, and everything is measured by its largest value.
const LEFT_OUT: f64 = 0.02;
/// A coefficient that a whole turn changes by more than this part of its scale does not come back.
const SAME: f64 = 1e-9;
/// Where they are compared, in parts of a period.
const COMPARED: [f64; 5] = [0.0, 0.131, 0.292, 0.583, 0.877];

/// Over which coordinates a table reaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// All turns of a mechanism that turns fully; of a limited range all but 2 % of it at each end.
    Whole,
    /// From one coordinate to another, rad or m.
    Between(f64, f64),
}

/// A coefficient of the reduced model.
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
        "not smooth enough for a table: with {points} samples, {left:.1e} of the largest value is left"
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
    inertia: Inertias,
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
        if !(1e-14..=1e-2).contains(&accuracy) {
            return Err(TableError::Accuracy { accuracy });
        }
        let grid = reach(exact.range(), extent)?;
        let mut source = Source::new(exact);
        let mut bounds = Vec::new();

        let model = exact.model();
        let counts = [model.reactions().len(), model.loads().len()];
        let [both, reactions, loads] = entries(counts);
        let fit = fit_inertia(grid, accuracy, &mut source)?;
        let made = bound::size::<Inertias>(grid, &both, &fit, accuracy, &mut source)?;
        let inertia = note(&mut bounds, &both, &fit, made);

        let mut columns = |which: &[Entry]| {
            if which.is_empty() {
                return Columns::new(grid, which, &mut source);
            }
            let fit = fit_columns(grid, accuracy, which, &mut source)?;
            let made = bound::size::<Columns>(grid, which, &fit, accuracy, &mut source)?;
            Ok(note(&mut bounds, which, &fit, made))
        };
        Ok(Self {
            accuracy,
            angle: model.plan().is_angle(0),
            inertia,
            reactions: columns(&reactions)?,
            loads: columns(&loads)?,
            counts,
            bounds,
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
        let of = |columns: &Columns| match columns.width {
            0 => 0,
            _ => columns.grid.cells,
        };
        [
            self.inertia.grid.cells,
            of(&self.reactions),
            of(&self.loads),
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
        self.inertia.at(q)
    }

    fn curvature(&self, q: f64, (): &mut ()) -> Result<Inertia, PlaceError> {
        self.inertia.curvature(q)
    }

    fn coefficients(&self, q: f64, (): &mut (), out: &mut Coefficients) -> Result<(), PlaceError> {
        (out.m, out.half_dm) = self.inertia.at(q)?;
        self.reactions.at(q, &mut out.a, &mut out.b)
    }
}

/// The coefficients in their order: m and ½m′, those of the reactions, those of the loads.
fn entries([reactions, loads]: [usize; 2]) -> [Vec<Entry>; 3] {
    let a = (0..reactions).map(|reaction| Entry::A { reaction });
    let b = (0..reactions).map(|reaction| Entry::B { reaction });
    let w = (0..loads).map(|load| Entry::W { load });
    let c =
        (0..loads).flat_map(|load| (0..reactions).map(move |reaction| Entry::C { load, reaction }));
    let inertia = vec![Entry::M, Entry::HalfDm];
    [inertia, a.chain(b).collect(), w.chain(c).collect()]
}

/// The extent as a grid of one cell.
fn reach(range: Range, extent: Extent) -> Result<Grid, TableError> {
    let (from, to) = match (extent, range.period(), range.limits()) {
        (Extent::Whole, Some(period), _) => {
            let turns = (period / TAU).round() as u32;
            return Ok(Grid::new(0.0, period, turns, 1));
        }
        (Extent::Whole, None, None) => return Err(TableError::Endless),
        (Extent::Whole, None, Some((from, to))) => {
            let margin = LEFT_OUT * (to - from);
            (from + margin, to - margin)
        }
        (Extent::Between(from, to), _, limits) => {
            let inside = limits.is_none_or(|(lowest, highest)| lowest <= from && to <= highest);
            if !(inside && from < to && (to - from).is_finite()) {
                return Err(TableError::Extent { from, to });
            }
            (from, to)
        }
    };
    Ok(Grid::new(from, to - from, 0, 1))
}

fn fit_inertia(grid: Grid, accuracy: f64, source: &mut Source<'_>) -> Result<Fit, TableError> {
    // m over a radian of a turn, or as much of an extent, is of the kind of ½m′.
    let per_turn = TAU / grid.length;
    let scale = |largest: &[f64]| {
        let weighed = [largest[0], largest[1] / per_turn];
        let [m, slope] = [
            weighed[0],
            fit::scales(&weighed, &|_, _| true)[1] * per_turn,
        ];
        vec![m, slope]
    };
    let mut values = |q: f64, out: &mut [f64]| {
        let at = source.inertia(q)?;
        out.copy_from_slice(&[at.m, at.half_dm]);
        Ok(())
    };
    fit::fit(grid, 2, accuracy, &scale, &mut values)
}

fn fit_columns(
    grid: Grid,
    accuracy: f64,
    which: &[Entry],
    source: &mut Source<'_>,
) -> Result<Fit, TableError> {
    let alike: Vec<bool> = which
        .iter()
        .flat_map(|&one| which.iter().map(move |&other| (one, other)))
        .map(|(one, other)| source.alike(one, other))
        .collect();
    let width = which.len();
    let scale = |largest: &[f64]| fit::scales(largest, &|i, j| alike[i * width + j]);
    let mut here = vec![Dual::default(); width];
    let mut values = |q: f64, out: &mut [f64]| {
        source.fill(which, q, &mut here)?;
        for (out, here) in out.iter_mut().zip(&here) {
            *out = here.v;
        }
        Ok(())
    };
    if grid.turns > 0 {
        comes_back(grid, which, &scale, &mut values)?;
    }
    fit::fit(grid, width, accuracy, &scale, &mut values)
}

/// Refuses coefficients that are not the same a period later.
fn comes_back(
    grid: Grid,
    which: &[Entry],
    scale: &dyn Fn(&[f64]) -> Vec<f64>,
    values: &mut fit::Values<'_>,
) -> Result<(), TableError> {
    let (mut here, mut later) = (vec![0.0; which.len()], vec![0.0; which.len()]);
    let (mut largest, mut apart) = (here.clone(), here.clone());
    for part in COMPARED {
        let q = grid.from + part * grid.length;
        values(q, &mut here)?;
        values(q + grid.length, &mut later)?;
        for k in 0..which.len() {
            largest[k] = here[k].abs().max(largest[k]);
            apart[k] = (here[k] - later[k]).abs().max(apart[k]);
        }
    }
    let scales = scale(&largest);
    let gone = (0..which.len()).find(|&k| apart[k] > SAME * scales[k]);
    match gone {
        Some(k) => Err(TableError::NotPeriodic { what: which[k] }),
        None => Ok(()),
    }
}

/// Takes down the bounds of what was made.
fn note<P>(bounds: &mut Vec<Bound>, which: &[Entry], fit: &Fit, made: (P, Vec<f64>)) -> P {
    let (pieces, errors) = made;
    let known = which.iter().zip(&fit.scales).zip(errors);
    bounds.extend(known.map(|((&of, &scale), error)| Bound { of, scale, error }));
    pieces
}
