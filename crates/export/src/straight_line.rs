//! Straight-line code: operations without a branch, each on results of earlier ones.

use crate::real::Real;

/// What an operation works on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operand {
    /// A coordinate, by its place.
    Coordinate(usize),
    /// A constant.
    Constant(f64),
    /// The result of an operation, by its index.
    Result(usize),
}

/// An operation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operation {
    /// A sum.
    Add(Operand, Operand),
    /// A difference.
    Subtract(Operand, Operand),
    /// A product.
    Multiply(Operand, Operand),
    /// A quotient.
    Divide(Operand, Operand),
    /// The opposite.
    Negate(Operand),
    /// A square root.
    SquareRoot(Operand),
    /// A sine.
    Sine(Operand),
    /// A cosine.
    Cosine(Operand),
    /// The angle of the direction (second, first) from the first axis, in (−π, π].
    Angle(Operand, Operand),
}

impl Operation {
    /// What it works on; an operation on one has it twice.
    pub(crate) fn operands(&self) -> [Operand; 2] {
        match *self {
            Self::Add(a, b)
            | Self::Subtract(a, b)
            | Self::Multiply(a, b)
            | Self::Divide(a, b)
            | Self::Angle(a, b) => [a, b],
            Self::Negate(a) | Self::SquareRoot(a) | Self::Sine(a) | Self::Cosine(a) => [a, a],
        }
    }

    /// The same operation on other operands.
    pub(crate) fn with_operands(&self, [a, b]: [Operand; 2]) -> Self {
        match self {
            Self::Add(..) => Self::Add(a, b),
            Self::Subtract(..) => Self::Subtract(a, b),
            Self::Multiply(..) => Self::Multiply(a, b),
            Self::Divide(..) => Self::Divide(a, b),
            Self::Angle(..) => Self::Angle(a, b),
            Self::Negate(_) => Self::Negate(a),
            Self::SquareRoot(_) => Self::SquareRoot(a),
            Self::Sine(_) => Self::Sine(a),
            Self::Cosine(_) => Self::Cosine(a),
        }
    }

    fn evaluate<R: Real>(&self, value: impl Fn(Operand) -> R) -> R {
        match *self {
            Self::Add(a, b) => value(a) + value(b),
            Self::Subtract(a, b) => value(a) - value(b),
            Self::Multiply(a, b) => value(a) * value(b),
            Self::Divide(a, b) => value(a) / value(b),
            Self::Negate(a) => R::of(0.0) - value(a),
            Self::SquareRoot(a) => value(a).sqrt(),
            Self::Sine(a) => value(a).sin(),
            Self::Cosine(a) => value(a).cos(),
            Self::Angle(a, b) => value(a).atan2(value(b)),
        }
    }
}

/// Operations, and which results are wanted.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StraightLine {
    /// Each uses earlier ones only.
    pub operations: Vec<Operation>,
    /// What is wanted.
    pub outputs: Vec<Operand>,
}

impl StraightLine {
    /// The same without operations that no output needs.
    pub(crate) fn without_unused(self) -> Self {
        let mut needed = vec![false; self.operations.len()];
        let mark = |operand: Operand, needed: &mut Vec<bool>| {
            if let Operand::Result(k) = operand {
                needed[k] = true;
            }
        };
        for &output in &self.outputs {
            mark(output, &mut needed);
        }
        for (k, operation) in self.operations.iter().enumerate().rev() {
            if needed[k] {
                let operands = operation.operands();
                operands.into_iter().for_each(|o| mark(o, &mut needed));
            }
        }
        let mut new_index = vec![0; needed.len()];
        let mut operations = Vec::new();
        let renamed = |operand: Operand, new_index: &[usize]| match operand {
            Operand::Result(k) => Operand::Result(new_index[k]),
            other @ (Operand::Coordinate(_) | Operand::Constant(_)) => other,
        };
        for (k, operation) in self.operations.iter().enumerate() {
            if needed[k] {
                new_index[k] = operations.len();
                let operands = operation.operands().map(|o| renamed(o, &new_index));
                operations.push(operation.with_operands(operands));
            }
        }
        let outputs = self.outputs.iter();
        Self {
            outputs: outputs.map(|&o| renamed(o, &new_index)).collect(),
            operations,
        }
    }

    /// The outputs at coordinates, rad or m.
    pub fn evaluate<R: Real>(&self, q: &[R]) -> Vec<R> {
        let mut results: Vec<R> = Vec::with_capacity(self.operations.len());
        let value = |operand: Operand, results: &[R]| match operand {
            Operand::Coordinate(k) => q[k],
            Operand::Constant(value) => R::of(value),
            Operand::Result(k) => results[k],
        };
        for operation in &self.operations {
            let result = operation.evaluate(|operand| value(operand, &results));
            results.push(result);
        }
        let outputs = self.outputs.iter();
        outputs.map(|&output| value(output, &results)).collect()
    }

    /// How many of its operations are square roots, sines, cosines and angles.
    pub fn functions(&self) -> usize {
        let is_function = |operation: &&Operation| match operation {
            Operation::SquareRoot(_)
            | Operation::Sine(_)
            | Operation::Cosine(_)
            | Operation::Angle(..) => true,
            Operation::Add(..)
            | Operation::Subtract(..)
            | Operation::Multiply(..)
            | Operation::Divide(..)
            | Operation::Negate(_) => false,
        };
        self.operations.iter().filter(is_function).count()
    }

    /// All constants.
    pub(crate) fn constants(&self) -> impl Iterator<Item = f64> + '_ {
        let used = self.operations.iter().flat_map(Operation::operands);
        let all = used.chain(self.outputs.iter().copied());
        all.filter_map(|operand| match operand {
            Operand::Constant(value) => Some(value),
            Operand::Coordinate(_) | Operand::Result(_) => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_output_needs_goes() {
        use Operand::{Constant, Coordinate, Result};
        let code = StraightLine {
            operations: vec![
                Operation::Sine(Coordinate(0)),
                Operation::Cosine(Coordinate(0)),
                Operation::Multiply(Result(1), Constant(2.0)),
            ],
            outputs: vec![Result(2), Coordinate(0)],
        };
        let short = code.clone().without_unused();
        assert_eq!(short.operations.len(), 2);
        assert_eq!(short.evaluate(&[0.7]), code.evaluate(&[0.7]));
        assert_eq!(short.evaluate(&[0.7]), [2.0 * 0.7_f64.cos(), 0.7]);
        assert_eq!(short.functions(), 1);
    }
}
