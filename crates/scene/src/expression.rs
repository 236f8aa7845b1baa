//! Expressions in strings: their errors point at the characters of the file.

use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::table_reader::{Value, string};
use dwell_laws::Expression;

/// The expression of a string, in which the names of `variables` may occur.
pub(crate) fn expression(
    value: &Value<'_>,
    variables: &[&str],
    what: &str,
    diagnostics: &mut Diagnostics,
) -> Option<Expression> {
    let text = string(value, format_args!("{what}"), diagnostics)?;
    let error = match Expression::parse(text, variables) {
        Ok(expression) => return Some(expression),
        Err(error) => error,
    };
    let at = diagnostics.part_span(&value.span(), text, error.span);
    let mut diagnostic = Diagnostic::new(format!("{what}: {}", error.message)).label(at, "here");
    // With one variable, a name of the scene is a likelier slip than a misspelt constant.
    let help = match variables {
        [only] if error.message.starts_with("unknown name") => Some(format!(
            "the variable here is `{only}`; no other name of the scene is known to it"
        )),
        _ => error.help,
    };
    if let Some(help) = help {
        diagnostic = diagnostic.help(help);
    }
    diagnostics.push(diagnostic);
    None
}
