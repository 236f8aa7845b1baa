//! Several `f64` side by side: generic code evaluated in them gives several results at once.
//!
//! Every operation acts on each lane as on an `f64`, so the results of each lane equal those of the
//! single evaluation bit for bit. The compiler generates vector instructions.
//!
//! A decision must be the same in all lanes: code that branches on a value tests every lane ([`uniform`](crate::uniform), [`Scalar::exceeds`]).
//! If lanes disagree, each value must be evaluated alone.

use crate::real::Real;
use crate::scalar::Scalar;
use crate::sin_cos::sin_cos;
use std::array;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// `N` numbers of type `f64` side by side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lanes<const N: usize>(pub [f64; N]);

impl<const N: usize> Default for Lanes<N> {
    fn default() -> Self {
        Self([0.0; N])
    }
}

impl<const N: usize> Lanes<N> {
    /// A function of each lane.
    #[inline(always)]
    fn map(self, of: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(of))
    }

    /// A function of two numbers, lane by lane.
    #[inline(always)]
    fn zip_with(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        Self(array::from_fn(|lane| of(self.0[lane], other.0[lane])))
    }
}

impl<const N: usize> Scalar for Lanes<N> {
    const HAS_DERIVATIVES: bool = false;
    const EPSILON: f64 = f64::EPSILON;
    const LANES: usize = N;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self([value; N])
    }

    /// The value of the first lane.
    #[inline(always)]
    fn value(self) -> f64 {
        self.0[0]
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        self.0[lane]
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos(self, |lanes| lanes.0, Self)
    }

    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        self.zip_with(other, f64::atan2)
    }

    /// The derivatives are valid at one value only: lanes with another value become NaN, so code that
    /// composes functions must not be evaluated in lanes.
    #[inline(always)]
    fn compose(self, derivatives: &[f64; 4]) -> Self {
        let first = self.0[0];
        self.map(|value| {
            if value == first {
                derivatives[0]
            } else {
                f64::NAN
            }
        })
    }
}

impl<const N: usize> Real for Lanes<N> {
    fn of(value: f64) -> Self {
        Self([value; N])
    }

    /// The value of the first lane.
    fn to_f64(self) -> f64 {
        self.0[0]
    }

    fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    fn sin(self) -> Self {
        Scalar::sin_cos(self).0
    }

    fn cos(self) -> Self {
        Scalar::sin_cos(self).1
    }

    fn atan2(self, other: Self) -> Self {
        self.zip_with(other, f64::atan2)
    }
}

impl<const N: usize> Add for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip_with(o, |a, b| a + b)
    }
}

impl<const N: usize> Sub for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.zip_with(o, |a, b| a - b)
    }
}

impl<const N: usize> Mul for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.zip_with(o, |a, b| a * b)
    }
}

impl<const N: usize> Div for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        self.zip_with(o, |a, b| a / b)
    }
}

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl<const N: usize> AddAssign for Lanes<N> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl<const N: usize> SubAssign for Lanes<N> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}
