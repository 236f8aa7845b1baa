//! Collects the errors of a file in one report, and the places of the parts of a scene.

use crate::error::{SceneError, SceneWarning, Source};
use crate::spans::{SceneLocation, SceneSpans};
use crate::wording::choices;
use std::cell::{Cell, RefCell};
use std::fmt::Write as _;
use std::ops::Range;

/// Bytes of the text.
pub(crate) type Span = Range<usize>;

/// Errors reported at once. A file can be wrong twenty thousand times over, a reader cannot.
const MAX_REPORTED: usize = 40;

/// One thing that is wrong.
#[derive(Debug)]
struct Diagnostic {
    message: String,
    help: Option<String>,
    labels: Vec<(Span, String)>,
}

/// Everything that is wrong with one file. Its readers share it.
#[derive(Debug)]
pub(crate) struct Diagnostics {
    source: Source,
    found: RefCell<Vec<Diagnostic>>,
    suppressed: Cell<usize>,
    warnings: RefCell<Vec<SceneWarning>>,
    /// The places of the parts of the scene.
    spans: RefCell<SceneSpans>,
}

impl Diagnostics {
    pub(crate) fn new(source: &Source) -> Self {
        Self {
            source: Source::clone(source),
            found: RefCell::default(),
            suppressed: Cell::new(0),
            warnings: RefCell::default(),
            spans: RefCell::default(),
        }
    }

    /// Reports an error with its places, the main place first, and a suggestion (may be empty).
    pub(crate) fn report(
        &self,
        message: impl Into<String>,
        labels: &[(&Span, &str)],
        help: impl Into<String>,
    ) {
        if self.full() {
            return self.suppressed.set(self.suppressed.get() + 1);
        }
        let labels = labels.iter().map(|&(at, label)| (at.clone(), label.into()));
        self.found.borrow_mut().push(Diagnostic {
            message: message.into(),
            help: Some(help.into()).filter(|help| !help.is_empty()),
            labels: labels.collect(),
        });
    }

    /// Reports an error and returns `None` instead of a value.
    pub(crate) fn reject<T>(
        &self,
        message: impl Into<String>,
        labels: &[(&Span, &str)],
        help: impl Into<String>,
    ) -> Option<T> {
        self.report(message, labels, help);
        None
    }

    /// Notes where a thing of the scene is written.
    pub(crate) fn place(&self, location: SceneLocation, span: &Span) {
        self.spans.borrow_mut().insert(location, span.clone());
    }

    /// All that has been noted.
    pub(crate) fn take_spans(&self) -> SceneSpans {
        self.spans.take()
    }

    /// Where in the file a part of a string is. A string with escapes does not stand in the file
    /// as it reads: then it is the whole of it.
    pub(crate) fn part_span(&self, string: &Span, text: &str, part: Span) -> Span {
        let written = self.source.inner().get(string.clone()).unwrap_or_default();
        let quotes = match written.get(..3) {
            Some("\"\"\"" | "\'\'\'") if written.len() >= 6 => 3,
            _ => 1,
        };
        let inner = written.get(quotes..written.len().saturating_sub(quotes));
        let inner = inner.unwrap_or_default();
        // A line break right after three quotes is no part of the text.
        let skipped = match (quotes, inner.find('\n')) {
            (3, Some(0)) => 1,
            (3, Some(1)) if inner.starts_with('\r') => 2,
            _ => 0,
        };
        if inner.get(skipped..) != Some(text) || text.is_empty() {
            return string.clone();
        }
        let from = string.start + quotes + skipped;
        from + part.start..from + part.end
    }

    /// Warns of a valid entry that is probably a mistake.
    pub(crate) fn warn(&self, message: String, label: &str, span: Span) {
        let warning = SceneWarning::at(&self.source, message, label, span);
        self.warnings.borrow_mut().push(warning);
    }

    /// The warnings.
    pub(crate) fn warnings(&self) -> Vec<SceneWarning> {
        self.warnings.take()
    }

    /// How many there are: a part of the file was read well if its reading did not change this.
    pub(crate) fn count(&self) -> usize {
        self.found.borrow().len() + self.suppressed.get()
    }

    fn full(&self) -> bool {
        self.found.borrow().len() >= MAX_REPORTED
    }

    /// A suggestion instead of `wrong`: the nearest of the names, or else their list. `kind` is their kind, in the
    /// plural.
    pub(crate) fn choices<'n>(
        &self,
        wrong: &str,
        kind: &str,
        names: impl Iterator<Item = &'n str> + Clone,
    ) -> String {
        // Comparing with every name costs; it is not done for messages nobody sees.
        if self.full() {
            return String::new();
        }
        choices(wrong, kind, names)
    }

    /// The report; `None` without errors.
    pub(crate) fn to_error(&self) -> Option<SceneError> {
        let mut found = self.found.take();
        // In the order of the file, whatever order the sections were read in.
        found.sort_by_key(|p| p.labels.first().map_or(0, |(span, _)| span.start));
        let single =
            |p: Diagnostic| SceneError::with_labels(&self.source, p.message, p.help, p.labels);
        let mut errors: Vec<_> = found.into_iter().map(single).collect();
        if errors.len() < 2 {
            return errors.pop();
        }
        let suppressed = self.suppressed.get();
        let mut message = format!("the scene has {} errors", errors.len() + suppressed);
        if suppressed > 0 {
            let _ = write!(message, "; here are {MAX_REPORTED} of them");
        }
        let mut all = SceneError::without_labels(message, None);
        all.text = Some(Source::clone(&self.source));
        all.related = errors;
        Some(all)
    }
}
