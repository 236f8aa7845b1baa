//! What becomes of the parts of a file: each with its line.

use std::cell::RefCell;
use std::fmt;
use std::rc::Rc;
use std::sync::Arc;

/// What leaving a part of a file out, or keeping it, means for the results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
        let Self {
            file, line, text, ..
        } = self;
        match line {
            0 => write!(f, "{file}: {text}"),
            line => write!(f, "{file}:{line}: {text}"),
        }
    }
}

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) file: Arc<str>,
    pub(crate) line: usize,
}

/// All findings of an import, shared by its steps.
#[derive(Debug, Clone, Default)]
pub(crate) struct Findings(Rc<RefCell<Vec<Finding>>>);

impl Findings {
    pub(crate) fn add(&self, place: &Place, effect: Effect, text: impl Into<String>) {
        self.0.borrow_mut().push(Finding {
            file: Arc::clone(&place.file),
            line: place.line,
            text: text.into(),
            effect,
        });
    }

    /// The findings, those of the first file first, by their lines.
    pub(crate) fn sorted(&self) -> Vec<Finding> {
        let mut all = self.0.borrow().clone();
        let files: Vec<_> = all.iter().map(|one| Arc::clone(&one.file)).collect();
        all.sort_by_key(|one| (files.iter().position(|file| *file == one.file), one.line));
        all.dedup();
        all
    }
}
