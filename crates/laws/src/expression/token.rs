//! The text split into numbers, names and operators.

use std::ops::Range;

use super::error::ExpressionError;
use super::function::Comparison;
use super::tape::{continues_identifier, starts_identifier};

/// The kind of a token.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum TokenKind {
    Number(f64),
    /// Letters, digits, `_` and `.`.
    Identifier,
    /// Anything between backticks.
    QuotedIdentifier,
    Plus,
    Minus,
    Star,
    Slash,
    Caret,
    Comparison(Comparison),
    Comma,
    OpenParen,
    CloseParen,
    EndOfText,
}

/// A token with its byte range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Token {
    pub(super) kind: TokenKind,
    pub(super) start: usize,
    pub(super) end: usize,
}

impl Token {
    fn new(kind: TokenKind, start: usize, length: usize) -> Self {
        let end = start + length;
        Self { kind, start, end }
    }

    pub(super) fn span(self) -> Range<usize> {
        self.start..self.end
    }
}

/// The next token at or after byte `start`, after blanks.
pub(super) fn next_token(text: &str, start: usize) -> Result<Token, ExpressionError> {
    let tail = text.get(start..).unwrap_or("");
    let rest = tail.trim_start();
    let start = start + tail.len() - rest.len();
    let token = |kind, length| Ok(Token::new(kind, start, length));
    let Some(first) = rest.chars().next() else {
        return token(TokenKind::EndOfText, 0);
    };
    let second = rest[first.len_utf8()..].chars().next();
    if first.is_ascii_digit() || (first == '.' && second.is_some_and(|c| c.is_ascii_digit())) {
        return number(rest, start);
    }
    if starts_identifier(first) {
        let length = rest
            .find(|c| !continues_identifier(c))
            .unwrap_or(rest.len());
        return token(TokenKind::Identifier, length);
    }
    match (first, second) {
        ('+', _) => token(TokenKind::Plus, 1),
        ('-', _) => token(TokenKind::Minus, 1),
        ('*', _) => token(TokenKind::Star, 1),
        ('/', _) => token(TokenKind::Slash, 1),
        ('^', _) => token(TokenKind::Caret, 1),
        (',', _) => token(TokenKind::Comma, 1),
        ('(', _) => token(TokenKind::OpenParen, 1),
        (')', _) => token(TokenKind::CloseParen, 1),
        ('<', Some('=')) => token(TokenKind::Comparison(Comparison::LessOrEqual), 2),
        ('>', Some('=')) => token(TokenKind::Comparison(Comparison::GreaterOrEqual), 2),
        ('<', _) => token(TokenKind::Comparison(Comparison::Less), 1),
        ('>', _) => token(TokenKind::Comparison(Comparison::Greater), 1),
        ('`', _) => match rest[1..].find('`') {
            Some(length) => token(TokenKind::QuotedIdentifier, length + 2),
            None => Err(ExpressionError::new(
                start..start + 1,
                "this backtick begins a name that has no end",
            )
            .help("a name with other characters than letters, digits, `_` and `.` stands between two backticks")),
        },
        _ => Err(unexpected(first, start)),
    }
}

/// Digits with at most one point, and an exponent only if it has digits of its own.
fn number(rest: &str, start: usize) -> Result<Token, ExpressionError> {
    let digits = |at: usize| {
        let tail = rest.get(at..).unwrap_or("");
        at + tail.bytes().take_while(u8::is_ascii_digit).count()
    };
    let mut length = digits(0);
    if rest[length..].starts_with('.') {
        length = digits(length + 1);
    }
    if rest[length..].starts_with(['e', 'E']) {
        let sign = usize::from(rest[length + 1..].starts_with(['+', '-']));
        let end = digits(length + 1 + sign);
        if end > length + 1 + sign {
            length = end;
        }
    }
    match rest[..length].parse::<f64>() {
        Ok(number) if number.is_finite() => {
            Ok(Token::new(TokenKind::Number(number), start, length))
        }
        _ => Err(ExpressionError::new(
            start..start + length,
            "this number is too large",
        )),
    }
}

fn unexpected(c: char, start: usize) -> ExpressionError {
    let error = ExpressionError::new(
        start..start + c.len_utf8(),
        format!("unexpected character {c:?}"),
    );
    let instead = match c {
        '−' | '–' => "write `-`",
        '·' | '×' | '⋅' => "write `*`",
        '÷' | ':' => "write `/`",
        '≤' => "write `<=`",
        '≥' => "write `>=`",
        '²' => "write `^2`",
        '³' => "write `^3`",
        '√' => "write `sqrt(…)`",
        '=' | '!' | '&' | '|' => "the comparisons are `<`, `<=`, `>` and `>=`",
        '[' | ']' | '{' | '}' => "only round parentheses group",
        '\'' | '"' => {
            "a name with other characters than letters, digits, `_` and `.` stands between two backticks"
        }
        _ => return error,
    };
    error.help(instead)
}
