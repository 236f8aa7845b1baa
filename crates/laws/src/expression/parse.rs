//! The grammar: operators by precedence (V. R. Pratt, *Top down operator precedence*, 1973),
//! written to the tape as they are read.

use std::ops::Range;

use super::error::{ExpressionError, nearest};
use super::function::{Binary, Comparison, Constant, Function};
use super::tape::{Op, PLACES, Tape, is_plain, run};
use super::token::{self, Kind, Token};

/// How deep parentheses, powers and signs may nest: each takes a few calls of the parser.
const NESTING: usize = 64;

/// How tightly the sign of an operand binds: -x^2 is -(x^2), and -x*y is (-x)*y.
const SIGN: u8 = 6;

/// A part of the text that has a value.
struct Operand {
    span: Range<usize>,
    /// Its value, if no variable occurs in it.
    constant: Option<f64>,
}

struct Parser<'a> {
    text: &'a str,
    variables: &'a [&'a str],
    /// The token just consumed, and the one to come.
    before: Option<Token>,
    token: Token,
    tape: Tape,
    /// How many results the tape keeps here.
    kept: usize,
    nesting: usize,
}

/// The tape of a text.
pub(super) fn parse(text: &str, variables: &[&str]) -> Result<Tape, ExpressionError> {
    let mut parser = Parser {
        text,
        variables,
        before: None,
        token: token::next(text, 0)?,
        tape: Tape::default(),
        kept: 0,
        nesting: 0,
    };
    parser.operand(0)?;
    match parser.token.kind {
        Kind::End => Ok(parser.tape),
        _ => Err(parser.unexpected()),
    }
}

/// The operation between two operands, and how tightly it binds the one before and after it.
fn infix(kind: Kind) -> Option<(Binary, u8, u8)> {
    Some(match kind {
        Kind::Plus => (Binary::Add, 1, 2),
        Kind::Minus => (Binary::Subtract, 1, 2),
        Kind::Star => (Binary::Multiply, 3, 4),
        Kind::Slash => (Binary::Divide, 3, 4),
        Kind::Caret => (Binary::Power, 8, 7),
        _ => return None,
    })
}

impl<'a> Parser<'a> {
    fn advance(&mut self) -> Result<(), ExpressionError> {
        self.before = Some(self.token);
        self.token = token::next(self.text, self.token.to)?;
        Ok(())
    }

    fn of(&self, span: Range<usize>) -> &'a str {
        self.text.get(span).unwrap_or("")
    }

    /// Everything from here that binds at least as tightly as `least`.
    fn operand(&mut self, least: u8) -> Result<Operand, ExpressionError> {
        self.nesting += 1;
        if self.nesting > NESTING {
            return Err(self.too_deep(self.token.span()));
        }
        let mut left = self.prefix()?;
        while let Some((operation, before, after)) = infix(self.token.kind) {
            if before < least {
                break;
            }
            self.advance()?;
            let right = self.operand(after)?;
            let span = left.span.start..right.span.end;
            left = self.join(Op::Binary(operation), span, &[left, right])?;
        }
        self.nesting -= 1;
        Ok(left)
    }

    fn prefix(&mut self) -> Result<Operand, ExpressionError> {
        let token = self.token;
        match token.kind {
            Kind::Number(number) => {
                self.advance()?;
                self.join(Op::Number(number), token.span(), &[])
            }
            Kind::Plain => self.name(token),
            Kind::Quoted => {
                self.advance()?;
                let name = self.of(token.from + 1..token.to - 1);
                match self.variables.iter().position(|v| *v == name) {
                    Some(index) => self.join(Op::Variable(index), token.span(), &[]),
                    None => Err(self.unknown_name(name, token)),
                }
            }
            Kind::Minus => {
                self.advance()?;
                let operand = self.operand(SIGN)?;
                let span = token.from..operand.span.end;
                self.join(Op::Negate, span, &[operand])
            }
            Kind::Open => {
                self.advance()?;
                let inner = self.operand(0)?;
                let span = token.from..self.token.to;
                self.close(token)?;
                Ok(Operand { span, ..inner })
            }
            _ => Err(self.no_operand()),
        }
    }

    fn name(&mut self, token: Token) -> Result<Operand, ExpressionError> {
        self.advance()?;
        let name = self.of(token.span());
        if self.token.kind == Kind::Open {
            return match Function::named(name) {
                Some(function) => self.call(function, token),
                None => Err(self.unknown_function(name, token)),
            };
        }
        // Names of the scene come first: none of them is hidden by a constant.
        if let Some(index) = self.variables.iter().position(|v| *v == name) {
            return self.join(Op::Variable(index), token.span(), &[]);
        }
        match Constant::ALL.iter().find(|(known, _)| *known == name) {
            Some(&(_, constant)) => self.join(Op::Constant(constant), token.span(), &[]),
            None => Err(self.unknown_name(name, token)),
        }
    }

    fn call(&mut self, function: Function, name: Token) -> Result<Operand, ExpressionError> {
        let open = self.token;
        self.advance()?;
        let mut operands = Vec::new();
        let mut comparison = None;
        let mut found = 0;
        while !(found == 0 && self.token.kind == Kind::Close) {
            if found > 0 {
                self.advance()?;
            }
            operands.push(self.operand(0)?);
            if function == Function::If && found == 0 {
                comparison = Some(self.comparison(&mut operands)?);
            }
            found += 1;
            if self.token.kind != Kind::Comma {
                break;
            }
        }
        let span = name.from..self.token.to;
        self.close(open)?;
        let needed = function.arguments();
        let op = match (function, comparison) {
            _ if found != needed => {
                let called = function.name();
                let s = if needed == 1 { "" } else { "s" };
                let message = format!("`{called}` takes {needed} argument{s}, not {found}");
                return Err(ExpressionError::new(span, message));
            }
            (Function::Unary(function), _) => Op::Unary(function),
            (Function::Binary(operation), _) => Op::Binary(operation),
            (_, Some(comparison)) => Op::If(comparison),
            (_, None) => Op::Clamp,
        };
        self.join(op, span, &operands)
    }

    /// The rest of the first argument of `if`, whose first operand has been read.
    fn comparison(&mut self, operands: &mut Vec<Operand>) -> Result<Comparison, ExpressionError> {
        let Kind::Comparison(comparison) = self.token.kind else {
            if !matches!(self.token.kind, Kind::Comma | Kind::Close) {
                return Err(self.unexpected());
            }
            let span = operands
                .last()
                .map_or(self.token.span(), |o| o.span.clone());
            let error = ExpressionError::new(span, "the first argument of `if` is a comparison");
            return Err(error.help("for example `if(x > 0, x, 0)`"));
        };
        self.advance()?;
        operands.push(self.operand(0)?);
        Ok(comparison)
    }

    fn close(&mut self, open: Token) -> Result<(), ExpressionError> {
        match self.token.kind {
            Kind::Close => self.advance(),
            Kind::End => Err(not_closed(open)),
            _ => Err(self.unexpected()),
        }
    }

    /// Writes an operation behind its operands.
    fn join(
        &mut self,
        op: Op,
        span: Range<usize>,
        operands: &[Operand],
    ) -> Result<Operand, ExpressionError> {
        self.kept = self.kept - op.takes() + 1;
        if self.kept > PLACES {
            return Err(self.too_deep(span));
        }
        self.tape.depth = self.tape.depth.max(self.kept);
        self.tape.ops.push(op);
        let constant = match op {
            Op::Variable(_) => None,
            _ => constant(op, operands),
        };
        match constant {
            Some(value) if !value.is_finite() => {
                let what = if value.is_nan() {
                    "not a number"
                } else {
                    "infinite"
                };
                let message = format!("`{}` is {what}", self.of(span.clone()));
                Err(ExpressionError::new(span, message))
            }
            _ => Ok(Operand { span, constant }),
        }
    }

    // What can be wrong.

    fn too_deep(&self, span: Range<usize>) -> ExpressionError {
        ExpressionError::new(span, "too deep: the expression is nested too far")
            .help("take parentheses away, or put the longer operand first")
    }

    /// The token to come cannot begin an operand.
    fn no_operand(&self) -> ExpressionError {
        let here = self.token;
        match (self.before, here.kind) {
            (None, Kind::End) => {
                ExpressionError::new(0..self.text.len(), "the expression is empty")
            }
            (None, Kind::Close) => no_opening(here),
            (Some(open), Kind::Close) if open.kind == Kind::Open => ExpressionError::new(
                open.from..here.to,
                "there is nothing between the parentheses",
            ),
            (Some(open), Kind::End) if open.kind == Kind::Open => not_closed(open),
            (Some(before), _) if before.kind != Kind::Open => {
                let what = self.of(before.span());
                let error = ExpressionError::new(
                    before.span(),
                    format!("there is no operand after `{what}`"),
                );
                match (before.kind, here.kind) {
                    (Kind::Star, Kind::Star) => error.help("a power is written `x^2`"),
                    (_, Kind::Plus) => error.help("a number needs no plus sign"),
                    _ => error,
                }
            }
            _ => {
                let what = self.of(here.span());
                let message = format!("there is no operand before `{what}`");
                ExpressionError::new(here.span(), message)
            }
        }
    }

    /// The token to come cannot follow an operand.
    fn unexpected(&self) -> ExpressionError {
        let here = self.token;
        let what = self.of(here.span());
        match here.kind {
            Kind::Close => no_opening(here),
            Kind::Comma => ExpressionError::new(
                here.span(),
                "a comma stands only between the arguments of a function",
            )
            .help("the decimal sign is a point"),
            Kind::Comparison(_) => ExpressionError::new(
                here.span(),
                format!("`{what}` stands only in the first argument of `if`, once"),
            )
            .help("for example `if(x > 0, x, 0)`"),
            _ => ExpressionError::new(here.span(), format!("there is no operator before `{what}`"))
                .help("a product is written `a*b`"),
        }
    }

    fn unknown_name(&self, name: &str, token: Token) -> ExpressionError {
        let error = ExpressionError::new(token.span(), format!("unknown name `{name}`"));
        if Function::named(name).is_some() {
            return error.help(format!("the function is written `{name}(…)`"));
        }
        let tail = self.of(token.from..self.text.len());
        let quoted = |v: &&&str| !is_plain(v) && v.starts_with(name) && tail.starts_with(**v);
        if let Some(quoted) = self.variables.iter().find(quoted) {
            return error.help(format!(
                "did you mean {quoted:?}? It is written between two backticks"
            ));
        }
        let constants = Constant::ALL.iter().map(|&(known, _)| known);
        let known = self.variables.iter().copied().chain(constants);
        if let Some(meant) = nearest(name, known.clone()) {
            return error.help(format!("did you mean `{meant}`?"));
        }
        if name == "e" {
            return error.help("Euler's number is `exp(1)`");
        }
        error.help(list("the names are", known))
    }

    fn unknown_function(&self, name: &str, token: Token) -> ExpressionError {
        if self.variables.contains(&name) || Constant::ALL.iter().any(|(known, _)| *known == name) {
            return ExpressionError::new(token.span(), format!("`{name}` is not a function"))
                .help(format!("a product is written `{name}*(…)`"));
        }
        let error = ExpressionError::new(token.span(), format!("unknown function `{name}`"));
        let meant = match name {
            "log" => return error.help("did you mean `ln` or `log10`?"),
            "sgn" | "signum" => Some("sign"),
            "pow" => return error.help("a power is written `x^2`"),
            "arcsin" => Some("asin"),
            "arccos" => Some("acos"),
            "arctan" => Some("atan"),
            "heaviside" => Some("step"),
            _ => nearest(name, Function::ALL.iter().map(|&(known, _)| known)),
        };
        error.help(match meant {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => list(
                "the functions are",
                Function::ALL.iter().map(|&(known, _)| known),
            ),
        })
    }
}

fn not_closed(open: Token) -> ExpressionError {
    ExpressionError::new(open.span(), "this parenthesis is not closed")
}

fn no_opening(close: Token) -> ExpressionError {
    ExpressionError::new(close.span(), "this parenthesis closes nothing")
}

/// The value of an operation on constants.
fn constant(op: Op, operands: &[Operand]) -> Option<f64> {
    const MOST: usize = 4;
    let mut ops = [op; MOST + 1];
    for (place, operand) in ops.iter_mut().zip(operands) {
        *place = Op::Number(operand.constant?);
    }
    ops.get(..=operands.len())
        .map(|ops| run::<f64, MOST>(ops, |_| f64::NAN))
}

/// A scene can have hundreds of names; the first two dozen are told.
fn list<'a>(title: &str, names: impl Iterator<Item = &'a str>) -> String {
    const SHOWN: usize = 24;
    let mut names: Vec<_> = names.map(|name| format!("`{name}`")).collect();
    if names.len() > SHOWN {
        names.truncate(SHOWN);
        names.push("…".to_owned());
    }
    format!("{title} {}", names.join(", "))
}
