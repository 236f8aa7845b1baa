//! Expressions in the order of their evaluation: operands first, then what joins them.
//!
//! The tape is also the syntax tree, flat: it is compared, printed and dropped without recursion,
//! however long a sum is.

use super::function::{Binary, Comparison, Constant, Function, Unary};
use super::jet::Scalar;

/// How many intermediate results a tape may keep at once. The parser refuses a text that needs
/// more, so that evaluation has a fixed place for all of them.
pub(super) const PLACES: usize = 32;

/// As many do for most tapes: clearing all places would take longer than their evaluation.
const FEW: usize = 5;

/// The operations of an expression, and how many results they keep at once.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Tape {
    pub(super) ops: Vec<Op>,
    pub(super) depth: usize,
}

/// One step of an evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Op {
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
    pub(super) fn takes(self) -> usize {
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
    pub(super) fn run<S: Scalar>(&self, variable: impl Fn(usize) -> S) -> S {
        if self.depth <= FEW {
            run::<S, FEW>(&self.ops, variable)
        } else {
            run::<S, PLACES>(&self.ops, variable)
        }
    }
}

/// The result of operations that keep N results at once.
pub(super) fn run<S: Scalar, const N: usize>(ops: &[Op], variable: impl Fn(usize) -> S) -> S {
    let mut places = [S::constant(0.0); N];
    let mut used = 0;
    for &op in ops {
        used -= op.takes();
        let at = &mut places[used..];
        at[0] = match op {
            Op::Number(number) => S::constant(number),
            Op::Constant(constant) => S::constant(constant.value()),
            Op::Variable(index) => variable(index),
            Op::Negate => at[0].negate(),
            Op::Unary(function) => at[0].unary(function),
            Op::Binary(operation) => at[0].binary(operation, at[1]),
            Op::Clamp => at[0].binary(Binary::Max, at[1]).binary(Binary::Min, at[2]),
            Op::If(comparison) => {
                let [a, b] = [at[0].value(), at[1].value()];
                if a.is_nan() || b.is_nan() {
                    S::constant(f64::NAN)
                } else if comparison.holds(a, b) {
                    at[2]
                } else {
                    at[3]
                }
            }
        };
        used += 1;
    }
    places[0]
}

/// How tightly a printed text holds together.
const SUM: u8 = 1;
const PRODUCT: u8 = 3;
const NEGATION: u8 = 5;
const POWER: u8 = 8;
const ATOM: u8 = 9;

/// A text that the parser reads as these operations again, with no more parentheses than it needs.
pub(super) fn print<'a>(ops: &[Op], name: impl Fn(usize) -> &'a str) -> String {
    let mut parts: Vec<(String, u8)> = Vec::new();
    for &op in ops {
        let mut operands = parts.split_off(parts.len() - op.takes()).into_iter();
        let mut next = || operands.next().unwrap_or_default();
        parts.push(match op {
            Op::Number(number) => (print_number(number), ATOM),
            Op::Constant(constant) => {
                let known = Constant::ALL.iter().find(|(_, known)| *known == constant);
                (known.map_or("", |(name, _)| name).to_owned(), ATOM)
            }
            Op::Variable(index) => (print_name(name(index)), ATOM),
            Op::Negate => (format!("-{}", on_the_right(next(), NEGATION + 1)), NEGATION),
            Op::Unary(function) => {
                let name = Function::Unary(function).name();
                (format!("{name}({})", next().0), ATOM)
            }
            Op::Binary(operation) => print_binary(operation, next(), next()),
            Op::Clamp => {
                let [x, low, high] = [next().0, next().0, next().0];
                (format!("clamp({x}, {low}, {high})"), ATOM)
            }
            Op::If(comparison) => {
                let [a, b, yes, no] = [next().0, next().0, next().0, next().0];
                let symbol = comparison.symbol();
                (format!("if({a} {symbol} {b}, {yes}, {no})"), ATOM)
            }
        });
    }
    parts.pop().map_or_else(String::new, |(text, _)| text)
}

fn print_binary(operation: Binary, left: (String, u8), right: (String, u8)) -> (String, u8) {
    let (symbol, level, least_left, least_right) = match operation {
        Binary::Add => (" + ", SUM, SUM, SUM + 1),
        Binary::Subtract => (" - ", SUM, SUM, SUM + 1),
        Binary::Multiply => ("*", PRODUCT, PRODUCT, PRODUCT + 1),
        Binary::Divide => ("/", PRODUCT, PRODUCT, PRODUCT + 1),
        Binary::Power => ("^", POWER, POWER + 1, POWER),
        function => {
            let name = Function::Binary(function).name();
            return (format!("{name}({}, {})", left.0, right.0), ATOM);
        }
    };
    // The left text grows in place: a sum of many terms is printed in time proportional to it.
    let mut text = if left.1 < least_left {
        format!("({})", left.0)
    } else {
        left.0
    };
    text.push_str(symbol);
    text.push_str(&on_the_right(right, least_right));
    (text, level)
}

/// A minus that begins an operand needs no parentheses.
fn on_the_right((text, level): (String, u8), least: u8) -> String {
    if level < least && level != NEGATION {
        format!("({text})")
    } else {
        text
    }
}

/// The shortest digits that give the number again.
fn print_number(number: f64) -> String {
    if number == 0.0 || (1e-4..1e15).contains(&number) {
        format!("{number}")
    } else {
        format!("{number:e}")
    }
}

fn print_name(name: &str) -> String {
    if is_plain(name) {
        name.to_owned()
    } else {
        format!("`{name}`")
    }
}

/// Whether a name can stand without backticks.
pub(super) fn is_plain(name: &str) -> bool {
    name.starts_with(begins_name) && name.chars().all(continues_name)
}

pub(super) fn begins_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

pub(super) fn continues_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '.'
}
