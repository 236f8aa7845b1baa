//! Names: which ones are allowed.

use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::wording::{MAX_NAME_LENGTH, shorten};

/// Says what is wrong with a name of `kind` ("a body"), if anything. A name is quoted in
/// messages, joined with dots, and heads columns of tables, so it has to survive all three.
pub(crate) fn check(kind: &str, name: &str, key: &Span, diagnostics: &mut Diagnostics) {
    let short_name = shorten(name);
    let diagnostic = if name.is_empty() {
        Diagnostic::new(format!("the name of {kind} is empty"))
    } else if name.contains('.') {
        Diagnostic::new(format!("the name `{short_name}` of {kind} holds a dot"))
            .help("a dot joins names, as in `body.point`: take `-` or `_` instead")
    } else if name.chars().count() > MAX_NAME_LENGTH {
        Diagnostic::new(format!(
            "the name of {kind} is longer than {MAX_NAME_LENGTH} characters"
        ))
    } else if name.trim() != name || !name.chars().all(allowed) {
        Diagnostic::new(format!("`{short_name}` cannot be the name of {kind}"))
            .help("a name is made of letters, digits, `_`, `-`, primes and inner spaces")
    } else {
        return;
    };
    diagnostics.push(diagnostic.label(key.clone(), "this name"));
}

fn allowed(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '-' | ' ' | '\'' | '′' | '″')
}
