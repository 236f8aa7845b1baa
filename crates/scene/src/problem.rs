//! Gathering the errors of a file, so that one report holds them all.

use crate::error::{SceneError, Source};
use crate::names::nearest;
use std::fmt::Write as _;
use std::ops::Range;

/// Bytes of the text.
pub(crate) type Span = Range<usize>;

/// Errors reported at once. A file can be wrong twenty thousand times over, a reader cannot.
const MOST: usize = 40;
/// Names listed in one message.
const LISTED: usize = 16;

/// One thing that is wrong.
#[derive(Debug)]
pub(crate) struct Problem {
    message: String,
    help: Option<String>,
    labels: Vec<(Span, String)>,
}

impl Problem {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            help: None,
            labels: Vec::new(),
        }
    }

    pub(crate) fn at(mut self, span: Span, label: impl Into<String>) -> Self {
        self.labels.push((span, label.into()));
        self
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    fn into_error(self, source: &Source) -> SceneError {
        SceneError::at(source, self.message, self.help, self.labels)
    }
}

/// Everything that is wrong with one file.
#[derive(Debug)]
pub(crate) struct Problems {
    source: Source,
    found: Vec<Problem>,
    untold: usize,
}

impl Problems {
    pub(crate) fn of(source: &Source) -> Self {
        Self {
            source: Source::clone(source),
            found: Vec::new(),
            untold: 0,
        }
    }

    /// Where in the file a part of a string is. A string with escapes does not stand in the file
    /// as it reads: then it is the whole of it.
    pub(crate) fn within(&self, string: &Span, text: &str, part: Span) -> Span {
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

    pub(crate) fn push(&mut self, problem: Problem) {
        if self.full() {
            self.untold += 1;
        } else {
            self.found.push(problem);
        }
    }

    /// How many there are: a part of the file was read well if its reading did not change this.
    pub(crate) fn count(&self) -> usize {
        self.found.len() + self.untold
    }

    fn full(&self) -> bool {
        self.found.len() >= MOST
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
        let untold = self.untold;
        let mut errors: Vec<_> = self
            .found
            .into_iter()
            .map(|p| p.into_error(&self.source))
            .collect();
        if errors.len() < 2 {
            return errors.pop();
        }
        let mut message = format!("the scene has {} errors", errors.len() + untold);
        if untold > 0 {
            let _ = write!(message, "; here are {MOST} of them");
        }
        let mut all = SceneError::bare(message, None);
        all.text = Some(self.source);
        all.others = errors;
        Some(all)
    }
}

/// What to try instead of the name `wrong`: the nearest of `names`, or else their list. `kind` is
/// what they are, in the plural.
pub fn choices<'n>(
    wrong: &str,
    kind: &str,
    names: impl Iterator<Item = &'n str> + Clone,
) -> String {
    match nearest(wrong, names.clone()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => match (list(names.clone()), names.count()) {
            (None, _) => format!("there are no {kind}"),
            (Some(only), 1) => format!("of the {kind} there is only {only}"),
            (Some(list), _) => format!("the {kind} are {list}"),
        },
    }
}

/// "`a`, `b` and `c`", cut short if long; nothing if there is none.
pub(crate) fn list<'n>(mut names: impl Iterator<Item = &'n str>) -> Option<String> {
    let mut text = format!("`{}`", names.next()?);
    let mut last = None;
    for (k, name) in names.enumerate() {
        if k + 1 == LISTED {
            text.push_str(", …");
            return Some(text);
        }
        if let Some(previous) = last.replace(name) {
            let _ = write!(text, ", `{previous}`");
        }
    }
    if let Some(name) = last {
        let _ = write!(text, " and `{name}`");
    }
    Some(text)
}
