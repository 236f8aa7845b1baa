//! The description of the keys, and its products, the schema and the documentation, compared with the behaviour of the
//! reader.

use super::*;
use crate::keys::{self, KeySchema, Presence, TableSchema, ValueShape, kinds};
use crate::schema::{as_json, schema};
use serde_json::Value;
use std::fmt::Write as _;

const PAGE: &str = include_str!("../../../../docs/scene-format.md");

/// Every table that the keys of a scene, in the plane or in space, lead to, each once.
pub(super) fn tables(scene: &'static str) -> Vec<&'static TableSchema> {
    fn follow(shape: &'static ValueShape, found: &mut Vec<&'static TableSchema>) {
        match shape {
            ValueShape::Table(id) | ValueShape::Tables(id) => visit(keys::table(id), found),
            ValueShape::Kinds(things) => kinds(things).into_iter().for_each(|t| visit(t, found)),
            ValueShape::Either(shapes) => shapes.iter().for_each(|shape| follow(shape, found)),
            _ => {}
        }
    }
    fn visit(table: &'static TableSchema, found: &mut Vec<&'static TableSchema>) {
        if found.iter().any(|t| std::ptr::eq(*t, table)) {
            return;
        }
        found.push(table);
        for key in table.keys.iter().chain(&table.named) {
            follow(&key.shape, found);
        }
    }
    let mut found = Vec::new();
    visit(keys::table(scene), &mut found);
    found
}

/// How the value of a key is written, for a reader.
fn value(shape: &ValueShape) -> String {
    match shape {
        ValueShape::Text => "text".to_owned(),
        ValueShape::Number => "number".to_owned(),
        ValueShape::Boolean => "`true` or `false`".to_owned(),
        ValueShape::Count => "whole number from 2".to_owned(),
        ValueShape::Word(words) => {
            let words: Vec<_> = words.iter().map(|w| format!("`\"{w}\"`")).collect();
            words.join(", ")
        }
        ValueShape::Expression => "expression".to_owned(),
        ValueShape::Pair => "two numbers".to_owned(),
        ValueShape::TwoPairs => "two pairs of numbers".to_owned(),
        ValueShape::Triple => "three numbers".to_owned(),
        ValueShape::TwoTriples => "two times three numbers".to_owned(),
        ValueShape::Tensor => "three or six numbers".to_owned(),
        ValueShape::Rows => "two or more pairs of numbers".to_owned(),
        ValueShape::Numbers => "four or more numbers".to_owned(),
        ValueShape::Name(what) => what.clone(),
        ValueShape::TwoNames(what) => format!("two of {what}"),
        ValueShape::Names(0, what) => format!("list of {what}"),
        ValueShape::Names(min, what) => format!("{min} or more of {what}"),
        ValueShape::Table(_) => "table".to_owned(),
        ValueShape::Tables(_) => "list of tables".to_owned(),
        ValueShape::Kinds(things) => {
            let kinds = kinds(things).into_iter();
            let kinds: Vec<_> = kinds.map(|t| format!("`{}`", t.name)).collect();
            format!("table of a kind: {}", kinds.join(", "))
        }
        ValueShape::Either(shapes) => {
            let mut shapes: Vec<_> = shapes.iter().map(value).collect();
            shapes.dedup();
            shapes.join(", or ")
        }
    }
}

/// When a key of a set may be absent.
fn instead_of(table: &TableSchema, key: &KeySchema) -> String {
    let sets = table.sets();
    let others = sets.iter().filter(|set| !set.contains(&key.name.as_str()));
    let others: Vec<_> = others.flatten().map(|name| format!("`{name}`")).collect();
    format!("needed, or else {}", others.join(", "))
}

/// The keys of a table as Markdown.
fn markdown(table: &TableSchema) -> String {
    let mut text = format!("**`{}`** {}\n\n", table.name, table.doc);
    text.push_str(
        "| key | value | unit | if absent | meaning | example |\n|---|---|---|---|---|---|\n",
    );
    for key in table.keys.iter().chain(&table.named) {
        let absent = match &key.presence {
            None if key.name.starts_with('<') => "",
            None => "needed",
            Some(Presence::OneOf(_)) => "one of these is needed",
            Some(Presence::Set(_)) => &instead_of(table, key),
            Some(Presence::Absent(default)) => default,
        };
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {absent} | {} | `{}` |",
            key.name,
            value(&key.shape),
            key.unit,
            key.doc,
            key.example
        );
    }
    text
}

#[test]
fn the_page_shows_every_table_as_the_reader_knows_it() {
    let mut tables = tables("scene");
    let in_space = self::tables("scene-in-space").into_iter();
    tables.extend(in_space.filter(|t| t.name != "[units]"));
    let mut page = String::new();
    let mut listed = Vec::new();
    let mut rest = PAGE;
    while let Some((before, after)) = rest.split_once("<!-- keys: ") {
        let (name, after) = after.split_once(" -->").unwrap();
        let (_, after) = after.split_once("<!-- /keys -->").unwrap();
        let table = tables.iter().find(|t| t.name == name);
        let table = table.unwrap_or_else(|| panic!("there is no table `{name}`"));
        let _ = write!(
            page,
            "{before}<!-- keys: {name} -->\n{}<!-- /keys -->",
            markdown(table)
        );
        listed.push(name);
        rest = after;
    }
    page.push_str(rest);
    for table in &tables {
        let times = listed.iter().filter(|name| **name == table.name).count();
        assert_eq!(times, 1, "`{}` on the page", table.name);
    }
    same_as_written("../../docs/scene-format.md", &page);
}

#[test]
fn the_schema_is_written_down() {
    same_as_written("../../docs/scene-schema.json", &schema());
}

/// The examples of the page: the first is a scene, the others are fragments of it.
fn examples() -> Vec<String> {
    let blocks = PAGE.split("```toml\n").skip(1);
    let blocks: Vec<_> = blocks.map(|b| b.split_once("```").unwrap().0).collect();
    let whole = blocks[0];
    let mut scenes = vec![whole.to_owned()];
    scenes.extend(blocks[1..].iter().map(|fragment| merged(whole, fragment)));
    scenes
}

/// The scene with what the fragment says: a body gets what is said of it, another entry of a
/// section is replaced, and so is the whole of a motion. A fragment that has actuators of its own has no more use for the sections
/// that speak of the others.
pub(super) fn merged(scene: &str, fragment: &str) -> String {
    let mut scene: toml::Table = scene.parse().unwrap();
    let fragment: toml::Table = fragment
        .parse()
        .unwrap_or_else(|e| panic!("{fragment}\n{e}"));
    if fragment.contains_key("actuators") {
        for section in ["actuators", "assembly", "motion", "loads"] {
            scene.remove(section);
        }
    }
    for (section, value) in fragment {
        let toml::Value::Table(entries) = value else {
            scene.insert(section, value);
            continue;
        };
        if section == "motion" {
            scene.insert(section, entries.into());
            continue;
        }
        let is_bodies = section == "bodies";
        let old = scene.entry(&section).or_insert(toml::Table::new().into());
        let old = old.as_table_mut().unwrap();
        for (name, entry) in entries {
            match (old.get_mut(&name), entry) {
                (Some(toml::Value::Table(body)), toml::Value::Table(new)) if is_bodies => {
                    body.extend(new);
                }
                (_, entry) => {
                    old.insert(name, entry);
                }
            }
        }
    }
    scene.to_string()
}

#[test]
fn every_example_of_the_page_is_read() {
    let examples = examples();
    assert!(examples.len() >= 8);
    for text in examples {
        if let Err(error) = parse(&text) {
            panic!("{text}\n{}", render(&error));
        }
    }
}

/// Tables with the example of each key, in turn, and what else it needs, as inline tables.
pub(super) fn tables_of_examples(table: &TableSchema) -> Vec<(String, String)> {
    let written = |key: &KeySchema| format!("{} = {}", key.name, key.example);
    let one = |wanted: &KeySchema| {
        let mut parts: Vec<_> = table
            .keys
            .iter()
            .filter(|k| k.presence.is_none() && k.name != wanted.name)
            .map(written)
            .collect();
        let alternative = table.keys.iter().find(|k| k.is_one_of());
        match (wanted.is_one_of(), alternative) {
            (true, _) => {}
            // Numbers of dry friction make sense together.
            _ if table.name.starts_with("[friction.") => {
                let others = table.keys.iter();
                let others = others.filter(|k| k.name != wanted.name && k.presence.is_some());
                parts.extend(others.map(written));
            }
            // An end stop has a limit, and its damper a spring.
            _ if table.name.starts_with("[stops.") => {
                let needed = |key: &&KeySchema| match key.name.as_str() {
                    "min" => wanted.name != "min",
                    "stiffness" => wanted.name == "damping",
                    _ => false,
                };
                parts.extend(table.keys.iter().filter(needed).map(written));
            }
            (_, None) => {
                let sets = table.sets();
                let containing = sets.iter().find(|set| set.contains(&wanted.name.as_str()));
                let set = containing.or(sets.first()).into_iter().flatten();
                let keys = set.filter_map(|name| table.keys.iter().find(|k| k.name == **name));
                parts.extend(keys.filter(|k| k.name != wanted.name).map(written));
            }
            // A start is that of a sine or a rise.
            _ if wanted.name == "start" && table.name == "coupling" => {
                let rise = table.keys.iter().find(|k| k.name == "cycloidal");
                parts.extend(rise.map(written));
            }
            // Only a table is interpolated.
            _ if wanted.name == "interpolation" => {
                let rows = table.keys.iter().find(|k| k.name == "table");
                parts.extend(rows.map(written));
            }
            (_, Some(key)) => parts.push(written(key)),
        }
        parts.push(written(wanted));
        (wanted.name.clone(), format!("{{ {} }}", parts.join(", ")))
    };
    let keys = table.keys.iter().filter(|k| !k.name.starts_with('<'));
    keys.map(one).collect()
}

#[test]
fn every_example_of_a_key_is_read() {
    let scene = &examples()[0];
    let around = |table: &TableSchema, inner: &str| -> Option<String> {
        let law = "cycloidal = { rise = 1.0, duration = 0.5 }";
        Some(match table.name.as_str() {
            "[bodies.<body>]" => format!("bodies.crank = {inner}"),
            "[bodies.<body>.varying-inertia]" => format!("bodies.crank.varying-inertia = {inner}"),
            "<reaction>" => format!(
                "bodies.crank.varying-inertia = {{ angle = [0, 90, 180, 270], inertia = [2, 1.5, 1, 1.5], reactions.other = {inner} }}"
            ),
            "[actuators.<actuator>]" => format!("actuators.other = {inner}\nassembly.other = 10"),
            "[coordinates.<coordinate>]" => format!("coordinates.other = {inner}"),
            "[prescribed]" => {
                let inner = inner.trim_end_matches('}');
                format!("prescribed = {inner}, phi = {{ {law} }} }}")
            }
            // One actuator is led, another has to be free.
            "[motion]" if inner.contains("prescribed") => format!(
                "actuators.phi = {{ angle = [\"ground\", \"crank\"] }}\n\
                 actuators.psi = {{ angle = [\"crank\", \"rod\"] }}\nmotion = {inner}"
            ),
            "parameters of [sweep]" => format!("sweep.parameters = {inner}"),
            "tied of [sweep]" => format!("sweep.tied = {inner}"),
            "targets of [sweep]" => format!("sweep.targets = {inner}"),
            "a target of [sweep]" => format!("sweep.targets.foot = {inner}"),
            "a job of [optimise]" => format!("optimise.best = {inner}"),
            "vary of a job" => {
                format!("optimise.best = {{ vary = {inner}, minimise = \"m.max\" }}")
            }
            "minimise of a job" => {
                let vary = "{ \"crank.mass\" = [1, 2] }";
                format!("optimise.best = {{ vary = {vary}, minimise = {inner} }}")
            }
            "choose of a job" => {
                let vary = "{ \"crank.mass\" = [1, 2] }, minimise = \"m.max\"";
                format!("optimise.best = {{ vary = {vary}, choose = {inner} }}")
            }
            "[stops.<stop>]" => format!("stops.other = {inner}"),
            "[friction.<pin>]" => format!("friction.A = {inner}"),
            "[friction.<slide>]" => format!("friction.slide = {inner}"),
            "[prescribed.<actuator>], [motion.prescribed.<actuator>]" => {
                format!("prescribed = {{ duration = 2.0, phi = {inner} }}")
            }
            "sinusoid" => format!("prescribed = {{ duration = 2.0, phi.sinusoid = {inner} }}"),
            "polynomial345, polynomial4567, cycloidal" => {
                format!("prescribed = {{ duration = 2.0, phi.cycloidal = {inner} }}")
            }
            "trapezoidal" => {
                format!("prescribed = {{ duration = 2.0, phi.trapezoidal = {inner} }}")
            }
            "magnitude, stiffness, damping, voltage, speed" => {
                format!("loads.other = {{ torque = \"crank\", magnitude = {inner} }}")
            }
            "dwell" => format!("requests.dwell = {inner}"),
            "sections" => format!("requests.sections = [{inner}]"),
            name if name.starts_with('[') => format!("{} = {inner}", name.trim_matches(['[', ']'])),
            name if kinds("joints").iter().any(|t| t.name == name) => {
                format!("joints.other = {inner}")
            }
            name if kinds("loads").iter().any(|t| t.name == name) => {
                let replaced = if name == "gravity" { "weight" } else { "other" };
                format!("loads.{replaced} = {inner}")
            }
            name if kinds("drives").iter().any(|t| t.name == name) => {
                format!("drives.other = {inner}")
            }
            name if kinds("events").iter().any(|t| t.name == name) => {
                format!("motion = {{ initial-velocity = 1, duration = 1, events.other = {inner} }}")
            }
            _ => return None,
        })
    };
    let mut read = 0;
    for table in tables("scene") {
        let texts = if table.name == "the scene" {
            let each = table.keys.iter().filter(|k| k.name != "actuators");
            each.map(|k| format!("{} = {}", k.name, k.example))
                .collect()
        } else {
            let inner = tables_of_examples(table);
            let texts: Vec<_> = inner
                .iter()
                .map(|(_, inner)| around(table, inner))
                .map(|text| text.unwrap_or_else(|| panic!("where does `{}` go?", table.name)))
                .collect();
            texts
        };
        for fragment in texts {
            let text = merged(scene, &fragment);
            if let Err(error) = parse(&text) {
                panic!("{fragment}\n{}", render(&error));
            }
            read += 1;
        }
    }
    assert!(read > 80, "{read}");
}

/// What a schema finds wrong with a value: the part of JSON schema that ours uses.
fn wrong(schema: &Value, value: &Value) -> Option<String> {
    if let Some(each) = schema["oneOf"].as_array() {
        let fitting = each.iter().filter(|s| wrong(s, value).is_none()).count();
        if fitting != 1 {
            return Some(format!("{value} fits {fitting} of {} kinds", each.len()));
        }
    }
    if let Some(each) = schema["anyOf"].as_array()
        && each.iter().all(|s| wrong(s, value).is_some())
    {
        return Some(format!("{value} fits nothing"));
    }
    if let Some(words) = schema["enum"].as_array()
        && !words.contains(value)
    {
        return Some(format!("{value} is none of {words:?}"));
    }
    for name in schema["required"].as_array().into_iter().flatten() {
        if value.get(name.as_str()?).is_none() {
            return Some(format!("{name} is missing"));
        }
    }
    let is = match schema["type"].as_str() {
        Some("object") => value.is_object(),
        Some("array") => value.is_array(),
        Some("string") => value.is_string(),
        Some("boolean") => value.is_boolean(),
        Some("number") => value.is_number(),
        Some("integer") => value.is_i64(),
        Some(other) => panic!("unknown type {other}"),
        None => true,
    };
    if !is {
        return Some(format!("{value} is no {}", schema["type"]));
    }
    if let Some(items) = value.as_array() {
        let limit = |key: &str| schema[key].as_u64().map(|n| n as usize);
        let (min_items, max_items) = (limit("minItems"), limit("maxItems"));
        if min_items.is_some_and(|n| items.len() < n) || max_items.is_some_and(|n| items.len() > n)
        {
            return Some(format!("{value} has {} items", items.len()));
        }
        return items.iter().find_map(|item| wrong(&schema["items"], item));
    }
    let properties = schema["properties"].as_object()?;
    value.as_object()?.iter().find_map(|(name, value)| {
        let inner = properties
            .get(name)
            .unwrap_or(&schema["additionalProperties"]);
        match inner {
            Value::Bool(false) => Some(format!("{name} is unknown")),
            inner => wrong(inner, value),
        }
    })
}

/// What the schema finds wrong with a scene.
fn refused(text: &str) -> Option<String> {
    let schema: Value = serde_json::from_str(&schema()).unwrap();
    let table = toml::de::DeTable::parse(text).unwrap();
    wrong(
        &schema,
        &as_json(&toml::de::DeValue::Table(table.into_inner())),
    )
}

#[test]
fn the_schema_takes_what_the_reader_takes() {
    let mut texts = examples();
    texts.extend([WHOLE, MACHINE, FREE_MOTION].map(str::to_owned));
    let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
    for case in std::fs::read_dir(cases).unwrap() {
        let path = case.unwrap().path().join("scene.toml");
        texts.extend(std::fs::read_to_string(path).ok());
    }
    assert!(texts.len() > 12);
    for text in texts {
        assert_eq!(refused(&text), None, "{text}");
    }
}

/// Of the careless scenes, the schema sees those with a key unknown or missing, and those with a
/// value of another kind.
#[test]
fn the_schema_refuses_what_has_the_wrong_shape() {
    let mut refused_count = 0;
    for (text, scene) in [
        (include_str!("errors.txt"), WHOLE),
        (include_str!("machine.txt"), MACHINE),
        (include_str!("driven.txt"), FREE_MOTION),
    ] {
        for case in text.split("\n\n") {
            let lines = |sign: char| {
                let lines: Vec<_> = case.lines().filter_map(|l| l.strip_prefix(sign)).collect();
                lines.join("\n")
            };
            let messages = lines('=');
            let shape = ["unknown key", "is missing", ": expected a number, found"];
            if messages.contains("not valid TOML") || !shape.iter().any(|s| messages.contains(s)) {
                continue;
            }
            let text = changed(scene, &lines('-'), &lines('+'));
            assert!(refused(&text).is_some(), "{case}");
            refused_count += 1;
        }
    }
    assert!(refused_count > 40, "{refused_count}");
}

#[test]
fn the_units_are_those_that_the_reader_knows() {
    use crate::units::{ANGLES, KnownUnit, LENGTHS, MASSES};
    let all: [(&str, &[KnownUnit]); 3] =
        [("length", &LENGTHS), ("mass", &MASSES), ("angle", &ANGLES)];
    for (key, units) in all {
        let key = keys::table("units").key(key).unwrap();
        let ValueShape::Word(words) = &key.shape else {
            panic!("{key:?}");
        };
        assert_eq!(*words, units.iter().map(|u| u.0).collect::<Vec<_>>());
    }
}
