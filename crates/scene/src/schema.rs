//! The JSON schema of scenes, with which editors complete and explain keys.

use crate::keys::{self, KeySchema, Presence, TableSchema, ValueShape, kinds};
use serde_json::{Map, Value, json};
use toml::de::{DeTable, DeValue};

/// The schema of scenes (JSON schema, draft 7), indented, with a line end. It describes the shape of a scene: keys and
/// the kinds of their values. [`PlaneScene::read`](crate::PlaneScene::read) checks names and numbers.
pub fn schema() -> String {
    let scenes = ["scene", "scene-in-space"].map(|id| table(keys::table(id)));
    let schema = json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Scene of Dwell",
        "anyOf": scenes,
    });
    // The alternate form of `Display` is the indented one.
    format!("{schema:#}\n")
}

fn table(table: &TableSchema) -> Value {
    let properties = table.keys.iter().map(|k| (k.name.clone(), key(k)));
    let properties: Map<_, _> = properties.collect();
    let mut schema = json!({
        "type": "object",
        "title": table.name,
        "description": table.doc,
        "properties": properties,
        "additionalProperties": table.named.as_ref().map_or(json!(false), key),
    });
    let required = table.keys.iter().filter(|k| k.presence.is_none());
    let required: Vec<_> = required.map(|k| k.name.as_str()).collect();
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    // The sets of keys of which exactly one is needed.
    let single = table.alternatives().into_iter().map(|name| vec![name]);
    let choices: Vec<_> = single.chain(table.sets()).collect();
    if !choices.is_empty() {
        let each = choices.iter().map(|names| json!({ "required": names }));
        schema["oneOf"] = each.collect();
    }
    schema
}

fn key(key: &KeySchema) -> Value {
    let mut schema = shape(&key.shape);
    let mut doc = key.doc.clone();
    if !key.unit.is_empty() {
        doc.push_str(&format!(" Unit: {}.", key.unit));
    }
    if let Some(Presence::Absent(default)) = &key.presence {
        doc.push_str(&format!(" Absent: {default}."));
    }
    schema["description"] = json!(doc);
    if let Some(example) = example(&key.example) {
        schema["examples"] = json!([example]);
    }
    schema
}

fn shape(shape: &ValueShape) -> Value {
    let number = &json!({ "type": "number" });
    let string = |what: &str| json!({ "type": "string", "title": what });
    let list = |item: Value, min_items: usize| json!({ "type": "array", "items": item, "minItems": min_items });
    let two = |item: Value| json!({ "type": "array", "items": item, "minItems": 2, "maxItems": 2 });
    let numbers = |min: usize, max: usize| json!({ "type": "array", "items": number, "minItems": min, "maxItems": max });
    match shape {
        ValueShape::Text => string("text"),
        ValueShape::Expression => string("expression"),
        ValueShape::Name(what) => string(what),
        ValueShape::Number => number.clone(),
        ValueShape::Boolean => json!({ "type": "boolean" }),
        ValueShape::Count => json!({ "type": "integer", "minimum": 2, "maximum": 1_000_000 }),
        ValueShape::Word(words) => json!({ "enum": words }),
        ValueShape::Pair => numbers(2, 2),
        ValueShape::TwoPairs => two(numbers(2, 2)),
        ValueShape::Triple => numbers(3, 3),
        ValueShape::TwoTriples => two(numbers(3, 3)),
        ValueShape::Tensor => json!({ "anyOf": [numbers(3, 3), numbers(6, 6)] }),
        ValueShape::Rows => list(numbers(2, 2), 2),
        ValueShape::Numbers => list(number.clone(), 4),
        ValueShape::TwoNames(what) => two(string(what)),
        ValueShape::Names(min_items, what) => list(string(what), *min_items),
        ValueShape::Table(id) => table(keys::table(id)),
        ValueShape::Tables(id) => list(table(keys::table(id)), 0),
        ValueShape::Kinds(things) => {
            let kinds: Vec<_> = kinds(things).into_iter().map(table).collect();
            json!({ "oneOf": kinds })
        }
        ValueShape::Either(shapes) => {
            let shapes: Vec<_> = shapes.iter().map(self::shape).collect();
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
            let entries = table.iter();
            let entries = entries.map(|(k, v)| (k.get_ref().to_string(), as_json(v.get_ref())));
            Value::Object(entries.collect())
        }
    }
}
