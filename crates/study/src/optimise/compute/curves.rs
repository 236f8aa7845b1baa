//! Extrema of sampled curves: the places where a curve is higher than on both sides.

/// Places of a curve, from 0 to 1, with its values there.
pub(super) struct Samples<'a> {
    pub(super) values: &'a [f64],
    /// Whether the last value is followed by the first.
    pub(super) is_turn: bool,
}

/// Local extrema that are examined at most.
const MOST: usize = 10;

impl Samples<'_> {
    /// The distance of two places.
    pub(super) fn spacing(&self) -> f64 {
        let count = self.values.len();
        1.0 / if self.is_turn { count } else { count - 1 } as f64
    }

    /// The places of the local maxima of `sign` times the curve, by parabolas, the highest first. Those at an end are marked.
    pub(super) fn maxima(&self, sign: f64) -> Vec<(f64, bool)> {
        let count = self.values.len();
        let value = |k: usize| sign * self.values[k % count];
        let (inner, spacing) = (usize::from(!self.is_turn), self.spacing());
        let mut found: Vec<(f64, f64, bool)> = Vec::new();
        for k in inner..count - inner {
            let [a, b, c] = [value(k + count - 1), value(k), value(k + 1)];
            if b >= a && b > c {
                let bend = a - 2.0 * b + c;
                let off = 0.5 * (a - c) / bend;
                found.push(((k as f64 + off) * spacing, b - 0.25 * (a - c) * off, false));
            }
        }
        if !self.is_turn {
            if value(0) > value(1) {
                found.push((0.0, value(0), true));
            }
            if value(count - 1) > value(count - 2) {
                found.push((1.0, value(count - 1), true));
            }
        }
        // A constant curve is as high everywhere.
        if found.is_empty() {
            found.push((0.0, value(0), true));
        }
        found.sort_by(|a, b| b.1.total_cmp(&a.1));
        found.truncate(MOST);
        found
            .into_iter()
            .map(|(u, _, is_end)| (u, is_end))
            .collect()
    }

    /// The part of the largest magnitude that the last Fourier coefficients of a turn have.
    pub(super) fn roughness(&self, alternating: &[[f64; 3]]) -> f64 {
        let size = self.values.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
        let coefficient = |part: usize| -> f64 {
            let terms = self.values.iter().zip(alternating);
            terms.map(|(v, of)| v * of[part]).sum()
        };
        let largest = (0..3)
            .map(|part| coefficient(part).abs())
            .fold(0.0, f64::max);
        2.0 * largest / (self.values.len() as f64 * size.max(f64::MIN_POSITIVE))
    }
}

/// (−1)ᵏ at the places of a turn, and its products with the cosine and the sine of the place.
pub(super) fn alternating(count: usize) -> Vec<[f64; 3]> {
    let term = |k: usize| {
        let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / count as f64).sin_cos();
        [sign, sign * cos, sign * sin]
    };
    (0..count).map(term).collect()
}

/// Follows an angle over its jumps by whole revolutions.
pub(super) fn unwrap(values: &mut [f64]) {
    use std::f64::consts::TAU;
    for k in 1..values.len() {
        let revolutions = ((values[k] - values[k - 1]) / TAU).round();
        values[k] -= TAU * revolutions;
    }
}
