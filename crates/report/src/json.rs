//! JSON in which a number that is not finite keeps its name.

use crate::error::ReportError;
use dwell_findings::Finding;
use serde::{Serialize, Serializer};

/// The value as indented JSON with a line end. Its numbers must be of type [`Number`]: JSON has no NaN and no
/// infinity, and `serde_json` writes a bare `f64` that is not finite as `null`, which readers take for "not computed".
///
/// # Errors
///
/// [`ReportError::Json`] if the value cannot be JSON, such as a map whose keys are lists.
pub fn json<T: Serialize + ?Sized>(value: &T) -> Result<String, ReportError> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}

/// A number of a JSON document: one that is not finite becomes `"NaN"`, `"inf"` or `"-inf"`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number(pub f64);

impl From<f64> for Number {
    fn from(value: f64) -> Self {
        Self(value)
    }
}

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            v if v.is_finite() => serializer.serialize_f64(v),
            v if v.is_nan() => serializer.serialize_str("NaN"),
            v if v > 0.0 => serializer.serialize_str("inf"),
            _ => serializer.serialize_str("-inf"),
        }
    }
}

/// A finding as it stands in JSON documents: its fields are their keys.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FindingRecord<'a> {
    key: &'a str,
    check: String,
    comparison: &'a str,
    domain: &'a str,
    absolute_difference: Number,
    unit: &'a str,
    relative_difference: Number,
    scale: &'a str,
    worst_at: &'a str,
    tolerance: Number,
    tolerance_reason: &'a str,
    condition_number: Number,
    integrated: bool,
    pass: bool,
}

impl<'a> From<&'a Finding> for FindingRecord<'a> {
    fn from(finding: &'a Finding) -> Self {
        Self {
            key: &finding.key,
            check: finding.check.to_string(),
            comparison: &finding.comparison,
            domain: &finding.domain,
            absolute_difference: finding.absolute_difference.into(),
            unit: &finding.unit,
            relative_difference: finding.relative_difference.into(),
            scale: &finding.scale,
            worst_at: &finding.worst_at,
            tolerance: finding.tolerance.into(),
            tolerance_reason: &finding.tolerance_reason,
            condition_number: finding.condition_number.into(),
            integrated: finding.integrated,
            pass: finding.pass,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_not_finite_is_named() {
        let numbers = [0.1, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e-300];
        let text = json(&numbers.map(Number)).unwrap();
        let read: serde_json::Value = serde_json::from_str(&text).unwrap();
        let expected = serde_json::json!([0.1, "NaN", "inf", "-inf", 1e-300]);
        assert_eq!(read, expected);
    }

    #[test]
    fn no_number_of_a_finding_is_null() {
        let finding = Finding {
            tolerance: f64::NAN,
            condition_number: f64::INFINITY,
            ..Finding::default()
        };
        let text = json(&FindingRecord::from(&finding)).unwrap();
        assert!(!text.contains("null") && text.contains("\"inf\""), "{text}");
    }
}
