//! Singular values and eigenvalues of dense `f64` matrices, by faer. In WebAssembly, where faer would be a twentieth of the live page's
//! module and matrices are small, by Jacobi rotations and the QR algorithm, which the tests compare with faer.

#[cfg(not(target_family = "wasm"))]
mod by_faer;
#[cfg(any(target_family = "wasm", test))]
mod hessenberg;
#[cfg(any(target_family = "wasm", test))]
mod jacobi;

#[cfg(not(target_family = "wasm"))]
use by_faer as method;
use std::ops::{Index, IndexMut};

#[cfg(target_family = "wasm")]
mod method {
    pub(super) use super::hessenberg::eigenvalues;
    pub(super) use super::jacobi::svd;
}

/// A matrix, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    rows: usize,
    columns: usize,
    entries: Vec<f64>,
}

/// The singular value decomposition U Σ Vᵀ of a matrix, with square U and V.
#[derive(Debug, Clone, PartialEq)]
pub struct Svd {
    /// The left singular vectors, by column.
    pub u: Matrix,
    /// The singular values, in descending order.
    pub values: Vec<f64>,
    /// The right singular vectors, by column.
    pub v: Matrix,
}

impl Svd {
    /// The number of singular values above `tolerance` times the largest.
    pub fn rank(&self, tolerance: f64) -> usize {
        let largest = self.values.first().copied().unwrap_or(0.0);
        let counts = |value: &&f64| **value > tolerance * largest;
        self.values.iter().filter(counts).count()
    }
}

impl Matrix {
    /// A matrix of zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            entries: vec![0.0; rows * columns],
        }
    }

    /// The matrix with the entries `entry(row, column)`.
    pub fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let mut matrix = Self::zeros(rows, columns);
        for i in 0..rows {
            for j in 0..columns {
                matrix[(i, j)] = entry(i, j);
            }
        }
        matrix
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The matrix of its first `rows` rows.
    #[must_use]
    pub fn first_rows(&self, rows: usize) -> Self {
        Self {
            rows,
            columns: self.columns,
            entries: self.entries[..rows * self.columns].to_vec(),
        }
    }

    /// Its singular values and vectors; `None` if an entry is NaN or infinite.
    ///
    /// ```
    /// use dwell_numerics::dense::Matrix;
    ///
    /// let of_rank_1 = Matrix::from_fn(3, 2, |i, j| ((i + 1) * (j + 1)) as f64);
    /// let svd = of_rank_1.svd().ok_or("no numbers")?;
    /// assert!((svd.values[0] - 70f64.sqrt()).abs() < 1e-14 && svd.values[1] < 1e-14);
    /// // The second column of V spans the null space.
    /// assert!((svd.v[(0, 1)] + 2.0 * svd.v[(1, 1)]).abs() < 1e-14);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn svd(&self) -> Option<Svd> {
        let is_finite = self.entries.iter().all(|entry| entry.is_finite());
        is_finite.then(|| method::svd(self)).flatten()
    }

    /// The eigenvalues [real, imaginary] of a square matrix, in any order; `None` if an entry is not finite or the iteration does not
    /// converge.
    pub fn eigenvalues(&self) -> Option<Vec<[f64; 2]>> {
        let is_finite = self.entries.iter().all(|entry| entry.is_finite());
        is_finite.then(|| method::eigenvalues(self)).flatten()
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    #[inline]
    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        &self.entries[i * self.columns + j]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    #[inline]
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut f64 {
        &mut self.entries[i * self.columns + j]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix of numbers between −½ and ½.
    fn random(rows: usize, columns: usize, seed: f64) -> Matrix {
        let mut state = 0.37 + 0.01 * seed;
        let mut matrix = Matrix::zeros(rows, columns);
        for entry in &mut matrix.entries {
            state = (state * 997.0 + 0.123_f64).fract();
            *entry = state - 0.5;
        }
        matrix
    }

    /// The largest deviation from orthonormal columns.
    fn skew(of: &Matrix) -> f64 {
        let mut largest = 0.0_f64;
        for p in 0..of.columns {
            for q in 0..of.columns {
                let dot: f64 = (0..of.rows).map(|i| of[(i, p)] * of[(i, q)]).sum();
                largest = largest.max((dot - f64::from(u8::from(p == q))).abs());
            }
        }
        largest
    }

    #[test]
    fn both_methods_have_the_same_singular_values_and_give_the_matrix_back() {
        for (k, (rows, columns)) in [(1, 1), (7, 4), (4, 7), (12, 12), (30, 21), (3, 9)]
            .into_iter()
            .enumerate()
        {
            let mut matrix = random(rows, columns, k as f64);
            if rows > 3 {
                // Rows that depend on others, up to a relative 1e-9 and exactly.
                for j in 0..columns {
                    matrix[(2, j)] = matrix[(0, j)] - matrix[(1, j)] + 1e-9 * matrix[(2, j)];
                    matrix[(3, j)] = 2.0 * matrix[(0, j)];
                }
            }
            let (own, other) = (
                jacobi::svd(&matrix).unwrap(),
                by_faer::svd(&matrix).unwrap(),
            );
            for (a, b) in own.values.iter().zip(&other.values) {
                // Measured: 7e-15.
                assert!((a - b).abs() < 1e-13, "{rows} × {columns}: {a} {b}");
            }
            for svd in [own, other] {
                assert_eq!((svd.u.rows, svd.u.columns), (rows, rows));
                assert_eq!((svd.v.rows, svd.v.columns), (columns, columns));
                // Measured: 8e-15, and 3e-15 below.
                assert!(skew(&svd.u) < 1e-13 && skew(&svd.v) < 1e-13);
                for i in 0..rows {
                    for j in 0..columns {
                        let parts = svd.values.iter().enumerate();
                        let sum: f64 = parts.map(|(k, s)| svd.u[(i, k)] * s * svd.v[(j, k)]).sum();
                        assert!((sum - matrix[(i, j)]).abs() < 1e-13, "{rows} × {columns}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_matrix_of_zeros_has_every_vector_in_its_null_spaces() {
        let svd = jacobi::svd(&Matrix::zeros(3, 2)).unwrap();
        assert_eq!(svd.values, [0.0, 0.0]);
        assert!(skew(&svd.u) < 1e-15 && skew(&svd.v) < 1e-15);
    }

    #[test]
    fn both_methods_have_the_same_eigenvalues() {
        let sorted = |mut values: Vec<[f64; 2]>| {
            values.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
            values
        };
        for n in 1..14 {
            let matrix = random(n, n, 0.3);
            let own = sorted(hessenberg::eigenvalues(&matrix).unwrap());
            let other = sorted(by_faer::eigenvalues(&matrix).unwrap());
            assert_eq!(own.len(), n);
            for (a, b) in own.iter().zip(&other) {
                // Measured: 3e-15.
                assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-13, "{n}: {a:?} {b:?}");
            }
        }
    }

    #[test]
    fn known_eigenvalues_are_found() {
        // The companion matrix of (z − 1)(z − 2)(z² + 4).
        let rows = [
            [3.0, -6.0, 12.0, -8.0],
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ];
        let found = hessenberg::eigenvalues(&Matrix::from_fn(4, 4, |i, j| rows[i][j])).unwrap();
        for expected in [[1.0, 0.0], [2.0, 0.0], [0.0, 2.0], [0.0, -2.0]] {
            let distance = |z: &[f64; 2]| (z[0] - expected[0]).hypot(z[1] - expected[1]);
            let nearest = found.iter().map(distance).fold(f64::INFINITY, f64::min);
            // Measured: 1.1e-15.
            assert!(nearest < 1e-13, "{expected:?}: {found:?}");
        }
    }

    #[test]
    fn what_is_no_number_has_none() {
        let matrix = Matrix::from_fn(2, 2, |i, _| if i == 0 { f64::NAN } else { 1.0 });
        assert!(matrix.svd().is_none() && matrix.eigenvalues().is_none());
    }
}
