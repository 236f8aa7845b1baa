//! Nonlinear least squares between bounds (K. Levenberg, 1944; D. Marquardt, 1963), with the damping of H. B. Nielsen (1999): variables at
//! a bound stay there while the sum falls beyond it.

use super::{backward, cholesky, dot, forward};

/// Residuals at a point.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Residuals {
    /// Their values.
    pub values: Vec<f64>,
    /// By residual: its derivatives.
    pub slopes: Vec<Vec<f64>>,
}

/// Where a search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastSquares {
    /// The point.
    pub x: Vec<f64>,
    /// The sum of the squares.
    pub sum: f64,
    /// Number of evaluations.
    pub evaluations: usize,
}

/// A relative gain that is none, and the first damping.
const NO_GAIN: f64 = 1e-14;
const DAMPING: f64 = 1e-3;
const MOST_DAMPING: f64 = 1e12;

/// Searches the least sum of squares between bounds, from a point, in at most so many evaluations; `None` if there are no residuals there.
// Long because the iteration is one loop.
pub fn least_squares(
    problem: &mut dyn FnMut(&[f64]) -> Option<Residuals>,
    start: &[f64],
    bounds: &[[f64; 2]],
    evaluations: usize,
) -> Option<LeastSquares> {
    let n = start.len();
    let mut x: Vec<f64> = (start.iter().zip(bounds))
        .map(|(x, [from, to])| x.clamp(*from, *to))
        .collect();
    let mut at = problem(&x)?;
    let mut sum = dot(&at.values, &at.values);
    let (mut damping, mut growth, mut count) = (DAMPING, 2.0, 1);
    while count < evaluations && sum > 0.0 {
        let slope = |k: usize| -> f64 {
            let each = at.slopes.iter().zip(&at.values);
            each.map(|(row, r)| row[k] * r).sum()
        };
        let slopes: Vec<f64> = (0..n).map(slope).collect();
        let is_held = |k: usize| {
            x[k] <= bounds[k][0] && slopes[k] > 0.0 || x[k] >= bounds[k][1] && slopes[k] < 0.0
        };
        let held: Vec<bool> = (0..n).map(is_held).collect();
        let entry = |i: usize, j: usize| -> f64 { at.slopes.iter().map(|r| r[i] * r[j]).sum() };
        let mut normal: Vec<Vec<f64>> = (0..n)
            .map(|i| (0..n).map(|j| entry(i, j)).collect())
            .collect();
        let sizes = (0..n).filter(|k| !held[*k]).map(|k| normal[k][k]);
        let size = sizes.fold(0.0, f64::max);
        if size == 0.0 {
            break;
        }
        for (k, row) in normal.iter_mut().enumerate() {
            row[k] += damping * row[k].max(1e-6 * size);
        }
        let next = bounded_minimum(&normal, &slopes, &x, bounds, held);
        count += 1;
        let change: Vec<f64> = next.iter().zip(&x).map(|(a, b)| a - b).collect();
        let predicted: f64 = at
            .slopes
            .iter()
            .zip(&at.values)
            .map(|(row, r)| (r + dot(row, &change)).powi(2))
            .sum();
        let there = problem(&next).filter(|there| dot(&there.values, &there.values) < sum);
        let Some(there) = there else {
            damping *= growth;
            growth *= 2.0;
            if damping > MOST_DAMPING || sum - predicted <= NO_GAIN * sum {
                break;
            }
            continue;
        };
        let after = dot(&there.values, &there.values);
        let gain = (sum - after) / (sum - predicted).max(f64::MIN_POSITIVE);
        damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
        damping = damping.max(1e-14);
        growth = 2.0;
        let is_done = sum - after <= NO_GAIN * sum;
        (x, at, sum) = (next, there, after);
        if is_done {
            break;
        }
    }
    Some(LeastSquares {
        x,
        sum,
        evaluations: count,
    })
}

/// The least of ½ dᵀ A d + gᵀ d from a point, of which some components are held; those that would leave their bounds end there, and the others follow.
fn bounded_minimum(
    a: &[Vec<f64>],
    g: &[f64],
    x: &[f64],
    bounds: &[[f64; 2]],
    mut is_fixed: Vec<bool>,
) -> Vec<f64> {
    let mut next = x.to_vec();
    loop {
        let free: Vec<usize> = (0..x.len()).filter(|k| !is_fixed[*k]).collect();
        let change: Vec<f64> = next.iter().zip(x).map(|(a, b)| a - b).collect();
        let matrix: Vec<Vec<f64>> = (free.iter())
            .map(|&i| free.iter().map(|&j| a[i][j]).collect())
            .collect();
        let fixed = |i: usize| -> f64 {
            let all = 0..x.len();
            all.filter(|k| is_fixed[*k])
                .map(|k| a[i][k] * change[k])
                .sum()
        };
        let mut step: Vec<f64> = free.iter().map(|&i| -g[i] - fixed(i)).collect();
        let Some(factor) = cholesky(&matrix) else {
            return x.to_vec();
        };
        forward(&factor, &mut step);
        backward(&factor, &mut step);
        let mut is_inside = true;
        for (&k, step) in free.iter().zip(&step) {
            let to = x[k] + step;
            next[k] = to.clamp(bounds[k][0], bounds[k][1]);
            if next[k] != to {
                (is_fixed[k], is_inside) = (true, false);
            }
        }
        if is_inside {
            return next;
        }
        for k in free {
            if !is_fixed[k] {
                next[k] = x[k];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 10 (y − x²), 1 − x.
    fn rosenbrock(at: &[f64]) -> Option<Residuals> {
        let [x, y] = [at[0], at[1]];
        Some(Residuals {
            values: vec![10.0 * (y - x * x), 1.0 - x],
            slopes: vec![vec![-20.0 * x, 10.0], vec![-1.0, 0.0]],
        })
    }

    #[test]
    fn the_valley_of_rosenbrock_ends_at_one_and_at_a_bound_before() {
        let free = least_squares(&mut rosenbrock, &[-1.2, 1.0], &[[-5.0, 5.0]; 2], 100);
        let free = free.expect("residuals");
        // Seen: 0, after 20 evaluations.
        assert!(
            (free.x[0] - 1.0).abs() < 1e-12 && free.evaluations < 60,
            "{free:?}"
        );
        let bounded = least_squares(
            &mut rosenbrock,
            &[-1.2, 0.4],
            &[[-5.0, 0.5], [-5.0, 5.0]],
            100,
        );
        let bounded = bounded.expect("residuals");
        // At x = 1/2 the best y is 1/4.
        assert!((bounded.sum - 0.25).abs() < 1e-12 && (bounded.x[1] - 0.25).abs() < 1e-8);
    }

    #[test]
    fn steps_to_where_a_problem_has_no_value_are_shortened() {
        // √x has no value below zero.
        let mut root = |at: &[f64]| {
            (at[0] > 0.0).then(|| Residuals {
                values: vec![at[0].sqrt() - 0.1],
                slopes: vec![vec![0.5 / at[0].sqrt()]],
            })
        };
        let found = least_squares(&mut root, &[4.0], &[[-10.0, 10.0]], 100).expect("residuals");
        assert!((found.x[0] - 0.01).abs() < 1e-10, "{found:?}");
    }
}
