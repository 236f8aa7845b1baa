//! Which keys exist, and which of them a scene uses: both from the one description in `keys.toml`, so that a study of all keys
//! cannot forget one.

use crate::keys::{self, KeySchema, TableSchema, ValueShape};
use toml::{Table, Value};

/// A key that a scene can have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneKey {
    /// Its table and its name, such as `[units] length` or `spring: stiffness`: no two keys have the same.
    pub id: String,
    /// The name of its table, such as `spring`.
    pub table: &'static str,
    /// Its name, or a placeholder for names of the scene, such as `<body>`.
    pub name: &'static str,
    /// Its meaning, in a sentence.
    pub doc: &'static str,
    /// Whether its value is always a table, so that other keys describe it.
    pub holds_keys: bool,
}

/// How the value of a used key is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrittenAs {
    /// Words for readers.
    Text,
    /// A number.
    Number,
    /// `true` or `false`.
    Boolean,
    /// A whole number.
    Count,
    /// One of these words.
    Word(&'static [String]),
    /// An expression in a string.
    Expression,
    /// `[x, y]`.
    Pair,
    /// `[[x, y], ...]`.
    Rows,
    /// `[x, x, ...]`.
    Numbers,
    /// A string that names something of this sort, such as `body.point`.
    Name(&'static str),
    /// A list of such names.
    Names(&'static str),
    /// A table, or a list of tables.
    Table,
}

/// A step to a value in a scene.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PathStep {
    /// The key of a table.
    Key(String),
    /// The place in a list.
    Index(usize),
}

/// A place where a scene uses a key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyUse {
    /// The [id](SceneKey::id) of the key.
    pub key: String,
    /// The steps to its value.
    pub path: Vec<PathStep>,
    /// How the value is written there.
    pub written: WrittenAs,
}

/// Every key that a scene can have, in the order of `keys.toml`.
pub fn scene_keys() -> Vec<SceneKey> {
    let mut ids = Vec::new();
    gather_tables("scene", &mut ids);
    let of_table = |id: &&'static str| {
        let table = keys::table(id);
        let keys = table.keys.iter().chain(&table.named);
        keys.map(move |key| SceneKey {
            id: key_id(table, key),
            table: &table.name,
            name: &key.name,
            doc: &key.doc,
            holds_keys: matches!(
                key.shape,
                ValueShape::Table(_) | ValueShape::Tables(_) | ValueShape::Kinds(_)
            ) || matches!(&key.shape, ValueShape::Either(shapes)
                if shapes.iter().all(|s| matches!(s, ValueShape::Table(_)))),
        })
    };
    ids.iter().flat_map(of_table).collect()
}

/// The uses of keys in the text of a scene, in its order; empty if it is not valid TOML.
pub fn key_uses(text: &str) -> Vec<KeyUse> {
    let Ok(root) = toml::from_str::<Table>(text.trim_start_matches('\u{feff}')) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    UseFinder { root: &root }.table(&root, keys::table("scene"), &[], &mut found);
    found
}

fn key_id(table: &TableSchema, key: &KeySchema) -> String {
    format!("{} {}", table.name, key.name)
}

/// Adds a table and those below it, each once.
fn gather_tables(id: &'static str, found: &mut Vec<&'static str>) {
    if found.contains(&id) {
        return;
    }
    found.push(id);
    let table = keys::table(id);
    for key in table.keys.iter().chain(&table.named) {
        tables_of(&key.shape, &mut |id| gather_tables(id, found));
    }
}

fn tables_of(shape: &'static ValueShape, each: &mut dyn FnMut(&'static str)) {
    match shape {
        ValueShape::Table(id) | ValueShape::Tables(id) => each(id),
        ValueShape::Kinds(things) => keys::kind_ids(things).iter().for_each(|id| each(id)),
        ValueShape::Either(shapes) => shapes.iter().for_each(|shape| tables_of(shape, each)),
        _ => {}
    }
}

/// A walk through a scene.
struct UseFinder<'a> {
    root: &'a Table,
}

impl UseFinder<'_> {
    fn table(
        &self,
        table: &Table,
        schema: &'static TableSchema,
        path: &[PathStep],
        found: &mut Vec<KeyUse>,
    ) {
        for (name, value) in table {
            let described = schema.keys.iter().find(|key| key.name == *name);
            let Some(key) = described.or(schema.named.as_ref()) else {
                continue;
            };
            let mut path = path.to_vec();
            path.push(PathStep::Key(name.clone()));
            found.push(KeyUse {
                key: key_id(schema, key),
                path: path.clone(),
                written: written_as(&key.shape, value),
            });
            self.inside(value, &key.shape, &path, found);
        }
    }

    /// The keys inside a value.
    fn inside(
        &self,
        value: &Value,
        shape: &'static ValueShape,
        path: &[PathStep],
        found: &mut Vec<KeyUse>,
    ) {
        match (value, shape) {
            (Value::Table(table), shape) => {
                if let Some(schema) = self.schema_of(table, shape, path) {
                    self.table(table, schema, path, found);
                }
            }
            (Value::Array(values), ValueShape::Tables(id)) => {
                for (k, value) in values.iter().enumerate() {
                    if let Value::Table(table) = value {
                        let path = [path, &[PathStep::Index(k)]].concat();
                        self.table(table, keys::table(id), &path, found);
                    }
                }
            }
            _ => {}
        }
    }

    /// The description of a table of this shape.
    fn schema_of(
        &self,
        table: &Table,
        shape: &'static ValueShape,
        path: &[PathStep],
    ) -> Option<&'static TableSchema> {
        match shape {
            ValueShape::Table(id) => Some(keys::table(id)),
            ValueShape::Kinds(things) => keys::kinds(things).into_iter().find(|kind| {
                let key = kind.keys.first();
                key.is_some_and(|key| table.contains_key(&key.name))
            }),
            ValueShape::Either(shapes) => {
                let mut all = shapes
                    .iter()
                    .filter_map(|shape| self.schema_of(table, shape, path));
                let first = all.next();
                // Friction has two tables: that of a pin, and that of a guide.
                match all.next() {
                    Some(second) if !self.is_revolute(path) => Some(second),
                    _ => first,
                }
            }
            _ => None,
        }
    }

    /// Whether the last name of a path is that of a revolute joint, or of a pin of several bodies.
    fn is_revolute(&self, path: &[PathStep]) -> bool {
        let Some(PathStep::Key(name)) = path.last() else {
            return false;
        };
        let joint = self.root.get("joints").and_then(|joints| joints.get(name));
        joint.is_none_or(|joint| joint.get("revolute").is_some())
    }
}

/// How a value of this shape is written.
fn written_as(shape: &'static ValueShape, value: &Value) -> WrittenAs {
    match shape {
        ValueShape::Text => WrittenAs::Text,
        ValueShape::Number => WrittenAs::Number,
        ValueShape::Boolean => WrittenAs::Boolean,
        ValueShape::Count => WrittenAs::Count,
        ValueShape::Word(words) => WrittenAs::Word(words),
        ValueShape::Expression => WrittenAs::Expression,
        ValueShape::Pair => WrittenAs::Pair,
        ValueShape::TwoPairs | ValueShape::Rows | ValueShape::TwoTriples => WrittenAs::Rows,
        ValueShape::Triple | ValueShape::Tensor => WrittenAs::Numbers,
        ValueShape::Numbers => WrittenAs::Numbers,
        ValueShape::Name(sort) => WrittenAs::Name(sort),
        ValueShape::TwoNames(sort) | ValueShape::Names(_, sort) => WrittenAs::Names(sort),
        ValueShape::Table(_) | ValueShape::Tables(_) | ValueShape::Kinds(_) => WrittenAs::Table,
        ValueShape::Either(shapes) => {
            let fits = |shape: &&ValueShape| {
                matches!(
                    (shape, value),
                    (ValueShape::Number, Value::Integer(_) | Value::Float(_))
                        | (
                            ValueShape::Expression | ValueShape::Name(_),
                            Value::String(_)
                        )
                        | (ValueShape::Table(_), Value::Table(_))
                        | (ValueShape::Pair | ValueShape::TwoNames(_), Value::Array(_))
                )
            };
            let found = shapes.iter().find(fits);
            found.map_or(WrittenAs::Table, |shape| written_as(shape, value))
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn every_key_has_an_id_of_its_own() {
        let mut ids: Vec<_> = scene_keys().into_iter().map(|key| key.id).collect();
        let count = ids.len();
        ids.sort();
        ids.dedup();
        assert_eq!(ids.len(), count);
        assert!(
            count > 150 && ids.iter().any(|id| id == "spring stiffness"),
            "{ids:?}"
        );
    }

    #[test]
    fn the_uses_of_a_scene_lead_to_its_values() {
        let text = "[joints]\nA = { revolute = [\"ground.A\", \"bar.A\"] }\nG = { prismatic = [\"bar.A\", \"box.B\"], axis = [1, 0] }\n\
                    [friction]\nA = { coefficient = 0.1, radius = 5 }\nG = { coefficient = 0.2 }\n\
                    [loads]\nf = { spring = [\"a.b\", \"c.d\"], stiffness = \"2*t\", free-length = 1 }\n[requests]\nsections = [{ body = \"bar\" }]";
        let uses = key_uses(text);
        let of = |id: &str| uses.iter().filter(|u| u.key == id).collect::<Vec<_>>();
        assert_eq!(of("[friction.<pin>] coefficient").len(), 1);
        assert_eq!(of("[friction.<slide>] coefficient").len(), 1);
        assert_eq!(of("spring stiffness")[0].written, WrittenAs::Expression);
        assert_eq!(of("spring free-length").len(), 1);
        let body = of("sections body");
        assert_eq!(body[0].path[2], PathStep::Index(0));
    }
}
