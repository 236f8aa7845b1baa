//! Decompositions by faer, for matrices of any size.

use super::{Matrix, Svd};
use faer::{Mat, MatRef};

fn faer_of(matrix: &Matrix) -> Mat<f64> {
    Mat::from_fn(matrix.rows, matrix.columns, |i, j| matrix[(i, j)])
}

fn matrix_of(of: MatRef<'_, f64>) -> Matrix {
    Matrix::from_fn(of.nrows(), of.ncols(), |i, j| of[(i, j)])
}

pub(super) fn svd(matrix: &Matrix) -> Option<Svd> {
    let found = faer_of(matrix).svd().ok()?;
    let values = found.S().column_vector();
    Some(Svd {
        u: matrix_of(found.U()),
        values: values.iter().copied().collect(),
        v: matrix_of(found.V()),
    })
}

pub(super) fn eigenvalues(matrix: &Matrix) -> Option<Vec<[f64; 2]>> {
    let found = faer_of(matrix).eigenvalues().ok()?;
    Some(found.iter().map(|z| [z.re, z.im]).collect())
}
