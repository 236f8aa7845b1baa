//! The finding that summarises single differences.

use crate::subject::SubjectError;
use dwell_findings::{Check, Finding};

/// How much of the reference's own estimated error the tolerance allows for.
const REFERENCE_ERROR_FACTOR: f64 = 10.0;
/// If the error of the check itself is larger than this, the check is inconclusive and the finding fails.
const MAX_WIDENED_TOLERANCE: f64 = 1e-6;

/// The largest of several differences.
#[derive(Debug, Clone, Default)]
pub struct LargestDifference {
    absolute_difference: f64,
    /// The largest difference, relative to its scale.
    pub relative_difference: f64,
    unit: &'static str,
    worst_at: String,
    reference_error: f64,
    condition_number: f64,
    /// How many were compared.
    pub count: usize,
    /// Why something could not be compared.
    pub failure: Option<String>,
}

/// One comparison.
#[derive(Debug, Clone, Copy)]
pub struct Comparison {
    /// The difference of the subject from the reference, its scale, and the reference's own estimated error.
    pub(crate) numbers: [f64; 3],
    /// The unit of all three.
    pub(crate) unit: &'static str,
    /// Condition number of the dense rows there; 1 if it has no meaning.
    pub(crate) condition_number: f64,
}

impl Comparison {
    /// A difference with its scale and the reference's own error, all in `unit`.
    pub fn new(numbers: [f64; 3], unit: &'static str, condition_number: f64) -> Self {
        Self {
            numbers,
            unit,
            condition_number,
        }
    }
}

impl LargestDifference {
    /// A failure without any comparison.
    pub(crate) fn failed(message: String) -> Self {
        Self {
            failure: Some(message),
            ..Self::default()
        }
    }

    /// Adds a comparison; its location is only composed if it is the worst.
    pub fn record(&mut self, comparison: &Comparison, location: impl FnOnce() -> String) {
        let [difference, scale, reference_error] = comparison.numbers;
        let over_scale = |value: f64| match value.abs() {
            // Zero agrees with zero even where nothing gives a scale.
            0.0 => 0.0,
            size => size / scale,
        };
        let relative = over_scale(difference);
        self.count += 1;
        self.reference_error = self.reference_error.max(over_scale(reference_error));
        if self.count == 1 || is_worse(relative, self.relative_difference) {
            self.absolute_difference = difference.abs();
            self.relative_difference = relative;
            self.unit = comparison.unit;
            self.condition_number = comparison.condition_number;
            self.worst_at = location();
        }
    }

    /// Records that something could not be compared at all, which fails the finding.
    pub fn record_failure(&mut self, message: String) {
        self.failure.get_or_insert(message);
    }

    /// Records that the subject failed.
    pub(crate) fn record_error(&mut self, error: &SubjectError) {
        self.record_failure(format!("the subject failed: {error}"));
    }

    /// The worse of two, of several quantities.
    pub(crate) fn merge_each<const N: usize>(these: [Self; N], others: [Self; N]) -> [Self; N] {
        let mut others = others.into_iter();
        these.map(|one| one.merge(others.next().unwrap_or_default()))
    }

    /// The worse of two.
    #[must_use]
    pub fn merge(mut self, other: Self) -> Self {
        let count = self.count + other.count;
        let reference_error = self.reference_error.max(other.reference_error);
        let failure = self.failure.take().or(other.failure.clone());
        let other_is_worse = other.count > 0
            && (self.count == 0 || is_worse(other.relative_difference, self.relative_difference));
        Self {
            count,
            reference_error,
            failure,
            ..if other_is_worse { other } else { self }
        }
    }
}

/// Whether `new` is worse than `old`. NaN is the worst, and is kept.
fn is_worse(new: f64, old: f64) -> bool {
    !old.is_nan() && (new.is_nan() || new > old)
}

/// Comparisons of one kind and unit. Their common scale, the largest of all, is known only when the set is complete.
#[derive(Default)]
pub(crate) struct ComparisonSet {
    pub(crate) scale: f64,
    comparisons: Vec<(Comparison, String)>,
    /// Whether each is checked by its own scale.
    individual_scales: bool,
}

impl ComparisonSet {
    /// A balance must hold in every state, however small its terms are there.
    pub(crate) fn with_individual_scales() -> Self {
        Self {
            individual_scales: true,
            ..Self::default()
        }
    }

    /// Adds a comparison, whose scale is a lower bound of the common scale.
    pub(crate) fn add(&mut self, comparison: Comparison, location: String) {
        // A maximum drops what is not a number, but then the difference is not one either.
        self.scale = self.scale.max(comparison.numbers[1]);
        self.comparisons.push((comparison, location));
    }

    /// The largest difference relative to the scale.
    pub(crate) fn largest(self) -> LargestDifference {
        let mut worst = LargestDifference::default();
        for (mut comparison, location) in self.comparisons {
            if !self.individual_scales {
                comparison.numbers[1] = self.scale;
            }
            worst.record(&comparison, || location);
        }
        worst
    }
}

/// The constant texts of a finding, and its tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FindingSpec<'a> {
    /// Short stable key.
    pub key: &'a str,
    /// The check of the finding.
    pub check: Check,
    /// The two compared quantities, in words.
    pub comparison: &'a str,
    /// The scale of the relative difference, in words.
    pub scale: &'a str,
    /// Largest relative difference allowed.
    pub tolerance: f64,
    /// The reason for the tolerance.
    pub tolerance_reason: &'a str,
}

impl FindingSpec<'_> {
    /// The finding over a domain. Ten times the estimated error of the reference replaces the tolerance if it is
    /// larger, up to a limit: next to a dead point every difference is inaccurate, and a finding must check the
    /// subject, not the reference. The reason of the tolerance then states this.
    pub fn finding(&self, domain: String, worst: LargestDifference) -> Finding {
        let widened = (REFERENCE_ERROR_FACTOR * worst.reference_error).min(MAX_WIDENED_TOLERANCE);
        let tolerance = self.tolerance.max(widened);
        let mut reason = self.tolerance_reason.to_owned();
        if worst.reference_error > 0.0 {
            reason += &format!("; own estimated error {:.0e}", worst.reference_error);
        }
        if tolerance > self.tolerance {
            let usual = self.tolerance;
            reason += &format!(", ten times which replaces the usual {usual:.0e}");
        }
        let none = || "nothing could be compared".to_owned();
        let failure = worst.failure.or_else(|| (worst.count == 0).then(none));
        let numbers = match failure {
            Some(_) => [f64::NAN; 2],
            None => [worst.absolute_difference, worst.relative_difference],
        };
        Finding {
            comparison: self.comparison.into(),
            domain,
            unit: worst.unit.into(),
            scale: self.scale.into(),
            worst_at: failure.unwrap_or(worst.worst_at),
            tolerance_reason: reason,
            condition_number: worst.condition_number.max(1.0),
            ..Finding::new(self.key, self.check, numbers, tolerance)
        }
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
                numbers: [difference, 2.0, reference_error],
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
    fn a_refusal_fails_with_its_message() {
        let mut refused = worst(&[0.0], 0.0);
        refused.record_failure("no answer".into());
        let finding = self::finding(worst(&[0.0], 0.0).merge(refused));
        assert!(!finding.pass);
        assert_eq!(finding.worst_at, "no answer");
    }

    #[test]
    fn an_inaccurate_check_widens_its_tolerance_up_to_a_limit() {
        assert!(finding(worst(&[1e-8], 1e-8)).pass);
        assert!(!finding(worst(&[1e-4], 1e-2)).pass);
    }
}
