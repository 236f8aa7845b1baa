//! The JSON schema of scenes, from which editors complete keys and show what they mean.

use crate::keys::{KeySchema, Presence, SCENE, TableSchema, ValueShape};
use serde_json::{Map, Value, json};
use toml::de::{DeTable, DeValue};

/// The schema of scenes (JSON schema, draft 7), indented, with a line end. It knows the shape of a
/// scene: keys and the kinds of their values. Whether names exist and numbers make sense is for
/// [`Scene::read`](crate::Scene::read) to say.
pub fn schema() -> String {
    let mut schema = table(&SCENE);
    set(
        &mut schema,
        "$schema",
        "http://json-schema.org/draft-07/schema#",
    );
    set(&mut schema, "title", "Scene of Dwell");
    // The alternate form of `Display` is the indented one.
    format!("{schema:#}\n")
}

fn set(schema: &mut Value, key: &str, value: impl Into<Value>) {
    if let Some(object) = schema.as_object_mut() {
        object.insert(key.to_owned(), value.into());
    }
}

fn table(table: &TableSchema) -> Value {
    let properties: Map<_, _> = table
        .keys
        .iter()
        .map(|k| (k.name.to_owned(), key(k)))
        .collect();
    let mut schema = json!({
        "type": "object",
        "title": table.name,
        "description": table.doc,
        "properties": properties,
        "additionalProperties": table.named.as_ref().map_or(json!(false), key),
    });
    let required = table
        .keys
        .iter()
        .filter(|k| k.presence == Presence::Required);
    let required: Vec<_> = required.map(|k| k.name).collect();
    if !required.is_empty() {
        set(&mut schema, "required", required);
    }
    let choices = choices(table);
    if !choices.is_empty() {
        let each = choices.iter().map(|names| json!({ "required": names }));
        set(&mut schema, "oneOf", each.collect::<Vec<_>>());
    }
    schema
}

/// The sets of keys of a table of which exactly one is needed; no table has two such groups.
fn choices(table: &TableSchema) -> Vec<Vec<&'static str>> {
    let single = table.keys.iter();
    let single = single.filter(|k| matches!(k.presence, Presence::OneOf(_)));
    let mut choices: Vec<_> = single.map(|k| vec![k.name]).collect();
    choices.extend(table.sets());
    choices
}

fn key(key: &KeySchema) -> Value {
    let mut schema = shape(key.shape);
    let mut doc = key.doc.to_owned();
    if !key.unit.is_empty() {
        doc.push_str(&format!(" Unit: {}.", key.unit));
    }
    if let Presence::Default(default) = key.presence {
        doc.push_str(&format!(" Absent: {default}."));
    }
    set(&mut schema, "description", doc);
    if let Some(example) = example(key.example) {
        set(&mut schema, "examples", vec![example]);
    }
    schema
}

fn shape(shape: ValueShape) -> Value {
    let number = json!({ "type": "number" });
    let string = |what: &str| json!({ "type": "string", "title": what });
    let list = |item: Value, min_items: usize| json!({ "type": "array", "items": item, "minItems": min_items });
    let two = |item: Value| json!({ "type": "array", "items": item, "minItems": 2, "maxItems": 2 });
    match shape {
        ValueShape::Text => string("text"),
        ValueShape::Expression => string("expression"),
        ValueShape::Name(what) => string(what),
        ValueShape::Number => number,
        ValueShape::Boolean => json!({ "type": "boolean" }),
        ValueShape::Count => json!({ "type": "integer", "minimum": 2, "maximum": 1_000_000 }),
        ValueShape::Word(words) => json!({ "enum": words }),
        ValueShape::Pair => two(number),
        ValueShape::TwoPairs => two(two(number)),
        ValueShape::Rows => list(two(number), 2),
        ValueShape::TwoNames(what) => two(string(what)),
        ValueShape::Names(what, min_items) => list(string(what), min_items),
        ValueShape::Table(inner) => table(inner),
        ValueShape::Tables(inner) => list(table(inner), 0),
        ValueShape::Kinds(kinds) => {
            let kinds: Vec<_> = kinds.iter().map(|t| table(t)).collect();
            json!({ "oneOf": kinds })
        }
        ValueShape::Either(shapes) => {
            let shapes: Vec<_> = shapes.iter().map(|s| self::shape(*s)).collect();
            json!({ "anyOf": shapes })
        }
    }
}

/// The example as JSON.
fn example(text: &str) -> Option<Value> {
    let text = format!("x = {text}");
    let table = DeTable::parse(&text).ok()?;
    table.get_ref().get("x").map(|x| as_json(x.get_ref()))
}

/// A value of TOML as JSON. Dates, which no scene has, become strings.
pub(crate) fn as_json(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => json!(text),
        DeValue::Integer(i) => i.as_str().parse::<i64>().map_or(Value::Null, |i| json!(i)),
        DeValue::Float(x) => x.as_str().parse::<f64>().map_or(Value::Null, |x| json!(x)),
        DeValue::Boolean(b) => json!(b),
        DeValue::Datetime(d) => json!(d.to_string()),
        DeValue::Array(values) => values.iter().map(|v| as_json(v.get_ref())).collect(),
        DeValue::Table(table) => {
            let entries = table
                .iter()
                .map(|(k, v)| (k.get_ref().to_string(), as_json(v.get_ref())));
            Value::Object(entries.collect())
        }
    }
}
