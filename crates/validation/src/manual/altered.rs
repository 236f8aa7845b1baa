//! A value of a scene, altered: a fault between the text and what is computed from it.

use dwell_scene::{KeyUse, PathStep, WrittenAs};
use toml::{Table, Value};

/// The part by which numbers are altered.
const PART: f64 = 0.01;
const SMALL_PART: f64 = 0.0005;
/// Units of inertia that another is mistaken for.
const INERTIA_UNITS: [&str; 2] = ["kg mm2", "kg m2"];
/// At most so many other names are tried.
const MAX_NAMES: usize = 40;

/// A text of a scene in which one value is another.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AlteredText {
    /// The scene.
    pub(super) text: String,
    /// What was altered, in a few words.
    pub(super) what: String,
}

/// The texts in which the value at a use of a key is another one, the likeliest to be a scene first; none for words that only
/// readers see.
pub(super) fn altered_texts(root: &Table, key_use: &KeyUse) -> Vec<AlteredText> {
    let Some(value) = find(root, &key_use.path) else {
        return Vec::new();
    };
    let values = other_values(root, value, key_use.written);
    let with = |(value, what): (Option<Value>, String)| {
        let text = replaced(root, &key_use.path, value?)?;
        Some(AlteredText { text, what })
    };
    let forgotten = AlteredText {
        text: removed(root, &key_use.path).unwrap_or_default(),
        what: "forgotten".to_owned(),
    };
    let all = values.into_iter().filter_map(with);
    all.chain((key_use.written != WrittenAs::Text).then_some(forgotten))
        .collect()
}

/// Another value with what it is, in a few words; none where the value is not of the kind.
type OtherValue = (Option<Value>, String);

/// The values that another is mistaken for.
fn other_values(root: &Table, value: &Value, written: WrittenAs) -> Vec<OtherValue> {
    match written {
        // The unit of inertia is two words of text.
        WrittenAs::Text => other_units(value),
        WrittenAs::Number => vec![
            (number(value, PART), "1 % more".to_owned()),
            // Wheels that no longer fit by so much are refused.
            (number(value, SMALL_PART), "0.05 % more".to_owned()),
        ],
        WrittenAs::Count => vec![(number(value, PART), "another number".to_owned())],
        WrittenAs::Boolean => {
            let other = value.as_bool().map(|b| Value::Boolean(!b));
            vec![(other, "the opposite".to_owned())]
        }
        WrittenAs::Word(words) => {
            let others = words.iter().filter(|word| value.as_str() != Some(word));
            let other = |word: &String| {
                (
                    Some(Value::String(word.clone())),
                    format!("read as `{word}`"),
                )
            };
            others.map(other).collect()
        }
        WrittenAs::Expression => {
            let more = value
                .as_str()
                .map(|text| Value::String(format!("1.01*({text})")));
            vec![(more, "1 % more".to_owned())]
        }
        WrittenAs::Pair => vec![
            (pair(value, PART), "turned and stretched by 1 %".to_owned()),
            (
                pair(value, SMALL_PART),
                "turned and stretched by 0.05 %".to_owned(),
            ),
        ],
        WrittenAs::Rows => vec![
            (rows(value), "its values 1 % more".to_owned()),
            (turned_rows(value), "its pairs turned".to_owned()),
        ],
        WrittenAs::Numbers => vec![(numbers(value), "its values 1 % more".to_owned())],
        WrittenAs::Name(sort) => {
            let names = names(root, sort);
            let others = names
                .into_iter()
                .filter(|name| value.as_str() != Some(name));
            let other = |name: String| {
                (
                    Some(Value::String(name.clone())),
                    format!("read as `{name}`"),
                )
            };
            others.take(MAX_NAMES).map(other).collect()
        }
        WrittenAs::Names(sort) => other_lists(root, value, sort),
        WrittenAs::Table => Vec::new(),
    }
}

/// Units of inertia, where a text is one.
fn other_units(value: &Value) -> Vec<OtherValue> {
    let units = INERTIA_UNITS.iter().filter(|_| {
        let text = value.as_str().unwrap_or_default();
        text.split(' ').count() == 2 && text.ends_with('2')
    });
    let other = |unit: &&str| {
        (
            Some(Value::String((*unit).to_owned())),
            format!("read as `{unit}`"),
        )
    };
    units.map(other).collect()
}

/// Lists of names: in reverse order, without the last, with another last.
fn other_lists(root: &Table, value: &Value, sort: &str) -> Vec<OtherValue> {
    let reversed = value.as_array().map(|names| {
        let reversed = names.iter().rev();
        Value::Array(reversed.cloned().collect())
    });
    let shorter = value.as_array().map(|names| {
        let first = names.iter().take(names.len().saturating_sub(1));
        Value::Array(first.cloned().collect())
    });
    let last_replaced = names(root, sort).into_iter().take(MAX_NAMES).map(|name| {
        let mut all = value.as_array().cloned().unwrap_or_default();
        if let Some(last) = all.last_mut() {
            *last = Value::String(name.clone());
        }
        (
            Some(Value::Array(all)),
            format!("the last one read as `{name}`"),
        )
    });
    let first = [
        (reversed, "in reverse order".to_owned()),
        (shorter, "the last one forgotten".to_owned()),
    ];
    let all = first.into_iter().chain(last_replaced);
    all.filter(|(other, _)| other.as_ref() != Some(value))
        .collect()
}

/// The value at the end of some steps.
fn find<'v>(root: &'v Table, path: &[PathStep]) -> Option<&'v Value> {
    let (first, rest) = path.split_first()?;
    let PathStep::Key(first) = first else {
        return None;
    };
    rest.iter()
        .try_fold(root.get(first)?, |value, step| match step {
            PathStep::Key(key) => value.get(key),
            PathStep::Index(k) => value.get(*k),
        })
}

/// The text with another value there.
fn replaced(root: &Table, path: &[PathStep], value: Value) -> Option<String> {
    let mut root = Value::Table(root.clone());
    let mut at = &mut root;
    for step in path {
        at = match step {
            PathStep::Key(key) => at.get_mut(key)?,
            PathStep::Index(k) => at.get_mut(*k)?,
        };
    }
    *at = value;
    toml::to_string(&root).ok()
}

/// The text without the key.
fn removed(root: &Table, path: &[PathStep]) -> Option<String> {
    let (last, steps) = path.split_last()?;
    let mut root = Value::Table(root.clone());
    let mut at = &mut root;
    for step in steps {
        at = match step {
            PathStep::Key(key) => at.get_mut(key)?,
            PathStep::Index(k) => at.get_mut(*k)?,
        };
    }
    let PathStep::Key(last) = last else {
        return None;
    };
    at.as_table_mut()?.remove(last)?;
    toml::to_string(&root).ok()
}

fn as_number(value: &Value) -> Option<f64> {
    value.as_float().or(value.as_integer().map(|i| i as f64))
}

/// A part more, or that part in place of zero.
fn number(value: &Value, part: f64) -> Option<Value> {
    if let Some(count) = value.as_integer().filter(|count| *count > 1) {
        // A count stays whole; where a number is meant it is another one, too.
        let other = count as f64 * (1.0 + part);
        return Some(match other.fract() == 0.0 {
            true => Value::Integer(other as i64),
            false => Value::Float(other),
        });
    }
    Some(Value::Float(altered(as_number(value)?, part)))
}

fn altered(value: f64, part: f64) -> f64 {
    match value {
        0.0 => part,
        value => value * (1.0 + part),
    }
}

/// A pair of numbers, turned and stretched, so that a direction changes, too.
fn pair(value: &Value, part: f64) -> Option<Value> {
    let pair: Vec<f64> = value.as_array()?.iter().filter_map(as_number).collect();
    let [x, y] = *pair else { return None };
    let size = match x.hypot(y) {
        0.0 => 1.0,
        size => size,
    };
    let other = [x + part * size, y - 2.0 * part * size];
    Some(Value::Array(other.map(Value::Float).to_vec()))
}

/// A list of numbers, each 1 % more.
fn numbers(value: &Value) -> Option<Value> {
    let all = value.as_array()?.iter();
    let all: Option<Vec<Value>> = all.map(|one| number(one, PART)).collect();
    all.map(Value::Array)
}

/// Rows of two numbers with the second a part more; of a pair of directions each turned.
fn rows(value: &Value) -> Option<Value> {
    let rows = value.as_array()?;
    let other = |row: &Value| {
        let row: Vec<f64> = row.as_array()?.iter().filter_map(as_number).collect();
        let [x, y] = *row else { return None };
        let y = if y == 0.0 { 0.0 } else { altered(y, PART) };
        Some(Value::Array(vec![Value::Float(x), Value::Float(y)]))
    };
    let other: Option<Vec<Value>> = rows.iter().map(other).collect();
    other.map(Value::Array)
}

/// Pairs, each turned.
fn turned_rows(value: &Value) -> Option<Value> {
    let turned: Option<Vec<Value>> = value
        .as_array()?
        .iter()
        .map(|row| pair(row, PART))
        .collect();
    turned.map(Value::Array)
}

/// The names of a sort in a scene.
fn names(root: &Table, sort: &str) -> Vec<String> {
    let keys = |section: &str| -> Vec<String> {
        let table = root.get(section).and_then(Value::as_table);
        table.map_or_else(Vec::new, |table| table.keys().cloned().collect())
    };
    let points = || {
        let bodies = keys("bodies").into_iter();
        bodies.flat_map(|body| {
            let points = root["bodies"][&body]
                .get("points")
                .and_then(Value::as_table);
            let names = points.map_or_else(Vec::new, |points| points.keys().cloned().collect());
            names
                .into_iter()
                .map(move |point: String| [body.clone(), point])
        })
    };
    match sort {
        "body" => keys("bodies"),
        "point" => points().map(|[_, point]| point).collect(),
        "body.point" => points().map(|names| names.join(".")).collect(),
        "joint" => keys("joints"),
        "actuator" => keys("actuators"),
        "coordinate" => [keys("coordinates"), keys("actuators")].concat(),
        "signal" => {
            let coordinates = [keys("coordinates"), keys("actuators")].concat();
            let rates = coordinates.iter().map(|name| format!("{name}.velocity"));
            let rates: Vec<String> = rates.collect();
            [vec!["t".to_owned()], coordinates, rates].concat()
        }
        "joint.component" => {
            let joints = keys("joints").into_iter();
            let parts = [
                "x", "y", "normal", "moment", "tooth", "axial", "tangent", "force",
            ];
            joints
                .flat_map(|joint| parts.map(|part| format!("{joint}.{part}")))
                .collect()
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use dwell_scene::key_uses;

    #[test]
    fn every_value_of_a_scene_becomes_another_one() {
        let text = "title = \"a\"\n[units]\nlength = \"mm\"\n[bodies.bar]\npoints = { A = [0, 0], B = [3, 4] }\nmass = 2\n\
                    [loads]\nf = { force = \"bar.A\", direction = [0, 1], magnitude = \"2*t\" }";
        let root: Table = toml::from_str(text).unwrap();
        let of = |id: &str| {
            let uses = key_uses(text);
            altered_texts(&root, uses.iter().find(|u| u.key == id).unwrap())
        };
        assert!(of("[bodies.<body>] mass")[0].text.contains("2.02"));
        assert!(of("force magnitude")[0].text.contains("1.01*(2*t)"));
        assert!(of("force force")[0].text.contains("bar.B"));
        assert!(of("[units] length").len() > 3);
        assert!(of("the scene title").is_empty());
        // Forgotten is a fault of everything else.
        assert!(!of("[bodies.<body>] mass")[2].text.contains("mass"));
    }
}
