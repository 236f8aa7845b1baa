//! What can be wrong with a text.

use std::ops::Range;

/// Why a text is no expression of the given variables.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct ExpressionError {
    /// The bytes of the text that are wrong; empty only for an empty text.
    pub span: Range<usize>,
    /// What is wrong, without a full stop.
    pub message: String,
    /// What to write instead, where that can be told.
    pub help: Option<String>,
}

impl ExpressionError {
    pub(super) fn new(span: Range<usize>, message: impl Into<String>) -> Self {
        Self {
            span,
            message: message.into(),
            help: None,
        }
    }

    pub(super) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// The candidate that was probably meant, if one is near enough: a third of its letters wrong at
/// most, and at least one allowed.
pub(super) fn nearest<'a>(
    name: &str,
    candidates: impl Iterator<Item = &'a str>,
) -> Option<&'a str> {
    let name: Vec<char> = name.to_lowercase().chars().collect();
    // Nobody means a name of thousands of letters, and the distance takes their square.
    if name.len() > 64 {
        return None;
    }
    candidates
        .filter(|candidate| candidate.len() <= 256)
        .map(|candidate| {
            let letters: Vec<char> = candidate.to_lowercase().chars().collect();
            let allowed = (letters.len().min(name.len()) / 3).max(1);
            (distance(&name, &letters), allowed, letters.len(), candidate)
        })
        // One letter for another one-letter name is no likeness.
        .filter(|&(wrong, allowed, length, _)| wrong <= allowed && wrong < length)
        .min_by_key(|&(wrong, ..)| wrong)
        .map(|(.., candidate)| candidate)
}

/// How many letters must be inserted, left out, replaced, or exchanged with a neighbour.
fn distance(a: &[char], b: &[char]) -> usize {
    let mut before_last: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 0..a.len() {
        let mut row = vec![i + 1];
        for j in 0..b.len() {
            let mut best = (last[j] + usize::from(a[i] != b[j]))
                .min(last[j + 1] + 1)
                .min(row[j] + 1);
            if i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j] {
                best = best.min(before_last[j - 1] + 1);
            }
            row.push(best);
        }
        before_last = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_by_hand() {
        let between = |a: &str, b: &str| {
            let [a, b] = [a, b].map(|s| s.chars().collect::<Vec<_>>());
            distance(&a, &b)
        };
        for (a, b, d) in [
            ("", "", 0),
            ("omga", "omega", 1),
            ("oemga", "omega", 1),
            ("sine", "sin", 1),
            ("kitten", "sitting", 3),
            ("", "abc", 3),
        ] {
            assert_eq!(between(a, b), d, "{a} {b}");
        }
    }

    #[test]
    fn the_nearest_or_none() {
        let names = ["t", "phi", "phi.speed", "omega"];
        for (name, meant) in [
            ("omga", Some("omega")),
            ("Omega", Some("omega")),
            ("phi.sped", Some("phi.speed")),
            ("T", Some("t")),
            ("x", None),
            ("velocity", None),
        ] {
            assert_eq!(nearest(name, names.into_iter()), meant, "{name}");
        }
    }
}
