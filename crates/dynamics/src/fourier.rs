//! Smooth periodic functions by their values at equally spaced points. The trapezoid rule on them gains
//! digits as fast as their Fourier coefficients fall, so the points are doubled until these have fallen
//! to rounding.

use crate::error::DynamicsError;
use std::f64::consts::TAU;

/// Points of the first rule, and of the last that is tried.
pub(crate) const FEWEST: usize = 32;
pub(crate) const MOST: usize = 8192;
/// Points from which on a function that is still not resolved is taken for sharp.
pub(crate) const MANY: usize = 2048;
/// Coefficients below this part of the largest are rounding.
const NEGLIGIBLE: f64 = 1e-16;
/// Coefficients below this part, of which the last quarter is not below this part of the quarter before,
/// are rounding too, of values that carry more of it. (Those of a smooth function fall by 100 there.)
const SMALL: f64 = 1e-8;
const FLAT: f64 = 0.25;

/// A function of a phase from 0 to 2π: c₀ + Σ c_k cos ks + s_k sin ks.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Series {
    pub(crate) mean: f64,
    /// (c_k, s_k) for k = 1, 2, …
    pub(crate) harmonics: Vec<[f64; 2]>,
    /// The largest of the last coefficients as a part of `size`.
    pub(crate) left: f64,
    /// Whether the last coefficients are rounding.
    pub(crate) resolved: bool,
}

impl Series {
    /// The series through values at equally spaced phases; coefficients are small or large beside
    /// `size`.
    pub(crate) fn new(values: &[f64], size: f64) -> Self {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let mut harmonics = harmonics(values);
        let largest = |of: &[[f64; 2]]| of.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
        let count = harmonics.len();
        let left = largest(&harmonics[count - 4..]);
        let left = if left == 0.0 { 0.0 } else { left / size };
        let sum = |of: &[[f64; 2]]| of.iter().flatten().map(|c| c.abs()).sum::<f64>();
        let [half, rest] = [count / 2, count - count / 4];
        let flat = sum(&harmonics[rest..]) > FLAT * sum(&harmonics[half..rest]);
        let noise = count >= FEWEST && left < SMALL && flat;
        let kept = |[c, s]: &[f64; 2]| c.abs().max(s.abs()) > NEGLIGIBLE.max(left) * size;
        let last = harmonics.iter().rposition(kept);
        harmonics.truncate(last.map_or(0, |l| l + 1));
        Self {
            mean,
            harmonics,
            left,
            // Sixteen roundings of a point remain in a coefficient.
            resolved: left < 16.0 * NEGLIGIBLE || noise,
        }
    }

    /// Its value and its integral from zero at a phase.
    pub(crate) fn at(&self, phase: f64) -> [f64; 2] {
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

/// What there is at `points` equally spaced parts of the period, keeping what is known at half of them.
pub(crate) fn refine<V>(
    known: Vec<V>,
    mut at: impl FnMut(f64) -> Result<V, DynamicsError>,
) -> Result<Vec<V>, DynamicsError> {
    if known.is_empty() {
        return (0..FEWEST).map(|k| at(k as f64 / FEWEST as f64)).collect();
    }
    let points = known.len();
    let mut finer = Vec::with_capacity(2 * points);
    for (k, value) in known.into_iter().enumerate() {
        finer.push(value);
        finer.push(at((k as f64 + 0.5) / points as f64)?);
    }
    Ok(finer)
}

/// Fourier coefficients (c_k, s_k), k = 1 … below half the number of points, which is a power of two (Cooley and
/// Tukey 1965).
fn harmonics(values: &[f64]) -> Vec<[f64; 2]> {
    let n = values.len();
    let bits = n.trailing_zeros();
    let turned = |i: usize| i.reverse_bits() >> (usize::BITS - bits);
    let mut sums: Vec<[f64; 2]> = (0..n).map(|i| [values[turned(i)], 0.0]).collect();
    let table: Vec<(f64, f64)> = (0..n / 2)
        .map(|i| (TAU * i as f64 / n as f64).sin_cos())
        .collect();
    let mut half = 1;
    while half < n {
        for block in sums.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for (k, (a, b)) in low.iter_mut().zip(high).enumerate() {
                let (sin, cos) = table[k * (n / (2 * half))];
                let along = [b[0] * cos - b[1] * sin, b[0] * sin + b[1] * cos];
                *b = [a[0] - along[0], a[1] - along[1]];
                *a = [a[0] + along[0], a[1] + along[1]];
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
            for (k, found) in harmonics(&values).iter().enumerate() {
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
