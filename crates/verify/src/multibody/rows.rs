//! The rows in coordinates of the centres of mass, which of them are solved, and how a motion is put
//! back on them.

use super::equations::MultibodyOde;
use super::{MotionSample, MultibodyError, MultibodySystem, Result};
use crate::dense::DenseMechanism;
use crate::description::Description;
use crate::inertias::Inertias;
use crate::lu::Lu;
use crate::pose::{Columns, Pose, Twist};
use crate::rank::rank;
use crate::rows::row::Since;
use dwell_dynamics::CoordinateMode;
use dwell_geometry::Mechanism;
use faer::Mat;

/// Newton's steps to close the rows.
const MAX_NEWTON_STEPS: usize = 30;
/// A step of Newton's method this short, in sizes or rad, is rounding.
const CONVERGED_STEP: f64 = 1e-14;
/// The largest residual of a row that is not solved, in sizes or rad.
const MAX_RESIDUAL: f64 = 1e-9;

/// The dense rows of a mechanism with its frames moved to the centres of mass, where a body has mass.
pub(super) fn centroidal_frames(
    mechanism: &Mechanism,
    inertias: Inertias<'_>,
) -> Result<DenseMechanism> {
    let description = Description::in_plane(mechanism, inertias)?;
    let centers: Vec<_> = description.bodies.iter().map(|body| body.mass).collect();
    Ok(DenseMechanism::of(description, |body, mean| {
        if centers[body].mass > 0.0 && body != mechanism.ground {
            centers[body].center
        } else {
            mean
        }
    }))
}

impl DenseMechanism {
    /// The coordinates of bodies that move in the plane, out of the poses of their moved frames.
    pub(super) fn coordinates_of(&self, poses: &[Pose]) -> Vec<f64> {
        let moving = self.moving_bodies();
        let of_body = moving.flat_map(|(b, _)| {
            let Pose {
                position, angle, ..
            } = poses[b];
            [position.x, position.y, angle]
        });
        of_body.collect()
    }

    /// The poses of the moved frames out of coordinates.
    pub(super) fn poses_of(&self, x: &[f64]) -> Vec<Pose> {
        let of_body = self.bodies.iter().map(|body| match body.columns {
            Columns::Plane(c) | Columns::Space(c) => Pose::from([x[c], x[c + 1], x[c + 2]]),
            Columns::Fixed => Pose::default(),
        });
        of_body.collect()
    }

    /// Frames [x, y, θ] of all bodies and their rates out of moved frames and velocities.
    pub(super) fn to_frames(&self, poses: &[Pose], v: &[f64]) -> [Vec<[f64; 3]>; 2] {
        let ground = self.bodies[self.ground].shift;
        let mut both = [0; 2].map(|_| vec![[0.0; 3]; self.bodies.len()]);
        for (b, body) in self.moving_bodies() {
            let (pose, twist): (&Pose, Twist) = (&poses[b], body.columns.twist(v));
            let arm = pose.rotation.apply(body.shift);
            let origin = ground + (pose.position - arm);
            let velocity = twist.at(-arm);
            both[0][b] = [origin.x, origin.y, pose.angle];
            both[1][b] = [velocity.x, velocity.y, twist.angular.z];
        }
        both
    }

    /// One row's rate: its line of the Jacobian times the velocities.
    pub(super) fn row_velocity(&self, jacobian: &[f64], row: usize, v: &[f64]) -> f64 {
        let n = self.rows.columns();
        let line = &jacobian[row * n..][..n];
        line.iter().zip(v).map(|(j, v)| j * v).sum()
    }

    /// The largest of angles and of lengths over the size.
    pub(super) fn largest_component(&self, of: &[f64]) -> f64 {
        let one = |(c, v): (usize, &f64)| (v / (self.size * self.column_scale(c))).abs();
        of.iter().enumerate().map(one).fold(0.0, f64::max)
    }
}

impl MultibodySystem {
    /// The mechanism with its prescribed actuators alone, and their rows after all joints'.
    fn prescribed_mechanism(&self) -> (Mechanism, Vec<usize>) {
        let mut mechanism = self.mechanism.clone();
        let mut rows: Vec<usize> = (0..self.frames.actuator_row()).collect();
        mechanism.actuators.clear();
        for (i, mode) in self.modes.iter().enumerate() {
            if *mode != CoordinateMode::Free {
                let actuator = self.mechanism.actuators[i].clone();
                mechanism.actuators.push(actuator);
                rows.push(self.frames.actuator_row() + i);
            }
        }
        (mechanism, rows)
    }

    /// By reaction: whether the rows determine it where the bodies stand so.
    pub(super) fn determinate(&self, bodies: &[[f64; 3]]) -> Result<Vec<bool>> {
        let mut determinate = vec![true; self.frames.actuator_row()];
        let ranks = rank(&self.prescribed_mechanism().0, bodies)?;
        for row in ranks.with_actuators.dependent_rows {
            if let Some(determinate) = determinate.get_mut(row) {
                *determinate = false;
            }
        }
        Ok(determinate)
    }

    /// The equations with gears meshed and independent rows chosen at a start.
    pub(super) fn ode_at(&self, start: &MotionSample) -> Result<MultibodyOde<'_>> {
        let poses = self.frames.frames(&start.poses)?;
        let candidate_rows = self.prescribed_mechanism().1;
        let mut frames = self.frames.clone();
        frames.rows.mesh(&poses);
        let active_rows = frames.independent_rows_of(&candidate_rows, usize::MAX, &poses);
        Ok(MultibodyOde {
            system: self,
            frames,
            active_rows,
            candidate_rows,
        })
    }
}

impl MultibodyOde<'_> {
    /// By row: the value, velocity and acceleration that is imposed on it.
    pub(super) fn prescribed_values(&self, t: f64) -> [Vec<f64>; 3] {
        let mut prescribed = [0; 3].map(|_| vec![0.0; self.frames.rows.len()]);
        for (i, mode) in self.system.modes.iter().enumerate() {
            if let CoordinateMode::Prescribed(law) = mode {
                for (of, value) in prescribed.iter_mut().zip(law.eval(t)) {
                    of[self.frames.actuator_row() + i] = value;
                }
            }
        }
        prescribed
    }

    /// The least change of the coordinates, a radian counted as a size, that changes the rows by
    /// `by`.
    fn min_norm_change(&self, poses: &[Pose], by: &[f64], t: f64) -> Result<Vec<f64>> {
        let frames = &self.frames;
        let n = frames.rows.columns();
        let mut right = Mat::zeros(n + self.active_rows.len(), 1);
        for (k, &row) in self.active_rows.iter().enumerate() {
            right[(n + k, 0)] = by[row] * frames.row_scale[row];
        }
        let unit = |i, j| if i == j { 1.0 } else { 0.0 };
        self.solve_bordered(unit, &frames.rows.jacobian(poses), &mut right, t)?;
        let scaled = (0..n).map(|c| right[(c, 0)] * frames.column_scale(c));
        Ok(scaled.collect())
    }

    /// Solves with a matrix of the coordinates and the scaled rows below and to the right of it, in place.
    pub(super) fn solve_bordered(
        &self,
        matrix: impl Fn(usize, usize) -> f64,
        jacobian: &[f64],
        right: &mut Mat<f64>,
        t: f64,
    ) -> Result<()> {
        let (frames, n) = (&self.frames, self.frames.rows.columns());
        let entry = |k: usize, c: usize| {
            let row = self.active_rows[k];
            jacobian[row * n + c] * frames.row_scale[row] * frames.column_scale(c)
        };
        let bordered = Mat::from_fn(right.nrows(), right.nrows(), |i, j| match (i < n, j < n) {
            (true, true) => matrix(i, j),
            (false, true) => entry(i - n, j),
            (true, false) => entry(j - n, i),
            (false, false) => 0.0,
        });
        let lu = Lu::new(bordered).map_err(|pivot| MultibodyError::Singular { t, pivot })?;
        lu.solve(right);
        Ok(())
    }

    /// Puts coordinates and velocities back on the rows, by the least change.
    pub(super) fn project(&self, t: f64, y: &mut [f64]) -> Result<()> {
        let frames = &self.frames;
        let n = frames.rows.columns();
        let (x, rest) = y.split_at_mut(n);
        let v = &mut rest[..n];
        let [value, row_velocities, _] = self.prescribed_values(t);
        let mut residual = vec![0.0; frames.rows.len()];
        let mut converged = false;
        let mut poses = frames.poses_of(x);
        let row_values = &value;
        for _ in 0..MAX_NEWTON_STEPS {
            let since = Since {
                poses: &poses,
                row_values,
            };
            frames.rows.residual(&poses, since, &value, &mut residual);
            residual.iter_mut().for_each(|r| *r = -*r);
            let step = self.min_norm_change(&poses, &residual, t)?;
            x.iter_mut().zip(&step).for_each(|(x, s)| *x += s);
            poses = frames.poses_of(x);
            let length = frames.largest_component(x);
            converged = frames.largest_component(&step) <= CONVERGED_STEP * (1.0 + length);
            if converged {
                break;
            }
        }
        let since = Since {
            poses: &poses,
            row_values,
        };
        frames.rows.residual(&poses, since, &value, &mut residual);
        let open = |&row: &usize| residual[row].abs() * frames.row_scale[row] / frames.size;
        let closed = |row: &usize| open(row) <= MAX_RESIDUAL;
        if !converged || !self.candidate_rows.iter().all(closed) {
            return Err(MultibodyError::NotClosed(t));
        }
        let jacobian = frames.rows.jacobian(&poses);
        let velocity_error = |row| row_velocities[row] - frames.row_velocity(&jacobian, row, v);
        let correction: Vec<f64> = (0..frames.rows.len()).map(velocity_error).collect();
        let change = self.min_norm_change(&poses, &correction, t)?;
        v.iter_mut().zip(&change).for_each(|(v, c)| *v += c);
        Ok(())
    }
}
