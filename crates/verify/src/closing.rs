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

use crate::dense::{Dense, DenseError};
use crate::solve::Lu;
use faer::Mat;

/// Newton steps allowed. Quadratic convergence from anything near needs four or five.
const STEPS: usize = 25;
/// A step this small, relative to the size, leaves an error of its square: rounding.
const SMALL_STEP: f64 = 1e-9;
/// A badly conditioned position may never get there, and is accepted once steps stop shrinking.
const STALLED_STEP: f64 = 1e-6;
/// What may be left open in any row in the end, in sizes or rad.
const OPEN: f64 = 1e-11;
/// A step as large as the mechanism is not a correction any more: another branch would be found.
const WILD_STEP: f64 = 1.5;
/// How far one step of [`Dense::follow`] may turn or move a body, in rad or sizes.
const STRIDE: f64 = 0.15;
/// Steps of [`Dense::follow`] before it gives up: next to a dead point they become ever shorter.
const STRIDES: usize = 2000;

/// A closed configuration: coordinates that meet the imposed values, and the factors there.
#[derive(Debug, Clone)]
pub struct Closed {
    /// Dense coordinates, three per moving body, in the moved frames.
    pub(crate) x: Vec<f64>,
    /// The value each row was closed at: zero for a closed joint, q for an actuator.
    pub(crate) imposed: Vec<f64>,
    pub(crate) lu: Lu,
}

impl Dense {
    /// Closes every row at its imposed value, starting from the coordinates `start`.
    pub fn close(&self, start: &[f64], imposed: &[f64]) -> Result<Closed, DenseError> {
        if start.len() != self.rows.columns() || imposed.len() != self.rows.len() {
            return Err(DenseError::Start);
        }
        let mut x = start.to_vec();
        let mut residual = vec![0.0; self.rows.len()];
        let mut last = f64::INFINITY;
        for step in 1..=STEPS {
            let lu = self.factor(&x)?;
            self.rows.residual(&x, imposed, &mut residual);
            let correction = self.solve(&lu, &residual);
            let moved = self.reach(&correction);
            if moved.is_nan() || moved >= WILD_STEP {
                return Err(DenseError::NotClosed { steps: step, moved });
            }
            for (x, s) in x.iter_mut().zip(&correction) {
                *x -= s;
            }
            if moved < SMALL_STEP || (moved < STALLED_STEP && moved > 0.5 * last) {
                self.rows.residual(&x, imposed, &mut residual);
                let open = self.openness(&residual);
                if open.is_nan() || open > OPEN {
                    return Err(DenseError::NotClosed { steps: step, moved });
                }
                let lu = self.factor(&x)?;
                return Ok(Closed {
                    x,
                    imposed: imposed.to_vec(),
                    lu,
                });
            }
            last = moved;
        }
        Err(DenseError::NotClosed {
            steps: STEPS,
            moved: last,
        })
    }

    /// Closes the rows at other values on the branch of `from`, starting from `start`.
    ///
    /// Near a change point two branches almost cross, and a long step across it lands smoothly on
    /// the wrong one: differences would converge to the slope of the crossing and look exact. The
    /// sign of det J tells the two apart, because it cannot change along a branch.
    pub fn close_beside(
        &self,
        from: &Closed,
        start: &[f64],
        imposed: &[f64],
    ) -> Result<Closed, DenseError> {
        let closed = self.close(start, imposed)?;
        if closed.lu.positive() == from.lu.positive() {
            Ok(closed)
        } else {
            Err(DenseError::OtherBranch)
        }
    }

    /// Closes again with `row` at another `value`, on the same branch, starting from where
    /// `direction`, the unit speed of that row, leads.
    pub fn step(
        &self,
        from: &Closed,
        row: usize,
        direction: &[f64],
        value: f64,
    ) -> Result<Closed, DenseError> {
        let by = value - from.imposed[row];
        let start: Vec<_> = from
            .x
            .iter()
            .zip(direction)
            .map(|(x, u)| x + u * by)
            .collect();
        let mut imposed = from.imposed.clone();
        imposed[row] = value;
        self.close_beside(from, &start, &imposed)
    }

    /// As [`Dense::follow`]; where rows repeat each other, by those that are farthest from dependent at `from`:
    /// any others may become dependent on the way.
    pub(crate) fn follow_by_best(
        &self,
        from: &Closed,
        row: usize,
        to: f64,
    ) -> Result<Closed, DenseError> {
        if self.rows.len() == self.rows.columns() {
            return self.follow(from, row, to);
        }
        let kept = self.independent(&from.x);
        if kept.len() != self.rows.columns() {
            return Err(DenseError::Singular { pivot: 0.0 });
        }
        let best = Self {
            kept,
            ..self.clone()
        };
        best.follow(&best.close(&from.x, &from.imposed)?, row, to)
    }

    /// Follows the branch continuously until `row` has the value `to`, in steps short enough for
    /// Newton's method not to change branch, halved where it fails.
    pub fn follow(&self, from: &Closed, row: usize, to: f64) -> Result<Closed, DenseError> {
        let mut here = from.clone();
        for _ in 0..STRIDES {
            if here.imposed[row] == to {
                return Ok(here);
            }
            let speed = self.unit_speed(&here, row);
            let left = to - here.imposed[row];
            let mut by = left.abs().min(STRIDE / self.reach(&speed)) * left.signum();
            let mut halvings = 0;
            here = loop {
                // The last step lands on `to` itself, not on a sum that rounds beside it.
                let value = if by == left {
                    to
                } else {
                    here.imposed[row] + by
                };
                match self.step(&here, row, &speed, value) {
                    Ok(next) => break next,
                    Err(error) if halvings == 20 || !by.is_finite() => return Err(error),
                    Err(_) => {
                        by *= 0.5;
                        halvings += 1;
                    }
                }
            };
        }
        Err(DenseError::NotClosed {
            steps: STRIDES,
            moved: STRIDE,
        })
    }

    /// How fast the rows' imposed value moves the mechanism: the largest |ω|, or |v| per size, of
    /// any body under the speeds `u`.
    pub fn reach(&self, u: &[f64]) -> f64 {
        let bodies = u.chunks_exact(3);
        largest(bodies.flat_map(|b| [b[0].hypot(b[1]) / self.size, b[2]]))
    }

    /// The speeds of all coordinates when `row` opens, or the actuator turns, at unit rate and all
    /// other rows are held: column k of J⁻¹.
    pub fn unit_speed(&self, at: &Closed, row: usize) -> Vec<f64> {
        let mut rates = vec![0.0; self.rows.len()];
        rates[row] = 1.0;
        self.solve(&at.lu, &rates)
    }

    /// The unit speeds of every row.
    ///
    /// A row that is not solved cannot be opened: nothing moves.
    pub fn unit_speeds(&self, at: &Closed) -> Vec<Vec<f64>> {
        let n = self.kept.len();
        let scale = |i: usize| self.row_scale[self.kept[i]];
        let mut right = Mat::from_fn(n, n, |i, j| if i == j { scale(i) } else { 0.0 });
        at.lu.solve(&mut right);
        let mut speeds = vec![vec![0.0; n]; self.rows.len()];
        for (k, &row) in self.kept.iter().enumerate() {
            for (c, speed) in speeds[row].iter_mut().enumerate() {
                *speed = right[(c, k)] * self.column_scale(c);
            }
        }
        speeds
    }

    /// The accelerations of all coordinates when they move at `x_dot` and row values accelerate
    /// at `rates`: J ẍ = rates − Φ̇ₓ ẋ.
    pub fn acceleration(&self, at: &Closed, x_dot: &[f64], rates: &[f64]) -> Vec<f64> {
        let mut right = vec![0.0; self.rows.len()];
        self.rows.curvature(&at.x, x_dot, &mut right);
        for (r, rate) in right.iter_mut().zip(rates) {
            *r = rate - *r;
        }
        self.solve(&at.lu, &right)
    }

    /// The largest residual of any row that is solved, in sizes or rad.
    fn openness(&self, residual: &[f64]) -> f64 {
        let scaled = self.kept.iter().map(|&k| residual[k] * self.row_scale[k]);
        largest(scaled) / self.size
    }

    /// Whether the rows that are not solved close too.
    ///
    /// # Errors
    /// [`DenseError::Open`] with the largest residual.
    pub(crate) fn check_repeated(&self, at: &Closed) -> Result<(), DenseError> {
        let mut residual = vec![0.0; self.rows.len()];
        self.rows.residual(&at.x, &at.imposed, &mut residual);
        let scaled = residual.iter().zip(&self.row_scale).map(|(r, s)| r * s);
        let open = largest(scaled) / self.size;
        if open <= OPEN {
            Ok(())
        } else {
            Err(DenseError::Open { open })
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
        Lu::new(self.solved(&self.scaled_jacobian(x)))
            .map_err(|pivot| DenseError::Singular { pivot })
    }

    /// The rows that are solved.
    fn solved(&self, matrix: &Mat<f64>) -> Mat<f64> {
        Mat::from_fn(self.kept.len(), matrix.ncols(), |i, j| {
            matrix[(self.kept[i], j)]
        })
    }

    /// The multipliers of all rows under which the forces `q` of the coordinates are made up:
    /// Jᵀ λ = q, by factors of the transposed matrix. Those of rows that are not solved are zero.
    pub(crate) fn multipliers(&self, at: &Closed, q: &[f64]) -> Result<Vec<f64>, DenseError> {
        let solved = self.solved(&self.scaled_jacobian(&at.x));
        let transposed = solved.transpose().to_owned();
        let lu = Lu::new(transposed).map_err(|pivot| DenseError::Singular { pivot })?;
        let mut right = Mat::from_fn(q.len(), 1, |c, _| q[c] * self.column_scale(c));
        lu.solve(&mut right);
        let mut multipliers = vec![0.0; self.rows.len()];
        for (k, &row) in self.kept.iter().enumerate() {
            multipliers[row] = right[(k, 0)] * self.row_scale[row];
        }
        Ok(multipliers)
    }

    fn solve(&self, lu: &Lu, right: &[f64]) -> Vec<f64> {
        let n = self.kept.len();
        let mut scaled = Mat::from_fn(n, 1, |i, _| {
            right[self.kept[i]] * self.row_scale[self.kept[i]]
        });
        lu.solve(&mut scaled);
        (0..n)
            .map(|c| scaled[(c, 0)] * self.column_scale(c))
            .collect()
    }
}

/// The largest magnitude; not a number if any is not, where `f64::max` would drop it.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| {
        if most.is_nan() || value.abs() <= most {
            most
        } else {
            value.abs()
        }
    })
}
