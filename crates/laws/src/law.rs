//! Any function of one variable.

use crate::{Expression, Polynomial, Profile, Sinusoid, Spline};

/// A function of one variable in a mechanism or a load: of time, s, or of a
/// coordinate, rad or m. All units are SI.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// A polynomial.
    Polynomial(Polynomial),
    /// A motion from rest to rest.
    Profile(Profile),
    /// A table, as a spline through its points.
    Spline(Spline),
    /// A sinusoid.
    Sinusoid(Sinusoid),
    /// An expression of one variable, the first with which it was parsed. (If others occur in it,
    /// the law is NaN.)
    Expression(Expression),
}

impl Law {
    /// The value and its exact first three derivatives at `x`.
    pub fn eval(&self, x: f64) -> [f64; 4] {
        match self {
            Self::Polynomial(polynomial) => polynomial.eval(x),
            Self::Profile(profile) => profile.eval(x),
            Self::Spline(spline) => spline.eval(x),
            Self::Sinusoid(sinusoid) => sinusoid.eval(x),
            Self::Expression(expression) => expression.derivatives_wrt(&[x], 0),
        }
    }

    /// The end of its table beyond which `x` is; `None` if it has no table, or the table covers `x` within the rounding error of a sum of
    /// angles or travels.
    pub fn end_passed(&self, x: f64) -> Option<f64> {
        let Self::Spline(spline) = self else {
            return None;
        };
        let [first, last] = spline.range();
        let rounding = TABLE_ROUNDING * first.abs().max(last.abs());
        match () {
            () if x < first - rounding => Some(first),
            () if x > last + rounding => Some(last),
            () => None,
        }
    }

    /// The largest absolute value between two x, sampled at equally spaced x and at the points of a table.
    pub fn largest(&self, from: f64, to: f64) -> f64 {
        let parts = 64;
        let part = |k: usize| from + (to - from) * k as f64 / parts as f64;
        let knots = match self {
            Self::Spline(spline) => spline.knots(),
            _ => &[],
        };
        let inside = knots.iter().copied().filter(|x| (from..=to).contains(x));
        let all = (0..=parts).map(part).chain(inside);
        all.map(|x| self.eval(x)[0].abs()).fold(0.0, f64::max)
    }

    /// Where the value jumps between one number and another, which should be close: the last
    /// number before the jump and the first after it. Only an expression can jump (`floor`, `sign`,
    /// `step`, `if`); of several jumps the most distinct one is returned. A jump of less than
    /// 10⁻⁶ of the value is ignored; a slope of 10⁹ or more counts as a jump.
    pub fn discontinuity(&self, from: f64, to: f64) -> Option<[f64; 2]> {
        let Self::Expression(_) = self else {
            return None;
        };
        // The difference of values that the derivatives at both ends do not explain: of fifth order
        // in the step for a smooth law, and never small for a jump.
        let unexplained = |a: f64, b: f64| {
            let ([p, v, c, _], [q, w, d, _], h) = (self.eval(a), self.eval(b), b - a);
            (q - p - 0.5 * h * (v + w) - h * h / 12.0 * (c - d)).abs()
        };
        let min_jump = JUMP_TOLERANCE * self.eval(from)[0].abs().max(self.eval(to)[0].abs());
        let (mut a, mut b) = (from, to);
        // A NaN is no jump.
        let may_jump = unexplained(a, b) > min_jump;
        if !may_jump {
            return None;
        }
        for _ in 0..MAX_HALVINGS {
            let middle = 0.5 * (a + b);
            if middle == a || middle == b {
                break;
            }
            if unexplained(a, middle) >= unexplained(middle, b) {
                b = middle;
            } else {
                a = middle;
            }
        }
        ((self.eval(b)[0] - self.eval(a)[0]).abs() > min_jump).then_some([a, b])
    }
}

/// Smallest jump, relative to the value.
const JUMP_TOLERANCE: f64 = 1e-6;
/// Relative distance by which a sum of angles or travels may exceed the end of a table: more than the error of an end that is found
/// by bisection.
const TABLE_ROUNDING: f64 = 1e-12;
/// Maximum number of bisections, down to the rounding of numbers of its size.
const MAX_HALVINGS: usize = 60;

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::{Rise, Shape};

    /// One law of each kind, and every shape of profile.
    fn laws() -> Vec<Law> {
        let rise = Rise {
            start: 0.5,
            rise: 2.0,
            duration: 3.0,
            delay: -1.0,
        };
        let table = [[-2.0, 1.0], [0.0, -1.0], [1.0, 2.0], [3.0, 0.0], [4.0, 1.0]];
        let mut laws = vec![
            Law::Polynomial(Polynomial {
                coefficients: vec![1.0, -2.0, 0.5, 0.25, -0.125],
            }),
            Law::Spline(Spline::through(&table).expect("a spline")),
            Law::Sinusoid(
                Sinusoid::starting_at(0.3, 0.7, 2.0 * PI / 3.0, 0.4).expect("a sinusoid"),
            ),
            Law::Expression(Expression::parse("x^2*exp(-x)/(4 + x^2)", &["x"]).expect("a formula")),
        ];
        for shape in [
            Shape::Polynomial345,
            Shape::Polynomial4567,
            Shape::Cycloidal,
            Shape::Trapezoidal { ramp: 0.7 },
        ] {
            laws.push(Law::Profile(Profile::new(shape, rise).expect("a profile")));
        }
        laws
    }

    /// Each derivative against the differences of the previous one. Sixth order with a step of
    /// 0.01: truncation h⁶ f⁗‴/140, for the sinusoid 1e-12 × 0.7 × 3¹⁰/140 = 3e-10 in the third.
    #[test]
    fn every_derivative_is_that_of_the_entry_before_it() {
        let h = 0.01;
        for law in laws() {
            // No knot of the spline, no end or corner of a profile within the stencil.
            for x in [-0.83, 0.41, 0.9, 1.55] {
                let exact = law.eval(x);
                for k in 0..3 {
                    let d = |n: f64| law.eval(x + n * h)[k] - law.eval(x - n * h)[k];
                    let difference = (45.0 * d(1.0) - 9.0 * d(2.0) + d(3.0)) / (60.0 * h);
                    let error = (difference - exact[k + 1]).abs();
                    assert!(error < 5e-10, "{law:?} at {x}, {}: {error:e}", k + 1);
                }
            }
        }
    }

    #[test]
    fn not_a_number_stays_visible() {
        for law in laws() {
            assert!(law.eval(f64::NAN).iter().all(|d| d.is_nan()), "{law:?}");
        }
    }

    #[test]
    fn jumps_are_found_between_neighbouring_numbers() {
        let law = |text| Law::Expression(Expression::parse(text, &["x"]).expect("a formula"));
        for (text, at) in [
            ("if(x > 0.3, 2, x)", 0.3),
            ("x + 0.001*floor(x/0.7)", 0.7),
            ("sin(x) + sign(x - 0.9)*1e-4", 0.9),
            ("cos(x) + 0.01*step(x - 0.123)", 0.123),
        ] {
            for [from, to] in [[0.0, 1.0], [1.0, 0.0]] {
                let [a, b] = law(text).discontinuity(from, to).expect(text);
                // A few roundings of 1, on both sides of it.
                assert!((a - b).abs() < 1e-15 && (a - at).abs() < 1e-15, "{text}");
                assert!((at - a) * (at - b) <= 0.0, "{text}: {a} {b}");
            }
        }
        for text in [
            "abs(x - 0.3)",
            "max(0, sin(20*x))",
            "tanh(1e6*(x - 0.4))",
            "sqrt(abs(x - 0.5))",
            "exp(30*x)",
            "if(x < 0.5, x^2, x - 0.25)",
            "1e60*x",
            "ln(x - 2)",
        ] {
            assert_eq!(law(text).discontinuity(0.0, 1.0), None, "{text}");
        }
        for law in laws() {
            assert_eq!(law.discontinuity(-1.0, 3.0), None, "{law:?}");
        }
    }

    #[test]
    fn a_law_of_two_variables_is_not_a_number() {
        let law = Law::Expression(Expression::parse("x + y", &["x", "y"]).expect("a formula"));
        assert!(law.eval(1.0)[0].is_nan());
    }
}
