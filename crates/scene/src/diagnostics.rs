//! Gathering the errors of a file, so that one report holds them all.

use crate::error::{SceneError, SceneWarning, Source};
use crate::wording::choices;
use std::collections::HashSet;
use std::fmt::Write as _;
use std::ops::Range;

/// Bytes of the text.
pub(crate) type Span = Range<usize>;

/// Errors reported at once. A file can be wrong twenty thousand times over, a reader cannot.
const MAX_REPORTED: usize = 40;

/// One thing that is wrong.
#[derive(Debug)]
pub(crate) struct Diagnostic {
    message: String,
    help: Option<String>,
    labels: Vec<(Span, String)>,
}

impl Diagnostic {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            help: None,
            labels: Vec::new(),
        }
    }

    pub(crate) fn label(mut self, span: Span, label: impl Into<String>) -> Self {
        self.labels.push((span, label.into()));
        self
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    fn into_error(self, source: &Source) -> SceneError {
        SceneError::with_labels(source, self.message, self.help, self.labels)
    }
}

/// Everything that is wrong with one file.
#[derive(Debug)]
pub(crate) struct Diagnostics {
    source: Source,
    found: Vec<Diagnostic>,
    /// Former names that the file uses: the name, what it is called now, where it stands.
    renamed: Vec<(String, String, Span)>,
    suppressed: usize,
}

impl Diagnostics {
    pub(crate) fn new(source: &Source) -> Self {
        Self {
            source: Source::clone(source),
            found: Vec::new(),
            renamed: Vec::new(),
            suppressed: 0,
        }
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

    pub(crate) fn push(&mut self, diagnostic: Diagnostic) {
        if self.full() {
            self.suppressed += 1;
        } else {
            self.found.push(diagnostic);
        }
    }

    /// Records that the file uses the former name of something.
    pub(crate) fn warn_renamed(&mut self, former: &str, current: &str, span: Span) {
        self.renamed
            .push((former.to_owned(), current.to_owned(), span));
    }

    /// One warning for each former name, at its first use, in the order of the file.
    pub(crate) fn warnings(&mut self) -> Vec<SceneWarning> {
        self.renamed.sort_by_key(|(.., span)| span.start);
        let mut known = HashSet::new();
        let first = self
            .renamed
            .iter()
            .filter(|(former, current, _)| known.insert((former, current)));
        first
            .map(|(former, current, span)| {
                SceneWarning::renamed(&self.source, former, current, span.clone())
            })
            .collect()
    }

    /// How many there are: a part of the file was read well if its reading did not change this.
    pub(crate) fn count(&self) -> usize {
        self.found.len() + self.suppressed
    }

    fn full(&self) -> bool {
        self.found.len() >= MAX_REPORTED
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
    pub(crate) fn into_error(mut self) -> Option<SceneError> {
        // In the order of the file, whatever order the sections were read in.
        self.found
            .sort_by_key(|p| p.labels.first().map_or(0, |(span, _)| span.start));
        let suppressed = self.suppressed;
        let mut errors: Vec<_> = self
            .found
            .into_iter()
            .map(|p| p.into_error(&self.source))
            .collect();
        if errors.len() < 2 {
            return errors.pop();
        }
        let mut message = format!("the scene has {} errors", errors.len() + suppressed);
        if suppressed > 0 {
            let _ = write!(message, "; here are {MAX_REPORTED} of them");
        }
        let mut all = SceneError::without_labels(message, None);
        all.text = Some(self.source);
        all.related = errors;
        Some(all)
    }
}
