//! The functions that an expression may use: their names, values and derivatives.

use std::f64::consts::{LN_10, PI, TAU};

/// A named number. (Euler's number has no name: `e` is a likely name in a scene.)
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Constant {
    Pi,
    Tau,
}

impl Constant {
    pub(super) const ALL: [(&'static str, Self); 2] = [("pi", Self::Pi), ("tau", Self::Tau)];

    pub(crate) fn value(self) -> f64 {
        match self {
            Self::Pi => PI,
            Self::Tau => TAU,
        }
    }
}

/// A function of one argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unary {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Log10,
    Sqrt,
    Abs,
    Sign,
    Floor,
    Step,
}

/// An operation on two arguments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Atan2,
    Hypot,
    Min,
    Max,
}

/// How `if` compares two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Comparison {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

/// The function that a name before a parenthesis refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Function {
    Unary(Unary),
    Binary(Binary),
    Clamp,
    If,
}

impl Function {
    pub(super) const ALL: [(&'static str, Self); 23] = [
        ("sin", Self::Unary(Unary::Sin)),
        ("cos", Self::Unary(Unary::Cos)),
        ("tan", Self::Unary(Unary::Tan)),
        ("asin", Self::Unary(Unary::Asin)),
        ("acos", Self::Unary(Unary::Acos)),
        ("atan", Self::Unary(Unary::Atan)),
        ("sinh", Self::Unary(Unary::Sinh)),
        ("cosh", Self::Unary(Unary::Cosh)),
        ("tanh", Self::Unary(Unary::Tanh)),
        ("exp", Self::Unary(Unary::Exp)),
        ("ln", Self::Unary(Unary::Ln)),
        ("log10", Self::Unary(Unary::Log10)),
        ("sqrt", Self::Unary(Unary::Sqrt)),
        ("abs", Self::Unary(Unary::Abs)),
        ("sign", Self::Unary(Unary::Sign)),
        ("floor", Self::Unary(Unary::Floor)),
        ("step", Self::Unary(Unary::Step)),
        ("atan2", Self::Binary(Binary::Atan2)),
        ("hypot", Self::Binary(Binary::Hypot)),
        ("min", Self::Binary(Binary::Min)),
        ("max", Self::Binary(Binary::Max)),
        ("clamp", Self::Clamp),
        ("if", Self::If),
    ];

    pub(super) fn from_name(name: &str) -> Option<Self> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found.map(|&(_, function)| function)
    }

    pub(super) fn name(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, known)| *known == self);
        found.map_or("", |&(name, _)| name)
    }

    /// Number of arguments; the comparison of `if` counts as one.
    pub(super) fn argument_count(self) -> usize {
        match self {
            Self::Unary(_) => 1,
            Self::Binary(_) => 2,
            Self::Clamp | Self::If => 3,
        }
    }
}

impl Comparison {
    pub(crate) fn holds(self, a: f64, b: f64) -> bool {
        match self {
            Self::Less => a < b,
            Self::LessOrEqual => a <= b,
            Self::Greater => a > b,
            Self::GreaterOrEqual => a >= b,
        }
    }
}

/// −1, 0 or 1; NaN of NaN.
pub(crate) fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

impl Unary {
    pub(super) fn value(self, x: f64) -> f64 {
        match self {
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.tan(),
            Self::Asin => x.asin(),
            Self::Acos => x.acos(),
            Self::Atan => x.atan(),
            Self::Sinh => x.sinh(),
            Self::Cosh => x.cosh(),
            Self::Tanh => x.tanh(),
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Log10 => x.log10(),
            Self::Sqrt => x.sqrt(),
            Self::Abs => x.abs(),
            Self::Sign => sign(x),
            Self::Floor => x.floor(),
            Self::Step if x.is_nan() => x,
            Self::Step => f64::from(u8::from(x >= 0.0)),
        }
    }

    /// The first three derivatives at `x`, where the function has that value and is smooth; `None`
    /// for the functions made of straight pieces.
    pub(super) fn derivatives(self, x: f64, value: f64) -> Option<[f64; 3]> {
        Some(match self {
            Self::Sin => [x.cos(), -value, -x.cos()],
            Self::Cos => [-x.sin(), -value, x.sin()],
            Self::Tan => {
                let (t, s) = (value, 1.0 + value * value);
                [s, 2.0 * t * s, 2.0 * s * (1.0 + 3.0 * t * t)]
            }
            Self::Asin => asin_derivatives(x),
            Self::Acos => asin_derivatives(x).map(|d| -d),
            Self::Atan => {
                let d = 1.0 / (1.0 + x * x);
                [d, -2.0 * x * d * d, (6.0 * x * x - 2.0) * d * d * d]
            }
            Self::Sinh => [x.cosh(), value, x.cosh()],
            Self::Cosh => [x.sinh(), value, x.sinh()],
            Self::Tanh => {
                // 1 − tanh² without the cancellation.
                let (t, s) = (value, x.cosh().powi(-2));
                [s, -2.0 * t * s, 2.0 * s * (2.0 * t * t - s)]
            }
            Self::Exp => [value; 3],
            Self::Ln => ln_derivatives(x),
            Self::Log10 => ln_derivatives(x).map(|d| d / LN_10),
            Self::Sqrt => {
                let d = 0.5 / value;
                [d, -0.5 * d / x, 0.75 * d / (x * x)]
            }
            Self::Abs | Self::Sign | Self::Floor | Self::Step => return None,
        })
    }
}

fn asin_derivatives(x: f64) -> [f64; 3] {
    let r = 1.0 / ((1.0 - x) * (1.0 + x));
    let d = r.sqrt();
    [d, x * d * r, (1.0 + 2.0 * x * x) * d * r * r]
}

fn ln_derivatives(x: f64) -> [f64; 3] {
    let d = 1.0 / x;
    [d, -d * d, 2.0 * d * d * d]
}

impl Binary {
    pub(super) fn value(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Power => power(a, b),
            Self::Atan2 => a.atan2(b),
            Self::Hypot => a.hypot(b),
            Self::Min | Self::Max if self.selects_first(a, b) => a,
            Self::Min | Self::Max => b,
        }
    }

    /// Whether `min` or `max` selects its first argument: on a tie it does. NaN is selected,
    /// not hidden.
    pub(super) fn selects_first(self, a: f64, b: f64) -> bool {
        let is_selected = if self == Self::Min { a <= b } else { a >= b };
        a.is_nan() || (is_selected && !b.is_nan())
    }
}

/// aᵇ. Small integer powers are products, which are rounded in the same way on every machine.
pub(super) fn power(a: f64, b: f64) -> f64 {
    if b == 1.0 {
        a
    } else if b == 2.0 {
        a * a
    } else if b == 3.0 {
        a * a * a
    } else {
        a.powf(b)
    }
}
