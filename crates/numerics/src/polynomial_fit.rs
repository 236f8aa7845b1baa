//! Least-squares fits of several functions by polynomials that are orthogonal on the nodes, for functions that cannot be
//! evaluated within a gap between the nodes.

use crate::scalar::Scalar;
use std::f64::consts::PI;

/// Several functions of one variable, each with its own degree.
#[derive(Debug, Clone, PartialEq)]
pub struct PolynomialFit {
    basis: OrthogonalBasis,
    /// By function: its coefficients.
    coefficients: Vec<Vec<f64>>,
}

/// Polynomials orthogonal on some nodes, by their recurrence
/// pₖ₊₁ = (x/s − αₖ) pₖ − βₖ pₖ₋₁ (Forsythe 1957).
#[derive(Debug, Clone, PartialEq)]
struct OrthogonalBasis {
    scale: f64,
    alpha: Vec<f64>,
    beta: Vec<f64>,
}

impl OrthogonalBasis {
    /// The basis on some nodes, with the values of each polynomial there.
    fn new(nodes: &[f64], scale: f64, degree: usize) -> (Self, Vec<Vec<f64>>) {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let x: Vec<f64> = nodes.iter().map(|x| x / scale).collect();
        let mut all = vec![vec![1.0; x.len()]];
        let (mut alpha, mut beta) = (Vec::new(), Vec::new());
        let mut before = 0.0;
        for k in 0..degree.min(x.len().saturating_sub(1)) {
            let last = &all[k];
            let moved: Vec<f64> = last.iter().zip(&x).map(|(p, x)| p * x).collect();
            let square = dot(last, last);
            alpha.push(dot(&moved, last) / square);
            beta.push(if k == 0 { 0.0 } else { square / before });
            before = square;
            let next = (0..x.len())
                .map(|i| {
                    let earlier = if k == 0 { 0.0 } else { all[k - 1][i] };
                    (x[i] - alpha[k]) * last[i] - beta[k] * earlier
                })
                .collect();
            all.push(next);
        }
        (Self { scale, alpha, beta }, all)
    }

    /// The polynomials with their first two derivatives.
    fn eval<T: Scalar>(&self, x: T, out: &mut Vec<[T; 3]>) {
        let (zero, one) = (T::from_f64(0.0), T::from_f64(1.0));
        let by = T::from_f64(1.0 / self.scale);
        let x = x * by;
        out.clear();
        out.push([one, zero, zero]);
        for (k, (&alpha, &beta)) in self.alpha.iter().zip(&self.beta).enumerate() {
            let last = out[k];
            let early = if k == 0 { [zero; 3] } else { out[k - 1] };
            let (x, beta) = (x - T::from_f64(alpha), T::from_f64(beta));
            out.push([
                x * last[0] - beta * early[0],
                x * last[1] + last[0] - beta * early[1],
                x * last[2] + last[1] + last[1] - beta * early[2],
            ]);
        }
        for p in out {
            p[1] = p[1] * by;
            p[2] = p[2] * by * by;
        }
    }
}

impl PolynomialFit {
    /// Fits each function by its values at the nodes (`samples[node][function]`) with polynomials of at most the given degree, or less if
    /// higher terms only fit rounding errors. `scale` is about the largest |node|.
    pub fn new(nodes: &[f64], samples: &[Vec<f64>], scale: f64, degree: usize) -> Self {
        let (basis, all) = OrthogonalBasis::new(nodes, scale, degree);
        let functions = samples.first().map_or(0, Vec::len);
        let fit_function = |f: usize| {
            let mut remainders: Vec<f64> = samples.iter().map(|sample| sample[f]).collect();
            let mut fit_function = Vec::with_capacity(all.len());
            let mut residuals = Vec::with_capacity(all.len());
            for p in &all {
                let square: f64 = p.iter().map(|p| p * p).sum();
                let projection: f64 = p.iter().zip(&remainders).map(|(p, r)| p * r).sum();
                let c = projection / square;
                for (remainders, p) in remainders.iter_mut().zip(p) {
                    *remainders -= c * p;
                }
                fit_function.push(c);
                residuals.push(remainders.iter().map(|r| r * r).sum::<f64>());
            }
            // Terms that do not reduce the residual further fit rounding errors.
            let min_residual = residuals.iter().copied().fold(f64::INFINITY, f64::min);
            let enough = residuals.iter().position(|&l| l <= 4.0 * min_residual);
            fit_function.truncate(enough.map_or(fit_function.len(), |e| e + 1));
            fit_function
        };
        Self {
            coefficients: (0..functions).map(fit_function).collect(),
            basis,
        }
    }

    /// Memory for the results of [`PolynomialFit::eval`].
    pub fn workspace(&self) -> Vec<[f64; 3]> {
        vec![[0.0; 3]; self.coefficients.len()]
    }

    /// Values and first two derivatives of all functions.
    pub fn eval<T: Scalar>(&self, x: T, basis_values: &mut Vec<[T; 3]>, out: &mut [[T; 3]]) {
        self.basis.eval(x, basis_values);
        for (out, row) in out.iter_mut().zip(&self.coefficients) {
            *out = [T::from_f64(0.0); 3];
            for (p, &c) in basis_values.iter().zip(row) {
                for (out, &p) in out.iter_mut().zip(p) {
                    *out += p * T::from_f64(c);
                }
            }
        }
    }
}

/// Chebyshev nodes between two numbers, in increasing order: dense at both ends.
pub fn chebyshev_nodes(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| {
        let part = 0.5 - 0.5 * ((i as f64 + 0.5) * PI / count as f64).cos();
        from + (to - from) * part
    })
}
