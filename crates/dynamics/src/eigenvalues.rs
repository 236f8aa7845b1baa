//! The eigenvalues of a small matrix, and their errors.
//!
//! The matrix is balanced first: its rows and columns are scaled by powers of two, which changes no eigenvalue and no
//! digit, until each column is as large as its row. The effect of rounding and of the errors of its entries on the
//! eigenvalues is measured by changing every entry by its error. This also holds for multiple eigenvalues, for which
//! first derivatives do not exist.

use crate::error::{DynamicsError, Result};
use dwell_numerics::dense::Matrix;

/// Numbers of changed matrices whose eigenvalues are compared.
const CHANGES: usize = 12;
/// The largest effect of these random changes of sign is seldom below a third of the largest possible effect.
const SAFETY_FACTOR: f64 = 3.0;
/// Backward error of the computed eigenvalues, relative to the norm of the balanced matrix.
const BACKWARD_ERROR: f64 = 4.0 * f64::EPSILON;
/// Rounds of balancing; a few are enough.
const MAX_ROUNDS: usize = 64;

/// The eigenvalues of a row-major n×n matrix, the largest real part first.
pub(crate) fn eigenvalues(matrix: &[f64], n: usize) -> Result<Vec<[f64; 2]>> {
    if !matrix.iter().all(|a| a.is_finite()) {
        return Err(DynamicsError::NoEigenvalues);
    }
    let mut balanced = matrix.to_vec();
    balance(&mut balanced, n);
    of_balanced(&balanced, n)
}

fn of_balanced(matrix: &[f64], n: usize) -> Result<Vec<[f64; 2]>> {
    let matrix = Matrix::from_fn(n, n, |i, j| matrix[i * n + j]);
    let found = matrix.eigenvalues();
    let mut values = found.ok_or(DynamicsError::NoEigenvalues)?;
    values.sort_by(|x, y| y[0].total_cmp(&x[0]).then(y[1].total_cmp(&x[1])));
    Ok(values)
}

/// The eigenvalues, each with its estimated error, for given errors of the entries.
pub(crate) fn eigenvalues_with_errors(
    matrix: &[f64],
    entry_errors: &[f64],
    n: usize,
) -> Result<(Vec<[f64; 2]>, Vec<f64>)> {
    if !matrix.iter().chain(entry_errors).all(|a| a.is_finite()) {
        return Err(DynamicsError::NoEigenvalues);
    }
    let mut balanced = matrix.to_vec();
    let scales = balance(&mut balanced, n);
    let values = of_balanced(&balanced, n)?;
    let norm = balanced.iter().map(|a| a * a).sum::<f64>().sqrt();
    let mut errors = vec![0.0_f64; n];
    let mut random = 0_u64;
    for _ in 0..CHANGES {
        let mut changed = balanced.clone();
        for i in 0..n {
            for j in 0..n {
                let entry = entry_errors[i * n + j] * scales[j] / scales[i];
                changed[i * n + j] += random_sign(&mut random) * (entry + BACKWARD_ERROR * norm);
            }
        }
        let others = of_balanced(&changed, n)?;
        for (error, [re, im]) in errors.iter_mut().zip(&values) {
            let distances = others.iter().map(|z| (z[0] - re).hypot(z[1] - im));
            *error = error.max(distances.fold(f64::INFINITY, f64::min));
        }
    }
    // A conjugate pair has one error.
    let of_pair = |k: usize| {
        let [re, im] = values[k];
        let conjugate = values.iter().position(|z| *z == [re, -im]).unwrap_or(k);
        SAFETY_FACTOR * errors[k].max(errors[conjugate])
    };
    let errors = (0..n).map(of_pair).collect();
    Ok((values, errors))
}

/// 1 or −1, from the bits of a linear congruential generator (Knuth, MMIX).
fn random_sign(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    if *state >> 63 == 0 { 1.0 } else { -1.0 }
}

/// Balances a matrix (Parlett & Reinsch 1969): D⁻¹ A D, whose diagonal D is returned.
fn balance(matrix: &mut [f64], n: usize) -> Vec<f64> {
    let mut scales = vec![1.0; n];
    for _ in 0..MAX_ROUNDS {
        let mut is_balanced = true;
        for i in 0..n {
            let sum = |of: &dyn Fn(usize) -> usize| {
                let others = (0..n).filter(|&j| j != i);
                others.map(|j| matrix[of(j)].abs()).sum::<f64>()
            };
            let (row, column) = (sum(&|j| i * n + j), sum(&|j| j * n + i));
            let ratio = row / column;
            if !(ratio.is_normal() && ratio > 0.0) {
                continue;
            }
            let factor = (0.5 * ratio.log2()).round().exp2();
            if factor == 1.0 || row / factor + column * factor >= 0.95 * (row + column) {
                continue;
            }
            is_balanced = false;
            scales[i] *= factor;
            for j in 0..n {
                matrix[i * n + j] /= factor;
                matrix[j * n + i] *= factor;
            }
        }
        if is_balanced {
            break;
        }
    }
    scales
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spring-mass pair of 1e6 rad/s and of 1e-3 rad/s in one matrix: each keeps its digits.
    #[test]
    fn balanced_matrices_keep_the_digits_of_small_eigenvalues() {
        let (fast, slow) = (1e12, 1e-6);
        let mut matrix = vec![0.0; 16];
        (matrix[2], matrix[7], matrix[8], matrix[13]) = (1.0, 1.0, -fast, -slow);
        let found = eigenvalues(&matrix, 4).unwrap();
        let mut sizes: Vec<f64> = found.iter().map(|[re, im]| re.hypot(*im)).collect();
        sizes.sort_by(f64::total_cmp);
        for (size, expected) in sizes.iter().zip([1e-3, 1e-3, 1e6, 1e6]) {
            assert!((size / expected - 1.0).abs() < 1e-14, "{size} {expected}");
        }
    }

    /// The error of a simple eigenvalue is that of the entries; of a double one its square root, as of a coordinate
    /// that nothing drives back.
    #[test]
    fn errors_cover_what_the_entries_leave_open() {
        let entry = 1e-10_f64;
        let stiffness = |k: f64| vec![0.0, 1.0, -k, 0.0];
        let only = vec![0.0, 0.0, entry, 0.0];
        for (k, expected) in [(4.0, 0.25 * entry), (0.0, entry.sqrt())] {
            let (values, errors) = eigenvalues_with_errors(&stiffness(k), &only, 2).unwrap();
            for (z, error) in values.iter().zip(&errors) {
                assert!((z[0].hypot(z[1]) - k.sqrt()).abs() < 1e-12, "{values:?}");
                assert!((0.9..10.0).contains(&(error / expected)), "{k}: {errors:?}");
            }
        }
    }
}
