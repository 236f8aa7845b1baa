//! Numbers that carry a bound of their rounding with them, so that a tape tells what of its result is none.

use super::function::{Binary, Unary};
use super::jet::{Jet, TapeScalar};

/// Roundings of a variable: those of an integration's last steps.
const OF_VARIABLE: f64 = 4.0;

/// A value and the largest error that rounding leaves it, to the first order.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rounded {
    value: f64,
    pub(crate) error: f64,
}

impl Rounded {
    pub(crate) fn variable(value: f64) -> Self {
        let error = OF_VARIABLE * f64::EPSILON * value.abs();
        Self { value, error }
    }

    /// As a jet whose rate is the error.
    fn moving(self) -> Jet {
        Jet::moving(Some([self.value, self.error]))
    }

    /// The result of an operation, from those in which one operand after the other moves.
    fn of(results: &[Jet]) -> Self {
        let value = results[0].value();
        let moved = results.iter().map(|result| result.derivatives()[1].abs());
        Self {
            value,
            error: moved.sum::<f64>() + f64::EPSILON * value.abs(),
        }
    }
}

impl TapeScalar for Rounded {
    fn constant(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn negate(self) -> Self {
        Self {
            value: -self.value,
            ..self
        }
    }

    fn unary(self, function: Unary) -> Self {
        Self::of(&[self.moving().unary(function)])
    }

    fn binary(self, operation: Binary, other: Self) -> Self {
        let [a, b] = [self, other].map(|operand| Jet::constant(operand.value));
        Self::of(&[
            self.moving().binary(operation, b),
            a.binary(operation, other.moving()),
        ])
    }
}
