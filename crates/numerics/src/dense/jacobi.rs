//! Singular values by one-sided Jacobi rotations: pairs of columns are rotated until all are orthogonal. Their lengths are the singular values.
//!
//! Source: M. R. Hestenes, *Inversion of matrices by biorthogonalization and related results*, J. SIAM 6 (1958); G. H. Golub,
//! C. F. Van Loan, *Matrix Computations*, 8.6.3.

use super::{Matrix, Svd};

/// Maximum number of sweeps over all pairs; about ten are needed.
const MAX_SWEEPS: usize = 60;
/// Columns count as orthogonal if the cosine of their angle is at most this times the square root of the number of rows (rounding).
const ORTHOGONAL: f64 = 8.0 * f64::EPSILON;

/// Bounds below which numbers are rounding errors.
struct Limits {
    /// The cosine of the angle between two columns.
    cosine: f64,
    /// The square of the length of a column.
    square: f64,
}

pub(super) fn svd(matrix: &Matrix) -> Option<Svd> {
    if matrix.rows < matrix.columns {
        let turned = Matrix::from_fn(matrix.columns, matrix.rows, |i, j| matrix[(j, i)]);
        let Svd { u, values, v } = svd(&turned)?;
        return Some(Svd { u: v, values, v: u });
    }
    let n = matrix.columns;
    let column = |j: usize| (0..matrix.rows).map(move |i| matrix[(i, j)]).collect();
    let mut columns: Vec<Vec<f64>> = (0..n).map(column).collect();
    let unit = |j: usize| (0..n).map(|i| f64::from(u8::from(i == j))).collect();
    let mut turns: Vec<Vec<f64>> = (0..n).map(unit).collect();
    let squares: f64 = matrix.entries.iter().map(|x| x * x).sum();
    let limits = Limits {
        cosine: ORTHOGONAL * (matrix.rows as f64).sqrt(),
        square: f64::EPSILON * f64::EPSILON * squares,
    };
    let mut is_done = false;
    for _ in 0..MAX_SWEEPS {
        is_done = true;
        for q in 1..n {
            for p in 0..q {
                is_done &= !make_orthogonal(&mut columns, &mut turns, p, q, &limits);
            }
        }
        if is_done {
            break;
        }
    }
    let lengths: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| lengths[b].total_cmp(&lengths[a]));
    let values: Vec<f64> = order.iter().map(|&k| lengths[k]).collect();
    let largest = values.first().copied().unwrap_or(0.0);
    // A column of rounding errors has no direction.
    let zero = matrix.rows as f64 * f64::EPSILON * largest;
    let mut left = Vec::new();
    for &k in order.iter().take_while(|&&k| lengths[k] > zero) {
        left.push(columns[k].iter().map(|x| x / lengths[k]).collect());
    }
    complete(&mut left, matrix.rows);
    is_done.then(|| Svd {
        u: Matrix::from_fn(matrix.rows, matrix.rows, |i, j| left[j][i]),
        values,
        v: Matrix::from_fn(n, n, |i, j| turns[order[j]][i]),
    })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Rotates the columns p < q in their plane until they are orthogonal. Returns whether they were not orthogonal before.
fn make_orthogonal(
    columns: &mut [Vec<f64>],
    turns: &mut [Vec<f64>],
    p: usize,
    q: usize,
    limits: &Limits,
) -> bool {
    let [pp, qq, pq] = [(p, p), (q, q), (p, q)].map(|(i, j)| dot(&columns[i], &columns[j]));
    if pq.abs() <= limits.cosine * (pp * qq).sqrt() || pp.min(qq) <= limits.square {
        return false;
    }
    let cotangent = (qq - pp) / (2.0 * pq);
    let tangent = 1.0_f64.copysign(cotangent) / (cotangent.abs() + cotangent.hypot(1.0));
    let cos = 1.0 / tangent.hypot(1.0);
    let sin = cos * tangent;
    for all in [columns, turns] {
        let (before, after) = all.split_at_mut(q);
        for (x, y) in before[p].iter_mut().zip(&mut after[0]) {
            (*x, *y) = (cos * *x - sin * *y, sin * *x + cos * *y);
        }
    }
    true
}

/// Adds unit vectors orthogonal to the given ones until they span the space of `dimensions` dimensions.
fn complete(vectors: &mut Vec<Vec<f64>>, dimensions: usize) {
    while vectors.len() < dimensions {
        let mut longest = (0.0, Vec::new());
        for k in 0..dimensions {
            let mut rest = vec![0.0; dimensions];
            rest[k] = 1.0;
            // Twice, to remove the rounding error of the first projection.
            for _ in 0..2 {
                for other in vectors.iter() {
                    let part = dot(&rest, other);
                    rest.iter_mut().zip(other).for_each(|(x, y)| *x -= part * y);
                }
            }
            let length = dot(&rest, &rest).sqrt();
            if length > longest.0 {
                longest = (length, rest);
            }
        }
        let (length, mut rest) = longest;
        rest.iter_mut().for_each(|x| *x /= length);
        vectors.push(rest);
    }
}
