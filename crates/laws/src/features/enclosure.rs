//! Bounds of a function and of its first two derivatives over an interval of its variable.

use super::interval::Interval;
use crate::expression::{Binary, Unary};
use std::f64::consts::LN_10;

/// Value, first and second derivative: each an interval that contains all of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Enclosure(pub(crate) [Interval; 3]);

const ZERO: Interval = Interval { lo: 0.0, hi: 0.0 };
const ONE: Interval = Interval { lo: 1.0, hi: 1.0 };

impl Enclosure {
    pub(crate) const UNKNOWN: Self = Self([Interval::ENTIRE; 3]);

    pub(crate) fn constant(value: f64) -> Self {
        Self([Interval::point(value), ZERO, ZERO])
    }

    /// The variable itself.
    pub(crate) fn variable(over: Interval) -> Self {
        Self([over, ONE, ZERO])
    }

    pub(crate) fn value(self) -> Interval {
        self.0[0]
    }

    /// Any number between two numbers, without known derivatives.
    pub(crate) fn between(low: f64, high: f64) -> Self {
        Self([Interval::checked(low, high), ZERO, ZERO])
    }

    /// The number, if it is constant.
    pub(crate) fn number(self) -> Option<f64> {
        let Interval { lo, hi } = self.value();
        (lo == hi && self.is_constant()).then_some(lo)
    }

    fn is_constant(self) -> bool {
        self.0[1] == ZERO && self.0[2] == ZERO
    }

    pub(crate) fn hull(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].hull(other.0[k])))
    }

    pub(crate) fn negate(self) -> Self {
        Self(self.0.map(Interval::neg))
    }

    pub(crate) fn minus(self, other: Self) -> Self {
        self.plus(other.negate())
    }

    fn plus(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].add(other.0[k])))
    }

    fn times(self, other: Self) -> Self {
        let ([a, a1, a2], [b, b1, b2]) = (self.0, other.0);
        Self([
            a.mul(b),
            a1.mul(b).add(a.mul(b1)),
            a2.mul(b).add(a1.mul(b1).scale(2.0)).add(a.mul(b2)),
        ])
    }

    /// f(self) by the chain rule, from f and its first two derivatives over the values.
    fn chain(self, [f, f1, f2]: [Interval; 3]) -> Self {
        let [_, u1, u2] = self.0;
        if self.is_constant() {
            return Self([f, ZERO, ZERO]);
        }
        Self([f, f1.mul(u1), f2.mul(u1.square()).add(f1.mul(u2))])
    }

    fn recip(self) -> Self {
        let inverse = self.value().recip();
        let square = inverse.square();
        self.chain([inverse, square.neg(), square.mul(inverse).scale(2.0)])
    }

    fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        let first = root.recip().scale(0.5);
        self.chain([root, first, first.div(self.value()).scale(-0.5)])
    }

    fn power(self, exponent: Self) -> Self {
        let Interval { lo: n, hi } = exponent.value();
        if n == hi && exponent.is_constant() {
            let x = self.value();
            let first = x.power(n - 1.0).scale(n);
            let second = match n {
                1.0 => ZERO,
                n => x.power(n - 2.0).scale(n * (n - 1.0)),
            };
            return self.chain([x.power(n), first, second]);
        }
        self.unary(Unary::Ln).times(exponent).unary(Unary::Exp)
    }

    /// A function of it. Piecewise linear functions give no bounds here, because their piece must be decided first.
    pub(crate) fn unary(self, function: Unary) -> Self {
        let x = self.value();
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        let derivatives = match function {
            Unary::Sin => [x.sin(), x.cos(), x.sin().neg()],
            Unary::Cos => [x.cos(), x.sin().neg(), x.cos().neg()],
            Unary::Tan => return self.unary(Unary::Sin).times(self.unary(Unary::Cos).recip()),
            Unary::Asin | Unary::Acos => {
                let root = ONE.sub(x.square()).sqrt().recip();
                let second = x.mul(root).mul(root.square());
                let arcsine = x.growing_within([-1.0, 1.0], f64::asin);
                if function == Unary::Asin {
                    [arcsine, root, second]
                } else {
                    let right_angle = Interval::point(std::f64::consts::FRAC_PI_2);
                    [right_angle.sub(arcsine), root.neg(), second.neg()]
                }
            }
            Unary::Atan => {
                let first = ONE.add(x.square()).recip();
                let second = x.mul(first.square()).scale(-2.0);
                [x.growing(f64::atan), first, second]
            }
            Unary::Sinh => [x.growing(f64::sinh), x.cosh(), x.growing(f64::sinh)],
            Unary::Cosh => [x.cosh(), x.growing(f64::sinh), x.cosh()],
            Unary::Tanh => {
                let tangent = x.growing_within(all, f64::tanh);
                let first = x.cosh().square().recip();
                [tangent, first, tangent.mul(first).scale(-2.0)]
            }
            Unary::Exp => [x.exp(); 3],
            Unary::Ln => {
                let inverse = x.recip();
                let logarithm = x.growing_within([0.0, f64::INFINITY], f64::ln);
                [logarithm, inverse, inverse.square().neg()]
            }
            Unary::Log10 => {
                let factor = Self::constant(1.0 / LN_10);
                return self.unary(Unary::Ln).times(factor);
            }
            Unary::Sqrt => return self.sqrt(),
            Unary::Abs | Unary::Sign | Unary::Floor | Unary::Step => return Self::UNKNOWN,
        };
        self.chain(derivatives)
    }

    /// An operation on two values; `min` and `max` are their hull.
    pub(crate) fn binary(self, operation: Binary, other: Self) -> Self {
        match operation {
            Binary::Add => self.plus(other),
            Binary::Subtract => self.minus(other),
            Binary::Multiply => self.times(other),
            Binary::Divide if other.is_constant() => {
                let factor = other.value().recip();
                Self(self.0.map(|e| e.mul(factor)))
            }
            Binary::Divide => self.times(other.recip()),
            Binary::Power => self.power(other),
            Binary::Hypot => {
                let two = Self::constant(2.0);
                self.power(two).plus(other.power(two)).sqrt()
            }
            // arctan of y/x or x/y, if one of the two is never zero.
            Binary::Atan2 if !other.value().contains(0.0) => {
                let ratio = self.times(other.recip()).unary(Unary::Atan);
                let half_turn = if other.value().lo > 0.0 {
                    Interval::point(0.0)
                } else if self.value().lo >= 0.0 {
                    Interval::point(std::f64::consts::PI)
                } else if self.value().hi < 0.0 {
                    Interval::point(-std::f64::consts::PI)
                } else {
                    return Self::UNKNOWN;
                };
                let [value, ..] = ratio.0;
                let entries = [value.add(half_turn), ratio.0[1], ratio.0[2]];
                Self(entries)
            }
            Binary::Atan2 if !self.value().contains(0.0) => {
                let ratio = other.times(self.recip()).unary(Unary::Atan).negate();
                let quarter = std::f64::consts::FRAC_PI_2 * self.value().lo.signum();
                let [value, ..] = ratio.0;
                let value = value.add(Interval::point(quarter));
                Self([value, ratio.0[1], ratio.0[2]])
            }
            Binary::Atan2 => Self::UNKNOWN,
            Binary::Min | Binary::Max => self.hull(other),
        }
    }
}
