//! Tables of several kinds, each identified by the one key that names it: joints, loads, drives and events.

use crate::keys::{TableSchema, kinds};
use crate::table_reader::{Entry, TableReader};
use crate::wording::list;

/// The kind of a joint, a load or another, and the key that names it, if there is exactly one. Reports
/// which keys are not of this kind; `thing` names the object in messages.
pub(crate) fn kind<'f, 'a>(
    fields: &'f TableReader<'a>,
    thing: &str,
) -> Option<(&'static str, &'f Entry<'a>)> {
    kind_among(fields, thing, &kinds(&format!("{thing}s")))
}

/// The kind, among these kinds.
pub(crate) fn kind_among<'f, 'a>(
    fields: &'f TableReader<'a>,
    thing: &str,
    kinds: &[&'static TableSchema],
) -> Option<(&'static str, &'f Entry<'a>)> {
    let named = |n: &str| kinds.iter().find(|t| t.kind_key() == n);
    let chosen = fields.one_of(|n| named(n).is_some()).ok()?;
    let Some(entry) = chosen else {
        report_missing_kind(fields, thing, kinds);
        return None;
    };
    let table = named(entry.name)?;
    for other in fields.unknown_entries(table) {
        if !kinds.iter().any(|t| t.contains_key(other.name)) {
            fields.report_unknown_key(other, "keys here", table.names());
            continue;
        }
        let (kind, key) = (entry.written(), other.written());
        let message = format!("{} is of kind `{kind}` and has no `{key}`", fields.what);
        let label = format!("not for this kind of {thing}");
        let help = match other.name {
            "axis" if table.contains_key("axes") => {
                "write `axes = [[0, 1, 0], [1, 0, 0]]`, one for each body"
            }
            "axes" if table.contains_key("axis") => "write `axis`, in the frame of the first body",
            _ => "leave it out",
        };
        other.reject::<()>(message, &label, help);
    }
    Some((table.kind_key(), entry))
}

/// Reports that no key names a kind; a key may be a misspelt kind.
fn report_missing_kind(fields: &TableReader<'_>, thing: &str, kinds: &[&'static TableSchema]) {
    let kind_names = kinds.iter().map(|t| t.kind_key());
    let count = fields.log().count();
    for entry in &fields.entries {
        if !kinds.iter().any(|t| t.contains_key(entry.name)) {
            let kind = format!("kinds of a {thing}");
            fields.report_unknown_key(entry, &kind, kind_names.clone());
        }
    }
    // A misspelt kind is one slip, not two.
    if fields.log().count() > count {
        return;
    }
    let first = kinds.iter().take(1).flat_map(|t| &t.keys);
    let needed = first.filter(|k| k.presence.is_none());
    let keys: Vec<_> = needed
        .map(|k| format!("{} = {}", k.name, k.example))
        .collect();
    let example = keys.join(", ");
    let list = list(kind_names).unwrap_or_default();
    let help = format!("write it as `{{ {example} }}`; the kinds are {list}");
    let message = format!("{} has no kind", fields.what);
    let labels = [(&fields.key, "no kind")];
    fields.log().report(message, &labels, help);
}

/// Reports a kind in keys.toml that its reader does not handle, instead of treating it as another kind.
pub(crate) fn reject_unread_kind<T>(entry: &Entry<'_>) -> Option<T> {
    let message = format!("`{}` cannot be read by this version", entry.name);
    entry.reject(message, "this kind", "")
}
