//! The reduced model between the positions of two exported runs.

use super::combine::ExportedRuns;
use dwell_geometry::{PositionError, Range};
use dwell_kinetostatics::{Coefficients, Inertia, ReducedModel};
use std::f64::consts::TAU;

/// How values between positions are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleInterpolation {
    /// Straight lines: m and ½m′ each by itself, as a table is usually read.
    Linear,
    /// Cubic polynomials with given slopes: of m twice ½m′, otherwise by differences of fourth order.
    Cubic,
    /// A trigonometric series over a whole revolution at equal distances: m from the integral of ½m′ and its own mean.
    Trigonometric,
}

impl SampleInterpolation {
    /// Trigonometric over a whole revolution at equal distances, otherwise cubic.
    pub fn best_for(runs: &ExportedRuns) -> Self {
        match runs.is_whole_revolution {
            true => Self::Trigonometric,
            false => Self::Cubic,
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

/// A function with two derivatives.
#[derive(Debug, Clone, PartialEq)]
enum Curve {
    Linear(Vec<f64>),
    /// Values and slopes.
    Cubic(Vec<[f64; 2]>),
    /// The mean, then the coefficients of cos and sin of each multiple.
    Series(f64, Vec<[f64; 2]>),
}

/// A reduced model that is known at positions.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledModel {
    q: Vec<f64>,
    period: Option<f64>,
    /// m, ½m′, every a, every b.
    curves: Vec<Curve>,
    reactions: usize,
}

impl SampledModel {
    /// The model through the positions of two runs, or through every `stride`-th of them.
    pub fn new(runs: &ExportedRuns, interpolation: SampleInterpolation, stride: usize) -> Self {
        let rows: Vec<usize> = (0..runs.q.len()).step_by(stride.max(1)).collect();
        let q: Vec<f64> = rows.iter().map(|&k| runs.q[k]).collect();
        let period = runs.is_whole_revolution.then_some(TAU);
        let column = |of: &dyn Fn(&Coefficients) -> f64| -> Vec<f64> {
            rows.iter().map(|&k| of(&runs.coefficients[k])).collect()
        };
        let (m, half_dm) = (column(&|c| c.m), column(&|c| c.half_dm));
        let plain = |values: Vec<f64>| match interpolation {
            SampleInterpolation::Linear => Curve::Linear(values),
            SampleInterpolation::Cubic => {
                let slopes = slopes(&q, &values, period);
                Curve::Cubic(
                    values
                        .into_iter()
                        .zip(slopes)
                        .map(<[f64; 2]>::from)
                        .collect(),
                )
            }
            SampleInterpolation::Trigonometric => series(&values),
        };
        let mut curves = match interpolation {
            SampleInterpolation::Linear => vec![plain(m), plain(half_dm)],
            SampleInterpolation::Cubic => {
                let both = m.iter().zip(&half_dm).map(|(m, half)| [*m, 2.0 * half]);
                let m = Curve::Cubic(both.collect());
                vec![m, plain(half_dm)]
            }
            SampleInterpolation::Trigonometric => {
                let half_dm = series(&half_dm);
                vec![integral(&half_dm, &m), half_dm]
            }
        };
        let reactions = runs.reactions.len();
        curves.extend((0..reactions).map(|r| plain(column(&|c| c.a[r]))));
        curves.extend((0..reactions).map(|r| plain(column(&|c| c.b[r]))));
        Self {
            q,
            period,
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
        Ok(self
            .curves
            .iter()
            .map(|curve| self.eval(curve, q)[0])
            .collect())
    }

    fn within(&self, q: f64) -> Result<f64, PositionError> {
        let (first, last) = (self.q[0], self.q[self.q.len() - 1]);
        match self.period {
            Some(period) => Ok(first + (q - first).rem_euclid(period)),
            None if (first..=last).contains(&q) => Ok(q),
            None => Err(PositionError::NoAssembly {
                group: 0,
                q,
                gap: f64::NAN,
            }),
        }
    }

    /// Value, first and second derivative.
    fn eval(&self, curve: &Curve, q: f64) -> [f64; 3] {
        let k = self.q.partition_point(|&x| x <= q).max(1) - 1;
        let next = (k + 1) % self.q.len();
        let (k, next) = match (self.period, next) {
            (None, 0) => (k - 1, k),
            _ => (k, next),
        };
        let from = self.q[k];
        let to = if next > k {
            self.q[next]
        } else {
            self.q[0] + self.period.unwrap_or(0.0)
        };
        let (h, u) = (to - from, (q - from) / (to - from));
        match curve {
            Curve::Linear(values) => {
                let slope = (values[next] - values[k]) / h;
                [values[k] + slope * (q - from), slope, 0.0]
            }
            Curve::Cubic(points) => {
                let ([f, df], [g, dg]) = (points[k], points[next]);
                let (rise, bend) = (g - f, h * (df + dg));
                let (c2, c3) = (3.0 * rise - h * df - bend, bend - 2.0 * rise);
                [
                    f + u * (h * df + u * (c2 + u * c3)),
                    (h * df + u * (2.0 * c2 + 3.0 * u * c3)) / h,
                    (2.0 * c2 + 6.0 * u * c3) / (h * h),
                ]
            }
            Curve::Series(mean, terms) => {
                let (sin, cos) = (q - self.q[0]).sin_cos();
                let mut turned = [1.0, 0.0];
                let mut sum = [*mean, 0.0, 0.0];
                for (k, [a, b]) in terms.iter().enumerate() {
                    let [c, s] = turned;
                    turned = [c * cos - s * sin, s * cos + c * sin];
                    let ([c, s], k) = (turned, (k + 1) as f64);
                    let value = a * c + b * s;
                    sum[0] += value;
                    sum[1] += k * (b * c - a * s);
                    sum[2] -= k * k * value;
                }
                sum
            }
        }
    }

    /// The largest coefficients of the last eighth of the series of each function, summed: what the series leaves out is of
    /// that size; zero without series.
    pub(super) fn tails(&self) -> Vec<f64> {
        let tail = |curve: &Curve| match curve {
            Curve::Series(_, terms) => {
                let last = &terms[terms.len() - terms.len().div_ceil(8)..];
                last.iter().map(|[a, b]| a.hypot(*b)).sum()
            }
            Curve::Linear(_) | Curve::Cubic(_) => 0.0,
        };
        self.curves.iter().map(tail).collect()
    }
}

/// Slopes by differences of fourth order over equal steps around, otherwise by parabolas.
fn slopes(q: &[f64], values: &[f64], period: Option<f64>) -> Vec<f64> {
    let count = q.len();
    let at = |k: isize| -> Option<[f64; 2]> {
        let n = isize::try_from(count).ok()?;
        let wrapped = usize::try_from(k.rem_euclid(n)).ok()?;
        match (period, (0..n).contains(&k)) {
            (_, true) => Some([q[wrapped], values[wrapped]]),
            (Some(period), false) => Some([
                q[wrapped] + period * k.div_euclid(n) as f64,
                values[wrapped],
            ]),
            (None, false) => None,
        }
    };
    let slope = |k: isize| {
        let near: Vec<[f64; 2]> = (-2..=2).filter_map(|d| at(k + d)).collect();
        let [x, _] = at(k).unwrap_or([0.0; 2]);
        // The derivative at x of the polynomial through the points.
        let of = |i: usize| -> f64 {
            let others = |skip: usize| (0..near.len()).filter(move |&j| j != i && j != skip);
            let denominator: f64 = others(i).map(|j| near[i][0] - near[j][0]).product();
            let sum: f64 = others(i)
                .map(|j| others(j).map(|l| x - near[l][0]).product::<f64>())
                .sum();
            near[i][1] * sum / denominator
        };
        (0..near.len()).map(of).sum()
    };
    (0..count)
        .map(|k| slope(isize::try_from(k).unwrap_or(0)))
        .collect()
}

/// The trigonometric series through values at equal distances over a revolution.
fn series(values: &[f64]) -> Curve {
    let count = values.len();
    let mean = values.iter().sum::<f64>() / count as f64;
    let table: Vec<[f64; 2]> = (0..count)
        .map(|j| (TAU * j as f64 / count as f64).sin_cos())
        .map(|(s, c)| [c, s])
        .collect();
    let term = |k: usize| {
        let mut sum = [0.0; 2];
        for (j, value) in values.iter().enumerate() {
            let [c, s] = table[(j * k) % count];
            sum = [sum[0] + value * c, sum[1] + value * s];
        }
        // Of an even number of values the last cosine is met twice.
        let share = if 2 * k == count { 1.0 } else { 2.0 } / count as f64;
        [
            sum[0] * share,
            if 2 * k == count { 0.0 } else { sum[1] * share },
        ]
    };
    Curve::Series(mean, (1..=count / 2).map(term).collect())
}

/// Twice the integral of a series, with the mean of these values. The mean of the slope is not that of a periodic function.
fn integral(slope: &Curve, values: &[f64]) -> Curve {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let Curve::Series(_, terms) = slope else {
        return series(values);
    };
    let integrated = terms.iter().enumerate().map(|(k, [a, b])| {
        let k = (k + 1) as f64;
        [-2.0 * b / k, 2.0 * a / k]
    });
    Curve::Series(mean, integrated.collect())
}

impl ReducedModel for SampledModel {
    type Workspace = ();

    fn workspace(&self) {}

    fn reactions(&self) -> usize {
        self.reactions
    }

    fn range(&self) -> Range {
        match self.period {
            Some(_) => Range::Full,
            None => Range::Unresolved(self.q[0], self.q[self.q.len() - 1]),
        }
    }

    fn inertia(&self, q: f64, (): &mut ()) -> Result<(f64, f64), PositionError> {
        self.inertia_derivatives(q, &mut ())
            .map(|at| (at.m, at.half_dm))
    }

    fn inertia_derivatives(&self, q: f64, (): &mut ()) -> Result<Inertia, PositionError> {
        let q = self.within(q)?;
        let [m, slope, bend] = self.eval(&self.curves[0], q);
        Ok(match &self.curves[0] {
            // Straight lines of m have steps for a slope: ½m′ is a line of its own.
            Curve::Linear(_) => {
                let [half_dm, half_ddm, _] = self.eval(&self.curves[1], q);
                Inertia {
                    m,
                    half_dm,
                    half_ddm,
                }
            }
            Curve::Cubic(_) | Curve::Series(..) => Inertia {
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
        let of = |curves: &[Curve]| curves.iter().map(|curve| self.eval(curve, q)[0]).collect();
        (out.m, out.half_dm) = (m, half_dm);
        out.a = of(&self.curves[2..2 + self.reactions]);
        out.b = of(&self.curves[2 + self.reactions..]);
        Ok(())
    }
}
