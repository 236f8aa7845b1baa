//! The findings on the random machines.

use super::run::{MachineResult, MachineRun};
use crate::drawn::{Drawn, completed, finding, largest, refused};
use dwell_findings::Finding;
use dwell_validation::extremes::series::{MAX_ESTIMATE_RATIO, REQUIRED_CELL_FRACTION};

/// Below this true error an estimate is one of roundings.
const ROUNDING: f64 = 1e-13;
/// A true error is known where it is so many times that of the reference.
const KNOWN: f64 = 3.0;
/// The part of the machines that may have no reference, and that of the runs that may be refused.
const MAX_UNKNOWN: f64 = 0.1;
const MAX_REFUSED: f64 = 0.2;

/// The findings: accuracies kept or refused, estimates not below the true error and not far above it.
pub fn check(results: &[MachineResult]) -> Vec<Finding> {
    let ratios = completed(results).filter_map(|(_, run)| run.estimate_ratio());
    let ratios: Vec<f64> = ratios.collect();
    let too_large = ratios.iter().filter(|ratio| **ratio > MAX_ESTIMATE_RATIO);
    let too_large = too_large.count() as f64 / ratios.len().max(1) as f64;
    let of =
        |key: &str, words: [&str; 3], found, allowed| finding(results, key, words, found, allowed);
    vec![
        of(
            "machines-accuracy",
            [
                "motions of random machines to a required accuracy: another method, restarted by hand at switches in time",
                "the required accuracy",
                "what is promised is kept",
            ],
            largest(results, MachineRun::accuracy_ratio),
            1.0,
        ),
        of(
            "machines-error-estimate",
            [
                "the true error of random machines, where it is above 1e-13",
                "the estimated error",
                "an estimate below the true error would hide a wrong number",
            ],
            largest(results, |run| Some(1.0 / run.estimate_ratio()?)),
            1.0,
        ),
        of(
            "machines-error-estimates",
            [
                "estimated errors of random machines above 100 times the true ones",
                "the runs",
                "an estimate that is often far too large says nothing",
            ],
            (too_large, String::new()),
            1.0 - REQUIRED_CELL_FRACTION,
        ),
        of(
            "machines-refused",
            [
                "motions of random machines that are refused",
                "the runs",
                "where a switch holds a speed there is no motion to follow; these are few",
            ],
            refused(results),
            MAX_REFUSED,
        ),
        of(
            "machines-without-reference",
            [
                "random machines that the reference cannot follow, either",
                "the machines",
                "what has no reference is not checked",
            ],
            without_reference(results),
            MAX_UNKNOWN,
        ),
    ]
}

/// The part of the machines that have no reference, with the first of them.
fn without_reference(results: &[MachineResult]) -> (f64, String) {
    let mut unknown = results.iter().filter(|m| m.without_reference.is_some());
    let part = unknown.clone().count() as f64 / results.len().max(1) as f64;
    let first = unknown.next().map(|m| format!("machine {}", m.number));
    (part, first.unwrap_or_default())
}

impl Drawn for MachineResult {
    type Run = MachineRun;
    const NAME: &'static str = "machines";

    fn runs(&self) -> &[MachineRun] {
        &self.runs
    }

    fn location(&self, run: &MachineRun) -> String {
        let (number, kind, accuracy) = (self.number, self.kind, run.accuracy);
        format!("machine {number}, {kind}, accuracy {accuracy:.0e}")
    }

    fn refusal(run: &MachineRun) -> Option<&str> {
        run.refused.as_deref()
    }
}

impl MachineRun {
    /// Whether its error is known, and it is a result.
    fn is_checked(&self) -> bool {
        self.refused.is_none() && !self.error.is_nan()
    }

    /// The true error over the required accuracy; that of the reference counts as none.
    pub fn accuracy_ratio(&self) -> Option<f64> {
        let is_known = self.error > KNOWN * self.reference_error;
        let beyond = if is_known {
            self.error - self.reference_error
        } else {
            0.0
        };
        self.is_checked().then(|| beyond / self.accuracy)
    }

    /// The estimated error over the true one, where that is above rounding and known.
    pub fn estimate_ratio(&self) -> Option<f64> {
        let is_known = self.error > ROUNDING && self.error > KNOWN * self.reference_error;
        (self.is_checked() && is_known).then(|| self.estimate / (self.error - self.reference_error))
    }
}
