//! Mechanisms whose joints repeat each other: which rows are solved, and which multipliers are determined.

use crate::dense::DenseMechanism;
use crate::error::{DenseError, Result};
use crate::inertias::Inertias;
use crate::rank::rank;
use dwell_geometry::Mechanism;

/// A row of which less than this remains beside the others depends on them: as for singular values.
const INDEPENDENCE_TOLERANCE: f64 = 1e-9;

impl DenseMechanism {
    /// The same with its gears meshed as they stand in the configuration with the frames `poses` of all bodies. Where
    /// joints repeat each other, a largest set of independent rows is solved, found there.
    pub(crate) fn with_meshed_gears<'m>(
        mechanism: &Mechanism,
        inertias: impl Into<Inertias<'m>>,
        poses: &[[f64; 3]],
    ) -> Result<Self> {
        let mut dense = Self::without_rank_check(mechanism, inertias)?;
        let (rows, columns) = (dense.rows.len(), dense.rows.columns());
        let x = dense.coordinates(poses)?;
        if rows != columns {
            dense.independent_rows = dense.select_independent_rows(&x);
            if dense.independent_rows.len() != columns {
                return Err(DenseError::NotSquare { rows, columns });
            }
            for row in rank(mechanism, poses)?.with_actuators.dependent_rows {
                dense.determinate[row] = false;
            }
        }
        dense.rows.mesh(&x);
        Ok(dense)
    }

    /// The rows that are solved where rows repeat each other, the actuators' among them.
    pub(crate) fn select_independent_rows(&self, x: &[f64]) -> Vec<usize> {
        let all: Vec<usize> = (0..self.rows.len()).collect();
        self.independent_rows_of(&all, self.actuator_row(), x)
    }

    /// Those of some rows of which none is made up of the others: by Gram and Schmidt, first those from `preferred` on,
    /// then always the one that is farthest from those before.
    pub(crate) fn independent_rows_of(
        &self,
        candidates: &[usize],
        preferred: usize,
        x: &[f64],
    ) -> Vec<usize> {
        let matrix = self.scaled_jacobian(x);
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
}
