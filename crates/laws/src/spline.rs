//! A table of points, and the curve through them.

use crate::error::LawError;

/// The curve between the points of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// A cubic spline: value, first and second derivative are continuous. It overshoots points that change
    /// abruptly.
    #[default]
    Spline,
    /// Cubic pieces that rise where the points rise and fall where they fall: never beyond neighbouring points. Value and
    /// first derivative are continuous (F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5, 1984).
    Monotone,
    /// Straight lines.
    Linear,
    /// The value of the previous point.
    Step,
}

impl Interpolation {
    /// All of them, with their names in scenes.
    pub const ALL: [(&'static str, Self); 4] = [
        ("spline", Self::Spline),
        ("monotone", Self::Monotone),
        ("linear", Self::Linear),
        ("step", Self::Step),
    ];
}

/// The curve through the points of a table: cubic or lower between two points, as [`Interpolation`] says.
///
/// At its ends a spline is *not-a-knot*: the first two pieces are one cubic, and so the last two (C. de
/// Boor, *A Practical Guide to Splines*, chapter IV). So it reproduces every cubic, and is as
/// exact at the ends as elsewhere. A natural spline would bend every motion and force to zero
/// curvature there. Three points make a parabola, two a line.
///
/// Outside its [`range`](Self::range) a spline or a line continues along the tangent of its end, so that the velocity of a motion does not
/// jump. Monotone and stepped curves keep the value of their end.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    /// The x at which the pieces begin, and the end of the last.
    knots: Vec<f64>,
    /// By piece: its Taylor polynomial at its beginning, value first. The last entry is the tangent
    /// at the end.
    pieces: Vec<[f64; 4]>,
    interpolation: Interpolation,
}

impl Spline {
    /// The cubic spline through `points`, each x and y, in SI units.
    ///
    /// # Errors
    /// As [`Spline::interpolating`].
    pub fn through(points: &[[f64; 2]]) -> Result<Self, LawError> {
        Self::interpolating(points, Interpolation::Spline)
    }

    /// The curve through `points`, each x and y, in SI units.
    ///
    /// # Errors
    /// [`LawError::TooFewPoints`], [`LawError::PointNotFinite`], [`LawError::NotAscending`],
    /// [`LawError::TooSteep`].
    pub fn interpolating(
        points: &[[f64; 2]],
        interpolation: Interpolation,
    ) -> Result<Self, LawError> {
        check(points)?;
        let steps: Vec<f64> = points.windows(2).map(|p| p[1][0] - p[0][0]).collect();
        let slopes: Vec<f64> = points
            .windows(2)
            .zip(&steps)
            .map(|(p, h)| (p[1][1] - p[0][1]) / h)
            .collect();
        if let Some(before) = (0..steps.len()).find(|&i| !(steps[i] + slopes[i]).is_finite()) {
            return Err(LawError::TooSteep { index: before + 1 });
        }
        let last = steps.len();
        // The second derivatives of a spline, the first of monotone pieces.
        let derivatives = match interpolation {
            Interpolation::Spline => second_derivatives(&steps, &slopes),
            Interpolation::Monotone => monotone_tangents(&steps, &slopes),
            Interpolation::Linear | Interpolation::Step => Vec::new(),
        };
        let mut pieces = Vec::with_capacity(points.len());
        for (i, (&h, &slope)) in steps.iter().zip(&slopes).enumerate() {
            let value = points[i][1];
            let piece = match interpolation {
                Interpolation::Spline => {
                    let [m, n] = [derivatives[i], derivatives[i + 1]];
                    let tangent = slope - h * (2.0 * m + n) / 6.0;
                    [value, tangent, 0.5 * m, (n - m) / (6.0 * h)]
                }
                Interpolation::Monotone => {
                    let [m, n] = [derivatives[i], derivatives[i + 1]];
                    let third = (m + n - 2.0 * slope) / (h * h);
                    [value, m, (3.0 * slope - 2.0 * m - n) / h, third]
                }
                Interpolation::Linear => [value, slope, 0.0, 0.0],
                Interpolation::Step => [value, 0.0, 0.0, 0.0],
            };
            if !piece.iter().all(|c| c.is_finite()) {
                return Err(LawError::TooSteep { index: i + 1 });
            }
            pieces.push(piece);
        }
        let (h, slope) = (steps[last - 1], slopes[last - 1]);
        let end = match interpolation {
            Interpolation::Spline => {
                slope + h * (derivatives[last - 1] + 2.0 * derivatives[last]) / 6.0
            }
            Interpolation::Linear => slope,
            Interpolation::Monotone | Interpolation::Step => 0.0,
        };
        pieces.push([points[last][1], end, 0.0, 0.0]);
        Ok(Self {
            knots: points.iter().map(|p| p[0]).collect(),
            pieces,
            interpolation,
        })
    }

    /// The x of the points.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Whether value, first or second derivative jumps at the points.
    pub fn has_kinks(&self) -> bool {
        self.interpolation != Interpolation::Spline
    }

    /// The largest overshoot beyond the range of its points: x, the value, and the overshoot relative to that range.
    pub fn overshoot(&self) -> Option<[f64; 3]> {
        let values = self.pieces.iter().map(|piece| piece[0]);
        let low = values.clone().fold(f64::INFINITY, f64::min);
        let high = values.fold(f64::NEG_INFINITY, f64::max);
        let mut farthest: Option<[f64; 3]> = None;
        for (knots, &[value, b, c, d]) in self.knots.windows(2).zip(&self.pieces) {
            // The extrema of a cubic: b + 2 c u + 3 d u² = 0, by the formula without cancellation.
            let discriminant = (c * c - 3.0 * b * d).max(0.0).sqrt();
            let sum = -(c + c.signum() * discriminant);
            for u in [sum / (3.0 * d), b / sum] {
                if u > 0.0 && u < knots[1] - knots[0] {
                    let y = value + u * (b + u * (c + u * d));
                    let beyond = (y - high).max(low - y) / (high - low);
                    if beyond > farthest.map_or(4.0 * f64::EPSILON, |[_, _, most]| most) {
                        farthest = Some([knots[0] + u, y, beyond]);
                    }
                }
            }
        }
        farthest
    }

    /// The first and the last x of the table.
    pub fn range(&self) -> [f64; 2] {
        [self.knots[0], self.knots[self.knots.len() - 1]]
    }

    /// The value and its first three derivatives at `x`; the third at a point of the table is that
    /// of the piece after it. At the ends of the range they are those of the end pieces.
    pub fn eval(&self, x: f64) -> [f64; 4] {
        if x.is_nan() {
            return [f64::NAN; 4];
        }
        let [first, last] = self.range();
        // A time summed from steps may exceed the end by a few rounding errors, and still belongs to the end.
        let tolerance = 4.0 * f64::EPSILON * first.abs().max(last.abs());
        let is_step = self.interpolation == Interpolation::Step;
        let i = if x > last + tolerance || (is_step && x >= last) {
            self.pieces.len() - 1
        } else {
            let inner = &self.knots[1..self.knots.len() - 1];
            inner.partition_point(|&knot| knot <= x)
        };
        if x < first - tolerance {
            return self.eval_before(x);
        }
        self.eval_on(i, x)
    }

    /// The value and three derivatives of one piece, whatever `x` is; `piece` is the number of points before it.
    pub(crate) fn eval_piece(&self, piece: f64, x: f64) -> [f64; 4] {
        if piece < 1.0 {
            return self.eval_before(x);
        }
        self.eval_on((piece as usize - 1).min(self.pieces.len() - 1), x)
    }

    /// The straight line before the first point.
    fn eval_before(&self, x: f64) -> [f64; 4] {
        let [value, b, ..] = self.pieces[0];
        let b = match self.interpolation {
            Interpolation::Spline | Interpolation::Linear => b,
            Interpolation::Monotone | Interpolation::Step => 0.0,
        };
        [value + (x - self.knots[0]) * b, b, 0.0, 0.0]
    }

    fn eval_on(&self, i: usize, x: f64) -> [f64; 4] {
        let [value, b, c, d] = self.pieces[i];
        let u = x - self.knots[i];
        [
            value + u * (b + u * (c + u * d)),
            b + u * (2.0 * c + u * 3.0 * d),
            2.0 * c + u * 6.0 * d,
            6.0 * d,
        ]
    }
}

fn check(points: &[[f64; 2]]) -> Result<(), LawError> {
    if points.len() < 2 {
        return Err(LawError::TooFewPoints {
            found: points.len(),
        });
    }
    if let Some(index) = points.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
        return Err(LawError::PointNotFinite { index });
    }
    match points.windows(2).position(|p| p[1][0] <= p[0][0]) {
        Some(before) => Err(LawError::NotAscending { index: before + 1 }),
        None => Ok(()),
    }
}

/// The first derivatives at all points, by Fritsch and Butland: zero at extrema, otherwise a weighted harmonic mean
/// of both slopes; at the ends the slope of the parabola, limited in the same way.
fn monotone_tangents(steps: &[f64], slopes: &[f64]) -> Vec<f64> {
    let last = steps.len();
    if last == 1 {
        return vec![slopes[0]; 2];
    }
    let end = |[h, k]: [f64; 2], [s, t]: [f64; 2]| {
        let parabola = ((2.0 * h + k) * s - h * t) / (h + k);
        if parabola * s <= 0.0 {
            0.0
        } else if s * t <= 0.0 && parabola.abs() > 3.0 * s.abs() {
            3.0 * s
        } else {
            parabola
        }
    };
    let inner = (1..last).map(|i| {
        let ([h, k], [s, t]) = ([steps[i - 1], steps[i]], [slopes[i - 1], slopes[i]]);
        if s * t <= 0.0 {
            return 0.0;
        }
        let [v, w] = [2.0 * k + h, k + 2.0 * h];
        (v + w) / (v / s + w / t)
    });
    let first = end([steps[0], steps[1]], [slopes[0], slopes[1]]);
    let final_one = end(
        [steps[last - 1], steps[last - 2]],
        [slopes[last - 1], slopes[last - 2]],
    );
    std::iter::once(first)
        .chain(inner)
        .chain([final_one])
        .collect()
}

/// The second derivatives at all points: between neighbours
/// h₋ M₋ + 2 (h₋ + h₊) M + h₊ M₊ = 6 (slope₊ − slope₋), and at each end the third derivatives of
/// the two pieces agree. With the end's M eliminated the rows are still dominated by their
/// diagonals, so that no pivoting is needed.
fn second_derivatives(steps: &[f64], slopes: &[f64]) -> Vec<f64> {
    let last = steps.len();
    match last {
        1 => return vec![0.0; 2],
        2 => return vec![2.0 * (slopes[1] - slopes[0]) / (steps[0] + steps[1]); 3],
        _ => {}
    }
    let mut second = vec![0.0; last + 1];
    // The coefficient of each row's right neighbour, after elimination of the left one.
    let mut right = vec![0.0; last + 1];
    for i in 1..last {
        let [before, after] = [steps[i - 1], steps[i]];
        let [mut left, mut diagonal, mut next] = [before, 2.0 * (before + after), after];
        if i == 1 {
            let ratio = before / after;
            diagonal += before * (1.0 + ratio);
            next -= before * ratio;
            left = 0.0;
        }
        if i == last - 1 {
            let ratio = after / before;
            diagonal += after * (1.0 + ratio);
            left -= after * ratio;
            next = 0.0;
        }
        let pivot = diagonal - left * right[i - 1];
        right[i] = next / pivot;
        second[i] = (6.0 * (slopes[i] - slopes[i - 1]) - left * second[i - 1]) / pivot;
    }
    for i in (1..last - 1).rev() {
        second[i] -= right[i] * second[i + 1];
    }
    second[0] = second[1] + (second[1] - second[2]) * steps[0] / steps[1];
    second[last] = second[last - 1]
        + (second[last - 1] - second[last - 2]) * steps[last - 1] / steps[last - 2];
    second
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Polynomial;

    const UNEVEN: [f64; 6] = [-1.0, -0.7, 0.4, 0.5, 1.9, 2.2];

    fn table(f: impl Fn(f64) -> f64, xs: &[f64]) -> Spline {
        let points: Vec<_> = xs.iter().map(|&x| [x, f(x)]).collect();
        Spline::through(&points).expect("a spline")
    }

    /// Polynomials of degree n − 1 through n points, up to the cubic, come back with all their
    /// derivatives. Rounding of the values, 1e-15, over the smallest step, 0.1, cubed.
    #[test]
    fn cubics_are_reproduced() {
        let law = Polynomial {
            coefficients: vec![0.5, -1.0, 2.0, 0.75],
        };
        for n in 2..=6 {
            let mut law = law.clone();
            law.coefficients.truncate(n);
            let spline = table(|x| law.eval(x)[0], &UNEVEN[..n]);
            for i in 0..=50 {
                let x = -1.0 + (UNEVEN[n - 1] + 1.0) * f64::from(i) / 50.0;
                let exact = law.eval(x);
                for (a, b) in spline.eval(x).into_iter().zip(exact) {
                    assert!((a - b).abs() < 1e-11, "{n} points, at {x}: {a} {b}");
                }
            }
        }
    }

    /// It passes through its points, and at each of them two derivatives are the same from both
    /// sides: over 1e-12 each changes by as much of the next one, which is 10, 1e2 and 1e3 at most.
    #[test]
    fn points_and_smoothness() {
        let spline = table(|x| (7.0 * x).sin(), &UNEVEN);
        for &x in &UNEVEN {
            // The last point is the sum of its piece: a few roundings of numbers up to 10.
            assert!((spline.eval(x)[0] - (7.0 * x).sin()).abs() < 1e-14);
        }
        let h = 1e-12;
        for &x in &UNEVEN[1..5] {
            let [before, after] = [spline.eval(x - h), spline.eval(x)];
            for (k, limit) in [2e-11, 1e-10, 1e-9].into_iter().enumerate() {
                assert!((before[k] - after[k]).abs() < limit, "{k} at {x}");
            }
        }
        // The knots that are none: one cubic on both sides of the second and the last but one.
        for x in [UNEVEN[1], UNEVEN[4]] {
            let [before, after] = [spline.eval(x - 1e-6)[3], spline.eval(x + 1e-6)[3]];
            assert!((before / after - 1.0).abs() < 1e-10, "{before} {after}");
        }
        assert!((spline.eval(0.39)[3] / spline.eval(0.41)[3] - 1.0).abs() > 0.1);
    }

    /// Fourth order everywhere, ends included: half the step, a sixteenth of the error. (A natural
    /// spline would show a quarter.) Ratios between 14 and 18 allow for the next term.
    #[test]
    fn fourth_order_up_to_the_ends() {
        let worst = |n: u32| {
            let xs: Vec<f64> = (0..=n).map(|i| f64::from(i) / f64::from(n)).collect();
            let spline = table(|x| (2.0 * x).exp(), &xs);
            (0..=1000)
                .map(|i| f64::from(i) / 1000.0)
                .map(|x| (spline.eval(x)[0] - (2.0 * x).exp()).abs())
                .fold(0.0, f64::max)
        };
        let ratio = worst(40) / worst(80);
        assert!((14.0..18.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn outside_along_the_tangents() {
        let spline = table(|x| x * x * x, &UNEVEN);
        for (x, end) in [(-3.0, -1.0), (4.0, 2.2_f64)] {
            let [value, slope, ..] = spline.eval(end);
            let outside = spline.eval(x);
            // A few roundings of 40.
            assert!((outside[0] - (value + slope * (x - end))).abs() < 1e-13);
            assert!((outside[1] - slope).abs() < 1e-13);
            assert_eq!(outside[2..], [0.0, 0.0]);
        }
        assert_eq!(spline.range(), [-1.0, 2.2]);
        // The ends themselves, and a rounding beyond them, still have the curvature of the pieces.
        for x in [2.2, 2.2_f64.next_up(), -1.0, (-1.0_f64).next_down()] {
            // Roundings of values of 10 over the smallest step, 0.1, squared.
            assert!((spline.eval(x)[2] - 6.0 * x).abs() < 2e-13, "{x}");
        }
    }

    /// Data with a jump: a spline overshoots, the other curves do not. All pass through the points, and monotone
    /// curves have a continuous slope.
    #[test]
    fn only_a_spline_goes_beyond_its_points() {
        let points = [
            [0.0, 0.0],
            [1.0, 0.0],
            [1.01, 10.0],
            [2.0, 10.0],
            [4.0, 0.0],
        ];
        let [place, value, beyond] = Spline::through(&points)
            .expect("a spline")
            .overshoot()
            .expect("an overshoot");
        assert!(beyond > 1.0 && !(0.0..=10.0).contains(&value), "{place}");
        for (_, interpolation) in &Interpolation::ALL[1..] {
            let curve = Spline::interpolating(&points, *interpolation).expect("a curve");
            assert_eq!(curve.overshoot(), None);
            for i in 0..=2000 {
                let [value, ..] = curve.eval(f64::from(i) / 500.0);
                assert!(
                    (-1e-14..=10.0 + 1e-14).contains(&value),
                    "{interpolation:?} {value}"
                );
            }
            for [x, y] in points {
                assert!((curve.eval(x)[0] - y).abs() < 1e-13); // roundings of slopes of 1e3
            }
        }
        let smooth = Spline::interpolating(&points, Interpolation::Monotone).expect("a curve");
        assert_eq!([-3.0, 9.0].map(|x| smooth.eval(x)[0]), [0.0, 0.0]);
        for x in [1.0, 1.01, 2.0] {
            let [a, b] = [x - 1e-12, x + 1e-12].map(|x| smooth.eval(x)[1]);
            assert!((a - b).abs() < 1e-5, "{a} {b}"); // curvatures of 1e6 over 1e-12
        }
        let step = Spline::interpolating(&points, Interpolation::Step).expect("a curve");
        assert_eq!(
            [1.0, 1.005, 1.01, 3.9].map(|x| step.eval(x)[0]),
            [0.0, 0.0, 10.0, 10.0]
        );
    }

    #[test]
    fn errors_say_which_point() {
        let through = |points: &[[f64; 2]]| Spline::through(points).expect_err("not a table");
        assert_eq!(through(&[[0.0, 1.0]]), LawError::TooFewPoints { found: 1 });
        assert_eq!(
            through(&[[0.0, 1.0], [1.0, f64::NAN], [2.0, 0.0]]),
            LawError::PointNotFinite { index: 1 }
        );
        let error = through(&[[0.0, 1.0], [1.0, 0.0], [1.0, 2.0]]);
        assert_eq!(error, LawError::NotAscending { index: 2 });
        assert_eq!(
            error.to_string(),
            "point 3 of the table does not come after point 2: the first column must ascend"
        );
        assert_eq!(
            through(&[[0.0, 0.0], [1.0, 0.0], [1.0_f64.next_up(), 1e300]]),
            LawError::TooSteep { index: 2 }
        );
        assert_eq!(
            through(&[[-1e308, 0.0], [1e308, 0.0]]),
            LawError::TooSteep { index: 1 }
        );
    }
}
