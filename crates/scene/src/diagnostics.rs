//! Gathering the errors of a file, so that one report holds them all.

use crate::error::{SceneError, SceneWarning, Source};
use crate::wording::choices;
use std::cell::{Cell, RefCell};
use std::collections::HashSet;
use std::fmt::Write as _;
use std::ops::Range;

/// Bytes of the text.
pub(crate) type Span = Range<usize>;

/// Errors reported at once. A file can be wrong twenty thousand times over, a reader cannot.
const MAX_REPORTED: usize = 40;

/// One thing that is wrong, until it is reported.
#[derive(Debug)]
#[must_use]
pub(crate) struct Diagnostic<'l> {
    log: &'l Diagnostics,
    found: Found,
}

#[derive(Debug)]
struct Found {
    message: String,
    help: Option<String>,
    labels: Vec<(Span, String)>,
}

impl Diagnostic<'_> {
    pub(crate) fn label(mut self, span: &Span, label: impl Into<String>) -> Self {
        self.found.labels.push((span.clone(), label.into()));
        self
    }

    /// How to mend it; nothing where the text is empty.
    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.found.help = Some(help.into()).filter(|help| !help.is_empty());
        self
    }

    pub(crate) fn report(self) {
        if self.log.full() {
            self.log.suppressed.set(self.log.suppressed.get() + 1);
        } else {
            self.log.found.borrow_mut().push(self.found);
        }
    }

    /// Reports it, in place of what could not be read.
    pub(crate) fn reject<T>(self) -> Option<T> {
        self.report();
        None
    }
}

/// Everything that is wrong with one file. Its readers share it.
#[derive(Debug)]
pub(crate) struct Diagnostics {
    source: Source,
    found: RefCell<Vec<Found>>,
    suppressed: Cell<usize>,
    /// Former names that the file uses: the name, what it is called now, where it stands.
    renamed: RefCell<Vec<(String, String, Span)>>,
}

impl Diagnostics {
    pub(crate) fn new(source: &Source) -> Self {
        Self {
            source: Source::clone(source),
            found: RefCell::default(),
            suppressed: Cell::new(0),
            renamed: RefCell::default(),
        }
    }

    /// Something that is wrong, to be reported once its places are added.
    pub(crate) fn error(&self, message: impl Into<String>) -> Diagnostic<'_> {
        let message = message.into();
        let (help, labels) = (None, Vec::new());
        let found = Found {
            message,
            help,
            labels,
        };
        Diagnostic { log: self, found }
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

    /// Records that the file uses the former name of something.
    pub(crate) fn warn_renamed(&self, former: &str, current: &str, span: Span) {
        let renamed = (former.to_owned(), current.to_owned(), span);
        self.renamed.borrow_mut().push(renamed);
    }

    /// The former name that stands at `span`, if one does.
    pub(crate) fn former_name_at(&self, span: &Span) -> Option<String> {
        let renamed = self.renamed.borrow();
        let found = renamed.iter().find(|(.., at)| at == span);
        found.map(|(former, ..)| former.clone())
    }

    /// One warning for each former name, at its first use, in the order of the file.
    pub(crate) fn warnings(&self) -> Vec<SceneWarning> {
        let mut renamed = self.renamed.borrow_mut();
        renamed.sort_by_key(|(.., span)| span.start);
        let mut known = HashSet::new();
        let first = renamed
            .iter()
            .filter(|(former, current, _)| known.insert((former, current)));
        let warning = |(former, current, span): &(String, String, Span)| {
            SceneWarning::renamed(&self.source, former, current, span.clone())
        };
        first.map(warning).collect()
    }

    /// How many there are: a part of the file was read well if its reading did not change this.
    pub(crate) fn count(&self) -> usize {
        self.found.borrow().len() + self.suppressed.get()
    }

    fn full(&self) -> bool {
        self.found.borrow().len() >= MAX_REPORTED
    }

    /// What to try instead of `wrong`: the nearest of the names, or else their list. `kind` is
    /// what they are, in the plural.
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

    /// The report, or nothing if all is well.
    pub(crate) fn to_error(&self) -> Option<SceneError> {
        let mut found = self.found.take();
        // In the order of the file, whatever order the sections were read in.
        found.sort_by_key(|p| p.labels.first().map_or(0, |(span, _)| span.start));
        let single = |p: Found| SceneError::with_labels(&self.source, p.message, p.help, p.labels);
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
