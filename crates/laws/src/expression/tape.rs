//! Expressions in the order of their evaluation: operands first, then what joins them.
//!
//! The tape is also the syntax tree, flat: it is compared and dropped without recursion, however long a sum is.

use super::function::{Binary, Comparison, Constant, Unary};
use super::jet::TapeScalar;

/// How many intermediate results a tape may keep at once. The parser refuses a text that needs
/// more, so that evaluation has a fixed place for all of them.
pub(super) const STACK_SIZE: usize = 32;

/// As many do for most tapes: clearing all places would take longer than their evaluation.
const SMALL_STACK_SIZE: usize = 5;

/// The operations of an expression, and how many results they keep at once.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Tape {
    pub(super) ops: Vec<Op>,
    pub(super) depth: usize,
}

/// One step of an evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Op {
    Number(f64),
    Constant(Constant),
    /// The variable of that place in the list given to the parser.
    Variable(usize),
    Negate,
    Unary(Unary),
    Binary(Binary),
    /// Of a value, the lower and the upper bound.
    Clamp,
    /// Of the two numbers compared, the value if it holds, and the value else.
    If(Comparison),
}

impl Op {
    /// How many results it takes from the places; it leaves one.
    pub(crate) fn arity(self) -> usize {
        match self {
            Self::Number(_) | Self::Constant(_) | Self::Variable(_) => 0,
            Self::Negate | Self::Unary(_) => 1,
            Self::Binary(_) => 2,
            Self::Clamp => 3,
            Self::If(_) => 4,
        }
    }
}

impl Tape {
    /// The result; `variable` gives the value of each variable.
    pub(super) fn run<S: TapeScalar>(&self, variable: impl Fn(usize) -> S) -> S {
        if self.depth <= SMALL_STACK_SIZE {
            run::<S, SMALL_STACK_SIZE>(&self.ops, variable)
        } else {
            run::<S, STACK_SIZE>(&self.ops, variable)
        }
    }
}

/// The result of operations that keep N results at once.
pub(super) fn run<S: TapeScalar, const N: usize>(ops: &[Op], variable: impl Fn(usize) -> S) -> S {
    let mut stack = [S::constant(0.0); N];
    let mut depth = 0;
    for &op in ops {
        depth -= op.arity();
        let operands = &mut stack[depth..];
        operands[0] = match op {
            Op::Number(number) => S::constant(number),
            Op::Constant(constant) => S::constant(constant.value()),
            Op::Variable(index) => variable(index),
            Op::Negate => operands[0].negate(),
            Op::Unary(function) => operands[0].unary(function),
            Op::Binary(operation) => operands[0].binary(operation, operands[1]),
            Op::Clamp => operands[0]
                .binary(Binary::Max, operands[1])
                .binary(Binary::Min, operands[2]),
            Op::If(comparison) => {
                let [a, b] = [operands[0].value(), operands[1].value()];
                if a.is_nan() || b.is_nan() {
                    S::constant(f64::NAN)
                } else if comparison.holds(a, b) {
                    operands[2]
                } else {
                    operands[3]
                }
            }
        };
        depth += 1;
    }
    stack[0]
}

/// The value of a part of a tape, which is an expression of its own.
pub(crate) fn run_parts(ops: &[Op], variable: impl Fn(usize) -> f64) -> f64 {
    run::<f64, STACK_SIZE>(ops, variable)
}

/// Whether a name can stand without backticks.
pub(super) fn is_identifier(name: &str) -> bool {
    name.starts_with(starts_identifier) && name.chars().all(continues_identifier)
}

pub(super) fn starts_identifier(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

pub(super) fn continues_identifier(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '.'
}
