//! A small reader of expressions: those of a scene, and the lines of generated code. It shares nothing with the
//! program's own expressions.

use super::jet::Jet;

/// An expression as read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Expression {
    Number(f64),
    Name(String),
    Negative(Box<Expression>),
    Operation(Operator, Box<[Expression; 2]>),
    Call(String, Vec<Expression>),
}

/// What stands between two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operator {
    Plus,
    Minus,
    Times,
    Over,
    Power,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

/// The operators as written, longer signs first, with how tightly they bind the operand before and after them.
const OPERATORS: [(&str, Operator, u8, u8); 10] = [
    ("**", Operator::Power, 8, 7),
    ("<=", Operator::LessOrEqual, 1, 2),
    (">=", Operator::GreaterOrEqual, 1, 2),
    ("<", Operator::Less, 1, 2),
    (">", Operator::Greater, 1, 2),
    ("+", Operator::Plus, 3, 4),
    ("-", Operator::Minus, 3, 4),
    ("*", Operator::Times, 5, 6),
    ("/", Operator::Over, 5, 6),
    ("^", Operator::Power, 8, 7),
];
const SIGN_BINDING: u8 = 7;

struct Reader<'a> {
    rest: &'a str,
}

impl Expression {
    /// Reads a whole text; none where it is not an expression.
    pub(crate) fn read(text: &str) -> Option<Self> {
        let mut reader = Reader { rest: text };
        let expression = reader.operand(0)?;
        reader.rest.trim().is_empty().then_some(expression)
    }

    /// Whether a name occurs that the test picks.
    pub(crate) fn mentions(&self, is_meant: &dyn Fn(&str) -> bool) -> bool {
        match self {
            Self::Number(_) => false,
            Self::Name(name) => is_meant(name),
            Self::Negative(inner) => inner.mentions(is_meant),
            Self::Operation(_, sides) => sides.iter().any(|side| side.mentions(is_meant)),
            Self::Call(_, arguments) => arguments.iter().any(|a| a.mentions(is_meant)),
        }
    }

    /// Value and derivatives, with those of its names; none where a name or a function is unknown.
    pub(crate) fn at(&self, names: &dyn Fn(&str) -> Option<Jet>) -> Option<Jet> {
        Some(match self {
            Self::Number(value) => Jet::constant(*value),
            Self::Name(name) => names(name).or_else(|| constant(name))?,
            Self::Negative(inner) => -inner.at(names)?,
            Self::Operation(operator, sides) => {
                let [a, b] = [sides[0].at(names)?, sides[1].at(names)?];
                operate(*operator, a, b)
            }
            Self::Call(name, arguments) => {
                let of = |k: usize| arguments.get(k)?.at(names);
                call(name, of(0)?, of(1), of(2))?
            }
        })
    }
}

fn constant(name: &str) -> Option<Jet> {
    let value = match name {
        "pi" => std::f64::consts::PI,
        "tau" => std::f64::consts::TAU,
        _ => return None,
    };
    Some(Jet::constant(value))
}

fn operate(operator: Operator, a: Jet, b: Jet) -> Jet {
    let holds = |condition: bool| Jet::constant(f64::from(u8::from(condition)));
    let (x, y) = (a.value(), b.value());
    match operator {
        Operator::Plus => a + b,
        Operator::Minus => a - b,
        Operator::Times => a * b,
        Operator::Over => a / b,
        Operator::Power if b.0[1] == 0.0 && b.0[2] == 0.0 => a.power(y),
        Operator::Power => (b * a.ln()).exp(),
        Operator::Less => holds(x < y),
        Operator::LessOrEqual => holds(x <= y),
        Operator::Greater => holds(x > y),
        Operator::GreaterOrEqual => holds(x >= y),
    }
}

// Long: an arm for each function.
fn call(name: &str, a: Jet, b: Option<Jet>, c: Option<Jet>) -> Option<Jet> {
    let u = a.value();
    let one = Jet::constant(1.0);
    let half = Jet::constant(0.5);
    let smaller = |a: Jet, b: Jet| if b.value() < a.value() { b } else { a };
    let larger = |a: Jet, b: Jet| if b.value() > a.value() { b } else { a };
    Some(match name {
        "sin" => a.sin(),
        "cos" => a.cos(),
        "tan" => a.sin() / a.cos(),
        "asin" => a.atan2((one - a * a).sqrt()),
        "acos" => (one - a * a).sqrt().atan2(a),
        "atan" => a.atan(),
        "sinh" => (a.exp() - (-a).exp()) * half,
        "cosh" => (a.exp() + (-a).exp()) * half,
        "tanh" => one - Jet::constant(2.0) / ((a + a).exp() + one),
        "exp" => a.exp(),
        "ln" => a.ln(),
        "log10" => a.ln() / Jet::constant(std::f64::consts::LN_10),
        "sqrt" => a.sqrt(),
        "abs" | "fabs" if u < 0.0 => -a,
        "abs" | "fabs" => a,
        "sign" => Jet::constant(f64::from(i8::from(u > 0.0) - i8::from(u < 0.0))),
        "floor" => Jet::constant(u.floor()),
        "step" => Jet::constant(f64::from(u8::from(u >= 0.0))),
        "atan2" => a.atan2(b?),
        "hypot" => (a * a + b? * b?).sqrt(),
        "min" => smaller(a, b?),
        "max" => larger(a, b?),
        "pow" => operate(Operator::Power, a, b?),
        "clamp" => smaller(larger(a, b?), c?),
        "if" if u != 0.0 => b?,
        "if" => c?,
        _ => return None,
    })
}

impl Reader<'_> {
    fn skip_spaces(&mut self) {
        self.rest = self.rest.trim_start();
    }

    fn takes(&mut self, sign: &str) -> bool {
        self.skip_spaces();
        let rest = self.rest.strip_prefix(sign);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn take_while(&mut self, belongs: impl Fn(usize, char) -> bool) -> String {
        let mut characters = self.rest.char_indices();
        let end = characters.find(|&(at, c)| !belongs(at, c));
        let end = end.map_or(self.rest.len(), |(at, _)| at);
        let (taken, rest) = self.rest.split_at(end);
        self.rest = rest;
        taken.to_owned()
    }

    fn operand(&mut self, binding: u8) -> Option<Expression> {
        let mut left = self.prefix()?;
        loop {
            self.skip_spaces();
            let found = OPERATORS
                .iter()
                .find(|(sign, ..)| self.rest.starts_with(sign));
            match found {
                Some(&(sign, operator, before, after)) if before >= binding => {
                    self.rest = self.rest.strip_prefix(sign)?;
                    let right = self.operand(after)?;
                    left = Expression::Operation(operator, Box::new([left, right]));
                }
                _ => return Some(left),
            }
        }
    }

    fn prefix(&mut self) -> Option<Expression> {
        if self.takes("-") {
            return Some(Expression::Negative(Box::new(self.operand(SIGN_BINDING)?)));
        }
        if self.takes("(") {
            let inner = self.operand(0)?;
            return self.takes(")").then_some(inner);
        }
        if self.takes("`") {
            let name = self.take_while(|_, c| c != '`');
            return self.takes("`").then_some(Expression::Name(name));
        }
        if self
            .rest
            .starts_with(|c: char| c.is_ascii_digit() || c == '.')
        {
            let text = self.rest.to_owned();
            let sign_of_exponent = |at: usize| text[..at].ends_with(['e', 'E']);
            let digits = self.take_while(|at, c| {
                c.is_ascii_digit()
                    || matches!(c, '.' | 'e' | 'E')
                    || (matches!(c, '+' | '-') && sign_of_exponent(at))
            });
            return digits.parse().ok().map(Expression::Number);
        }
        let name = self.take_while(|_, c| c.is_alphanumeric() || matches!(c, '_' | '.' | '\''));
        if name.is_empty() {
            return None;
        }
        if !self.takes("(") {
            return Some(Expression::Name(name));
        }
        let mut arguments = vec![self.operand(0)?];
        while self.takes(",") {
            arguments.push(self.operand(0)?);
        }
        self.takes(")").then_some(Expression::Call(name, arguments))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Option<f64> {
        let names = |name: &str| (name == "x").then_some(Jet([0.3, 1.0, 0.0]));
        Expression::read(text)?.at(&names).map(Jet::value)
    }

    #[test]
    fn operators_bind_as_the_field_writes_them() {
        for (text, expected) in [
            ("2 + 3*4 - 6/3", 12.0),
            ("-2^2", -4.0),
            ("2^3^2", 512.0),
            ("2**-1", 0.5),
            ("-2*3", -6.0),
            ("1 - 2 - 3", -4.0),
            ("if(x <= 0.3, max(1, 2), 7) + 1e-1", 2.1),
            ("clamp(5, 0, 1) + atan2(1, 1)*4/pi", 2.0),
            ("hypot(3, 4) + floor(-0.5) + step(0) + sign(-x)", 4.0),
        ] {
            assert_eq!(value(text), Some(expected), "{text}");
        }
        for wrong in ["2 +", "sin 3", "(1", "unknown(1)", "y"] {
            assert_eq!(value(wrong), None, "{wrong}");
        }
    }
}
