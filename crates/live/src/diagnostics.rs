//! Errors and warnings for an editor: the messages of the command line with their places in the text.

use dwell_scene::{SceneError, SceneWarning};
use serde::Serialize;

/// A message about a scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct MessageInText {
    /// `error` or `warning`.
    pub severity: &'static str,
    /// The message.
    pub message: String,
    /// A suggestion.
    pub help: Option<String>,
    /// Its places, the main one first.
    pub labels: Vec<LabelInText>,
}

/// A place in the text of a scene, with a remark.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LabelInText {
    /// Start of the place, in UTF-16 code units, as in JavaScript.
    pub from: usize,
    /// End of the place (exclusive), in UTF-16 code units.
    pub to: usize,
    /// Its line, from 1.
    pub line: usize,
    /// The remark, or an empty text.
    pub remark: String,
}

/// The individual errors, in the order of the file.
pub(crate) fn errors(error: &SceneError) -> Vec<MessageInText> {
    let errors = error.errors();
    errors.iter().map(|one| message("error", one)).collect()
}

/// The warnings of a scene.
pub(crate) fn warnings(warnings: &[SceneWarning]) -> Vec<MessageInText> {
    let as_error = |warning: &SceneWarning| SceneError {
        labels: warning.labels.clone(),
        text: warning.text.clone(),
        ..SceneError::without_labels(warning.message.clone(), None)
    };
    let all = warnings.iter().map(as_error);
    all.map(|one| message("warning", &one)).collect()
}

fn message(severity: &'static str, error: &SceneError) -> MessageInText {
    let text = error.text.as_ref().map_or("", |text| text.inner().as_str());
    let spans = error.labels.iter().map(|label| {
        let remark = label.label().unwrap_or_default();
        (label.offset(), label.len(), remark)
    });
    MessageInText {
        severity,
        message: error.message.clone(),
        help: error.help.clone(),
        labels: spans
            .map(|(offset, length, remark)| label(text, offset, length, remark))
            .collect(),
    }
}

/// A byte span of the text as a place in it.
fn label(text: &str, offset: usize, length: usize, remark: &str) -> LabelInText {
    let before = text.get(..offset).unwrap_or(text);
    let within = text.get(offset..offset + length).unwrap_or_default();
    let units = |part: &str| part.encode_utf16().count();
    LabelInText {
        from: units(before),
        to: units(before) + units(within),
        line: before.matches('\n').count() + 1,
        remark: remark.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_as_a_browser_does() {
        // Two bytes are one code unit; four bytes are two.
        let found = label("é\n𝜑 = 1", 3, 4, "here");
        assert_eq!((found.from, found.to, found.line), (2, 4, 2));
    }
}
