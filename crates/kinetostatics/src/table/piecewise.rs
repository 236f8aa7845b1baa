//! Pieces of a table: equal cells, each with one polynomial about its middle. Finding the cell and
//! evaluating it cost the same everywhere.
//!
//! A piece is Hermite's polynomial through values and slopes at [`NODES`] points of its cell, the ends
//! included, so that neighbours agree in value and slope. Of m only ½m′ is interpolated; m is its
//! continuous integral, and so it is with V and ½V′. Therefore m and V are single-valued functions of the
//! coordinate, and the energy of a motion on the table cannot drift.

use super::Result;
use super::build::{ColumnSampler, SlopeSampler};
use crate::error::PositionResult;
use crate::reduced::Inertia;
use dwell_geometry::PositionError;
use dwell_numerics::{Dual, Scalar};
use std::f64::consts::TAU;

/// Points of a cell at which a function and its slope are taken from the exact model.
pub(super) const NODES: usize = 4;
/// Coefficients of a piece: its degree is one less.
pub(super) const TERMS: usize = 2 * NODES;
/// The zeros of (1 − x²) P₃′(x), the Gauss–Lobatto points: between them the error is nearly uniform.
const LOBATTO_NODES: [f64; NODES] = [-1.0, -0.447_213_595_499_957_9, 0.447_213_595_499_957_9, 1.0];
/// Near the middles between these points, where the error of a piece is largest.
pub(super) const BETWEEN_NODES: [f64; NODES - 1] = [-0.76, 0.0, 0.76];
/// Revolutions that can be subtracted without a rounding: 2π is split after 30 bits, and a period may have 8 revolutions.
const MAX_REVOLUTIONS: f64 = 1_048_576.0;
/// 2π to 30 bits, and the rest of it.
const TAU_COARSE: f64 = 6.283_185_306_936_502_5;
const TAU_FINE: f64 = 2.430_840_202_602_477e-10;

/// Added to a number below 2³¹, it leaves no room for a fraction, and the integer in the last bits: rounds to
/// the nearest integer without a function call.
const ROUND_TO_NEAREST: f64 = 6_755_399_441_055_744.0;

/// Splits a count of cells, at least zero, into a cell and where in it from −1 to 1.
#[inline]
fn cell_and_offset(part: f64) -> (usize, f64) {
    let middle = part - 0.5;
    let cell = middle + ROUND_TO_NEAREST;
    let x = 2.0 * (middle - (cell - ROUND_TO_NEAREST));
    (cell.to_bits() as u32 as usize, x)
}

/// Equal cells over a domain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grid {
    /// Its lower end, rad or m; zero for a full revolution.
    pub(super) from: f64,
    pub(super) length: f64,
    /// Revolutions after which everything repeats itself; zero if it never does.
    pub(super) revolutions: u32,
    pub(super) cells: usize,
    per_period: f64,
    coarse: f64,
    fine: f64,
    per_cell: f64,
    /// The largest number below that of the cells.
    last: f64,
    /// Parts of a cell by which rounding may leave the domain; more for a coordinate of many
    /// revolutions.
    rounding_margin: f64,
}

impl Grid {
    pub(super) fn new(from: f64, length: f64, revolutions: u32, cells: usize) -> Self {
        let count = f64::from(revolutions);
        let (per_period, coarse, fine) = match revolutions {
            0 => (0.0, 0.0, 0.0),
            _ => (1.0 / (TAU * count), TAU_COARSE * count, TAU_FINE * count),
        };
        Self {
            from,
            length,
            revolutions,
            cells,
            per_period,
            coarse,
            fine,
            per_cell: cells as f64 / length,
            last: (cells as f64).next_down(),
            rounding_margin: if revolutions > 0 { 1e-3 } else { 1e-9 },
        }
    }

    /// This domain with another number of cells.
    pub(super) fn with_cells(self, cells: usize) -> Self {
        Self::new(self.from, self.length, self.revolutions, cells)
    }

    /// The domain, rad or m.
    pub(super) fn domain(&self) -> [f64; 2] {
        [self.from, self.from + self.length]
    }

    /// Half the width of a cell.
    pub(super) fn half(&self) -> f64 {
        0.5 * self.length / self.cells as f64
    }

    /// The coordinate at `x` from −1 to 1 of a cell; neighbours have the same number at their common end.
    pub(super) fn coordinate(&self, cell: usize, x: f64) -> f64 {
        let mut part = cell as f64 + 0.5 * (x + 1.0);
        if self.revolutions > 0 && part >= self.cells as f64 {
            part = 0.0;
        }
        self.from + self.length * (part / self.cells as f64)
    }

    /// The cell of a coordinate, and the position in it from −1 to 1.
    #[inline]
    pub(super) fn locate(&self, q: f64) -> PositionResult<(usize, f64)> {
        let part = (q - self.from) * self.per_cell;
        if part >= 0.0 && part < self.cells as f64 {
            Ok(cell_and_offset(part))
        } else {
            self.locate_wrapped(q)
        }
    }

    /// The cell of a coordinate in any number type.
    #[inline]
    fn locate_scalar<T: Scalar>(&self, q: T) -> PositionResult<(usize, T)> {
        let (cell, x) = self.locate(q.value())?;
        // The position in a cell is linear in q: only its slope remains.
        let x = q.compose(&[x, 2.0 * self.per_cell, 0.0, 0.0]);
        Ok((cell, x))
    }

    /// The cell of a coordinate that is outside the domain by whole periods or rounding; otherwise an error.
    #[inline]
    fn locate_wrapped(&self, q: f64) -> PositionResult<(usize, f64)> {
        let periods = (q * self.per_period - 0.5 + ROUND_TO_NEAREST) - ROUND_TO_NEAREST;
        let part =
            (((q - periods * self.coarse) - periods * self.fine) - self.from) * self.per_cell;
        let cells = self.cells as f64;
        let inside = part >= -self.rounding_margin && part <= cells + self.rounding_margin;
        if !(inside && periods.abs() < MAX_REVOLUTIONS) {
            return Err(self.out_of_range(q));
        }
        // A coordinate beyond an end by rounding belongs to the last cell.
        let (cell, x) = cell_and_offset(part.clamp(0.0, self.last));
        Ok((cell, x + 2.0 * (part - part.clamp(0.0, self.last))))
    }

    #[cold]
    fn out_of_range(&self, q: f64) -> PositionError {
        if !q.is_finite() {
            return PositionError::NotFinite;
        }
        let limit = MAX_REVOLUTIONS * TAU;
        let (from, to) = match self.revolutions {
            0 => (self.from, self.from + self.length),
            _ => (-limit, limit),
        };
        PositionError::OutOfRange { q, from, to }
    }
}

/// The coefficients, of rising powers of x, of Hermite's polynomial through `[value, slope]` (by x) at
/// [`LOBATTO_NODES`], by Newton's divided differences: common parts of neighbours are subtracted first, so that
/// rounding is relative to the differences.
fn hermite(data: &[[f64; 2]; NODES]) -> [f64; TERMS] {
    let node = |i: usize| LOBATTO_NODES[i / 2];
    let mut difference = [0.0; TERMS];
    for (i, d) in difference.iter_mut().enumerate() {
        *d = data[i / 2][0];
    }
    for order in 1..TERMS {
        for i in (order..TERMS).rev() {
            difference[i] = if order == 1 && i % 2 == 1 {
                data[i / 2][1]
            } else {
                (difference[i] - difference[i - 1]) / (node(i) - node(i - order))
            };
        }
    }
    // From Newton's products to powers, the last factor first.
    let mut powers = [0.0; TERMS];
    for i in (0..TERMS).rev() {
        for j in (1..TERMS).rev() {
            powers[j] = powers[j - 1] - node(i) * powers[j];
        }
        powers[0] = difference[i] - node(i) * powers[0];
    }
    powers
}

/// Coefficients of a function and half its slope side by side, of rising powers.
type CellCoefficients = [[f64; 2]; TERMS + 1];

/// A function of the coordinate integrated from half its slope: m from ½m′, V from ½V′.
#[derive(Debug, Clone, PartialEq)]
pub struct IntegratedCurve {
    pub(super) grid: Grid,
    cells: Vec<CellCoefficients>,
}

/// The function at the middle of a cell and the coefficients of half its slope, which define the cell.
pub(super) type CellData = (f64, [f64; TERMS]);

impl IntegratedCurve {
    pub(super) fn new(grid: Grid, sampler: &mut dyn SlopeSampler) -> Result<Self> {
        let half = grid.half();
        let mut slopes: Vec<[f64; TERMS]> = Vec::with_capacity(grid.cells);
        // By cell: the function at its points; the first belongs to the cell before.
        let mut known = Vec::with_capacity(grid.cells);
        let first = sampler.sample(grid.coordinate(0, LOBATTO_NODES[0]))?;
        let mut left = first;
        for cell in 0..grid.cells {
            let mut at = [left; NODES];
            for (at, &x) in at.iter_mut().zip(&LOBATTO_NODES).skip(1) {
                let q = grid.coordinate(cell, x);
                // A period ends where it began.
                let again = grid.revolutions > 0 && q == grid.from;
                *at = if again { first } else { sampler.sample(q)? };
            }
            left = at[NODES - 1];
            known.push(at.map(|at| at.m));
            slopes.push(hermite(&at.map(|at| [at.half_dm, at.half_ddm * half])));
        }
        if grid.revolutions > 0 {
            // The gain over a period is truncation and rounding: its mean is subtracted.
            let gains = slopes.iter().map(|g| integrate_slope(g, half, [-1.0, 1.0]));
            let gain: f64 = gains.sum();
            for slope in &mut slopes {
                slope[0] -= gain / (2.0 * grid.length);
            }
        }
        // From middle to middle, so that the ends agree; then shifted to the mean of the exact values.
        let mut middle = Vec::with_capacity(grid.cells);
        let (mut m, mut shift) = (0.0, 0.0);
        for (cell, slope) in slopes.iter().enumerate() {
            if let Some(before) = cell.checked_sub(1).and_then(|b| slopes.get(b)) {
                m += integrate_slope(before, half, [0.0, 1.0])
                    + integrate_slope(slope, half, [-1.0, 0.0]);
            }
            middle.push(m);
            for (known, &x) in known[cell].iter().zip(&LOBATTO_NODES).skip(1) {
                shift += known - (m + integrate_slope(slope, half, [0.0, x]));
            }
        }
        let shift = shift / ((NODES - 1) * grid.cells) as f64;
        let cells = middle.iter().zip(&slopes);
        let cell_data = cells.map(|(m, slope)| (m + shift, *slope));
        Ok(Self::from_cell_data(grid, cell_data))
    }

    /// The cells from m in their middles and ½m′.
    pub(super) fn from_cell_data(
        grid: Grid,
        cell_data: impl IntoIterator<Item = CellData>,
    ) -> Self {
        let half = grid.half();
        let cell = |(m, slope): CellData| {
            let mut cell = [[0.0; 2]; TERMS + 1];
            cell[0][0] = m;
            for (j, g) in slope.iter().enumerate() {
                cell[j][1] = *g;
                cell[j + 1][0] = 2.0 * half * g / (j + 1) as f64;
            }
            cell
        };
        Self {
            grid,
            cells: cell_data.into_iter().map(cell).collect(),
        }
    }

    pub(super) fn cell_data(&self) -> impl Iterator<Item = CellData> {
        self.cells.iter().map(|cell| {
            let mut slope = [0.0; TERMS];
            for (s, pair) in slope.iter_mut().zip(cell) {
                *s = pair[1];
            }
            (cell[0][0], slope)
        })
    }

    /// The function and half its slope at `q` (rad or m).
    ///
    /// # Errors
    /// [`PositionError`] outside the table.
    #[inline]
    pub fn eval<T: Scalar>(&self, q: T) -> PositionResult<[T; 2]> {
        let (cell, x) = self.grid.locate_scalar(q)?;
        Ok(eval_cell(&self.cells[cell], x))
    }

    /// The function, half its slope and half its second derivative.
    ///
    /// # Errors
    /// [`PositionError`] outside the table.
    #[inline]
    pub fn derivatives(&self, q: f64) -> PositionResult<Inertia> {
        let (cell, x) = self.grid.locate(q)?;
        let cell = &self.cells[cell];
        let [m, half_dm] = eval_cell(cell, x);
        let powers = (1..TERMS).rev();
        let slope = powers.fold(0.0, |sum, j| sum * x + j as f64 * cell[j][1]);
        Ok(Inertia {
            m,
            half_dm,
            half_ddm: slope / self.grid.half(),
        })
    }

    /// How many cells it has.
    pub fn cells(&self) -> usize {
        self.grid.cells
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        std::mem::size_of_val(self.cells.as_slice())
    }
}

/// The change of m between two positions in a cell, from ½m′.
fn integrate_slope(slope: &[f64; TERMS], half: f64, [from, to]: [f64; 2]) -> f64 {
    let integral = |x: f64| {
        let terms = slope.iter().enumerate().rev();
        terms.fold(0.0, |sum, (j, g)| (sum + g / (j + 1) as f64) * x)
    };
    2.0 * half * (integral(to) - integral(from))
}

/// Both polynomials at once, in pairs of terms (Estrin's scheme), which are independent of each other.
#[inline]
fn eval_cell<T: Scalar>(c: &CellCoefficients, x: T) -> [T; 2] {
    let lift = |[a, b]: [f64; 2]| [T::from_f64(a), T::from_f64(b)];
    let add = |a: [T; 2], b: [T; 2], x: T| [a[0] + b[0] * x, a[1] + b[1] * x];
    let line = |i: usize| add(lift(c[i]), lift(c[i + 1]), x);
    let (x2, x4) = (x * x, (x * x) * (x * x));
    let low = add(line(0), line(2), x2);
    let high = add(line(4), line(6), x2);
    add(low, add(high, lift(c[8]), x4), x4)
}

/// Any number of functions of the coordinate, side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct PiecewiseColumns {
    pub(super) grid: Grid,
    pub(super) width: usize,
    /// By cell, by falling power, by column.
    pub(super) terms: Vec<f64>,
}

impl PiecewiseColumns {
    pub(super) fn empty(grid: Grid) -> Self {
        Self {
            grid,
            width: 0,
            terms: Vec::new(),
        }
    }

    pub(super) fn new(grid: Grid, width: usize, sampler: &mut ColumnSampler<'_>) -> Result<Self> {
        let mut terms = Vec::with_capacity(grid.cells * TERMS * width);
        let half = grid.half();
        let mut nodes = vec![vec![Dual::default(); width]; NODES];
        sampler(grid.coordinate(0, LOBATTO_NODES[0]), &mut nodes[NODES - 1])?;
        for cell in 0..grid.cells {
            // A cell begins where the one before ended.
            nodes.swap(0, NODES - 1);
            for (node, &x) in nodes.iter_mut().zip(&LOBATTO_NODES).skip(1) {
                sampler(grid.coordinate(cell, x), node)?;
            }
            let offset = terms.len();
            terms.resize(offset + TERMS * width, 0.0);
            for column in 0..width {
                let mut data = [[0.0; 2]; NODES];
                for (data, node) in data.iter_mut().zip(&nodes) {
                    *data = [node[column].v, node[column].d * half];
                }
                for (j, term) in hermite(&data).into_iter().enumerate() {
                    terms[offset + (TERMS - 1 - j) * width + column] = term;
                }
            }
        }
        Ok(Self { grid, width, terms })
    }

    /// All columns at `q` (rad or m), the first `left.len()` of them to `left`, the others to `right`.
    ///
    /// # Errors
    /// [`PositionError`] outside the table.
    #[inline]
    pub fn eval<T: Scalar>(&self, q: T, left: &mut [T], right: &mut [T]) -> PositionResult {
        let (cell, x) = self.grid.locate_scalar(q)?;
        let size = TERMS * self.width;
        if size == 0 {
            return Ok(());
        }
        left.fill(T::from_f64(0.0));
        right.fill(T::from_f64(0.0));
        for row in self.terms[cell * size..][..size].chunks_exact(self.width) {
            let (first, second) = row.split_at(left.len().min(row.len()));
            horner(left, first, x);
            horner(right, second, x);
        }
        Ok(())
    }

    /// The number of cells; zero without columns.
    pub fn cells(&self) -> usize {
        if self.width > 0 { self.grid.cells } else { 0 }
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        std::mem::size_of_val(self.terms.as_slice())
    }
}

/// One step of Horner's scheme, of several polynomials side by side.
#[inline]
fn horner<T: Scalar>(sums: &mut [T], terms: &[f64], x: T) {
    for (sum, &term) in sums.iter_mut().zip(terms) {
        *sum = *sum * x + T::from_f64(term);
    }
}
