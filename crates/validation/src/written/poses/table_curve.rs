//! The curve through the points of a table of the scene: a spline by a dense system of its second derivatives, a monotone
//! curve after Fritsch and Butland (1984), straight lines, or steps.

use super::jet::Jet;
use super::law::number;
use toml::{Table, Value};

/// Points, and the slope at both ends of each piece.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TableCurve {
    points: Vec<[f64; 2]>,
    slopes: Vec<[f64; 2]>,
    is_step: bool,
    is_spline: bool,
}

impl TableCurve {
    /// The curve of a table with the units of its variable and value; `usual` is its interpolation if it names none.
    pub(crate) fn read(table: &Table, usual: &str, units: [f64; 2]) -> Option<Self> {
        let Value::Array(rows) = table.get("table")? else {
            return None;
        };
        let point = |row: &Value| {
            let row = row.as_array()?;
            let of = |k: usize| Some(number(row.get(k))? * units[k]);
            Some([of(0)?, of(1)?])
        };
        let points: Vec<[f64; 2]> = rows.iter().map(point).collect::<Option<_>>()?;
        if points.len() < 2 {
            return None;
        }
        let interpolation = table.get("interpolation").and_then(Value::as_str);
        let interpolation = interpolation.unwrap_or(usual);
        let secants = points.windows(2).map(secant);
        let slopes = match interpolation {
            "spline" => pieces(&spline_slopes(&points)?),
            "monotone" => pieces(&monotone_slopes(&points)),
            _ => secants.map(|slope| [slope; 2]).collect(),
        };
        Some(Self {
            points,
            slopes,
            is_step: interpolation == "step",
            is_spline: interpolation == "spline",
        })
    }

    /// The points.
    pub(crate) fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// The x of the points.
    pub(crate) fn knots(&self) -> Vec<f64> {
        self.points.iter().map(|p| p[0]).collect()
    }

    /// Whether its second derivative is continuous.
    pub(crate) fn is_spline(&self) -> bool {
        self.is_spline
    }

    /// The cubic of Hermite in its piece; none outside the table.
    pub(crate) fn at(&self, x: Jet) -> Option<Jet> {
        let last = self.points.last()?[0];
        let at = x.value();
        if !(self.points[0][0] <= at && at <= last) {
            return None;
        }
        let piece = self
            .points
            .partition_point(|p| p[0] <= at)
            .clamp(1, self.slopes.len())
            - 1;
        let [[x0, y0], [x1, y1]] = [self.points[piece], self.points[piece + 1]];
        let of = Jet::constant;
        if self.is_step {
            return Some(of(if at == last { y1 } else { y0 }));
        }
        let h = x1 - x0;
        let u = (x - of(x0)) / of(h);
        let rest = of(1.0) - u;
        let [m0, m1] = self.slopes[piece];
        Some(
            rest * rest * (of(1.0) + of(2.0) * u) * of(y0)
                + u * u * (of(3.0) - of(2.0) * u) * of(y1)
                + of(h) * u * rest * (rest * of(m0) - u * of(m1)),
        )
    }
}

fn secant(pair: &[[f64; 2]]) -> f64 {
    (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0])
}

fn pieces(slopes: &[f64]) -> Vec<[f64; 2]> {
    slopes.windows(2).map(|s| [s[0], s[1]]).collect()
}

/// Slopes of the cubic spline that is not-a-knot at both ends: second derivatives of neighbouring pieces agree at every
/// inner point, third derivatives at the second and the last but one.
fn spline_slopes(points: &[[f64; 2]]) -> Option<Vec<f64>> {
    let n = points.len();
    let steps: Vec<f64> = points.windows(2).map(|p| p[1][0] - p[0][0]).collect();
    let secants: Vec<f64> = points.windows(2).map(secant).collect();
    if n == 2 {
        return Some(vec![secants[0]; 2]);
    }
    if n == 3 {
        let bend = (secants[1] - secants[0]) / (steps[0] + steps[1]);
        let middle = secants[0] + bend * steps[0];
        return Some(vec![
            secants[0] - bend * steps[0],
            middle,
            secants[1] + bend * steps[1],
        ]);
    }
    let mut rows = vec![vec![0.0; n + 1]; n];
    for i in 1..n - 1 {
        let [h, k] = [steps[i - 1], steps[i]];
        rows[i][i - 1] = 1.0 / h;
        rows[i][i] = 2.0 / h + 2.0 / k;
        rows[i][i + 1] = 1.0 / k;
        rows[i][n] = 3.0 * (secants[i - 1] / h + secants[i] / k);
    }
    // The third derivative of a piece is 6 (m₀ + m₁ − 2 secant)/h².
    for (row, [i, j]) in [(0, [0, 1]), (n - 1, [n - 3, n - 2])] {
        for (piece, sign) in [(i, 1.0), (j, -1.0)] {
            let weight = sign / (steps[piece] * steps[piece]);
            rows[row][piece] += weight;
            rows[row][piece + 1] += weight;
            rows[row][n] += 2.0 * weight * secants[piece];
        }
    }
    solve(rows)
}

/// Gauss's elimination with the largest pivots; the right side is the last column.
pub(crate) fn solve(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let n = rows.len();
    for column in 0..n {
        let size = |row: &usize| rows[*row][column].abs();
        let pivot = (column..n).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        rows.swap(column, pivot);
        let pivot_row = rows[column].clone();
        if pivot_row[column] == 0.0 {
            return None;
        }
        for (_, row) in rows.iter_mut().enumerate().filter(|(k, _)| *k != column) {
            let factor = row[column] / pivot_row[column];
            let pairs = row.iter_mut().zip(&pivot_row);
            pairs.for_each(|(x, p)| *x -= factor * p);
        }
    }
    Some((0..n).map(|k| rows[k][n] / rows[k][k]).collect())
}

/// Weighted harmonic means of the neighbouring secants; at the ends a parabola's slope that keeps the rise.
fn monotone_slopes(points: &[[f64; 2]]) -> Vec<f64> {
    let n = points.len();
    let secants: Vec<f64> = points.windows(2).map(secant).collect();
    let steps: Vec<f64> = points.windows(2).map(|p| p[1][0] - p[0][0]).collect();
    if n == 2 {
        return vec![secants[0]; 2];
    }
    let end = |near: usize, next: usize| {
        let [h, k, s, t] = [steps[near], steps[next], secants[near], secants[next]];
        let slope = s + (s - t) * h / (h + k);
        if slope * s <= 0.0 {
            0.0
        } else if s * t <= 0.0 && slope.abs() > 3.0 * s.abs() {
            3.0 * s
        } else {
            slope
        }
    };
    let inner = |i: usize| {
        let [h, k, s, t] = [steps[i - 1], steps[i], secants[i - 1], secants[i]];
        if s * t <= 0.0 {
            0.0
        } else {
            3.0 * (h + k) / ((2.0 * k + h) / s + (k + 2.0 * h) / t)
        }
    };
    let mut slopes = vec![end(0, 1)];
    slopes.extend((1..n - 1).map(inner));
    slopes.push(end(n - 2, n - 3));
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(text: &str) -> TableCurve {
        let table: Table = text.parse().expect("a table");
        TableCurve::read(&table, "spline", [1.0, 1.0]).expect("a curve")
    }

    /// Not-a-knot splines reproduce cubics, and three points a parabola.
    #[test]
    fn splines_reproduce_cubics() {
        let cubic = |x: f64| x * x * x - 2.0 * x + 0.5;
        let points = [0.0, 0.4, 1.0, 1.3, 2.0].map(|x| format!("[{x}, {}]", cubic(x)));
        let of = curve(&format!("table = [{}]", points.join(", ")));
        let parabola = curve("table = [[0, 0], [1, 1], [3, 9]]");
        for x in [0.0, 0.2, 0.7, 1.2, 1.9, 2.0] {
            let found = of.at(Jet([x, 1.0, 0.0])).expect("inside").0;
            let expected = [cubic(x), 3.0 * x * x - 2.0, 6.0 * x];
            assert!(
                (0..3).all(|k| (found[k] - expected[k]).abs() < 1e-12),
                "{found:?}"
            );
            let found = parabola.at(Jet([x, 1.0, 0.0])).expect("inside").0;
            assert!((found[0] - x * x).abs() < 1e-12 && (found[2] - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn other_curves_keep_between_their_points() {
        let text = "table = [[0, 1], [1, 2], [2, 2], [3, 0]]\ninterpolation = ";
        for (kind, at_half, at_end) in [("\"linear\"", 1.5, 0.0), ("\"step\"", 1.0, 0.0)] {
            let of = curve(&format!("{text}{kind}"));
            assert_eq!(of.at(Jet::constant(0.5)).map(Jet::value), Some(at_half));
            assert_eq!(of.at(Jet::constant(3.0)).map(Jet::value), Some(at_end));
            assert_eq!(of.at(Jet::constant(3.1)), None);
        }
        let of = curve(&format!("{text}\"monotone\""));
        assert!(of.at(Jet::constant(1.4)).is_some_and(|y| y.value() == 2.0));
    }
}
