//! Plain results of a check: what was compared, where, how far apart, the tolerance and the verdict.
//! The types are shared by the crates that make findings and those that print them, and depend on neither.
//!
//! ```
//! use dwell_findings::{Check, Finding, all_pass};
//!
//! let finding = Finding {
//!     key: "power".into(),
//!     check: Check::Power,
//!     relative_difference: 2e-13,
//!     tolerance: 1e-12,
//!     pass: true,
//!     ..Finding::default()
//! };
//! assert_eq!(finding.check.to_string(), "4 power");
//! assert!(all_pass(&[finding]));
//! ```

mod check;
mod long_table;
mod record;
mod table;

pub use check::Check;
pub use long_table::LongTable;
pub use record::{Record, RecordedEvent, RecordedExtrema, RecordedNumber};
pub use table::{Column, Table};

/// One comparison of a result with an independent reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Short stable key, such as `m-energy`.
    pub key: String,
    /// The independent check that it belongs to.
    pub check: Check,
    /// The compared quantities.
    pub comparison: String,
    /// The positions or times of the comparison.
    pub domain: String,
    /// The largest absolute difference, in `unit`.
    pub absolute_difference: f64,
    /// Unit of the absolute difference.
    pub unit: String,
    /// The largest difference relative to `scale`.
    pub relative_difference: f64,
    /// The quantity to which the difference is relative.
    pub scale: String,
    /// Where the largest difference occurred, such as `phi = 1.3 rad, slide.normal`.
    pub worst_at: String,
    /// The bound on the compared difference (the relative one unless `scale` says otherwise).
    pub tolerance: f64,
    /// The reason for the tolerance.
    pub tolerance_reason: String,
    /// Condition number of the scaled constraint Jacobian there; 1 if it does not apply.
    pub condition_number: f64,
    /// Whether the checked value was integrated in time: its error is then a factor times the integrator's
    /// tolerance, not rounding.
    pub integrated: bool,
    /// The verdict: the difference is finite and within the tolerance.
    pub pass: bool,
}

/// The largest admissible tolerance, in multiples of the measured difference, and of the machine epsilon times the condition number. With
/// a larger one the check would miss errors that it can detect.
const MAX_TOLERANCE_FACTOR: f64 = 100.0;
const MAX_ROUNDINGS: f64 = 50.0;

impl Default for Finding {
    /// Nothing compared yet: a failure.
    fn default() -> Self {
        Self {
            key: String::new(),
            check: Check::default(),
            comparison: String::new(),
            domain: String::new(),
            absolute_difference: f64::NAN,
            unit: String::new(),
            relative_difference: f64::NAN,
            scale: "none".to_owned(),
            worst_at: String::new(),
            tolerance: 0.0,
            tolerance_reason: String::new(),
            condition_number: 1.0,
            integrated: false,
            pass: false,
        }
    }
}

impl Finding {
    /// The finding of an absolute and a relative difference, which passes if the relative one is within the
    /// tolerance; its texts are empty.
    pub fn new(key: &str, check: Check, [absolute, relative]: [f64; 2], tolerance: f64) -> Self {
        Self {
            key: key.to_owned(),
            check,
            absolute_difference: absolute,
            relative_difference: relative,
            tolerance,
            pass: relative <= tolerance,
            ..Self::default()
        }
    }

    /// The largest admissible tolerance: 100 times the measured difference plus 50 machine epsilons times the
    /// condition number.
    pub fn max_tolerance(&self) -> f64 {
        MAX_TOLERANCE_FACTOR * self.relative_difference
            + MAX_ROUNDINGS * f64::EPSILON * self.condition_number
    }

    /// Whether the tolerance is above [`Finding::max_tolerance`]. Integrated results are exempt, since slopes and
    /// factors of the integrator's tolerance decide on them; a finding that compared nothing is never loose.
    pub fn is_loose(&self) -> bool {
        !self.integrated && self.tolerance > self.max_tolerance()
    }

    /// Replaces the tolerance and its reason, and updates the verdict. A finding that compared nothing still fails.
    pub fn set_tolerance(&mut self, tolerance: f64, reason: &str) {
        self.tolerance = tolerance;
        self.tolerance_reason = reason.to_owned();
        self.pass = self.relative_difference <= tolerance;
    }
}

/// Whether every finding passed.
pub fn all_pass(findings: &[Finding]) -> bool {
    findings.iter().all(|f| f.pass)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding_of(relative: f64, tolerance: f64) -> Finding {
        Finding {
            relative_difference: relative,
            tolerance,
            check: Check::ReleasedConstraint,
            ..Finding::default()
        }
    }

    #[test]
    fn a_tolerance_is_loose_above_a_hundred_differences_and_fifty_roundings() {
        assert!(!finding_of(1e-12, 1e-10).is_loose());
        assert!(finding_of(1e-12, 1.1e-10).is_loose());
        // Without a difference, 50 rounding errors are allowed: 1.1e-14 times the condition number.
        assert!(!finding_of(0.0, 1e-14).is_loose() && finding_of(0.0, 1.2e-14).is_loose());
        let ill_conditioned = Finding {
            condition_number: 1e3,
            ..finding_of(0.0, 1e-11)
        };
        assert!(!ill_conditioned.is_loose());
        let integrated = Finding {
            integrated: true,
            ..finding_of(1e-12, 1e-8)
        };
        assert!(!integrated.is_loose());
    }

    #[test]
    fn another_tolerance_changes_the_verdict_unless_nothing_was_compared() {
        let mut finding = finding_of(1e-12, 1e-10);
        finding.set_tolerance(1e-11, "measured");
        assert!(finding.pass);
        finding.set_tolerance(1e-13, "measured");
        assert!(!finding.pass);
        finding.relative_difference = f64::NAN;
        finding.set_tolerance(1.0, "measured");
        assert!(!finding.pass);
    }
}
