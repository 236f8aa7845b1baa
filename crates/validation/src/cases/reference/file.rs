//! The files of references, in TOML or JSON.

use crate::error::ValidationError;
use dwell_laws::Expression;
use serde_json::Value;
use std::path::Path;

/// The values of a file: of the ending `json` in JSON, else in TOML.
pub(crate) fn read_file(path: &Path) -> Result<Value, ValidationError> {
    let wrong = |reason: String| ValidationError::Reference {
        path: path.display().to_string(),
        reason,
    };
    let bytes = std::fs::read(path).map_err(|e| wrong(format!("cannot be read: {e}")))?;
    let text = String::from_utf8(bytes).map_err(|_| wrong("is not UTF-8 text".to_owned()))?;
    let text = text.trim_start_matches('\u{feff}');
    if path.extension().is_some_and(|ending| ending == "json") {
        return serde_json::from_str(text).map_err(|e| wrong(e.to_string()));
    }
    toml::from_str(text).map_err(|e| {
        let before = e.span().and_then(|span| text.get(..span.start));
        let line = before.map_or(1, |before| before.lines().count().max(1));
        let message = e.message().trim_end();
        wrong(format!("line {line}: not valid TOML: {message}"))
    })
}

/// A finite number: as such, as a text (fifty digits do not fit a JSON number), or as an exact expression.
pub(crate) fn number(value: &Value) -> Option<f64> {
    let found = match value {
        Value::String(text) => text.trim().parse().ok().or_else(|| {
            let expression = Expression::parse(&text.replace("**", "^"), &[]);
            Some(expression.ok()?.eval(&[]))
        }),
        other => other.as_f64(),
    };
    found.filter(|v| v.is_finite())
}

/// Numbers by their keys, if all are there.
pub(crate) fn numbers<const N: usize>(of: &Value, keys: [&str; N]) -> Option<[f64; N]> {
    let all: Option<Vec<f64>> = keys.iter().map(|key| number(&of[key])).collect();
    all?.try_into().ok()
}

/// The entries of a list; none where there is no list.
pub(crate) fn entries(of: &Value) -> &[Value] {
    of.as_array().map_or(&[], Vec::as_slice)
}
