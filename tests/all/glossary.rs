//! The retired words of `docs/glossary.md` stay out of names and messages.

use dwell_tests::fixtures::repository_root;
use std::fs;
use std::path::{Path, PathBuf};

/// A word of the glossary's last table, and whether it is kept out of names, of messages, or of both.
struct RetiredWord {
    word: String,
    names: bool,
    messages: bool,
}

fn retired_words() -> Vec<RetiredWord> {
    let glossary =
        fs::read_to_string(repository_root().join("docs/glossary.md")).expect("the glossary");
    let (_, table) = glossary
        .split_once("\n## Retired words\n")
        .expect("its last section");
    let rows = table.lines().filter(|line| line.starts_with("| `"));
    rows.map(|row| {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        RetiredWord {
            word: cells[1].trim_matches('`').to_owned(),
            names: cells[2].contains("names"),
            messages: cells[2].contains("messages"),
        }
    })
    .collect()
}

pub(crate) fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
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
pub(crate) fn split(text: &str) -> (String, Vec<String>) {
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

/// Names that a file defines: after a keyword, and fields and variants at the beginning of a line.
fn defined_names(code: &str) -> Vec<String> {
    const KEYWORDS: [&str; 9] = [
        "struct", "enum", "trait", "type", "union", "fn", "mod", "const", "static",
    ];
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut names = Vec::new();
    for line in code.lines() {
        let words: Vec<&str> = line
            .split(|c| !is_word(c))
            .filter(|w| !w.is_empty())
            .collect();
        for pair in words.windows(2) {
            if KEYWORDS.contains(&pair[0]) {
                names.push(pair[1].to_owned());
            }
        }
        let field = line
            .trim_start()
            .trim_start_matches("pub(crate) ")
            .trim_start_matches("pub(super) ");
        let field = field.trim_start_matches("pub ");
        let name: String = field.chars().take_while(|&c| is_word(c)).collect();
        let after = field[name.len()..].trim_start();
        let is_field =
            after.starts_with(": ") && line.trim_end().ends_with(',') && line.contains("pub");
        let is_variant = name.starts_with(char::is_uppercase) && after.starts_with(',');
        if is_field || is_variant {
            names.push(name);
        }
    }
    names
}

/// `AssemblyMode`, `assembly_mode` and `MAX_MODES` in words of small letters.
fn words_of(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let letters: Vec<char> = name.chars().collect();
    for (i, &letter) in letters.iter().enumerate() {
        let begins = letter.is_uppercase() && i > 0 && letters[i - 1].is_lowercase();
        if letter == '_' || begins {
            words.push(String::new());
        }
        if letter != '_' {
            words
                .last_mut()
                .expect("a word")
                .extend(letter.to_lowercase());
        }
    }
    words
}

#[test]
fn retired_words_stay_out_of_names_and_messages() {
    let retired = retired_words();
    assert!(retired.len() > 100, "{}", retired.len());
    let mut files = Vec::new();
    for entry in fs::read_dir(repository_root().join("crates")).expect("the crates") {
        sources(&entry.expect("a crate").path().join("src"), &mut files);
    }
    let mut found = Vec::new();
    for path in &files {
        let (code, strings) = split(&fs::read_to_string(path).expect("a source"));
        let mut names = defined_names(&code);
        names.extend(
            path.file_stem()
                .and_then(|stem| stem.to_str())
                .map(str::to_owned),
        );
        for retired in &retired {
            if retired.names {
                let hits = names
                    .iter()
                    .filter(|name| words_of(name).contains(&retired.word));
                found.extend(hits.map(|name| format!("{}: {name}", path.display())));
            }
            if retired.messages {
                let words = |text: &str| {
                    text.split(|c: char| !c.is_alphabetic())
                        .any(|w| w == retired.word)
                };
                let hits = strings.iter().filter(|text| words(text));
                found.extend(hits.map(|text| format!("{}: \"{text}\"", path.display())));
            }
        }
    }
    assert!(
        found.is_empty(),
        "retired words, see docs/glossary.md:\n{}",
        found.join("\n")
    );
}
