//! Names: which ones are allowed.

use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::wording::{MAX_NAME_LENGTH, shorten};

/// Reports a fault in the name of an entry of `kind` ("a body"), if there is any. A name must be usable in quotes of
/// messages, in names joined by dots, and in headings of tables.
pub(crate) fn check(kind: &str, entry: &Entry<'_>) {
    let name = entry.name;
    let short_name = shorten(name);
    let (message, help) = if name.is_empty() {
        (format!("the name of {kind} is empty"), "")
    } else if name.contains('.') {
        let help = "a dot joins names, as in `body.point`: take `-` or `_` instead";
        (
            format!("the name `{short_name}` of {kind} holds a dot"),
            help,
        )
    } else if name.chars().count() > MAX_NAME_LENGTH {
        let message = format!("the name of {kind} is longer than {MAX_NAME_LENGTH} characters");
        (message, "")
    } else if name.trim() != name || !name.chars().all(allowed) {
        let help = "a name is made of letters, digits, `_`, `-`, primes and inner spaces";
        (format!("`{short_name}` cannot be the name of {kind}"), help)
    } else {
        return;
    };
    entry.reject::<()>(message, "this name", help);
}

/// Reports a fault in a name that may contain dots.
pub(crate) fn check_dotted(kind: &str, entry: &Entry<'_>) {
    let parts = entry.name.split('.');
    let good = |part: &str| !part.is_empty() && part.trim() == part && part.chars().all(allowed);
    if entry.name.chars().count() > MAX_NAME_LENGTH || !parts.into_iter().all(good) {
        let message = format!("`{}` cannot be the name of {kind}", shorten(entry.name));
        let help = "a name is made of letters, digits, `_`, `-`, primes, inner spaces, and dots between them";
        entry.reject::<()>(message, "this name", help);
    }
}

/// The results of `read` for the named entries of a table, in order; `thing` is their kind.
pub(crate) fn read_each<'a, T>(
    fields: &TableReader<'a>,
    thing: &str,
    location: fn(usize) -> SceneLocation,
    mut read: impl FnMut(usize, &Entry<'a>) -> Option<T>,
) -> Vec<T> {
    let one = |(k, entry): (usize, &Entry<'a>)| {
        check(thing, entry);
        entry.place(location(k));
        read(k, entry)
    };
    fields.entries.iter().enumerate().filter_map(one).collect()
}

fn allowed(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '-' | ' ' | '\'' | '′' | '″')
}
