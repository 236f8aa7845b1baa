//! The text cut into numbers, names and signs.

use std::ops::Range;

use super::error::ExpressionError;
use super::function::Comparison;
use super::tape::{begins_name, continues_name};

/// What a piece of the text is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Number(f64),
    /// Letters, digits, `_` and `.`.
    Plain,
    /// Anything between backticks.
    Quoted,
    Plus,
    Minus,
    Star,
    Slash,
    Caret,
    Comparison(Comparison),
    Comma,
    Open,
    Close,
    End,
}

/// A piece of the text, from one byte to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) from: usize,
    pub(super) to: usize,
}

impl Token {
    pub(super) fn span(self) -> Range<usize> {
        self.from..self.to
    }
}

/// The piece that begins at byte `from` or, after blanks, behind it.
pub(super) fn next(text: &str, from: usize) -> Result<Token, ExpressionError> {
    let tail = text.get(from..).unwrap_or("");
    let rest = tail.trim_start();
    let from = from + tail.len() - rest.len();
    let Some(first) = rest.chars().next() else {
        let kind = Kind::End;
        return Ok(Token {
            kind,
            from,
            to: from,
        });
    };
    let token = |kind, length| {
        Ok(Token {
            kind,
            from,
            to: from + length,
        })
    };
    let second = rest[first.len_utf8()..].chars().next();
    if first.is_ascii_digit() || (first == '.' && second.is_some_and(|c| c.is_ascii_digit())) {
        return number(rest, from);
    }
    if begins_name(first) {
        let length = rest.find(|c| !continues_name(c)).unwrap_or(rest.len());
        return token(Kind::Plain, length);
    }
    match (first, second) {
        ('+', _) => token(Kind::Plus, 1),
        ('-', _) => token(Kind::Minus, 1),
        ('*', _) => token(Kind::Star, 1),
        ('/', _) => token(Kind::Slash, 1),
        ('^', _) => token(Kind::Caret, 1),
        (',', _) => token(Kind::Comma, 1),
        ('(', _) => token(Kind::Open, 1),
        (')', _) => token(Kind::Close, 1),
        ('<', Some('=')) => token(Kind::Comparison(Comparison::LessOrEqual), 2),
        ('>', Some('=')) => token(Kind::Comparison(Comparison::GreaterOrEqual), 2),
        ('<', _) => token(Kind::Comparison(Comparison::Less), 1),
        ('>', _) => token(Kind::Comparison(Comparison::Greater), 1),
        ('`', _) => match rest[1..].find('`') {
            Some(length) => token(Kind::Quoted, length + 2),
            None => Err(ExpressionError::new(
                from..from + 1,
                "this backtick begins a name that has no end",
            )
            .help("a name with other characters than letters, digits, `_` and `.` stands between two backticks")),
        },
        _ => Err(unexpected(first, from)),
    }
}

/// Digits with at most one point, and an exponent only if it has digits of its own.
fn number(rest: &str, from: usize) -> Result<Token, ExpressionError> {
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
    let to = from + length;
    match rest[..length].parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(Token {
            kind: Kind::Number(number),
            from,
            to,
        }),
        _ => Err(ExpressionError::new(from..to, "this number is too large")),
    }
}

fn unexpected(c: char, from: usize) -> ExpressionError {
    let error = ExpressionError::new(
        from..from + c.len_utf8(),
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
