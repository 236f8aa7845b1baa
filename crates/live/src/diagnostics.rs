//! Errors and warnings as an editor shows them: the words of the command line, and where in the text they belong.

use dwell_scene::{SceneError, SceneWarning};
use serde::Serialize;

/// A message about a scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct MessageInText {
    /// `error` or `warning`.
    pub severity: &'static str,
    /// What is wrong.
    pub message: String,
    /// What to try.
    pub help: Option<String>,
    /// Where, the main place first.
    pub labels: Vec<LabelInText>,
}

/// A place in the text of a scene, with a remark.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LabelInText {
    /// The first character, and the one after the last, in units of UTF-16, as JavaScript counts.
    pub from: usize,
    /// See [`from`](Self::from).
    pub to: usize,
    /// Its line, from 1.
    pub line: usize,
    /// The remark, or nothing.
    pub remark: String,
}

/// The errors that one reports, in the order of the file.
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
        labels: spans.map(|span| label(text, span)).collect(),
    }
}

/// A span of bytes of the text as a place in it.
fn label(text: &str, (offset, length, remark): (usize, usize, &str)) -> LabelInText {
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
        // Two bytes and one unit; four bytes and two units.
        let found = label("é\n𝜑 = 1", (3, 4, "here"));
        assert_eq!((found.from, found.to, found.line), (2, 4, 2));
    }
}
