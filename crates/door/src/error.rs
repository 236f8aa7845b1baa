//! Why a file cannot be imported.

use std::ops::Range;
use std::sync::Arc;
use thiserror::Error;

pub(crate) type Result<T> = std::result::Result<T, DoorError>;

/// The error of an import.
#[derive(Debug, Clone, Error)]
#[error("{message}")]
pub struct DoorError {
    /// What is wrong.
    pub message: String,
    /// What may help; may be empty.
    pub help: String,
    /// The part of a file that the error is about.
    pub part: Option<Part>,
}

/// A part of a file.
#[derive(Debug, Clone)]
pub struct Part {
    /// The file.
    pub file: Arc<str>,
    /// Its text.
    pub text: Arc<str>,
    /// The bytes of the part.
    pub span: Range<usize>,
}

impl DoorError {
    pub(crate) fn new(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            help: help.into(),
            part: None,
        }
    }

    /// An option names a part that the model does not have.
    pub(crate) fn unknown<'n>(
        what: &str,
        name: &str,
        known: impl Iterator<Item = &'n str>,
    ) -> Self {
        let known = known.collect::<Vec<_>>().join(", ");
        let has = if known.is_empty() { "none" } else { &known };
        Self::new(
            format!("the model has no {what} `{name}`: it has {has}"),
            "",
        )
    }

    /// The message with its place, and what may help.
    pub fn full_message(&self) -> String {
        let place = self.part.as_ref().map_or(String::new(), |part| {
            let before = part.text.get(..part.span.start).unwrap_or_default();
            format!("{}:{}: ", part.file, 1 + before.matches('\n').count())
        });
        match self.help.as_str() {
            "" => format!("{place}{self}"),
            help => format!("{place}{self} ({help})"),
        }
    }
}
