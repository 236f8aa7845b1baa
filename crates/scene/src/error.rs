//! The error type: a message, its places in the file, and a suggestion.

use miette::{Diagnostic, LabeledSpan, NamedSource};
use std::ops::Range;
use std::sync::Arc;

/// Longest line that is shown, bytes. A longer one is no help to a reader, and the drawing of
/// columns beyond 65 535 panics.
const MAX_LINE_BYTES: usize = 2000;

/// Name and text of a scene, shared by the scene and its errors.
pub(crate) type Source = Arc<NamedSource<String>>;

/// An error of a scene, with its place in the text and a suggestion.
///
/// Several errors of one file are one `SceneError` whose [`errors`](Self::errors) are the single
/// ones.
#[derive(Debug, Clone, thiserror::Error, Diagnostic)]
#[error("{message}")]
pub struct SceneError {
    /// The message, which names the body, joint or key.
    pub message: String,
    /// How to mend it.
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
    pub related: Vec<SceneError>,
}

/// A warning about a valid scene, which probably contains a mistake. Plain data.
#[derive(Debug, Clone, thiserror::Error, Diagnostic)]
#[error("{message}")]
#[diagnostic(severity(Warning))]
pub struct SceneWarning {
    /// The message: the entry, and a replacement.
    pub message: String,
    /// The byte range of the text that it is about.
    #[label(collection)]
    pub labels: Vec<LabeledSpan>,
    /// The text the label points into; `None` if the line is too long to be shown.
    #[source_code]
    pub text: Option<Arc<NamedSource<String>>>,
}

impl SceneWarning {
    pub(crate) fn at(source: &Source, message: String, label: &str, span: Range<usize>) -> Self {
        let label = (span, label.to_owned());
        let located = SceneError::with_labels(source, message, None, [label]);
        Self {
            message: located.message,
            labels: located.labels,
            text: located.text,
        }
    }
}

impl SceneError {
    /// An error without a place: there is no text.
    pub fn without_labels(message: String, help: Option<String>) -> Self {
        Self {
            message,
            help,
            labels: Vec::new(),
            text: None,
            related: Vec::new(),
        }
    }

    /// An error at a range of the text of another file than a scene, such as a table of numbers: the file's `name` and its text; the
    /// remark at the range is its `label`.
    pub fn in_text(
        name: &str,
        text: &str,
        message: String,
        help: Option<String>,
        at: Range<usize>,
        label: String,
    ) -> Self {
        let source = Arc::new(NamedSource::new(name, text.to_owned()));
        Self::with_labels(&source, message, help, [(at, label)])
    }

    /// An error at ranges of the text. The ranges are cut to the text and to character boundaries, since a label
    /// outside would keep the whole message from being drawn. If a line is too long to be shown, the message states
    /// line and column instead.
    pub(crate) fn with_labels(
        source: &Source,
        message: String,
        help: Option<String>,
        labels: impl IntoIterator<Item = (Range<usize>, String)>,
    ) -> Self {
        let text = source.inner();
        // Nothing is drawn behind the last character: what is missing there is shown at it.
        let written = text.trim_end();
        let last = written.char_indices().next_back().map_or(0, |(at, _)| at);
        let labels = labels.into_iter().map(|(span, label)| {
            let span = if span.start >= written.len() {
                last..written.len()
            } else {
                span
            };
            let start = text.floor_char_boundary(span.start);
            let end = text.ceil_char_boundary(span.end).max(start);
            LabeledSpan::new((!label.is_empty()).then_some(label), start, end - start)
        });
        let labels: Vec<_> = labels.collect();
        if let Some(first) = labels.first()
            && labels.iter().any(|l| has_long_lines(text, l))
        {
            let before = text.get(..first.offset()).unwrap_or_default();
            let line = before.matches('\n').count() + 1;
            let in_line = before.rsplit('\n').next().unwrap_or_default();
            let column = in_line.chars().count() + 1;
            let position = format!("{}, line {line}, column {column}", source.name());
            return Self::without_labels(format!("{message} ({position})"), help);
        }
        Self {
            labels,
            text: Some(Arc::clone(source)),
            ..Self::without_labels(message, help)
        }
    }

    /// The single errors: itself, or those it gathers.
    pub fn errors(&self) -> &[Self] {
        if self.related.is_empty() {
            std::slice::from_ref(self)
        } else {
            &self.related
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

/// Whether one of the lines shown for a label is too long: those it is on, and one on either side.
fn has_long_lines(text: &str, label: &LabeledSpan) -> bool {
    let (start, end) = (label.offset(), label.offset() + label.len());
    let before = text.get(..start).unwrap_or_default();
    let after = text.get(end..).unwrap_or_default();
    let from = before.rmatch_indices('\n').nth(1);
    let to = after.match_indices('\n').nth(1);
    let from = from.map_or(0, |(at, _)| at + 1);
    let to = to.map_or(text.len(), |(at, _)| end + at);
    let excerpt = text.get(from..to).unwrap_or_default();
    excerpt.lines().any(|line| line.len() > MAX_LINE_BYTES)
}
