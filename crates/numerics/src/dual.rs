//! Dual numbers: values with exact first derivatives (forward differentiation).

use crate::scalar::Scalar;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A value with its derivative: v + d ε with ε² = 0. The evaluation of a function at q + ε gives its derivative
/// with respect to q, exact to rounding.
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

    #[inline]
    fn new(v: f64, d: f64) -> Self {
        Self { v, d }
    }
}

impl Scalar for Dual {
    const HAS_DERIVATIVES: bool = true;
    const EPSILON: f64 = f64::EPSILON;
    #[inline]
    fn from_f64(value: f64) -> Self {
        Self::new(value, 0.0)
    }
    #[inline]
    fn value(self) -> f64 {
        self.v
    }
    #[inline]
    fn sqrt(self) -> Self {
        let v = self.v.sqrt();
        Self::new(v, 0.5 * self.d / v)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = Scalar::sin_cos(self.v);
        (Self::new(s, c * self.d), Self::new(c, -s * self.d))
    }
    #[inline]
    fn atan2(self, other: Self) -> Self {
        let square = self.v * self.v + other.v * other.v;
        Self::new(
            self.v.atan2(other.v),
            (other.v * self.d - self.v * other.d) / square,
        )
    }
    #[inline]
    fn compose(self, derivatives: &[f64; 4]) -> Self {
        Self::new(derivatives[0], derivatives[1] * self.d)
    }
}

impl Add for Dual {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self::new(self.v + o.v, self.d + o.d)
    }
}

impl Sub for Dual {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self::new(self.v - o.v, self.d - o.d)
    }
}

impl Mul for Dual {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self::new(self.v * o.v, self.d * o.v + self.v * o.d)
    }
}

impl Div for Dual {
    type Output = Self;
    #[inline]
    fn div(self, o: Self) -> Self {
        let v = self.v / o.v;
        Self::new(v, (self.d - v * o.d) / o.v)
    }
}

impl Neg for Dual {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.v, -self.d)
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
            (s * s / (Dual::from_f64(2.0) + c) - (-x) * c).sqrt()
        };
        let (x, h) = (0.7, 1e-6);
        let slope = (f(Dual::from_f64(x + h)).v - f(Dual::from_f64(x - h)).v) / (2.0 * h);
        assert!((f(Dual::variable(x)).d - slope).abs() < 1e-9);
    }
}
