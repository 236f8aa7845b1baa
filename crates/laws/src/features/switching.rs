//! Where the pieces of an expression meet: the comparisons, kinks and jumps that depend on one variable only.

use super::enclosure::Enclosure;
use super::interval::Interval;
use crate::expression::{Binary, Expression, Op, Sides, Unary, run_held_parts, run_parts, sign};

/// Values below this are zero in any unit: the tail of a pulse where it underflows.
pub(super) const NOTHING: f64 = 1e-280;

/// An expression as a function of one of its variables, with the others unknown.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pieces {
    ops: Vec<Op>,
    variable: usize,
    /// By operation: index of the first operation of its first operand.
    starts: Vec<usize>,
    /// The functions whose zeros separate the pieces, inner ones first, and the condition of an `if` before its branches.
    pub(super) switches: Vec<Switch>,
    /// The terms that depend on the variable only, by their last operation.
    pub(super) terms: Vec<usize>,
}

/// A function of the variable whose zeros (or integer values) separate pieces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Switch {
    /// The switching operation, and the index of this function of it.
    pub(crate) op: usize,
    pub(crate) function: usize,
    /// The last operation of the minuend and of the subtrahend, if there is one.
    pub(crate) left: usize,
    pub(crate) right: Option<usize>,
    /// Whether it switches at every integer, not only at zero.
    pub(crate) at_integers: bool,
}

impl Switch {
    /// The side on which a value of its function is.
    pub(super) fn side(&self, value: f64) -> f64 {
        if self.at_integers {
            value.floor()
        } else {
            sign(value)
        }
    }
}

/// The operands and dependencies of the operations of an expression.
pub(crate) struct Operands {
    /// By operation: index of the first operation of its first operand.
    pub(crate) starts: Vec<usize>,
    /// By operation: whether it depends on the variable, and on another one.
    pub(crate) depends: Vec<[bool; 2]>,
    /// By operation: the last operation of each operand.
    pub(crate) operands: Vec<Vec<usize>>,
}

impl Operands {
    pub(crate) fn of(ops: &[Op], variable: Option<usize>) -> Self {
        let mut found = Self {
            starts: Vec::with_capacity(ops.len()),
            depends: Vec::with_capacity(ops.len()),
            operands: Vec::with_capacity(ops.len()),
        };
        let mut stack: Vec<usize> = Vec::new();
        for (i, op) in ops.iter().enumerate() {
            let of = stack.split_off(stack.len().saturating_sub(op.arity()));
            let own = match op {
                Op::Variable(index) => [Some(*index) == variable, Some(*index) != variable],
                _ => [false; 2],
            };
            let all = of.iter().map(|&o| found.depends[o]);
            let depends = all.fold(own, |[a, b], [c, d]| [a || c, b || d]);
            let start = of.first().map_or(i, |&first| found.starts[first]);
            found.depends.push(depends);
            found.starts.push(start);
            found.operands.push(of);
            stack.push(i);
        }
        found
    }

    /// Whether two operands are identical, so that their difference is zero everywhere.
    pub(crate) fn is_same(&self, ops: &[Op], a: usize, b: usize) -> bool {
        ops[self.starts[a]..=a] == ops[self.starts[b]..=b]
    }
}

impl Pieces {
    pub(super) fn of(expression: &Expression, variable: usize) -> Self {
        let ops = expression.ops().to_vec();
        let tree = Operands::of(&ops, Some(variable));
        let (depends, operands) = (&tree.depends, &tree.operands);
        let is_alone = |i: usize| depends[i] == [true, false];
        let mut pieces = Self {
            switches: Vec::new(),
            terms: Vec::new(),
            variable,
            starts: tree.starts.clone(),
            ops,
        };
        for (i, of) in operands.iter().enumerate() {
            let found = switches_of(pieces.ops[i], i, of);
            let separable = |s: &Switch| match s.right {
                None => is_alone(s.left),
                Some(right) => {
                    let neither = !depends[s.left][1] && !depends[right][1];
                    neither
                        && (is_alone(s.left) || is_alone(right))
                        && !tree.is_same(&pieces.ops, s.left, right)
                }
            };
            let found: Vec<Switch> = found.into_iter().filter(separable).collect();
            pieces.switches.extend(found);
        }
        // A condition is decided before what depends on it.
        pieces
            .switches
            .sort_by_key(|s| match (pieces.ops[s.op], s.right) {
                (Op::If(_), Some(right)) => right,
                _ => s.op,
            });
        let mut open: Vec<usize> = pieces.ops.len().checked_sub(1).into_iter().collect();
        while let Some(i) = open.pop() {
            let is_sum = matches!(
                pieces.ops[i],
                Op::Negate | Op::Binary(Binary::Add | Binary::Subtract)
            );
            if is_alone(i) && !is_sum {
                pieces.terms.push(i);
            } else if depends[i][0] {
                open.extend(&operands[i]);
            }
        }
        pieces
    }

    /// Number of operations, each of which has its sides.
    pub(super) fn len(&self) -> usize {
        self.ops.len()
    }

    /// Bounds of the part that ends with operation `last`, over an interval of the variable with these sides.
    pub(super) fn enclose(&self, last: usize, over: Interval, sides: &[Sides]) -> Enclosure {
        let first = self.starts[last];
        let is_own = |index| index == self.variable;
        let variable = |index| {
            if is_own(index) {
                Enclosure::variable(over)
            } else {
                Enclosure::UNKNOWN
            }
        };
        enclose_ops(&self.ops[first..=last], &sides[first..=last], variable)
    }

    /// Bounds of a switch's function.
    pub(super) fn enclose_switch(
        &self,
        switch: &Switch,
        over: Interval,
        sides: &[Sides],
    ) -> Enclosure {
        let left = self.enclose(switch.left, over, sides);
        match switch.right {
            None => left,
            Some(right) => left.minus(self.enclose(right, over, sides)),
        }
    }

    /// The side of a switch whose function is zero within rounding throughout an interval: 0 if it is exactly zero, as `abs(t) - t`
    /// after 0. If both pieces agree within rounding, as `max(sin(t), t)` near 0, either side is taken.
    pub(super) fn resting_side(
        &self,
        switch: &Switch,
        over: Interval,
        sides: &[Sides],
    ) -> Option<f64> {
        /// Rounding error of the slopes of all parts together, relative to the largest.
        const ROUNDING: f64 = 1e-13;
        let middle = 0.5 * (over.lo + over.hi);
        let values = [over.lo, middle, over.hi].map(|x| self.switch_value(switch, x));
        let [bounds, slope, _] = self.enclose_switch(switch, over, sides).0;
        let slopes = self.largest_slope(switch, over, sides);
        if values == [0.0; 3] && slope.magnitude() <= ROUNDING * slopes {
            return Some(0.0);
        }
        let meet = match self.ops[switch.op] {
            Op::Unary(Unary::Abs) | Op::Binary(Binary::Min | Binary::Max) | Op::Clamp => {
                self.rounding(switch, over, sides)
            }
            _ => 0.0,
        };
        let apart = values[1].abs() + 0.5 * over.width() * slope.magnitude();
        let is_zero = apart.min(bounds.magnitude()) <= meet + NOTHING;
        is_zero.then(|| sign(values[1]))
    }

    /// The rounding error of a switch's function.
    pub(super) fn rounding(&self, switch: &Switch, over: Interval, sides: &[Sides]) -> f64 {
        const ROUNDINGS: f64 = 64.0 * f64::EPSILON;
        let parts = std::iter::once(switch.left).chain(switch.right);
        ROUNDINGS * parts.map(|last| self.size(last, over, sides)).sum::<f64>()
    }

    /// The scale of the rounding error of a part: the size of its terms, which may cancel.
    fn size(&self, last: usize, over: Interval, sides: &[Sides]) -> f64 {
        let of_operands = |count: usize| {
            let ends =
                std::iter::successors(last.checked_sub(1), |&end| self.starts[end].checked_sub(1));
            ends.take(count).map(|end| self.size(end, over, sides))
        };
        match self.ops[last] {
            Op::Negate | Op::Unary(Unary::Abs) => of_operands(1).sum(),
            Op::Binary(Binary::Add | Binary::Subtract) => of_operands(2).sum(),
            Op::Binary(Binary::Multiply) => of_operands(2).product(),
            Op::Binary(Binary::Min | Binary::Max) => of_operands(2).fold(0.0, f64::max),
            _ => self.enclose(last, over, sides).value().magnitude(),
        }
    }

    /// Whether an operation belongs to the branch that a decided `if` does not take.
    pub(super) fn is_unused(&self, op: usize, sides: &[Sides]) -> bool {
        let outer = self.ops.iter().zip(sides).enumerate().skip(op + 1);
        let mut unused = outer.filter_map(|(i, (outer, [side, _]))| match (outer, side) {
            (Op::If(comparison), &Some(side)) => {
                let no = self.starts[i - 1];
                Some(if comparison.holds(side, 0.0) {
                    no..i
                } else {
                    self.starts[no - 1]..no
                })
            }
            _ => None,
        });
        unused.any(|branch| branch.contains(&op))
    }

    /// The largest slope of all parts of a switch's function.
    fn largest_slope(&self, switch: &Switch, over: Interval, sides: &[Sides]) -> f64 {
        let parts = std::iter::once(switch.left)
            .chain(switch.right)
            .flat_map(|last| self.starts[last]..=last);
        let slopes = parts.map(|last| self.enclose(last, over, sides).0[1].magnitude());
        slopes.fold(0.0, f64::max)
    }

    /// The value of a switch's function.
    pub(super) fn switch_value(&self, switch: &Switch, x: f64) -> f64 {
        let part = |last: usize| {
            let variable = |index| if index == self.variable { x } else { f64::NAN };
            run_parts(&self.ops[self.starts[last]..=last], variable)
        };
        part(switch.left) - switch.right.map_or(0.0, part)
    }

    /// The value of a term.
    pub(super) fn term_value(&self, last: usize, x: f64) -> f64 {
        run_parts(&self.ops[self.starts[last]..=last], |_| x)
    }
}

/// Bounds of an expression from bounds of its variables, on the given sides.
pub(crate) fn enclose_ops(
    ops: &[Op],
    sides: &[Sides],
    variable: impl Fn(usize) -> Enclosure,
) -> Enclosure {
    let mut stack: Vec<Enclosure> = Vec::new();
    for (i, &op) in ops.iter().enumerate() {
        let first = stack.len().saturating_sub(op.arity());
        let (of, held) = (&stack[first..], sides.get(i).copied().unwrap_or_default());
        let number = exact(op, of, held).map(Enclosure::constant);
        let found = number.unwrap_or_else(|| enclose_op(op, of, held, &variable));
        stack.truncate(first);
        stack.push(found);
    }
    stack.pop().unwrap_or(Enclosure::UNKNOWN)
}

fn enclose_op(
    op: Op,
    operands: &[Enclosure],
    [side, second]: Sides,
    variable: impl Fn(usize) -> Enclosure,
) -> Enclosure {
    let [side, second] = decided(op, operands, [side, second]);
    let choose = |side: Option<f64>, above: Enclosure, below: Enclosure| match side {
        Some(s) if s > 0.0 => above,
        Some(_) => below,
        None => above.hull(below),
    };
    match (op, operands) {
        (Op::Number(number), _) => Enclosure::constant(number),
        (Op::Constant(constant), _) => Enclosure::constant(constant.value()),
        (Op::Variable(index), _) => variable(index),
        (Op::Negate, &[x]) => x.negate(),
        (Op::Unary(Unary::Abs), &[x]) => choose(side, x, x.negate()),
        (Op::Unary(Unary::Sign), &[_]) => {
            Enclosure::between(side.unwrap_or(-1.0), side.unwrap_or(1.0))
        }
        (Op::Unary(Unary::Step), &[_]) => {
            let step = |side: f64| f64::from(u8::from(side >= 0.0));
            Enclosure::between(step(side.unwrap_or(-1.0)), step(side.unwrap_or(1.0)))
        }
        (Op::Unary(Unary::Floor), &[x]) => match side {
            Some(whole) => Enclosure::constant(whole),
            None => {
                let Interval { lo, hi } = x.value();
                Enclosure::between(lo.floor(), hi.floor())
            }
        },
        (Op::Unary(function), &[x]) => x.unary(function),
        (Op::Binary(Binary::Max), &[a, b]) => choose(side, a, b),
        (Op::Binary(Binary::Min), &[a, b]) => choose(side, b, a),
        (Op::Binary(operation), &[a, b]) => a.binary(operation, b),
        (Op::Clamp, &[x, low, high]) => {
            if low.value().hi > high.value().lo {
                return x.hull(low).hull(high);
            }
            choose(second, high, choose(side, x, low))
        }
        (Op::If(comparison), &[_, _, yes, no]) => match side {
            Some(side) if comparison.holds(side, 0.0) => yes,
            Some(_) => no,
            None => yes.hull(no),
        },
        _ => Enclosure::UNKNOWN,
    }
}

/// The held sides of an operation, or, if none is held, the sides that its compared values determine.
fn decided(op: Op, operands: &[Enclosure], [side, second]: Sides) -> Sides {
    let decide = |held: Option<f64>, difference: Enclosure| {
        let Interval { lo, hi } = difference.value();
        let by_value = if lo > 0.0 {
            Some(1.0)
        } else {
            (hi < 0.0).then_some(-1.0)
        };
        held.or(by_value)
    };
    match (op, operands) {
        (Op::Unary(Unary::Abs | Unary::Sign | Unary::Step), &[x]) => [decide(side, x), None],
        (Op::Binary(Binary::Min | Binary::Max), &[a, b]) | (Op::If(_), &[a, b, _, _]) => {
            [decide(side, a.minus(b)), None]
        }
        (Op::Clamp, &[x, low, high]) => [decide(side, x.minus(low)), decide(second, x.minus(high))],
        _ => [side, second],
    }
}

/// The value of an operation on constants, as evaluation yields it: a constant on a threshold is exactly on it.
fn exact(op: Op, operands: &[Enclosure], sides: Sides) -> Option<f64> {
    if op.arity() == 0 {
        return None;
    }
    if operands.iter().any(|o| o.number().is_none()) {
        // A product with zero is constant.
        let is_zero = |o: &Enclosure| o.number() == Some(0.0);
        let is_product = op == Op::Binary(Binary::Multiply);
        return (is_product && operands.iter().any(is_zero)).then_some(0.0);
    }
    let mut held = vec![Sides::default(); operands.len()];
    held.push(sides);
    let numbers = operands.iter().filter_map(|o| o.number());
    let mut ops: Vec<Op> = numbers.map(Op::Number).collect();
    ops.push(op);
    Some(run_held_parts(&ops, |_| f64::NAN, &held)).filter(|value: &f64| value.is_finite())
}

/// The functions whose zeros separate the pieces of an operation.
// Long because every kind of operation is named.
pub(crate) fn switches_of(operation: Op, op: usize, operands: &[usize]) -> Vec<Switch> {
    let zero = |function, left, right| Switch {
        op,
        function,
        left,
        right,
        at_integers: false,
    };
    match (operation, operands) {
        (Op::Unary(Unary::Abs | Unary::Sign | Unary::Step), &[x]) => vec![zero(0, x, None)],
        (Op::Unary(Unary::Floor), &[x]) => vec![Switch {
            at_integers: true,
            ..zero(0, x, None)
        }],
        (Op::Binary(Binary::Min | Binary::Max), &[a, b]) => vec![zero(0, a, Some(b))],
        // Its cut: y = 0 on the left.
        (Op::Binary(Binary::Atan2), &[y, _]) => vec![zero(0, y, None)],
        (Op::Clamp, &[x, low, high]) => {
            vec![zero(0, x, Some(low)), zero(1, x, Some(high))]
        }
        (Op::If(_), &[a, b, ..]) => vec![zero(0, a, Some(b))],
        // Smooth wherever they are finite. Every kind is listed, so that a new one must be classified.
        (
            Op::Number(_)
            | Op::Constant(_)
            | Op::Variable(_)
            | Op::Negate
            | Op::Unary(
                Unary::Sin
                | Unary::Cos
                | Unary::Tan
                | Unary::Asin
                | Unary::Acos
                | Unary::Atan
                | Unary::Sinh
                | Unary::Cosh
                | Unary::Tanh
                | Unary::Exp
                | Unary::Ln
                | Unary::Log10
                | Unary::Sqrt,
            )
            | Op::Binary(
                Binary::Add
                | Binary::Subtract
                | Binary::Multiply
                | Binary::Divide
                | Binary::Power
                | Binary::Hypot,
            ),
            _,
        ) => Vec::new(),
        // The parser guarantees the operands of each operation.
        (
            Op::Unary(Unary::Abs | Unary::Sign | Unary::Step | Unary::Floor)
            | Op::Binary(Binary::Min | Binary::Max | Binary::Atan2)
            | Op::Clamp
            | Op::If(_),
            _,
        ) => Vec::new(),
    }
}
