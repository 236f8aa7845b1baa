//! TOML text.

use crate::error::{DoorError, Result};

/// The largest number that a scene may have.
const LARGEST: f64 = 1e60;
/// In place of a number that no scene may have; it is in no other text.
const WRONG: char = '\u{FFFF}';

#[derive(Default)]
pub(super) struct Text(String);

impl Text {
    pub(super) fn line(&mut self, line: &str) {
        self.0 += line;
        self.0 += "\n";
    }

    pub(super) fn table(&mut self, path: &str) {
        self.line(&format!("\n[{path}]"));
    }

    pub(super) fn pair(&mut self, name: &str, value: impl std::fmt::Display) {
        self.line(&format!("{} = {value}", key(name)));
    }

    /// An inline table.
    pub(super) fn entry(&mut self, name: &str, keys: &str) {
        self.pair(name, format_args!("{{ {keys} }}"));
    }

    pub(super) fn finish(self) -> Result<String> {
        let Some(line) = self.0.lines().find(|line| line.contains(WRONG)) else {
            return Ok(self.0);
        };
        let near: String = line.replace(WRONG, "?").chars().take(100).collect();
        let message = format!("a number is not finite, or above {LARGEST:e}, near `{near}`");
        Err(DoorError::new(message, ""))
    }
}

/// A number with 15 digits, which leaves the last rounding out.
pub(super) fn number(value: f64) -> String {
    let value = format!("{value:.14e}").parse().unwrap_or(value);
    match value {
        0.0 => "0".to_owned(),
        value if value.is_nan() || value.abs() > LARGEST => WRONG.to_string(),
        value if (1e-5..1e9).contains(&value.abs()) => format!("{value}"),
        value => format!("{value:e}"),
    }
}

pub(super) fn list(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|value| number(*value)).collect();
    format!("[{}]", values.join(", "))
}

/// A text in quotes.
pub(super) fn quoted(text: &str) -> String {
    let plain = text.replace(char::is_control, " ");
    format!("\"{}\"", plain.replace('\\', "\\\\").replace('"', "\\\""))
}

/// A key, in quotes if it needs them.
pub(super) fn key(name: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    match name.chars().all(is_bare) {
        true => name.to_owned(),
        false => quoted(name),
    }
}

/// A comment of one line.
pub(crate) fn comment(text: &str) -> String {
    let line = format!("# {}", text.replace(char::is_control, " "));
    line.trim_end().to_owned()
}
