//! How messages quote texts of the file and list names.

use dwell_laws::expression::nearest;
use std::fmt::Write as _;

/// Longest name, in characters: it has to fit a table's column.
pub(crate) const MAX_NAME_LENGTH: usize = 64;
/// Names listed in one message.
const MAX_LISTED: usize = 16;

/// A suggestion instead of the name `wrong`: the nearest of `names`, or else their list. `kind` is their kind, in the
/// plural.
pub fn choices<'n>(
    wrong: &str,
    kind: &str,
    names: impl Iterator<Item = &'n str> + Clone,
) -> String {
    match nearest(wrong, names.clone()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => match (list(names.clone()), names.count()) {
            (None, _) => format!("there are no {kind}"),
            (Some(only), 1) => format!("of the {kind} there is only {only}"),
            (Some(list), _) => format!("the {kind} are {list}"),
        },
    }
}

/// "`a`, `b` and `c`", shortened if long; `None` if there is none.
pub(crate) fn list<'n>(mut names: impl Iterator<Item = &'n str>) -> Option<String> {
    let mut text = format!("`{}`", names.next()?);
    let mut last = None;
    for (k, name) in names.enumerate() {
        if k + 1 == MAX_LISTED {
            text.push_str(", …");
            return Some(text);
        }
        if let Some(previous) = last.replace(name) {
            let _ = write!(text, ", `{previous}`");
        }
    }
    if let Some(name) = last {
        let _ = write!(text, " and `{name}`");
    }
    Some(text)
}

/// A number to four digits.
pub(crate) fn short(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}

/// A text of the file as a message quotes it: not longer than a line, no control characters.
pub(crate) fn shorten(text: &str) -> String {
    let mut short: String = text
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .take(MAX_NAME_LENGTH)
        .collect();
    if text.chars().nth(MAX_NAME_LENGTH).is_some() {
        short.push('…');
    }
    short
}
