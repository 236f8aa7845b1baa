//! What rounding does to anything that is read off a closed configuration.

use crate::closing::Closed;
use crate::dense::{Dense, DenseError};

/// How far a row is opened to see what rounding does, in sizes.
const PROBE: f64 = 1e-7;
/// The part of the sum of all rows' roundings that is expected: they rarely all add up. Differences
/// met beside a change point were a fifth of the sum and less.
const EXPECTED: f64 = 0.2;

impl Dense {
    /// How much rounding may have moved each of the `values` of a configuration, which are `exact`
    /// there, and the pose relative to the mechanism's size.
    ///
    /// A row cannot be closed better than to a unit in the last place of its arms, and next to a
    /// dead point that is magnified without limit. So each row is opened a little by itself, and
    /// the sum of what that moves, scaled down to one rounding, bounds the noise to first order.
    pub(crate) fn rounding(
        &self,
        closed: &Closed,
        unit_speeds: &[Vec<f64>],
        exact: &[f64],
        values: impl Fn(&Closed) -> Result<Vec<f64>, DenseError>,
    ) -> Result<(Vec<f64>, f64), DenseError> {
        let mut noise = vec![0.0; exact.len()];
        let mut pose = 0.0;
        let share = EXPECTED * f64::EPSILON / PROBE;
        for (row, (direction, scale)) in unit_speeds.iter().zip(&self.row_scale).enumerate() {
            let opened = PROBE * self.size / scale;
            let there = self.step(closed, row, direction, closed.imposed[row] + opened)?;
            for ((noise, there), exact) in noise.iter_mut().zip(values(&there)?).zip(exact) {
                *noise += share * (there - exact).abs();
            }
            pose += EXPECTED * f64::EPSILON * self.reach(direction) * self.size / scale;
        }
        Ok((noise, pose))
    }
}
