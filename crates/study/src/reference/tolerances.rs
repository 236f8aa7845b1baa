//! The tolerances of a case, by finding: written from measurement, in place of those of the code.

use super::{object, parse};
use dwell_findings::Finding;
use serde_json::Value;

/// By key of a finding: the largest relative difference allowed.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Tolerances(Vec<(String, f64)>);

impl Tolerances {
    pub(super) fn read(value: &Value) -> Result<Self, String> {
        if value.is_null() {
            return Ok(Self::default());
        }
        let read = |(key, value): (&String, &Value)| match parse(value) {
            Some(tolerance) if tolerance >= 0.0 => Ok((key.clone(), tolerance)),
            _ => Err(format!(
                "tolerances: `{key}` is not a number from zero on: {value}"
            )),
        };
        let fields = object(value, "`tolerances`")?;
        fields.iter().map(read).collect::<Result<_, _>>().map(Self)
    }

    /// Judges findings by them. A finding without one keeps that of the code.
    ///
    /// # Errors
    /// A key that no finding has, in words that name the known ones.
    pub(crate) fn judge(&self, findings: &mut [Finding]) -> Result<(), String> {
        for (key, tolerance) in &self.0 {
            if findings.iter().all(|f| f.key != *key) {
                let mut known: Vec<&str> = findings.iter().map(|f| f.key.as_str()).collect();
                known.sort_unstable();
                known.dedup();
                return Err(format!(
                    "tolerances: there is no finding `{key}`; there are {}",
                    known.join(", ")
                ));
            }
            for finding in findings.iter_mut().filter(|f| f.key == *key) {
                let why = "measured for this case, with room for another machine's rounding";
                let usual = finding.why.clone();
                finding.within(*tolerance, &format!("{why}; in general: {usual}"));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn findings() -> Vec<Finding> {
        let of = |key: &str| Finding {
            key: key.into(),
            relative: 1e-14,
            tolerance: 1e-12,
            pass: true,
            ..Finding::default()
        };
        vec![of("power"), of("closure"), of("power")]
    }

    #[test]
    fn every_finding_of_a_key_is_judged_by_it() {
        let read = Tolerances::read(&json!({ "power": 1e-15 })).unwrap();
        let mut all = findings();
        read.judge(&mut all).unwrap();
        assert_eq!(
            all.iter().map(|f| f.pass).collect::<Vec<_>>(),
            [false, true, false]
        );
    }

    #[test]
    fn a_key_that_no_finding_has_is_an_error() {
        let read = Tolerances::read(&json!({ "pwoer": 1e-15 })).unwrap();
        let error = read.judge(&mut findings()).unwrap_err();
        assert_eq!(
            error,
            "tolerances: there is no finding `pwoer`; there are closure, power"
        );
        assert!(Tolerances::read(&json!({ "power": "much" })).is_err());
        assert!(Tolerances::read(&json!({ "power": -1e-9 })).is_err());
        assert!(Tolerances::read(&json!(3)).is_err());
    }
}
