//! The reduced model between the positions of two exported runs.

use super::combine::ExportedRuns;
use dwell_geometry::{PositionError, Range};
use dwell_kinetostatics::{Coefficients, Inertia, ReducedModel};
use dwell_numerics::{SamplePositions, SampledCurve};
use std::f64::consts::TAU;

/// How values between positions are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleInterpolation {
    /// Straight lines: m and ½m′ are interpolated separately, as tables usually are.
    Linear,
    /// Cubic polynomials with given slopes: of m twice ½m′, otherwise by differences of fourth order.
    Cubic,
    /// A trigonometric series over a whole revolution at equal distances: m from the integral of ½m′ and its own mean.
    Trigonometric,
}

impl SampleInterpolation {
    /// Trigonometric over a whole revolution at equal distances, otherwise cubic.
    pub fn best_for(runs: &ExportedRuns) -> Self {
        if runs.is_whole_revolution {
            Self::Trigonometric
        } else {
            Self::Cubic
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Cubic => "cubic",
            Self::Trigonometric => "trigonometric",
        }
    }
}

/// A reduced model that is known at positions.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledModel {
    positions: SamplePositions,
    /// m, ½m′, every a, every b.
    curves: Vec<SampledCurve>,
    reactions: usize,
}

impl SampledModel {
    /// The model through the positions of two runs, or through every `stride`-th of them.
    pub fn new(runs: &ExportedRuns, interpolation: SampleInterpolation, stride: usize) -> Self {
        let rows: Vec<usize> = (0..runs.q.len()).step_by(stride.max(1)).collect();
        let q = rows.iter().map(|&k| runs.q[k]).collect();
        let positions = SamplePositions::new(q, runs.is_whole_revolution.then_some(TAU));
        let column = |of: &dyn Fn(&Coefficients) -> f64| -> Vec<f64> {
            rows.iter().map(|&k| of(&runs.coefficients[k])).collect()
        };
        let (m, half_dm) = (column(&|c| c.m), column(&|c| c.half_dm));
        let plain = |values: Vec<f64>| match interpolation {
            SampleInterpolation::Linear => SampledCurve::Linear(values),
            SampleInterpolation::Cubic => positions.cubic(values),
            SampleInterpolation::Trigonometric => SampledCurve::series(&values),
        };
        let m = match interpolation {
            SampleInterpolation::Linear => plain(m),
            SampleInterpolation::Cubic => {
                let both = m.iter().zip(&half_dm).map(|(m, half)| [*m, 2.0 * half]);
                SampledCurve::Cubic(both.collect())
            }
            SampleInterpolation::Trigonometric => {
                SampledCurve::integral_of_twice(&plain(half_dm.clone()), &m)
            }
        };
        let mut curves = vec![m, plain(half_dm)];
        let reactions = runs.reactions.len();
        curves.extend((0..reactions).map(|r| plain(column(&|c| c.a[r]))));
        curves.extend((0..reactions).map(|r| plain(column(&|c| c.b[r]))));
        Self {
            positions,
            curves,
            reactions,
        }
    }

    /// All coefficients at a coordinate: m, ½m′, every a, every b.
    ///
    /// # Errors
    /// [`PositionError`] outside the positions.
    pub fn values(&self, q: f64) -> Result<Vec<f64>, PositionError> {
        let q = self.within(q)?;
        let curves = self.curves.iter();
        Ok(curves
            .map(|curve| self.positions.eval(curve, q)[0])
            .collect())
    }

    /// One coefficient of [`Self::values`], without evaluating the others.
    #[cfg(feature = "output")]
    pub(super) fn value(&self, q: f64, index: usize) -> Option<f64> {
        let (q, curve) = (self.within(q).ok()?, self.curves.get(index)?);
        Some(self.positions.eval(curve, q)[0])
    }

    fn within(&self, q: f64) -> Result<f64, PositionError> {
        let [from, to] = self.positions.ends();
        let within = self.positions.within(q);
        within.ok_or(PositionError::OutOfRange { q, from, to })
    }

    /// The largest coefficients of the last eighth of the series of each function, summed, as an estimate of the truncation
    /// error; zero without series.
    pub(super) fn tails(&self) -> Vec<f64> {
        self.curves.iter().map(SampledCurve::tail).collect()
    }
}

impl ReducedModel for SampledModel {
    type Workspace = ();

    fn workspace(&self) {}

    fn reactions(&self) -> usize {
        self.reactions
    }

    fn range(&self) -> Range {
        let [from, to] = self.positions.ends();
        match self.positions.period() {
            Some(_) => Range::Full,
            None => Range::Unresolved(from, to),
        }
    }

    fn inertia(&self, q: f64, (): &mut ()) -> Result<(f64, f64), PositionError> {
        self.inertia_derivatives(q, &mut ())
            .map(|at| (at.m, at.half_dm))
    }

    fn inertia_derivatives(&self, q: f64, (): &mut ()) -> Result<Inertia, PositionError> {
        let q = self.within(q)?;
        let [m, slope, bend] = self.positions.eval(&self.curves[0], q);
        Ok(match &self.curves[0] {
            // Straight lines of m have steps for a slope: ½m′ is a line of its own.
            SampledCurve::Linear(_) => {
                let [half_dm, half_ddm, _] = self.positions.eval(&self.curves[1], q);
                Inertia {
                    m,
                    half_dm,
                    half_ddm,
                }
            }
            SampledCurve::Cubic(_) | SampledCurve::Series(..) => Inertia {
                m,
                half_dm: 0.5 * slope,
                half_ddm: 0.5 * bend,
            },
        })
    }

    fn coefficients(
        &self,
        q: f64,
        (): &mut (),
        out: &mut Coefficients,
    ) -> Result<(), PositionError> {
        let Inertia { m, half_dm, .. } = self.inertia_derivatives(q, &mut ())?;
        let q = self.within(q)?;
        let of = |curves: &[SampledCurve]| {
            curves
                .iter()
                .map(|curve| self.positions.eval(curve, q)[0])
                .collect()
        };
        (out.m, out.half_dm) = (m, half_dm);
        out.a = of(&self.curves[2..2 + self.reactions]);
        out.b = of(&self.curves[2 + self.reactions..]);
        Ok(())
    }
}
