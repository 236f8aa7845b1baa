//! Double-double numbers, about 32 digits. A second evaluation in these numbers gives the rounding error of an `f64` evaluation.
//!
//! A [`DoubleDouble`] is an unevaluated sum `hi + lo` with |lo| ≤ ½ ulp(hi). Sums and products use error-free transformations; the
//! relative error of one operation is a few 2⁻¹⁰⁴.
//!
//! Source: T. J. Dekker, *A floating-point technique for extending the available precision*, Numer. Math. 18
//! (1971); Y. Hida, X. S. Li, D. H. Bailey, *Algorithms for quad-double precision floating point arithmetic*,
//! ARITH-15 (2001).

use crate::scalar::Scalar;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A double-double number, `hi + lo`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DoubleDouble {
    /// The nearest `f64`.
    pub hi: f64,
    /// The remainder.
    pub lo: f64,
}

/// π/2 in three words: a whole multiple of each is exact in two words.
const HALF_PI_PARTS: [f64; 3] = [
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
#[cfg(not(target_family = "wasm"))]
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

#[cfg(target_family = "wasm")]
use split_product as two_product;

/// a × b and its rounding error without a fused multiply-add, which WebAssembly lacks, by products of halves (Dekker 1971). Exact for
/// numbers below 2⁹⁹⁶ if no product of halves underflows.
#[cfg(any(target_family = "wasm", test))]
#[inline]
fn split_product(a: f64, b: f64) -> (f64, f64) {
    /// 2²⁷ + 1 splits 53 digits into halves.
    const SPLITTER: f64 = 134_217_729.0;
    let split = |x: f64| {
        let scaled = SPLITTER * x;
        let high = scaled - (scaled - x);
        (high, x - high)
    };
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    let product = a * b;
    let rest = a_high * b_high - product + a_high * b_low + a_low * b_high;
    (product, rest + a_low * b_low)
}

impl DoubleDouble {
    /// π.
    pub const PI: Self = Self {
        hi: 2.0 * HALF_PI_PARTS[0],
        lo: 2.0 * HALF_PI_PARTS[1],
    };

    fn renormalized((hi, lo): (f64, f64)) -> Self {
        let (hi, lo) = quick_sum(hi, lo);
        Self { hi, lo }
    }

    /// The exact product of two `f64`.
    pub fn exact_product(a: f64, b: f64) -> Self {
        let (hi, lo) = two_product(a, b);
        Self { hi, lo }
    }

    /// The absolute value.
    pub fn abs(self) -> Self {
        if self.hi < 0.0 { -self } else { self }
    }

    /// Sine and cosine of |r| ≤ π/4 by their series.
    fn sin_cos_series(r: Self) -> (Self, Self) {
        let square = r * r;
        let (mut sin, mut cos) = (r, Self::from_f64(1.0));
        let (mut odd, mut even) = (r, cos);
        // (π/4)²⁹/29! is 1e-34.
        for k in 1..15 {
            let n = f64::from(2 * k);
            even = -(even * square) / Self::from_f64(n * (n - 1.0));
            odd = -(odd * square) / Self::from_f64(n * (n + 1.0));
            cos += even;
            sin += odd;
        }
        (sin, cos)
    }
}

impl Scalar for DoubleDouble {
    const HAS_DERIVATIVES: bool = false;
    const EPSILON: f64 = f64::EPSILON * f64::EPSILON;

    #[inline]
    fn from_f64(value: f64) -> Self {
        Self { hi: value, lo: 0.0 }
    }

    #[inline]
    fn value(self) -> f64 {
        self.hi
    }

    /// One step of Newton's method from the `f64` root doubles its digits.
    fn sqrt(self) -> Self {
        let root = self.hi.sqrt();
        if root == 0.0 || !root.is_finite() {
            return Self::from_f64(root);
        }
        let rest = self - Self::exact_product(root, root);
        Self::renormalized((root, rest.hi / (2.0 * root)))
    }

    fn sin_cos(self) -> (Self, Self) {
        let quarters = (self.hi / HALF_PI_PARTS[0]).round();
        if !quarters.is_finite() {
            return (Self::from_f64(f64::NAN), Self::from_f64(f64::NAN));
        }
        let r = HALF_PI_PARTS.iter().fold(self, |rest, &part| {
            rest - Self::exact_product(quarters, part)
        });
        let (sin, cos) = Self::sin_cos_series(r);
        match quarters.rem_euclid(4.0) {
            0.0 => (sin, cos),
            1.0 => (cos, -sin),
            2.0 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }

    /// The `f64` angle plus the small angle between it and the vector.
    fn atan2(self, other: Self) -> Self {
        let angle = self.hi.atan2(other.hi);
        let (sin, cos) = Self::from_f64(angle).sin_cos();
        let across = self * cos - other * sin;
        let along = other * cos + self * sin;
        if along.hi == 0.0 {
            return Self::from_f64(angle);
        }
        // The angle is about 1e-16; its cube is below the last digit.
        Self::from_f64(angle) + across / along
    }

    fn from_revolutions(count: f64) -> Self {
        Self::exact_product(4.0 * count, HALF_PI_PARTS[0])
            + Self::exact_product(4.0 * count, HALF_PI_PARTS[1])
    }

    /// The values of the function are `f64`, so its own rounding is ignored; the effect of the argument's
    /// second word is included.
    fn compose(self, derivatives: &[f64; 4]) -> Self {
        let [value, slope, ..] = *derivatives;
        Self::from_f64(value) + Self::exact_product(slope, self.lo)
    }
}

// Not inlined in WebAssembly: evaluations in these numbers would otherwise be most of the module.
impl Add for DoubleDouble {
    type Output = Self;
    #[cfg_attr(not(target_family = "wasm"), inline)]
    #[cfg_attr(target_family = "wasm", inline(never))]
    fn add(self, o: Self) -> Self {
        let (hi, rest) = two_sum(self.hi, o.hi);
        let (lo, rest_lo) = two_sum(self.lo, o.lo);
        let (hi, rest) = quick_sum(hi, rest + lo);
        Self::renormalized((hi, rest + rest_lo))
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[cfg_attr(not(target_family = "wasm"), inline)]
    #[cfg_attr(target_family = "wasm", inline(never))]
    fn mul(self, o: Self) -> Self {
        let (hi, rest) = two_product(self.hi, o.hi);
        Self::renormalized((hi, rest + (self.hi * o.lo + self.lo * o.hi)))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    /// Long division: three quotients, each of the remainder of the previous ones.
    #[cfg_attr(not(target_family = "wasm"), inline)]
    #[cfg_attr(target_family = "wasm", inline(never))]
    fn div(self, o: Self) -> Self {
        let first = self.hi / o.hi;
        if !first.is_finite() {
            return Self::from_f64(first);
        }
        let rest = self - o * Self::from_f64(first);
        let second = rest.hi / o.hi;
        let rest = rest - o * Self::from_f64(second);
        let (hi, lo) = quick_sum(first, second);
        Self::renormalized((hi, lo)) + Self::from_f64(rest.hi / o.hi)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

impl AddAssign for DoubleDouble {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl SubAssign for DoubleDouble {
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

    fn near(got: DoubleDouble, hi: f64, lo: f64) {
        let error = (got - DoubleDouble { hi, lo }).hi.abs();
        assert!(error <= FEW * hi.abs(), "{got:?} is off by {error:e}");
    }

    /// Values by an arbitrary-precision program, 40 digits, split into two words.
    #[test]
    fn val_thirty_digits() {
        near(
            DoubleDouble::from_f64(1.0) / DoubleDouble::from_f64(3.0),
            0.3333333333333333,
            1.850371707708594e-17,
        );
        near(
            DoubleDouble::from_f64(2.0).sqrt(),
            SQRT_2,
            -9.667293313452913e-17,
        );
        near(
            DoubleDouble::from_f64(0.7).sin_cos().0,
            0.644217687237691,
            2.8740567927338755e-18,
        );
        near(
            DoubleDouble::from_f64(0.7).sin_cos().1,
            0.7648421872844885,
            -4.013780434022238e-17,
        );
        near(
            DoubleDouble::from_f64(-2.5).sin_cos().0,
            -0.5984721441039565,
            5.521403334082375e-17,
        );
        near(
            DoubleDouble::from_f64(-2.5).sin_cos().1,
            -0.8011436155469337,
            -1.8674742705085553e-17,
        );
        near(
            DoubleDouble::from_f64(100.25).sin_cos().0,
            -0.2772828564548513,
            -1.361336774720287e-17,
        );
        near(
            DoubleDouble::from_f64(100.25).sin_cos().1,
            0.9607883312760612,
            -2.1441388741342008e-17,
        );
        near(
            DoubleDouble::from_f64(1.5).atan2(DoubleDouble::from_f64(-0.25)),
            1.7359450042095235,
            -1.035362362795107e-17,
        );
        near(
            DoubleDouble::exact_product(0.1, 0.3),
            0.03,
            1.6653345369377347e-18,
        );
    }

    #[test]
    fn products_by_halves_are_those_of_the_fused_operation() {
        let mut x = 0.37_f64;
        for k in -300..300 {
            x = (x * 997.0 + 0.123).fract();
            let (a, b) = ((x - 0.5) * f64::from(k).exp2(), (0.7 - x * x) * 3.0);
            assert_eq!(split_product(a, b), two_product(a, b), "{a} × {b}");
        }
    }

    #[test]
    fn val_identities() {
        for k in -40..40 {
            let x = DoubleDouble::from_f64(f64::from(k) * 0.37) / DoubleDouble::from_f64(3.0);
            let (sin, cos) = x.sin_cos();
            assert!(
                (sin * sin + cos * cos - DoubleDouble::from_f64(1.0))
                    .hi
                    .abs()
                    < FEW
            );
            let (twice, _) = (x + x).sin_cos();
            assert!(
                (twice - DoubleDouble::from_f64(2.0) * sin * cos).hi.abs() < 4.0 * FEW,
                "{k}"
            );
            let back = (sin.atan2(cos) - x) / (DoubleDouble::from_f64(2.0) * DoubleDouble::PI);
            assert!(
                (back.hi - back.hi.round() + back.lo).abs() < 4.0 * FEW,
                "{k}"
            );
            let root = (x * x).sqrt();
            assert!((root - x.abs()).hi.abs() <= FEW * x.hi.abs());
            if k != 0 {
                assert!((x / x - DoubleDouble::from_f64(1.0)).hi.abs() < FEW);
            }
        }
    }

    #[test]
    fn a_thousand_turns_lose_no_more_than_their_own_digits() {
        let x = DoubleDouble::from_f64(0.7);
        let far = x + DoubleDouble::PI * DoubleDouble::from_f64(2000.0);
        let (near, far) = (x.sin_cos().0, far.sin_cos().0);
        assert!((near - far).hi.abs() < 2000.0 * 4.0 * FEW);
    }

    #[test]
    fn what_is_no_number_stays_none() {
        let nan = DoubleDouble::from_f64(f64::NAN);
        assert!(nan.sqrt().hi.is_nan() && nan.sin_cos().0.hi.is_nan());
        assert!(
            (DoubleDouble::from_f64(1.0) / DoubleDouble::from_f64(0.0))
                .hi
                .is_infinite()
        );
        assert!(DoubleDouble::from_f64(-1.0).sqrt().hi.is_nan());
    }
}
