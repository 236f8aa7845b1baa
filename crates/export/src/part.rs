//! Functions of the coordinate in cells of uneven width: many narrow ones where the functions bend, few wide ones
//! elsewhere. A domain has equal bins, each of which belongs to one cell, so that finding the cell costs the same everywhere.

use crate::machine::{Domain, Function};

/// Coefficients of a piece: its degree is one less.
pub(crate) const TERMS: usize = 8;
/// Numbers of a cell before its coefficients: its middle, the inverse of half its width and its width.
pub(crate) const HEAD: usize = 3;
/// Numbers of a curve in a cell: its value at the middle and the coefficients of half its slope.
pub(crate) const CURVE: usize = 1 + TERMS;

/// The numbers of the export.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Four bytes.
    Float,
    /// Eight bytes.
    Double,
}

impl Precision {
    /// Bytes of a number.
    pub fn bytes(self) -> usize {
        match self {
            Self::Float => 4,
            Self::Double => 8,
        }
    }

    /// The unit in which errors are measured, in words.
    pub(crate) fn measured_in(self) -> &'static str {
        match self {
            Self::Double => "double precision",
            Self::Float => "single precision, its rounding included",
        }
    }

    /// The number that is stored.
    pub fn round(self, value: f64) -> f64 {
        match self {
            Self::Float => f64::from(value as f32),
            Self::Double => value,
        }
    }
}

/// Where a function is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Column {
    /// The column is a constant.
    Constant(f64),
    /// The column is the k-th of those in the cells.
    Tabulated(usize),
}

/// Functions of the coordinate that are looked up together.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The functions that come with half their slope; all of them are in the cells.
    pub curves: Vec<Function>,
    /// The other functions, and where each is found.
    pub columns: Vec<(Function, Column)>,
    /// By bin: its cell. Empty without cells.
    pub index: Vec<u16>,
    /// By cell: [`HEAD`], then [`CURVE`] numbers for each curve, then [`TERMS`] for each tabulated column, all by rising powers.
    pub cells: Vec<f64>,
    /// Bins for each unit of the coordinate.
    pub bins_per_unit: f64,
}

impl Part {
    /// Numbers of a cell.
    pub fn stride(&self) -> usize {
        HEAD + CURVE * self.curves.len() + TERMS * self.tabulated()
    }

    /// How many columns are in the cells.
    pub fn tabulated(&self) -> usize {
        let tabulated = |(_, column): &&(_, Column)| matches!(column, Column::Tabulated(_));
        self.columns.iter().filter(tabulated).count()
    }

    /// How many cells it has.
    pub fn cell_count(&self) -> usize {
        self.cells.len() / self.stride()
    }

    /// Bytes of an entry of the index.
    pub fn index_bytes(&self) -> usize {
        if self.cell_count() <= 256 { 1 } else { 2 }
    }

    /// Bytes of its constants.
    pub fn bytes(&self, precision: Precision) -> usize {
        self.cells.len() * precision.bytes() + self.index.len() * self.index_bytes()
    }
}

/// The numbers with which whole periods are subtracted from a coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wrapping {
    /// One over the period.
    pub per_period: f64,
    /// The leading bits of the period: products with counts of periods are exact.
    pub coarse: f64,
    /// The rest of it.
    pub fine: f64,
    /// The largest coordinate.
    pub limit: f64,
}

impl Wrapping {
    /// The wrapping of a periodic domain.
    pub(crate) fn new(domain: Domain, precision: Precision) -> Option<Self> {
        let period = domain.length();
        let (bits, periods) = match precision {
            Precision::Float => (8, 4096.0),
            Precision::Double => (29, 1_048_576.0),
        };
        (domain.revolutions > 0).then(|| {
            let scale = f64::powi(2.0, bits - 1 - period.log2().floor() as i32);
            let coarse = (period * scale).floor() / scale;
            Self {
                per_period: precision.round(1.0 / period),
                coarse,
                fine: precision.round(fine_period(domain, coarse)),
                limit: precision.round(period * periods),
            }
        })
    }
}

/// The period without its leading bits, with 2π to more digits than a double has.
fn fine_period(domain: Domain, coarse: f64) -> f64 {
    /// 2π less the double nearest to it.
    const TAU_REST: f64 = 2.449_293_598_294_706_4e-16;
    (domain.length() - coarse) + f64::from(domain.revolutions) * TAU_REST
}
