//! TOML text.

use crate::error::DoorError;

/// The largest number that a scene may have.
const LARGEST: f64 = 1e60;

#[derive(Default)]
pub(super) struct Text {
    text: String,
    /// The line of the first number that no scene may have.
    wrong: Option<String>,
}

impl Text {
    pub(super) fn line(&mut self, line: &str) {
        if self.wrong.as_deref() == Some("") {
            self.wrong = Some(line.to_owned());
        }
        self.text += line;
        self.text += "\n";
    }

    pub(super) fn table(&mut self, path: &[&str]) {
        let path: Vec<String> = path.iter().map(|name| key(name)).collect();
        self.text += "\n";
        self.line(&format!("[{}]", path.join(".")));
    }

    pub(super) fn pair(&mut self, key: &str, value: f64) {
        let value = self.number(value);
        self.line(&format!("{key} = {value}"));
    }

    pub(super) fn number(&mut self, value: f64) -> String {
        if !(value.abs() <= LARGEST) && self.wrong.is_none() {
            self.wrong = Some(String::new());
        }
        match value {
            0.0 => "0".to_owned(),
            value if (1e-5..1e9).contains(&value.abs()) => format!("{value}"),
            value => format!("{value:e}"),
        }
    }

    pub(super) fn list(&mut self, values: &[f64]) -> String {
        let values: Vec<String> = values.iter().map(|value| self.number(*value)).collect();
        format!("[{}]", values.join(", "))
    }

    pub(super) fn finish(&mut self) -> Result<String, DoorError> {
        match self.wrong.take() {
            Some(line) => Err(DoorError::Number(line.chars().take(120).collect())),
            None => Ok(std::mem::take(&mut self.text)),
        }
    }
}

/// A text in quotes.
pub(super) fn quoted(text: &str) -> String {
    let one = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        c if c.is_control() => " ".to_owned(),
        c => c.to_string(),
    };
    format!("\"{}\"", text.chars().map(one).collect::<String>())
}

/// A key, in quotes if it needs them.
pub(super) fn key(name: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(is_bare) {
        name.to_owned()
    } else {
        quoted(name)
    }
}

/// A comment of one line.
pub(crate) fn comment(text: &str) -> String {
    let text: String = text
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    format!("# {text}").trim_end().to_owned()
}
