//! The one error type: a message, where in the file, and what to try.

use miette::{Diagnostic, LabeledSpan, NamedSource};
use std::sync::Arc;

/// Name and text of a scene, shared by the scene and its errors.
pub(crate) type Source = Arc<NamedSource<String>>;

/// What is wrong with a scene, where in its text, and what to try.
///
/// Several errors of one file are one `SceneError` whose [`errors`](Self::errors) are the single
/// ones.
#[derive(Debug, Clone, thiserror::Error, Diagnostic)]
#[error("{message}")]
pub struct SceneError {
    /// What is wrong, naming the body, joint or key.
    pub message: String,
    /// What to try.
    #[help]
    pub help: Option<String>,
    /// Byte ranges of the text, each with a remark. Within the text, on character boundaries.
    #[label(collection)]
    pub labels: Vec<LabeledSpan>,
    /// The text the labels point into; none if the file could not be read.
    #[source_code]
    pub text: Option<Arc<NamedSource<String>>>,
    /// The single errors, if there are several.
    #[related]
    pub others: Vec<SceneError>,
}

impl SceneError {
    /// An error without a place: there is no text.
    pub(crate) fn bare(message: String, help: Option<String>) -> Self {
        Self {
            message,
            help,
            labels: Vec::new(),
            text: None,
            others: Vec::new(),
        }
    }

    /// An error at ranges of the text. The ranges are cut to the text and to character boundaries,
    /// since a label outside would keep the whole message from being drawn.
    pub(crate) fn at(
        source: &Source,
        message: String,
        help: Option<String>,
        labels: impl IntoIterator<Item = (std::ops::Range<usize>, String)>,
    ) -> Self {
        let text = source.inner();
        let labels = labels.into_iter().map(|(span, label)| {
            let start = text.floor_char_boundary(span.start);
            let end = text.ceil_char_boundary(span.end).max(start);
            LabeledSpan::new(Some(label), start, end - start)
        });
        Self {
            message,
            help,
            labels: labels.collect(),
            text: Some(Arc::clone(source)),
            others: Vec::new(),
        }
    }

    /// The single errors: itself, or those it gathers.
    pub fn errors(&self) -> &[Self] {
        if self.others.is_empty() {
            std::slice::from_ref(self)
        } else {
            &self.others
        }
    }

    /// Each label of this error as (the text it points at, its remark).
    pub fn labelled(&self) -> Vec<(&str, &str)> {
        let text = self.text.as_ref().map_or("", |t| t.inner().as_str());
        let slice = |l: &LabeledSpan| text.get(l.offset()..l.offset() + l.len());
        self.labels
            .iter()
            .map(|l| (slice(l).unwrap_or(""), l.label().unwrap_or("")))
            .collect()
    }
}
