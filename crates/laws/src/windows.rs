//! Switches and pulses of functions between the points of a step at which they are evaluated.
//!
//! An integrator evaluates a function at a few points of a step. Over the step, polynomials represent its variables as accurately as the
//! integration, so interval arithmetic bounds the function in the whole step. A condition that cannot change is excluded immediately;
//! one that changes, in a window of any width, is found by bisection.

use crate::expression::{Binary, HeldPieces, Op, Sides, Unary, run_held_parts};
use crate::features::enclosure::Enclosure;
use crate::features::interval::Interval;
use crate::features::switching::{Operands, enclose_ops};

/// Maximum number of parts of a step that are examined for one function.
const MAX_CELLS: usize = 256;
/// Smallest part, relative to the step: narrower windows are not searched.
const MIN_WIDTH: f64 = 1e-9;
/// Polynomials up to this degree need no search: the points of a step and a parabola through them show their extrema.
const PARABOLA_DEGREE: u32 = 2;
/// Changes below this fraction of a term's largest value are no pulse.
const NEGLIGIBLE: f64 = 1e-9;
/// Smaller values are a tail that underflows; only the rounding of its bounds remains.
pub(crate) const UNDERFLOW: f64 = 1e-290;
/// A pulse is examined if it exceeds the values at the step's ends by this fraction of their difference.
const UNSEEN: f64 = 0.5;
/// Fraction of its height at which a pulse begins.
const BEGINS: f64 = 1e-12;
/// A feature that extends over this fraction of a step on both sides of its maximum is resolved by the method.
const RESOLVED: f64 = 0.25;

/// The variables over a step: polynomials through their values at five equally spaced instants.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// By variable: powers of the time, whose unit is a quarter of the whole.
    coefficients: Vec<[f64; 5]>,
}

/// A pulse between points of evaluation; times are fractions of the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pulse {
    /// Its position.
    pub at: f64,
    /// Distance from its beginning to there.
    pub width: f64,
}

/// A term of an expression that may have a narrow pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NarrowTerm {
    start: usize,
    last: usize,
    /// Its largest value; not finite if unknown.
    scale: f64,
    /// The only variable on which it depends, if the dependence is monotone: as long as this variable is monotone, the
    /// ends of a step show the largest value.
    pub(crate) follows: Option<usize>,
}

/// The variable of which a part is an increasing (1) or decreasing (−1) function; `None` with 0 for a constant.
type Trend = (Option<usize>, f64);

impl Course {
    /// The course through the values of all variables at five equally spaced instants.
    pub fn through(samples: &[&[f64]; 5]) -> Self {
        let of = |i: usize| {
            let mut difference: [f64; 5] = std::array::from_fn(|k| samples[k][i]);
            for order in 1..5 {
                for k in (order..5).rev() {
                    difference[k] -= difference[k - 1];
                }
            }
            let [value, d1, d2, d3, d4] = difference;
            [
                value,
                d1 - d2 / 2.0 + d3 / 3.0 - d4 / 4.0,
                d2 / 2.0 - d3 / 2.0 + 11.0 * d4 / 24.0,
                d3 / 6.0 - d4 / 4.0,
                d4 / 24.0,
            ]
        };
        Self {
            coefficients: (0..samples[0].len()).map(of).collect(),
        }
    }

    /// The course of some of the variables.
    pub fn of(&self, variables: std::ops::Range<usize>) -> Self {
        let own = self.coefficients.get(variables).unwrap_or_default();
        Self {
            coefficients: own.to_vec(),
        }
    }

    fn value(&self, variable: usize, at: f64) -> f64 {
        let own = self.coefficients.get(variable);
        own.map_or(f64::NAN, |c| {
            c.iter().rev().fold(0.0, |sum, c| sum * 4.0 * at + c)
        })
    }

    /// Whether a variable is monotone over the step.
    fn has_one_direction(&self, variable: usize) -> bool {
        let [_, slope, _] = self.enclose(variable, [0.0, 1.0]).0;
        slope.lo > 0.0 || slope.hi < 0.0
    }

    fn enclose(&self, variable: usize, [from, to]: [f64; 2]) -> Enclosure {
        let Some(coefficients) = self.coefficients.get(variable) else {
            return Enclosure::UNKNOWN;
        };
        // Expanded about the middle, where the powers of the remaining distance are small.
        let middle = 2.0 * (from + to);
        let mut shifted = *coefficients;
        for k in 0..4 {
            for j in (k..4).rev() {
                shifted[j] += middle * shifted[j + 1];
            }
        }
        let half = 2.0 * (to - from);
        let [c0, c1, c2, c3, c4] = shifted;
        // Bound by the powers of the half width, with the rounding error of their sum.
        let about = |middle: f64, others: &[f64]| {
            let sum = |sum: f64, c: &f64| (sum + c.abs()) * half;
            let radius = others.iter().rev().fold(0.0, sum) * (1.0 + 16.0 * f64::EPSILON);
            Interval::point(middle).add(Interval::checked(-radius, radius))
        };
        Enclosure([
            about(c0, &[c1, c2, c3, c4]),
            about(c1, &[2.0 * c2, 3.0 * c3, 4.0 * c4]),
            about(2.0 * c2, &[6.0 * c3, 12.0 * c4]),
        ])
    }
}

/// A part of an expression on held pieces, over a course of its variables.
pub(crate) struct Traced<'a> {
    pub(crate) ops: &'a [Op],
    pub(crate) sides: &'a [Sides],
    pub(crate) course: &'a Course,
}

impl<'a> Traced<'a> {
    /// The operations from one to another.
    pub(crate) fn part(
        all: &'a [Op],
        [start, last]: [usize; 2],
        held: &'a HeldPieces,
        course: &'a Course,
    ) -> Self {
        Self {
            ops: &all[start..=last],
            sides: held.sides.get(start..=last).unwrap_or_default(),
            course,
        }
    }

    pub(crate) fn value(&self, at: f64) -> f64 {
        run_held_parts(self.ops, |i| self.course.value(i, at), self.sides)
    }

    pub(crate) fn enclose(&self, over: [f64; 2]) -> Enclosure {
        enclose_ops(self.ops, self.sides, |i| self.course.enclose(i, over))
    }
}

/// Where in a step a function is outside an interval: shortly after the first such instant that the examined parts show, with no
/// earlier instant outside.
pub(crate) fn first_outside(
    bounds: [f64; 2],
    value: impl Fn(f64) -> f64,
    enclose: impl Fn([f64; 2]) -> Enclosure,
) -> Option<f64> {
    outside(bounds, value, enclose, true)
}

/// An instant of a step at which a function is outside an interval, if found: any, or shortly after the first if `first` is set.
fn outside(
    [low, high]: [f64; 2],
    value: impl Fn(f64) -> f64,
    enclose: impl Fn([f64; 2]) -> Enclosure,
    first: bool,
) -> Option<f64> {
    let is_outside = |at: f64| value(at) < low || value(at) > high;
    let mut found = None;
    let mut open = vec![[0.0, 1.0]];
    for _ in 0..MAX_CELLS {
        let Some([from, to]) = open.pop() else { break };
        let [values, slope, _] = enclose([from, to]).0;
        if values.lo >= low && values.hi <= high {
            continue;
        }
        let middle = 0.5 * (from + to);
        // A monotone or constant function lies between its end values.
        let turns = slope.contains(0.0) && slope.magnitude() > 0.0;
        let at = [from, middle, to].into_iter().find(|&at| is_outside(at));
        if let Some(at) = at {
            if !(first && turns && at > from && at - from > MIN_WIDTH) {
                return Some(at);
            }
            // It may be outside earlier, between the points.
            found = Some(at);
            open.clear();
            if at < to {
                open.push([from, at]);
                continue;
            }
        }
        if turns && to - from > MIN_WIDTH {
            open.extend([[middle, to], [from, middle]]);
        }
    }
    found
}

impl NarrowTerm {
    /// The terms of an expression that depend on more than `time`.
    pub(crate) fn all(ops: &[Op], tree: &Operands) -> Vec<Self> {
        let mut found = Vec::new();
        let mut open: Vec<usize> = ops.len().checked_sub(1).into_iter().collect();
        while let Some(last) = open.pop() {
            let (start, of) = (tree.starts[last], &tree.operands[last]);
            if !tree.depends[last][1] || !(start..=last).any(|i| is_narrow(ops, tree, i)) {
                continue;
            }
            match ops[last] {
                Op::Negate
                | Op::Binary(Binary::Add | Binary::Subtract | Binary::Min | Binary::Max)
                | Op::Clamp => open.extend(of),
                Op::If(_) => open.extend(&of[2..]),
                _ => {
                    let anything = enclose_ops(&ops[start..=last], &[], |_| Enclosure::UNKNOWN);
                    let scale = anything.value().magnitude();
                    found.push(Self {
                        start,
                        last,
                        scale,
                        follows: trend(ops, tree, last).and_then(|(variable, _)| variable),
                    });
                }
            }
        }
        found
    }

    /// A pulse of the term between two points that the step does not show.
    pub(crate) fn hidden(&self, ops: &[Op], held: &HeldPieces, course: &Course) -> Option<Pulse> {
        if self.follows.is_some_and(|of| course.has_one_direction(of)) {
            return None;
        }
        let term = Traced::part(ops, [self.start, self.last], held, course);
        let ends = [term.value(0.0), term.value(1.0)];
        let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let scale = if self.scale.is_finite() {
            self.scale
        } else {
            low.abs().max(high.abs())
        };
        let unseen = (UNSEEN * (high - low))
            .max(NEGLIGIBLE * scale)
            .max(UNDERFLOW);
        let enclose = |over: [f64; 2]| term.enclose(over);
        let bounds = [low - unseen, high + unseen];
        let at = outside(bounds, |at| term.value(at), enclose, false)?;
        let excess = |at: f64| (low - term.value(at)).max(term.value(at) - high);
        let at = top_near(at, excess);
        let top = excess(at);
        let is_low = |at: f64| !(0.0..=1.0).contains(&at) || excess(at) < 0.5 * top;
        // A periodic function has other maxima at some distance.
        let is_narrow = |part: &f64| is_low(at - part * RESOLVED) && is_low(at + part * RESOLVED);
        if ![1.0, 0.77, 0.41].iter().any(is_narrow) {
            return None;
        }
        let mut width = MIN_WIDTH;
        while width < at && excess(at - width) > BEGINS * top {
            width *= 2.0;
        }
        Some(Pulse { at, width })
    }
}

/// The maximum of a pulse in a step, starting from a point on it.
fn top_near(mut at: f64, height: impl Fn(f64) -> f64) -> f64 {
    const MAX_MOVES: usize = 200;
    let (mut top, mut reach) = (height(at), RESOLVED);
    for _ in 0..MAX_MOVES {
        if reach < MIN_WIDTH {
            break;
        }
        let sides = [at - reach, at + reach].map(|side| side.clamp(0.0, 1.0));
        match sides.into_iter().find(|&side| height(side) > top) {
            Some(side) => (at, top) = (side, height(side)),
            None => reach *= 0.5,
        }
    }
    at
}

/// Whether an operation can turn a slowly varying operand into a narrow feature. A quotient by a constant is a multiple, and a low power a
/// product; neither can.
fn is_narrow(ops: &[Op], tree: &Operands, i: usize) -> bool {
    match ops[i] {
        Op::Unary(
            Unary::Exp
            | Unary::Tanh
            | Unary::Tan
            | Unary::Sinh
            | Unary::Cosh
            | Unary::Atan
            | Unary::Ln
            | Unary::Log10,
        )
        | Op::Binary(Binary::Atan2) => true,
        Op::Binary(Binary::Divide) => tree.depends[tree.operands[i][1]] != [false; 2],
        Op::Binary(Binary::Power) => {
            !matches!(ops[tree.operands[i][1]], Op::Number(n) if [1.0, 2.0, 3.0].contains(&n))
        }
        _ => false,
    }
}

/// The trend of a part of an expression that is a monotone function of a single variable.
fn trend(ops: &[Op], tree: &Operands, last: usize) -> Option<Trend> {
    if tree.depends[last] == [false; 2] {
        return Some((None, 0.0));
    }
    let of = &tree.operands[last];
    let operand = |i: usize| trend(ops, tree, of[i]);
    // Sign of an operand over all values of the variable: 0 if it has both signs.
    let sign = |i: usize| {
        let part = &ops[tree.starts[of[i]]..=of[i]];
        let range = enclose_ops(part, &[], |_| Enclosure::UNKNOWN).value();
        f64::from(range.lo > 0.0) - f64::from(range.hi < 0.0)
    };
    let times = |(variable, trend): Trend, factor: f64| {
        (trend * factor != 0.0).then_some((variable, trend * factor))
    };
    match ops[last] {
        Op::Variable(variable) => Some((Some(variable), 1.0)),
        Op::Negate => times(operand(0)?, -1.0),
        Op::Unary(Unary::Exp | Unary::Tanh | Unary::Sinh | Unary::Atan) => operand(0),
        Op::Binary(operation @ (Binary::Add | Binary::Subtract)) => {
            let direction = if operation == Binary::Add { 1.0 } else { -1.0 };
            match (operand(0)?, operand(1)?) {
                ((None, _), other) => times(other, direction),
                (one, (None, _)) => Some(one),
                (one, other) => (times(other, direction) == Some(one)).then_some(one),
            }
        }
        Op::Binary(operation @ (Binary::Multiply | Binary::Divide)) => {
            match (operand(0)?, operand(1)?) {
                ((None, _), other) if operation == Binary::Multiply => times(other, sign(0)),
                // A quotient by an operand of constant sign.
                ((None, _), other) => times(other, -sign(0) * sign(1).abs()),
                (one, (None, _)) => times(one, sign(1)),
                _ => None,
            }
        }
        _ => None,
    }
}

/// Whether a function may exceed a bound between points at which it does not.
pub(crate) fn may_hide(ops: &[Op], tree: &Operands, last: usize) -> bool {
    degree(ops, tree, last) > PARABOLA_DEGREE
}

/// The degree of a part as a polynomial; 1000 or more if it is none.
fn degree(ops: &[Op], tree: &Operands, last: usize) -> u32 {
    const NONE: u32 = 1000;
    let of: Vec<u32> = tree.operands[last]
        .iter()
        .map(|&o| degree(ops, tree, o))
        .collect();
    let most = of.iter().copied().max().unwrap_or(0);
    match ops[last] {
        Op::Number(_) | Op::Constant(_) => 0,
        Op::Variable(_) => 1,
        _ if most == 0 => 0,
        Op::Negate | Op::Unary(Unary::Abs) | Op::Clamp => most,
        Op::Binary(Binary::Add | Binary::Subtract | Binary::Min | Binary::Max) => most,
        Op::Unary(Unary::Sign | Unary::Step | Unary::Floor) => 0,
        Op::If(_) => of[2].max(of[3]),
        Op::Binary(Binary::Multiply) => of[0].saturating_add(of[1]),
        Op::Binary(Binary::Divide) if of[1] == 0 => of[0],
        Op::Binary(Binary::Power) => match ops[tree.operands[last][1]] {
            Op::Number(n) if n == 1.0 || n == 2.0 => of[0].saturating_mul(n as u32),
            _ => NONE,
        },
        Op::Unary(_) | Op::Binary(_) => NONE,
    }
}
