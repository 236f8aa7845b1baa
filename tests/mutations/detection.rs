//! Which checks detect a fault, and by how much.

use dwell_findings::{Check, Finding};

/// The checks that are applied to mutations: all but rounding and closed forms.
pub const CHECKS: &[Check] = Check::ALL.split_at(10).0;
/// Checks that must detect a fault in an equation.
pub const REQUIRED_CHECKS: usize = 2;
/// Digits above the tolerance from which on a fault counts as detected: the rounding of another machine
/// must not decide it.
const MIN_DIGITS: f64 = 1.0;
/// Digits from which on it is detected clearly.
pub const STRONG_DIGITS: f64 = 3.0;
/// Digits that stand for a difference that is not a number, or that should be exactly zero.
const MAX_DIGITS: f64 = 16.0;

/// By check: the digits by which a fault is detected, log₁₀ of difference over tolerance; zero where it passes, none
/// where the check was not applied.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Detection {
    pub digits: [Option<f64>; 10],
}

impl Detection {
    /// Of findings, by the number of their check.
    pub fn from_findings<'a>(findings: impl IntoIterator<Item = &'a Finding>) -> Self {
        let mut detection = Self::default();
        for finding in findings {
            detection.record(
                finding.check.number(),
                if finding.pass { 0.0 } else { digits(finding) },
            );
        }
        detection
    }

    fn record(&mut self, number: usize, digits: f64) {
        let recorded = &mut self.digits[number];
        *recorded = Some(recorded.unwrap_or(0.0).max(digits));
    }

    /// By both.
    pub fn merge(mut self, other: &Self) -> Self {
        for (number, digits) in other.digits.iter().enumerate() {
            if let Some(digits) = digits {
                self.record(number, *digits);
            }
        }
        self
    }

    /// Whether a check detects it.
    pub fn detects(&self, number: usize) -> bool {
        self.digits[number].is_some_and(|digits| digits >= MIN_DIGITS)
    }

    /// How many independent checks detect it.
    pub fn check_count(&self) -> usize {
        (0..CHECKS.len())
            .filter(|&number| self.detects(number))
            .count()
    }

    /// The numbers of the checks that detect it, in brackets those with few digits.
    pub fn check_numbers(&self) -> String {
        let each = (0..CHECKS.len()).filter(|&number| self.detects(number));
        let texts = each.map(|number| match self.digits[number] {
            Some(digits) if digits >= STRONG_DIGITS => number.to_string(),
            _ => format!("({number})"),
        });
        texts.collect::<Vec<_>>().join(" ")
    }
}

fn digits(finding: &Finding) -> f64 {
    let digits = (finding.relative_difference / finding.tolerance.max(f64::EPSILON / 16.0)).log10();
    if digits.is_nan() {
        MAX_DIGITS
    } else {
        digits.clamp(0.0, MAX_DIGITS)
    }
}
