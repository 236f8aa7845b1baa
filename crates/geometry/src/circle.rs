//! Sine and cosine of several numbers side by side, each to the bits of a number alone.
//!
//! The library of the platform takes one number at a time, and other platforms give other bits. Here an
//! angle is taken to r = x − k π/2 in |r| ≤ π/4, and two polynomials in r² give both; no lane takes a
//! branch of its own, so the compiler makes vector instructions of it.

use crate::scalar::{Scalar, each};
use std::f64::consts::FRAC_2_PI;

/// π/2 in three parts. The first two have 41 bits each, so that their products with k are exact.
const QUARTER: [f64; 3] = [
    1.570_796_326_794_152_3,
    7.443_547_480_484_391e-13,
    2.232_414_100_745_812e-25,
];

/// Up to here k has at most 12 bits, rad: a thousand turns. What is farther off is left to the platform.
const FARTHEST: f64 = 6.4e3;

/// Added to a number below 2⁵¹ and taken off again, it leaves the nearest whole number, which until then
/// stands in the last bits.
const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;

/// (sin r − r)/r³ as a polynomial in r²: the least relative error of the sine over |r| ≤ π/4 is 4e-18.
const SINE: [f64; 6] = [
    -0.166_666_666_666_666_3,
    0.008_333_333_333_321_84,
    -0.000_198_412_698_293_585_28,
    2.755_731_353_851_434e-6,
    -2.505_073_438_930_579e-8,
    1.589_543_329_488_574_6e-10,
];

/// (cos r − 1 + r²/2)/r⁴ likewise: 6e-20.
const COSINE: [f64; 6] = [
    0.041_666_666_666_666_595,
    -0.001_388_888_888_887_334_2,
    2.480_158_728_900_208e-5,
    -2.755_731_421_703_879_7e-7,
    2.087_570_539_599_661e-9,
    -1.135_874_923_601_705_3e-11,
];

/// Sine and cosine, each within 0.8 of a unit in its last place. A kind of number says how it is split into
/// plain ones side by side, and how it is joined of them.
#[inline(always)]
pub fn sin_cos<T: Scalar, const N: usize>(
    x: T,
    split: impl Fn(T) -> [f64; N] + Copy,
    join: impl Fn([f64; N]) -> T + Copy,
) -> (T, T) {
    let plain = split(x);
    if plain.iter().all(|x| x.abs() <= FARTHEST) {
        return near(x, split, join);
    }
    let (sin, cos) = far(plain);
    (join(sin), join(cos))
}

/// Where one of them is far off, or no number.
#[cold]
#[inline(never)]
fn far<const N: usize>(x: [f64; N]) -> ([f64; N], [f64; N]) {
    let both = x.map(|x| {
        if x.abs() <= FARTHEST {
            Scalar::sin_cos(x)
        } else {
            x.sin_cos()
        }
    });
    (both.map(|b| b.0), both.map(|b| b.1))
}

#[inline(always)]
fn near<T: Scalar, const N: usize>(
    x: T,
    split: impl Fn(T) -> [f64; N],
    join: impl Fn([f64; N]) -> T,
) -> (T, T) {
    let shifted = x * T::lift(FRAC_2_PI) + T::lift(WHOLE);
    let k = shifted - T::lift(WHOLE);
    let [one, two, three] = each(QUARTER, T::lift);
    // Both exact but for the rounding of r, and that is in `rest`.
    let (first, second) = (x - k * one, k * two);
    let r = first - second;
    let rest = ((first - r) - second) - k * three;

    let square = r * r;
    let half = T::lift(0.5) * square;
    let sin = r + (square * r * polynomial(SINE, square) + (rest - rest * half));
    // 1 − r²/2 is rounded; what it lost is exact.
    let cos = T::lift(1.0) - half;
    let lost = (T::lift(1.0) - cos) - half;
    let cos = cos + (lost + (square * square * polynomial(COSINE, square) - r * rest));

    // Odd quarters exchange the two; their signs follow from the last two bits of k.
    let [mut sin, mut cos, k] = [sin, cos, shifted].map(split);
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

/// In pairs, which wait for each other less than one term after another.
#[inline(always)]
fn polynomial<T: Scalar>(of: [f64; 6], x: T) -> T {
    let of = each(of, T::lift);
    let square = x * x;
    (of[0] + of[1] * x) + square * ((of[2] + of[3] * x) + square * (of[4] + of[5] * x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Lanes;
    use crate::wide::Wide;
    use std::array;
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    fn alone(x: f64) -> (f64, f64) {
        Scalar::sin_cos(x)
    }

    /// Over the whole extent, and where a sine is next to zero or the quarters change.
    fn angles() -> Vec<f64> {
        let mut all: Vec<f64> = (0..40_000)
            .map(|i| {
                let part = (f64::from(i) * 0.618_033_988_749_894_9).fract();
                let size = [1e-3, 1.0, TAU, 100.0, FARTHEST][i as usize % 5];
                size * (2.0 * part - 1.0)
            })
            .collect();
        for k in -4070..=4070 {
            let at = f64::from(k) * 0.5 * FRAC_PI_2;
            all.extend([at.next_down(), at, at.next_up(), at + 1e-9]);
        }
        all.retain(|x| x.abs() <= FARTHEST);
        all
    }

    #[test]
    fn errors_are_below_one_unit_in_the_last_place() {
        let mut most = 0.0_f64;
        for x in angles() {
            let (sin, cos) = alone(x);
            let truth = Wide::lift(x).sin_cos();
            for (value, truth) in [(sin, truth.0), (cos, truth.1)] {
                // Of a number with all its bits set the unit is half as large, relatively.
                let unit = truth.hi.abs().next_up() - truth.hi.abs();
                let off = (Wide::lift(value) - truth).value().abs() / unit;
                most = most.max(off);
                assert!(off < 0.8, "{x}: {value:e} is {off} units off");
            }
        }
        assert!(most > 0.5, "{most}");
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
