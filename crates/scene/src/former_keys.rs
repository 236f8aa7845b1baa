//! Former names of keys. They are still read: before anything else looks at the TOML tree, each is replaced by the key's current
//! name, and a warning names that. The new entry keeps the span of the old one, so that messages point at what is written.

use crate::diagnostics::Diagnostics;
use crate::keys::{self, KeySchema, TableSchema, ValueShape, kinds};
use std::borrow::Cow;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Replaces the former names among the keys of `table` and of all tables below it. Names of the scene's own stay as they are.
pub(crate) fn rename_former_keys(
    table: &mut DeTable<'_>,
    schema: &'static TableSchema,
    log: &Diagnostics,
) {
    for key in &schema.keys {
        rename(table, key, log);
    }
    for (name, value) in table.iter_mut() {
        if let Some(key) = schema.key(name.get_ref()) {
            rename_in_value(value, &key.shape, log);
        }
    }
}

fn rename_in_value(
    value: &mut Spanned<DeValue<'_>>,
    shape: &'static ValueShape,
    log: &Diagnostics,
) {
    match (value.get_mut(), shape) {
        (DeValue::Table(table), shape) => {
            if let ValueShape::Kinds(things) = shape {
                for key in kinds(things).iter().filter_map(|kind| kind.keys.first()) {
                    rename(table, key, log);
                }
            }
            for schema in schemas_of(table, shape) {
                rename_former_keys(table, schema, log);
            }
        }
        (DeValue::Array(values), ValueShape::Tables(id)) => {
            for value in values.iter_mut() {
                if let DeValue::Table(inner) = value.get_mut() {
                    rename_former_keys(inner, keys::table(id), log);
                }
            }
        }
        _ => {}
    }
}

/// The schemas that describe the keys of `table`, which is a value of this shape. A table of one of several kinds has that of its
/// kind; current names of the kinds only.
pub(crate) fn schemas_of(
    table: &DeTable<'_>,
    shape: &'static ValueShape,
) -> Vec<&'static TableSchema> {
    match shape {
        ValueShape::Table(id) => vec![keys::table(id)],
        ValueShape::Kinds(things) => {
            let mut kinds = kinds(things);
            kinds.retain(|kind| table.contains_key(kind.kind_key()));
            kinds
        }
        ValueShape::Either(shapes) => {
            let each = shapes.iter().flat_map(|shape| schemas_of(table, shape));
            each.collect()
        }
        _ => Vec::new(),
    }
}

fn rename(table: &mut DeTable<'_>, key: &'static KeySchema, log: &Diagnostics) {
    let Some(former) = &key.former else { return };
    let Some((written, value)) = table.remove_entry(former.as_str()) else {
        return;
    };
    let (name, span) = (key.name.as_str(), written.span());
    if let Some((current, _)) = table.get_key_value(name) {
        let message = format!("both `{former}` and `{name}` are given");
        let current = (&current.span(), "the current name of the same key");
        let help = format!("keep `{name}` and delete `{former}`");
        return log.report(message, &[(&span, "the former name"), current], help);
    }
    log.warn_renamed(former, name, span.clone());
    table.insert(Spanned::new(span, Cow::Borrowed(name)), value);
}
