//! Householder QR factors of a matrix with more rows than columns: least-squares solutions of A x = b, and the smallest
//! solutions of Aᵀ x = b.

use crate::factor_outcome::FactorOutcome;
use crate::lu;
use crate::scalar::Scalar;

/// Factors the row-major m × n matrix `a` (m > n) in place: R above, the reflections' vectors below
/// and the vectors' first components in `heads` (n entries).
pub fn factor<T: Scalar>(a: &mut [T], heads: &mut [T], m: usize) -> FactorOutcome {
    let n = heads.len();
    let (mut min_pivot, mut max_pivot) = (f64::INFINITY, 0.0_f64);
    for k in 0..n {
        let mut square = T::from_f64(0.0);
        for i in k..m {
            square += a[i * n + k] * a[i * n + k];
        }
        let size = square.value().sqrt();
        min_pivot = if size.is_nan() {
            0.0
        } else {
            min_pivot.min(size)
        };
        max_pivot = max_pivot.max(size);
        if size == 0.0 || size.is_nan() {
            heads[k] = T::from_f64(0.0);
            continue;
        }
        let length = square.sqrt();
        let first = a[k * n + k];
        // Away from cancellation.
        let alpha = if first.value() > 0.0 { -length } else { length };
        let head = first - alpha;
        // v = (head, a below); v·v = 2 length (length + |first|).
        let norm = T::from_f64(2.0) * (square - first * alpha);
        for j in k + 1..n {
            let mut dot = head * a[k * n + j];
            for i in k + 1..m {
                dot += a[i * n + k] * a[i * n + j];
            }
            let factor = (dot + dot) / norm;
            let change = factor * head;
            a[k * n + j] -= change;
            for i in k + 1..m {
                let change = factor * a[i * n + k];
                a[i * n + j] -= change;
            }
        }
        a[k * n + k] = alpha;
        heads[k] = head;
    }
    // The matrix is not square: it has no determinant. Without a column none depends on others.
    let (min_pivot, max_pivot) = if n == 0 {
        (1.0, 1.0)
    } else {
        (min_pivot, max_pivot)
    };
    FactorOutcome::new(1.0, min_pivot, max_pivot)
}

/// Applies the k-th reflection to `b`.
fn apply_reflector<T: Scalar>(a: &[T], heads: &[T], m: usize, k: usize, b: &mut [T]) {
    let n = heads.len();
    let head = heads[k];
    let (mut dot, mut norm) = (head * b[k], head * head);
    for i in k + 1..m {
        dot += a[i * n + k] * b[i];
        norm += a[i * n + k] * a[i * n + k];
    }
    if norm.value() == 0.0 {
        return;
    }
    let factor = (dot + dot) / norm;
    b[k] -= factor * head;
    for i in k + 1..m {
        b[i] -= factor * a[i * n + k];
    }
}

/// The least-squares solution of A x = b, in the first entries of `b` (m entries).
pub fn solve<T: Scalar>(a: &[T], heads: &[T], m: usize, b: &mut [T]) {
    let n = heads.len();
    for k in 0..n {
        apply_reflector(a, heads, m, k, b);
    }
    lu::solve_upper(a, n, b);
}

/// The smallest solution of Aᵀ x = b: `b` holds n entries of b, and then m of x.
pub fn solve_transposed<T: Scalar>(a: &[T], heads: &[T], m: usize, b: &mut [T]) {
    let n = heads.len();
    lu::solve_upper_transposed(a, n, b);
    b[n..m].fill(T::from_f64(0.0));
    for k in (0..n).rev() {
        apply_reflector(a, heads, m, k, b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: [f64; 8] = [1.0, 2.0, -0.5, 1.0, 3.0, 0.25, 0.0, -1.5];

    #[test]
    fn solves_consistent_equations_and_balances_with_the_smallest_forces() {
        let (mut a, mut heads) = (A, [0.0; 2]);
        assert!(factor(&mut a, &mut heads, 4).pivot_ratio > 0.1);
        let x = [0.7, -1.2];
        let mut b: Vec<f64> = (0..4)
            .map(|i| A[2 * i] * x[0] + A[2 * i + 1] * x[1])
            .collect();
        solve(&a, &heads, 4, &mut b);
        assert!((b[0] - x[0]).abs() < 1e-15 && (b[1] - x[1]).abs() < 1e-15);

        // λ = A (AᵀA)⁻¹ f is the smallest one with Aᵀ λ = f: it lies in the columns of A.
        let f = [1.0, 2.0];
        let mut b = [f[0], f[1], 9.0, 9.0];
        solve_transposed(&a, &heads, 4, &mut b);
        for (j, want) in f.iter().enumerate() {
            let got: f64 = (0..4).map(|i| A[2 * i + j] * b[i]).sum();
            assert!((got - want).abs() < 1e-14);
        }
        let mut c = b;
        solve(&a, &heads, 4, &mut c);
        for i in 0..4 {
            let in_columns = A[2 * i] * c[0] + A[2 * i + 1] * c[1];
            assert!((in_columns - b[i]).abs() < 1e-14);
        }
    }
}
