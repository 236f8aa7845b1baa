//! A magnitude computed by the program that uses the library.

use dwell_numerics::Scalar;
use std::fmt;
use std::sync::Arc;

/// The most signals that a function may depend on: its derivatives are taken without allocation.
pub const MAX_FUNCTION_SIGNALS: usize = 16;

/// Relative step of the central differences: the third root of the rounding, so that truncation and rounding are
/// both about 1e-10.
const STEP: f64 = 6e-6;

/// A magnitude computed by the caller's own program from the values of its signals, in SI.
///
/// It must be a smooth function of them between its breakpoints: the integrators' Jacobians and linearised motions take
/// its derivatives by differences (about ten digits). Nothing of it is searched: a jump or a kink that is no breakpoint makes
/// the steps of a motion so short that it ends. Two are equal if they are the same function.
#[derive(Clone)]
pub struct MagnitudeFunction {
    function: Arc<Function>,
    /// By signal that has any, its index and the values at which the function jumps or has a kink, ascending.
    breakpoints: Vec<(usize, Vec<f64>)>,
}

type Function = dyn Fn(&[f64]) -> f64 + Send + Sync;

impl MagnitudeFunction {
    /// From a function or closure.
    pub fn new(function: impl Fn(&[f64]) -> f64 + Send + Sync + 'static) -> Self {
        Self {
            function: Arc::new(function),
            breakpoints: Vec::new(),
        }
    }

    /// This function with breakpoints, that is, values of a signal (given by its index) at which it jumps or has a kink. The integration
    /// of a motion stops at each and treats each side separately. Values that are not finite are ignored.
    #[must_use]
    pub fn with_breakpoints(mut self, signal: usize, values: &[f64]) -> Self {
        let known = self.breakpoints.iter().position(|(i, _)| *i == signal);
        let k = known.unwrap_or(self.breakpoints.len());
        if known.is_none() {
            self.breakpoints.push((signal, Vec::new()));
        }
        let all = &mut self.breakpoints[k].1;
        all.extend(values.iter().filter(|value| value.is_finite()));
        all.sort_by(f64::total_cmp);
        all.dedup();
        self
    }

    /// By signal that has breakpoints: its index, and their values, ascending.
    pub fn breakpoints(&self) -> impl Iterator<Item = (usize, &[f64])> {
        self.breakpoints.iter().map(|(i, values)| (*i, &values[..]))
    }

    /// The value at these signals.
    pub fn value(&self, signals: &[f64]) -> f64 {
        (self.function)(signals)
    }

    /// The value in any kind of number, with derivatives by central differences.
    pub(super) fn eval<T: Scalar>(&self, numbers: &[T], values: &[f64]) -> T {
        eval_by(|at| self.value(at), numbers, values)
    }

    /// Evaluates the function on held pieces, each given by a signal's index and its bounds. Beyond a bound the function keeps its
    /// value at the bound.
    pub(super) fn eval_held<T: Scalar>(
        &self,
        numbers: &[T],
        values: &[f64],
        held: &[(usize, [f64; 2])],
    ) -> T {
        let value = |at: &[f64]| {
            let mut inside = [0.0; MAX_FUNCTION_SIGNALS];
            let Some(inside) = inside.get_mut(..at.len()) else {
                return f64::NAN;
            };
            inside.copy_from_slice(at);
            for &(i, [low, high]) in held {
                inside[i] = at[i].max(low.next_up()).min(high.next_down());
            }
            self.value(inside)
        };
        eval_by(value, numbers, values)
    }
}

/// A function in any kind of number, with derivatives by central differences.
fn eval_by<T: Scalar>(value: impl Fn(&[f64]) -> f64, numbers: &[T], values: &[f64]) -> T {
    let slope = |i: usize| {
        let mut near = [0.0; MAX_FUNCTION_SIGNALS];
        let Some(near) = near.get_mut(..values.len()) else {
            return f64::NAN;
        };
        let step = STEP * values[i].abs().max(1.0);
        let mut at = |x: f64| {
            near.copy_from_slice(values);
            near[i] = x;
            value(near)
        };
        (at(values[i] + step) - at(values[i] - step)) / (2.0 * step)
    };
    first_order(value(values), slope, numbers, values)
}

/// A function in any number type: its value, plus its slopes times the difference of each variable from its plain
/// value. That is exact to first order, as a dual number is.
pub(super) fn first_order<T: Scalar>(
    value: f64,
    slope: impl Fn(usize) -> f64,
    numbers: &[T],
    values: &[f64],
) -> T {
    let mut sum = T::from_f64(value);
    if T::HAS_DERIVATIVES {
        for (i, &number) in numbers.iter().enumerate() {
            sum += (number - T::from_f64(values[i])) * T::from_f64(slope(i));
        }
    }
    sum
}

impl fmt::Debug for MagnitudeFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("MagnitudeFunction")
    }
}

impl PartialEq for MagnitudeFunction {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.function, &other.function) && self.breakpoints == other.breakpoints
    }
}
