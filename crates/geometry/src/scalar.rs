//! The kinds of number a plan can be evaluated in: plain `f64`, [`Dual`] for exact derivatives with
//! respect to a coordinate, `f32` and [`Wide`](crate::Wide) to measure what rounding does.

use crate::circle::sin_cos;
use std::f64::consts::TAU;
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A number that positions, velocities, accelerations and reactions can be computed in.
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
    const DERIVES: bool;
    /// The distance from one to the next larger number.
    const EPSILON: f64;
    /// A constant.
    fn lift(value: f64) -> Self;
    /// The value alone, on which every decision (pivot, convergence, limit) is made.
    fn value(self) -> f64;
    /// How many numbers such a one holds side by side.
    const LANES: usize = 1;
    /// The value in one of them.
    #[inline]
    fn lane(self, _lane: usize) -> f64 {
        self.value()
    }
    /// Square root.
    fn sqrt(self) -> Self;
    /// Sine and cosine together.
    fn sin_cos(self) -> (Self, Self);
    /// The angle of (x, y) = (`other`, `self`) from the x axis, in (−π, π].
    fn atan2(self, other: Self) -> Self;
    /// The angle of whole turns, rad.
    #[inline]
    fn turns(count: f64) -> Self {
        Self::lift(TAU * count)
    }
    /// The numbers as plain ones, if that is what they are: for a library that knows no others.
    fn plain(_numbers: &mut [Self]) -> Option<&mut [f64]> {
        None
    }
    /// A function of this number, from its value and first three derivatives at
    /// [`value`](Self::value).
    fn through(self, derivatives: &[f64; 4]) -> Self;
}

/// A function of each of some numbers. (The standard library's is not always inlined.)
#[inline(always)]
pub fn each<A: Copy, B: Copy, const N: usize>(of: [A; N], act: impl Fn(A) -> B) -> [B; N] {
    let mut out = [act(of[0]); N];
    for n in 1..N {
        out[n] = act(of[n]);
    }
    out
}

/// What a test of each lane says; none where lanes disagree. A decision that must be the same for all
/// numbers side by side is made by this: where it is not, each of them goes its way alone.
#[inline(always)]
pub(crate) fn agreed<T: Scalar>(test: impl Fn(usize) -> bool) -> Option<bool> {
    let first = test(0);
    (1..T::LANES)
        .all(|lane| test(lane) == first)
        .then_some(first)
}

impl Scalar for f64 {
    const DERIVES: bool = false;
    const EPSILON: f64 = f64::EPSILON;
    #[inline]
    fn lift(value: f64) -> Self {
        value
    }
    #[inline]
    fn value(self) -> f64 {
        self
    }
    #[inline]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos(self, |x| [x], |[x]| x)
    }
    #[inline]
    fn atan2(self, other: Self) -> Self {
        f64::atan2(self, other)
    }
    #[inline]
    fn through(self, derivatives: &[f64; 4]) -> Self {
        derivatives[0]
    }
    #[inline]
    fn plain(numbers: &mut [Self]) -> Option<&mut [f64]> {
        Some(numbers)
    }
}

impl Scalar for f32 {
    const DERIVES: bool = false;
    const EPSILON: f64 = f32::EPSILON as f64;
    #[inline]
    fn lift(value: f64) -> Self {
        value as Self
    }
    #[inline]
    fn value(self) -> f64 {
        f64::from(self)
    }
    #[inline]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        f32::sin_cos(self)
    }
    #[inline]
    fn atan2(self, other: Self) -> Self {
        f32::atan2(self, other)
    }
    #[inline]
    fn through(self, derivatives: &[f64; 4]) -> Self {
        derivatives[0] as Self
    }
}

/// A value with its derivative: v + d ε with ε² = 0. Evaluating a plan at q + ε gives the exact
/// derivative of everything with respect to q, to rounding.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Dual {
    /// The value.
    pub v: f64,
    /// Its derivative.
    pub d: f64,
}

impl Dual {
    /// The independent variable: derivative one.
    pub fn variable(v: f64) -> Self {
        Self { v, d: 1.0 }
    }
}

impl Scalar for Dual {
    const DERIVES: bool = true;
    const EPSILON: f64 = f64::EPSILON;
    #[inline]
    fn lift(value: f64) -> Self {
        Self { v: value, d: 0.0 }
    }
    #[inline]
    fn value(self) -> f64 {
        self.v
    }
    #[inline]
    fn sqrt(self) -> Self {
        let v = self.v.sqrt();
        Self {
            v,
            d: 0.5 * self.d / v,
        }
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = Scalar::sin_cos(self.v);
        (
            Self {
                v: s,
                d: c * self.d,
            },
            Self {
                v: c,
                d: -s * self.d,
            },
        )
    }
    #[inline]
    fn atan2(self, other: Self) -> Self {
        let square = self.v * self.v + other.v * other.v;
        Self {
            v: self.v.atan2(other.v),
            d: (other.v * self.d - self.v * other.d) / square,
        }
    }
    #[inline]
    fn through(self, derivatives: &[f64; 4]) -> Self {
        Self {
            v: derivatives[0],
            d: derivatives[1] * self.d,
        }
    }
}

impl Add for Dual {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self {
            v: self.v + o.v,
            d: self.d + o.d,
        }
    }
}

impl Sub for Dual {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self {
            v: self.v - o.v,
            d: self.d - o.d,
        }
    }
}

impl Mul for Dual {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self {
            v: self.v * o.v,
            d: self.d * o.v + self.v * o.d,
        }
    }
}

impl Div for Dual {
    type Output = Self;
    #[inline]
    fn div(self, o: Self) -> Self {
        let v = self.v / o.v;
        Self {
            v,
            d: (self.d - v * o.d) / o.v,
        }
    }
}

impl Neg for Dual {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            v: -self.v,
            d: -self.d,
        }
    }
}

impl AddAssign for Dual {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl SubAssign for Dual {
    #[inline]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each operation against a central difference of itself.
    #[test]
    fn derivatives_agree_with_differences() {
        let f = |x: Dual| {
            let (s, c) = x.sin_cos();
            (s * s / (Dual::lift(2.0) + c) - (-x) * c).sqrt()
        };
        let (x, h) = (0.7, 1e-6);
        let slope = (f(Dual::lift(x + h)).v - f(Dual::lift(x - h)).v) / (2.0 * h);
        assert!((f(Dual::variable(x)).d - slope).abs() < 1e-9);
    }
}
