//! Errors in the text of an expression.

use std::ops::Range;

/// Why a text is not an expression of the given variables.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct ExpressionError {
    /// The byte range of the fault in the text; empty only for an empty text.
    pub span: Range<usize>,
    /// The fault, without a full stop.
    pub message: String,
    /// What to write instead, if known.
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

/// Longest name that is compared with others: the cost of a distance is the square of the length.
const MAX_COMPARED: usize = 64;

/// The name that was probably meant: the one that differs in capitals only, or the nearest, with one slip
/// (a letter inserted, left out, replaced, or exchanged with its neighbour) for three letters, and three at most.
pub fn nearest<'n>(wrong: &str, names: impl Iterator<Item = &'n str> + Clone) -> Option<&'n str> {
    let length = wrong.chars().count();
    if length > MAX_COMPARED {
        return None;
    }
    let folded = wrong.to_lowercase();
    // Compared by spelling or by sound: `fi` means `phi`, not `pi`.
    let distance = |name: &str| {
        let name = name.to_lowercase();
        let sound = |name: &str| name.replace("ph", "f");
        let written = strsim::osa_distance(&name, &folded);
        written.min(strsim::osa_distance(&sound(&name), &sound(&folded)))
    };
    if let Some(same) = names.clone().find(|n| n.to_lowercase() == folded) {
        return Some(same);
    }
    // Two one-letter names have nothing in common; `A` is no slip for `B`.
    let slips = match length {
        0 | 1 => 0,
        _ => length.div_ceil(3).min(3),
    };
    names
        .filter(|n| n.chars().count().abs_diff(length) <= slips)
        .map(|n| (distance(n), n))
        .filter(|(d, n)| *d <= slips && *d < n.chars().count())
        .min_by_key(|(d, _)| *d)
        .map(|(_, n)| n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_or_none() {
        let names = ["t", "pi", "phi", "phi.velocity", "omega"];
        for (name, meant) in [
            ("omga", Some("omega")),
            ("oemga", Some("omega")),
            ("Omega", Some("omega")),
            ("phi.velocty", Some("phi.velocity")),
            ("T", Some("t")),
            ("x", None),
            ("height", None),
            ("fi", Some("phi")),
        ] {
            assert_eq!(nearest(name, names.into_iter()), meant, "{name}");
        }
    }
}
