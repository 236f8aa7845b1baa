//! A small reader of expressions: the lines of generated code. It shares nothing with the program's own expressions.

/// An expression as read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Expression {
    Number(f64),
    Name(String),
    Negative(Box<Expression>),
    Operation(Operator, Box<[Expression; 2]>),
    Call(String, Vec<Expression>),
}

/// An operator between two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operator {
    Plus,
    Minus,
    Times,
    Over,
    Power,
}

/// The operators as written, longer signs first, with how tightly they bind the operand before and after them.
const OPERATORS: [(&str, Operator, u8, u8); 5] = [
    ("**", Operator::Power, 8, 7),
    ("+", Operator::Plus, 3, 4),
    ("-", Operator::Minus, 3, 4),
    ("*", Operator::Times, 5, 6),
    ("/", Operator::Over, 5, 6),
];
const SIGN_BINDING: u8 = 7;

struct Reader<'a> {
    rest: &'a str,
}

impl Expression {
    /// Reads a whole text; `None` if it is not an expression.
    pub(crate) fn read(text: &str) -> Option<Self> {
        let mut reader = Reader { rest: text };
        let expression = reader.operand(0)?;
        reader.rest.trim().is_empty().then_some(expression)
    }

    /// Its value for given values of its names; `None` if a name or a function is unknown.
    pub(crate) fn at(&self, names: &dyn Fn(&str) -> Option<f64>) -> Option<f64> {
        Some(match self {
            Self::Number(value) => *value,
            Self::Name(name) => names(name)?,
            Self::Negative(inner) => -inner.at(names)?,
            Self::Operation(operator, sides) => {
                let [a, b] = [sides[0].at(names)?, sides[1].at(names)?];
                match operator {
                    Operator::Plus => a + b,
                    Operator::Minus => a - b,
                    Operator::Times => a * b,
                    Operator::Over => a / b,
                    Operator::Power => a.powf(b),
                }
            }
            Self::Call(name, arguments) => {
                let of = |k: usize| arguments.get(k)?.at(names);
                let a = of(0)?;
                match name.as_str() {
                    "sin" => a.sin(),
                    "cos" => a.cos(),
                    "sqrt" => a.sqrt(),
                    "atan2" => a.atan2(of(1)?),
                    "pow" => a.powf(of(1)?),
                    _ => return None,
                }
            }
        })
    }
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
        Expression::read(text)?.at(&|name| (name == "x").then_some(0.3))
    }

    #[test]
    fn operators_bind_as_the_languages_write_them() {
        for (text, expected) in [
            ("2 + 3*4 - 6/3", 12.0),
            ("-2**2", -4.0),
            ("2**3**2", 512.0),
            ("2**-1", 0.5),
            ("-2*3", -6.0),
            ("1 - 2 - 3", -4.0),
            ("sqrt(x*x + 16 - 0.09) + 1e-1", 4.1),
            ("pow(x - 0.3, 2) + atan2(0, 1)", 0.0),
        ] {
            let found = value(text).unwrap_or(f64::NAN);
            assert!((found - expected).abs() < 1e-15, "{text}");
        }
        for wrong in ["2 +", "sin 3", "(1", "unknown(1)", "y"] {
            assert_eq!(value(wrong), None, "{wrong}");
        }
    }
}
