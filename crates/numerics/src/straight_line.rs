//! Straight-line code: operations without a branch, each on results of earlier ones.

use crate::real::Real;

/// An operand of an operation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operand {
    /// A coordinate, by its place.
    Coordinate(usize),
    /// A constant.
    Constant(f64),
    /// The result of an operation, by its index.
    Result(usize),
}

impl Operand {
    /// Its value, from the coordinates and the results of earlier operations.
    pub(crate) fn value<R: Real>(self, coordinates: &[R], results: &[R]) -> R {
        match self {
            Self::Coordinate(k) => coordinates[k],
            Self::Constant(value) => R::of(value),
            Self::Result(k) => results[k],
        }
    }
}

/// An operation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Operation {
    /// The kind of the operation.
    pub kind: OperationKind,
    /// The operands; a unary operation has its operand twice.
    pub operands: [Operand; 2],
}

/// The kind of an operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum OperationKind {
    /// A sum.
    Add,
    /// A difference.
    Subtract,
    /// A product.
    Multiply,
    /// A quotient.
    Divide,
    /// The opposite.
    Negate,
    /// A square root.
    SquareRoot,
    /// A sine.
    Sine,
    /// A cosine.
    Cosine,
    /// The angle of the direction (second, first) from the first axis, in (−π, π].
    Angle,
}

impl OperationKind {
    fn evaluate<R: Real>(self, [a, b]: [R; 2]) -> R {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Negate => R::of(0.0) - a,
            Self::SquareRoot => a.sqrt(),
            Self::Sine => a.sin(),
            Self::Cosine => a.cos(),
            Self::Angle => a.atan2(b),
        }
    }
}

/// Operations, and which results are wanted.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StraightLine {
    /// Each uses earlier ones only.
    pub operations: Vec<Operation>,
    /// The outputs.
    pub outputs: Vec<Operand>,
}

impl StraightLine {
    /// This code without operations that no output needs.
    pub fn without_unused(self) -> Self {
        let mut needed = vec![false; self.operations.len()];
        let mark = |operand: &Operand, needed: &mut Vec<bool>| {
            if let Operand::Result(k) = operand {
                needed[*k] = true;
            }
        };
        self.outputs.iter().for_each(|o| mark(o, &mut needed));
        for (k, operation) in self.operations.iter().enumerate().rev() {
            if needed[k] {
                operation.operands.iter().for_each(|o| mark(o, &mut needed));
            }
        }
        let mut new_index = vec![0; needed.len()];
        let mut operations = Vec::new();
        let renamed = |operand: Operand, new_index: &[usize]| match operand {
            Operand::Result(k) => Operand::Result(new_index[k]),
            other @ (Operand::Coordinate(_) | Operand::Constant(_)) => other,
        };
        for (k, mut operation) in self.operations.into_iter().enumerate() {
            if needed[k] {
                new_index[k] = operations.len();
                operation.operands = operation.operands.map(|o| renamed(o, &new_index));
                operations.push(operation);
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
        let mut results = Vec::with_capacity(self.operations.len());
        self.evaluate_operations(q, &mut results);
        let outputs = self.outputs.iter();
        outputs.map(|output| output.value(q, &results)).collect()
    }

    /// The results of all operations at coordinates.
    pub(crate) fn evaluate_operations<R: Real>(&self, q: &[R], results: &mut Vec<R>) {
        results.clear();
        for Operation { kind, operands } in &self.operations {
            let result = kind.evaluate(operands.map(|operand| operand.value(q, results)));
            results.push(result);
        }
    }

    /// How many of its operations are square roots, sines, cosines and angles.
    pub fn functions(&self) -> usize {
        use OperationKind::{Angle, Cosine, Sine, SquareRoot};
        let is_function = |o: &&Operation| matches!(o.kind, SquareRoot | Sine | Cosine | Angle);
        self.operations.iter().filter(is_function).count()
    }

    /// The operands of its operations, and its outputs.
    pub fn operands(&self) -> impl Iterator<Item = Operand> + '_ {
        let used = self.operations.iter().flat_map(|o| o.operands);
        used.chain(self.outputs.iter().copied())
    }

    /// All constants.
    pub fn constants(&self) -> impl Iterator<Item = f64> + '_ {
        self.operands().filter_map(|operand| match operand {
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
        let of = |kind, operands| Operation { kind, operands };
        let code = StraightLine {
            operations: vec![
                of(OperationKind::Sine, [Coordinate(0); 2]),
                of(OperationKind::Cosine, [Coordinate(0); 2]),
                of(OperationKind::Multiply, [Result(1), Constant(2.0)]),
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
