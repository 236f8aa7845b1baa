//! Functions sampled at positions, interpolated by straight lines, cubic polynomials or a trigonometric series.

use std::f64::consts::TAU;

/// The last terms of a series are omitted as long as their sum is below this fraction of the largest value.
const ROUNDING: f64 = 1e-17;

/// The positions at which functions are sampled, in ascending order.
#[derive(Debug, Clone, PartialEq)]
pub struct SamplePositions {
    x: Vec<f64>,
    period: Option<f64>,
}

/// An interpolated function.
#[derive(Debug, Clone, PartialEq)]
pub enum SampledCurve {
    /// Straight lines between the values.
    Linear(Vec<f64>),
    /// Cubic polynomials between values with slopes.
    Cubic(Vec<[f64; 2]>),
    /// The mean, then the coefficients of the cosine and the sine of each multiple of the angle from the first position.
    Series(f64, Vec<[f64; 2]>),
}

impl SamplePositions {
    /// Two positions or more, in ascending order; with a period, the last is below the first of the next period.
    pub fn new(x: Vec<f64>, period: Option<f64>) -> Self {
        Self { x, period }
    }

    /// The first and the last position.
    pub fn ends(&self) -> [f64; 2] {
        [self.x[0], self.x[self.x.len() - 1]]
    }

    /// The positions.
    pub fn positions(&self) -> &[f64] {
        &self.x
    }

    /// The period, if the functions repeat.
    pub fn period(&self) -> Option<f64> {
        self.period
    }

    /// `x` moved into the range of the positions by whole periods; `None` beyond their ends.
    pub fn within(&self, x: f64) -> Option<f64> {
        let [first, last] = self.ends();
        match self.period {
            Some(period) => Some(first + (x - first).rem_euclid(period)),
            None => (first..=last).contains(&x).then_some(x),
        }
    }

    /// The positions on both sides of `x`, and the indices of their values.
    fn interval(&self, x: f64) -> ([usize; 2], [f64; 2]) {
        let count = self.x.len();
        let k = self.x.partition_point(|&at| at <= x).max(1) - 1;
        match (self.period, k + 1 == count) {
            (Some(period), true) => ([k, 0], [self.x[k], self.x[0] + period]),
            (None, true) => ([k - 1, k], [self.x[k - 1], self.x[k]]),
            (_, false) => ([k, k + 1], [self.x[k], self.x[k + 1]]),
        }
    }

    /// Cubic polynomials through values, with slopes by fourth-order differences, and by parabolas at the ends.
    pub fn cubic(&self, values: Vec<f64>) -> SampledCurve {
        let slopes = self.slopes(&values);
        let both = values.into_iter().zip(slopes);
        SampledCurve::Cubic(both.map(<[f64; 2]>::from).collect())
    }

    /// Value, first and second derivative of a curve.
    pub fn eval(&self, curve: &SampledCurve, x: f64) -> [f64; 3] {
        match curve {
            SampledCurve::Linear(values) => {
                let ([k, next], [from, to]) = self.interval(x);
                let slope = (values[next] - values[k]) / (to - from);
                [values[k] + slope * (x - from), slope, 0.0]
            }
            SampledCurve::Cubic(points) => {
                let ([k, next], [from, to]) = self.interval(x);
                let (h, u) = (to - from, (x - from) / (to - from));
                let ([f, df], [g, dg]) = (points[k], points[next]);
                let (rise, bend) = (g - f, h * (df + dg));
                let (c2, c3) = (3.0 * rise - h * df - bend, bend - 2.0 * rise);
                [
                    f + u * (h * df + u * (c2 + u * c3)),
                    (h * df + u * (2.0 * c2 + 3.0 * u * c3)) / h,
                    (2.0 * c2 + 6.0 * u * c3) / (h * h),
                ]
            }
            SampledCurve::Series(mean, terms) => series_value(*mean, terms, x - self.x[0]),
        }
    }

    /// Slopes by fourth-order differences where the steps are equal, otherwise by the polynomial through the neighbours.
    fn slopes(&self, values: &[f64]) -> Vec<f64> {
        let count = self.x.len();
        let at = |k: isize| -> Option<[f64; 2]> {
            let n = isize::try_from(count).ok()?;
            let wrapped = usize::try_from(k.rem_euclid(n)).ok()?;
            let turns = k.div_euclid(n);
            let shift = match (self.period, turns) {
                (_, 0) => 0.0,
                (Some(period), _) => period * turns as f64,
                (None, _) => return None,
            };
            Some([self.x[wrapped] + shift, values[wrapped]])
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
        let index = |k: usize| isize::try_from(k).unwrap_or(0);
        (0..count).map(|k| slope(index(k))).collect()
    }
}

impl SampledCurve {
    /// The trigonometric series through values that are equally spaced over a revolution.
    pub fn series(values: &[f64]) -> Self {
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
            // For an even number of values the last cosine is counted twice.
            let share = if 2 * k == count { 1.0 } else { 2.0 } / count as f64;
            [
                sum[0] * share,
                if 2 * k == count { 0.0 } else { sum[1] * share },
            ]
        };
        let mut terms: Vec<[f64; 2]> = (1..=count / 2).map(term).collect();
        // The omitted terms are below the rounding error of a value.
        let size = |[a, b]: &[f64; 2]| a.abs() + b.abs();
        let largest = values
            .iter()
            .fold(0.0_f64, |max, value| max.max(value.abs()));
        let mut left_out = 0.0;
        while terms.len() > 1 {
            left_out += size(&terms[terms.len() - 1]);
            if left_out > ROUNDING * largest {
                break;
            }
            terms.pop();
        }
        Self::Series(mean, terms)
    }

    /// The function whose slope is twice a series, with the mean of `values`. The mean of the slope is
    /// dropped, because the integral must be periodic.
    pub fn integral_of_twice(slope: &Self, values: &[f64]) -> Self {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let Self::Series(_, terms) = slope else {
            return Self::series(values);
        };
        let integrated = terms.iter().enumerate().map(|(k, [a, b])| {
            let k = (k + 1) as f64;
            [-2.0 * b / k, 2.0 * a / k]
        });
        Self::Series(mean, integrated.collect())
    }

    /// Sum of the largest coefficients of the last eighth of a series, an estimate of the truncation error. Zero
    /// for other curves.
    pub fn tail(&self) -> f64 {
        match self {
            Self::Series(_, terms) => {
                let last = &terms[terms.len() - terms.len().div_ceil(8)..];
                last.iter().map(|[a, b]| a.hypot(*b)).sum()
            }
            Self::Linear(_) | Self::Cubic(_) => 0.0,
        }
    }
}

/// Value, first and second derivative of a series at an angle.
fn series_value(mean: f64, terms: &[[f64; 2]], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    let mut turned = [1.0, 0.0];
    let mut sum = [mean, 0.0, 0.0];
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
