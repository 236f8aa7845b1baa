//! LU factorisation with partial pivoting for few unknowns, in any number type.

use crate::factor_outcome::FactorOutcome;
#[cfg(not(target_family = "wasm"))]
use crate::lu_faer;
use crate::scalar::{Scalar, uniform};

/// Whether `f64` matrices of so many unknowns are factored by faer, which allocates scratch memory.
#[cfg(not(target_family = "wasm"))]
#[inline]
pub fn uses_faer(unknowns: usize) -> bool {
    unknowns >= lu_faer::FAER_MIN_UNKNOWNS
}

/// Whether `f64` matrices of so many unknowns are factored by faer: never in WebAssembly.
#[cfg(target_family = "wasm")]
#[inline]
pub fn uses_faer(_unknowns: usize) -> bool {
    false
}

/// Whether loops over few unknowns are unrolled; in WebAssembly, where size matters, only for `f64`.
const fn unrolls<T: Scalar>() -> bool {
    let is_plain = !T::HAS_DERIVATIVES && T::EPSILON == f64::EPSILON && T::LANES == 1;
    is_plain || !cfg!(target_family = "wasm")
}

/// The number of unknowns if loops are unrolled for it, otherwise a number without unrolled loops.
#[inline(always)]
pub(crate) fn unrolled<T: Scalar>(unknowns: usize) -> usize {
    if unrolls::<T>() { unknowns } else { usize::MAX }
}

/// Factors the row-major n×n matrix `a` in place, with the row exchanges in `pivots`.
pub fn factor<T: Scalar>(a: &mut [T], pivots: &mut [usize]) -> FactorOutcome {
    #[cfg(not(target_family = "wasm"))]
    if uses_faer(pivots.len())
        && let Some(plain) = T::as_f64_slice_mut(a)
    {
        return lu_faer::factor(plain, pivots);
    }
    eliminate(a, pivots)
}

/// [`factor`] by our own elimination, without faer.
pub(crate) fn eliminate<T: Scalar>(a: &mut [T], pivots: &mut [usize]) -> FactorOutcome {
    // Loops over few unknowns are unrolled.
    match unrolled::<T>(pivots.len()) {
        2 => eliminate_inline(a, pivots, 2),
        3 => eliminate_inline(a, pivots, 3),
        4 => eliminate_inline(a, pivots, 4),
        5 => eliminate_inline(a, pivots, 5),
        _ => eliminate_inline(a, pivots, pivots.len()),
    }
}

#[inline(always)]
fn eliminate_inline<T: Scalar>(a: &mut [T], pivots: &mut [usize], n: usize) -> FactorOutcome {
    let (a, pivots) = (&mut a[..n * n], &mut pivots[..n]);
    let mut sign = 1.0;
    let (mut min_pivot, mut max_pivot) = (f64::INFINITY, 0.0_f64);
    for k in 0..n {
        let mut best = k;
        for i in k + 1..n {
            let (new, old) = (a[i * n + k], a[best * n + k]);
            match uniform::<T>(|lane| new.lane(lane).abs() > old.lane(lane).abs()) {
                Some(true) => best = i,
                Some(false) => {}
                None => return FactorOutcome::SINGULAR,
            }
        }
        pivots[k] = best;
        if best != k {
            sign = -sign;
            for j in 0..n {
                a.swap(k * n + j, best * n + j);
            }
        }
        let pivot = a[k * n + k];
        let Some(positive) = uniform::<T>(|lane| pivot.lane(lane) > 0.0) else {
            return FactorOutcome::SINGULAR;
        };
        sign *= if positive {
            1.0
        } else if pivot.value() < 0.0 {
            -1.0
        } else {
            0.0
        };
        for size in (0..T::LANES).map(|lane| pivot.lane(lane)) {
            // `min` would discard a NaN; a NaN pivot must be reported as singular.
            min_pivot = if size.is_nan() {
                0.0
            } else {
                min_pivot.min(size.abs())
            };
            max_pivot = max_pivot.max(size.abs());
        }
        // Divisions are slow: one for each pivot.
        let inverse = T::from_f64(1.0) / pivot;
        for i in k + 1..n {
            let ratio = a[i * n + k] * inverse;
            a[i * n + k] = ratio;
            for j in k + 1..n {
                let change = ratio * a[k * n + j];
                a[i * n + j] -= change;
            }
        }
    }
    FactorOutcome::new(sign, min_pivot, max_pivot)
}

/// Solves A x = b in place.
pub fn solve<T: Scalar>(a: &[T], pivots: &[usize], b: &mut [T]) {
    match unrolled::<T>(pivots.len()) {
        2 => solve_inline(a, pivots, b, 2),
        3 => solve_inline(a, pivots, b, 3),
        4 => solve_inline(a, pivots, b, 4),
        5 => solve_inline(a, pivots, b, 5),
        _ => solve_inline(a, pivots, b, pivots.len()),
    }
}

#[inline(always)]
fn solve_inline<T: Scalar>(a: &[T], pivots: &[usize], b: &mut [T], n: usize) {
    let (a, pivots, b) = (&a[..n * n], &pivots[..n], &mut b[..n]);
    for (k, &row) in pivots.iter().enumerate() {
        b.swap(k, row);
    }
    for i in 1..n {
        for j in 0..i {
            let change = a[i * n + j] * b[j];
            b[i] -= change;
        }
    }
    solve_upper(a, n, b);
}

/// Solves U x = b in place, with U above and on the diagonal of `a`.
#[inline(always)]
pub(crate) fn solve_upper<T: Scalar>(a: &[T], n: usize, b: &mut [T]) {
    for i in (0..n).rev() {
        for j in i + 1..n {
            let change = a[i * n + j] * b[j];
            b[i] -= change;
        }
        // The reciprocal does not depend on the sum.
        b[i] = b[i] * (T::from_f64(1.0) / a[i * n + i]);
    }
}

/// Solves Uᵀ x = b in place, with U above and on the diagonal of `a`.
#[inline(always)]
pub(crate) fn solve_upper_transposed<T: Scalar>(a: &[T], n: usize, b: &mut [T]) {
    for i in 0..n {
        for j in 0..i {
            let change = a[j * n + i] * b[j];
            b[i] -= change;
        }
        // The reciprocal does not depend on the sum.
        b[i] = b[i] * (T::from_f64(1.0) / a[i * n + i]);
    }
}

/// Solves Aᵀ x = b in place.
pub fn solve_transposed<T: Scalar>(a: &[T], pivots: &[usize], b: &mut [T]) {
    match unrolled::<T>(pivots.len()) {
        2 => solve_transposed_inline(a, pivots, b, 2),
        3 => solve_transposed_inline(a, pivots, b, 3),
        4 => solve_transposed_inline(a, pivots, b, 4),
        5 => solve_transposed_inline(a, pivots, b, 5),
        _ => solve_transposed_inline(a, pivots, b, pivots.len()),
    }
}

#[inline(always)]
fn solve_transposed_inline<T: Scalar>(a: &[T], pivots: &[usize], b: &mut [T], n: usize) {
    let (a, pivots, b) = (&a[..n * n], &pivots[..n], &mut b[..n]);
    solve_upper_transposed(a, n, b);
    for i in (0..n).rev() {
        for j in i + 1..n {
            let change = a[j * n + i] * b[j];
            b[i] -= change;
        }
    }
    for (k, &row) in pivots.iter().enumerate().rev() {
        b.swap(k, row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: [f64; 9] = [0.0, 2.0, 1.0, 1.0, -1.0, 3.0, 4.0, 0.5, -2.0];

    #[test]
    fn solves_a_system_that_needs_pivoting_and_its_transpose() {
        let x = [1.0, -2.0, 0.5];
        let mut lu = A;
        let mut pivots = [0; 3];
        let factored = factor(&mut lu, &mut pivots);
        // det A = 0·(2 − 1.5) − 2·(−2 − 12) + 1·(0.5 + 4) = 32.5
        assert!(factored.determinant_sign > 0.0 && factored.pivot_ratio > 0.1);
        let (mut b, mut c) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            for j in 0..3 {
                b[i] += A[3 * i + j] * x[j];
                c[i] += A[3 * j + i] * x[j];
            }
        }
        solve(&lu, &pivots, &mut b);
        solve_transposed(&lu, &pivots, &mut c);
        for i in 0..3 {
            assert!((b[i] - x[i]).abs() < 1e-14 && (c[i] - x[i]).abs() < 1e-14);
        }
    }

    #[test]
    fn a_singular_or_invalid_matrix_is_seen() {
        let mut pivots = [0; 2];
        assert!(factor(&mut [1.0, 2.0, 2.0, 4.0], &mut pivots).pivot_ratio < 1e-15);
        assert!(factor(&mut [f64::NAN, 2.0, 2.0, 4.0], &mut pivots).pivot_ratio < 1e-15);
    }
}
