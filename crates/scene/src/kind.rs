//! Tables of several kinds, each told by the one key that names it: joints, loads, drives and events.

use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::keys::{TableSchema, kinds};
use crate::table_reader::{Entry, TableReader};
use crate::wording::list;

/// The kind of a joint, a load or another, and the key that names it, if there is exactly one. Says which
/// keys are not of this kind; `thing` is what has a kind, `at` its name.
pub(crate) fn kind<'f, 'a>(
    fields: &'f TableReader<'a>,
    at: &Span,
    thing: &str,
    diagnostics: &mut Diagnostics,
) -> Option<(&'static str, &'f Entry<'a>)> {
    let kinds = kinds(&format!("{thing}s"));
    let named = |n: &str| kinds.iter().find(|t| t.kind_key() == n);
    let chosen = fields.one_of(|n| named(n).is_some(), diagnostics).ok()?;
    let Some(entry) = chosen else {
        report_missing_kind(fields, at, thing, &kinds, diagnostics);
        return None;
    };
    let table = named(entry.name)?;
    for other in fields
        .entries
        .iter()
        .filter(|e| !table.contains_key(e.name))
    {
        if !kinds.iter().any(|t| t.contains_key(other.name)) {
            fields.report_unknown_key(other, "keys here", table.names(), diagnostics);
            continue;
        }
        diagnostics.push(
            Diagnostic::new(format!(
                "{} is of kind `{}` and has no `{}`",
                fields.what, entry.name, other.name
            ))
            .label(other.key.clone(), format!("not for this kind of {thing}"))
            .help("leave it out"),
        );
    }
    Some((table.kind_key(), entry))
}

/// Says that no key names a kind: one of them may have been meant to.
fn report_missing_kind(
    fields: &TableReader<'_>,
    at: &Span,
    thing: &str,
    kinds: &[&'static TableSchema],
    diagnostics: &mut Diagnostics,
) {
    let kind_names = kinds.iter().map(|t| t.kind_key());
    let count = diagnostics.count();
    for entry in &fields.entries {
        if !kinds.iter().any(|t| t.contains_key(entry.name)) {
            let kind = format!("kinds of a {thing}");
            fields.report_unknown_key(entry, &kind, kind_names.clone(), diagnostics);
        }
    }
    // A misspelt kind is one slip, not two.
    if diagnostics.count() > count {
        return;
    }
    let keys = kinds.first().map_or(&[][..], |t| &t.keys);
    let needed = keys.iter().filter(|k| k.presence.is_none());
    let example: Vec<_> = needed
        .map(|k| format!("{} = {}", k.name, k.example))
        .collect();
    let example = example.join(", ");
    let list = list(kind_names).unwrap_or_default();
    diagnostics.push(
        Diagnostic::new(format!("{} has no kind", fields.what))
            .label(at.clone(), "no kind")
            .help(format!(
                "write it as `{{ {example} }}`; the kinds are {list}"
            )),
    );
}
