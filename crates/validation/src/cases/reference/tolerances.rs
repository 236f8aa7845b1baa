//! The tolerances of a case, by finding: written from measurement, in place of those of the code.

use super::{number, object};
use crate::written::WRITTEN_PREFIX;
use dwell_findings::Finding;
use serde_json::Value;

/// By key of a finding: the largest relative difference allowed.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Tolerances {
    by_key: Vec<(String, f64)>,
}

impl Tolerances {
    pub(super) fn read(value: &Value) -> Result<Self, String> {
        if value.is_null() {
            return Ok(Self::default());
        }
        let mut tolerances = Self::default();
        for (key, value) in object(value, "`tolerances`")? {
            let Some(tolerance) = number(value).filter(|&tolerance| tolerance >= 0.0) else {
                return Err(format!(
                    "tolerances: `{key}` must be a number of 0 or more, not {value}"
                ));
            };
            tolerances.by_key.push((key.clone(), tolerance));
        }
        Ok(tolerances)
    }

    /// Applies them to findings. A finding without one keeps the tolerance of the code.
    ///
    /// # Errors
    /// A key that no finding has, with the known ones. Where a finding fails, that is what is reported: a failed comparison may be
    /// why others are missing.
    pub(crate) fn apply(&self, findings: &mut [Finding]) -> Result<(), String> {
        // Files are judged only where the program is known: the library alone has no such findings.
        let has_written = findings.iter().any(|f| f.key.starts_with(WRITTEN_PREFIX));
        let is_meant = |key: &str| has_written || !key.starts_with(WRITTEN_PREFIX);
        for (key, tolerance) in self.by_key.iter().filter(|(key, _)| is_meant(key)) {
            for finding in findings.iter_mut().filter(|f| f.key == *key) {
                let reason = "measured for this case, with room for another machine's rounding";
                let usual = finding.tolerance_reason.clone();
                finding.set_tolerance(*tolerance, &format!("{reason}; in general: {usual}"));
            }
        }
        let is_there = |key: &str| findings.iter().any(|f| f.key == key);
        let missing = self
            .by_key
            .iter()
            .find(|(key, _)| is_meant(key) && !is_there(key));
        match missing {
            Some((key, _)) if findings.iter().all(|f| f.pass) => {
                let mut known: Vec<&str> = findings.iter().map(|f| f.key.as_str()).collect();
                known.sort_unstable();
                known.dedup();
                let known = known.join(", ");
                Err(format!(
                    "tolerances: there is no finding `{key}`; the findings are {known}"
                ))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn findings() -> Vec<Finding> {
        let of = |key: &str| Finding {
            key: key.into(),
            relative_difference: 1e-14,
            tolerance: 1e-12,
            pass: true,
            ..Finding::default()
        };
        vec![of("power"), of("closure"), of("power")]
    }

    #[test]
    fn every_finding_of_a_key_has_its_tolerance() {
        let read = Tolerances::read(&json!({ "power": 1e-15 })).unwrap();
        let mut all = findings();
        read.apply(&mut all).unwrap();
        assert_eq!(
            all.iter().map(|f| f.pass).collect::<Vec<_>>(),
            [false, true, false]
        );
    }

    #[test]
    fn a_key_that_no_finding_has_is_an_error() {
        let read = Tolerances::read(&json!({ "pwoer": 1e-15 })).unwrap();
        let error = read.apply(&mut findings()).unwrap_err();
        assert_eq!(
            error,
            "tolerances: there is no finding `pwoer`; the findings are closure, power"
        );
        let mut failing = findings();
        failing[0].pass = false;
        assert_eq!(read.apply(&mut failing), Ok(()));
        assert!(Tolerances::read(&json!({ "power": "much" })).is_err());
        assert!(Tolerances::read(&json!({ "power": -1e-9 })).is_err());
        assert!(Tolerances::read(&json!(3)).is_err());
    }
}
