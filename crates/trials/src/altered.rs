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
    let mut whole = Value::Table(root.clone());
    let Some(value) = at(&mut whole, &key_use.path).cloned() else {
        return Vec::new();
    };
    let values = other_values(root, &value, key_use.written).into_iter();
    let mut texts = Vec::new();
    for (value, what) in values.filter_map(|(value, what)| Some((value?, what))) {
        let mut altered = whole.clone();
        if let Some(place) = at(&mut altered, &key_use.path) {
            *place = value;
        }
        let text = toml::to_string(&altered);
        texts.extend(text.map(|text| AlteredText { text, what }));
    }
    if key_use.written != WrittenAs::Text {
        texts.push(AlteredText {
            text: removed(whole, &key_use.path).unwrap_or_default(),
            what: "forgotten".to_owned(),
        });
    }
    texts
}

/// Another value with what it is, in a few words; none where the value is not of the kind.
type OtherValue = (Option<Value>, String);

/// Other values with what they are.
fn named<const N: usize>(values: [(Option<Value>, &str); N]) -> Vec<OtherValue> {
    values.map(|(value, what)| (value, what.to_owned())).into()
}

/// Another word or name.
fn read_as(name: String) -> OtherValue {
    let what = format!("read as `{name}`");
    (Some(Value::String(name)), what)
}

/// The values that another is mistaken for.
fn other_values(root: &Table, value: &Value, written: WrittenAs) -> Vec<OtherValue> {
    let is_other = |name: &String| value.as_str() != Some(name.as_str());
    match written {
        // The unit of inertia is two words of text.
        WrittenAs::Text => other_units(value),
        WrittenAs::Number => named([
            (number(value, PART), "1 % more"),
            // Wheels that no longer fit by so much are refused.
            (number(value, SMALL_PART), "0.05 % more"),
        ]),
        WrittenAs::Count => named([(number(value, PART), "another number")]),
        WrittenAs::Boolean => {
            let other = value.as_bool().map(|b| Value::Boolean(!b));
            named([(other, "the opposite")])
        }
        WrittenAs::Word(words) => {
            let others = words.iter().filter(|word| is_other(word));
            others.cloned().map(read_as).collect()
        }
        WrittenAs::Expression => {
            let more = value.as_str().map(|text| format!("1.01*({text})"));
            named([(more.map(Value::String), "1 % more")])
        }
        WrittenAs::Pair => named([
            (pair(value, PART), "turned and stretched by 1 %"),
            (pair(value, SMALL_PART), "turned and stretched by 0.05 %"),
        ]),
        WrittenAs::Rows => named([
            (each(value, second_more), "its values 1 % more"),
            (each(value, |row| pair(row, PART)), "its pairs turned"),
        ]),
        WrittenAs::Numbers => {
            let more = each(value, |one| number(one, PART));
            named([(more, "its values 1 % more")])
        }
        WrittenAs::Name(sort) => {
            let others = names(root, sort).into_iter().filter(is_other);
            others.take(MAX_NAMES).map(read_as).collect()
        }
        WrittenAs::Names(sort) => other_lists(root, value, sort),
        WrittenAs::Table => Vec::new(),
    }
}

/// Units of inertia, where a text is one.
fn other_units(value: &Value) -> Vec<OtherValue> {
    let text = value.as_str().unwrap_or_default();
    match text.split(' ').count() == 2 && text.ends_with('2') {
        true => INERTIA_UNITS.map(|unit| read_as(unit.to_owned())).into(),
        false => Vec::new(),
    }
}

/// Lists of names: in reverse order, without the last, with another last.
fn other_lists(root: &Table, value: &Value, sort: &str) -> Vec<OtherValue> {
    let list = value.as_array();
    let reversed = list.map(|names| names.iter().rev().cloned().collect());
    let shorter = list.map(|names| names[..names.len().saturating_sub(1)].to_vec());
    let last_replaced = names(root, sort).into_iter().take(MAX_NAMES).map(|name| {
        let what = format!("the last one read as `{name}`");
        let mut all = list.cloned().unwrap_or_default();
        if let Some(last) = all.last_mut() {
            *last = Value::String(name);
        }
        (Some(Value::Array(all)), what)
    });
    let first = named([
        (reversed.map(Value::Array), "in reverse order"),
        (shorter.map(Value::Array), "the last one forgotten"),
    ]);
    let all = first.into_iter().chain(last_replaced);
    all.filter(|(other, _)| other.as_ref() != Some(value))
        .collect()
}

/// The value at the end of some steps.
fn at<'v>(root: &'v mut Value, path: &[PathStep]) -> Option<&'v mut Value> {
    path.iter().try_fold(root, |value, step| match step {
        PathStep::Key(key) => value.get_mut(key),
        PathStep::Index(k) => value.get_mut(*k),
    })
}

/// The text without the key.
fn removed(mut root: Value, path: &[PathStep]) -> Option<String> {
    let (PathStep::Key(last), steps) = path.split_last()? else {
        return None;
    };
    at(&mut root, steps)?.as_table_mut()?.remove(last)?;
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

/// The numbers of a list of two.
fn two_numbers(value: &Value) -> Option<[f64; 2]> {
    let numbers = value.as_array()?.iter().filter_map(as_number);
    numbers.collect::<Vec<f64>>().try_into().ok()
}

/// A pair of numbers, turned and stretched, so that a direction changes, too.
fn pair(value: &Value, part: f64) -> Option<Value> {
    let [x, y] = two_numbers(value)?;
    let size = match x.hypot(y) {
        0.0 => 1.0,
        size => size,
    };
    let other = [x + part * size, y - 2.0 * part * size];
    Some(Value::Array(other.map(Value::Float).into()))
}

/// A row of two numbers with the second 1 % more.
fn second_more(row: &Value) -> Option<Value> {
    let [x, y] = two_numbers(row)?;
    let y = if y == 0.0 { 0.0 } else { altered(y, PART) };
    Some(Value::Array([x, y].map(Value::Float).into()))
}

/// A list of which every entry is another.
fn each(list: &Value, other: impl Fn(&Value) -> Option<Value>) -> Option<Value> {
    let others = list.as_array()?.iter().map(other);
    others.collect::<Option<_>>().map(Value::Array)
}

/// The names of a sort in a scene.
fn names(root: &Table, sort: &str) -> Vec<String> {
    let keys_of = |table: Option<&Value>| -> Vec<String> {
        let table = table.and_then(Value::as_table);
        table.map_or_else(Vec::new, |table| table.keys().cloned().collect())
    };
    let keys = |section: &str| keys_of(root.get(section));
    let points = || {
        keys("bodies").into_iter().flat_map(|body| {
            let points = keys_of(root["bodies"][&body].get("points"));
            points.into_iter().map(move |point| [body.clone(), point])
        })
    };
    let coordinates = || [keys("coordinates"), keys("actuators")].concat();
    match sort {
        "body" => keys("bodies"),
        "point" => points().map(|[_, point]| point).collect(),
        "body.point" => points().map(|names| names.join(".")).collect(),
        "joint" => keys("joints"),
        "actuator" => keys("actuators"),
        "coordinate" => coordinates(),
        "signal" => {
            let rates = coordinates()
                .into_iter()
                .map(|name| format!("{name}.velocity"));
            [vec!["t".to_owned()], coordinates(), rates.collect()].concat()
        }
        "joint.component" => {
            let parts = [
                "x", "y", "normal", "moment", "tooth", "axial", "tangent", "force",
            ];
            let of_joint = |joint: String| parts.map(|part| format!("{joint}.{part}"));
            keys("joints").into_iter().flat_map(of_joint).collect()
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
