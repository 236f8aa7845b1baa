//! Values of a scene file.

use std::fmt;

/// A value of a key of a scene: a number, a boolean, a text (a name, a point `body.point`, an expression), a list, or a
/// table of keys. All types of values in a scene convert into it.
///
/// ```
/// use dwell::Value;
/// assert_eq!(Value::from([1.0, 0.5]).to_string(), "[1.0, 0.5]");
/// assert_eq!(Value::from("ground.A").to_string(), "\"ground.A\"");
/// assert_eq!(Value::from(true).to_string(), "true");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number, in SI.
    Number(f64),
    /// True or false.
    Switch(bool),
    /// A name, a point, an expression.
    Text(String),
    /// Several values.
    List(Vec<Value>),
    /// Keys with their values.
    Table(Vec<(String, Value)>),
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<bool> for Value {
    fn from(switch: bool) -> Self {
        Self::Switch(switch)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl<T: Into<Value>, const N: usize> From<[T; N]> for Value {
    fn from(list: [T; N]) -> Self {
        Self::List(list.into_iter().map(Into::into).collect())
    }
}

impl<T: Into<Value>> From<Vec<T>> for Value {
    fn from(list: Vec<T>) -> Self {
        Self::List(list.into_iter().map(Into::into).collect())
    }
}

/// Formats the value as TOML, in one line.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) if number.is_nan() => f.write_str("nan"),
            // All digits; `inf` and `1e-7` are TOML too.
            Self::Number(number) => write!(f, "{number:?}"),
            Self::Switch(switch) => write!(f, "{switch}"),
            Self::Text(text) => f.write_str(&quoted(text)),
            Self::List(list) => {
                let texts: Vec<String> = list.iter().map(Self::to_string).collect();
                write!(f, "[{}]", texts.join(", "))
            }
            Self::Table(keys) => {
                let pair = |(key, value): &(String, Self)| format!("{} = {value}", self::key(key));
                let texts: Vec<String> = keys.iter().map(pair).collect();
                write!(f, "{{ {} }}", texts.join(", "))
            }
        }
    }
}

/// A text as a basic string of TOML.
pub(crate) fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

/// A key, without quotes if TOML permits.
pub(crate) fn key(text: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !text.is_empty() && text.chars().all(bare) {
        text.to_owned()
    } else {
        quoted(text)
    }
}
