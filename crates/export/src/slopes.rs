//! Slopes of straight-line code by its coordinate, as more operations of the same code.

use crate::real::Real;
use crate::recording::{RecordedNumber, RecordingError, record};
use crate::straight_line::StraightLine;
use dwell_numerics::Scalar;
use std::cmp::Ordering;
use std::convert::Infallible;
use std::ops::{Add, Div, Mul, Sub};

/// Appends to the outputs of a code the slopes of some of them: of others zero.
pub(crate) fn with_slopes(code: &StraightLine, outputs: &[(usize, bool)]) -> StraightLine {
    let evaluate = |q: RecordedNumber| {
        let one = RecordedNumber::from_f64(1.0);
        let all = code.evaluate(&[Sloped {
            value: q,
            slope: one,
        }]);
        let slope = |&(k, wanted): &(usize, bool)| match all.get(k).filter(|_| wanted) {
            Some(of) => of.slope,
            None => RecordedNumber::from_f64(0.0),
        };
        let values = all.iter().map(|of| of.value);
        Ok(values.chain(outputs.iter().map(slope)).collect())
    };
    let found: Result<StraightLine, RecordingError<Infallible>> = record(&[0.5], evaluate);
    // Operations of a code make no decision and have no other function.
    found.unwrap_or_default()
}

/// A recorded number and its slope.
#[derive(Debug, Clone, Copy)]
struct Sloped {
    value: RecordedNumber,
    slope: RecordedNumber,
}

impl PartialEq for Sloped {
    fn eq(&self, other: &Self) -> bool {
        self.to_f64() == other.to_f64()
    }
}

impl PartialOrd for Sloped {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.to_f64().partial_cmp(&other.to_f64())
    }
}

impl Add for Sloped {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slope: self.slope + other.slope,
        }
    }
}

impl Sub for Sloped {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            slope: self.slope - other.slope,
        }
    }
}

impl Mul for Sloped {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            slope: self.slope * other.value + self.value * other.slope,
        }
    }
}

impl Div for Sloped {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self {
            value,
            slope: (self.slope - value * other.slope) / other.value,
        }
    }
}

impl Real for Sloped {
    fn of(value: f64) -> Self {
        Self {
            value: RecordedNumber::from_f64(value),
            slope: RecordedNumber::from_f64(0.0),
        }
    }

    fn to_f64(self) -> f64 {
        self.value.value()
    }

    fn sqrt(self) -> Self {
        let value = Scalar::sqrt(self.value);
        Self {
            value,
            slope: RecordedNumber::from_f64(0.5) * self.slope / value,
        }
    }

    fn sin(self) -> Self {
        let (value, cos) = self.value.sin_cos();
        Self {
            value,
            slope: cos * self.slope,
        }
    }

    fn cos(self) -> Self {
        let (sin, value) = self.value.sin_cos();
        Self {
            value,
            slope: -(sin * self.slope),
        }
    }

    fn atan2(self, other: Self) -> Self {
        let square = self.value * self.value + other.value * other.value;
        let turned = other.value * self.slope - self.value * other.slope;
        Self {
            value: Scalar::atan2(self.value, other.value),
            slope: turned / square,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::straight_line::{Operand, Operation};

    #[test]
    fn slopes_are_those_of_differences() {
        use Operand::{Constant, Coordinate, Result};
        let code = StraightLine {
            operations: vec![
                Operation::Sine(Coordinate(0)),
                Operation::Cosine(Coordinate(0)),
                Operation::Add(Result(1), Constant(2.0)),
                Operation::SquareRoot(Result(2)),
                Operation::Divide(Result(0), Result(3)),
                Operation::Angle(Result(4), Result(2)),
                Operation::Multiply(Result(5), Coordinate(0)),
                Operation::Negate(Result(6)),
                Operation::Subtract(Result(7), Result(4)),
            ],
            outputs: vec![Result(8), Result(3), Constant(4.0)],
        };
        let sloped = with_slopes(&code, &[(0, true), (1, false), (2, true)]);
        assert_eq!(sloped.outputs.len(), 6);
        for q in [-1.0_f64, 0.3, 2.0] {
            let [value, _, _, slope, unwanted, of_constant] = sloped.evaluate(&[q])[..] else {
                panic!("six outputs");
            };
            let h = 1e-5;
            let [before, after] = [q - h, q + h].map(|q| code.evaluate(&[q])[0]);
            assert_eq!(value, code.evaluate(&[q])[0]);
            assert!((slope - (after - before) / (2.0 * h)).abs() < 1e-9, "{q}");
            assert_eq!([unwanted, of_constant], [0.0, 0.0]);
        }
    }
}
