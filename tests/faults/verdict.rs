//! Which truths catch a fault, and by how much.

use dwell_findings::Finding;

/// The truths of DESIGN §1, by their number.
pub(crate) const TRUTHS: [&str; 10] = [
    "0 closure",
    "1 energy",
    "2 slope, Lagrange",
    "3 released",
    "4 power",
    "5 period",
    "6 multibody",
    "7 balance",
    "8 each body",
    "9 published",
];
/// Truths that must catch a fault in an equation.
pub(crate) const ENOUGH: usize = 2;
/// Digits above the tolerance from which on a fault counts as caught: the rounding of another machine
/// must not decide it.
const CAUGHT: f64 = 1.0;
/// Digits from which on it is caught strongly.
pub(crate) const STRONGLY: f64 = 3.0;
/// Digits that stand for a difference that is no number, or that should be exactly zero.
const MOST: f64 = 16.0;

/// By truth: the digits by which a fault is seen, log₁₀ of difference over tolerance; zero where it passes, none
/// where the truth was not asked.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Verdict {
    pub(crate) digits: [Option<f64>; 10],
}

impl Verdict {
    /// Of findings, by the number that each truth begins with.
    pub(crate) fn of<'a>(findings: impl IntoIterator<Item = &'a Finding>) -> Self {
        let mut verdict = Self::default();
        for finding in findings {
            if let Some(number) = finding.number() {
                verdict.meet(number, if finding.pass { 0.0 } else { digits(finding) });
            }
        }
        verdict
    }

    fn meet(&mut self, number: usize, digits: f64) {
        let own = &mut self.digits[number];
        *own = Some(own.unwrap_or(0.0).max(digits));
    }

    /// By both.
    pub(crate) fn and(mut self, other: &Self) -> Self {
        for (number, digits) in other.digits.iter().enumerate() {
            if let Some(digits) = digits {
                self.meet(number, *digits);
            }
        }
        self
    }

    /// Whether a truth catches it.
    pub(crate) fn caught(&self, number: usize) -> bool {
        self.digits[number].is_some_and(|digits| digits >= CAUGHT)
    }

    /// How many independent truths catch it.
    pub(crate) fn count(&self) -> usize {
        (0..TRUTHS.len())
            .filter(|&number| self.caught(number))
            .count()
    }

    /// The numbers of the truths that catch it, in brackets those that do so weakly.
    pub(crate) fn words(&self) -> String {
        let each = (0..TRUTHS.len()).filter(|&number| self.caught(number));
        let words = each.map(|number| match self.digits[number] {
            Some(digits) if digits >= STRONGLY => number.to_string(),
            _ => format!("({number})"),
        });
        words.collect::<Vec<_>>().join(" ")
    }
}

fn digits(finding: &Finding) -> f64 {
    let digits = (finding.relative / finding.tolerance.max(f64::EPSILON / 16.0)).log10();
    if digits.is_nan() {
        MOST
    } else {
        digits.clamp(0.0, MOST)
    }
}
