//! Slopes of straight-line code by its coordinate, as more operations of the same code.

use dwell_numerics::Real;
use dwell_numerics::Scalar;
use dwell_numerics::StraightLine;
use dwell_numerics::{RecordedNumber, RecordingError, record};
use std::convert::Infallible;
use std::ops::{Add, Div, Mul, Sub};

/// Appends the slopes of the outputs from `first` on to the outputs of a code; zero for a slope that is not needed.
pub(crate) fn with_slopes(code: &StraightLine, first: usize, wanted: &[bool]) -> StraightLine {
    let evaluate = |q: RecordedNumber| {
        let all = code.evaluate(&[Sloped::new(q, RecordedNumber::from_f64(1.0))]);
        let slopes = all[first..].iter().zip(wanted).map(|(of, &wanted)| {
            if wanted {
                of.slope
            } else {
                RecordedNumber::default()
            }
        });
        Ok(all.iter().map(|of| of.value).chain(slopes).collect())
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

impl Sloped {
    fn new(value: RecordedNumber, slope: RecordedNumber) -> Self {
        Self { value, slope }
    }
}

impl Add for Sloped {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.slope + other.slope)
    }
}

impl Sub for Sloped {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::new(self.value - other.value, self.slope - other.slope)
    }
}

impl Mul for Sloped {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        Self::new(value, self.slope * other.value + self.value * other.slope)
    }
}

impl Div for Sloped {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::new(value, (self.slope - value * other.slope) / other.value)
    }
}

impl Real for Sloped {
    fn of(value: f64) -> Self {
        let zero = RecordedNumber::default();
        Self::new(RecordedNumber::from_f64(value), zero)
    }

    fn to_f64(self) -> f64 {
        self.value.value()
    }

    fn sqrt(self) -> Self {
        let value = Scalar::sqrt(self.value);
        Self::new(value, RecordedNumber::from_f64(0.5) * self.slope / value)
    }

    fn sin(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        Self::new(sin, cos * self.slope)
    }

    fn cos(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        Self::new(cos, -(sin * self.slope))
    }

    fn atan2(self, other: Self) -> Self {
        let square = self.value * self.value + other.value * other.value;
        let turned = other.value * self.slope - self.value * other.slope;
        Self::new(Scalar::atan2(self.value, other.value), turned / square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_numerics::{Operand, Operation, OperationKind as Kind};

    #[test]
    fn slopes_are_those_of_differences() {
        use Operand::{Constant, Coordinate, Result};
        let of = |kind, operands| Operation { kind, operands };
        let code = StraightLine {
            operations: vec![
                of(Kind::Sine, [Coordinate(0); 2]),
                of(Kind::Cosine, [Coordinate(0); 2]),
                of(Kind::Add, [Result(1), Constant(2.0)]),
                of(Kind::SquareRoot, [Result(2); 2]),
                of(Kind::Divide, [Result(0), Result(3)]),
                of(Kind::Angle, [Result(4), Result(2)]),
                of(Kind::Multiply, [Result(5), Coordinate(0)]),
                of(Kind::Negate, [Result(6); 2]),
                of(Kind::Subtract, [Result(7), Result(4)]),
            ],
            outputs: vec![Result(8), Result(3), Constant(4.0)],
        };
        let sloped = with_slopes(&code, 0, &[true, false, true]);
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
