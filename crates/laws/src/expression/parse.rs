//! The parser: operators by precedence (V. R. Pratt, *Top down operator precedence*, 1973),
//! appended to the tape as they are read.

use std::ops::Range;

use super::error::{ExpressionError, nearest};
use super::function::{Binary, Comparison, Constant, Function};
use super::tape::{Op, STACK_SIZE, Sides, Tape, is_identifier, run};
use super::token::{self, Token, TokenKind};

/// Maximum nesting of parentheses, powers and signs: each takes a few recursive calls of the parser.
const MAX_NESTING: usize = 64;

/// Precedence of the sign of an operand: -x^2 is -(x^2), and -x*y is (-x)*y.
const SIGN_BINDING: u8 = 6;

/// A part of the text that has a value.
struct Operand {
    span: Range<usize>,
    /// Its value, if no variable occurs in it.
    constant: Option<f64>,
}

struct Parser<'a> {
    text: &'a str,
    variables: &'a [&'a str],
    /// The token just consumed, and the next one.
    previous: Option<Token>,
    token: Token,
    tape: Tape,
    /// Number of intermediate results at this point of the tape.
    stack_depth: usize,
    nesting: usize,
}

/// The tape of a text.
pub(super) fn parse(text: &str, variables: &[&str]) -> Result<Tape, ExpressionError> {
    let mut parser = Parser {
        text,
        variables,
        previous: None,
        token: token::next_token(text, 0)?,
        tape: Tape::default(),
        stack_depth: 0,
        nesting: 0,
    };
    parser.operand(0)?;
    match parser.token.kind {
        TokenKind::EndOfText => Ok(parser.tape),
        _ => Err(parser.unexpected()),
    }
}

/// The operation between two operands, and its precedence to the left and to the right.
fn infix(kind: TokenKind) -> Option<(Binary, u8, u8)> {
    Some(match kind {
        TokenKind::Plus => (Binary::Add, 1, 2),
        TokenKind::Minus => (Binary::Subtract, 1, 2),
        TokenKind::Star => (Binary::Multiply, 3, 4),
        TokenKind::Slash => (Binary::Divide, 3, 4),
        TokenKind::Caret => (Binary::Power, 8, 7),
        _ => return None,
    })
}

impl<'a> Parser<'a> {
    fn advance(&mut self) -> Result<(), ExpressionError> {
        self.previous = Some(self.token);
        self.token = token::next_token(self.text, self.token.end)?;
        Ok(())
    }

    fn slice(&self, span: Range<usize>) -> &'a str {
        self.text.get(span).unwrap_or("")
    }

    /// Parses an operand whose operators have at least the precedence `min_binding`.
    fn operand(&mut self, min_binding: u8) -> Result<Operand, ExpressionError> {
        self.nesting += 1;
        if self.nesting > MAX_NESTING {
            return Err(self.too_deep(self.token.span()));
        }
        let mut left = self.prefix()?;
        while let Some((operation, left_binding, right_binding)) = infix(self.token.kind) {
            if left_binding < min_binding {
                break;
            }
            self.advance()?;
            let right = self.operand(right_binding)?;
            let span = left.span.start..right.span.end;
            left = self.emit(Op::Binary(operation), span, &[left, right])?;
        }
        self.nesting -= 1;
        Ok(left)
    }

    fn prefix(&mut self) -> Result<Operand, ExpressionError> {
        let token = self.token;
        match token.kind {
            TokenKind::Number(number) => {
                self.advance()?;
                self.emit(Op::Number(number), token.span(), &[])
            }
            TokenKind::Identifier => self.name(token),
            TokenKind::QuotedIdentifier => {
                self.advance()?;
                let name = self.slice(token.start + 1..token.end - 1);
                match self.variables.iter().position(|v| *v == name) {
                    Some(index) => self.emit(Op::Variable(index), token.span(), &[]),
                    None => Err(self.unknown_name(name, token)),
                }
            }
            TokenKind::Minus => {
                self.advance()?;
                let operand = self.operand(SIGN_BINDING)?;
                let span = token.start..operand.span.end;
                self.emit(Op::Negate, span, &[operand])
            }
            TokenKind::OpenParen => {
                self.advance()?;
                let inner = self.operand(0)?;
                let span = token.start..self.token.end;
                self.close(token)?;
                Ok(Operand { span, ..inner })
            }
            _ => Err(self.missing_operand()),
        }
    }

    fn name(&mut self, token: Token) -> Result<Operand, ExpressionError> {
        self.advance()?;
        let name = self.slice(token.span());
        if self.token.kind == TokenKind::OpenParen {
            return match Function::from_name(name) {
                Some(function) => self.call(function, token),
                None => Err(self.unknown_function(name, token)),
            };
        }
        // Variables take precedence over constants.
        if let Some(index) = self.variables.iter().position(|v| *v == name) {
            return self.emit(Op::Variable(index), token.span(), &[]);
        }
        match Constant::ALL.iter().find(|(known, _)| *known == name) {
            Some(&(_, constant)) => self.emit(Op::Constant(constant), token.span(), &[]),
            None => Err(self.unknown_name(name, token)),
        }
    }

    fn call(&mut self, function: Function, name: Token) -> Result<Operand, ExpressionError> {
        let open = self.token;
        self.advance()?;
        let mut operands = Vec::new();
        let mut comparison = None;
        let mut found = 0;
        while !(found == 0 && self.token.kind == TokenKind::CloseParen) {
            if found > 0 {
                self.advance()?;
            }
            operands.push(self.operand(0)?);
            if function == Function::If && found == 0 {
                comparison = Some(self.comparison(&mut operands)?);
            }
            found += 1;
            if self.token.kind != TokenKind::Comma {
                break;
            }
        }
        let span = name.start..self.token.end;
        self.close(open)?;
        let needed = function.argument_count();
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
        self.emit(op, span, &operands)
    }

    /// The rest of the first argument of `if`, whose first operand has been read.
    fn comparison(&mut self, operands: &mut Vec<Operand>) -> Result<Comparison, ExpressionError> {
        let TokenKind::Comparison(comparison) = self.token.kind else {
            if !matches!(self.token.kind, TokenKind::Comma | TokenKind::CloseParen) {
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
            TokenKind::CloseParen => self.advance(),
            TokenKind::EndOfText => Err(not_closed(open)),
            _ => Err(self.unexpected()),
        }
    }

    /// Appends an operation to its operands.
    fn emit(
        &mut self,
        op: Op,
        span: Range<usize>,
        operands: &[Operand],
    ) -> Result<Operand, ExpressionError> {
        self.stack_depth = self.stack_depth - op.arity() + 1;
        if self.stack_depth > STACK_SIZE {
            return Err(self.too_deep(span));
        }
        self.tape.depth = self.tape.depth.max(self.stack_depth);
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
                let message = format!("`{}` is {what}", self.slice(span.clone()));
                Err(ExpressionError::new(span, message))
            }
            _ => Ok(Operand { span, constant }),
        }
    }

    // Errors.

    fn too_deep(&self, span: Range<usize>) -> ExpressionError {
        ExpressionError::new(span, "too deep: the expression is nested too far")
            .help("take parentheses away, or put the longer operand first")
    }

    /// The next token cannot begin an operand.
    fn missing_operand(&self) -> ExpressionError {
        let here = self.token;
        match (self.previous, here.kind) {
            (None, TokenKind::EndOfText) => {
                ExpressionError::new(0..self.text.len(), "the expression is empty")
            }
            (None, TokenKind::CloseParen) => no_opening(here),
            (Some(open), TokenKind::CloseParen) if open.kind == TokenKind::OpenParen => {
                ExpressionError::new(
                    open.start..here.end,
                    "there is nothing between the parentheses",
                )
            }
            (Some(open), TokenKind::EndOfText) if open.kind == TokenKind::OpenParen => {
                not_closed(open)
            }
            (Some(previous), _) if previous.kind != TokenKind::OpenParen => {
                let what = self.slice(previous.span());
                let error = ExpressionError::new(
                    previous.span(),
                    format!("there is no operand after `{what}`"),
                );
                match (previous.kind, here.kind) {
                    (TokenKind::Star, TokenKind::Star) => error.help("a power is written `x^2`"),
                    (_, TokenKind::Plus) => error.help("a number needs no plus sign"),
                    _ => error,
                }
            }
            _ => {
                let what = self.slice(here.span());
                let message = format!("there is no operand before `{what}`");
                ExpressionError::new(here.span(), message)
            }
        }
    }

    /// The next token cannot follow an operand.
    fn unexpected(&self) -> ExpressionError {
        let here = self.token;
        let what = self.slice(here.span());
        match here.kind {
            TokenKind::CloseParen => no_opening(here),
            TokenKind::Comma => ExpressionError::new(
                here.span(),
                "a comma stands only between the arguments of a function",
            )
            .help("the decimal sign is a point"),
            TokenKind::Comparison(_) => ExpressionError::new(
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
        if Function::from_name(name).is_some() {
            return error.help(format!("the function is written `{name}(…)`"));
        }
        let tail = self.slice(token.start..self.text.len());
        let quoted = |v: &&&str| !is_identifier(v) && v.starts_with(name) && tail.starts_with(**v);
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
    const MAX_OPERANDS: usize = 4;
    let mut ops = [op; MAX_OPERANDS + 1];
    for (slot, operand) in ops.iter_mut().zip(operands) {
        *slot = Op::Number(operand.constant?);
    }
    ops.get(..=operands.len())
        .map(|ops| run::<f64, MAX_OPERANDS>(ops, |_| f64::NAN, |_| Sides::default()))
}

/// A scene can have hundreds of names; the first two dozen are listed.
fn list<'a>(title: &str, names: impl Iterator<Item = &'a str>) -> String {
    const MAX_LISTED: usize = 24;
    let mut names: Vec<_> = names.map(|name| format!("`{name}`")).collect();
    if names.len() > MAX_LISTED {
        names.truncate(MAX_LISTED);
        names.push("…".to_owned());
    }
    format!("{title} {}", names.join(", "))
}
