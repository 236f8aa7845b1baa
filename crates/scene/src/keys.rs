//! The allowed contents of a scene: the tables of `keys.toml`, which describes each field.

use serde::Deserialize;
use std::collections::HashMap;
use std::sync::LazyLock;
use toml::de::DeTable;

#[derive(Deserialize)]
struct Keys {
    kinds: HashMap<String, Vec<String>>,
    tables: HashMap<String, TableSchema>,
}

/// A table of a scene.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TableSchema {
    pub(crate) name: String,
    pub(crate) doc: String,
    #[serde(default)]
    pub(crate) keys: Vec<KeySchema>,
    pub(crate) named: Option<KeySchema>,
}

/// A key of a table.
#[derive(Debug, Deserialize)]
pub(crate) struct KeySchema {
    pub(crate) name: String,
    /// Its name before the first release, for the help of an error.
    pub(crate) former: Option<String>,
    #[serde(rename = "value")]
    pub(crate) shape: ValueShape,
    #[serde(default)]
    pub(crate) unit: String,
    /// Absent for a key that is needed.
    #[serde(flatten)]
    pub(crate) presence: Option<Presence>,
    pub(crate) doc: String,
    pub(crate) example: String,
}

/// When a key may be absent.
#[derive(Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Presence {
    /// The key is optional; this is the default.
    Absent(String),
    /// Where another of its group is given: exactly one of them is needed.
    OneOf(String),
    /// Where all keys of another set are given.
    Set(String),
}

/// How the value of a key is written.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum ValueShape {
    Text,
    Number,
    Boolean,
    /// A whole number, at least two.
    Count,
    /// One of these words.
    Word(Vec<String>),
    /// An expression in a string.
    Expression,
    /// `[x, y]`.
    Pair,
    /// `[[x, y], [x, y]]`, two of them exactly.
    TwoPairs,
    /// `[x, y, z]`.
    Triple,
    /// `[[x, y, z], [x, y, z]]`, two of them exactly.
    TwoTriples,
    /// Three or six numbers.
    Tensor,
    /// `[[x, y], ...]`, two or more.
    Rows,
    /// `[x, x, ...]`, four or more.
    Numbers,
    /// A string that names something: `body`, `body.point`.
    Name(String),
    /// Two of them.
    TwoNames(String),
    /// A list of names with a minimum length.
    Names(usize, String),
    /// The table of that id.
    Table(String),
    /// A list of such tables.
    Tables(String),
    /// A table of one of several kinds, each identified by its first key.
    Kinds(String),
    /// Any of these.
    Either(Vec<ValueShape>),
}

static KEYS: LazyLock<Keys> = LazyLock::new(|| {
    // The files are part of the program: every test would meet a mistake in them.
    #[allow(clippy::expect_used, reason = "no user can influence it")]
    let read = |text| toml::from_str::<Keys>(text).expect("keys.toml has tables of this form");
    let (mut keys, space) = (
        read(include_str!("keys.toml")),
        read(include_str!("space/keys.toml")),
    );
    keys.kinds.extend(space.kinds);
    keys.tables.extend(space.tables);
    keys
});

/// The table that `keys.toml` describes under `id`. Panics if there is none: ids occur only in this crate and in the file, and a
/// test checks all of them.
pub(crate) fn table(id: &str) -> &'static TableSchema {
    &KEYS.tables[id]
}

/// The kinds of `things`: joints, loads, drives or events.
pub(crate) fn kinds(things: &str) -> Vec<&'static TableSchema> {
    kind_ids(things).iter().map(|id| table(id)).collect()
}

/// Their ids.
pub(crate) fn kind_ids(things: &str) -> &'static [String] {
    &KEYS.kinds[things]
}

/// The schemas that describe the keys of a table which is a value of this shape. A table of one of several kinds has that of its kind.
pub(crate) fn schemas_of(
    of: &DeTable<'_>,
    shape: &'static ValueShape,
) -> Vec<&'static TableSchema> {
    match shape {
        ValueShape::Table(id) => vec![table(id)],
        ValueShape::Kinds(things) => {
            let mut kinds = kinds(things);
            kinds.retain(|kind| of.contains_key(kind.kind_key()));
            kinds
        }
        ValueShape::Either(shapes) => {
            let each = shapes.iter().flat_map(|shape| schemas_of(of, shape));
            each.collect()
        }
        _ => Vec::new(),
    }
}

/// The name among `names` of a key that was called `former` before the first release.
pub(crate) fn renamed<'n>(
    former: &str,
    mut names: impl Iterator<Item = &'n str>,
) -> Option<&'n str> {
    let keys = || KEYS.tables.values().flat_map(|table| &table.keys);
    names.find(|name| keys().any(|key| key.name == *name && key.former.as_deref() == Some(former)))
}

impl KeySchema {
    pub(crate) fn is_one_of(&self) -> bool {
        matches!(self.presence, Some(Presence::OneOf(_)))
    }
}

impl TableSchema {
    /// Names of its keys.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> + Clone {
        self.keys.iter().map(|k| k.name.as_str())
    }

    pub(crate) fn contains_key(&self, name: &str) -> bool {
        self.names().any(|n| n == name)
    }

    /// The key of that name, or the description of the names of the scene's own.
    pub(crate) fn key(&self, name: &str) -> Option<&KeySchema> {
        let known = self.keys.iter().find(|k| k.name == name);
        known.or(self.named.as_ref())
    }

    /// Names of its keys of which exactly one is needed; no table has two such groups.
    pub(crate) fn alternatives(&self) -> Vec<&str> {
        let alternatives = self.keys.iter().filter(|k| k.is_one_of());
        alternatives.map(|k| k.name.as_str()).collect()
    }

    /// The names of each of its sets of keys, in their order.
    pub(crate) fn sets(&self) -> Vec<Vec<&str>> {
        let mut sets: Vec<(&str, Vec<&str>)> = Vec::new();
        for key in &self.keys {
            let Some(Presence::Set(set)) = &key.presence else {
                continue;
            };
            match sets.iter_mut().find(|(name, _)| name == set) {
                Some((_, keys)) => keys.push(&key.name),
                None => sets.push((set, vec![&key.name])),
            }
        }
        sets.into_iter().map(|(_, keys)| keys).collect()
    }

    /// The key that names its kind among others.
    pub(crate) fn kind_key(&self) -> &str {
        self.keys.first().map_or("", |k| &k.name)
    }
}
