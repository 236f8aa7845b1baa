//! Closing the dense rows by Newton's method, with any imposed values.
//!
//! With R the scale of the rows (1 for lengths, the size for angles) and C that of the coordinates
//! (1 for x and y, 1/size for θ), every system solved is the dimensionless one
//!
//! ```text
//! (R J C) (C⁻¹ s) = R r                                      (1)
//! ```
//!
//! so that pivots can be compared with each other, whatever the mechanism's size.

use crate::dense::DenseMechanism;
use crate::error::DenseError;
use crate::lu::Lu;
use dwell_geometry::Vec2;
use faer::Mat;

/// Newton steps allowed. Quadratic convergence from anything near needs four or five.
const MAX_NEWTON_STEPS: usize = 25;
/// A step this small, relative to the size, leaves an error of its square: rounding.
const CONVERGED_STEP: f64 = 1e-9;
/// A badly conditioned position may never get there, and is accepted once steps stop shrinking.
const STALLED_STEP: f64 = 1e-6;
/// What may be left open in any row in the end, in sizes or rad.
const MAX_RESIDUAL: f64 = 1e-11;
/// A step as large as the mechanism is not a correction any more: another branch would be found.
const MAX_NEWTON_STEP: f64 = 1.5;
/// How far one step of [`DenseMechanism::follow`] may turn or move a body, in rad or sizes.
const MAX_FOLLOW_STEP: f64 = 0.15;
/// Steps of [`DenseMechanism::follow`] before it gives up: next to a dead point they become ever shorter.
const MAX_FOLLOW_STEPS: usize = 2000;

/// A closed configuration: coordinates that meet the imposed values, and the factors there.
#[derive(Debug, Clone)]
pub struct ClosedConfiguration {
    /// Dense coordinates, three per moving body, in the moved frames.
    pub(crate) x: Vec<f64>,
    /// The value each row was closed at: zero for a closed joint, q for an actuator.
    pub(crate) row_values: Vec<f64>,
    pub(crate) lu: Lu,
}

impl DenseMechanism {
    /// Where a point given in a body's own frame is in the plane, m.
    pub fn point(&self, closed: &ClosedConfiguration, body: usize, point: Vec2) -> Vec2 {
        let ground = self.bodies[self.mechanism.ground].shift;
        let of = &self.bodies[body];
        ground + self.frame_point(of, &closed.x, point - of.shift)
    }

    /// Closes every row at its imposed value, starting from the coordinates `initial_guess`.
    pub fn close(
        &self,
        initial_guess: &[f64],
        row_values: &[f64],
    ) -> Result<ClosedConfiguration, DenseError> {
        if initial_guess.len() != self.rows.columns() || row_values.len() != self.rows.len() {
            return Err(DenseError::InvalidPoses);
        }
        let mut x = initial_guess.to_vec();
        let mut residual = vec![0.0; self.rows.len()];
        let mut previous_norm = f64::INFINITY;
        for step in 1..=MAX_NEWTON_STEPS {
            let lu = self.factor(&x)?;
            self.rows.residual(&x, row_values, &mut residual);
            let correction = self.solve(&lu, &residual);
            let correction_norm = self.scaled_norm(&correction);
            if correction_norm.is_nan() || correction_norm >= MAX_NEWTON_STEP {
                return Err(DenseError::NotClosed {
                    steps: step,
                    last_step: correction_norm,
                });
            }
            for (x, s) in x.iter_mut().zip(&correction) {
                *x -= s;
            }
            if correction_norm < CONVERGED_STEP
                || (correction_norm < STALLED_STEP && correction_norm > 0.5 * previous_norm)
            {
                self.rows.residual(&x, row_values, &mut residual);
                let open_residual = self.largest_residual(&residual);
                if open_residual.is_nan() || open_residual > MAX_RESIDUAL {
                    return Err(DenseError::NotClosed {
                        steps: step,
                        last_step: correction_norm,
                    });
                }
                let lu = self.factor(&x)?;
                return Ok(ClosedConfiguration {
                    x,
                    row_values: row_values.to_vec(),
                    lu,
                });
            }
            previous_norm = correction_norm;
        }
        Err(DenseError::NotClosed {
            steps: MAX_NEWTON_STEPS,
            last_step: previous_norm,
        })
    }

    /// Closes the rows at other values on the branch of `from`, starting from `initial_guess`.
    ///
    /// Near a change point two branches almost cross, and a long step across it lands smoothly on
    /// the wrong one: differences would converge to the slope of the crossing and look exact. The
    /// sign of det J tells the two apart, because it cannot change along a branch.
    pub fn close_on_branch(
        &self,
        from: &ClosedConfiguration,
        initial_guess: &[f64],
        row_values: &[f64],
    ) -> Result<ClosedConfiguration, DenseError> {
        let configuration = self.close(initial_guess, row_values)?;
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
        from: &ClosedConfiguration,
        row: usize,
        direction: &[f64],
        value: f64,
    ) -> Result<ClosedConfiguration, DenseError> {
        let increment = value - from.row_values[row];
        let initial_guess: Vec<_> = from
            .x
            .iter()
            .zip(direction)
            .map(|(x, u)| x + u * increment)
            .collect();
        let mut row_values = from.row_values.clone();
        row_values[row] = value;
        self.close_on_branch(from, &initial_guess, &row_values)
    }

    /// As [`DenseMechanism::follow`]; where rows repeat each other, by those that are farthest from dependent at `from`:
    /// any others may become dependent on the way.
    pub(crate) fn follow_with_best_rows(
        &self,
        from: &ClosedConfiguration,
        row: usize,
        to: f64,
    ) -> Result<ClosedConfiguration, DenseError> {
        if self.rows.len() == self.rows.columns() {
            return self.follow(from, row, to);
        }
        let independent_rows = self.select_independent_rows(&from.x);
        if independent_rows.len() != self.rows.columns() {
            return Err(DenseError::Singular { pivot: 0.0 });
        }
        let best = Self {
            independent_rows,
            ..self.clone()
        };
        best.follow(&best.close(&from.x, &from.row_values)?, row, to)
    }

    /// Follows the branch continuously until `row` has the value `to`, in steps short enough for
    /// Newton's method not to change branch, halved where it fails.
    pub fn follow(
        &self,
        from: &ClosedConfiguration,
        row: usize,
        to: f64,
    ) -> Result<ClosedConfiguration, DenseError> {
        let mut here = from.clone();
        for _ in 0..MAX_FOLLOW_STEPS {
            if here.row_values[row] == to {
                return Ok(here);
            }
            let velocity = self.unit_velocity(&here, row);
            let remaining = to - here.row_values[row];
            let mut increment = remaining
                .abs()
                .min(MAX_FOLLOW_STEP / self.scaled_norm(&velocity))
                * remaining.signum();
            let mut halvings = 0;
            here = loop {
                // The last step lands on `to` itself, not on a sum that rounds beside it.
                let value = if increment == remaining {
                    to
                } else {
                    here.row_values[row] + increment
                };
                match self.step_row(&here, row, &velocity, value) {
                    Ok(next) => break next,
                    Err(error) if halvings == 20 || !increment.is_finite() => return Err(error),
                    Err(_) => {
                        increment *= 0.5;
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

    /// How fast the rows' imposed value moves the mechanism: the largest |ω|, or |v| per size, of
    /// any body under the speeds `u`.
    pub fn scaled_norm(&self, u: &[f64]) -> f64 {
        let bodies = u.chunks_exact(3);
        max_abs(bodies.flat_map(|b| [b[0].hypot(b[1]) / self.size, b[2]]))
    }

    /// The speeds of all coordinates when `row` opens, or the actuator turns, at unit rate and all
    /// other rows are held: column k of J⁻¹.
    pub fn unit_velocity(&self, at: &ClosedConfiguration, row: usize) -> Vec<f64> {
        let mut row_velocities = vec![0.0; self.rows.len()];
        row_velocities[row] = 1.0;
        self.solve(&at.lu, &row_velocities)
    }

    /// The unit velocities of every row.
    ///
    /// A row that is not solved cannot be opened: nothing moves.
    pub fn unit_velocities(&self, at: &ClosedConfiguration) -> Vec<Vec<f64>> {
        let n = self.independent_rows.len();
        let scale = |i: usize| self.row_scale[self.independent_rows[i]];
        let mut right = Mat::from_fn(n, n, |i, j| if i == j { scale(i) } else { 0.0 });
        at.lu.solve(&mut right);
        let mut velocities = vec![vec![0.0; n]; self.rows.len()];
        for (k, &row) in self.independent_rows.iter().enumerate() {
            for (c, velocity) in velocities[row].iter_mut().enumerate() {
                *velocity = right[(c, k)] * self.column_scale(c);
            }
        }
        velocities
    }

    /// The accelerations of all coordinates when they move at `x_dot` and row values accelerate
    /// at `rates`: J ẍ = rates − Φ̇ₓ ẋ.
    pub fn acceleration(
        &self,
        at: &ClosedConfiguration,
        x_dot: &[f64],
        row_accelerations: &[f64],
    ) -> Vec<f64> {
        let mut right = vec![0.0; self.rows.len()];
        self.rows.velocity_product(&at.x, x_dot, &mut right);
        for (r, rate) in right.iter_mut().zip(row_accelerations) {
            *r = rate - *r;
        }
        self.solve(&at.lu, &right)
    }

    /// The largest residual of any row that is solved, in sizes or rad.
    fn largest_residual(&self, residual: &[f64]) -> f64 {
        let scaled = self
            .independent_rows
            .iter()
            .map(|&k| residual[k] * self.row_scale[k]);
        max_abs(scaled) / self.size
    }

    /// Whether the rows that are not solved close too.
    ///
    /// # Errors
    /// [`DenseError::RedundantRowsOpen`] with the largest residual.
    pub(crate) fn check_redundant_rows(&self, at: &ClosedConfiguration) -> Result<(), DenseError> {
        let mut residual = vec![0.0; self.rows.len()];
        self.rows.residual(&at.x, &at.row_values, &mut residual);
        let scaled = residual.iter().zip(&self.row_scale).map(|(r, s)| r * s);
        let open_residual = max_abs(scaled) / self.size;
        if open_residual <= MAX_RESIDUAL {
            Ok(())
        } else {
            Err(DenseError::RedundantRowsOpen {
                residual: open_residual,
            })
        }
    }

    pub(crate) fn column_scale(&self, column: usize) -> f64 {
        if column % 3 == 2 {
            1.0 / self.size
        } else {
            1.0
        }
    }

    /// R J C of eq. (1) at the coordinates `x`.
    pub(crate) fn scaled_jacobian(&self, x: &[f64]) -> Mat<f64> {
        let (rows, columns) = (self.rows.len(), self.rows.columns());
        let mut jacobian = vec![0.0; rows * columns];
        self.rows.jacobian(x, &mut jacobian);
        Mat::from_fn(rows, columns, |i, j| {
            jacobian[i * columns + j] * self.row_scale[i] * self.column_scale(j)
        })
    }

    fn factor(&self, x: &[f64]) -> Result<Lu, DenseError> {
        Lu::new(self.independent_part(&self.scaled_jacobian(x)))
            .map_err(|pivot| DenseError::Singular { pivot })
    }

    /// The rows that are solved.
    fn independent_part(&self, matrix: &Mat<f64>) -> Mat<f64> {
        Mat::from_fn(self.independent_rows.len(), matrix.ncols(), |i, j| {
            matrix[(self.independent_rows[i], j)]
        })
    }

    /// The multipliers of all rows under which the forces `q` of the coordinates are made up:
    /// Jᵀ λ = q, by factors of the transposed matrix. Those of rows that are not solved are zero.
    pub(crate) fn multipliers(
        &self,
        at: &ClosedConfiguration,
        q: &[f64],
    ) -> Result<Vec<f64>, DenseError> {
        let independent_part = self.independent_part(&self.scaled_jacobian(&at.x));
        let transposed = independent_part.transpose().to_owned();
        let lu = Lu::new(transposed).map_err(|pivot| DenseError::Singular { pivot })?;
        let mut right = Mat::from_fn(q.len(), 1, |c, _| q[c] * self.column_scale(c));
        lu.solve(&mut right);
        let mut multipliers = vec![0.0; self.rows.len()];
        for (k, &row) in self.independent_rows.iter().enumerate() {
            multipliers[row] = right[(k, 0)] * self.row_scale[row];
        }
        Ok(multipliers)
    }

    fn solve(&self, lu: &Lu, right: &[f64]) -> Vec<f64> {
        let n = self.independent_rows.len();
        let mut scaled = Mat::from_fn(n, 1, |i, _| {
            right[self.independent_rows[i]] * self.row_scale[self.independent_rows[i]]
        });
        lu.solve(&mut scaled);
        (0..n)
            .map(|c| scaled[(c, 0)] * self.column_scale(c))
            .collect()
    }
}

/// The largest magnitude; not a number if any is not, where `f64::max` would drop it.
fn max_abs(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |max, value| {
        if max.is_nan() || value.abs() <= max {
            max
        } else {
            value.abs()
        }
    })
}
