//! Expressions in strings: their errors point at the characters of the file.

use crate::value::Value;
use dwell_laws::Expression;

/// The expression of a string, in which the names of `variables` may occur.
pub(crate) fn expression(value: Value<'_>, variables: &[&str], what: &str) -> Option<Expression> {
    let text = value.string(what)?;
    let error = match Expression::parse(text, variables) {
        Ok(expression) => return Some(expression),
        Err(error) => error,
    };
    // With one variable, a name of the scene is a likelier slip than a misspelt constant.
    let help = match variables {
        [only] if error.message.starts_with("unknown name") => {
            format!("the variable here is `{only}`; no other name of the scene is known to it")
        }
        _ => error.help.unwrap_or_default(),
    };
    let at = value.log().part_span(&value.span(), text, error.span);
    let message = format!("{what}: {}", error.message);
    value.log().reject(message, &[(&at, "here")], help)
}
