//! Numbers with a bound of their rounding error, which a tape propagates (running error analysis).

use super::function::{Binary, Unary};
use super::jet::{Jet, TapeScalar};

/// Rounding errors of a variable, from the last steps of an integration.
const OF_VARIABLE: f64 = 4.0;

/// A value and the first-order bound of its rounding error.
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

    /// The number as a jet whose rate is the error.
    fn moving(self) -> Jet {
        Jet::moving(Some([self.value, self.error]))
    }

    /// The result of an operation, from its jets with respect to one operand after another.
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
