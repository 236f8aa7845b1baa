//! Sine and cosine of several numbers side by side, with the bits of single evaluations.
//!
//! The functions of the platform take one number at a time, and their bits differ between platforms. Here an
//! angle is reduced to r = x − k π/2 with |r| ≤ π/4, and two polynomials in r² give both functions. No lane takes a
//! branch of its own, so the compiler generates vector instructions.

use crate::scalar::{Scalar, map_array};
use std::f64::consts::FRAC_2_PI;

/// π/2 in three parts. The first two have 41 bits each, so that their products with k are exact.
const HALF_PI_PARTS: [f64; 3] = [
    1.570_796_326_794_152_3,
    7.443_547_480_484_391e-13,
    2.232_414_100_745_812e-25,
];

/// Largest angle, rad, for which k has at most 12 bits: a thousand revolutions. Larger angles use the platform's functions.
const MAX_REDUCED: f64 = 6.4e3;

/// Adding this to a number below 2⁵¹ rounds it to the nearest integer, which is then in the last bits of the sum.
/// Subtracting it again gives that integer.
const ROUNDING_SHIFT: f64 = 1.5 * (1_u64 << 52) as f64;

/// (sin r − r)/r³ as the minimax polynomial in r²: the relative error of the sine over |r| ≤ π/4 is 4e-18.
const SIN_COEFFICIENTS: [f64; 6] = [
    -0.166_666_666_666_666_3,
    0.008_333_333_333_321_84,
    -0.000_198_412_698_293_585_28,
    2.755_731_353_851_434e-6,
    -2.505_073_438_930_579e-8,
    1.589_543_329_488_574_6e-10,
];

/// (cos r − 1 + r²/2)/r⁴ as the minimax polynomial in r²: 6e-20.
const COS_COEFFICIENTS: [f64; 6] = [
    0.041_666_666_666_666_595,
    -0.001_388_888_888_887_334_2,
    2.480_158_728_900_208e-5,
    -2.755_731_421_703_879_7e-7,
    2.087_570_539_599_661e-9,
    -1.135_874_923_601_705_3e-11,
];

/// Sine and cosine, each within 0.8 of a unit in its last place. `split` and `join` convert a number type into
/// its lanes and back.
#[inline(always)]
pub fn sin_cos<T: Scalar, const N: usize>(
    x: T,
    split: impl Fn(T) -> [f64; N] + Copy,
    join: impl Fn([f64; N]) -> T + Copy,
) -> (T, T) {
    let plain = split(x);
    if plain.iter().all(|x| x.abs() <= MAX_REDUCED) {
        return to_quadrants(sin_cos_reduced(x), split, join);
    }
    let (sin, cos) = sin_cos_by_lane(plain);
    (join(sin), join(cos))
}

/// Lanes in registers, whose sines are computed without splitting them.
pub trait LanesInRegisters: Scalar {
    /// Exchanges and signs a sine and a cosine by a shifted k, as `to_quadrants` does lane by lane.
    fn to_quadrants(reduced: [Self; 3]) -> (Self, Self);
    /// Sine and cosine lane by lane, by [`sin_cos_by_lane`].
    fn sin_cos_by_lane(self) -> (Self, Self);
}

/// Sine and cosine of lanes in registers, with the bits of [`sin_cos`].
#[inline(always)]
pub fn sin_cos_in_registers<T: LanesInRegisters>(x: T) -> (T, T) {
    if T::from_f64(MAX_REDUCED * MAX_REDUCED).exceeds(x * x) {
        return T::to_quadrants(sin_cos_reduced(x));
    }
    x.sin_cos_by_lane()
}

/// Sines and cosines of angles if one of them is large or NaN.
#[cold]
#[inline(never)]
pub fn sin_cos_by_lane<const N: usize>(x: [f64; N]) -> ([f64; N], [f64; N]) {
    let both = x.map(|x| {
        if x.abs() <= MAX_REDUCED {
            Scalar::sin_cos(x)
        } else {
            x.sin_cos()
        }
    });
    (both.map(|b| b.0), both.map(|b| b.1))
}

/// Sine and cosine of x − k π/2, and k in the last bits of a number.
#[inline(always)]
fn sin_cos_reduced<T: Scalar>(x: T) -> [T; 3] {
    let shifted = x * T::from_f64(FRAC_2_PI) + T::from_f64(ROUNDING_SHIFT);
    let k = shifted - T::from_f64(ROUNDING_SHIFT);
    let [one, two, three] = map_array(HALF_PI_PARTS, T::from_f64);
    // Both are exact except for the rounding of r, which is in `rest`.
    let (first, second) = (x - k * one, k * two);
    let r = first - second;
    let rest = ((first - r) - second) - k * three;

    let square = r * r;
    let half = T::from_f64(0.5) * square;
    let sin = r + (square * r * polynomial(SIN_COEFFICIENTS, square) + (rest - rest * half));
    // 1 − r²/2 is rounded; its rounding error is exact.
    let cos = T::from_f64(1.0) - half;
    let lost = (T::from_f64(1.0) - cos) - half;
    let cos = cos + (lost + (square * square * polynomial(COS_COEFFICIENTS, square) - r * rest));
    [sin, cos, shifted]
}

/// Odd quadrants exchange the two; their signs follow from the last two bits of k.
#[inline(always)]
fn to_quadrants<T: Scalar, const N: usize>(
    reduced: [T; 3],
    split: impl Fn(T) -> [f64; N],
    join: impl Fn([f64; N]) -> T,
) -> (T, T) {
    let [mut sin, mut cos, k] = reduced.map(split);
    for ((sin, cos), k) in sin.iter_mut().zip(&mut cos).zip(k) {
        let k = k.to_bits();
        let both = [sin.to_bits(), cos.to_bits()];
        let other = (both[0] ^ both[1]) & (k & 1).wrapping_neg();
        let sign = |k: u64| (k & 2) << 62;
        *sin = f64::from_bits(both[0] ^ other ^ sign(k));
        *cos = f64::from_bits(both[1] ^ other ^ sign(k + 1));
    }
    (join(sin), join(cos))
}

/// A polynomial in pairs of terms (Estrin), with less latency than Horner's rule.
#[inline(always)]
fn polynomial<T: Scalar>(of: [f64; 6], x: T) -> T {
    let of = map_array(of, T::from_f64);
    let square = x * x;
    (of[0] + of[1] * x) + square * ((of[2] + of[3] * x) + square * (of[4] + of[5] * x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::double_double::DoubleDouble;
    use crate::lanes::Lanes;
    use std::array;
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    fn alone(x: f64) -> (f64, f64) {
        Scalar::sin_cos(x)
    }

    /// Angles over the whole range, and near zeros of the sine and limits of the quadrants.
    fn angles() -> Vec<f64> {
        let mut all: Vec<f64> = (0..40_000)
            .map(|i| {
                let part = (f64::from(i) * 0.618_033_988_749_894_9).fract();
                let size = [1e-3, 1.0, TAU, 100.0, MAX_REDUCED][i as usize % 5];
                size * (2.0 * part - 1.0)
            })
            .collect();
        for k in -4070..=4070 {
            let at = f64::from(k) * 0.5 * FRAC_PI_2;
            all.extend([at.next_down(), at, at.next_up(), at + 1e-9]);
        }
        all.retain(|x| x.abs() <= MAX_REDUCED);
        all
    }

    #[test]
    fn errors_are_below_one_unit_in_the_last_place() {
        let mut max_error = 0.0_f64;
        for x in angles() {
            let (sin, cos) = alone(x);
            let reference = DoubleDouble::from_f64(x).sin_cos();
            for (value, reference) in [(sin, reference.0), (cos, reference.1)] {
                // For a number with all bits set, the unit in the last place is relatively half as large.
                let unit = reference.hi.abs().next_up() - reference.hi.abs();
                let error = (DoubleDouble::from_f64(value) - reference).value().abs() / unit;
                max_error = max_error.max(error);
                assert!(error < 0.8, "{x}: {value:e} is {error} units off");
            }
        }
        assert!(max_error > 0.5, "{max_error}");
    }

    #[test]
    fn lanes_have_the_bits_of_a_number_alone() {
        let far = [1e4, -1e22, f64::INFINITY, f64::NAN, 0.0, -0.0, 1e-310];
        let all: Vec<f64> = angles().into_iter().chain(far).collect();
        for at in 0..all.len() - 3 {
            let four: [f64; 4] = array::from_fn(|i| all[at + i]);
            let (sin, cos) = Lanes(four).sin_cos();
            for (i, x) in four.into_iter().enumerate() {
                let alone = alone(x);
                assert_eq!(sin.0[i].to_bits(), alone.0.to_bits(), "sin {x}");
                assert_eq!(cos.0[i].to_bits(), alone.1.to_bits(), "cos {x}");
            }
        }
    }

    #[test]
    fn whole_quarters_and_no_numbers() {
        assert_eq!(alone(0.0), (0.0, 1.0));
        assert_eq!(alone(PI).1, -1.0);
        assert_eq!(alone(FRAC_PI_2).0, 1.0);
        assert!(alone(f64::NAN).0.is_nan() && alone(f64::INFINITY).1.is_nan());
    }
}
