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
    /// Condition number of the dense scaled rows at the worst place; 1 where it has no meaning.
    pub condition: f64,
    /// Whether what is judged was integrated in time: its error is a factor times the integrator's
    /// tolerance, not rounding.
    pub integrated: bool,
    /// The verdict: the difference is finite and within the tolerance.
    pub pass: bool,
}

/// The most that a tolerance may be, in differences met and in condition numbers times the unit of the last
/// place: above it a check would let pass what it could have seen.
const SEEN: f64 = 100.0;
const ROUNDINGS: f64 = 50.0;

impl Default for Finding {
    /// Nothing compared yet: a failure.
    fn default() -> Self {
        Self {
            key: String::new(),
            truth: String::new(),
            compared: String::new(),
            over: String::new(),
            absolute: f64::NAN,
            unit: String::new(),
            relative: f64::NAN,
            scale: "none".to_owned(),
            worst: String::new(),
            tolerance: 0.0,
            why: String::new(),
            condition: 1.0,
            integrated: false,
            pass: false,
        }
    }
}

impl Finding {
    /// The most that the tolerance may be: 100 times the difference met, and 50 roundings times the condition.
    pub fn most(&self) -> f64 {
        SEEN * self.relative + ROUNDINGS * f64::EPSILON * self.condition
    }

    /// Whether the tolerance is above that. Integrated results are judged by slopes and factors, and
    /// a finding that compared nothing has no slack.
    pub fn slack(&self) -> bool {
        !self.integrated && self.tolerance > self.most()
    }

    /// The number of its truth, 0 to 9, by which findings are put together.
    pub fn number(&self) -> Option<usize> {
        let digit = self.truth.chars().next()?.to_digit(10)?;
        usize::try_from(digit).ok()
    }

    /// Judges by another tolerance, with the reason for it. What could not be compared still fails.
    pub fn within(&mut self, tolerance: f64, why: &str) {
        self.tolerance = tolerance;
        self.why = why.to_owned();
        self.pass = self.relative <= tolerance;
    }
}

/// Whether every finding passed.
pub fn all_pass(findings: &[Finding]) -> bool {
    findings.iter().all(|f| f.pass)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn met(relative: f64, tolerance: f64) -> Finding {
        Finding {
            relative,
            tolerance,
            truth: "3 released constraint".into(),
            ..Finding::default()
        }
    }

    #[test]
    fn a_tolerance_is_slack_above_a_hundred_differences_and_fifty_roundings() {
        assert!(!met(1e-12, 1e-10).slack());
        assert!(met(1e-12, 1.1e-10).slack());
        // Nothing is seen, but 50 roundings are allowed for: 1.1e-14, and times the condition.
        assert!(!met(0.0, 1e-14).slack() && met(0.0, 1.2e-14).slack());
        let ill = Finding {
            condition: 1e3,
            ..met(0.0, 1e-11)
        };
        assert!(!ill.slack());
        let integrated = Finding {
            integrated: true,
            ..met(1e-12, 1e-8)
        };
        assert!(!integrated.slack());
        assert_eq!(integrated.number(), Some(3));
    }

    #[test]
    fn another_tolerance_is_another_verdict_but_for_what_was_not_compared() {
        let mut finding = met(1e-12, 1e-10);
        finding.within(1e-11, "measured");
        assert!(finding.pass);
        finding.within(1e-13, "measured");
        assert!(!finding.pass);
        finding.relative = f64::NAN;
        finding.within(1.0, "measured");
        assert!(!finding.pass);
    }
}
