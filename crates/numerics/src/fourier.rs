//! Fourier series of smooth periodic functions from values at equally spaced points. The error of the trapezoidal
//! rule decreases as fast as the Fourier coefficients, so the number of points is doubled until the coefficients have
//! decayed to rounding.

use std::f64::consts::TAU;

/// Minimum number of points for a function to count as resolved.
pub const MIN_POINTS: usize = 32;
/// Maximum number of points; a function that needs more is not resolved.
pub const MAX_POINTS: usize = 8192;
/// Number of points from which an unresolved function counts as sharp; panels are more efficient then.
pub const SHARP_POINTS: usize = 2048;
/// Coefficients below this fraction of the largest are rounding errors.
const COEFFICIENT_ROUNDING: f64 = 1e-16;
/// Below this fraction, coefficients that no longer decrease from the third to the last quarter are also rounding errors,
/// of less accurate values. (Those of a smooth function fall by a factor of 100 there.)
const NOISY_TAIL: f64 = 1e-8;
const FLATNESS: f64 = 0.25;
/// Phases at which a series is compared with its function, as fractions of a period; no fractions with a small denominator.
const BETWEEN: [f64; 5] = [
    0.107_295_316,
    0.290_743_847,
    0.483_198_233,
    0.668_620_151,
    0.886_441_529,
];
/// The truncation error there may be this many times the largest of the last coefficients, or of a rounding error.
const LEFT_OUT: f64 = 1e4;

/// A function of a phase s from 0 to 2π: c₀ + Σ c_k cos ks + s_k sin ks.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FourierSeries {
    /// c₀, the mean over a period.
    pub mean: f64,
    /// (c_k, s_k) for k = 1, 2, …
    pub harmonics: Vec<[f64; 2]>,
    /// The largest of the last coefficients relative to `size`.
    pub tail: f64,
    /// Whether the last coefficients are rounding errors.
    pub is_resolved: bool,
}

impl FourierSeries {
    /// The series through values at equally spaced phases; coefficients are judged relative to
    /// `size`.
    pub fn new(values: &[f64], size: f64) -> Self {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let mut harmonics = fourier_coefficients(values);
        let largest = |of: &[[f64; 2]]| of.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
        let count = harmonics.len();
        let tail = largest(&harmonics[count - 4..]);
        let tail = match (mean.is_finite(), tail == 0.0) {
            (true, true) => 0.0,
            (true, false) => tail / size,
            // A NaN enters every coefficient.
            (false, _) => f64::INFINITY,
        };
        let sum = |of: &[[f64; 2]]| of.iter().flatten().map(|c| c.abs()).sum::<f64>();
        let [half, rest] = [count / 2, count - count / 4];
        let is_flat = sum(&harmonics[rest..]) > FLATNESS * sum(&harmonics[half..rest]);
        let is_rounding = count >= MIN_POINTS && tail < NOISY_TAIL && is_flat;
        let kept = |[c, s]: &[f64; 2]| c.abs().max(s.abs()) > COEFFICIENT_ROUNDING.max(tail) * size;
        let last = harmonics.iter().rposition(kept);
        harmonics.truncate(last.map_or(0, |l| l + 1));
        Self {
            mean,
            harmonics,
            tail,
            // A coefficient contains up to sixteen rounding errors of a value.
            is_resolved: tail < 16.0 * COEFFICIENT_ROUNDING || is_rounding,
        }
    }

    /// Compares the series with its function between the points: aliased harmonics, such as 32 waves at 32 points,
    /// appear at the points as lower harmonics or as none. If they differ, the series is marked as unresolved, and its tail is
    /// the difference relative to `size`.
    ///
    /// # Errors
    /// The first error of `at`, the function of the fraction (0 … 1) of a period.
    pub fn check_between<E>(
        &mut self,
        size: f64,
        mut at: impl FnMut(f64) -> Result<f64, E>,
    ) -> Result<(), E> {
        let mut difference = 0.0_f64;
        for part in BETWEEN {
            let error = (at(part)? - self.eval(TAU * part)[0]).abs() / size;
            // A NaN counts as a difference.
            difference = if error.is_nan() {
                f64::INFINITY
            } else {
                difference.max(error)
            };
        }
        if difference > LEFT_OUT * self.tail.max(COEFFICIENT_ROUNDING) {
            self.tail = difference;
            self.is_resolved = false;
        }
        Ok(())
    }

    /// Its value and its integral from zero at a phase.
    pub fn eval(&self, phase: f64) -> [f64; 2] {
        let (sin, cos) = phase.sin_cos();
        let (mut c, mut s) = (1.0, 0.0);
        let mut sums = [self.mean, self.mean * phase];
        for (k, [ck, sk]) in self.harmonics.iter().enumerate() {
            (c, s) = (c * cos - s * sin, s * cos + c * sin);
            sums[0] += ck * c + sk * s;
            sums[1] += (ck * s + sk * (1.0 - c)) / (k + 1) as f64;
        }
        sums
    }
}

/// Samples at twice as many equally spaced fractions (0 … 1) of a period as `known` holds; the known ones are reused. If `known`
/// is empty, the samples at `first` fractions, a power of two from 16.
///
/// # Errors
/// The first error of `at`.
pub fn refine_samples<V, E>(
    known: Vec<V>,
    first: usize,
    mut at: impl FnMut(f64) -> Result<V, E>,
) -> Result<Vec<V>, E> {
    if known.is_empty() {
        return (0..first).map(|k| at(k as f64 / first as f64)).collect();
    }
    let points = known.len();
    let mut finer = Vec::with_capacity(2 * points);
    for (k, value) in known.into_iter().enumerate() {
        finer.push(value);
        finer.push(at((k as f64 + 0.5) / points as f64)?);
    }
    Ok(finer)
}

/// Fourier coefficients (c_k, s_k) for k from 1 to below half the number of points, which is a power of two (Cooley and
/// Tukey 1965).
pub fn fourier_coefficients(values: &[f64]) -> Vec<[f64; 2]> {
    let n = values.len();
    let bits = n.trailing_zeros();
    let bit_reversed = |i: usize| i.reverse_bits() >> (usize::BITS - bits);
    let mut sums: Vec<[f64; 2]> = (0..n).map(|i| [values[bit_reversed(i)], 0.0]).collect();
    let table: Vec<(f64, f64)> = (0..n / 2)
        .map(|i| (TAU * i as f64 / n as f64).sin_cos())
        .collect();
    let mut half = 1;
    while half < n {
        for block in sums.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for (k, (a, b)) in low.iter_mut().zip(high).enumerate() {
                let (sin, cos) = table[k * (n / (2 * half))];
                let rotated = [b[0] * cos - b[1] * sin, b[0] * sin + b[1] * cos];
                *b = [a[0] - rotated[0], a[1] - rotated[1]];
                *a = [a[0] + rotated[0], a[1] + rotated[1]];
            }
        }
        half *= 2;
    }
    sums.truncate(n / 2);
    sums.drain(1..)
        .map(|sum| sum.map(|s| 2.0 * s / n as f64))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 16, 32 or 64 waves in a period are invisible at 32 points, but not between them; 15 waves are resolved.
    #[test]
    fn waves_beyond_the_points_are_seen_between_them() {
        for (waves, resolved) in [(3.0, true), (16.0, false), (32.0, false), (64.0, false)] {
            let at = |part: f64| 1.0 + 1e-9 * (waves * TAU * part).sin();
            let values: Vec<f64> = (0..32).map(|k| at(f64::from(k) / 32.0)).collect();
            let mut series = FourierSeries::new(&values, 1.0);
            assert!(series.is_resolved, "{waves}: {}", series.tail);
            series
                .check_between(1.0, |part| Ok::<f64, ()>(at(part)))
                .unwrap();
            assert_eq!(series.is_resolved, resolved, "{waves}: {}", series.tail);
            assert_eq!(series.tail > 1e-10, !resolved, "{waves}: {}", series.tail);
        }
    }

    /// A function with known coefficients, at a count of points that holds all of them.
    #[test]
    fn harmonics_are_those_of_the_function() {
        let of = |k: usize| [1.0 / (1.0 + k as f64), (k as f64).sin()];
        for n in [32, 64, 256] {
            let value = |i: usize| {
                let phase = TAU * i as f64 / n as f64;
                let terms = (1..n / 2).map(|k| {
                    let (sin, cos) = (k as f64 * phase).sin_cos();
                    of(k)[0] * cos + of(k)[1] * sin
                });
                0.3 + terms.sum::<f64>()
            };
            let values: Vec<f64> = (0..n).map(value).collect();
            for (k, found) in fourier_coefficients(&values).iter().enumerate() {
                let [c, s] = of(k + 1);
                // The phases of the test are rounded at some hundred radians.
                assert!(
                    (found[0] - c).abs() < 1e-13 && (found[1] - s).abs() < 1e-13,
                    "{n} {k}"
                );
            }
        }
    }
}
