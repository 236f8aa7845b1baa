//! Plain results of a check: what was compared, where, how far apart, the tolerance and the verdict.

use serde::Serialize;

/// One comparison of a result with an independent truth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Short stable key, such as `m-energy`.
    pub key: String,
    /// Which truth of the workbench it rests on, such as `2 finite differences`.
    pub truth: String,
    /// What was compared with what, in words, with the equation.
    pub compared: String,
    /// Over which positions or times.
    pub over: String,
    /// The largest absolute difference, in `unit`.
    pub absolute: f64,
    /// Unit of the absolute difference.
    pub unit: String,
    /// The largest difference relative to `scale`.
    pub relative: f64,
    /// What the relative difference is relative to, in words.
    pub scale: String,
    /// Where the largest difference was met, such as `phi = 1.3 rad, slide.normal`.
    pub worst: String,
    /// The bound on the judged difference (the relative one unless `scale` says otherwise).
    pub tolerance: f64,
    /// Why the tolerance is what it is.
    pub why: String,
    /// The verdict: the difference is finite and within the tolerance.
    pub pass: bool,
}

/// Whether every finding passed.
pub fn all_pass(findings: &[Finding]) -> bool {
    findings.iter().all(|f| f.pass)
}
