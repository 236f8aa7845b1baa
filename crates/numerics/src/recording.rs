//! A number type that records operations. The model is evaluated once with it, by the same source code as always, and
//! the recorded operations are the exported code.
//!
//! Decisions depend on values, as usual, and are not recorded. Therefore code recorded at one coordinate is valid at
//! another one only if all decisions are the same: [`record`] compares recordings at several.

use crate::scalar::{Constant, Lift, Scalar};
use crate::straight_line::{Operand, Operation, OperationKind as Kind, StraightLine};
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use thiserror::Error;

/// Why there is no straight-line code.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RecordingError<E> {
    /// The model has no value.
    #[error("{0}")]
    Evaluation(E),
    /// A function is known by its values alone.
    #[error("a function is known by its values alone")]
    Function,
    /// Other operations at another position.
    #[error("the operations at {first:?} and {second:?} differ")]
    Differs {
        /// The coordinates of a position, rad or m.
        first: Vec<f64>,
        /// The numbers of another recording.
        second: Vec<f64>,
    },
}

/// The recorded operations.
#[derive(Debug, Default)]
struct Record {
    operations: Vec<Operation>,
    /// The index of each operation, so that each is stored once.
    known: HashMap<(Kind, [OperandKey; 2]), usize>,
    /// Whether a function was met that has no operations.
    has_function: bool,
}

/// An operand that can be compared: its kind, and its index or its bits.
type OperandKey = (u8, u64);

thread_local! {
    static RECORD: RefCell<Record> = RefCell::default();
}

/// The operations of functions of a coordinate. They are recorded at each of the coordinates, rad or m, and must be the same.
///
/// # Errors
/// [`RecordingError`].
pub fn record<E>(
    coordinates: &[f64],
    mut evaluate: impl FnMut(RecordedNumber) -> Result<Vec<RecordedNumber>, E>,
) -> Result<StraightLine, RecordingError<E>> {
    let positions: Vec<Vec<f64>> = coordinates.iter().map(|&q| vec![q]).collect();
    record_at(&positions, |q| evaluate(q[0]))
}

/// The operations of functions of several coordinates, recorded at each of the positions.
///
/// # Errors
/// [`RecordingError`].
pub fn record_at<E>(
    positions: &[Vec<f64>],
    mut evaluate: impl FnMut(&[RecordedNumber]) -> Result<Vec<RecordedNumber>, E>,
) -> Result<StraightLine, RecordingError<E>> {
    let mut first: Option<(&Vec<f64>, StraightLine)> = None;
    for position in positions {
        RECORD.take();
        let coordinates = position.iter().enumerate();
        let coordinates = coordinates.map(|(k, &value)| RecordedNumber {
            value,
            operand: Operand::Coordinate(k),
        });
        let outputs = evaluate(&coordinates.collect::<Vec<_>>());
        let record = RECORD.take();
        let outputs = outputs.map_err(RecordingError::Evaluation)?;
        if record.has_function {
            return Err(RecordingError::Function);
        }
        let code = StraightLine {
            operations: record.operations,
            outputs: outputs.iter().map(|output| output.operand).collect(),
        };
        let code = code.without_unused();
        match &first {
            None => first = Some((position, code)),
            Some((_, same)) if *same == code => {}
            Some((other, _)) => {
                return Err(RecordingError::Differs {
                    first: (*other).clone(),
                    second: position.clone(),
                });
            }
        }
    }
    Ok(first.map(|(_, code)| code).unwrap_or_default())
}

/// A number of which each operation is recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordedNumber {
    value: f64,
    operand: Operand,
}

impl Default for RecordedNumber {
    fn default() -> Self {
        Self::from_f64(0.0)
    }
}

impl RecordedNumber {
    fn is_constant(self) -> bool {
        matches!(self.operand, Operand::Constant(_))
    }

    /// Whether it is this constant.
    fn is(self, value: f64) -> bool {
        self.is_constant() && self.value == value
    }

    /// The result of an operation on two numbers, or on one twice; of constants it is one.
    fn result(value: f64, kind: Kind, of: [Self; 2]) -> Self {
        if of.iter().all(|number| number.is_constant()) {
            return Self::from_f64(value);
        }
        let operands = of.map(|number| number.operand);
        let index = RECORD.with_borrow_mut(|record| {
            let next = record.operations.len();
            let known = record.known.entry((kind, operands.map(key)));
            let index = *known.or_insert(next);
            if index == next {
                record.operations.push(Operation { kind, operands });
            }
            index
        });
        Self {
            value,
            operand: Operand::Result(index),
        }
    }
}

fn key(operand: Operand) -> OperandKey {
    match operand {
        Operand::Constant(value) => (0, value.to_bits()),
        Operand::Coordinate(k) => (1, k as u64),
        Operand::Result(k) => (2, k as u64),
    }
}

impl Constant for RecordedNumber {
    const IS_PREPARED: bool = false;

    fn length([x, y, z]: [Self; 3]) -> Self {
        (x * x + y * y + z * z).sqrt()
    }
}

impl Lift<Self> for RecordedNumber {
    fn lift(constant: Self) -> Self {
        constant
    }
}

impl Scalar for RecordedNumber {
    const HAS_DERIVATIVES: bool = false;
    const EPSILON: f64 = f64::EPSILON;

    fn from_f64(value: f64) -> Self {
        Self {
            value,
            operand: Operand::Constant(value),
        }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn sqrt(self) -> Self {
        Self::result(self.value.sqrt(), Kind::SquareRoot, [self; 2])
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = Scalar::sin_cos(self.value);
        (
            Self::result(sin, Kind::Sine, [self; 2]),
            Self::result(cos, Kind::Cosine, [self; 2]),
        )
    }

    fn atan2(self, other: Self) -> Self {
        let value = self.value.atan2(other.value);
        Self::result(value, Kind::Angle, [self, other])
    }

    fn compose(self, derivatives: &[f64; 4]) -> Self {
        if !self.is_constant() {
            RECORD.with_borrow_mut(|record| record.has_function = true);
        }
        Self::from_f64(derivatives[0])
    }
}

impl Add for RecordedNumber {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        match (self.is(0.0), other.is(0.0)) {
            (true, _) => other,
            (_, true) => self,
            _ => Self::result(self.value + other.value, Kind::Add, [self, other]),
        }
    }
}

impl Sub for RecordedNumber {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        match (self.is(0.0), other.is(0.0)) {
            (_, true) => self,
            (true, _) => -other,
            _ => Self::result(self.value - other.value, Kind::Subtract, [self, other]),
        }
    }
}

impl Mul for RecordedNumber {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        // Every value of a position is finite, and so its product with zero is zero.
        if self.is(0.0) || other.is(0.0) {
            return Self::from_f64(0.0);
        }
        let (one, rest) = if self.is_constant() {
            (self, other)
        } else {
            (other, self)
        };
        match (one.is(1.0), one.is(-1.0)) {
            (true, _) => rest,
            (_, true) => -rest,
            _ => Self::result(self.value * other.value, Kind::Multiply, [self, other]),
        }
    }
}

impl Div for RecordedNumber {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        match (self.is(0.0) && other.value != 0.0, other.is(1.0)) {
            (true, _) => Self::from_f64(0.0),
            (_, true) => self,
            _ => Self::result(self.value / other.value, Kind::Divide, [self, other]),
        }
    }
}

impl Neg for RecordedNumber {
    type Output = Self;

    fn neg(self) -> Self {
        Self::result(-self.value, Kind::Negate, [self; 2])
    }
}

impl AddAssign for RecordedNumber {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for RecordedNumber {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn number(value: f64) -> RecordedNumber {
        RecordedNumber::from_f64(value)
    }

    #[test]
    fn each_operation_stands_once_and_constants_are_computed() {
        let code = record(&[0.3, 1.1], |q| {
            let (sin, cos) = q.sin_cos();
            let square = sin * sin;
            let folded = number(2.0) * number(3.0) + number(0.0);
            Ok::<_, Infallible>(vec![
                square + cos * cos,
                square * folded,
                (q * number(0.0)) - q,
            ])
        });
        let code = code.expect("code");
        // sin, cos, sin², cos², their sum, 6 sin², −q.
        assert_eq!(code.operations.len(), 7);
        let [one, six, minus] = code.evaluate(&[0.8_f64])[..] else {
            panic!("three outputs");
        };
        assert!((one - 1.0).abs() < 1e-15);
        assert!((six - 6.0 * 0.8_f64.sin().powi(2)).abs() < 1e-15);
        assert_eq!(minus, -0.8);
    }

    #[test]
    fn a_decision_that_depends_on_the_coordinate_is_found() {
        let absolute = |q: RecordedNumber| {
            let value = if q.value() < 0.0 { -q } else { q };
            Ok::<_, Infallible>(vec![value])
        };
        assert!(record(&[0.5, 0.7], absolute).is_ok());
        let differs = RecordingError::Differs {
            first: vec![0.5],
            second: vec![-0.5],
        };
        assert_eq!(record(&[0.5, -0.5], absolute), Err(differs));
    }

    #[test]
    fn a_function_of_values_has_no_operations() {
        let law = |q: RecordedNumber| Ok::<_, Infallible>(vec![q.compose(&[1.0, 0.0, 0.0, 0.0])]);
        assert_eq!(record(&[0.5], law), Err(RecordingError::Function));
    }
}
