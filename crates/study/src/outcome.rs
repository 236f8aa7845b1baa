//! What a command yields, and how it tells its progress.

use dwell_findings::Finding;
use dwell_report::Files;

/// What a command yields: nothing is written until the caller writes the files.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcome {
    /// What to print.
    pub summary: String,
    /// What to write, below the folder the user chose.
    pub files: Files,
    /// What was checked.
    pub findings: Vec<Finding>,
}

/// A step of long work.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    /// Steps in all.
    pub total: usize,
    /// What has just been done.
    pub done: &'a str,
}

/// Hears of every step that is done, from any thread.
pub type Progress<'a> = &'a (dyn Fn(Step<'_>) + Sync);

/// Hears nothing.
pub fn silent(_: Step<'_>) {}
