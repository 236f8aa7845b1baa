//! JSON with names for numbers that are not finite.

use crate::error::ReportError;
use dwell_findings::Finding;
use serde::ser::SerializeStruct as _;
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
#[derive(Debug, Clone, PartialEq)]
pub struct FindingRecord<'a>(pub &'a Finding);

impl Serialize for FindingRecord<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let f = self.0;
        let mut record = serializer.serialize_struct("Finding", 14)?;
        record.serialize_field("key", &f.key)?;
        record.serialize_field("check", &f.check.to_string())?;
        record.serialize_field("comparison", &f.comparison)?;
        record.serialize_field("domain", &f.domain)?;
        record.serialize_field("absolute_difference", &Number(f.absolute_difference))?;
        record.serialize_field("unit", &f.unit)?;
        record.serialize_field("relative_difference", &Number(f.relative_difference))?;
        record.serialize_field("scale", &f.scale)?;
        record.serialize_field("worst_at", &f.worst_at)?;
        record.serialize_field("tolerance", &Number(f.tolerance))?;
        record.serialize_field("tolerance_reason", &f.tolerance_reason)?;
        record.serialize_field("condition_number", &Number(f.condition_number))?;
        record.serialize_field("integrated", &f.integrated)?;
        record.serialize_field("pass", &f.pass)?;
        record.end()
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
        let text = json(&FindingRecord(&finding)).unwrap();
        assert!(!text.contains("null") && text.contains("\"inf\""), "{text}");
    }
}
