//! The determinant of A − λ 1, by elimination in complex numbers.

/// A complex number: its real and its imaginary part.
pub(super) type Complex = [f64; 2];

fn times([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a * c - b * d, a * d + b * c]
}

fn over(one: Complex, [c, d]: Complex) -> Complex {
    let square = c * c + d * d;
    times(one, [c / square, -d / square])
}

fn minus([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a - c, b - d]
}

/// The absolute value.
pub(super) fn size([a, b]: Complex) -> f64 {
    a.hypot(b)
}

/// The largest absolute value of some numbers, not below the smallest that is not zero.
pub(super) fn largest_size(values: &[Complex]) -> f64 {
    let sizes = values.iter().map(|value| size(*value));
    sizes.fold(f64::MIN_POSITIVE, f64::max)
}

/// det(A − λ 1), by elimination with the largest pivot of each column.
fn determinant(matrix: &[Vec<f64>], lambda: Complex) -> Complex {
    let n = matrix.len();
    let entry =
        |i: usize, j: usize| minus([matrix[i][j], 0.0], if i == j { lambda } else { [0.0; 2] });
    let mut a: Vec<Vec<Complex>> = (0..n)
        .map(|i| (0..n).map(|j| entry(i, j)).collect())
        .collect();
    let mut product = [1.0, 0.0];
    for k in 0..n {
        let pivot = (k..n)
            .max_by(|&i, &j| size(a[i][k]).total_cmp(&size(a[j][k])))
            .unwrap_or(k);
        if size(a[pivot][k]) == 0.0 {
            return [0.0; 2];
        }
        if pivot != k {
            a.swap(pivot, k);
            product = [-product[0], -product[1]];
        }
        product = times(product, a[k][k]);
        let row = a[k].clone();
        for below in &mut a[k + 1..] {
            let factor = over(below[k], row[k]);
            for (value, above) in below.iter_mut().zip(&row).skip(k) {
                *value = minus(*value, times(factor, *above));
            }
        }
    }
    product
}

/// How far λ is from a root of the characteristic polynomial, by one step of Newton's method, for eigenvalues up to `largest`.
pub(super) fn error_of_root(matrix: &[Vec<f64>], lambda: Complex, largest: f64) -> f64 {
    let aside = 1e-6 * largest;
    let at = determinant(matrix, lambda);
    let change = minus(
        determinant(matrix, [lambda[0] + aside, lambda[1] + aside]),
        at,
    );
    match size(at) {
        0.0 => 0.0,
        left => left / size(change) * size([aside, aside]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_and_what_are_none() {
        // s² + 0.4 s + 4 = 0.
        let matrix = vec![vec![0.0, 1.0], vec![-4.0, -0.4]];
        let root = [-0.2, (4.0_f64 - 0.04).sqrt()];
        assert!(error_of_root(&matrix, root, 2.0) < 1e-14);
        let moved = error_of_root(&matrix, [root[0], root[1] + 1e-3], 2.0);
        assert!((moved - 1e-3).abs() < 1e-5, "{moved}");
        // A double root at zero.
        let integrator = vec![vec![0.0, 1.0], vec![0.0, 0.0]];
        assert!(error_of_root(&integrator, [0.0; 2], 1.0) == 0.0);
    }
}
