//! Tables of several kinds, each told by the one key that names it: joints, loads, drives and events.

use crate::fields::{Entry, Fields};
use crate::keys::{Need, Table};
use crate::problem::{Problem, Problems, Span, list};

/// The kind of a joint, a load or another, and the key that names it, if there is exactly one. Says which
/// keys are not of this kind; `thing` is what has a kind, `at` its name.
pub(crate) fn kind<'f, 'a>(
    fields: &'f Fields<'a>,
    at: &Span,
    thing: &str,
    kinds: &[&'static Table],
    problems: &mut Problems,
) -> Option<(&'static str, &'f Entry<'a>)> {
    let named = |n: &str| kinds.iter().find(|t| t.kind() == n);
    let chosen = fields.one_of(|n| named(n).is_some(), problems).ok()?;
    let Some(entry) = chosen else {
        none(fields, at, thing, kinds, problems);
        return None;
    };
    let table = named(entry.name)?;
    for other in fields.entries.iter().filter(|e| !table.knows(e.name)) {
        if !kinds.iter().any(|t| t.knows(other.name)) {
            fields.unknown(other, "keys here", table.names(), problems);
            continue;
        }
        problems.push(
            Problem::new(format!(
                "{} is of kind `{}` and has no `{}`",
                fields.what, entry.name, other.name
            ))
            .at(other.key.clone(), format!("not for this kind of {thing}"))
            .help("leave it out"),
        );
    }
    Some((table.kind(), entry))
}

/// Says that no key names a kind: one of them may have been meant to.
fn none(
    fields: &Fields<'_>,
    at: &Span,
    thing: &str,
    kinds: &[&'static Table],
    problems: &mut Problems,
) {
    let words = kinds.iter().map(|t| t.kind());
    let count = problems.count();
    for entry in &fields.entries {
        if !kinds.iter().any(|t| t.knows(entry.name)) {
            let kind = format!("kinds of a {thing}");
            fields.unknown(entry, &kind, words.clone(), problems);
        }
    }
    // A misspelt kind is one slip, not two.
    if problems.count() > count {
        return;
    }
    let keys = kinds.first().map_or(&[][..], |t| t.keys);
    let needed = keys.iter().filter(|k| k.need == Need::Required);
    let example: Vec<_> = needed
        .map(|k| format!("{} = {}", k.name, k.example))
        .collect();
    let example = example.join(", ");
    let list = list(words).unwrap_or_default();
    problems.push(
        Problem::new(format!("{} has no kind", fields.what))
            .at(at.clone(), "of which kind?")
            .help(format!(
                "write it as `{{ {example} }}`; the kinds are {list}"
            )),
    );
}
