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
    let name = name.to_lowercase();
    let length = name.chars().count();
    // Nobody means a name of thousands of letters, and the distance takes their square.
    if length > 64 {
        return None;
    }
    candidates
        .filter(|candidate| candidate.len() <= 256)
        .map(|candidate| {
            let folded = candidate.to_lowercase();
            let letters = folded.chars().count();
            let allowed = (letters.min(length) / 3).max(1);
            // Letters inserted, left out, replaced, or exchanged with a neighbour.
            let wrong = strsim::osa_distance(&name, &folded);
            (wrong, allowed, letters, candidate)
        })
        // One letter for another one-letter name is no likeness.
        .filter(|&(wrong, allowed, length, _)| wrong <= allowed && wrong < length)
        .min_by_key(|&(wrong, ..)| wrong)
        .map(|(.., candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_or_none() {
        let names = ["t", "phi", "phi.speed", "omega"];
        for (name, meant) in [
            ("omga", Some("omega")),
            ("oemga", Some("omega")),
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
