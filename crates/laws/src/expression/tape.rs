//! Expressions in the order of their evaluation: operands first, then the operation (postfix order).
//!
//! The tape is also the syntax tree, flat: it is compared and dropped without recursion, however long a sum is.

use super::function::{Binary, Comparison, Constant, Unary};
use super::jet::TapeScalar;
use std::f64::consts::TAU;

/// Maximum number of intermediate results of a tape. The parser rejects a text that needs
/// more, so evaluation uses a stack of fixed size.
pub(super) const STACK_SIZE: usize = 32;

/// A smaller stack that suffices for most tapes: clearing the full stack would take longer than their evaluation.
const SMALL_STACK_SIZE: usize = 5;

/// The operations of an expression, and their stack size.
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
    /// The variable with this index in the list given to the parser.
    Variable(usize),
    Negate,
    Unary(Unary),
    Binary(Binary),
    /// Its operands are a value, the lower and the upper bound.
    Clamp,
    /// Its operands are the two compared numbers, the value if the comparison is true, and the value otherwise.
    If(Comparison),
}

impl Op {
    /// Number of operands that it takes from the stack; it pushes one result.
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
        let free = |_| Sides::default();
        if self.depth <= SMALL_STACK_SIZE {
            run::<S, SMALL_STACK_SIZE>(&self.ops, variable, free)
        } else {
            run::<S, STACK_SIZE>(&self.ops, variable, free)
        }
    }

    /// The result, with some operations held on one of their pieces.
    pub(super) fn run_held<S: TapeScalar>(
        &self,
        variable: impl Fn(usize) -> S,
        sides: &[Sides],
    ) -> S {
        run::<S, STACK_SIZE>(&self.ops, variable, |op| sides_of(sides, op))
    }
}

/// The piece on which a switching operation is held: the sign of its function (0 if it rests on zero), or the integer below it.
/// An operation has up to two functions (`clamp`). `None`: not held.
pub(crate) type Sides = [Option<f64>; 2];

/// The pieces on which a function is held, whatever its variables are: of an expression by operation, of a table
/// by number.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HeldPieces {
    pub(crate) sides: Vec<Sides>,
}

impl HeldPieces {
    /// Nothing is held.
    pub const NONE: Self = Self { sides: Vec::new() };

    /// Whether nothing is held.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.sides.is_empty()
    }

    /// The pieces of a function that switches at values of its variables, one for each variable.
    pub fn pieces(&self) -> impl Iterator<Item = Option<f64>> {
        self.sides.iter().map(|[piece, _]| *piece)
    }
}

fn sides_of(sides: &[Sides], op: usize) -> Sides {
    sides.get(op).copied().unwrap_or_default()
}

/// The result of operations with the stack size N; `held` gives the sides on which each operation is held.
pub(super) fn run<S: TapeScalar, const N: usize>(
    ops: &[Op],
    variable: impl Fn(usize) -> S,
    held: impl Fn(usize) -> Sides,
) -> S {
    let mut stack = [S::constant(0.0); N];
    let mut depth = 0;
    for (i, &op) in ops.iter().enumerate() {
        depth -= op.arity();
        let operands = &mut stack[depth..];
        let sides = held(i);
        if sides != Sides::default() {
            operands[0] = held_piece(op, operands, sides);
            depth += 1;
            continue;
        }
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

/// A switching operation on the piece given by its sides, whatever its operands are.
fn held_piece<S: TapeScalar>(op: Op, operands: &[S], [side, second]: Sides) -> S {
    let difference = |a: usize, b: usize| operands[a].value() - operands[b].value();
    if op == Op::Clamp {
        // Each of its two bounds may be held.
        let above_low = side.unwrap_or_else(|| difference(0, 1)) > 0.0;
        let above_high = second.unwrap_or_else(|| difference(0, 2)) > 0.0
            || !above_low && difference(1, 2) > 0.0;
        return operands[if above_high {
            2
        } else {
            usize::from(!above_low)
        }];
    }
    let side = side.unwrap_or(0.0);
    let choose = |above: S, below: S| if side > 0.0 { above } else { below };
    match op {
        Op::Unary(Unary::Abs) if side == 0.0 => S::constant(0.0),
        Op::Unary(Unary::Abs) => choose(operands[0], operands[0].negate()),
        Op::Unary(Unary::Sign | Unary::Floor) => S::constant(side),
        Op::Unary(Unary::Step) => S::constant(f64::from(u8::from(side >= 0.0))),
        Op::Binary(Binary::Max) => choose(operands[0], operands[1]),
        Op::Binary(Binary::Min) => choose(operands[1], operands[0]),
        Op::Binary(Binary::Atan2) => {
            // Continued across its cut, y = 0 on the left.
            let [y, x] = [operands[0], operands[1]];
            let beyond = x.value() < 0.0 && y.value() * side < 0.0;
            let turn = if beyond { TAU * side } else { 0.0 };
            y.binary(Binary::Atan2, x)
                .binary(Binary::Add, S::constant(turn))
        }
        Op::If(comparison) if comparison.holds(side, 0.0) => operands[2],
        Op::If(_) => operands[3],
        // The others do not switch.
        Op::Number(_)
        | Op::Constant(_)
        | Op::Variable(_)
        | Op::Negate
        | Op::Clamp
        | Op::Unary(_)
        | Op::Binary(_) => S::constant(f64::NAN),
    }
}

/// The value of a part of a tape that is a complete expression.
pub(crate) fn run_parts(ops: &[Op], variable: impl Fn(usize) -> f64) -> f64 {
    run_held_parts(ops, variable, &[])
}

/// The value of such a part, with some of its operations held on one of their pieces.
pub(crate) fn run_held_parts<S: TapeScalar>(
    ops: &[Op],
    variable: impl Fn(usize) -> S,
    sides: &[Sides],
) -> S {
    run::<S, STACK_SIZE>(ops, variable, |op| sides_of(sides, op))
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
