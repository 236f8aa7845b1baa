//! Extremes of curves over the range of a mechanism of one degree of freedom, also between the positions of `dwell reduce`.

use crate::explain::{StudyError, explain_model, explain_position};
use crate::models::exact_model;
use crate::trajectory::compute::{Point, default_limits, highest_between};
use dwell_kinetostatics::{Coefficients, ExactModel, Model, ReducedModel};
use dwell_scene::Scene;

/// Intervals of the range at which the curves are evaluated, those of `dwell reduce`; and the local extrema of them about
/// which the largest and smallest values are looked for between these positions.
const INTERVALS: usize = 720;
const REFINED: usize = 2;

/// Values with the coordinates at which they occur.
pub(super) type ExtremeValues = Vec<Point>;

/// The quantities of a curve, from the coefficients at a position.
type Quantities = Box<dyn Fn(&Coefficients) -> Vec<f64>>;

/// Curves over the range.
pub(super) struct RangeCurves {
    exact: ExactModel,
    quantities: Quantities,
    curves: Vec<Vec<Point>>,
}

impl RangeCurves {
    /// m and ½m′.
    ///
    /// # Errors
    /// [`StudyError`] where the mechanism has not one actuator or a position cannot be assembled.
    pub(super) fn of_inertia(scene: &Scene, model: &Model) -> Result<Self, StudyError> {
        let exact = exact_model(scene, model.without_reactions())?;
        Self::new(scene, exact, Box::new(|at| vec![at.m, at.half_dm]))
    }

    /// Some reactions in the free rotation without loads, by their index in the model: R = a q̈ + b q̇² with
    /// q̈ = −½m′ q̇²/m and q̇² = 2E/m, E being the `energy`, J.
    ///
    /// # Errors
    /// As [`of_inertia`](Self::of_inertia).
    pub(super) fn of_free_reactions(
        scene: &Scene,
        model: &Model,
        indices: &[usize],
        energy: f64,
    ) -> Result<Self, StudyError> {
        let all = model.reactions();
        let wanted: Vec<_> = indices
            .iter()
            .filter_map(|&k| all.get(k).copied())
            .collect();
        let with_reactions = model.clone().with_reactions(&wanted);
        let exact = exact_model(scene, with_reactions.map_err(|e| explain_model(scene, &e))?)?;
        let reactions = move |at: &Coefficients| {
            let (m, half_dm) = (at.m, at.half_dm);
            let pairs = at.a.iter().zip(&at.b);
            let free = pairs.map(|(a, b)| 2.0 * energy * (b - a * half_dm / m) / m);
            free.collect()
        };
        Self::new(scene, exact, Box::new(reactions))
    }

    fn new(scene: &Scene, exact: ExactModel, quantities: Quantities) -> Result<Self, StudyError> {
        let plan = exact.model().plan();
        let ([from, to], ..) = default_limits(scene, plan);
        let mut workspace = exact.workspace();
        let mut coefficients = exact.model().coefficient_buffer();
        let mut curves: Vec<Vec<Point>> = Vec::new();
        for k in 0..=INTERVALS {
            let fraction = k as f64 / INTERVALS as f64;
            let q = from * (1.0 - fraction) + to * fraction;
            let evaluated = exact.coefficients(q, &mut workspace, &mut coefficients);
            evaluated.map_err(|e| explain_position(scene, plan, &e))?;
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
        let mut coefficients = self.exact.model().coefficient_buffer();
        let mut value = |q: f64| {
            let evaluated = self
                .exact
                .coefficients(q, &mut workspace, &mut coefficients);
            evaluated.ok()?;
            let value = *(self.quantities)(&coefficients).get(k)?;
            Some(of(value)).filter(|value| value.is_finite())
        };
        highest_between(&curve, REFINED, &mut value).unwrap_or([f64::NAN; 2])
    }

    /// Of each curve the smallest and the largest value.
    pub(super) fn extremes(&self) -> ExtremeValues {
        let of_curve = |k: usize| {
            let [at, value] = self.highest(k, |v| -v);
            [[at, -value], self.highest(k, |v| v)]
        };
        (0..self.curves.len()).flat_map(of_curve).collect()
    }

    /// Of each curve the largest magnitude, at an index of its own; between them there is nothing.
    pub(super) fn largest(&self, indices: &[usize]) -> ExtremeValues {
        let count = indices.iter().max().map_or(0, |last| last + 1);
        let mut all = vec![[f64::NAN; 2]; count];
        for (k, &index) in indices.iter().enumerate() {
            all[index] = self.highest(k, f64::abs);
        }
        all
    }
}
