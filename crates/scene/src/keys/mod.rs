//! What can be written in a scene: each table with its keys. From this one description come the
//! lists of keys that messages know, the schema that editors complete with, and the tables of
//! docs/scene-format.md.

mod drives;
mod loads;
mod mechanism;
mod motion;
mod prescribed;
mod scene;

pub(crate) use drives::DRIVES;
pub(crate) use loads::{LOADS, PRISMATIC_FRICTION, REVOLUTE_FRICTION};
pub(crate) use mechanism::{ACTUATOR, BODY, COORDINATE, COUPLING_LAWS, JOINTS};
pub(crate) use motion::{EVENT_KINDS, MOTION};
pub(crate) use prescribed::{
    COORDINATE_SWEEP, LAW, MAGNITUDE, PRESCRIBED, PROFILE, SINUSOID, TRAPEZOID,
};
pub(crate) use scene::{CALIBRATION, DWELL, REQUESTS, SCENE, SECTION, UNITS};

/// A table of a scene.
#[derive(Debug)]
pub(crate) struct TableSchema {
    /// How the documentation calls it: its header, or its first key.
    pub(crate) name: &'static str,
    /// What it is for, in a sentence.
    pub(crate) doc: &'static str,
    /// Its keys.
    pub(crate) keys: &'static [KeySchema],
    /// What its other keys are, where they are names of the scene's own.
    pub(crate) named: Option<KeySchema>,
}

/// A key of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KeySchema {
    pub(crate) name: &'static str,
    /// Its former names, which are still read.
    pub(crate) former: &'static [&'static str],
    pub(crate) shape: ValueShape,
    /// Unit of its numbers; `length`, `angle`, `mass` and `inertia` are the scene's own.
    pub(crate) unit: &'static str,
    pub(crate) presence: Presence,
    /// What it says, in a sentence.
    pub(crate) doc: &'static str,
    /// A value as it is written.
    pub(crate) example: &'static str,
}

/// Whether a key has to be there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Presence {
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
pub(crate) enum ValueShape {
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
    Table(&'static TableSchema),
    /// A list of tables.
    Tables(&'static TableSchema),
    /// A table of one of several kinds, each told by its first key.
    Kinds(&'static [&'static TableSchema]),
    /// Any of these.
    Either(&'static [ValueShape]),
}

/// A key that has to be there.
const fn key(
    name: &'static str,
    shape: ValueShape,
    unit: &'static str,
    doc: &'static str,
    example: &'static str,
) -> KeySchema {
    KeySchema {
        name,
        former: &[],
        shape,
        unit,
        presence: Presence::Required,
        doc,
        example,
    }
}

impl KeySchema {
    /// The same key, which had these names before.
    const fn formerly(mut self, former: &'static [&'static str]) -> Self {
        self.former = former;
        self
    }

    /// Its name before it was renamed; its name if it never was.
    pub(crate) fn former_name(&self) -> &'static str {
        self.former.first().copied().unwrap_or(self.name)
    }

    /// The same key, which may be absent.
    const fn with_default(mut self, default: &'static str) -> Self {
        self.presence = Presence::Default(default);
        self
    }

    /// The same key, one of a group of which one has to be there.
    const fn one_of(mut self, group: &'static str) -> Self {
        self.presence = Presence::OneOf(group);
        self
    }

    /// The same key, needed with the others of its set, where no other set is there.
    const fn in_set(mut self, set: &'static str) -> Self {
        self.presence = Presence::Set(set);
        self
    }
}

/// A table without keys of the scene's own.
const fn table(name: &'static str, doc: &'static str, keys: &'static [KeySchema]) -> TableSchema {
    TableSchema {
        name,
        doc,
        keys,
        named: None,
    }
}

impl TableSchema {
    /// Names of its keys.
    pub(crate) fn names(&self) -> impl Iterator<Item = &'static str> + Clone + use<> {
        let keys = self.keys;
        keys.iter().map(|k| k.name)
    }

    pub(crate) fn contains_key(&self, name: &str) -> bool {
        self.names().any(|n| n == name)
    }

    /// The key of that name, or the description of the names of the scene's own.
    pub(crate) fn key(&self, name: &str) -> Option<KeySchema> {
        let known = self.keys.iter().find(|k| k.name == name);
        known.copied().or(self.named)
    }

    /// The names of each of its sets of keys, in their order.
    pub(crate) fn sets(&self) -> Vec<Vec<&'static str>> {
        let mut sets: Vec<(&str, Vec<&'static str>)> = Vec::new();
        for key in self.keys {
            let Presence::Set(set) = key.presence else {
                continue;
            };
            match sets.iter_mut().find(|(name, _)| *name == set) {
                Some((_, keys)) => keys.push(key.name),
                None => sets.push((set, vec![key.name])),
            }
        }
        sets.into_iter().map(|(_, keys)| keys).collect()
    }

    /// The key that tells its kind among others.
    pub(crate) fn kind_key(&self) -> &'static str {
        self.keys.first().map_or("", |k| k.name)
    }
}
