//! The effect of rounding on everything that is computed in a closed configuration.

use crate::constraint_closing::Configuration;
use crate::dense::DenseMechanism;
use crate::error::Result;

/// How far a row is opened to see what rounding does, in sizes.
const PROBE_STEP: f64 = 1e-7;
/// The part of the sum of all rows' roundings that is expected: they rarely all add up. Differences
/// met beside a change point were a fifth of the sum and less.
const EXPECTED_SHARE: f64 = 0.2;

impl DenseMechanism {
    /// How much rounding may have moved each of the `values` of a configuration, which are `exact`
    /// there, and the pose relative to the mechanism's size.
    ///
    /// A row cannot be closed better than to a unit in the last place of its arms, and next to a
    /// dead point that is magnified without limit. So each row is opened a little by itself, and
    /// the sum of what that moves, scaled down to one rounding, bounds the noise to first order.
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
