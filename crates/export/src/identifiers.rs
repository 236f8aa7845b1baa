//! Names of a scene as identifiers: different names stay different, and none can be a word of a language.

use crate::machine::{LoadDescription, MachineDescription};
use std::collections::HashSet;

/// The identifiers of an export.
#[derive(Debug, Clone, PartialEq)]
pub struct Identifiers {
    /// The prefix of the names of functions and types.
    pub prefix: String,
    /// The prefix in capitals, for constants.
    pub capitals: String,
    /// By load.
    pub loads: Vec<String>,
    /// By reaction.
    pub reactions: Vec<String>,
    /// By point.
    pub points: Vec<String>,
}

impl Identifiers {
    /// The identifiers of a machine.
    pub fn new(machine: &MachineDescription) -> Self {
        Self::of(
            &machine.name,
            &machine.loads,
            &machine.reactions,
            &machine.points,
        )
    }

    /// The identifiers of a machine with this name and these parts.
    pub(crate) fn of(
        name: &str,
        loads: &[LoadDescription],
        reactions: &[(String, &'static str)],
        points: &[String],
    ) -> Self {
        let mut prefix = plain(name).to_ascii_lowercase();
        if !prefix.starts_with(|c: char| c.is_ascii_alphabetic()) {
            prefix.insert_str(0, "machine_");
        }
        let reactions: Vec<_> = reactions.iter().map(|(name, _)| name).collect();
        let loads: Vec<_> = loads.iter().map(|load| &load.name).collect();
        Self {
            capitals: prefix.to_ascii_uppercase(),
            prefix,
            loads: distinct(&loads),
            reactions: distinct(&reactions),
            points: distinct(&points.iter().collect::<Vec<_>>()),
        }
    }
}

/// Letters, digits and underscores; any other character becomes an underscore if it separates words, else its number.
fn plain(name: &str) -> String {
    let mut text = String::new();
    for c in name.chars() {
        match c {
            c if c.is_ascii_alphanumeric() => text.push(c),
            '.' | '-' | '_' | ' ' => text.push('_'),
            c => text += &format!("u{:04x}", u32::from(c)),
        }
    }
    text
}

/// As [`plain`], with a number appended to names that would be equal to others.
pub(crate) fn distinct(names: &[&String]) -> Vec<String> {
    // How many there are is called `…_COUNT`.
    let mut used = HashSet::from(["COUNT".to_owned()]);
    let mut all = Vec::with_capacity(names.len());
    for name in names {
        let plain = plain(name);
        let numbered = (2_usize..).map(|k| format!("{plain}_{k}"));
        let mut candidates = std::iter::once(plain.clone()).chain(numbered);
        // In capitals, too, they differ.
        let free = candidates.find(|one| !used.contains(&one.to_ascii_uppercase()));
        let found = free.unwrap_or(plain);
        used.insert(found.to_ascii_uppercase());
        all.push(found);
    }
    all
}

/// Text that can stand in a comment of any language: it has one line and cannot end the comment or continue the line.
pub(crate) fn comment(text: &str) -> String {
    let safe = |c: char| match c {
        '*' => '+',
        '\\' => '/',
        '?' => '.',
        c if c.is_alphanumeric() || c.is_ascii_graphic() || c == ' ' => c,
        '²' | '′' | '½' | '·' | '–' | '“' | '”' | '°' | '±' | '≤' | '≥' | '−' => {
            c
        }
        _ => ' ',
    };
    text.chars().map(safe).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn different_names_stay_different() {
        let names = [
            "slide.normal",
            "slide_normal",
            "φ",
            "u03c6",
            "A",
            "a",
            "a_2",
            "count",
        ];
        let owned: Vec<String> = names.iter().map(|&n| n.to_owned()).collect();
        let found = distinct(&owned.iter().collect::<Vec<_>>());
        let capitals: HashSet<_> = found.iter().map(|n| n.to_ascii_uppercase()).collect();
        assert_eq!(capitals.len(), names.len(), "{found:?}");
        assert!(!capitals.contains("COUNT"), "{found:?}");
    }

    #[test]
    fn a_title_stays_in_its_comment() {
        let hostile = "x */ int y; /* ??/\n *??/\r\u{2028}\u{202e}\\";
        let found = comment(hostile);
        assert!(!found.contains("*/") && !found.contains("/*") && !found.contains('\\'));
        assert!(!found.contains("??") && found.lines().count() == 1);
        assert!(!found.contains('\u{202e}'));
    }
}
