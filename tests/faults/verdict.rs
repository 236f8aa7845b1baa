//! Which truths catch a fault, and by how much.

use dwell_findings::Finding;

/// The truths of DESIGN §1, by their number.
pub(crate) const TRUTHS: [&str; 10] = [
    "closure",
    "energy",
    "slope",
    "released",
    "power",
    "period",
    "multibody",
    "balance",
    "bodies",
    "published",
];
/// Truths that must catch a fault in an equation.
pub(crate) const ENOUGH: usize = 2;
/// Digits that stand for a difference that is no number.
const NO_NUMBER: f64 = 16.0;

/// By truth: the digits by which it catches a fault, log₁₀ of difference over tolerance; none where
/// it does not.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Verdict {
    pub(crate) digits: [Option<f64>; 10],
}

impl Verdict {
    /// Of findings, by the number that each truth begins with.
    pub(crate) fn of<'a>(findings: impl IntoIterator<Item = &'a Finding>) -> Self {
        let mut verdict = Self::default();
        for finding in findings {
            verdict.meet(finding);
        }
        verdict
    }

    fn meet(&mut self, finding: &Finding) {
        let number = match finding.number() {
            Some(number) => number,
            None if finding.truth.starts_with("published") => 9,
            None => return,
        };
        if finding.pass {
            return;
        }
        let tolerance = finding.tolerance.max(f64::EPSILON / 16.0);
        let digits = (finding.relative / tolerance).log10();
        let digits = if digits.is_finite() { digits } else { NO_NUMBER };
        let own = &mut self.digits[number];
        *own = Some(own.unwrap_or(0.0).max(digits));
    }

    /// By both.
    pub(crate) fn and(mut self, other: &Self) -> Self {
        for (own, other) in self.digits.iter_mut().zip(&other.digits) {
            if let Some(other) = other {
                *own = Some(own.unwrap_or(0.0).max(*other));
            }
        }
        self
    }

    /// How many independent truths catch it.
    pub(crate) fn count(&self) -> usize {
        self.digits.iter().flatten().count()
    }
}
