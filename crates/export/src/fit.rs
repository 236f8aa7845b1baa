//! Fits the cells of a part: from the left, each as wide as its accuracy allows.
//!
//! A piece interpolates at Chebyshev's nodes. Of a curve only half the slope is interpolated, shifted by a constant so that
//! its integral has the exact values at both ends of the cell; so m and the potentials are continuous, have the exact
//! period, and the energy of a motion does not drift.

use crate::balance::balance;
use crate::error::FitError;
use crate::machine::{Domain, Function, FunctionSampler, MachineDescription, PartKind};
use crate::part::{CURVE, Column, HEAD, Part, Precision, TERMS};

/// Points at which the sizes of all functions are taken.
const SIZE_POINTS: usize = 512;
/// A function that varies by less than this part of what it comes to is a constant.
const ROUNDING: f64 = 1e-13;
/// A function is judged by its largest value, or by this part of the largest of its kind, if that is more.
const KIND_FLOOR: f64 = 1e-3;
/// A coefficient that a period changes by more than this part of its scale is not periodic.
const PERIODICITY_TOLERANCE: f64 = 1e-9;
/// Numbers of bins that are tried.
const BINS: std::ops::RangeInclusive<u32> = 4..=13;
/// Points of a cell at which its error is measured, the ends included.
const CHECKS: usize = 3 * TERMS;
/// Part of the accuracy that the errors at these points may reach.
const SHARE: f64 = 0.5;

/// A fitted part, with the scale of each function: of value and half slope of the curves, then of the columns.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedPart {
    /// The cells.
    pub part: Part,
    /// By curve: of its value and of half its slope.
    pub curve_scales: Vec<[f64; 2]>,
    /// By column.
    pub column_scales: Vec<f64>,
}

/// One evaluation of all functions of a part.
#[derive(Debug, Clone, Default)]
struct Row {
    curves: Vec<[f64; 2]>,
    columns: Vec<f64>,
}

struct Fitter<'a, S> {
    machine: &'a MachineDescription,
    kind: PartKind,
    sampler: &'a mut S,
    curves: Vec<Function>,
    columns: Vec<Function>,
    precision: Precision,
    /// By curve, and by column: the largest error.
    curve_tolerances: Vec<[f64; 2]>,
    column_tolerances: Vec<f64>,
    /// Columns that are in the cells.
    tabulated: Vec<usize>,
}

/// Fits a part of a machine to an accuracy relative to the largest value of each function.
///
/// # Errors
/// [`FitError`] where there is no position, a function is not periodic, or the accuracy cannot be reached.
pub fn fit<S: FunctionSampler>(
    machine: &MachineDescription,
    kind: PartKind,
    accuracy: f64,
    precision: Precision,
    sampler: &mut S,
) -> Result<FittedPart, FitError<S::Error>> {
    let mut fitter = Fitter::new(machine, kind, precision, sampler);
    let (curve_scales, column_scales, found) = fitter.sizes()?;
    fitter.require_periodic(&curve_scales, &column_scales)?;
    let allowed = SHARE * accuracy;
    let both = |s: &[f64; 2]| s.map(|s| s * allowed);
    fitter.curve_tolerances = curve_scales.iter().map(both).collect();
    fitter.column_tolerances = column_scales.iter().map(|s| s * allowed).collect();
    let is_tabulated = |k: &usize| matches!(found[*k], Column::Tabulated(_));
    fitter.tabulated = (0..found.len()).filter(is_tabulated).collect();
    let columns = fitter.columns.iter().copied().zip(found).collect();
    let (index, mut cells, bins_per_unit) = fitter.smallest(accuracy)?;
    if kind == PartKind::Motion && precision == Precision::Float {
        balance(&mut cells, fitter.stride(), &index, machine.domain);
    }
    let part = Part {
        curves: fitter.curves,
        columns,
        index,
        cells,
        bins_per_unit,
    };
    Ok(FittedPart {
        part,
        curve_scales,
        column_scales,
    })
}

/// The scales of a part whose functions are operations; nothing of it is in cells.
///
/// # Errors
/// [`FitError`] where there is no position, or a function is not periodic.
pub(crate) fn scales<S: FunctionSampler>(
    machine: &MachineDescription,
    kind: PartKind,
    precision: Precision,
    sampler: &mut S,
) -> Result<FittedPart, FitError<S::Error>> {
    let mut fitter = Fitter::new(machine, kind, precision, sampler);
    let (curve_scales, column_scales, found) = fitter.sizes()?;
    fitter.require_periodic(&curve_scales, &column_scales)?;
    let part = Part {
        columns: fitter.columns.iter().copied().zip(found).collect(),
        curves: fitter.curves,
        index: Vec::new(),
        cells: Vec::new(),
        bins_per_unit: 0.0,
    };
    Ok(FittedPart {
        part,
        curve_scales,
        column_scales,
    })
}

type Sizes = (Vec<[f64; 2]>, Vec<f64>, Vec<Column>);
type Cells = (Vec<u16>, Vec<f64>, f64);

impl<'a, S: FunctionSampler> Fitter<'a, S> {
    fn new(
        machine: &'a MachineDescription,
        kind: PartKind,
        precision: Precision,
        sampler: &'a mut S,
    ) -> Self {
        Self {
            machine,
            kind,
            sampler,
            curves: machine.curves(kind),
            columns: machine.columns(kind),
            precision,
            curve_tolerances: Vec::new(),
            column_tolerances: Vec::new(),
            tabulated: Vec::new(),
        }
    }

    fn row(&mut self, q: f64) -> Result<Row, FitError<S::Error>> {
        let mut row = Row {
            curves: vec![[0.0; 2]; self.curves.len()],
            columns: vec![0.0; self.columns.len()],
        };
        self.sampler
            .sample(self.kind, q, &mut row.curves, &mut row.columns)
            .map_err(FitError::Sampler)?;
        Ok(row)
    }

    /// Numbers of a cell.
    fn stride(&self) -> usize {
        HEAD + CURVE * self.curves.len() + TERMS * self.tabulated.len()
    }

    /// Scales of all functions, and which columns are constants.
    fn sizes(&mut self) -> Result<Sizes, FitError<S::Error>> {
        let Domain { from, .. } = self.machine.domain;
        let length = self.machine.domain.length();
        let mut curves = vec![[0.0_f64; 2]; self.curves.len()];
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.columns.len()];
        for i in 0..=SIZE_POINTS {
            let row = self.row(from + length * (i as f64 / SIZE_POINTS as f64))?;
            for (size, value) in curves.iter_mut().zip(&row.curves) {
                *size = [0, 1].map(|k| size[k].max(value[k].abs()));
            }
            for ([low, high], value) in ranges.iter_mut().zip(&row.columns) {
                (*low, *high) = (low.min(*value), high.max(*value));
            }
        }
        // A function and its slope are of one kind over a radian of a revolution, or over the domain.
        let span = match self.machine.domain.revolutions {
            0 => length,
            revolutions => length / (std::f64::consts::TAU * f64::from(revolutions)),
        };
        let curve_scale = |(size, &of): (&[f64; 2], &Function)| {
            let value = size[0].max(KIND_FLOOR * self.machine.reference_size(of));
            [value, size[1].max(KIND_FLOOR * value / span)]
        };
        let curve_scales = curves.iter().zip(&self.curves).map(curve_scale).collect();
        let sizes: Vec<f64> = ranges.iter().map(|[l, h]| l.abs().max(h.abs())).collect();
        let scale = |(k, &of): (usize, &Function)| {
            let others = sizes.iter().zip(&self.columns);
            let alike = others.filter(|(_, other)| self.machine.same_kind(of, **other));
            let kind = alike.fold(self.machine.reference_size(of), |max, (s, _)| max.max(*s));
            sizes[k].max(KIND_FLOOR * kind)
        };
        let column_scales: Vec<f64> = self.columns.iter().enumerate().map(scale).collect();
        let mut tabulated = 0;
        let place = |((range, scale), &of): ((&[f64; 2], &f64), &Function)| {
            let [low, high] = *range;
            let rounding = ROUNDING * scale.max(self.machine.reference_size(of));
            if high - low > rounding {
                tabulated += 1;
                return Column::Tabulated(tabulated - 1);
            }
            let middle = 0.5 * (low + high);
            Column::Constant(if middle.abs() > rounding { middle } else { 0.0 })
        };
        let both = ranges.iter().zip(&column_scales).zip(&self.columns);
        let found = both.map(place).collect();
        Ok((curve_scales, column_scales, found))
    }

    /// Refuses functions that are not the same a period later.
    fn require_periodic(
        &mut self,
        curve_scales: &[[f64; 2]],
        column_scales: &[f64],
    ) -> Result<(), FitError<S::Error>> {
        let domain = self.machine.domain;
        if domain.revolutions == 0 {
            return Ok(());
        }
        for part in [0.0, 0.131, 0.292, 0.583, 0.877] {
            let q = domain.from + part * domain.length();
            let (here, later) = (self.row(q)?, self.row(q + domain.length())?);
            let curves = here.curves.iter().zip(&later.curves).zip(curve_scales);
            let curves = curves.map(|((a, b), scale)| (a[0] - b[0]).abs() / scale[0]);
            let columns = here.columns.iter().zip(&later.columns).zip(column_scales);
            let columns = columns.map(|((a, b), scale)| (a - b).abs() / scale);
            let functions = self.curves.iter().chain(&self.columns);
            let all = curves.chain(columns).zip(functions);
            let changed = all.filter(|(change, _)| *change > PERIODICITY_TOLERANCE);
            if let Some((_, &function)) = changed.into_iter().next() {
                let name = self.machine.function_name(function);
                return Err(FitError::NotPeriodic { name, function });
            }
        }
        Ok(())
    }

    /// The cells that take the least memory, over all numbers of bins.
    fn smallest(&mut self, accuracy: f64) -> Result<Cells, FitError<S::Error>> {
        if self.curves.is_empty() && self.tabulated.is_empty() {
            return Ok((Vec::new(), Vec::new(), 0.0));
        }
        let mut best: Option<(usize, Cells)> = None;
        let mut failure = None;
        for exponent in BINS {
            let bins = 1_usize << exponent;
            let (index, cells) = match self.cells(bins)? {
                Ok(found) => found,
                Err(failed) => {
                    failure = Some(failed);
                    continue;
                }
            };
            let entry = if cells.len() / self.stride() <= 256 {
                1
            } else {
                2
            };
            let bytes = cells.len() * self.precision.bytes() + bins * entry;
            if best.as_ref().is_some_and(|(least, _)| *least <= bytes) {
                break;
            }
            let per_unit = bins as f64 / self.machine.domain.length();
            best = Some((bytes, (index, cells, self.precision.round(per_unit))));
        }
        match (best, failure) {
            (Some((_, cells)), _) => Ok(cells),
            (None, failure) => {
                let (function, q) = failure.unwrap_or((Function::Inertia, 0.0));
                let name = self.machine.function_name(function);
                Err(FitError::NotReached { name, q, accuracy })
            }
        }
    }

    /// Cells over so many bins; else the function that one bin does not hold, and where.
    #[expect(clippy::type_complexity, reason = "one caller")]
    fn cells(
        &mut self,
        bins: usize,
    ) -> Result<Result<(Vec<u16>, Vec<f64>), (Function, f64)>, FitError<S::Error>> {
        let (mut index, mut cells) = (Vec::with_capacity(bins), Vec::new());
        let (mut begin, mut guess, mut count) = (0, bins, 0_usize);
        while begin < bins {
            let remaining = bins - begin;
            // The widest that holds lies between what holds and what does not.
            let (mut holds, mut fails) = (None, remaining + 1);
            let mut width = guess.clamp(1, remaining);
            while width > 0 {
                match self.cell(bins, begin, width)? {
                    Ok(numbers) => holds = Some((width, numbers)),
                    Err(failed) if width == 1 => return Ok(Err(failed)),
                    Err(_) => fails = width,
                }
                let held = holds.as_ref().map_or(0, |(width, _)| *width);
                if fails - held <= 1 {
                    break;
                }
                width = match held {
                    0 => fails / 2,
                    // Widths grow by a half until one fails.
                    _ if fails > remaining => (held + held.div_ceil(2)).min(remaining),
                    _ => (held + fails) / 2,
                };
            }
            let Some((width, numbers)) = holds else {
                break;
            };
            if count > usize::from(u16::MAX) {
                let q = self.machine.domain.from;
                return Ok(Err((Function::Inertia, q)));
            }
            index.extend(std::iter::repeat_n(count as u16, width));
            cells.extend(numbers);
            (begin, guess, count) = (begin + width, width, count + 1);
        }
        Ok(Ok((index, cells)))
    }

    /// The numbers of a cell; else the function whose error is too large, and where.
    #[expect(clippy::type_complexity, reason = "one caller")]
    fn cell(
        &mut self,
        bins: usize,
        begin: usize,
        width: usize,
    ) -> Result<Result<Vec<f64>, (Function, f64)>, FitError<S::Error>> {
        let Domain { from, to, .. } = self.machine.domain;
        let step = self.machine.domain.length() / bins as f64;
        let ends = [begin, begin + width].map(|bin| (from + step * bin as f64).min(to));
        let middle = self.precision.round(0.5 * (ends[0] + ends[1]));
        let per_half = self.precision.round(2.0 / (ends[1] - ends[0]));
        let coordinate = |x: f64| (middle + x / per_half).clamp(from, to);
        let mut nodes = Vec::with_capacity(TERMS);
        for x in chebyshev_nodes() {
            nodes.push(self.row(coordinate(x))?);
        }
        let outer = [self.row(coordinate(-1.0))?, self.row(coordinate(1.0))?];
        let mut numbers = vec![middle, per_half, self.precision.round(2.0 / per_half)];
        for k in 0..self.curves.len() {
            let slopes = std::array::from_fn(|i| nodes[i].curves[k][1]);
            let ends = [outer[0].curves[k][0], outer[1].curves[k][0]];
            numbers.extend(curve(slopes, ends, 2.0 / per_half));
        }
        for &k in &self.tabulated {
            numbers.extend(interpolate(std::array::from_fn(|i| nodes[i].columns[k])));
        }
        for i in 0..=CHECKS {
            let x = -(std::f64::consts::PI * i as f64 / CHECKS as f64).cos();
            let q = coordinate(x);
            let exact = self.row(q)?;
            if let Some(function) = self.error_too_large(&numbers, (q - middle) * per_half, &exact)
            {
                return Ok(Err((function, q)));
            }
        }
        let rounded = numbers.into_iter().map(|n| self.precision.round(n));
        Ok(Ok(rounded.collect()))
    }

    /// The first function that is not within its tolerance.
    fn error_too_large(&self, numbers: &[f64], x: f64, exact: &Row) -> Option<Function> {
        let beyond = |found: f64, exact: f64, tolerance: f64| {
            // NaN counts as the largest error.
            let within = (found - exact).abs() <= tolerance;
            !within
        };
        for (k, &function) in self.curves.iter().enumerate() {
            let of = &numbers[HEAD + CURVE * k..][..CURVE];
            let half_slope = polynomial(&of[1..], x);
            let value = of[0] + numbers[2] * integral(&of[1..], x);
            let [value_tolerance, slope_tolerance] = self.curve_tolerances[k];
            if beyond(value, exact.curves[k][0], value_tolerance)
                || beyond(half_slope, exact.curves[k][1], slope_tolerance)
            {
                return Some(function);
            }
        }
        let first = HEAD + CURVE * self.curves.len();
        for (j, &k) in self.tabulated.iter().enumerate() {
            let value = polynomial(&numbers[first + TERMS * j..][..TERMS], x);
            if beyond(value, exact.columns[k], self.column_tolerances[k]) {
                return Some(self.columns[k]);
            }
        }
        None
    }
}

/// The zeros of Chebyshev's polynomial of as many terms.
fn chebyshev_nodes() -> [f64; TERMS] {
    let half_step = std::f64::consts::PI / (2 * TERMS) as f64;
    std::array::from_fn(|i| -((2 * i + 1) as f64 * half_step).cos())
}

/// The coefficients, by rising powers, of the polynomial through values at [`chebyshev_nodes`], by Newton's divided
/// differences.
fn interpolate(values: [f64; TERMS]) -> [f64; TERMS] {
    let nodes = chebyshev_nodes();
    let mut difference = values;
    for order in 1..TERMS {
        for i in (order..TERMS).rev() {
            difference[i] = (difference[i] - difference[i - 1]) / (nodes[i] - nodes[i - order]);
        }
    }
    // From Newton's products to powers, the last factor first.
    let mut powers = [0.0; TERMS];
    for i in (0..TERMS).rev() {
        for j in (1..TERMS).rev() {
            powers[j] = powers[j - 1] - nodes[i] * powers[j];
        }
        powers[0] = difference[i] - nodes[i] * powers[0];
    }
    powers
}

/// The numbers of a curve from half its slope at the nodes and its values at both ends of a cell of this width.
fn curve(slopes: [f64; TERMS], ends: [f64; 2], width: f64) -> [f64; CURVE] {
    let mut g = interpolate(slopes);
    let change = width * (integral(&g, 1.0) - integral(&g, -1.0));
    // The integral of a constant g₀ over the cell is 2 g₀ times the width.
    g[0] += (ends[1] - ends[0] - change) / (2.0 * width);
    let middle = 0.5 * (ends[0] + ends[1] - width * (integral(&g, 1.0) + integral(&g, -1.0)));
    std::array::from_fn(|i| if i == 0 { middle } else { g[i - 1] })
}

fn polynomial(terms: &[f64], x: f64) -> f64 {
    terms.iter().rev().fold(0.0, |sum, term| sum * x + term)
}

/// Σ gⱼ xʲ⁺¹/(j + 1). The function is its value at the middle and the cell's width times this, since its slope is twice g.
fn integral(terms: &[f64], x: f64) -> f64 {
    let terms = terms.iter().enumerate().rev();
    terms.fold(0.0, |sum, (j, term)| (sum + term / (j + 1) as f64) * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight values determine a polynomial of degree 7: x⁷ − 3x + 2 comes back.
    #[test]
    fn a_polynomial_comes_back() {
        let found = interpolate(chebyshev_nodes().map(|x| x.powi(7) - 3.0 * x + 2.0));
        let exact = [2.0, -3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        for (found, exact) in found.iter().zip(exact) {
            assert!((found - exact).abs() < 1e-13, "{found} {exact}");
        }
    }

    /// sin 2q has half the slope cos 2q; the curve takes the values at both ends whatever the slopes are.
    #[test]
    fn a_curve_has_its_values_at_both_ends() {
        let (from, width) = (0.3, 0.4);
        let q = |x: f64| from + 0.5 * width * (1.0 + x);
        let value = |x: f64| (2.0 * q(x)).sin();
        let slopes = chebyshev_nodes().map(|x| (2.0 * q(x)).cos());
        for shift in [0.0, 0.1] {
            let numbers = curve(slopes.map(|s| s + shift), [value(-1.0), value(1.0)], width);
            let found = |x: f64| numbers[0] + width * integral(&numbers[1..], x);
            for x in [-1.0, 1.0] {
                assert!((found(x) - value(x)).abs() < 1e-15);
            }
            let inside = (found(0.3) - value(0.3)).abs();
            // (0.4)⁸ / (2⁷ 8!) = 1.3e-10 of the slope, less by the integral.
            assert!(inside < 1e-11, "{inside}");
        }
    }
}
