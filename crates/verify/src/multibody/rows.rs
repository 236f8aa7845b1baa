//! The rows in coordinates of the centres of mass, which of them are solved, and how a motion is put
//! back on them.

use super::equations::MultibodyOde;
use super::{MotionSample, MultibodyError, MultibodySystem};
use crate::dense::{DenseMechanism, for_each_attachment};
use crate::lu::Lu;
use crate::rank::rank;
use dwell_dynamics::CoordinateMode;
use dwell_geometry::constraint_rows::ConstraintRows;
use dwell_geometry::{Mechanism, Vec2, vec2};
use dwell_kinetostatics::Mass;
use faer::Mat;

/// What is left of a row of order one below this is rounding.
const INDEPENDENCE_TOLERANCE: f64 = 1e-9;
/// Newton's steps to close the rows.
const MAX_NEWTON_STEPS: usize = 30;
/// A step of Newton's method this short, in sizes or rad, is rounding.
const CONVERGED_STEP: f64 = 1e-14;
/// The largest residual of a row that is not solved, in sizes or rad.
const MAX_RESIDUAL: f64 = 1e-9;

/// The rows of the mechanism with its frames moved to the centres of mass.
#[derive(Debug, Clone)]
pub(super) struct CentroidalFrames {
    pub(super) rows: ConstraintRows,
    /// By body: first of its columns, and the new origin in its own frame.
    pub(super) columns: Vec<Option<usize>>,
    shifts: Vec<Vec2>,
    /// Where the ground's origin is moved to.
    pub(super) ground_origin: Vec2,
    /// What a radian is compared with, m.
    pub(super) size: f64,
    pub(super) row_scale: Vec<f64>,
    /// Row of the first actuator.
    pub(super) actuator_row: usize,
}

impl CentroidalFrames {
    pub(super) fn new(mechanism: &Mechanism, masses: &[Mass]) -> Result<Self, MultibodyError> {
        let dense = DenseMechanism::without_rank_check(mechanism, masses)?;
        let shifts: Vec<Vec2> = masses
            .iter()
            .zip(&dense.bodies)
            .map(|(mass, body)| {
                // The ground, and what has no mass, is given no centre.
                let centred = mass.mass > 0.0 && body.column.is_some();
                if centred { mass.center } else { body.shift }
            })
            .collect();
        let mut shifted = mechanism.clone();
        for_each_attachment(&mut shifted, |body, point| *point -= shifts[body]);
        Ok(Self {
            rows: ConstraintRows::new(&shifted).map_err(crate::DenseError::from)?,
            columns: dense.bodies.iter().map(|b| b.column).collect(),
            ground_origin: shifts[mechanism.ground],
            shifts,
            size: dense.size(),
            actuator_row: dense.actuator_row(),
            row_scale: dense.row_scale,
        })
    }

    pub(super) fn coordinate_count(&self) -> usize {
        self.rows.columns()
    }

    /// Coordinates and speeds of the centres out of frames and their rates.
    pub(super) fn to_centroidal(
        &self,
        bodies: &[[f64; 3]],
        velocity: &[[f64; 3]],
    ) -> (Vec<f64>, Vec<f64>) {
        let (mut x, mut v) = (
            vec![0.0; self.coordinate_count()],
            vec![0.0; self.coordinate_count()],
        );
        for (b, column) in self.columns.iter().enumerate() {
            let Some(c) = *column else { continue };
            let ([px, py, angle], [vx, vy, omega]) = (bodies[b], velocity[b]);
            let arm = self.shifts[b].rotate(Vec2::from_angle(angle));
            let center = (vec2(px, py) - self.ground_origin) + arm;
            let velocity_of_centre = vec2(vx, vy) + arm.perp() * omega;
            x[c..c + 3].copy_from_slice(&[center.x, center.y, angle]);
            v[c..c + 3].copy_from_slice(&[velocity_of_centre.x, velocity_of_centre.y, omega]);
        }
        (x, v)
    }

    /// Frames and their rates out of coordinates and speeds of the centres.
    pub(super) fn to_frames(&self, x: &[f64], v: &[f64]) -> [Vec<[f64; 3]>; 2] {
        let count = self.columns.len();
        let mut both = [vec![[0.0; 3]; count], vec![[0.0; 3]; count]];
        for (b, column) in self.columns.iter().enumerate() {
            let Some(c) = *column else { continue };
            let arm = self.shifts[b].rotate(Vec2::from_angle(x[c + 2]));
            let origin = self.ground_origin + (vec2(x[c], x[c + 1]) - arm);
            let origin_velocity = vec2(v[c], v[c + 1]) - arm.perp() * v[c + 2];
            both[0][b] = [origin.x, origin.y, x[c + 2]];
            both[1][b] = [origin_velocity.x, origin_velocity.y, v[c + 2]];
        }
        both
    }

    pub(super) fn column_scale(&self, column: usize) -> f64 {
        if column % 3 == 2 {
            1.0 / self.size
        } else {
            1.0
        }
    }

    /// ∂Φ/∂x of all rows, row after row.
    pub(super) fn jacobian(&self, x: &[f64]) -> Vec<f64> {
        let mut jacobian = vec![0.0; self.rows.len() * self.coordinate_count()];
        self.rows.jacobian(x, &mut jacobian);
        jacobian
    }

    /// One row's rate: its line of the Jacobian times the speeds.
    pub(super) fn row_velocity(&self, jacobian: &[f64], row: usize, v: &[f64]) -> f64 {
        let line = &jacobian[row * self.coordinate_count()..][..self.coordinate_count()];
        line.iter().zip(v).map(|(j, v)| j * v).sum()
    }
}

/// The rows that are solved at a configuration, of those at hand: by Gram and Schmidt, always the
/// one that is farthest from those before.
fn select_independent_rows(
    frames: &CentroidalFrames,
    candidate_rows: &[usize],
    x: &[f64],
) -> Vec<usize> {
    let jacobian = frames.jacobian(x);
    let n = frames.coordinate_count();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let scaled_row = |&row: &usize| -> (usize, Vec<f64>) {
        let scaled = |c: usize| jacobian[row * n + c] * frames.column_scale(c);
        let scale = frames.row_scale[row];
        (row, (0..n).map(|c| scaled(c) * scale).collect())
    };
    let mut remaining_rows: Vec<(usize, Vec<f64>)> =
        candidate_rows.iter().map(scaled_row).collect();
    let mut independent_rows = Vec::new();
    while let Some(farthest) = (0..remaining_rows.len()).max_by(|&i, &j| {
        let size = |k: usize| dot(&remaining_rows[k].1, &remaining_rows[k].1);
        size(i).total_cmp(&size(j))
    }) {
        let (row, scaled_row) = remaining_rows.swap_remove(farthest);
        let length = dot(&scaled_row, &scaled_row).sqrt();
        if length.is_nan() || length < INDEPENDENCE_TOLERANCE {
            break;
        }
        let unit: Vec<f64> = scaled_row.iter().map(|v| v / length).collect();
        for (_, other) in &mut remaining_rows {
            let projection = dot(other, &unit);
            other
                .iter_mut()
                .zip(&unit)
                .for_each(|(v, u)| *v -= projection * u);
        }
        independent_rows.push(row);
    }
    independent_rows.sort_unstable();
    independent_rows
}

impl MultibodySystem {
    /// The mechanism with its prescribed actuators alone, and their rows after all joints'.
    fn prescribed_mechanism(&self) -> (Mechanism, Vec<usize>) {
        let mut mechanism = self.mechanism.clone();
        let mut rows: Vec<usize> = (0..self.frames.actuator_row).collect();
        mechanism.actuators.clear();
        for (i, mode) in self.modes.iter().enumerate() {
            if *mode != CoordinateMode::Free {
                mechanism
                    .actuators
                    .push(self.mechanism.actuators[i].clone());
                rows.push(self.frames.actuator_row + i);
            }
        }
        (mechanism, rows)
    }

    /// By reaction: whether the rows determine it where the bodies stand so.
    pub(super) fn determinate(&self, bodies: &[[f64; 3]]) -> Result<Vec<bool>, MultibodyError> {
        let mut determinate = vec![true; self.frames.actuator_row];
        for row in rank(&self.prescribed_mechanism().0, bodies)?
            .with_actuators
            .dependent_rows
        {
            if let Some(determinate) = determinate.get_mut(row) {
                *determinate = false;
            }
        }
        Ok(determinate)
    }

    /// The equations with gears meshed and independent rows chosen at a start.
    pub(super) fn ode_at(&self, start: &MotionSample) -> Result<MultibodyOde<'_>, MultibodyError> {
        let (x, _) = self.frames.to_centroidal(&start.poses, &start.velocities);
        let candidate_rows = self.prescribed_mechanism().1;
        let mut frames = self.frames.clone();
        frames.rows.mesh(&x);
        let active_rows = select_independent_rows(&frames, &candidate_rows, &x);
        Ok(MultibodyOde {
            system: self,
            frames,
            active_rows,
            candidate_rows,
        })
    }
}

impl MultibodyOde<'_> {
    /// By row: the value, speed and acceleration that is imposed on it.
    pub(super) fn prescribed_values(&self, t: f64) -> [Vec<f64>; 3] {
        let mut prescribed = [0; 3].map(|_| vec![0.0; self.frames.rows.len()]);
        for (i, mode) in self.system.modes.iter().enumerate() {
            if let CoordinateMode::Prescribed(law) = mode {
                for (of, value) in prescribed.iter_mut().zip(law.eval(t)) {
                    of[self.frames.actuator_row + i] = value;
                }
            }
        }
        prescribed
    }

    /// The least change of the coordinates, a radian counted as a size, that changes the rows by
    /// `by`.
    fn min_norm_change(
        &self,
        x: &[f64],
        change: &[f64],
        t: f64,
    ) -> Result<Vec<f64>, MultibodyError> {
        let frames = &self.frames;
        let (n, m) = (frames.coordinate_count(), self.active_rows.len());
        let jacobian = frames.jacobian(x);
        let mut matrix = Mat::zeros(n + m, n + m);
        let mut right = Mat::zeros(n + m, 1);
        for c in 0..n {
            matrix[(c, c)] = 1.0;
        }
        self.add_border(&jacobian, &mut matrix);
        for (k, &row) in self.active_rows.iter().enumerate() {
            right[(n + k, 0)] = change[row] * frames.row_scale[row];
        }
        let lu = Lu::new(matrix).map_err(|pivot| MultibodyError::Singular { t, pivot })?;
        lu.solve(&mut right);
        Ok((0..n)
            .map(|c| right[(c, 0)] * frames.column_scale(c))
            .collect())
    }

    /// The scaled rows, below and to the right of what a matrix holds for the coordinates.
    pub(super) fn add_border(&self, jacobian: &[f64], matrix: &mut Mat<f64>) {
        let n = self.frames.coordinate_count();
        for (k, &row) in self.active_rows.iter().enumerate() {
            for c in 0..n {
                let entry = jacobian[row * n + c]
                    * self.frames.row_scale[row]
                    * self.frames.column_scale(c);
                matrix[(n + k, c)] = entry;
                matrix[(c, n + k)] = entry;
            }
        }
    }

    /// Puts coordinates and speeds back on the rows, by the least change.
    pub(super) fn project(&self, t: f64, y: &mut [f64]) -> Result<(), MultibodyError> {
        let frames = &self.frames;
        let n = frames.coordinate_count();
        let (x, rest) = y.split_at_mut(n);
        let v = &mut rest[..n];
        let [value, row_velocities, _] = self.prescribed_values(t);
        let mut residual = vec![0.0; frames.rows.len()];
        let mut converged = false;
        for _ in 0..MAX_NEWTON_STEPS {
            frames.rows.residual(x, &value, &mut residual);
            residual.iter_mut().for_each(|r| *r = -*r);
            let step = self.min_norm_change(x, &residual, t)?;
            x.iter_mut().zip(&step).for_each(|(x, s)| *x += s);
            if frames.scaled_norm(&step) <= CONVERGED_STEP * (1.0 + frames.scaled_norm(x)) {
                converged = true;
                break;
            }
        }
        frames.rows.residual(x, &value, &mut residual);
        let open = |&row: &usize| residual[row].abs() * frames.row_scale[row] / frames.size;
        if !converged
            || !self
                .candidate_rows
                .iter()
                .all(|row| open(row) <= MAX_RESIDUAL)
        {
            return Err(MultibodyError::NotClosed { t });
        }
        let jacobian = frames.jacobian(x);
        let velocity_error = |row| row_velocities[row] - frames.row_velocity(&jacobian, row, v);
        let correction: Vec<f64> = (0..frames.rows.len()).map(velocity_error).collect();
        let change = self.min_norm_change(x, &correction, t)?;
        v.iter_mut().zip(&change).for_each(|(v, c)| *v += c);
        Ok(())
    }
}

impl CentroidalFrames {
    /// The largest of angles and of lengths over the size.
    pub(super) fn scaled_norm(&self, of: &[f64]) -> f64 {
        let one = |(c, v): (usize, &f64)| (v / (self.size * self.column_scale(c))).abs();
        of.iter().enumerate().map(one).fold(0.0, f64::max)
    }
}
