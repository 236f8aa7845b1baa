//! The result of an analysis as text and files.

use dwell_findings::Finding;
use dwell_report::Files;

/// The result of an analysis, in memory: nothing is written until the caller writes the files.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcome {
    /// Text to print.
    pub summary: String,
    /// Files to write, relative to the output folder.
    pub files: Files,
    /// Results of checks.
    pub findings: Vec<Finding>,
}
