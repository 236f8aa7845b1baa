//! Extremes of curves over the range of a mechanism of one degree of freedom, also between the positions of `dwell reduce`.

use crate::trajectory::compute::{Point, highest_between};
use dwell_geometry::PositionError;
use dwell_kinetostatics::{Coefficients, ExactModel, ReducedModel as _, ReducibleModel};

/// Number of intervals of the range at whose ends the curves are evaluated, as in `dwell reduce`.
const INTERVALS: usize = 720;

/// Values with the coordinates at which they occur.
pub(crate) type ExtremeValues = Vec<Point>;

/// The quantities of a curve, from the coefficients at a position.
type Quantities = Box<dyn Fn(&Coefficients) -> Vec<f64>>;

/// Curves over the range.
pub(crate) struct RangeCurves<M: ReducibleModel> {
    exact: ExactModel<M>,
    quantities: Quantities,
    curves: Vec<Vec<Point>>,
}

impl<M: ReducibleModel> RangeCurves<M> {
    /// m and ½m′ between two coordinates, rad or m.
    ///
    /// # Errors
    /// [`PositionError`] where a position cannot be assembled.
    pub(crate) fn of_inertia(
        exact: ExactModel<M>,
        limits: [f64; 2],
    ) -> Result<Self, PositionError> {
        Self::new(exact, limits, Box::new(|at| vec![at.m, at.half_dm]))
    }

    /// The reactions of a model in the free rotation without loads: R = a q̈ + b q̇² with
    /// q̈ = −½m′ q̇²/m and q̇² = 2E/m, E being the `energy`, J.
    ///
    /// # Errors
    /// As [`of_inertia`](Self::of_inertia).
    pub(crate) fn of_free_reactions(
        exact: ExactModel<M>,
        limits: [f64; 2],
        energy: f64,
    ) -> Result<Self, PositionError> {
        let reactions = move |at: &Coefficients| {
            let (m, half_dm) = (at.m, at.half_dm);
            let pairs = at.a.iter().zip(&at.b);
            let free = pairs.map(|(a, b)| 2.0 * energy * (b - a * half_dm / m) / m);
            free.collect()
        };
        Self::new(exact, limits, Box::new(reactions))
    }

    fn new(
        exact: ExactModel<M>,
        [from, to]: [f64; 2],
        quantities: Quantities,
    ) -> Result<Self, PositionError> {
        let mut workspace = exact.workspace();
        let mut coefficients = exact.coefficient_buffer();
        let mut curves: Vec<Vec<Point>> = Vec::new();
        for k in 0..=INTERVALS {
            let fraction = k as f64 / INTERVALS as f64;
            let q = from * (1.0 - fraction) + to * fraction;
            exact.coefficients(q, &mut workspace, &mut coefficients)?;
            let values = quantities(&coefficients);
            curves.resize(values.len(), Vec::new());
            for (curve, value) in curves.iter_mut().zip(values) {
                curve.push([q, value]);
            }
        }
        Ok(Self {
            exact,
            quantities,
            curves,
        })
    }

    /// The highest point of a function of a curve's values.
    fn highest(&self, k: usize, of: impl Fn(f64) -> f64) -> Point {
        let curve: Vec<Point> = self.curves[k].iter().map(|[q, v]| [*q, of(*v)]).collect();
        let mut workspace = self.exact.workspace();
        let mut coefficients = self.exact.coefficient_buffer();
        let mut value = |q: f64| {
            let evaluated = self
                .exact
                .coefficients(q, &mut workspace, &mut coefficients);
            evaluated.ok()?;
            let value = *(self.quantities)(&coefficients).get(k)?;
            Some(of(value)).filter(|value| value.is_finite())
        };
        highest_between(&curve, &mut value).unwrap_or([f64::NAN; 2])
    }

    /// The smallest and the largest value of each curve.
    pub(crate) fn extremes(&self) -> ExtremeValues {
        let of_curve = |k: usize| {
            let [at, value] = self.highest(k, |v| -v);
            [[at, -value], self.highest(k, |v| v)]
        };
        (0..self.curves.len()).flat_map(of_curve).collect()
    }

    /// The largest magnitude of each curve, each at its own index, without a search between positions.
    pub(crate) fn largest(&self, indices: &[usize]) -> ExtremeValues {
        let count = indices.iter().max().map_or(0, |last| last + 1);
        let mut all = vec![[f64::NAN; 2]; count];
        for (k, &index) in indices.iter().enumerate() {
            all[index] = self.highest(k, f64::abs);
        }
        all
    }
}
