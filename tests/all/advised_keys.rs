//! What messages advise can be written: sections and keys are those of `keys.toml`.

use dwell_tests::fixtures::repository_root;
use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The crates whose texts advise what to write in a scene.
const CRATES: [&str; 9] = [
    "cli",
    "dwell",
    "dynamics",
    "geometry",
    "kinetostatics",
    "laws",
    "live",
    "scene",
    "study",
];
/// What stands before the name of a key that is advised, but for an article.
const VERBS: [&str; 7] = ["add", "give", "needs", "out", "set", "use", "without"];
const ARTICLES: [&str; 5] = ["a", "an", "another", "one", "the"];
/// Units that stand in brackets as sections do.
const UNITS: [&str; 3] = ["deg", "m", "rad"];

/// The keys of each section, and all keys with the words that are values.
struct Known {
    sections: HashMap<String, HashSet<String>>,
    names: HashSet<String>,
}

fn words_in(value: &toml::Value, words: &mut HashSet<String>) {
    match value {
        toml::Value::String(word) => _ = words.insert(word.clone()),
        toml::Value::Array(all) => all.iter().for_each(|value| words_in(value, words)),
        toml::Value::Table(all) => all.values().for_each(|value| words_in(value, words)),
        _ => {}
    }
}

fn known() -> Known {
    let mut known = Known {
        sections: HashMap::new(),
        names: HashSet::new(),
    };
    for file in ["keys.toml", "space/keys.toml"] {
        let path = repository_root().join("crates/scene/src").join(file);
        let text = fs::read_to_string(path).expect("the keys");
        let keys: toml::Table = text.parse().expect("a TOML file");
        for table in keys["tables"].as_table().expect("tables").values() {
            let name = table["name"].as_str().expect("a name");
            let section = name.trim_end_matches(" in space");
            let section = known.sections.entry(section.to_owned()).or_default();
            let keys = table.get("keys").and_then(toml::Value::as_array);
            for key in keys.into_iter().flatten() {
                let name = key["name"].as_str().expect("a name");
                section.insert(name.to_owned());
                known.names.insert(name.to_owned());
                words_in(&key["value"], &mut known.names);
            }
        }
    }
    known
}

fn is_name(text: &str) -> bool {
    let begins = text.starts_with(|c: char| c.is_ascii_lowercase());
    begins && text.chars().all(|c| c.is_ascii_lowercase() || c == '-')
}

impl Known {
    /// What a message advises that is no section, and no key where it shall be written.
    fn wrong_in(&self, message: &str) -> Vec<String> {
        let mut wrong = Vec::new();
        for part in message.split('[').skip(1) {
            let Some((section, _)) = part.split_once(']') else {
                continue;
            };
            let mut names = section.split('.');
            let first = names.next().unwrap_or_default();
            let is_section = self.sections["the scene"].contains(first);
            if is_name(first) && !is_section && !UNITS.contains(&first) {
                wrong.push(format!("no section [{section}]"));
            }
        }
        let parts: Vec<&str> = message.split('`').collect();
        for k in (1..parts.len().saturating_sub(1)).step_by(2) {
            let name = parts[k].split(" = ").next().unwrap_or_default();
            let before = parts[k - 1].split_whitespace().rev();
            let verb = before.into_iter().find(|word| !ARTICLES.contains(word));
            let is_advised = verb.is_some_and(|verb| VERBS.contains(&verb));
            if is_name(name) && is_advised && !self.names.contains(name) {
                wrong.push(format!("no key `{name}`"));
            }
            // `duration` (s) in [motion]
            let after = parts[k + 1].trim_start();
            let after = after.strip_prefix('(').map_or(after, |unit| {
                unit.split_once(')').map_or(after, |(_, after)| after)
            });
            let section = after.trim_start().strip_prefix("in [");
            let section = section.and_then(|section| section.split_once(']'));
            let keys = section.and_then(|(section, _)| self.sections.get(&format!("[{section}]")));
            if is_name(name) && keys.is_some_and(|keys| !keys.contains(name)) {
                wrong.push(format!("no key `{name}` there"));
            }
        }
        wrong
    }
}

/// A string literal as it is printed: without the ends of its lines.
fn printed(literal: &str) -> String {
    let mut lines = literal.split("\\\n");
    let first = lines.next().unwrap_or_default().to_owned();
    lines.fold(first, |text, line| text + line.trim_start())
}

#[test]
fn messages_advise_sections_and_keys_that_exist() {
    let known = known();
    assert!(
        known
            .wrong_in("give a `duration` (s) in [motion]")
            .is_empty()
    );
    for retired in ["give a `speed` in [motion]", "add `centre`", "see [sweeps]"] {
        assert_eq!(known.wrong_in(retired).len(), 1, "{retired}");
    }
    let mut files = Vec::new();
    for name in CRATES {
        let folder = repository_root().join("crates").join(name).join("src");
        sources(&folder, &mut files);
    }
    let mut found = Vec::new();
    for path in &files {
        let (_, strings) = split(&fs::read_to_string(path).expect("a source"));
        for message in strings.iter().map(|literal| printed(literal)) {
            // Code in brackets is no message.
            if message.contains(' ') {
                let wrong = known.wrong_in(&message).into_iter();
                found.extend(wrong.map(|what| format!("{}: {what}: {message}", path.display())));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() && path.file_name().is_some_and(|name| name != "tests") {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs")
            && path.file_stem().is_some_and(|s| s != "tests")
        {
            found.push(path);
        }
    }
}

/// The code of a file and its string literals: without comments, and without what follows the first `#[cfg(test)]`.
fn split(text: &str) -> (String, Vec<String>) {
    let text = text.split("#[cfg(test)]").next().unwrap_or(text);
    let (mut code, mut strings) = (String::new(), Vec::new());
    let mut rest = text;
    while let Some(letter) = rest.chars().next() {
        if rest.starts_with("//") {
            rest = rest.split_once('\n').map_or("", |(_, after)| after);
            code.push('\n');
        } else if letter == '"' {
            let mut escaped = false;
            let end = rest[1..].find(|c| {
                let closes = c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                closes
            });
            let end = end.map_or(rest.len(), |end| end + 1);
            strings.push(rest[1..end].to_owned());
            rest = rest.get(end + 1..).unwrap_or("");
        } else if rest.starts_with("'\"'") {
            rest = &rest[3..];
        } else {
            code.push(letter);
            rest = &rest[letter.len_utf8()..];
        }
    }
    (code, strings)
}
