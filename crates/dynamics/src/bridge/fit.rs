//! Functions fitted on nodes on both sides of a gap.

use dwell_geometry::Scalar;
use std::f64::consts::PI;

/// The orientations of all frames and the travels of all slides as functions of one coordinate.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fit {
    basis: Basis,
    /// By function: its coefficients.
    rows: Vec<Vec<f64>>,
}

/// Polynomials orthogonal on some nodes, by their recurrence
/// pₖ₊₁ = (x/s − αₖ) pₖ − βₖ pₖ₋₁ (Forsythe 1957).
#[derive(Debug, Clone, PartialEq)]
struct Basis {
    scale: f64,
    alpha: Vec<f64>,
    beta: Vec<f64>,
}

impl Basis {
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
            let next = (0..x.len()).map(|i| {
                let earlier = if k == 0 { 0.0 } else { all[k - 1][i] };
                (x[i] - alpha[k]) * last[i] - beta[k] * earlier
            });
            let next = next.collect();
            all.push(next);
        }
        (Self { scale, alpha, beta }, all)
    }

    /// The polynomials with their first two derivatives.
    fn at<T: Scalar>(&self, x: T, out: &mut Vec<[T; 3]>) {
        let (zero, one) = (T::lift(0.0), T::lift(1.0));
        let by = T::lift(1.0 / self.scale);
        let x = x * by;
        out.clear();
        out.push([one, zero, zero]);
        for (k, (&alpha, &beta)) in self.alpha.iter().zip(&self.beta).enumerate() {
            let last = out[k];
            let early = if k == 0 { [zero; 3] } else { out[k - 1] };
            let (x, beta) = (x - T::lift(alpha), T::lift(beta));
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

impl Fit {
    /// Fits each function, no higher than its values on the nodes are known.
    pub(super) fn new(nodes: &[f64], samples: &[Vec<f64>], scale: f64, degree: usize) -> Self {
        let (basis, all) = Basis::new(nodes, scale, degree);
        let functions = samples.first().map_or(0, Vec::len);
        let row = |f: usize| {
            let mut rest: Vec<f64> = samples.iter().map(|sample| sample[f]).collect();
            let mut row = Vec::with_capacity(all.len());
            let mut left = Vec::with_capacity(all.len());
            for p in &all {
                let square: f64 = p.iter().map(|p| p * p).sum();
                let along: f64 = p.iter().zip(&rest).map(|(p, r)| p * r).sum();
                let c = along / square;
                for (rest, p) in rest.iter_mut().zip(p) {
                    *rest -= c * p;
                }
                row.push(c);
                left.push(rest.iter().map(|r| r * r).sum::<f64>());
            }
            // What brings the rest down no further is rounding.
            let least = left.iter().copied().fold(f64::INFINITY, f64::min);
            let enough = left.iter().position(|&l| l <= 4.0 * least);
            row.truncate(enough.map_or(row.len(), |e| e + 1));
            row
        };
        Self {
            rows: (0..functions).map(row).collect(),
            basis,
        }
    }

    /// Room for what [`Fit::at`] finds.
    pub(super) fn room(&self) -> Vec<[f64; 3]> {
        vec![[0.0; 3]; self.rows.len()]
    }

    /// Values and first two derivatives of all functions.
    pub(super) fn at<T: Scalar>(&self, x: T, powers: &mut Vec<[T; 3]>, out: &mut [[T; 3]]) {
        self.basis.at(x, powers);
        for (out, row) in out.iter_mut().zip(&self.rows) {
            *out = [T::lift(0.0); 3];
            for (p, &c) in powers.iter().zip(row) {
                for (out, &p) in out.iter_mut().zip(p) {
                    *out += p * T::lift(c);
                }
            }
        }
    }
}

/// Nodes between two distances, dense at both, on one side of the change point.
pub(super) fn nodes(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| {
        let part = 0.5 - 0.5 * ((i as f64 + 0.5) * PI / count as f64).cos();
        from + (to - from) * part
    })
}
