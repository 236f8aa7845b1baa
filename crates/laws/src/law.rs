//! Any function of one variable.

use crate::{Expression, Polynomial, Profile, Sinusoid, Spline};

/// A function of one variable that a mechanism or a load can hold: of time, s, or of a
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
    /// An expression of one variable, the first that it was parsed with. (If others occur in it,
    /// the law is NaN.)
    Expression(Expression),
}

impl Law {
    /// The value and its first three derivatives at `x`, by analysis, not by differences.
    pub fn at(&self, x: f64) -> [f64; 4] {
        match self {
            Self::Polynomial(polynomial) => polynomial.derivatives(x),
            Self::Profile(profile) => profile.at(x),
            Self::Spline(spline) => spline.at(x),
            Self::Sinusoid(sinusoid) => sinusoid.at(x),
            Self::Expression(expression) => expression.along(&[x], 0),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::{Shape, Travel};

    /// One law of each kind, and every shape of profile.
    fn laws() -> Vec<Law> {
        let travel = Travel {
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
            laws.push(Law::Profile(
                Profile::new(shape, travel).expect("a profile"),
            ));
        }
        laws
    }

    /// Each derivative against the differences of the one before it. Sixth order with a step of
    /// 0.01: truncation h⁶ f⁗‴/140, for the sinusoid 1e-12 × 0.7 × 3¹⁰/140 = 3e-10 in the third.
    #[test]
    fn every_derivative_is_that_of_the_entry_before_it() {
        let h = 0.01;
        for law in laws() {
            // No knot of the spline, no end or corner of a profile within the stencil.
            for x in [-0.83, 0.41, 0.9, 1.55] {
                let exact = law.at(x);
                for k in 0..3 {
                    let d = |n: f64| law.at(x + n * h)[k] - law.at(x - n * h)[k];
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
            assert!(law.at(f64::NAN).iter().all(|d| d.is_nan()), "{law:?}");
        }
    }

    #[test]
    fn a_law_of_two_variables_is_not_a_number() {
        let law = Law::Expression(Expression::parse("x + y", &["x", "y"]).expect("a formula"));
        assert!(law.at(1.0)[0].is_nan());
    }
}
