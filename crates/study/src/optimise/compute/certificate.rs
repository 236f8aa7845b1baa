//! Whether a design is optimal, and how that is known: the conditions of Karush, Kuhn and Tucker, the curvature of the Lagrangian along the
//! active constraints, and the results of the sweep there and nearby.

use super::engine::Worker;
use super::problem::Problem;
use super::search::{CONVERGED, Ended};
use crate::explain::StudyError;
use crate::sweep::compute::{Design, RequestedQuantities, SweptScene};
use dwell_dynamics::interruption;
use dwell_numerics::dense::Matrix;
use dwell_numerics::optimise::Constraint;

/// What is known of a design.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Certificate {
    /// Why it is not certified; `None` if it is.
    pub doubt: Option<String>,
    /// The largest component of the derivative of the Lagrangian in parts of the ranges, over 1 + that of the goal, the goal in parts of its
    /// first value.
    pub residual: f64,
    /// The largest violation of a condition, in parts of its limit.
    pub violation: f64,
    /// The largest product of a multiplier and the room of its condition.
    pub complementarity: f64,
    /// The smallest and the largest eigenvalue of the Lagrangian's second derivatives along the active constraints; none at a corner.
    pub curvature: Option<[f64; 2]>,
    /// The directions along which the goal does not change to second order: changes of the numbers, in their units, for the largest
    /// admissible one of 1 % of its range.
    pub flat: Vec<Vec<f64>>,
    /// The largest difference of a result from that of the sweep, in parts of it; `None` if the sweep has none, or was not asked.
    pub sweep_difference: Option<f64>,
    /// Random designs nearby that the sweep computed, that satisfy the conditions, and that are better.
    pub probes: [usize; 3],
}

/// A constraint within this part of its limit is active.
const ACTIVE: f64 = 1e-6;
/// A step in parts of the ranges for second derivatives.
const STEP: f64 = 1e-4;
/// Eigenvalues below this part of the largest are zero.
const FLAT: f64 = 1e-9;
/// Results of the sweep that differ by more are others.
const SAME: f64 = 1e-6;
/// Random designs nearby, and how near, in parts of the ranges.
const PROBES: u64 = 200;
const NEARBY: f64 = 0.01;
/// A probe is better if its goal is lower by this part.
const BETTER: f64 = 1e-7;

/// The certificate of where a search ended.
pub(super) fn certify(
    problem: &Problem<'_>,
    worker: &mut Worker<'_, '_>,
    of: &Ended,
) -> Certificate {
    let optimum = &of.optimum;
    let mut found = Certificate {
        residual: optimum.residual,
        violation: optimum.evaluation.violation(),
        complementarity: optimum.complementarity,
        ..Certificate::default()
    };
    if interruption::is_requested() {
        found.doubt = Some("the search was interrupted".to_owned());
        return found;
    }
    if !of.is_feasible() {
        let violation = found.violation;
        found.doubt = Some(format!(
            "a condition is violated by {violation:.1e} of its limit"
        ));
    } else if !of.is_converged() {
        let text = format!(
            "the residual is {:.1e}, above {CONVERGED:.0e}",
            optimum.residual
        );
        found.doubt = Some(text);
    }
    if let Some((values, vectors)) = curvatures(problem, worker, of) {
        let largest = values.iter().fold(0.0_f64, |max, v| v.abs().max(max));
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        if !values.is_empty() {
            found.curvature = Some([least, largest]);
        }
        // A goal that is zero is at its least whatever the curvature.
        let noise = FLAT * largest.max(1e-3);
        if least < -100.0 * noise && found.doubt.is_none() {
            found.doubt = Some(format!(
                "the goal falls to second order (eigenvalue {least:.2e})"
            ));
        }
        let flat = values.iter().zip(vectors).filter(|(v, _)| v.abs() <= noise);
        found.flat = flat.map(|(_, vector)| problem.direction(&vector)).collect();
    } else if found.doubt.is_none() {
        found.doubt = Some("designs nearby cannot be evaluated".to_owned());
    }
    found
}

impl Problem<'_> {
    /// A direction of the variables as changes of the numbers, the largest by 1 % of its range.
    fn direction(&self, vector: &[f64]) -> Vec<f64> {
        let own = &vector[..self.bounds.len()];
        let largest = own
            .iter()
            .fold(0.0_f64, |max, v| if v.abs() > max.abs() { *v } else { max });
        let each = own.iter().zip(&self.bounds);
        each.map(|(v, [from, to])| 0.01 * v / largest * (to - from))
            .collect()
    }
}

/// The eigenvalues of the Lagrangian's second derivatives along the active constraints, with their directions.
fn curvatures(
    problem: &Problem<'_>,
    worker: &mut Worker<'_, '_>,
    of: &Ended,
) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let optimum = &of.optimum;
    let n = optimum.x.len();
    let mut normals: Vec<Vec<f64>> = Vec::new();
    let constraints = &optimum.evaluation.constraints;
    for (constraint, multiplier) in constraints.iter().zip(&optimum.multipliers) {
        let is_active = constraint.is_equality || constraint.value < ACTIVE && *multiplier > ACTIVE;
        if is_active {
            normals.push(constraint.slope.clone());
        }
    }
    for (k, [from, to]) in problem.variable_bounds().into_iter().enumerate() {
        let x = optimum.x[k];
        if (x - from).min(to - x) <= ACTIVE * 1e-3 {
            normals.push((0..n).map(|i| f64::from(u8::from(i == k))).collect());
        }
    }
    let basis = null_space(&normals, n)?;
    let mut columns = Vec::new();
    for direction in &basis {
        columns.push(bend(problem, worker, of, direction)?);
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let m = basis.len();
    let entry =
        |i: usize, j: usize| 0.5 * (dot(&basis[i], &columns[j]) + dot(&basis[j], &columns[i]));
    if m == 0 {
        return Some((Vec::new(), Vec::new()));
    }
    // Shifted by its norm the matrix is positive, and its singular values are its eigenvalues.
    let squares = (0..m).flat_map(|i| (0..m).map(move |j| (i, j)));
    let norm = squares
        .map(|(i, j)| entry(i, j).powi(2))
        .sum::<f64>()
        .sqrt()
        + f64::MIN_POSITIVE;
    let shifted = Matrix::from_fn(m, m, |i, j| entry(i, j) + if i == j { norm } else { 0.0 });
    let svd = shifted.svd()?;
    let vector = |k: usize| -> Vec<f64> {
        let component = |i: usize| (0..m).map(|j| basis[j][i] * svd.v[(j, k)]).sum();
        (0..n).map(component).collect()
    };
    let values = svd.values.iter().map(|value| value - norm);
    Some((values.collect(), (0..m).map(vector).collect()))
}

/// Orthonormal directions that are perpendicular to some normals.
fn null_space(normals: &[Vec<f64>], n: usize) -> Option<Vec<Vec<f64>>> {
    let unit = |k: usize| -> Vec<f64> { (0..n).map(|i| f64::from(u8::from(i == k))).collect() };
    if normals.is_empty() {
        return Some((0..n).map(unit).collect());
    }
    let lengths: Vec<f64> = (normals.iter())
        .map(|normal| {
            normal
                .iter()
                .map(|v| v * v)
                .sum::<f64>()
                .sqrt()
                .max(f64::MIN_POSITIVE)
        })
        .collect();
    let matrix = Matrix::from_fn(normals.len(), n, |i, j| normals[i][j] / lengths[i]);
    let svd = matrix.svd()?;
    let rank = svd.rank(1e-8);
    let column = |k: usize| (0..n).map(|i| svd.v[(i, k)]).collect();
    Some((rank..n).map(column).collect())
}

/// The derivative of the Lagrangian's slope along a direction, by differences of exact slopes.
fn bend(
    problem: &Problem<'_>,
    worker: &mut Worker<'_, '_>,
    of: &Ended,
    direction: &[f64],
) -> Option<Vec<f64>> {
    let optimum = &of.optimum;
    let mut slope_at = |step: f64| -> Option<Vec<f64>> {
        let x: Vec<f64> = (optimum.x.iter().zip(direction))
            .map(|(x, d)| x + step * d)
            .collect();
        let there = problem.evaluate(worker, &x)?;
        let mut slope = there.slope;
        let constraints = &optimum.evaluation.constraints;
        for (constraint, multiplier) in constraints.iter().zip(&optimum.multipliers) {
            if *multiplier == 0.0 {
                continue;
            }
            let other: &Constraint = constraint.counterpart(&there.constraints)?;
            for (sum, part) in slope.iter_mut().zip(&other.slope) {
                *sum -= multiplier * part;
            }
        }
        Some(slope)
    };
    // One-sided where designs on the other side cannot be evaluated.
    let (after, before) = (slope_at(STEP), slope_at(-STEP));
    let (after, before, width) = match (after, before) {
        (Some(after), Some(before)) => (after, before, 2.0 * STEP),
        (Some(after), None) => (after, slope_at(0.0)?, STEP),
        (None, Some(before)) => (slope_at(0.0)?, before, STEP),
        (None, None) => return None,
    };
    Some(
        after
            .iter()
            .zip(&before)
            .map(|(a, b)| (a - b) / width)
            .collect(),
    )
}

/// Compares the results at a design with those of the sweep, and searches for better designs nearby.
///
/// # Errors
/// [`StudyError`] if the designs nearby are none.
// Long because the design nearby is described as a sweep.
pub(super) fn probe<S: SweptScene>(
    scene: &S,
    problem: &Problem<'_>,
    requested: &RequestedQuantities,
    values: &[f64],
    results: &[f64],
    found: &mut Certificate,
) -> Result<(), StudyError> {
    let numbers = problem.design.numbers(values);
    let swept = requested.evaluate(scene, &problem.design.assigned(&numbers));
    if let Some(message) = swept.message {
        found
            .doubt
            .get_or_insert(format!("the sweep does not compute it: {message}"));
        return Ok(());
    }
    let (goal, _) = problem.report_values(&swept.values, &numbers);
    let differences = results.iter().zip(&swept.values).map(|(own, swept)| {
        // Of a goal that vanishes, in parts of its first value.
        let size = own.abs().max(swept.abs()).max(1e-9 * problem.goal_size());
        (own - swept).abs() / size
    });
    let difference = differences.fold(0.0, f64::max);
    found.sweep_difference = Some(difference);
    if difference > SAME {
        let text = format!(
            "the sweep has other results there, by {difference:.1e} of them: the scene is assembled in another way, or its curves need more positions"
        );
        found.doubt.get_or_insert(text);
        return Ok(());
    }
    let nearby = problem
        .bounds
        .iter()
        .zip(values)
        .map(|([from, to], value)| {
            let off = NEARBY * (to - from);
            [(value - off).max(*from), (value + off).min(*to)]
        });
    let vary = problem.design.axes.iter().zip(nearby);
    let vary = vary.map(|(axis, [from, to])| format!("{}~uniform({from:?},{to:?})", axis.path));
    let vary: Vec<String> = vary.collect();
    let tied = problem.design.ties.iter();
    let tied = tied.map(|tie| format!("{}={}", tie.number.path, tie.number.text));
    let tied: Vec<String> = tied.collect();
    let design = Design::new(scene, &vary, Some(PROBES), 1)?.tied(scene, &tied)?;
    let family = scene.family(&design, requested);
    let indices: Vec<u64> = (0..PROBES).collect();
    let mut count = |row: crate::sweep::compute::Row| {
        if row.result.message.is_some() {
            return;
        }
        found.probes[0] += 1;
        let numbers = problem.design.numbers(&row.inputs);
        let (there, conditions) = problem.report_values(&row.result.values, &numbers);
        if problem.violation(&conditions) <= CONVERGED {
            found.probes[1] += 1;
            found.probes[2] +=
                usize::from(there < goal - BETTER * goal.abs().max(1e-9 * problem.goal_size()));
        }
    };
    requested.points(scene, &design, family.as_ref(), &indices, &mut count);
    if found.probes[2] > 0 {
        let text = format!(
            "{} of {PROBES} random designs nearby are better",
            found.probes[2]
        );
        found.doubt.get_or_insert(text);
    }
    Ok(())
}
