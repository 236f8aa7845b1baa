//! The effect of rounding on everything that is computed in a closed configuration.

use crate::constraint_closing::Configuration;
use crate::dense::DenseMechanism;
use crate::error::Result;

/// The amount by which a row is opened to measure the effect of rounding, relative to the size.
const PROBE_STEP: f64 = 1e-7;
/// The expected fraction of the sum of all rows' roundings, which rarely all add up. Differences observed near a change
/// point were at most a fifth of the sum.
const EXPECTED_SHARE: f64 = 0.2;

impl DenseMechanism {
    /// Bounds of the rounding errors of the `values` of a configuration, which are `exact` there, and of the pose
    /// relative to the mechanism's size.
    ///
    /// A row cannot be closed better than to a unit in the last place of its arms, and next to a dead point this error
    /// is magnified without limit. Therefore each row is opened a little, and the sum of the resulting changes, scaled
    /// down to one rounding, bounds the error to first order.
    pub(crate) fn rounding_bounds(
        &self,
        configuration: &Configuration,
        unit_velocities: &[Vec<f64>],
        exact: &[f64],
        values: impl Fn(&Configuration) -> Result<Vec<f64>>,
    ) -> Result<(Vec<f64>, f64)> {
        let mut bounds = vec![0.0; exact.len()];
        let mut pose_bound = 0.0;
        let factor = EXPECTED_SHARE * f64::EPSILON / PROBE_STEP;
        for (row, (direction, scale)) in unit_velocities.iter().zip(&self.row_scale).enumerate() {
            let opened = PROBE_STEP * self.size / scale;
            let value = configuration.row_values[row] + opened;
            let perturbed = self.step_row(configuration, row, direction, value)?;
            let moved = values(&perturbed)?.into_iter().zip(exact);
            for (bound, (perturbed, exact)) in bounds.iter_mut().zip(moved) {
                *bound += factor * (perturbed - exact).abs();
            }
            let norm = self.scaled_norm(direction);
            pose_bound += EXPECTED_SHARE * f64::EPSILON * norm * self.size / scale;
        }
        Ok((bounds, pose_bound))
    }
}
