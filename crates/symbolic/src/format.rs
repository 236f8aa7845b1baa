//! Terms as text, in LaTeX or as code.

use crate::algebra::{Node, Term};

/// A programming language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// Rust, `f64`.
    Rust,
    /// C99, `double`.
    C,
    /// Python 3.
    Python,
}

/// How terms are written.
pub(crate) enum OutputStyle<'a> {
    Code(Language),
    /// With the name of a symbol in LaTeX, and whether it is a constant.
    Latex(&'a dyn Fn(&str) -> String, &'a dyn Fn(&str) -> bool),
}

/// How tightly what surrounds a term binds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Precedence {
    Lowest,
    Product,
    /// The operand of a power, a method or a sign.
    Highest,
}

impl OutputStyle<'_> {
    /// A term as text.
    pub(crate) fn text(&self, term: &Term) -> String {
        self.write(term, Precedence::Lowest)
    }

    /// The summands of a term, each with its sign: what is added comes first.
    pub(crate) fn summands(&self, term: &Term) -> Vec<(bool, String)> {
        let mut found = Vec::new();
        summands(term, false, &mut found);
        if let (Self::Latex(..), Some(first)) = (self, found.iter().position(|s| !s.0)) {
            let positive = found.remove(first);
            found.insert(0, positive);
        }
        let only_one = found.len() == 1;
        let text = |(minus, term): (bool, Term)| {
            let precedence = if only_one && !minus {
                Precedence::Lowest
            } else {
                Precedence::Product
            };
            (minus, self.single(&term, precedence))
        };
        found.into_iter().map(text).collect()
    }

    fn write(&self, term: &Term, precedence: Precedence) -> String {
        let summands = self.summands(term);
        if let [(false, _)] = summands.as_slice() {
            return self.single(&unsigned(term).0, precedence);
        }
        let mut text = String::new();
        for (k, (minus, one)) in summands.iter().enumerate() {
            text += sign(k, *minus);
            text += one;
        }
        self.bracketed(text, precedence != Precedence::Lowest)
    }

    /// A text, in brackets if `needed`.
    fn bracketed(&self, text: String, needed: bool) -> String {
        match self {
            _ if !needed => text,
            Self::Code(_) => format!("({text})"),
            Self::Latex(..) => format!("\\left({text}\\right)"),
        }
    }

    /// A term without sign that is not a sum.
    fn single(&self, term: &Term, precedence: Precedence) -> String {
        match term.as_ref() {
            Node::Mul(..) | Node::Div(..) => self.product(term, precedence),
            Node::Add(..) | Node::Sub(..) | Node::Neg(_) => self.write(term, precedence),
            Node::Pow(base, exponent) => self.power(base, exponent, precedence),
            _ => self.atom(term),
        }
    }

    fn product(&self, term: &Term, precedence: Precedence) -> String {
        let (mut above, mut below) = (Vec::new(), Vec::new());
        factors(term, &mut above, &mut below);
        let join = |terms: &[Term], separator: &str| {
            let one = |t: &Term| self.write(t, Precedence::Product);
            terms.iter().map(one).collect::<Vec<_>>().join(separator)
        };
        let (text, binds_tighter) = match self {
            Self::Latex(_, constant) => {
                self.halves(&mut above, &mut below);
                above.sort_by_key(|t| factor_order(t, constant));
                below.sort_by_key(|t| factor_order(t, constant));
                let of = |terms: &[Term]| match terms {
                    [] => "1".to_owned(),
                    [one] => self.write(one, Precedence::Lowest),
                    many => join(many, " \\, "),
                };
                if !below.is_empty() {
                    return format!("\\frac{{{}}}{{{}}}", of(&above), of(&below));
                }
                (join(&above, " \\, "), Precedence::Product)
            }
            Self::Code(_) => {
                let product = match above.as_slice() {
                    [] => "1.0".to_owned(),
                    factors => join(factors, " * "),
                };
                match below.as_slice() {
                    [] => (product, Precedence::Product),
                    [one] => {
                        let divisor = self.write(one, Precedence::Highest);
                        (format!("{product} / {divisor}"), Precedence::Lowest)
                    }
                    many => (
                        format!("{product} / ({})", join(many, " * ")),
                        Precedence::Lowest,
                    ),
                }
            }
        };
        self.bracketed(text, precedence > binds_tighter)
    }

    /// Turns a factor of one half into a denominator of two.
    fn halves(&self, above: &mut Vec<Term>, below: &mut Vec<Term>) {
        above.retain(|term| {
            let Node::Const(value) = term.as_ref() else {
                return true;
            };
            let whole = inverse(*value);
            below.extend(whole.map(crate::algebra::number));
            whole.is_none() && *value != 1.0
        });
    }

    fn power(&self, base: &Term, exponent: &Term, precedence: Precedence) -> String {
        let whole = match exponent.as_ref() {
            Node::Const(n) if n.fract() == 0.0 && n.abs() < 100.0 => Some(*n as i32),
            _ => None,
        };
        let tight = self.write(base, Precedence::Highest);
        match (self, whole) {
            (Self::Latex(..), _) => {
                let exponent = self.write(exponent, Precedence::Lowest);
                // The power of a function is written at its name, that of a derivative outside brackets.
                match base.as_ref() {
                    Node::Cos(angle) if whole == Some(2) => {
                        format!("\\cos^2 {}", self.write(angle, Precedence::Highest))
                    }
                    Node::Sin(angle) if whole == Some(2) => {
                        format!("\\sin^2 {}", self.write(angle, Precedence::Highest))
                    }
                    Node::Sym(_) if tight.contains(['\'', ' ']) => {
                        format!("{{{tight}}}^{{{exponent}}}")
                    }
                    _ => format!("{tight}^{{{exponent}}}"),
                }
            }
            (Self::Code(Language::Rust), Some(n)) => {
                // A literal needs a type before a method call.
                format!("{tight}.powi({n})")
            }
            (Self::Code(Language::C), Some(2)) if matches!(base.as_ref(), Node::Sym(_)) => {
                let text = format!("{tight} * {tight}");
                self.bracketed(text, precedence != Precedence::Lowest)
            }
            (Self::Code(Language::C), _) => {
                let base = self.write(base, Precedence::Lowest);
                format!("pow({base}, {})", self.write(exponent, Precedence::Lowest))
            }
            (Self::Code(Language::Python), Some(n)) => format!("{tight}**{n}"),
            (Self::Code(Language::Python), None) => {
                format!("{tight}**{}", self.write(exponent, Precedence::Highest))
            }
            (Self::Code(Language::Rust), None) => {
                format!("{tight}.powf({})", self.write(exponent, Precedence::Lowest))
            }
        }
    }

    fn atom(&self, term: &Term) -> String {
        match term.as_ref() {
            Node::Sym(name) => match self {
                Self::Latex(names, _) => names(name),
                // Common subexpressions are named by the algebra.
                Self::Code(_) => name.replace("__x", "t"),
            },
            Node::Const(value) => match self {
                Self::Latex(..) if value.fract() == 0.0 && value.abs() < 1e6 => {
                    format!("{value:.0}")
                }
                Self::Latex(..) if inverse(*value).is_some() => {
                    format!("\\frac{{1}}{{{}}}", inverse(*value).unwrap_or(1.0))
                }
                _ => format!("{value:?}"),
            },
            Node::Cos(angle) => self.function("cos", angle, None),
            Node::Sin(angle) => self.function("sin", angle, None),
            Node::Sqrt(inner) => self.function("sqrt", inner, None),
            Node::Atan2(y, x) => self.function("atan2", y, Some(x)),
            // Closed forms contain no other kinds.
            _ => format!("{term}"),
        }
    }

    fn function(&self, name: &str, first: &Term, second: Option<&Term>) -> String {
        let lowest = |term: &Term| self.write(term, Precedence::Lowest);
        let highest = || self.write(first, Precedence::Highest);
        let all: Vec<String> = [first].into_iter().chain(second).map(lowest).collect();
        let all = all.join(", ");
        match (self, name) {
            (Self::Latex(..), "sqrt") => format!("\\sqrt{{{all}}}"),
            (Self::Latex(..), "atan2") => format!("\\operatorname{{atan2}}\\left({all}\\right)"),
            (Self::Latex(..), _) => format!("\\{name} {}", highest()),
            (Self::Code(Language::Rust), _) => {
                let second = second.map(lowest).unwrap_or_default();
                format!("{}.{name}({second})", highest())
            }
            (Self::Code(_), _) => format!("{name}({all})"),
        }
    }
}

/// The sign before the k-th summand.
pub(crate) fn sign(k: usize, minus: bool) -> &'static str {
    match (k, minus) {
        (0, true) => "-",
        (0, false) => "",
        (_, true) => " - ",
        (_, false) => " + ",
    }
}

/// The denominator of a fraction 1/n.
fn inverse(value: f64) -> Option<f64> {
    let inverse = (1.0 / value).round();
    (inverse > 1.0 && inverse < 10.0 && inverse * value == 1.0).then_some(inverse)
}

/// The summands of a term without their signs; `true` for subtracted ones.
fn summands(term: &Term, minus: bool, found: &mut Vec<(bool, Term)>) {
    match term.as_ref() {
        Node::Add(a, b) => {
            summands(a, minus, found);
            summands(b, minus, found);
        }
        Node::Sub(a, b) => {
            summands(a, minus, found);
            summands(b, !minus, found);
        }
        Node::Neg(a) => summands(a, !minus, found),
        Node::Const(value) if *value < 0.0 => {
            found.push((!minus, crate::algebra::number(-value)));
        }
        Node::Mul(..) | Node::Div(..) => {
            let (term, negative) = unsigned(term);
            found.push((minus != negative, term));
        }
        _ => found.push((minus, term.clone())),
    }
}

/// A product without its sign.
fn unsigned(term: &Term) -> (Term, bool) {
    match term.as_ref() {
        Node::Mul(a, b) => {
            let ((a, m), (b, n)) = (unsigned(a), unsigned(b));
            let one = |t: &Term| matches!(t.as_ref(), Node::Const(v) if *v == 1.0);
            let product = if one(&a) {
                b
            } else if one(&b) {
                a
            } else {
                a * b
            };
            (product, m != n)
        }
        Node::Div(a, b) => {
            let ((a, m), (b, n)) = (unsigned(a), unsigned(b));
            (a / b, m != n)
        }
        Node::Neg(a) => {
            let (a, m) = unsigned(a);
            (a, !m)
        }
        Node::Const(value) if *value < 0.0 => (crate::algebra::number(-value), true),
        Node::Add(..) | Node::Sub(..) => {
            let mut parts = Vec::new();
            summands(term, false, &mut parts);
            if parts.iter().any(|part| !part.0) {
                return (term.clone(), false);
            }
            let sum = parts.into_iter().map(|part| part.1).reduce(|a, b| a + b);
            (sum.unwrap_or_else(|| term.clone()), true)
        }
        _ => (term.clone(), false),
    }
}

fn factors(term: &Term, above: &mut Vec<Term>, below: &mut Vec<Term>) {
    match term.as_ref() {
        Node::Mul(a, b) => {
            factors(a, above, below);
            factors(b, above, below);
        }
        Node::Div(a, b) => {
            factors(a, above, below);
            factors(b, below, above);
        }
        _ => above.push(term.clone()),
    }
}

/// The order of factors in a product: numbers, constants, variables, functions, sums.
fn factor_order(term: &Term, constant: &dyn Fn(&str) -> bool) -> u8 {
    match term.as_ref() {
        Node::Const(_) => 0,
        Node::Sym(name) if constant(name) => 1,
        Node::Sym(_) => 2,
        Node::Pow(base, _) => factor_order(base, constant),
        _ => 3,
    }
}
