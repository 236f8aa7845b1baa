//! The number types of generic evaluations: `f64`, [`Dual`](crate::Dual) for exact derivatives with
//! respect to a coordinate, `f32` and [`DoubleDouble`](crate::DoubleDouble) to measure rounding errors.

use std::f64::consts::TAU;
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A number type in which positions, velocities, accelerations and reactions can be computed.
pub trait Scalar:
    Copy
    + Debug
    + Default
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// Whether such a number carries derivatives.
    const HAS_DERIVATIVES: bool;
    /// The distance from 1 to the next larger number.
    const EPSILON: f64;
    /// A constant.
    fn from_f64(value: f64) -> Self;
    /// The value without derivatives, by which every decision (pivot, convergence, limit) is made.
    fn value(self) -> f64;
    /// Number of values that such a number holds side by side.
    const LANES: usize = 1;
    /// The value in one lane.
    #[inline]
    fn lane(self, _lane: usize) -> f64 {
        self.value()
    }
    /// Whether the value in every lane exceeds that of the same lane of `other`. If lanes disagree, the values must be
    /// evaluated one by one.
    #[inline(always)]
    fn exceeds(self, other: Self) -> bool {
        (0..Self::LANES).all(|lane| self.lane(lane) > other.lane(lane))
    }
    /// Square root.
    fn sqrt(self) -> Self;
    /// Sine and cosine together.
    fn sin_cos(self) -> (Self, Self);
    /// The angle of (x, y) = (`other`, `self`) from the x axis, in (−π, π].
    fn atan2(self, other: Self) -> Self;
    /// The angle of `count` revolutions, rad.
    #[inline]
    fn from_revolutions(count: f64) -> Self {
        Self::from_f64(TAU * count)
    }
    /// The numbers as a slice of `f64`, if that is their type, for libraries that take `f64` only.
    fn as_f64_slice_mut(_numbers: &mut [Self]) -> Option<&mut [f64]> {
        None
    }
    /// A function of this number, from its value and first three derivatives at
    /// [`value`](Self::value).
    fn compose(self, derivatives: &[f64; 4]) -> Self;
}

/// Applies a function to each element of an array. (The method of the standard library is not always inlined.)
#[inline(always)]
pub fn map_array<A: Copy, B: Copy, const N: usize>(of: [A; N], f: impl Fn(A) -> B) -> [B; N] {
    let mut out = [f(of[0]); N];
    for n in 1..N {
        out[n] = f(of[n]);
    }
    out
}

/// The result of a test of each lane; `None` if lanes disagree, so that the values must be evaluated one by one.
/// Generic code decides only by this or by [`Scalar::exceeds`].
#[inline(always)]
pub fn uniform<T: Scalar>(test: impl Fn(usize) -> bool) -> Option<bool> {
    let first = test(0);
    (1..T::LANES)
        .all(|lane| test(lane) == first)
        .then_some(first)
}

/// A number that constants of an evaluation may be: the dimensions of a mechanism, its masses.
pub trait Constant: Scalar + PartialEq {
    /// Whether what follows from constants alone, such as the square of a length, is computed once and kept. It is not where
    /// an evaluation is to depend on the constants themselves.
    const IS_PREPARED: bool;
    /// The length of a vector of these components; of `f64` without overflow at the extremes.
    fn length(components: [Self; 3]) -> Self;
}

impl Constant for f64 {
    const IS_PREPARED: bool = true;

    fn length([x, y, z]: [Self; 3]) -> Self {
        x.hypot(y).hypot(z)
    }
}

/// A number type in which constants of type `C` take part: `f64` in any, recorded numbers in recorded ones.
pub trait Lift<C: Constant>: Scalar {
    /// The constant in this type.
    fn lift(constant: C) -> Self;
}

impl<T: Scalar> Lift<f64> for T {
    #[inline(always)]
    #[track_caller]
    fn lift(constant: f64) -> Self {
        Self::from_f64(constant)
    }
}
