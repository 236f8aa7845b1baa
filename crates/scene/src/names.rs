//! Names: which ones are allowed, and which one was meant.

use crate::problem::{Problem, Problems, Span};

/// Longest name, in characters: it has to fit a table's column.
const LONGEST: usize = 64;

/// Says what is wrong with a name of `kind` ("a body"), if anything. A name is quoted in
/// messages, joined with dots, and heads columns of tables, so it has to survive all three.
pub(crate) fn check(kind: &str, name: &str, key: &Span, problems: &mut Problems) {
    let shown = shorten(name);
    let problem = if name.is_empty() {
        Problem::new(format!("the name of {kind} is empty"))
    } else if name.contains('.') {
        Problem::new(format!("the name `{shown}` of {kind} holds a dot"))
            .help("a dot joins names, as in `body.point`: take `-` or `_` instead")
    } else if name.chars().count() > LONGEST {
        Problem::new(format!(
            "the name of {kind} is longer than {LONGEST} characters"
        ))
    } else if name.trim() != name || !name.chars().all(allowed) {
        Problem::new(format!("`{shown}` cannot be the name of {kind}"))
            .help("a name is made of letters, digits, `_`, `-`, primes and inner spaces")
    } else {
        return;
    };
    problems.push(problem.at(key.clone(), "this name"));
}

fn allowed(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '-' | ' ' | '\'' | '′' | '″')
}

/// The name that was probably meant: the same but for capitals, or the nearest within one slip
/// in three letters, and three at most.
pub(crate) fn nearest<'n>(
    wrong: &str,
    names: impl Iterator<Item = &'n str> + Clone,
) -> Option<&'n str> {
    let length = wrong.chars().count();
    if length > LONGEST {
        return None;
    }
    let folded = wrong.to_lowercase();
    if let Some(same) = names.clone().find(|n| n.to_lowercase() == folded) {
        return Some(same);
    }
    // Two one-letter names have nothing in common; `A` is no slip for `B`.
    let slips = if length < 2 {
        0
    } else {
        length.div_ceil(3).min(3)
    };
    names
        .filter(|n| n.chars().count().abs_diff(length) <= slips)
        .map(|n| (strsim::osa_distance(&n.to_lowercase(), &folded), n))
        .filter(|(d, n)| *d <= slips && *d < n.chars().count())
        .min_by_key(|(d, _)| *d)
        .map(|(_, n)| n)
}

/// A text of the file as a message quotes it: not longer than a line, no control characters.
pub(crate) fn shorten(text: &str) -> String {
    let mut short: String = text
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .take(LONGEST)
        .collect();
    if text.chars().nth(LONGEST).is_some() {
        short.push('…');
    }
    short
}
