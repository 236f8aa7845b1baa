//! The findings on the random machines.

use super::run::{MachineResult, MachineRun};
use crate::extremes::series::{MAX_ESTIMATE_RATIO, REQUIRED_CELL_FRACTION};
use dwell_findings::{Check, Finding};

/// Below this true error an estimate is one of roundings.
const ROUNDING: f64 = 1e-13;
/// A true error is known where it is so many times that of the reference.
const KNOWN: f64 = 3.0;
/// The part of the machines that may have no reference, and that of the runs that may be refused.
const MAX_UNKNOWN: f64 = 0.1;
const MAX_REFUSED: f64 = 0.2;

/// The findings: accuracies kept or refused, estimates not below the true error and not far above it.
pub fn check(results: &[MachineResult]) -> Vec<Finding> {
    let runs = || {
        results
            .iter()
            .flat_map(|m| m.runs.iter().map(move |run| (m, run)))
    };
    let known = || results.iter().filter(|m| m.without_reference.is_none());
    let count = runs().count().max(1) as f64;
    let finding = |key: &str,
                   comparison: &str,
                   scale: &str,
                   reason: &str,
                   (value, worst_at): (f64, String),
                   allowed: f64| {
        Finding {
            comparison: comparison.to_owned(),
            domain: format!("{} machines with {count} runs", results.len()),
            scale: scale.to_owned(),
            tolerance_reason: reason.to_owned(),
            worst_at,
            pass: value <= allowed && !results.is_empty(),
            ..Finding::new(key, Check::ClosedForms, [value; 2], allowed)
        }
    };
    let kept = largest(results, MachineRun::accuracy_ratio);
    let below = largest(results, |run| Some(1.0 / run.estimate_ratio()?));
    let ratios: Vec<f64> = runs().filter_map(|(_, run)| run.estimate_ratio()).collect();
    let too_large = ratios
        .iter()
        .filter(|ratio| **ratio > MAX_ESTIMATE_RATIO)
        .count();
    let too_large = too_large as f64 / ratios.len().max(1) as f64;
    let refused = runs().filter(|(_, run)| run.refused.is_some()).count() as f64 / count;
    let unknown = (results.len() - known().count()) as f64 / results.len().max(1) as f64;
    let first_refused = runs().find(|(_, run)| run.refused.is_some());
    let first_refused = first_refused.map_or_else(String::new, |(m, run)| location(m, run));
    let first_unknown = results.iter().find(|m| m.without_reference.is_some());
    let first_unknown = first_unknown.map_or_else(String::new, |m| format!("machine {}", m.number));
    vec![
        finding(
            "machines-accuracy",
            "motions of random machines to a required accuracy: another method, restarted by hand at switches in time",
            "the required accuracy",
            "what is promised is kept",
            kept,
            1.0,
        ),
        finding(
            "machines-error-estimate",
            "the true error of random machines, where it is above 1e-13",
            "the estimated error",
            "an estimate below the true error would hide a wrong number",
            below,
            1.0,
        ),
        finding(
            "machines-error-estimates",
            "estimated errors of random machines above 100 times the true ones",
            "the runs",
            "an estimate that is often far too large says nothing",
            (too_large, String::new()),
            1.0 - REQUIRED_CELL_FRACTION,
        ),
        finding(
            "machines-refused",
            "motions of random machines that are refused",
            "the runs",
            "where a speed is held by a switch there is no motion to follow; these are few",
            (refused, first_refused),
            MAX_REFUSED,
        ),
        finding(
            "machines-without-reference",
            "random machines that the reference cannot follow, either",
            "the machines",
            "what has no reference is not checked",
            (unknown, first_unknown),
            MAX_UNKNOWN,
        ),
    ]
}

fn location(machine: &MachineResult, run: &MachineRun) -> String {
    let reason = run
        .refused
        .as_deref()
        .map_or_else(String::new, |reason| format!(": {reason}"));
    format!(
        "machine {}, {}, accuracy {:.0e}{reason}",
        machine.number, machine.kind, run.accuracy
    )
}

/// The largest of something of the runs, and where it is.
fn largest(results: &[MachineResult], of: impl Fn(&MachineRun) -> Option<f64>) -> (f64, String) {
    let runs = results
        .iter()
        .flat_map(|m| m.runs.iter().map(move |run| (m, run)));
    let sizes = runs.filter_map(|(m, run)| Some((of(run)?, m, run)));
    let largest = sizes.max_by(|a, b| a.0.total_cmp(&b.0));
    largest.map_or((0.0, String::new()), |(size, m, run)| {
        (size, location(m, run))
    })
}

impl MachineRun {
    /// Whether its error is known, and it is a result.
    fn is_checked(&self) -> bool {
        self.refused.is_none() && !self.error.is_nan()
    }

    /// The true error over the required accuracy.
    pub fn accuracy_ratio(&self) -> Option<f64> {
        let beyond = (self.error - self.reference_error).max(0.0);
        self.is_checked().then(|| beyond / self.accuracy)
    }

    /// The estimated error over the true one, where that is above rounding and known.
    pub fn estimate_ratio(&self) -> Option<f64> {
        let is_known = self.error > ROUNDING && self.error > KNOWN * self.reference_error;
        (self.is_checked() && is_known).then(|| self.estimate / (self.error - self.reference_error))
    }
}
