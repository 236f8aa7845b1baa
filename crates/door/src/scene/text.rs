//! TOML text.

use crate::error::DoorError;

/// The largest number that a scene may have.
const LARGEST: f64 = 1e60;
/// In place of a number that no scene may have; it is in no other text.
const WRONG: char = '\u{1}';

#[derive(Default)]
pub(super) struct Text(String);

impl Text {
    pub(super) fn line(&mut self, line: &str) {
        self.0 += line;
        self.0 += "\n";
    }

    pub(super) fn table(&mut self, path: &[&str]) {
        let path: Vec<String> = path.iter().map(|name| key(name)).collect();
        self.line(&format!("\n[{}]", path.join(".")));
    }

    pub(super) fn pair(&mut self, name: &str, value: impl std::fmt::Display) {
        self.line(&format!("{} = {value}", key(name)));
    }

    /// An inline table.
    pub(super) fn entry(&mut self, name: &str, keys: &str) {
        self.pair(name, format_args!("{{ {keys} }}"));
    }

    pub(super) fn finish(self) -> Result<String, DoorError> {
        match self.0.lines().find(|line| line.contains(WRONG)) {
            Some(line) => Err(DoorError::Number(line.chars().take(100).collect())),
            None => Ok(self.0),
        }
    }
}

pub(super) fn number(value: f64) -> String {
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
    let bare = !name.is_empty() && name.chars().all(is_bare);
    if bare { name.to_owned() } else { quoted(name) }
}

/// A comment of one line.
pub(crate) fn comment(text: &str) -> String {
    format!("# {}", text.replace(char::is_control, " "))
        .trim_end()
        .to_owned()
}
