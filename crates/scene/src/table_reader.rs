//! Tables of the file, and their entries by key.

use crate::diagnostics::{Diagnostics, Span};
use crate::keys::{self, TableSchema};
use crate::spans::SceneLocation;
use crate::units::Units;
use crate::value::{Context, NumberRule, Value};
use crate::wording::shorten;
use toml::de::{DeTable, DeValue};

/// A key of a table with its value.
#[derive(Debug, Clone)]
pub(crate) struct Entry<'a> {
    /// The key.
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    pub(crate) value: Value<'a>,
}

impl<'a> Entry<'a> {
    /// The place of its key with its value.
    pub(crate) fn span(&self) -> Span {
        self.key.start..self.value.span().end
    }

    /// The key in a message.
    pub(crate) fn written(&self) -> String {
        shorten(self.name)
    }

    pub(crate) fn log(&self) -> &'a Diagnostics {
        self.value.log()
    }

    /// Notes where its key is.
    pub(crate) fn place(&self, location: SceneLocation) {
        self.log().place(location, &self.key);
    }

    /// Reports that something is wrong with its key.
    pub(crate) fn reject<T>(
        &self,
        message: impl Into<String>,
        label: &str,
        help: impl Into<String>,
    ) -> Option<T> {
        self.log().reject(message, &[(&self.key, label)], help)
    }
}

/// A table in the order of the file.
#[derive(Debug, Clone)]
pub(crate) struct TableReader<'a> {
    /// How a message calls the table.
    pub(crate) what: String,
    /// The place of its name, for errors about missing entries.
    pub(crate) key: Span,
    /// Its place: its header, or the whole of an inline table.
    pub(crate) span: Span,
    pub(crate) entries: Vec<Entry<'a>>,
    pub(crate) context: Context<'a>,
}

impl<'a> TableReader<'a> {
    pub(crate) fn new(
        what: impl Into<String>,
        key: Span,
        span: Span,
        table: &'a DeTable<'a>,
        context: Context<'a>,
    ) -> Self {
        let entries = table.iter().map(|(key, tree)| Entry {
            name: key.get_ref(),
            key: key.span(),
            value: Value { tree, context },
        });
        let mut entries: Vec<_> = entries.collect();
        entries.sort_by_key(|e| e.key.start);
        let what = what.into();
        Self {
            what,
            key,
            span,
            entries,
            context,
        }
    }

    /// The table that is the value of `entry`.
    pub(crate) fn open(entry: &Entry<'a>, what: impl Into<String>) -> Option<Self> {
        Self::of_value(entry.value, entry.key.clone(), what)
    }

    /// Reads `value` as a table; `key` is the place of its name.
    pub(crate) fn of_value(value: Value<'a>, key: Span, what: impl Into<String>) -> Option<Self> {
        let what = what.into();
        match value.get() {
            DeValue::Table(table) => Some(Self::new(what, key, value.span(), table, value.context)),
            _ => value.mismatch("a table", what),
        }
    }

    pub(crate) fn log(&self) -> &'a Diagnostics {
        self.context.log
    }

    pub(crate) fn units(&self) -> &'a Units {
        self.context.units
    }

    pub(crate) fn get(&self, name: &str) -> Option<&Entry<'a>> {
        self.entries.iter().find(|e| e.name == name)
    }

    /// Notes where the value of a key is, if it is given.
    pub(crate) fn place(&self, name: &str, location: SceneLocation) {
        if let Some(entry) = self.get(name) {
            self.log().place(location, &entry.value.span());
        }
    }

    /// How a message calls an entry of it: by the key as the file has it.
    pub(crate) fn name_of(&self, entry: &Entry<'_>) -> String {
        format!("{} of {}", entry.written(), self.what)
    }

    /// The entry of that key, or an error that it is missing; `help` describes the notation.
    pub(crate) fn require(&self, key: &str, help: &str) -> Option<&Entry<'a>> {
        self.get(key).or_else(|| {
            let message = format!("{} has no `{key}`", self.what);
            let label = format!("`{key}` is missing");
            self.log().reject(message, &[(&self.key, &label)], help)
        })
    }

    /// The number of that key in SI, or `default` if it is absent; `None` if it is invalid.
    pub(crate) fn number_or(&self, default: f64, key: &str, rule: &NumberRule<'_>) -> Option<f64> {
        match self.get(key) {
            Some(entry) => entry.value.quantity_with_sign(rule, self.name_of(entry)),
            None => Some(default),
        }
    }

    /// The number of that key in SI, which has to be there; `help` describes the notation.
    pub(crate) fn number(&self, key: &str, help: &str, rule: &NumberRule<'_>) -> Option<f64> {
        let entry = self.require(key, help)?;
        entry.value.quantity_with_sign(rule, self.name_of(entry))
    }

    /// The value of a boolean key, `false` if it is absent; `None` if it is invalid.
    pub(crate) fn boolean(&self, key: &str) -> Option<bool> {
        match self.get(key) {
            Some(entry) => entry
                .value
                .boolean(format_args!("`{key}` of {}", self.what)),
            None => Some(false),
        }
    }

    /// The entries that are none of the table's keys.
    pub(crate) fn unknown_entries(
        &self,
        table: &'static TableSchema,
    ) -> impl Iterator<Item = &Entry<'a>> {
        let unknown = |entry: &&Entry<'_>| !table.contains_key(entry.name);
        self.entries.iter().filter(unknown)
    }

    /// Reports the keys that are none of the table's.
    pub(crate) fn reject_unknown_keys(&self, table: &'static TableSchema) {
        for entry in self.unknown_entries(table) {
            self.report_unknown_key(entry, "keys here", table.names());
        }
    }

    /// Reports a key that is not allowed here.
    pub(crate) fn report_unknown_key<'n>(
        &self,
        entry: &Entry<'_>,
        kind: &str,
        names: impl Iterator<Item = &'n str> + Clone,
    ) {
        let help = match keys::renamed(entry.name, names.clone()) {
            Some(name) => format!("it is called `{name}`"),
            None => self.log().choices(entry.name, kind, names),
        };
        let message = format!("unknown key `{}` in {}", shorten(entry.name), self.what);
        entry.reject::<()>(message, "unknown key", help);
    }

    /// The one of several keys that exclude each other; `None` if there is none, and an error if there are two.
    pub(crate) fn one_of(&self, among: impl Fn(&str) -> bool) -> Result<Option<&Entry<'a>>, ()> {
        let mut found = self.entries.iter().filter(|e| among(e.name));
        match (found.next(), found.next()) {
            (first, None) => Ok(first),
            (None, Some(_)) => Ok(None),
            (Some(a), Some(b)) => {
                self.reject_both(a, b, ["either this", "or this"]);
                Err(())
            }
        }
    }

    /// The one key of a table of alternatives. Without one the error shows `help`, the notation. Other keys are errors, too; one
    /// of them may be a misspelling.
    pub(crate) fn alternative(
        &self,
        table: &'static TableSchema,
        lacks: &str,
        label: &str,
        help: impl Into<String>,
    ) -> Option<&Entry<'a>> {
        let alternatives = table.alternatives();
        let chosen = self.one_of(|name| alternatives.contains(&name)).ok()?;
        if chosen.is_none() && self.unknown_entries(table).next().is_none() {
            let message = format!("{} {lacks}", self.what);
            self.log().report(message, &[(&self.key, label)], help);
        }
        chosen
    }

    /// Reports two keys of which only one can be given; the labels describe each.
    pub(crate) fn reject_both(&self, a: &Entry<'_>, b: &Entry<'_>, labels: [&str; 2]) {
        let (one, other) = (a.written(), b.written());
        let message = format!("{} has both `{one}` and `{other}`", self.what);
        let labels = [(&a.key, labels[0]), (&b.key, labels[1])];
        self.log().report(message, &labels, "keep one of them");
    }
}
