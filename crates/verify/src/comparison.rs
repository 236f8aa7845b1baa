//! From single differences to a verdict.

use crate::subject::SubjectError;
use dwell_findings::{Check, Finding};

/// How much of the reference's own estimated error the tolerance allows for.
const REFERENCE_ERROR_FACTOR: f64 = 10.0;
/// Where the truth itself is worse than this it decides nothing, and the finding fails.
const MAX_WIDENED_TOLERANCE: f64 = 1e-6;

/// The largest difference met so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct LargestDifference {
    absolute_difference: f64,
    relative_difference: f64,
    unit: &'static str,
    worst_at: String,
    reference_error: f64,
    condition_number: f64,
    count: usize,
    failure: Option<String>,
}

/// One comparison.
pub(crate) struct Comparison {
    /// Subject less truth.
    pub(crate) difference: f64,
    /// What it is relative to.
    pub(crate) scale: f64,
    /// The reference's own estimated error, in the unit of the difference.
    pub(crate) reference_error: f64,
    /// The unit.
    pub(crate) unit: &'static str,
    /// Condition number of the dense rows there; 1 where it has no meaning.
    pub(crate) condition_number: f64,
}

impl LargestDifference {
    /// Takes a comparison in; the place is only written down if it is the worst.
    pub(crate) fn record(&mut self, comparison: &Comparison, location: impl FnOnce() -> String) {
        let over_scale = |value: f64| match value.abs() {
            // Zero agrees with zero even where nothing gives a scale.
            0.0 => 0.0,
            size => size / comparison.scale,
        };
        let relative_difference = over_scale(comparison.difference);
        self.count += 1;
        self.reference_error = self
            .reference_error
            .max(over_scale(comparison.reference_error));
        if self.count == 1 || is_worse(relative_difference, self.relative_difference) {
            self.absolute_difference = comparison.difference.abs();
            self.relative_difference = relative_difference;
            self.unit = comparison.unit;
            self.condition_number = comparison.condition_number;
            self.worst_at = location();
        }
    }

    /// Records that something could not be compared at all, which fails the finding.
    pub(crate) fn record_failure(&mut self, message: String) {
        self.failure.get_or_insert(message);
    }

    /// Records that the subject failed to answer.
    pub(crate) fn record_error(&mut self, error: &SubjectError) {
        self.record_failure(format!("the subject failed to answer: {error}"));
    }

    /// The worse of two.
    pub(crate) fn merge(mut self, other: Self) -> Self {
        let other_is_worse = other.count > 0
            && (self.count == 0 || is_worse(other.relative_difference, self.relative_difference));
        let (count, reference_error) = (
            self.count + other.count,
            self.reference_error.max(other.reference_error),
        );
        let failure = self.failure.take().or(other.failure.clone());
        let larger = if other_is_worse { other } else { self };
        Self {
            count,
            reference_error,
            failure,
            ..larger
        }
    }
}

/// Whether `new` is worse than `old`. What is not a number is the worst there is, and stays.
fn is_worse(new: f64, old: f64) -> bool {
    !old.is_nan() && (new.is_nan() || new > old)
}

/// The constant texts of a finding, and its tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FindingSpec<'a> {
    /// Short stable key.
    pub key: &'static str,
    /// The check that it belongs to.
    pub check: Check,
    /// What is compared with what.
    pub comparison: &'static str,
    /// What the relative difference is relative to.
    pub scale: &'static str,
    /// Largest relative difference allowed.
    pub tolerance: f64,
    /// Why the tolerance is what it is.
    pub tolerance_reason: &'a str,
}

impl FindingSpec<'_> {
    /// The finding over a domain. Ten times the reference's own estimated error replaces the tolerance
    /// where it is larger, up to a limit: next to a dead point every difference is inaccurate, and a
    /// finding must judge the subject, not the reference. The reason of the tolerance says so.
    pub(crate) fn finding(&self, domain: String, worst: LargestDifference) -> Finding {
        let widened = (REFERENCE_ERROR_FACTOR * worst.reference_error).min(MAX_WIDENED_TOLERANCE);
        let tolerance = self.tolerance.max(widened);
        let mut tolerance_reason = self.tolerance_reason.to_owned();
        if worst.reference_error > 0.0 {
            tolerance_reason.push_str(&format!(
                "; own estimated error {:.0e}",
                worst.reference_error
            ));
        }
        if tolerance > self.tolerance {
            tolerance_reason.push_str(&format!(
                ", ten times which replaces the usual {:.0e}",
                self.tolerance
            ));
        }
        let mut finding = Finding {
            key: self.key.into(),
            check: self.check,
            comparison: self.comparison.into(),
            domain,
            absolute_difference: worst.absolute_difference,
            unit: worst.unit.into(),
            relative_difference: worst.relative_difference,
            scale: self.scale.into(),
            worst_at: worst.worst_at,
            tolerance,
            tolerance_reason,
            condition_number: worst.condition_number.max(1.0),
            integrated: false,
            pass: worst.count > 0 && worst.relative_difference <= tolerance,
        };
        let failure = match worst.failure {
            None if worst.count == 0 => Some("nothing could be compared".to_owned()),
            failure => failure,
        };
        if let Some(message) = failure {
            finding.pass = false;
            finding.absolute_difference = f64::NAN;
            finding.relative_difference = f64::NAN;
            finding.worst_at = message;
        }
        finding
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEC: FindingSpec<'_> = FindingSpec {
        key: "k",
        check: Check::ConstraintClosure,
        comparison: "this with that",
        scale: "one",
        tolerance: 1e-9,
        tolerance_reason: "because",
    };

    fn finding(worst: LargestDifference) -> Finding {
        SPEC.finding("all".into(), worst)
    }

    fn worst(differences: &[f64], reference_error: f64) -> LargestDifference {
        let mut worst = LargestDifference::default();
        for &difference in differences {
            let comparison = Comparison {
                difference,
                scale: 2.0,
                reference_error,
                unit: "N",
                condition_number: 1.0,
            };
            worst.record(&comparison, || format!("at {difference}"));
        }
        worst
    }

    #[test]
    fn the_largest_is_kept_whatever_the_order() {
        for differences in [[1e-10, -4e-9, 1e-9], [-4e-9, 1e-9, 1e-10]] {
            let [a, b, c] = differences.map(|d| worst(&[d], 0.0));
            let finding = self::finding(a.merge(b).merge(c));
            assert_eq!(
                (finding.absolute_difference, finding.relative_difference),
                (4e-9, 2e-9)
            );
            assert_eq!(finding.worst_at, "at -0.000000004");
            assert!(!finding.pass);
        }
        assert!(finding(worst(&[1e-9], 0.0)).pass);
    }

    #[test]
    fn not_a_number_and_nothing_fail() {
        for differences in [&[f64::NAN, 1e-12][..], &[1e-12, f64::NAN], &[]] {
            assert!(!finding(worst(differences, 0.0)).pass);
        }
        let merged = worst(&[f64::NAN], 0.0).merge(worst(&[1.0], 0.0));
        assert!(finding(merged).relative_difference.is_nan());
        let merged = worst(&[1.0], 0.0).merge(worst(&[f64::NAN], 0.0));
        assert!(finding(merged).relative_difference.is_nan());
    }

    #[test]
    fn a_refusal_fails_and_is_told() {
        let mut refused = worst(&[0.0], 0.0);
        refused.record_failure("no answer".into());
        let finding = self::finding(worst(&[0.0], 0.0).merge(refused));
        assert!(!finding.pass);
        assert_eq!(finding.worst_at, "no answer");
    }

    #[test]
    fn a_blunt_truth_widens_its_tolerance_but_not_for_ever() {
        assert!(finding(worst(&[1e-8], 1e-8)).pass);
        assert!(!finding(worst(&[1e-4], 1e-2)).pass);
    }
}
