//! The functions of a part at a coordinate: looked up in cells, or by their operations.

use super::Status;
use crate::machine::Domain;
use crate::part::{CURVE, Column, HEAD, Part, Precision, TERMS, Wrapping};
use dwell_numerics::Real;
use dwell_numerics::StraightLine;

/// The source of the functions of a part. Their values are value and half slope of each curve, the columns, then the slopes
/// of the columns of motion (zero for a column that moves no rotor).
#[derive(Debug, Clone)]
pub(crate) enum Functions<R> {
    /// Functions in cells.
    Cells(Pieces<R>),
    /// Functions as operations.
    Code(StraightLine),
}

impl<R: Real> Functions<R> {
    /// The values at a coordinate within the domain.
    pub(crate) fn at(&self, q: R) -> Vec<R> {
        match self {
            Self::Cells(pieces) => pieces.at(q),
            Self::Code(code) => code.evaluate(&[q]),
        }
    }
}

/// The pieces of a part in one kind of number.
#[derive(Debug, Clone)]
pub(crate) struct Pieces<R> {
    cells: Vec<R>,
    index: Vec<u16>,
    stride: usize,
    from: R,
    bins_per_unit: R,
    curves: usize,
    columns: Vec<Column>,
    /// For the columns of motion: whether the slope is needed.
    slopes: Vec<bool>,
}

/// A place in a cell: where its numbers begin, and the powers of the position in it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<R> {
    begin: usize,
    x: R,
    x2: R,
    x4: R,
}

impl<R: Real> Pieces<R> {
    pub(crate) fn new(part: &Part, domain: Domain, slopes: Vec<bool>) -> Self {
        Self {
            cells: part.cells.iter().map(|&n| R::of(n)).collect(),
            index: part.index.clone(),
            stride: part.stride(),
            from: R::of(domain.from),
            bins_per_unit: R::of(part.bins_per_unit),
            curves: part.curves.len(),
            columns: part.columns.iter().map(|(_, column)| *column).collect(),
            slopes,
        }
    }

    fn at(&self, q: R) -> Vec<R> {
        let at = self.place(q);
        let curves = (0..self.curves).flat_map(|k| self.curve(k, at));
        let columns = self.columns.iter().map(|column| self.column(column, at));
        let slopes = self.columns.iter().zip(&self.slopes);
        let slopes = slopes.map(|(column, &wanted)| match column {
            Column::Tabulated(j) if wanted => {
                slope(self.terms(*j, at), at) * self.cells[at.begin + 1]
            }
            _ => R::of(0.0),
        });
        curves.chain(columns).chain(slopes).collect()
    }

    /// Finds the cell of a coordinate within the domain.
    fn place(&self, q: R) -> Place<R> {
        let zero = R::of(0.0);
        if self.index.is_empty() {
            return Place {
                begin: 0,
                x: zero,
                x2: zero,
                x4: zero,
            };
        }
        let bin = ((q - self.from) * self.bins_per_unit).to_f64() as usize;
        let cell = self.index[bin.min(self.index.len() - 1)];
        let begin = usize::from(cell) * self.stride;
        let x = (q - self.cells[begin]) * self.cells[begin + 1];
        let x2 = x * x;
        Place {
            begin,
            x,
            x2,
            x4: x2 * x2,
        }
    }

    /// A curve and half its slope.
    fn curve(&self, k: usize, at: Place<R>) -> [R; 2] {
        let of = &self.cells[at.begin + HEAD + CURVE * k..][..CURVE];
        let width = self.cells[at.begin + 2];
        let value = of[0] + width * integral(&of[1..], at);
        [value, polynomial(&of[1..], at)]
    }

    fn column(&self, column: &Column, at: Place<R>) -> R {
        match *column {
            Column::Constant(value) => R::of(value),
            Column::Tabulated(j) => polynomial(self.terms(j, at), at),
        }
    }

    fn terms(&self, tabulated: usize, at: Place<R>) -> &[R] {
        let first = at.begin + HEAD + CURVE * self.curves;
        &self.cells[first + TERMS * tabulated..][..TERMS]
    }
}

/// Seven powers in pairs of terms (Estrin's scheme), which are independent of each other.
fn polynomial<R: Real>(c: &[R], at: Place<R>) -> R {
    let Place { x, x2, x4, .. } = at;
    ((c[0] + c[1] * x) + (c[2] + c[3] * x) * x2) + ((c[4] + c[5] * x) + (c[6] + c[7] * x) * x2) * x4
}

/// The integral of the same from zero.
fn integral<R: Real>(c: &[R], at: Place<R>) -> R {
    let Place { x, x2, x4, .. } = at;
    let part = |j: usize| c[j] * R::of(1.0 / (j + 1) as f64);
    x * (((c[0] + part(1) * x) + (part(2) + part(3) * x) * x2)
        + ((part(4) + part(5) * x) + (part(6) + part(7) * x) * x2) * x4)
}

/// The derivative of the same.
fn slope<R: Real>(c: &[R], at: Place<R>) -> R {
    let Place { x, x2, x4, .. } = at;
    let times = |j: usize| c[j] * R::of(j as f64);
    ((c[1] + times(2) * x) + (times(3) + times(4) * x) * x2)
        + ((times(5) + times(6) * x) + times(7) * x2) * x4
}

/// Brings coordinates into the domain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Range<R> {
    from: R,
    to: R,
    wrapping: Option<[R; 4]>,
}

impl<R: Real> Range<R> {
    pub(crate) fn new(domain: Domain, precision: Precision) -> Self {
        let wrapping = Wrapping::new(domain, precision);
        Self {
            from: R::of(domain.from),
            to: R::of(domain.to),
            wrapping: wrapping.map(|w| [w.per_period, w.coarse, w.fine, w.limit].map(R::of)),
        }
    }

    /// The coordinate within the domain.
    pub(crate) fn wrap(&self, q: R) -> Result<R, Status> {
        let outside = || {
            if q.to_f64().is_finite() {
                Status::OutOfRange
            } else {
                Status::NotFinite
            }
        };
        let Some([per_period, coarse, fine, limit]) = self.wrapping else {
            let inside = (self.from.to_f64()..=self.to.to_f64()).contains(&q.to_f64());
            return if inside { Ok(q) } else { Err(outside()) };
        };
        let limits = (R::of(0.0) - limit).to_f64()..=limit.to_f64();
        if !limits.contains(&q.to_f64()) {
            return Err(outside());
        }
        // Truncated towards zero.
        let periods = R::of(f64::from((q * per_period).to_f64() as i32));
        let rest = (q - periods * coarse) - periods * fine;
        Ok(if rest.to_f64() < 0.0 {
            rest + self.to
        } else {
            rest
        })
    }
}
