//! Truth 9: values of named quantities at single states, published or computed elsewhere.

use crate::judge::{Check, Reading, Worst};
use dwell_findings::Finding;

/// A quantity at one state, and what it should be there.
#[derive(Debug, Clone, PartialEq)]
pub struct Value {
    /// What is compared and where, such as `k1.acceleration, sample 1`.
    pub place: String,
    /// Its unit.
    pub unit: &'static str,
    /// What the subject has.
    pub got: f64,
    /// What it should be.
    pub wanted: f64,
    /// The largest value of the unit, which the difference is relative to.
    pub scale: f64,
    /// Condition number of the dense rows at the state.
    pub condition: f64,
}

/// The words of a comparison of values.
#[derive(Debug, Clone, PartialEq)]
pub struct Values<'a> {
    /// Key of the finding.
    pub key: &'static str,
    /// Which truth it rests on.
    pub truth: &'static str,
    /// What is compared with what.
    pub compared: &'static str,
    /// Over which states.
    pub over: String,
    /// Largest relative difference allowed.
    pub tolerance: f64,
    /// Why that.
    pub why: &'a str,
}

/// Holds values against what they should be. Nothing to compare fails.
pub fn values(words: Values<'_>, values: &[Value]) -> Finding {
    let mut worst = Worst::default();
    for value in values {
        let reading = Reading {
            difference: value.got - value.wanted,
            scale: value.scale,
            own: 0.0,
            unit: value.unit,
            condition: value.condition,
        };
        worst.meet(&reading, || value.place.clone());
    }
    let finding = Check {
        key: words.key,
        truth: words.truth,
        compared: words.compared,
        over: words.over,
        scale: "the largest value of the same unit",
        tolerance: words.tolerance,
        why: "",
    }
    .judge(worst);
    Finding {
        why: words.why.to_owned(),
        ..finding
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(got: &[f64]) -> Finding {
        let value = |&got: &f64| Value {
            place: "x".into(),
            unit: "N",
            got,
            wanted: 2.0,
            scale: 4.0,
            condition: 1.0,
        };
        let all: Vec<Value> = got.iter().map(value).collect();
        let words = Values {
            key: "k",
            truth: "9",
            compared: "this with that",
            over: "1 sample".into(),
            tolerance: 1e-9,
            why: "because",
        };
        values(words, &all)
    }

    #[test]
    fn a_value_is_held_against_the_largest_of_its_unit() {
        assert!(judged(&[2.0 + 3e-9]).pass);
        let failed = judged(&[2.0, 2.0 - 5e-9]);
        // Rounding of numbers around two.
        assert!(!failed.pass && (failed.relative - 1.25e-9).abs() < 1e-15);
        assert_eq!(failed.why, "because");
    }

    #[test]
    fn what_is_no_number_and_nothing_fail() {
        assert!(!judged(&[2.0, f64::NAN]).pass);
        assert!(!judged(&[]).pass);
    }
}
