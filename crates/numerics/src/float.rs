//! `f64` and `f32` as [`Scalar`]s.

use crate::scalar::Scalar;
use crate::sin_cos::sin_cos;

impl Scalar for f64 {
    const HAS_DERIVATIVES: bool = false;
    const EPSILON: f64 = f64::EPSILON;
    #[inline]
    fn from_f64(value: f64) -> Self {
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
    fn compose(self, derivatives: &[f64; 4]) -> Self {
        derivatives[0]
    }
    #[inline]
    fn as_f64_slice_mut(numbers: &mut [Self]) -> Option<&mut [f64]> {
        Some(numbers)
    }
}

impl Scalar for f32 {
    const HAS_DERIVATIVES: bool = false;
    const EPSILON: f64 = f32::EPSILON as f64;
    #[inline]
    fn from_f64(value: f64) -> Self {
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
    fn compose(self, derivatives: &[f64; 4]) -> Self {
        derivatives[0] as Self
    }
}
