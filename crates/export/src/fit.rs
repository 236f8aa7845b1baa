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
/// A function that varies by less than this fraction of its reference size is a constant.
const ROUNDING: f64 = 1e-13;
/// A function is judged by its largest value, or by this part of the largest of its kind, if that is more.
const KIND_FLOOR: f64 = 1e-3;
/// A coefficient that a period changes by more than this part of its scale is not periodic.
const PERIODICITY_TOLERANCE: f64 = 1e-9;
/// Numbers of bins that are tried.
const BINS: std::ops::RangeInclusive<u32> = 4..=13;
/// Points of a cell at which its error is measured, the ends included.
const CHECKS: usize = 3 * TERMS;
/// Number of additional points of the domain at which cells are searched for narrow peaks.
const SEARCH_POINTS: usize = 8192;
/// Part of the accuracy that the errors at these points may reach.
const SHARE: f64 = 0.5;

/// A fitted part, with the scale of each of its [values](sample_values).
pub(crate) struct FittedPart {
    /// The cells.
    pub(crate) part: Part,
    /// Scales of value and half slope of the curves, then of the columns.
    pub(crate) scales: Vec<f64>,
}

/// All functions of a part at a coordinate (rad or m): value and half slope of the curves, then the columns.
///
/// # Errors
/// Those of the sampler.
pub(crate) fn sample_values<S: FunctionSampler>(
    machine: &MachineDescription,
    kind: PartKind,
    q: f64,
    sampler: &mut S,
) -> Result<Vec<f64>, S::Error> {
    let mut curves = vec![[0.0; 2]; machine.curves(kind).len()];
    let mut columns = vec![0.0; machine.columns(kind).len()];
    sampler.sample(kind, q, &mut curves, &mut columns)?;
    Ok(curves.into_iter().flatten().chain(columns).collect())
}

struct Fitter<'a, S> {
    machine: &'a MachineDescription,
    kind: PartKind,
    sampler: &'a mut S,
    accuracy: f64,
    precision: Precision,
    /// The part without its cells.
    part: Part,
    /// By value: the largest error.
    tolerances: Vec<f64>,
}

/// Fits a part of a machine to an accuracy relative to the largest value of each function. Without an accuracy it has no cells,
/// because its functions are operations.
///
/// # Errors
/// [`FitError`] if there is no position, a function is not periodic, or the accuracy cannot be reached.
pub(crate) fn fit<S: FunctionSampler>(
    machine: &MachineDescription,
    kind: PartKind,
    accuracy: Option<f64>,
    precision: Precision,
    sampler: &mut S,
) -> Result<FittedPart, FitError<S::Error>> {
    let columns = machine.columns(kind).into_iter();
    let mut fitter = Fitter {
        machine,
        kind,
        sampler,
        accuracy: accuracy.unwrap_or_default(),
        precision,
        part: Part {
            curves: machine.curves(kind),
            columns: columns.map(|of| (of, Column::Constant(0.0))).collect(),
            index: Vec::new(),
            cells: Vec::new(),
            bins_per_unit: 0.0,
        },
        tolerances: Vec::new(),
    };
    let scales = fitter.sizes()?;
    fitter.require_periodic(&scales)?;
    let mut part = fitter.part.clone();
    if let Some(accuracy) = accuracy
        && part.stride() > HEAD
    {
        let allowed = SHARE * accuracy;
        fitter.tolerances = scales.iter().map(|scale| scale * allowed).collect();
        part = fitter.smallest()?;
        if kind == PartKind::Motion && precision == Precision::Float {
            let stride = part.stride();
            balance(&mut part.cells, stride, &part.index, machine.domain);
        }
    }
    Ok(FittedPart { part, scales })
}

impl<S: FunctionSampler> Fitter<'_, S> {
    fn row(&mut self, q: f64) -> Result<Vec<f64>, FitError<S::Error>> {
        sample_values(self.machine, self.kind, q, self.sampler).map_err(FitError::Sampler)
    }

    /// Scales of all values; notes which columns are constants.
    fn sizes(&mut self) -> Result<Vec<f64>, FitError<S::Error>> {
        let (machine, length) = (self.machine, self.machine.domain.length());
        let first = 2 * self.part.curves.len();
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; first + self.part.columns.len()];
        for i in 0..=SIZE_POINTS {
            let row = self.row(machine.domain.from + length * (i as f64 / SIZE_POINTS as f64))?;
            for ([low, high], value) in ranges.iter_mut().zip(row) {
                (*low, *high) = (low.min(value), high.max(value));
            }
        }
        let sizes: Vec<f64> = ranges.iter().map(|[l, h]| l.abs().max(h.abs())).collect();
        // A function and its slope are of one kind over a radian of a revolution, or over the domain.
        let span = match machine.domain.revolutions {
            0 => length,
            revolutions => length / (std::f64::consts::TAU * f64::from(revolutions)),
        };
        let mut scales = Vec::with_capacity(sizes.len());
        for (size, &of) in sizes.chunks_exact(2).zip(&self.part.curves) {
            let value = size[0].max(KIND_FLOOR * machine.reference_size(of));
            scales.extend([value, size[1].max(KIND_FLOOR * value / span)]);
        }
        for (size, (of, _)) in sizes[first..].iter().zip(&self.part.columns) {
            let others = sizes[first..].iter().zip(&self.part.columns);
            let alike = others.filter(|(_, (other, _))| machine.same_kind(*of, *other));
            let kind = alike.fold(machine.reference_size(*of), |max, (s, _)| max.max(*s));
            scales.push(size.max(KIND_FLOOR * kind));
        }
        let mut tabulated = 0;
        let columns = self.part.columns.iter_mut();
        let ranges_and_scales = ranges[first..].iter().zip(&scales[first..]);
        for ((of, column), ([low, high], scale)) in columns.zip(ranges_and_scales) {
            let rounding = ROUNDING * scale.max(machine.reference_size(*of));
            if high - low > rounding {
                *column = Column::Tabulated(tabulated);
                tabulated += 1;
                continue;
            }
            let middle = 0.5 * (low + high);
            *column = Column::Constant(if middle.abs() > rounding { middle } else { 0.0 });
        }
        Ok(scales)
    }

    /// Refuses functions that are not the same a period later.
    fn require_periodic(&mut self, scales: &[f64]) -> Result<(), FitError<S::Error>> {
        let domain = self.machine.domain;
        if domain.revolutions == 0 {
            return Ok(());
        }
        for part in [0.0, 0.131, 0.292, 0.583, 0.877] {
            let q = domain.from + part * domain.length();
            let (here, later) = (self.row(q)?, self.row(q + domain.length())?);
            let Part {
                curves, columns, ..
            } = &self.part;
            let places = (0..2 * curves.len()).step_by(2).chain(2 * curves.len()..);
            let functions = curves.iter().chain(columns.iter().map(|(of, _)| of));
            let changed = |&(k, _): &(usize, &Function)| {
                (here[k] - later[k]).abs() / scales[k] > PERIODICITY_TOLERANCE
            };
            if let Some((_, &function)) = places.zip(functions).find(changed) {
                let name = self.machine.function_name(function);
                return Err(FitError::NotPeriodic { name, function });
            }
        }
        Ok(())
    }

    /// The cells that take the least memory, over all numbers of bins.
    fn smallest(&mut self) -> Result<Part, FitError<S::Error>> {
        let mut best = Err(self.not_reached(Function::Inertia, 0.0));
        let precision = self.precision;
        let bytes = |part: &Part| part.bytes(precision);
        for exponent in BINS {
            best = match (self.cells(1 << exponent), best) {
                (Ok(found), Ok(best)) if bytes(&best) <= bytes(&found) => return Ok(best),
                (Ok(found), _) => Ok(found),
                (Err(FitError::NotReached { .. }), Ok(best)) => Ok(best),
                (Err(failed @ FitError::NotReached { .. }), Err(_)) => Err(failed),
                (Err(error), _) => return Err(error),
            };
        }
        best
    }

    /// The error for a function that a cell of one bin does not represent, with its coordinate.
    fn not_reached(&self, function: Function, q: f64) -> FitError<S::Error> {
        FitError::NotReached {
            name: self.machine.function_name(function),
            q,
            accuracy: self.accuracy,
        }
    }

    /// The part with cells over a number of bins.
    ///
    /// # Errors
    /// [`FitError::NotReached`] if one bin is too wide.
    fn cells(&mut self, bins: usize) -> Result<Part, FitError<S::Error>> {
        let per_unit = bins as f64 / self.machine.domain.length();
        let mut part = Part {
            bins_per_unit: self.precision.round(per_unit),
            ..self.part.clone()
        };
        let (mut begin, mut guess, mut count) = (0, bins, 0_usize);
        while begin < bins {
            let remaining = bins - begin;
            // The widest that holds lies between what holds and what does not.
            let (mut holds, mut fails) = (None, remaining + 1);
            let mut width = guess.clamp(1, remaining);
            while width > 0 {
                match self.cell(bins, begin, width) {
                    Ok(numbers) => holds = Some((width, numbers)),
                    Err(FitError::NotReached { .. }) if width > 1 => fails = width,
                    Err(error) => return Err(error),
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
                return Err(self.not_reached(Function::Inertia, self.machine.domain.from));
            }
            part.index.extend(std::iter::repeat_n(count as u16, width));
            part.cells.extend(numbers);
            (begin, guess, count) = (begin + width, width, count + 1);
        }
        Ok(part)
    }

    /// The numbers of a cell.
    ///
    /// # Errors
    /// [`FitError::NotReached`] where the error of a function is too large.
    fn cell(
        &mut self,
        bins: usize,
        begin: usize,
        width: usize,
    ) -> Result<Vec<f64>, FitError<S::Error>> {
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
        let at_nodes = |value: usize| std::array::from_fn(|i| nodes[i][value]);
        let mut numbers = vec![middle, per_half, self.precision.round(2.0 / per_half)];
        let first = 2 * self.part.curves.len();
        for k in (0..first).step_by(2) {
            let ends = outer.each_ref().map(|row| row[k]);
            numbers.extend(curve(at_nodes(k + 1), ends, 2.0 / per_half));
        }
        for (k, (_, column)) in self.part.columns.iter().enumerate() {
            if matches!(column, Column::Tabulated(_)) {
                numbers.extend(interpolate(at_nodes(first + k)));
            }
        }
        for i in 0..=CHECKS {
            let x = -(std::f64::consts::PI * i as f64 / CHECKS as f64).cos();
            let q = coordinate(x);
            let exact = self.row(q)?;
            if let Some(function) =
                self.error_too_large(&numbers, (q - middle) * per_half, &exact, 1.0)
            {
                return Err(self.not_reached(function, q));
            }
        }
        // Between the points of a wide cell a narrow peak would pass unseen.
        let further = SEARCH_POINTS * width / bins;
        for i in 1..further {
            let q = coordinate(2.0 * i as f64 / further as f64 - 1.0);
            let exact = self.row(q)?;
            let x = (q - middle) * per_half;
            if let Some(function) = self.error_too_large(&numbers, x, &exact, 1.0 / SHARE) {
                return Err(self.not_reached(function, q));
            }
        }
        let rounded = numbers.into_iter().map(|n| self.precision.round(n));
        Ok(rounded.collect())
    }

    /// The first function whose error exceeds this multiple of its tolerance.
    fn error_too_large(
        &self,
        numbers: &[f64],
        x: f64,
        exact: &[f64],
        tolerances: f64,
    ) -> Option<Function> {
        let beyond = |found: f64, value: usize| {
            // NaN counts as the largest error.
            let within = (found - exact[value]).abs() <= tolerances * self.tolerances[value];
            !within
        };
        let Part {
            curves, columns, ..
        } = &self.part;
        for (k, &function) in curves.iter().enumerate() {
            let of = &numbers[HEAD + CURVE * k..][..CURVE];
            let half_slope = polynomial(&of[1..], x);
            let value = of[0] + numbers[2] * integral(&of[1..], x);
            if beyond(value, 2 * k) || beyond(half_slope, 2 * k + 1) {
                return Some(function);
            }
        }
        let first = HEAD + CURVE * curves.len();
        for (k, &(function, column)) in columns.iter().enumerate() {
            if let Column::Tabulated(j) = column
                && beyond(
                    polynomial(&numbers[first + TERMS * j..][..TERMS], x),
                    2 * curves.len() + k,
                )
            {
                return Some(function);
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
