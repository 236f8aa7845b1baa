//! Check 9: values of named quantities at single states, published or computed elsewhere.

use crate::comparison::{Comparison, FindingSpec, LargestDifference};
use dwell_findings::Finding;

/// A quantity at one state, with its reference value.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedValue {
    /// The quantity and the state, such as `k1.acceleration, sample 1`.
    pub location: String,
    /// Its unit.
    pub unit: &'static str,
    /// The value of the subject.
    pub value: f64,
    /// The reference value.
    pub expected: f64,
    /// The largest value of the unit, which the difference is relative to.
    pub scale: f64,
    /// Condition number of the dense rows at the state.
    pub condition_number: f64,
}

/// Compares values with their references. Without values the finding fails.
pub fn compare_values(spec: &FindingSpec<'_>, domain: String, values: &[ComparedValue]) -> Finding {
    let mut worst = LargestDifference::default();
    for value in values {
        let numbers = [value.value - value.expected, value.scale, 0.0];
        let comparison = Comparison::new(numbers, value.unit, value.condition_number);
        worst.record(&comparison, || value.location.clone());
    }
    spec.finding(domain, worst)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_findings::Check;

    fn finding_for(got: &[f64]) -> Finding {
        let value = |&got: &f64| ComparedValue {
            location: "x".into(),
            unit: "N",
            value: got,
            expected: 2.0,
            scale: 4.0,
            condition_number: 1.0,
        };
        let all: Vec<ComparedValue> = got.iter().map(value).collect();
        let spec = FindingSpec {
            key: "k",
            check: Check::ReferenceValues,
            comparison: "this with that",
            scale: "the largest value of the same unit",
            tolerance: 1e-9,
            tolerance_reason: "because",
        };
        compare_values(&spec, "1 sample".into(), &all)
    }

    #[test]
    fn a_value_is_held_against_the_largest_of_its_unit() {
        assert!(finding_for(&[2.0 + 3e-9]).pass);
        let failed = finding_for(&[2.0, 2.0 - 5e-9]);
        // Rounding of numbers around two.
        assert!(!failed.pass && (failed.relative_difference - 1.25e-9).abs() < 1e-15);
        assert_eq!(failed.tolerance_reason, "because");
    }

    #[test]
    fn what_is_no_number_and_nothing_fail() {
        assert!(!finding_for(&[2.0, f64::NAN]).pass);
        assert!(!finding_for(&[]).pass);
    }
}
