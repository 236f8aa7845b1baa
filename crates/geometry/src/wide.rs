//! Numbers of two words, about 32 digits: the rounding of an `f64` evaluation is seen by evaluating again in them.
//!
//! A [`Wide`] is an unevaluated sum `hi + lo` with |lo| ≤ ½ ulp(hi). Sums and products keep their rounding
//! errors by error-free transformations; one operation errs by a few 2⁻¹⁰⁴ of its result.
//!
//! Source: T. J. Dekker, *A floating-point technique for extending the available precision*, Numer. Math. 18
//! (1971); Y. Hida, X. S. Li, D. H. Bailey, *Algorithms for quad-double precision floating point arithmetic*,
//! ARITH-15 (2001).

use crate::scalar::Scalar;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A number of two words, `hi + lo`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wide {
    /// The nearest plain number.
    pub hi: f64,
    /// What it leaves.
    pub lo: f64,
}

/// π/2 in three words: a whole multiple of each is exact in two words.
const QUARTER: [f64; 3] = [
    f64::from_bits(0x3FF9_21FB_5444_2D18),
    f64::from_bits(0x3C91_A626_3314_5C07),
    f64::from_bits(0xB91F_1976_B7ED_8FBC),
];

/// a + b and its rounding error.
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// a + b and its rounding error, for |a| ≥ |b|.
#[inline]
fn quick_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// a × b and its rounding error.
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

impl Wide {
    /// π.
    pub const PI: Self = Self {
        hi: 2.0 * QUARTER[0],
        lo: 2.0 * QUARTER[1],
    };

    fn normal((hi, lo): (f64, f64)) -> Self {
        let (hi, lo) = quick_sum(hi, lo);
        Self { hi, lo }
    }

    /// A plain number times a plain number, exactly.
    pub fn product(a: f64, b: f64) -> Self {
        let (hi, lo) = two_product(a, b);
        Self { hi, lo }
    }

    /// The absolute value.
    pub fn abs(self) -> Self {
        if self.hi < 0.0 { -self } else { self }
    }

    /// Sine and cosine of |r| ≤ π/4 by their series.
    fn series(r: Self) -> (Self, Self) {
        let square = r * r;
        let (mut sin, mut cos) = (r, Self::lift(1.0));
        let (mut odd, mut even) = (r, cos);
        // (π/4)²⁹/29! is 1e-34.
        for k in 1..15 {
            let n = f64::from(2 * k);
            even = -(even * square) / Self::lift(n * (n - 1.0));
            odd = -(odd * square) / Self::lift(n * (n + 1.0));
            cos += even;
            sin += odd;
        }
        (sin, cos)
    }
}

impl Scalar for Wide {
    const DERIVES: bool = false;
    const EPSILON: f64 = f64::EPSILON * f64::EPSILON;

    #[inline]
    fn lift(value: f64) -> Self {
        Self { hi: value, lo: 0.0 }
    }

    #[inline]
    fn value(self) -> f64 {
        self.hi
    }

    /// One step of Newton's method from the plain root doubles its digits.
    fn sqrt(self) -> Self {
        let root = self.hi.sqrt();
        if root == 0.0 || !root.is_finite() {
            return Self::lift(root);
        }
        let rest = self - Self::product(root, root);
        Self::normal((root, rest.hi / (2.0 * root)))
    }

    fn sin_cos(self) -> (Self, Self) {
        let turns = (self.hi / QUARTER[0]).round();
        if !turns.is_finite() {
            return (Self::lift(f64::NAN), Self::lift(f64::NAN));
        }
        let r = QUARTER
            .iter()
            .fold(self, |rest, &part| rest - Self::product(turns, part));
        let (sin, cos) = Self::series(r);
        match turns.rem_euclid(4.0) {
            0.0 => (sin, cos),
            1.0 => (cos, -sin),
            2.0 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }

    /// The plain angle, and the small angle that is still between it and the vector.
    fn atan2(self, other: Self) -> Self {
        let angle = self.hi.atan2(other.hi);
        let (sin, cos) = Self::lift(angle).sin_cos();
        let across = self * cos - other * sin;
        let along = other * cos + self * sin;
        if along.hi == 0.0 {
            return Self::lift(angle);
        }
        // Of 1e-16 the cube is below the last digit.
        Self::lift(angle) + across / along
    }

    fn turns(count: f64) -> Self {
        Self::product(4.0 * count, QUARTER[0]) + Self::product(4.0 * count, QUARTER[1])
    }

    /// The function's own values are plain: its rounding is not seen, but what its argument's second word
    /// does to it is.
    fn through(self, derivatives: &[f64; 4]) -> Self {
        let [value, slope, ..] = *derivatives;
        Self::lift(value) + Self::product(slope, self.lo)
    }
}

impl Add for Wide {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        let (hi, rest) = two_sum(self.hi, o.hi);
        let (lo, least) = two_sum(self.lo, o.lo);
        let (hi, rest) = quick_sum(hi, rest + lo);
        Self::normal((hi, rest + least))
    }
}

impl Sub for Wide {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for Wide {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        let (hi, rest) = two_product(self.hi, o.hi);
        Self::normal((hi, rest + (self.hi * o.lo + self.lo * o.hi)))
    }
}

impl Div for Wide {
    type Output = Self;
    /// Long division: three quotients, each of what the ones before leave.
    #[inline]
    fn div(self, o: Self) -> Self {
        let first = self.hi / o.hi;
        if !first.is_finite() {
            return Self::lift(first);
        }
        let rest = self - o * Self::lift(first);
        let second = rest.hi / o.hi;
        let rest = rest - o * Self::lift(second);
        let (hi, lo) = quick_sum(first, second);
        Self::normal((hi, lo)) + Self::lift(rest.hi / o.hi)
    }
}

impl Neg for Wide {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

impl AddAssign for Wide {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl SubAssign for Wide {
    #[inline]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::SQRT_2;

    /// A few last digits: 2⁻¹⁰⁴ is 5e-32.
    const FEW: f64 = 3e-31;

    fn near(got: Wide, hi: f64, lo: f64) {
        let off = (got - Wide { hi, lo }).hi.abs();
        assert!(off <= FEW * hi.abs(), "{got:?} is off by {off:e}");
    }

    /// Values by an arbitrary-precision program, 40 digits, split into two words.
    #[test]
    fn val_thirty_digits() {
        near(
            Wide::lift(1.0) / Wide::lift(3.0),
            0.3333333333333333,
            1.850371707708594e-17,
        );
        near(Wide::lift(2.0).sqrt(), SQRT_2, -9.667293313452913e-17);
        near(
            Wide::lift(0.7).sin_cos().0,
            0.644217687237691,
            2.8740567927338755e-18,
        );
        near(
            Wide::lift(0.7).sin_cos().1,
            0.7648421872844885,
            -4.013780434022238e-17,
        );
        near(
            Wide::lift(-2.5).sin_cos().0,
            -0.5984721441039565,
            5.521403334082375e-17,
        );
        near(
            Wide::lift(-2.5).sin_cos().1,
            -0.8011436155469337,
            -1.8674742705085553e-17,
        );
        near(
            Wide::lift(100.25).sin_cos().0,
            -0.2772828564548513,
            -1.361336774720287e-17,
        );
        near(
            Wide::lift(100.25).sin_cos().1,
            0.9607883312760612,
            -2.1441388741342008e-17,
        );
        near(
            Wide::lift(1.5).atan2(Wide::lift(-0.25)),
            1.7359450042095235,
            -1.035362362795107e-17,
        );
        near(Wide::product(0.1, 0.3), 0.03, 1.6653345369377347e-18);
    }

    #[test]
    fn val_identities() {
        for k in -40..40 {
            let x = Wide::lift(f64::from(k) * 0.37) / Wide::lift(3.0);
            let (sin, cos) = x.sin_cos();
            assert!((sin * sin + cos * cos - Wide::lift(1.0)).hi.abs() < FEW);
            let (twice, _) = (x + x).sin_cos();
            assert!(
                (twice - Wide::lift(2.0) * sin * cos).hi.abs() < 4.0 * FEW,
                "{k}"
            );
            let back = (sin.atan2(cos) - x) / (Wide::lift(2.0) * Wide::PI);
            assert!(
                (back.hi - back.hi.round() + back.lo).abs() < 4.0 * FEW,
                "{k}"
            );
            let root = (x * x).sqrt();
            assert!((root - x.abs()).hi.abs() <= FEW * x.hi.abs());
            if k != 0 {
                assert!((x / x - Wide::lift(1.0)).hi.abs() < FEW);
            }
        }
    }

    #[test]
    fn a_thousand_turns_lose_no_more_than_their_own_digits() {
        let x = Wide::lift(0.7);
        let far = x + Wide::PI * Wide::lift(2000.0);
        let (near, far) = (x.sin_cos().0, far.sin_cos().0);
        assert!((near - far).hi.abs() < 2000.0 * 4.0 * FEW);
    }

    #[test]
    fn what_is_no_number_stays_none() {
        let nan = Wide::lift(f64::NAN);
        assert!(nan.sqrt().hi.is_nan() && nan.sin_cos().0.hi.is_nan());
        assert!((Wide::lift(1.0) / Wide::lift(0.0)).hi.is_infinite());
        assert!(Wide::lift(-1.0).sqrt().hi.is_nan());
    }
}
