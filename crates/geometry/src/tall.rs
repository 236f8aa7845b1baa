//! Householder's factors of a matrix with more rows than columns: equations of which some repeat what
//! others say. Least squares solve them, and of all forces that balance a load the smallest is taken.

use crate::scalar::Scalar;
use crate::small::Factored;

/// Factors the row-major m × n matrix `a` (m > n) in place: R above, the reflections' vectors below
/// and on the diagonal's side in `beside` (n entries, the vectors' first components).
pub(crate) fn factor<T: Scalar>(a: &mut [T], beside: &mut [T], m: usize) -> Factored {
    let n = beside.len();
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for k in 0..n {
        let mut square = T::lift(0.0);
        for i in k..m {
            square += a[i * n + k] * a[i * n + k];
        }
        let size = square.value().sqrt();
        least = if size.is_nan() { 0.0 } else { least.min(size) };
        most = most.max(size);
        if size == 0.0 || size.is_nan() {
            beside[k] = T::lift(0.0);
            continue;
        }
        let length = square.sqrt();
        let first = a[k * n + k];
        // Away from cancellation.
        let alpha = if first.value() > 0.0 { -length } else { length };
        let head = first - alpha;
        // v = (head, a below); v·v = 2 length (length + |first|).
        let norm = T::lift(2.0) * (square - first * alpha);
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
        beside[k] = head;
    }
    Factored {
        // No determinant: the factors carry no branch.
        sign: 1.0,
        measure: if most > 0.0 { least / most } else { 0.0 },
    }
}

/// Reflects `b` by the k-th reflection.
fn reflect<T: Scalar>(a: &[T], beside: &[T], m: usize, k: usize, b: &mut [T]) {
    let n = beside.len();
    let head = beside[k];
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
pub(crate) fn solve<T: Scalar>(a: &[T], beside: &[T], m: usize, b: &mut [T]) {
    let n = beside.len();
    for k in 0..n {
        reflect(a, beside, m, k, b);
    }
    for i in (0..n).rev() {
        for j in i + 1..n {
            let change = a[i * n + j] * b[j];
            b[i] -= change;
        }
        b[i] = b[i] / a[i * n + i];
    }
}

/// The smallest solution of Aᵀ x = b: `b` holds n entries of b, and then m of x.
pub(crate) fn solve_transposed<T: Scalar>(a: &[T], beside: &[T], m: usize, b: &mut [T]) {
    let n = beside.len();
    for i in 0..n {
        for j in 0..i {
            let change = a[j * n + i] * b[j];
            b[i] -= change;
        }
        b[i] = b[i] / a[i * n + i];
    }
    b[n..m].fill(T::lift(0.0));
    for k in (0..n).rev() {
        reflect(a, beside, m, k, b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: [f64; 8] = [1.0, 2.0, -0.5, 1.0, 3.0, 0.25, 0.0, -1.5];

    #[test]
    fn solves_consistent_equations_and_balances_with_the_smallest_forces() {
        let (mut a, mut beside) = (A, [0.0; 2]);
        assert!(factor(&mut a, &mut beside, 4).measure > 0.1);
        let x = [0.7, -1.2];
        let mut b: Vec<f64> = (0..4)
            .map(|i| A[2 * i] * x[0] + A[2 * i + 1] * x[1])
            .collect();
        solve(&a, &beside, 4, &mut b);
        assert!((b[0] - x[0]).abs() < 1e-15 && (b[1] - x[1]).abs() < 1e-15);

        // λ = A (AᵀA)⁻¹ f is the smallest one with Aᵀ λ = f: it lies in the columns of A.
        let f = [1.0, 2.0];
        let mut b = [f[0], f[1], 9.0, 9.0];
        solve_transposed(&a, &beside, 4, &mut b);
        for (j, want) in f.iter().enumerate() {
            let got: f64 = (0..4).map(|i| A[2 * i + j] * b[i]).sum();
            assert!((got - want).abs() < 1e-14);
        }
        let mut c = b;
        solve(&a, &beside, 4, &mut c);
        for i in 0..4 {
            let in_columns = A[2 * i] * c[0] + A[2 * i + 1] * c[1];
            assert!((in_columns - b[i]).abs() < 1e-14);
        }
    }
}
