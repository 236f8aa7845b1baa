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
/// It must be a smooth function of them where a motion passes: the integrators' Jacobians and linearised motions take
/// its derivatives by central differences (about ten digits). Two are equal if they are the same function.
#[derive(Clone)]
pub struct MagnitudeFunction(Arc<Function>);

type Function = dyn Fn(&[f64]) -> f64 + Send + Sync;

impl MagnitudeFunction {
    /// From a function or closure.
    pub fn new(function: impl Fn(&[f64]) -> f64 + Send + Sync + 'static) -> Self {
        Self(Arc::new(function))
    }

    /// The value at these signals.
    pub fn value(&self, signals: &[f64]) -> f64 {
        (self.0)(signals)
    }

    /// The value in any kind of number, with derivatives by central differences.
    pub(super) fn eval<T: Scalar>(&self, numbers: &[T], values: &[f64]) -> T {
        let slope = |i: usize| {
            let mut near = [0.0; MAX_FUNCTION_SIGNALS];
            let Some(near) = near.get_mut(..values.len()) else {
                return f64::NAN;
            };
            let step = STEP * values[i].abs().max(1.0);
            let mut at = |x: f64| {
                near.copy_from_slice(values);
                near[i] = x;
                self.value(near)
            };
            (at(values[i] + step) - at(values[i] - step)) / (2.0 * step)
        };
        first_order(self.value(values), slope, numbers, values)
    }
}

/// A function in any kind of number: its value, plus its slopes times what each variable holds beside its plain
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
        Arc::ptr_eq(&self.0, &other.0)
    }
}
