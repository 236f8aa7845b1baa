//! What becomes of the parts of a file: each with its line.

use std::cell::RefCell;
use std::fmt;
use std::rc::Rc;
use std::sync::Arc;

/// What becomes of parts that act only at a limit, and of parts that change the motion.
pub(crate) const AT_LIMITS: &str = "left out (acts only at a limit)";
pub(crate) const LOST: &str = "left out (changes the motion)";

/// What leaving a part of a file out, or keeping it, means for the results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effect {
    /// It is in the scene, perhaps in another form.
    Kept,
    /// It is left out, and no motion and no force depends on it.
    Nothing,
    /// It is left out; it acts only where a limit is reached.
    AtLimits,
    /// It is left out, and a motion or a force may depend on it.
    Changes,
}

/// One sentence about a part of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// The file, as its path was given.
    pub file: Arc<str>,
    /// The line of the part; 0 for the file as a whole.
    pub line: usize,
    /// The part, and what became of it.
    pub text: String,
    /// What this means.
    pub effect: Effect,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}: {}", self.file, self.text),
            line => write!(f, "{}:{line}: {}", self.file, self.text),
        }
    }
}

/// All findings of an import, shared by its steps.
pub(crate) type Findings = Rc<RefCell<Vec<Finding>>>;

/// The findings, those of the first file first, by their lines.
pub(crate) fn sorted(findings: &Findings) -> Vec<Finding> {
    let mut all = findings.borrow().clone();
    let files: Vec<_> = all.iter().map(|one| Arc::clone(&one.file)).collect();
    all.sort_by_key(|one| (files.iter().position(|file| *file == one.file), one.line));
    all.dedup();
    all
}

/// A place in a file, at which findings are noted.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pub(crate) file: Arc<str>,
    pub(crate) line: usize,
    pub(crate) findings: Findings,
}

impl Place {
    pub(crate) fn note(&self, effect: Effect, text: impl Into<String>) {
        self.findings.borrow_mut().push(Finding {
            file: Arc::clone(&self.file),
            line: self.line,
            text: text.into(),
            effect,
        });
    }

    pub(crate) fn kept(&self, text: impl Into<String>) {
        self.note(Effect::Kept, text);
    }

    /// Something that changes the motion is left out.
    pub(crate) fn lost(&self, what: impl fmt::Display) {
        self.note(Effect::Changes, format!("{what}: {LOST}"));
    }
}
