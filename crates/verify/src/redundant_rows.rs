//! Mechanisms whose joints repeat each other: which rows are solved, and which multipliers are determined.

use crate::dense::DenseMechanism;
use crate::error::DenseError;
use crate::rank::rank;
use dwell_geometry::Mechanism;
use dwell_kinetostatics::Mass;

/// A row of which less than this remains beside the others depends on them: as for singular values.
const INDEPENDENCE_TOLERANCE: f64 = 1e-9;

impl DenseMechanism {
    /// The same where joints repeat each other: a largest set of independent rows is solved, found
    /// in the configuration with the frames `poses` of all bodies.
    pub(crate) fn with_redundant_rows(
        mechanism: &Mechanism,
        masses: &[Mass],
        poses: &[[f64; 3]],
    ) -> Result<Self, DenseError> {
        let mut dense = Self::without_rank_check(mechanism, masses)?;
        let (rows, columns) = (dense.rows.len(), dense.rows.columns());
        if rows == columns {
            return Ok(dense);
        }
        let independent_rows = dense.select_independent_rows(&dense.coordinates(poses)?);
        if independent_rows.len() != columns {
            return Err(DenseError::NotSquare { rows, columns });
        }
        dense.independent_rows = independent_rows;
        for row in rank(mechanism, poses)?.with_actuators.dependent_rows {
            dense.determinate[row] = false;
        }
        Ok(dense)
    }

    /// The same with its gears meshed as they stand there.
    pub(crate) fn with_meshed_gears(
        mechanism: &Mechanism,
        masses: &[Mass],
        poses: &[[f64; 3]],
    ) -> Result<Self, DenseError> {
        let mut dense = Self::with_redundant_rows(mechanism, masses, poses)?;
        dense.mesh(poses)?;
        Ok(dense)
    }

    /// Rows of which none is made up of the others, the actuators' among them; by Gram and Schmidt,
    /// always with the one that is farthest from those before.
    pub(crate) fn select_independent_rows(&self, x: &[f64]) -> Vec<usize> {
        let matrix = self.scaled_jacobian(x);
        let rows = 0..matrix.nrows();
        let mut remaining_rows: Vec<Vec<f64>> = rows
            .map(|i| (0..matrix.ncols()).map(|j| matrix[(i, j)]).collect())
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut independent_rows: Vec<usize> = Vec::new();
        while independent_rows.len() < matrix.ncols() {
            let next_actuator = (self.actuator_row()..remaining_rows.len())
                .find(|row| !independent_rows.contains(row));
            let farthest = || {
                let size = |row: &usize| dot(&remaining_rows[*row], &remaining_rows[*row]);
                let others =
                    (0..remaining_rows.len()).filter(|row| !independent_rows.contains(row));
                others.max_by(|a, b| size(a).total_cmp(&size(b)))
            };
            let Some(next) = next_actuator.or_else(farthest) else {
                break;
            };
            let length = dot(&remaining_rows[next], &remaining_rows[next]).sqrt();
            // What is left of a row of order one is rounding.
            if length.is_nan() || length < INDEPENDENCE_TOLERANCE {
                break;
            }
            let unit: Vec<f64> = remaining_rows[next].iter().map(|v| v / length).collect();
            for row in &mut remaining_rows {
                let projection = dot(row, &unit);
                row.iter_mut()
                    .zip(&unit)
                    .for_each(|(v, u)| *v -= projection * u);
            }
            independent_rows.push(next);
        }
        independent_rows.sort_unstable();
        independent_rows
    }
}
