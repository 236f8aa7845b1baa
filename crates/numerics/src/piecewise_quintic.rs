//! Piecewise polynomials of degree five with two continuous derivatives: the fast form of a sampled function.

use crate::sampled_curve::{SamplePositions, SampledCurve};

/// Intervals are refined until the polynomials differ from the curve by less than this fraction of its largest value or slope.
const DIFFERENCE: f64 = 1e-13;
/// Maximum number of polynomials between two positions.
const MAX_PARTS: usize = 32;
/// Where polynomials are compared with their curve, as fractions of an interval: close to the largest difference.
const COMPARED: [f64; 2] = [0.28, 0.57];
/// Approximate number of intervals compared.
const COMPARED_INTERVALS: usize = 60;

/// The derivatives of a curve that the polynomials approximate to rounding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Checked {
    /// Its value.
    Value,
    /// Its value and its slope.
    Slope,
}

/// Polynomials of degree five between nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct PiecewiseQuintic {
    /// The nodes; with a period the last is the first of the next period.
    nodes: Vec<f64>,
    period: Option<f64>,
    /// By interval: coefficients of the powers of the distance from its first node.
    coefficients: Vec<[f64; 6]>,
}

impl PiecewiseQuintic {
    /// The polynomials through a curve. A cubic curve is reproduced; a series is approximated to rounding of its
    /// largest value, or as closely as 32 polynomials per interval allow.
    pub fn through(positions: &SamplePositions, curve: &SampledCurve, checked: Checked) -> Self {
        let coarse = Self::with_parts(positions, curve, 1);
        if !matches!(curve, SampledCurve::Series(..)) {
            return coarse;
        }
        // The difference of values falls with the sixth power of the length of an interval, that of slopes with the fifth.
        let [value, slope] = coarse.differences(positions, curve);
        let (difference, power) = match checked {
            Checked::Value => (value, 6),
            Checked::Slope => (value.max(slope), 5),
        };
        let is_enough = |parts: &usize| difference < DIFFERENCE * (*parts as f64).powi(power);
        match [1, 2, 4, 8, 16].into_iter().find(is_enough) {
            Some(1) => coarse,
            parts => Self::with_parts(positions, curve, parts.unwrap_or(MAX_PARTS)),
        }
    }

    fn with_parts(positions: &SamplePositions, curve: &SampledCurve, parts: usize) -> Self {
        let period = positions.period();
        let mut ends = positions.positions().to_vec();
        ends.extend(period.map(|period| ends[0] + period));
        let part = |pair: &[f64]| {
            let [from, to] = [pair[0], pair[1]];
            (0..parts).map(move |k| from + (to - from) * k as f64 / parts as f64)
        };
        let mut nodes: Vec<f64> = ends.windows(2).flat_map(part).collect();
        nodes.push(ends[ends.len() - 1]);
        let piece = |pair: &[f64]| match curve {
            SampledCurve::Series(..) => hermite(
                pair[1] - pair[0],
                [0, 1].map(|k| positions.eval(curve, pair[k])),
            ),
            SampledCurve::Linear(_) | SampledCurve::Cubic(_) => {
                // Within the interval, because a cubic curve has two second derivatives at its ends.
                let middle = 0.5 * (pair[0] + pair[1]);
                taylor(positions, curve, [pair[0], middle, pair[1]])
            }
        };
        Self {
            coefficients: nodes.windows(2).map(piece).collect(),
            nodes,
            period,
        }
    }

    /// The largest differences of value and slope from those of a curve in some intervals, relative to the largest there.
    fn differences(&self, positions: &SamplePositions, curve: &SampledCurve) -> [f64; 2] {
        let mut largest = [[0.0_f64; 2]; 2];
        let stride = (self.coefficients.len() / COMPARED_INTERVALS).max(1);
        for pair in self.nodes.windows(2).step_by(stride) {
            for part in COMPARED {
                let x = pair[0] + part * (pair[1] - pair[0]);
                let (own, expected) = (self.eval(x).unwrap_or_default(), positions.eval(curve, x));
                for (order, [difference, size]) in largest.iter_mut().enumerate() {
                    *difference = difference.max((own[order] - expected[order]).abs());
                    *size = size.max(expected[order].abs());
                }
            }
        }
        largest.map(|[difference, size]| match difference {
            0.0 => 0.0,
            difference => difference / size,
        })
    }

    /// The first and last x where it is defined; `None` if it is periodic.
    pub fn ends(&self) -> Option<[f64; 2]> {
        let last = self.nodes.last().copied().unwrap_or(f64::NAN);
        self.period.is_none().then_some([self.nodes[0], last])
    }

    /// The centre of the interval: angles are taken within half a revolution of it.
    pub fn middle(&self) -> f64 {
        0.5 * (self.nodes[0] + self.nodes[self.nodes.len() - 1])
    }

    /// The largest absolute value and the smallest value at the nodes.
    pub fn extent(&self) -> [f64; 2] {
        let mut extent = [f64::INFINITY, f64::NEG_INFINITY];
        for [value, ..] in &self.coefficients {
            extent = [extent[0].min(*value), extent[1].max(*value)];
        }
        extent
    }

    /// The value and the first four derivatives; `None` outside the ends. A periodic function has a value everywhere.
    pub fn eval(&self, x: f64) -> Option<[f64; 5]> {
        let first = self.nodes[0];
        let x = match self.period {
            Some(period) => first + (x - first).rem_euclid(period),
            None => x,
        };
        let last = self.coefficients.len() - 1;
        if !(first..=self.nodes[last + 1]).contains(&x) {
            return None;
        }
        let k = self.nodes.partition_point(|&node| node <= x).max(1) - 1;
        let k = k.min(last);
        let u = x - self.nodes[k];
        let [c0, c1, c2, c3, c4, c5] = self.coefficients[k];
        Some([
            c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
            c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5))),
            2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5)),
            6.0 * c3 + u * (24.0 * c4 + u * 60.0 * c5),
            24.0 * c4 + u * 120.0 * c5,
        ])
    }
}

/// The polynomial with these values, slopes and second derivatives at both ends of an interval of length `h`.
fn hermite(h: f64, [[f, df, ddf], [g, dg, ddg]]: [[f64; 3]; 2]) -> [f64; 6] {
    // Difference of the end from the parabola of the start, in units of the interval.
    let value = g - f - h * df - 0.5 * h * h * ddf;
    let slope = h * (dg - df) - h * h * ddf;
    let bend = h * h * (ddg - ddf);
    let c3 = 10.0 * value - 4.0 * slope + 0.5 * bend;
    let c4 = -15.0 * value + 7.0 * slope - bend;
    let c5 = 6.0 * value - 3.0 * slope + 0.5 * bend;
    let cubed = h * h * h;
    [
        f,
        df,
        0.5 * ddf,
        c3 / cubed,
        c4 / (cubed * h),
        c5 / (cubed * h * h),
    ]
}

/// The polynomial of third degree of a curve between two nodes, from its middle.
fn taylor(
    positions: &SamplePositions,
    curve: &SampledCurve,
    [from, middle, to]: [f64; 3],
) -> [f64; 6] {
    let [value, slope, bend] = positions.eval(curve, middle);
    let quarter = 0.25 * (to - from);
    let [_, _, later] = positions.eval(curve, middle + quarter);
    let third = (later - bend) / quarter;
    let back = from - middle;
    [
        value + back * (slope + back * (0.5 * bend + back * third / 6.0)),
        slope + back * (bend + back * 0.5 * third),
        0.5 * (bend + back * third),
        third / 6.0,
        0.0,
        0.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn positions(count: usize) -> SamplePositions {
        let x = (0..count).map(|k| 0.3 + TAU * k as f64 / count as f64);
        SamplePositions::new(x.collect(), Some(TAU))
    }

    /// A series of known function: value and four derivatives anywhere, also periods away.
    #[test]
    fn polynomials_follow_a_series_and_its_derivatives() {
        let positions = positions(37);
        let f = |x: f64| 2.0 + x.sin() - 0.3 * (4.0 * x).cos();
        let curve = SampledCurve::series(
            &positions
                .positions()
                .iter()
                .map(|&x| f(x))
                .collect::<Vec<_>>(),
        );
        let found = PiecewiseQuintic::through(&positions, &curve, Checked::Slope);
        for k in 0..200 {
            let x = -9.0 + 0.1 * f64::from(k);
            let expected = [
                f(x),
                x.cos() + 1.2 * (4.0 * x).sin(),
                -x.sin() + 4.8 * (4.0 * x).cos(),
                -x.cos() - 19.2 * (4.0 * x).sin(),
            ];
            let at = found.eval(x).unwrap();
            for (order, tolerance) in [1e-13, 3e-11, 1e-8, 3e-6].into_iter().enumerate() {
                let difference = (at[order] - expected[order]).abs();
                assert!(difference < tolerance, "{x} {order}: {difference:e}");
            }
        }
    }

    /// A cubic curve of unequal intervals is its own polynomials, and ends where its positions end.
    #[test]
    fn polynomials_of_a_cubic_curve_are_its_own() {
        let x = vec![0.0, 0.5, 1.25, 1.5, 2.0];
        let positions = SamplePositions::new(x.clone(), None);
        let curve = positions.cubic(x.iter().map(|x| x * x * x - x).collect());
        let found = PiecewiseQuintic::through(&positions, &curve, Checked::Slope);
        for k in 0..=200 {
            let x = 0.01 * f64::from(k);
            let [value, slope, ..] = found.eval(x).unwrap();
            let [expected, expected_slope, _] = positions.eval(&curve, x);
            assert!((value - expected).abs() < 1e-14, "{x}: {value} {expected}");
            assert!((slope - expected_slope).abs() < 1e-13, "{x}");
        }
        assert_eq!(found.eval(2.01), None);
        assert_eq!(found.ends(), Some([0.0, 2.0]));
    }
}
