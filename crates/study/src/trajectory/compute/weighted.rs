//! Statistics along a trajectory with the positions on which they depend, and by how much: what their derivatives are computed from.

use crate::explain::StudyError;
use crate::trajectory::compute::along::{Curve, CurveSearch, search_along};
use crate::trajectory::compute::{
    Analysis, Point, RowEvaluator, RowScene, Signal, Statistic, extremum_with_ties, stationary_near,
};

/// A statistic and the positions on whose signal it depends: its derivative by a number of the scene is the sum of the weights times
/// those of the signal there, at positions that stay where they are.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Weighted {
    pub(crate) value: f64,
    /// The summed signal.
    pub(crate) signal: Signal,
    /// Fractions of the trajectory, with their weights.
    pub(crate) weights: Vec<Point>,
    /// Other fractions at which an extremum is as large: the statistic has a kink there.
    pub(crate) ties: Vec<f64>,
}

/// As [`statistics_along`](super::statistics_along), with their weights; `None` for the distance from a table.
///
/// # Errors
/// As of that.
pub(crate) fn weighted_along<S: RowScene>(
    scene: &S,
    rows: &S::Rows,
    analysis: Analysis,
    wanted: &[(Signal, Statistic)],
) -> Result<Vec<Option<Weighted>>, StudyError> {
    search_along(
        scene,
        rows,
        analysis,
        wanted,
        |search, curves, all, duration| {
            let weighted = all.iter().map(|(signal, statistic)| {
                let curve = curves.iter().find(|curve| curve.signal == *signal)?;
                Some(search.weighted(curve, *statistic, duration))
            });
            weighted.collect()
        },
    )
}

impl<E: RowEvaluator> CurveSearch<'_, E> {
    /// The value of a statistic with its weights.
    fn weighted(&mut self, curve: &Curve, statistic: Statistic, duration: f64) -> Weighted {
        let value = self.value(curve, statistic, duration);
        let mut found = Weighted {
            value,
            signal: curve.signal.clone(),
            weights: Vec::new(),
            ties: Vec::new(),
        };
        // Those of a mean by trapezoids, each times the derivative of its summand.
        let last = (curve.points.len() - 1) as f64;
        let mean = |slope: &dyn Fn(f64) -> f64| -> Vec<Point> {
            let each = curve.points.iter().enumerate();
            let weights = each.map(|(k, &[u, v])| {
                let is_end = k == 0 || k + 1 == curve.points.len();
                [u, slope(v) * if is_end { 0.5 } else { 1.0 } / last]
            });
            weights.collect()
        };
        match statistic {
            Statistic::Mean => found.weights = mean(&|_| 1.0),
            // At zero it has a kink.
            Statistic::Rms if value == 0.0 => {}
            Statistic::Rms => found.weights = mean(&|v| v / value),
            Statistic::Work => found.weights = mean(&|_| duration),
            Statistic::Max => self.add_highest(curve, |v| v, 1.0, &mut found),
            Statistic::Min => self.add_highest(curve, |v| -v, 1.0, &mut found),
            Statistic::Stroke => {
                self.add_highest(curve, |v| v, 1.0, &mut found);
                self.add_highest(curve, |v| -v, -1.0, &mut found);
            }
            Statistic::MaxAbs | Statistic::PeakPower => {
                self.add_highest(curve, f64::abs, 1.0, &mut found);
                let at = found.weights.last().map_or(0.0, |[u, _]| *u);
                let sign = curve.near(at).signum();
                found.weights.iter_mut().for_each(|[_, w]| *w = sign);
            }
        }
        found
    }

    /// Adds the position of the highest value of a function of a signal, with a weight, and those that tie with it.
    fn add_highest(
        &mut self,
        curve: &Curve,
        of: fn(f64) -> f64,
        weight: f64,
        found: &mut Weighted,
    ) {
        let spacing = 1.0 / (curve.points.len() - 1) as f64;
        let high = self.high_points(curve, of);
        let Some(extremum) = extremum_with_ties(&high, [0.0, 1.0], spacing) else {
            return;
        };
        let mut value = |u: f64| Some(of(self.values(u, &[curve])?[0]));
        let at = stationary_near(&mut value, extremum.at, [0.0, 1.0], spacing);
        found.weights.push([at, weight]);
        found.ties.extend(extremum.ties);
    }
}
