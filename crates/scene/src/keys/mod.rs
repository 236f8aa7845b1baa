//! What can be written in a scene: each table with its keys. From this one description come the
//! lists of keys that messages know, the schema that editors complete with, and the tables of
//! docs/scene-format.md.

mod acting;
mod driving;
mod free;
mod moving;
mod parts;
mod root;

pub(crate) use acting::{LOADS, RUBBING_PIN, RUBBING_SLIDE};
pub(crate) use driving::DRIVES;
pub(crate) use free::{EVENT_KINDS, MOTION};
pub(crate) use moving::{LAW, MAGNITUDE, PRESCRIBED, PROFILE, SINUSOID, SWEEP, TRAPEZOID};
pub(crate) use parts::{ACTUATOR, BODY, COORDINATE, JOINTS, LAWS_OF_RELATIONS};
pub(crate) use root::{CALIBRATION, DWELL, REQUESTS, SCENE, SECTION, UNITS};

/// A table of a scene.
#[derive(Debug)]
pub(crate) struct Table {
    /// How the documentation calls it: its header, or its first key.
    pub(crate) name: &'static str,
    /// What it is for, in a sentence.
    pub(crate) doc: &'static str,
    /// Its keys.
    pub(crate) keys: &'static [Key],
    /// What its other keys are, where they are names of the scene's own.
    pub(crate) named: Option<Key>,
}

/// A key of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) shape: Shape,
    /// Unit of its numbers; `length`, `angle`, `mass` and `inertia` are the scene's own.
    pub(crate) unit: &'static str,
    pub(crate) need: Need,
    /// What it says, in a sentence.
    pub(crate) doc: &'static str,
    /// A value as it is written.
    pub(crate) example: &'static str,
}

/// Whether a key has to be there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Need {
    Required,
    /// What stands in for it.
    Default(&'static str),
    /// Exactly one of the table's keys of this group.
    OneOf(&'static str),
    /// All keys of exactly one of the table's sets.
    Set(&'static str),
}

/// How the value of a key is written.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Shape {
    Text,
    Number,
    Boolean,
    /// A whole number, at least two.
    Count,
    /// One of these words.
    Word(&'static [&'static str]),
    /// An expression in a string.
    Expression,
    /// `[x, y]`.
    Pair,
    /// `[[x, y], [x, y]]`, two of them exactly.
    TwoPairs,
    /// `[[x, y], ...]`, two or more.
    Rows,
    /// A string that names something: `body`, `body.point`.
    Name(&'static str),
    /// Two of them.
    TwoNames(&'static str),
    /// A list of them, at least so many.
    Names(&'static str, usize),
    Table(&'static Table),
    /// A list of tables.
    Tables(&'static Table),
    /// A table of one of several kinds, each told by its first key.
    Kinds(&'static [&'static Table]),
    /// Any of these.
    Either(&'static [Shape]),
}

/// A key that has to be there.
const fn key(
    name: &'static str,
    shape: Shape,
    unit: &'static str,
    doc: &'static str,
    example: &'static str,
) -> Key {
    Key {
        name,
        shape,
        unit,
        need: Need::Required,
        doc,
        example,
    }
}

impl Key {
    /// The same key, which may be absent.
    const fn or(mut self, default: &'static str) -> Self {
        self.need = Need::Default(default);
        self
    }

    /// The same key, one of a group of which one has to be there.
    const fn one_of(mut self, group: &'static str) -> Self {
        self.need = Need::OneOf(group);
        self
    }

    /// The same key, needed with the others of its set, where no other set is there.
    const fn in_set(mut self, set: &'static str) -> Self {
        self.need = Need::Set(set);
        self
    }
}

/// A table without keys of the scene's own.
const fn table(name: &'static str, doc: &'static str, keys: &'static [Key]) -> Table {
    Table {
        name,
        doc,
        keys,
        named: None,
    }
}

impl Table {
    /// Names of its keys.
    pub(crate) fn names(&self) -> impl Iterator<Item = &'static str> + Clone + use<> {
        let keys = self.keys;
        keys.iter().map(|k| k.name)
    }

    pub(crate) fn knows(&self, name: &str) -> bool {
        self.names().any(|n| n == name)
    }

    /// The names of each of its sets of keys, in their order.
    pub(crate) fn sets(&self) -> Vec<Vec<&'static str>> {
        let mut sets: Vec<(&str, Vec<&'static str>)> = Vec::new();
        for key in self.keys {
            let Need::Set(set) = key.need else { continue };
            match sets.iter_mut().find(|(name, _)| *name == set) {
                Some((_, keys)) => keys.push(key.name),
                None => sets.push((set, vec![key.name])),
            }
        }
        sets.into_iter().map(|(_, keys)| keys).collect()
    }

    /// The key that tells its kind among others.
    pub(crate) fn kind(&self) -> &'static str {
        self.keys.first().map_or("", |k| k.name)
    }
}
