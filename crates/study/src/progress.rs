//! The progress callback of long computations.

/// A step of a long computation.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    /// Total number of steps.
    pub total: usize,
    /// The step just completed.
    pub done: &'a str,
}

/// Called after each step, from any thread.
pub type Progress<'a> = &'a (dyn Fn(Step<'_>) + Sync);

/// Ignores progress.
pub fn no_progress(_: Step<'_>) {}
