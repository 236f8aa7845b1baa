//! The elimination of the plain solutions, independent of the code and of the checks.

/// The solution of a x = b, of n rows one after another, with row pivoting.
pub(crate) fn gauss(mut a: Vec<f64>, b: &[f64], n: usize) -> Vec<f64> {
    let mut b = b.to_vec();
    for k in 0..n {
        let pivot = (k..n)
            .max_by(|&i, &j| a[i * n + k].abs().total_cmp(&a[j * n + k].abs()))
            .unwrap();
        for c in 0..n {
            a.swap(k * n + c, pivot * n + c);
        }
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i * n + k] / a[k * n + k];
            if factor != 0.0 {
                for c in k..n {
                    a[i * n + c] -= factor * a[k * n + c];
                }
                b[i] -= factor * b[k];
            }
        }
    }
    for k in (0..n).rev() {
        for c in k + 1..n {
            b[k] -= a[k * n + c] * b[c];
        }
        b[k] /= a[k * n + k];
    }
    b
}
