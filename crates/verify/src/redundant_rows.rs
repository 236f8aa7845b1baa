//! Mechanisms whose joints repeat each other: which rows are solved, and which multipliers are determined.

use crate::dense::DenseMechanism;
use crate::description::DescribedJoint;
use crate::error::{DenseError, Result};
use crate::pose::Pose;
use dwell_geometry::space::Wrench;
use std::sync::Arc;

/// A row with a smaller remainder, relative to itself, depends on the others; the tolerance is that of singular values.
const INDEPENDENCE_TOLERANCE: f64 = 1e-9;

impl DenseMechanism {
    /// This mechanism, assembled with the moved frames in these poses and with its gears meshed there. If joints are redundant, it
    /// solves a largest set of rows that are independent there.
    pub(crate) fn assembled(mut self, start: &[Pose]) -> Result<Self> {
        if self.rows.len() != self.rows.columns() {
            self.assembly_rows = self.rows_at(start)?;
            for row in self.dependent_rows(start)? {
                self.determinate[row] = false;
            }
        }
        self.rows.mesh(start);
        Ok(self)
    }

    /// The rows that are solved at these poses. If rows are redundant, a largest set of those that are farthest from dependent there.
    ///
    /// # Errors
    /// [`DenseError::NotSquare`] if they do not determine the pose.
    pub(crate) fn rows_at(&self, poses: &[Pose]) -> Result<Arc<[usize]>> {
        let (rows, columns) = (self.rows.len(), self.rows.columns());
        if rows == columns {
            return Ok(Arc::clone(&self.assembly_rows));
        }
        let independent = self.select_independent_rows(poses);
        if independent.len() == columns {
            return Ok(independent.into());
        }
        Err(DenseError::NotSquare { rows, columns })
    }

    /// The rows that are solved where rows repeat each other, the actuators' among them.
    pub(crate) fn select_independent_rows(&self, poses: &[Pose]) -> Vec<usize> {
        let all: Vec<usize> = (0..self.rows.len()).collect();
        self.independent_rows_of(&all, self.actuator_row(), poses)
    }

    /// A set of independent rows among these, by Gram and Schmidt: first those from `preferred` on, then always the row
    /// that is farthest from the rows before.
    pub(crate) fn independent_rows_of(
        &self,
        candidates: &[usize],
        preferred: usize,
        poses: &[Pose],
    ) -> Vec<usize> {
        let matrix = self.scaled_jacobian(poses);
        let row = |&i: &usize| (i, (0..matrix.ncols()).map(|j| matrix[(i, j)]).collect());
        let mut remaining: Vec<(usize, Vec<f64>)> = candidates.iter().map(row).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut independent = Vec::new();
        while independent.len() < matrix.ncols() {
            let size = |k: &usize| dot(&remaining[*k].1, &remaining[*k].1);
            let farthest = || (0..remaining.len()).max_by(|i, j| size(i).total_cmp(&size(j)));
            let first_preferred = remaining.iter().position(|(row, _)| *row >= preferred);
            let Some(next) = first_preferred.or_else(farthest) else {
                break;
            };
            let (row, values) = remaining.remove(next);
            let length = dot(&values, &values).sqrt();
            // What is left of a row of order one is rounding.
            if length.is_nan() || length < INDEPENDENCE_TOLERANCE {
                break;
            }
            let unit: Vec<f64> = values.iter().map(|v| v / length).collect();
            for (_, other) in &mut remaining {
                let part = dot(other, &unit);
                let both = other.iter_mut().zip(&unit);
                both.for_each(|(v, u)| *v -= part * u);
            }
            independent.push(row);
        }
        independent.sort_unstable();
        independent
    }

    /// The multipliers of joints' rows that balance without any force, each of length one, with moments divided by the size. Empty if no
    /// row is redundant, or if no joint has reactions by components.
    pub(crate) fn self_stresses(&self, poses: &[Pose]) -> Vec<Vec<f64>> {
        let by_components = self.joints.iter().any(|joint| joint.is_wrench);
        if self.rows.len() == self.rows.columns() || !by_components {
            return Vec::new();
        }
        let matrix = self.scaled_jacobian(poses);
        let Ok(svd) = matrix.svd() else {
            return Vec::new();
        };
        let rank = self.rows.columns();
        let stress = |k: usize| {
            let parts = svd.U().col(k).iter().zip(&self.row_scale);
            parts.map(|(part, scale)| part * scale).collect()
        };
        (rank..self.rows.len()).map(stress).collect()
    }

    /// Force and moment of multipliers of a joint's rows on its second body, about its point there, by components.
    pub(crate) fn joint_wrench(
        &self,
        joint: &DescribedJoint,
        poses: &[Pose],
        multipliers: &[f64],
    ) -> [f64; 6] {
        self.joint_sum(joint, poses, |row, part| multipliers[row] * part)
    }

    /// Bounds of the components, from bounds of the multipliers.
    pub(crate) fn joint_wrench_bound(
        &self,
        joint: &DescribedJoint,
        poses: &[Pose],
        bounds: &[f64],
    ) -> [f64; 6] {
        self.joint_sum(joint, poses, |row, part| (bounds[row] * part).abs())
    }

    fn joint_sum(
        &self,
        joint: &DescribedJoint,
        poses: &[Pose],
        part_of: impl Fn(usize, f64) -> f64,
    ) -> [f64; 6] {
        let mut sum = [0.0; 6];
        let (second, point) = joint.at(poses);
        for row in joint.rows.clone() {
            self.rows
                .row(row)
                .each_own_gradient(poses, |body, factor, gradient| {
                    if body != second {
                        return;
                    }
                    let Wrench { force, moment } = gradient;
                    let arm = point - poses[body].position;
                    let moment = moment - arm.cross(force);
                    let parts = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
                    for (sum, part) in sum.iter_mut().zip(parts) {
                        *sum += part_of(row, factor * part);
                    }
                });
        }
        sum
    }
}
