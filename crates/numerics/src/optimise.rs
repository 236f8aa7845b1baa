//! Optimisation with derivatives: convex quadratic programs, sequential quadratic programming with the multipliers of all constraints, and
//! nonlinear least squares between bounds. Problems may have no value at some points: steps that lead there are shortened.

mod least_squares;
mod quadratic;
mod sequential;

pub use least_squares::{LeastSquares, Residuals, least_squares};
pub use quadratic::{QuadraticProgram, QuadraticSolution};
pub use sequential::{Constraint, Evaluation, Optimum, SequentialSettings, minimise};

/// Σ aᵢ bᵢ.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The largest magnitude.
fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |max, v| v.abs().max(max))
}

/// The lower triangular factor L of a symmetric positive definite matrix L Lᵀ; `None` if it is not definite.
fn cholesky(a: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let mut l: Vec<Vec<f64>> = Vec::with_capacity(a.len());
    for (i, row) in a.iter().enumerate() {
        let mut next = vec![0.0; i + 1];
        for j in 0..i {
            next[j] = (row[j] - dot(&next[..j], &l[j][..j])) / l[j][j];
        }
        let square = row[i] - dot(&next[..i], &next[..i]);
        if square.is_nan() || square <= 0.0 {
            return None;
        }
        next[i] = square.sqrt();
        l.push(next);
    }
    Some(l)
}

/// Solves L x = b in place.
fn forward(l: &[Vec<f64>], b: &mut [f64]) {
    for (i, row) in l.iter().enumerate() {
        b[i] = (b[i] - dot(&row[..i], &b[..i])) / row[i];
    }
}

/// Solves Lᵀ x = b in place.
fn backward(l: &[Vec<f64>], b: &mut [f64]) {
    for i in (0..l.len()).rev() {
        b[i] /= l[i][i];
        let solved = b[i];
        for (entry, factor) in b[..i].iter_mut().zip(&l[i]) {
            *entry -= factor * solved;
        }
    }
}
