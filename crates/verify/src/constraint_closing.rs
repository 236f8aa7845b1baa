//! Closing the dense rows by Newton's method, with any imposed values.
//!
//! With R the scale of the rows (1 for lengths, the size for angles) and C that of the coordinates
//! (1 for positions, 1/size for angles), every system solved is the dimensionless one
//!
//! ```text
//! (R J C) (C⁻¹ s) = R r                                      (1)
//! ```
//!
//! so that pivots can be compared with each other, whatever the mechanism's size.

use crate::dense::DenseMechanism;
use crate::error::{DenseError, Result};
use crate::lu::Lu;
use crate::pose::{Columns, Pose, Twist};
use crate::rows::row::Since;
use faer::Mat;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Newton steps allowed. Quadratic convergence from anything near needs four or five.
const MAX_NEWTON_STEPS: usize = 25;
/// A step this small, relative to the size, leaves an error of its square: rounding.
const CONVERGED_STEP: f64 = 1e-9;
/// A badly conditioned position may never get there, and is accepted once steps stop shrinking.
const STALLED_STEP: f64 = 1e-6;
/// Largest final residual of a row, relative to the size, or in rad.
const MAX_RESIDUAL: f64 = 1e-11;
/// Rounding error of a row of teeth, relative to the size.
const TEETH_CLOSED: f64 = 1e-15;
/// A step as large as the mechanism is not a correction any more: another branch would be found.
const MAX_NEWTON_STEP: f64 = 1.5;
/// How far one step of [`DenseMechanism::follow`] may rotate or move a body, in rad or sizes.
const MAX_FOLLOW_STEP: f64 = 0.15;
/// Steps of [`DenseMechanism::follow`] before it gives up: next to a dead point they become ever shorter.
const MAX_FOLLOW_STEPS: usize = 2000;

/// A closed configuration: coordinates that meet the imposed values, and the factors there.
#[derive(Debug, Clone)]
pub struct Configuration {
    /// The moved frames of all bodies, from the moved origin of the ground.
    pub(crate) poses: Vec<Pose>,
    /// The value each row was closed at: zero for a closed joint, q for an actuator.
    pub(crate) row_values: Vec<f64>,
    /// The rows that are solved, as many as there are coordinates. They imply the others.
    pub(crate) rows: Arc<[usize]>,
    pub(crate) lu: Lu,
}

impl Configuration {
    /// The poses from which rows of velocities are counted.
    fn since(&self) -> Since<'_> {
        Since {
            poses: &self.poses,
            row_values: &self.row_values,
        }
    }
}

impl DenseMechanism {
    /// Closes every row at its imposed value, starting from the moved frames `guess`. The teeth of gears in space mesh as there.
    ///
    /// # Errors
    /// [`DenseError`] where the rows are dependent, or do not close.
    pub fn close(&self, guess: &[Pose], row_values: &[f64]) -> Result<Configuration> {
        let poses = guess;
        let rows = self.rows_at(guess)?;
        self.close_since(Since { poses, row_values }, rows, guess, row_values)
    }

    /// Closes with some of the rows; rows of velocities are counted from a configuration.
    fn close_since(
        &self,
        since: Since<'_>,
        rows: Arc<[usize]>,
        guess: &[Pose],
        row_values: &[f64],
    ) -> Result<Configuration> {
        if guess.len() != self.bodies.len() || row_values.len() != self.rows.len() {
            return Err(DenseError::InvalidPoses);
        }
        let not_closed = |steps, last_step| Err(DenseError::NotClosed { steps, last_step });
        let mut poses = guess.to_vec();
        let mut residual = vec![0.0; self.rows.len()];
        let mut previous = f64::INFINITY;
        for step in 1..=MAX_NEWTON_STEPS {
            let lu = self.factor(&poses, &rows)?;
            self.rows.residual(&poses, since, row_values, &mut residual);
            let mut correction = self.solve(&lu, &rows, &residual);
            let norm = self.scaled_norm(&correction);
            if norm.is_nan() || norm >= MAX_NEWTON_STEP {
                return not_closed(step, norm);
            }
            correction.iter_mut().for_each(|c| *c = -*c);
            poses = self.moved(&poses, &correction);
            if norm < CONVERGED_STEP || (norm < STALLED_STEP && norm > 0.5 * previous) {
                self.rows.residual(&poses, since, row_values, &mut residual);
                let open = self.largest_residual(&residual, &rows);
                let stalls = norm > 0.5 * previous;
                // Teeth in space close by less than a square in each step: until nothing is gained.
                let is_done = !self.rows.has_teeth_in_space() || stalls || open <= TEETH_CLOSED;
                if open <= MAX_RESIDUAL && is_done {
                    let (lu, row_values) = (self.factor(&poses, &rows)?, row_values.to_vec());
                    return Ok(Configuration {
                        poses,
                        row_values,
                        rows,
                        lu,
                    });
                }
                if open.is_nan() || stalls {
                    return not_closed(step, norm);
                }
            }
            previous = norm;
        }
        not_closed(MAX_NEWTON_STEPS, previous)
    }

    /// Poses moved by a step of all coordinates.
    pub(crate) fn moved(&self, poses: &[Pose], step: &[f64]) -> Vec<Pose> {
        let both = self.bodies.iter().zip(poses);
        both.map(|(body, pose)| body.columns.moved(pose, step))
            .collect()
    }

    /// Closes the poses of all bodies at the coordinates `q` of the actuators; and how far that moves them,
    /// relative to the largest coordinate in them.
    pub(crate) fn close_at(&self, poses: &[Pose], q: &[f64]) -> Result<(Configuration, f64)> {
        let guess = self.moved_frames(poses)?;
        let mut row_values = vec![0.0; self.rows.len()];
        row_values[self.actuator_row()..].copy_from_slice(q);
        let closed = self.close(&guess, &row_values)?;
        let distances = poses.iter().map(|pose| pose.position.norm());
        let largest = distances.fold(self.size(), f64::max);
        // The ground stands in its own frame: what is claimed of it beyond that is off.
        let ground = &poses[self.ground];
        let off = max_abs(
            [
                ground.position.norm() / self.size,
                ground.rotation.vector().norm(),
            ]
            .into_iter(),
        );
        let norm = self.norm_of(self.steps(&guess, &closed.poses)).max(off);
        Ok((closed, norm * self.size() / largest))
    }

    /// By body: the step that leads from some poses to others.
    fn steps(&self, from: &[Pose], to: &[Pose]) -> impl Iterator<Item = Twist> {
        let both = self.bodies.iter().zip(from.iter().zip(to));
        both.map(|(body, (from, to))| body.columns.step(from, to))
    }

    /// How far two configurations are apart, rad or sizes.
    pub(crate) fn distance(&self, one: &Configuration, other: &Configuration) -> f64 {
        let bodies = 0..self.bodies.len();
        self.norm_of(bodies.map(|b| self.apart(b, [&one.poses[b], &other.poses[b]])))
    }

    /// The distance of two poses of a body, without whole revolutions and without an idle rotation.
    fn apart(&self, body: usize, [one, other]: [&Pose; 2]) -> Twist {
        if let Some(idle) = self.idle.iter().find(|idle| idle.body.0 == body) {
            let axis = |pose: &Pose| pose.rotation.apply(idle.axis);
            return Twist {
                linear: one.point(idle.point) - other.point(idle.point),
                angular: axis(other).cross(axis(one)),
            };
        }
        let columns = self.bodies[body].columns;
        let mut step = columns.step(other, one);
        if let Columns::Plane(_) = columns {
            step.angular.z -= TAU * (step.angular.z / TAU).round();
        }
        step
    }

    /// The distance of two poses of a body, in rad or relative to the size.
    pub(crate) fn body_distance(&self, body: usize, poses: [&Pose; 2]) -> f64 {
        self.norm_of(std::iter::once(self.apart(body, poses)))
    }

    /// Closes the rows at other values on the branch of `from`, starting from `initial_guess`.
    ///
    /// Near a change point two branches almost cross, and a long step across it lands smoothly on
    /// the wrong one: differences would converge to the slope of the crossing and look exact. The
    /// sign of det J distinguishes them, because it cannot change along a branch.
    pub fn close_on_branch(
        &self,
        from: &Configuration,
        initial_guess: &[Pose],
        row_values: &[f64],
    ) -> Result<Configuration> {
        let configuration = self.close_since(
            from.since(),
            Arc::clone(&from.rows),
            initial_guess,
            row_values,
        )?;
        if configuration.lu.positive() == from.lu.positive() {
            Ok(configuration)
        } else {
            Err(DenseError::OtherBranch)
        }
    }

    /// Closes again with `row` at another `value`, on the same branch, starting from where
    /// `direction`, the unit velocity of that row, leads.
    pub fn step_row(
        &self,
        from: &Configuration,
        row: usize,
        direction: &[f64],
        value: f64,
    ) -> Result<Configuration> {
        let increment = value - from.row_values[row];
        let step: Vec<f64> = direction.iter().map(|u| u * increment).collect();
        let initial_guess = self.moved(&from.poses, &step);
        let mut row_values = from.row_values.clone();
        row_values[row] = value;
        self.close_on_branch(from, &initial_guess, &row_values)
    }

    /// Follows the branch continuously until `row` has the value `to`.
    ///
    /// # Errors
    /// As of [`DenseMechanism::follow_to`].
    pub fn follow(&self, from: &Configuration, row: usize, to: f64) -> Result<Configuration> {
        let mut row_values = from.row_values.clone();
        row_values[row] = to;
        self.follow_to(from, &row_values)
    }

    /// Follows the branch continuously until the rows have these values, on a straight line, in steps short enough for Newton's method
    /// not to change branch, halved where it fails. If rows are redundant, each step uses the rows that are farthest from dependent,
    /// because others may become dependent before the end.
    ///
    /// # Errors
    /// [`DenseError`] if the branch cannot be followed so far.
    pub fn follow_to(&self, from: &Configuration, to: &[f64]) -> Result<Configuration> {
        let mut here = from.clone();
        for _ in 0..MAX_FOLLOW_STEPS {
            if here.row_values == to {
                return Ok(here);
            }
            here = self.by_best_rows(&here)?;
            let remaining: Vec<f64> = to
                .iter()
                .zip(&here.row_values)
                .map(|(t, h)| t - h)
                .collect();
            let velocity = self.solve(&here.lu, &here.rows, &remaining);
            let mut part = (MAX_FOLLOW_STEP / self.scaled_norm(&velocity)).min(1.0);
            let mut halvings = 0;
            here = loop {
                let between = |(h, r): (&f64, &f64)| h + part * r;
                // The last step lands on `to` itself, not on a sum that rounds beside it.
                let row_values: Vec<f64> = match part {
                    1.0 => to.to_vec(),
                    _ => here
                        .row_values
                        .iter()
                        .zip(&remaining)
                        .map(between)
                        .collect(),
                };
                let step: Vec<f64> = velocity.iter().map(|v| v * part).collect();
                let guess = self.moved(&here.poses, &step);
                match self.close_on_branch(&here, &guess, &row_values) {
                    Ok(next) => break next,
                    Err(error) if halvings == 20 || !part.is_finite() => return Err(error),
                    Err(_) => {
                        part *= 0.5;
                        halvings += 1;
                    }
                }
            };
        }
        Err(DenseError::NotClosed {
            steps: MAX_FOLLOW_STEPS,
            last_step: MAX_FOLLOW_STEP,
        })
    }

    /// The configuration, solved by the rows that are farthest from dependent there.
    fn by_best_rows(&self, at: &Configuration) -> Result<Configuration> {
        let mut best = at.clone();
        let rows = self.rows_at(&at.poses)?;
        if rows != at.rows {
            best.lu = self.factor(&at.poses, &rows)?;
            best.rows = rows;
        }
        Ok(best)
    }

    /// How fast the rows' imposed value moves the mechanism: the largest |ω|, or |v| per size, of
    /// any body at the velocities `u`.
    pub fn scaled_norm(&self, u: &[f64]) -> f64 {
        self.norm_of(self.bodies.iter().map(|body| body.columns.twist(u)))
    }

    fn norm_of(&self, twists: impl Iterator<Item = Twist>) -> f64 {
        max_abs(twists.flat_map(|t| [t.linear.norm() / self.size, t.angular.norm()]))
    }

    /// The velocities of all coordinates when `row` opens, or the actuator moves, at unit rate and all
    /// other rows are held: column k of J⁻¹.
    pub fn unit_velocity(&self, at: &Configuration, row: usize) -> Vec<f64> {
        let mut rates = vec![0.0; self.rows.len()];
        rates[row] = 1.0;
        self.solve(&at.lu, &at.rows, &rates)
    }

    /// The unit velocities of every row.
    ///
    /// A row that is not solved cannot be opened: its velocities are zero.
    pub fn unit_velocities(&self, at: &Configuration) -> Vec<Vec<f64>> {
        let n = at.rows.len();
        let mut right = Mat::zeros(n, n);
        for (k, &row) in at.rows.iter().enumerate() {
            right[(k, k)] = self.row_scale[row];
        }
        at.lu.solve(&mut right);
        let mut velocities = vec![vec![0.0; n]; self.rows.len()];
        for (k, &row) in at.rows.iter().enumerate() {
            for (c, velocity) in velocities[row].iter_mut().enumerate() {
                *velocity = right[(c, k)] * self.column_scale(c);
            }
        }
        velocities
    }

    /// The accelerations of all coordinates when they move at `x_dot` and row values accelerate
    /// at `rates`: J ẍ = rates − Φ̇ₓ ẋ.
    pub fn acceleration(&self, at: &Configuration, x_dot: &[f64], rates: &[f64]) -> Vec<f64> {
        let mut right = self.rows.velocity_products(&at.poses, x_dot);
        for (r, rate) in right.iter_mut().zip(rates) {
            *r = rate - *r;
        }
        self.solve(&at.lu, &at.rows, &right)
    }

    /// The largest residual of some rows, in sizes or rad.
    fn largest_residual(&self, residual: &[f64], rows: &[usize]) -> f64 {
        max_abs(rows.iter().map(|&k| residual[k] * self.row_scale[k])) / self.size
    }

    /// Whether the rows that are not solved close too.
    ///
    /// # Errors
    /// [`DenseError::RedundantRowsOpen`] with the largest residual.
    pub(crate) fn check_redundant_rows(&self, at: &Configuration) -> Result<()> {
        let mut residual = vec![0.0; self.rows.len()];
        self.rows
            .residual(&at.poses, at.since(), &at.row_values, &mut residual);
        let all: Vec<usize> = (0..residual.len()).collect();
        match self.largest_residual(&residual, &all) {
            open if open <= MAX_RESIDUAL => Ok(()),
            residual => Err(DenseError::RedundantRowsOpen(residual)),
        }
    }

    /// R J C of eq. (1) at these poses.
    pub(crate) fn scaled_jacobian(&self, poses: &[Pose]) -> Mat<f64> {
        let (rows, columns) = (self.rows.len(), self.rows.columns());
        let jacobian = self.rows.jacobian(poses);
        Mat::from_fn(rows, columns, |i, j| {
            jacobian[i * columns + j] * self.row_scale[i] * self.column_scale(j)
        })
    }

    fn factor(&self, poses: &[Pose], rows: &[usize]) -> Result<Lu> {
        Lu::new(part(&self.scaled_jacobian(poses), rows)).map_err(DenseError::Singular)
    }

    /// The sign of the determinant of the rows that are solved; `None` if they are dependent, and in space if some of them are
    /// redundant, because these may become dependent elsewhere.
    pub(crate) fn orientation(&self, poses: &[Pose]) -> Option<bool> {
        let in_space = matches!(self.whole(), Columns::Space(_));
        if in_space && self.rows.len() != self.rows.columns() {
            return None;
        }
        Some(self.factor(poses, &self.assembly_rows).ok()?.positive())
    }

    /// The multipliers of all rows that yield the forces `q` of the coordinates:
    /// Jᵀ λ = q, by factors of the transposed matrix. Those of rows that are not solved are zero.
    pub(crate) fn multipliers(&self, at: &Configuration, q: &[f64]) -> Result<Vec<f64>> {
        let rows = part(&self.scaled_jacobian(&at.poses), &at.rows);
        let lu = Lu::new(rows.transpose().to_owned()).map_err(DenseError::Singular)?;
        let mut right = Mat::from_fn(q.len(), 1, |c, _| q[c] * self.column_scale(c));
        lu.solve(&mut right);
        let mut multipliers = vec![0.0; self.rows.len()];
        for (k, &row) in at.rows.iter().enumerate() {
            multipliers[row] = right[(k, 0)] * self.row_scale[row];
        }
        Ok(multipliers)
    }

    fn solve(&self, lu: &Lu, rows: &[usize], right: &[f64]) -> Vec<f64> {
        let entry = |i: usize| right[rows[i]] * self.row_scale[rows[i]];
        let mut scaled = Mat::from_fn(rows.len(), 1, |i, _| entry(i));
        lu.solve(&mut scaled);
        let unscaled = (0..rows.len()).map(|c| scaled[(c, 0)] * self.column_scale(c));
        unscaled.collect()
    }
}

/// Some rows of a matrix.
fn part(matrix: &Mat<f64>, rows: &[usize]) -> Mat<f64> {
    Mat::from_fn(rows.len(), matrix.ncols(), |i, j| matrix[(rows[i], j)])
}

/// The largest magnitude; NaN if any value is NaN, which `f64::max` would drop.
fn max_abs(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |max, value| {
        if max.is_nan() || value.abs() <= max {
            max
        } else {
            value.abs()
        }
    })
}
