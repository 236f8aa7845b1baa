//! Expressions in the order of their evaluation: operands first, then what joins them.
//!
//! The tape is also the syntax tree, flat: it is compared and dropped without recursion, however long a sum is.

use super::function::{Binary, Comparison, Constant, Unary};
use super::jet::TapeScalar;
use std::f64::consts::TAU;

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
        let free = |_| Sides::default();
        if self.depth <= SMALL_STACK_SIZE {
            run::<S, SMALL_STACK_SIZE>(&self.ops, variable, free)
        } else {
            run::<S, STACK_SIZE>(&self.ops, variable, free)
        }
    }

    /// The result where some operations are held on one of their pieces.
    pub(super) fn run_held<S: TapeScalar>(
        &self,
        variable: impl Fn(usize) -> S,
        sides: &[Sides],
    ) -> S {
        run::<S, STACK_SIZE>(&self.ops, variable, |op| sides_of(sides, op))
    }
}

/// Which piece of a switching operation holds: the sign of its function (0 where it rests on zero), or the whole number below it.
/// An operation has up to two functions (`clamp`). None: as its operands say.
pub(crate) type Sides = [Option<f64>; 2];

/// Which pieces of a function hold, wherever its variables are: those of an expression by operation, that of a table
/// by its number.
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

    /// The pieces of a function that is held by the values of its variables, one for each.
    pub fn pieces(&self) -> impl Iterator<Item = Option<f64>> {
        self.sides.iter().map(|[piece, _]| *piece)
    }
}

fn sides_of(sides: &[Sides], op: usize) -> Sides {
    sides.get(op).copied().unwrap_or_default()
}

/// The result of operations that keep N results at once; `held` gives the sides on which each operation is held.
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

/// A switching operation on the piece that its sides name, wherever its operands are.
fn held_piece<S: TapeScalar>(op: Op, operands: &[S], [side, second]: Sides) -> S {
    let difference = |a: usize, b: usize| operands[a].value() - operands[b].value();
    if op == Op::Clamp {
        // Each of its bounds is held or not.
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

/// The value of a part of a tape, which is an expression of its own.
pub(crate) fn run_parts(ops: &[Op], variable: impl Fn(usize) -> f64) -> f64 {
    run_held_parts(ops, variable, &[])
}

/// The same where some of its operations are held on one of their pieces.
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
