//! Householder QR factorisation of a matrix with more rows than columns: least-squares solutions of A x = b, and minimum-norm
//! solutions of Aᵀ x = b.

use crate::factor_outcome::FactorOutcome;
use crate::lu;
use crate::scalar::Scalar;

/// Factors the row-major m × n matrix `a` (m > n) in place: R above, the reflections' vectors below, whose first components are
/// one, and their factors in `factors` (n entries): each reflection is 1 − factor v vᵀ.
pub fn factor<T: Scalar>(a: &mut [T], factors: &mut [T], m: usize) -> FactorOutcome {
    // Loops over few unknowns are unrolled.
    match (m, lu::unrolled::<T>(factors.len())) {
        (4, 3) => factor_inline(a, factors, 4, 3),
        (5, 4) => factor_inline(a, factors, 5, 4),
        (6, 5) => factor_inline(a, factors, 6, 5),
        (m, _) => factor_inline(a, factors, m, factors.len()),
    }
}

/// The volume of the parallelepiped of the columns of a row-major m×n matrix over the product of their lengths: 1 if they are perpendicular,
/// 0 if they are dependent. The columns are left perpendicular.
pub fn relative_volume(a: &mut [f64], m: usize, n: usize) -> f64 {
    let dot = |a: &[f64], j: usize, k: usize| (0..m).map(|i| a[i * n + j] * a[i * n + k]).sum();
    let mut volume = 1.0;
    for k in 0..n {
        let whole: f64 = dot(a, k, k);
        for j in 0..k {
            let (part, square): (f64, f64) = (dot(a, j, k), dot(a, j, j));
            if square > 0.0 {
                for i in 0..m {
                    a[i * n + k] -= part / square * a[i * n + j];
                }
            }
        }
        let rest: f64 = dot(a, k, k);
        volume *= if whole > 0.0 {
            (rest / whole).sqrt()
        } else {
            0.0
        };
    }
    volume
}

#[inline(always)]
fn factor_inline<T: Scalar>(a: &mut [T], factors: &mut [T], m: usize, n: usize) -> FactorOutcome {
    let (a, factors) = (&mut a[..m * n], &mut factors[..n]);
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
            factors[k] = T::from_f64(0.0);
            continue;
        }
        let length = square.sqrt();
        let first = a[k * n + k];
        // The sign that avoids cancellation.
        let alpha = if first.value() > 0.0 { -length } else { length };
        let head = first - alpha;
        let (one, inverse) = (T::from_f64(1.0), T::from_f64(1.0) / head);
        // v = (1, a below / head) and v·v = −2 alpha / head.
        let factor = -head * (one / alpha);
        for i in k + 1..m {
            a[i * n + k] = a[i * n + k] * inverse;
        }
        for j in k + 1..n {
            let mut dot = a[k * n + j];
            for i in k + 1..m {
                dot += a[i * n + k] * a[i * n + j];
            }
            let change = factor * dot;
            a[k * n + j] -= change;
            for i in k + 1..m {
                let part = change * a[i * n + k];
                a[i * n + j] -= part;
            }
        }
        a[k * n + k] = alpha;
        factors[k] = factor;
    }
    // The matrix is not square and has no determinant. Without columns it is not singular.
    let (min_pivot, max_pivot) = if n == 0 {
        (1.0, 1.0)
    } else {
        (min_pivot, max_pivot)
    };
    FactorOutcome::new(1.0, min_pivot, max_pivot)
}

/// Applies the k-th reflection to `b`.
#[inline(always)]
fn apply_reflector<T: Scalar>(a: &[T], [m, n]: [usize; 2], k: usize, factor: T, b: &mut [T]) {
    let mut dot = b[k];
    for i in k + 1..m {
        dot += a[i * n + k] * b[i];
    }
    let change = factor * dot;
    b[k] -= change;
    for i in k + 1..m {
        let part = change * a[i * n + k];
        b[i] -= part;
    }
}

/// The least-squares solution of A x = b, in the first entries of `b` (m entries).
pub fn solve<T: Scalar>(a: &[T], factors: &[T], m: usize, b: &mut [T]) {
    match (m, lu::unrolled::<T>(factors.len())) {
        (4, 3) => solve_inline(a, factors, [4, 3], b),
        (5, 4) => solve_inline(a, factors, [5, 4], b),
        (6, 5) => solve_inline(a, factors, [6, 5], b),
        (m, _) => solve_inline(a, factors, [m, factors.len()], b),
    }
}

#[inline(always)]
fn solve_inline<T: Scalar>(a: &[T], factors: &[T], [m, n]: [usize; 2], b: &mut [T]) {
    let (a, factors, b) = (&a[..m * n], &factors[..n], &mut b[..m]);
    for (k, factor) in factors.iter().enumerate() {
        apply_reflector(a, [m, n], k, *factor, b);
    }
    lu::solve_upper(a, n, b);
}

/// The minimum-norm solution of Aᵀ x = b: `b` holds n entries of b on input and m entries of x on return.
pub fn solve_transposed<T: Scalar>(a: &[T], factors: &[T], m: usize, b: &mut [T]) {
    match (m, lu::unrolled::<T>(factors.len())) {
        (4, 3) => solve_transposed_inline(a, factors, [4, 3], b),
        (5, 4) => solve_transposed_inline(a, factors, [5, 4], b),
        (6, 5) => solve_transposed_inline(a, factors, [6, 5], b),
        (m, _) => solve_transposed_inline(a, factors, [m, factors.len()], b),
    }
}

#[inline(always)]
fn solve_transposed_inline<T: Scalar>(a: &[T], factors: &[T], [m, n]: [usize; 2], b: &mut [T]) {
    let (a, factors, b) = (&a[..m * n], &factors[..n], &mut b[..m]);
    lu::solve_upper_transposed(a, n, b);
    b[n..m].fill(T::from_f64(0.0));
    for (k, factor) in factors.iter().enumerate().rev() {
        apply_reflector(a, [m, n], k, *factor, b);
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

        // λ = A (AᵀA)⁻¹ f is the minimum-norm solution of Aᵀ λ = f: it lies in the column space of A.
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
