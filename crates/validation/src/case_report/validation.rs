//! The result of validating a case.

use dwell_findings::Check;
use dwell_study::Outcome;

/// A validated case.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Validation {
    /// Summary, files and findings.
    pub outcome: Outcome,
    /// Values to the digits that every machine reproduces, and which findings pass.
    pub snapshot: String,
    /// The checks without findings, and in a few words why.
    pub not_applicable: Vec<(Check, &'static str)>,
}
