//! The number of cells of a table, from the decay of the coefficients of its functions.
//!
//! Over a full turn the coefficients are Fourier's, over a limited extent Chebyshev's: with q = middle + half cos θ
//! these are Fourier's again, of an even function of θ. If they have fallen to the accuracy at the K-th, the nearest
//! singularity is
//!
//! ```text
//! full turn    σ = ln(1/accuracy) / K · period/2π   beside the real axis            (1)
//! limited      ρ = accuracy^(−1/K),  σ = half ((ρ + 1/ρ)/2 − 1)   beyond an end     (2)
//! ```
//!
//! (an ellipse about the extent with half axes (ρ ± 1/ρ)/2; Trefethen 2013, chapter 8), and a piece of p
//! terms on a cell of half width h errs as (h/2σ)^p.

use super::piecewise::{Grid, TERMS};
use super::{Result, TableError};
use dwell_numerics::fourier::fourier_coefficients;
use std::f64::consts::TAU;

/// Samples of the first try and of the last, powers of two.
const MIN_SAMPLES: usize = 64;
const MAX_SAMPLES: usize = 16_384;
/// Fewest cells.
pub(super) const MIN_CELLS: usize = 4;
/// Least scale of a coefficient, relative to the largest of its kind: in a smaller coefficient terms cancel, and its
/// rounding error is that of its kind.
const MIN_RELATIVE_SCALE: f64 = 1e-3;

/// The values of a function at many coordinates, one row for each.
pub(super) type RowSampler<'a> = dyn FnMut(&[f64]) -> Result<Vec<Vec<f64>>> + 'a;

/// The scales of the values of a table, and the number of cells that their coefficients require.
pub(super) struct Sizing {
    /// By value: the largest met, or a thousandth of the largest of its kind.
    pub(super) scales: Vec<f64>,
    pub(super) cells: usize,
}

/// Sizes a table of `width` values. `scale` makes the scales from the largest of each.
pub(super) fn estimate_sizing(
    grid: Grid,
    width: usize,
    accuracy: f64,
    scale: &dyn Fn(&[f64]) -> Vec<f64>,
    values: &mut RowSampler<'_>,
) -> Result<Sizing> {
    let mut samples: Vec<Vec<f64>> = Vec::new();
    loop {
        samples = refine_samples(grid, samples, values)?;
        let points = samples.len();
        let largest = |k: usize| samples.iter().fold(0.0_f64, |s, at| s.max(at[k].abs()));
        let scales = scale(&(0..width).map(largest).collect::<Vec<f64>>());
        let magnitudes = harmonic_magnitudes(&samples, &scales);
        let last = magnitudes.iter().rposition(|&m| m > accuracy);
        let harmonics = last.map_or(1, |k| k + 1);
        // The last quarter of what was sampled must be below: else it is folded into the rest.
        if 8 * harmonics <= 3 * points {
            return Ok(Sizing {
                scales,
                cells: cell_count(grid, harmonics, accuracy),
            });
        }
        if points >= MAX_SAMPLES {
            let last_quarter = &magnitudes[3 * magnitudes.len() / 4..];
            let residual = last_quarter.iter().fold(0.0, |s: f64, x| s.max(*x));
            return Err(TableError::NotSmooth { points, residual });
        }
    }
}

/// Scales from the largest of each value: at least [`MIN_RELATIVE_SCALE`] of the largest of its kind, and of the weighted largest values of
/// related quantities.
pub(super) fn scales(largest: &[f64], relation: &dyn Fn(usize, usize) -> f64) -> Vec<f64> {
    let of_kind = |i: usize| {
        let all = largest.iter().enumerate();
        all.fold(0.0_f64, |s, (j, largest)| s.max(relation(i, j) * largest))
    };
    (0..largest.len())
        .map(|i| largest[i].max(MIN_RELATIVE_SCALE * of_kind(i)))
        .collect()
}

/// Values at equally spaced phases, twice as many as are known.
fn refine_samples(
    grid: Grid,
    known: Vec<Vec<f64>>,
    values: &mut RowSampler<'_>,
) -> Result<Vec<Vec<f64>>> {
    let fresh = known.is_empty();
    let count = if fresh { MIN_SAMPLES } else { 2 * known.len() };
    // Of an even function the second half is the first.
    let mirrored = |i: usize| grid.revolutions == 0 && 2 * i > count;
    let coordinate = |i: usize| {
        let part = i as f64 / count as f64;
        match grid.revolutions {
            0 => grid.from + 0.5 * grid.length * (1.0 + (TAU * part).cos()),
            _ => grid.from + grid.length * part,
        }
    };
    let is_new = |i: &usize| (fresh || i % 2 == 1) && !mirrored(*i);
    let coordinates: Vec<f64> = (0..count).filter(is_new).map(coordinate).collect();
    let (mut new, mut known) = (values(&coordinates)?.into_iter(), known.into_iter());
    let mut finer: Vec<Vec<f64>> = Vec::with_capacity(count);
    for i in 0..count {
        // Those that are known hold their mirrored ones.
        let old = (!fresh && i % 2 == 0).then(|| known.next()).flatten();
        let row = match old {
            Some(row) => Some(row),
            None if mirrored(i) => finer.get(count - i).cloned(),
            None => new.next(),
        };
        finer.extend(row);
    }
    Ok(finer)
}

/// By harmonic, the largest coefficient of all values, each as a part of its scale.
fn harmonic_magnitudes(samples: &[Vec<f64>], scales: &[f64]) -> Vec<f64> {
    let n = samples.len();
    let mut magnitudes = vec![0.0_f64; n / 2];
    for (k, &scale) in scales.iter().enumerate().filter(|(_, s)| **s > 0.0) {
        let values: Vec<f64> = samples.iter().map(|at| at[k]).collect();
        let coefficients = fourier_coefficients(&values);
        for (magnitude, [c, s]) in magnitudes.iter_mut().skip(1).zip(&coefficients) {
            *magnitude = magnitude.max(c.hypot(*s) / scale);
        }
    }
    magnitudes
}

/// The number of cells that a series with this number of harmonics requires, by (1) and (2).
fn cell_count(grid: Grid, harmonics: usize, accuracy: f64) -> usize {
    let decay = -accuracy.ln() / harmonics as f64;
    let singularity_distance = match grid.revolutions {
        0 => 0.5 * grid.length * (decay.cosh() - 1.0),
        _ => decay * grid.length / TAU,
    };
    let half = 2.0 * singularity_distance * accuracy.powf(1.0 / TERMS as f64);
    let cells = (0.5 * grid.length / half).ceil();
    // A cast of what is too large stays at the largest, which is refused as too many.
    (cells as usize).max(MIN_CELLS)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1/(1 − 2r cos θ + r²) has the coefficients 2 rᵏ/(1 − r²): they fall below 1e-12 of its largest
    /// value 1/(1 − r)² at the k with 2 rᵏ (1 − r)/(1 + r) = 1e-12.
    #[test]
    fn a_known_series_is_measured() {
        let r: f64 = 0.8;
        let grid = Grid::new(0.0, TAU, 1, 1);
        let at = |q: &f64| vec![1.0 / (1.0 - 2.0 * r * q.cos() + r * r)];
        let mut values = |q: &[f64]| Ok(q.iter().map(at).collect());
        let scale = |largest: &[f64]| largest.to_vec();
        let found = estimate_sizing(grid, 1, 1e-12, &scale, &mut values).expect("a fit");
        let k = (1e-12 * (1.0 + r) / (2.0 * (1.0 - r))).ln() / r.ln();
        assert_eq!(found.cells, cell_count(grid, k.floor() as usize + 1, 1e-12));
        assert!((found.scales[0] - 25.0).abs() < 1e-12);
    }

    /// A jump has coefficients that never become small.
    #[test]
    fn a_jump_is_refused() {
        let grid = Grid::new(-1.0, 2.0, 0, 1);
        let mut values = |q: &[f64]| Ok(q.iter().map(|q| vec![q.signum()]).collect());
        let scale = |largest: &[f64]| largest.to_vec();
        let found = estimate_sizing(grid, 1, 1e-8, &scale, &mut values);
        assert!(matches!(
            found,
            Err(TableError::NotSmooth {
                points: MAX_SAMPLES,
                ..
            })
        ));
    }
}
