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
    let ratios = runs(results).filter_map(|(_, run)| run.estimate_ratio());
    let ratios: Vec<f64> = ratios.collect();
    let too_large = ratios.iter().filter(|ratio| **ratio > MAX_ESTIMATE_RATIO);
    let too_large = too_large.count() as f64 / ratios.len().max(1) as f64;
    let mut findings = vec![
        Finding {
            comparison: "motions of random machines to a required accuracy: another method, restarted by hand at switches in time"
                .to_owned(),
            scale: "the required accuracy".to_owned(),
            tolerance_reason: "what is promised is kept".to_owned(),
            ..finding("machines-accuracy", results, largest(results, MachineRun::accuracy_ratio), 1.0)
        },
        Finding {
            comparison: "the true error of random machines, where it is above 1e-13".to_owned(),
            scale: "the estimated error".to_owned(),
            tolerance_reason: "an estimate below the true error would hide a wrong number".to_owned(),
            ..finding(
                "machines-error-estimate",
                results,
                largest(results, |run| Some(1.0 / run.estimate_ratio()?)),
                1.0,
            )
        },
        Finding {
            comparison: "estimated errors of random machines above 100 times the true ones".to_owned(),
            scale: "the runs".to_owned(),
            tolerance_reason: "an estimate that is often far too large says nothing".to_owned(),
            ..finding(
                "machines-error-estimates",
                results,
                (too_large, String::new()),
                1.0 - REQUIRED_CELL_FRACTION,
            )
        },
    ];
    findings.extend(refusals(results));
    findings
}

/// The findings on what is refused, by the program and by the reference.
fn refusals(results: &[MachineResult]) -> [Finding; 2] {
    let mut refused = runs(results).filter(|(_, run)| run.refused.is_some());
    let first_refused = refused.next();
    let refused = refused.count() + usize::from(first_refused.is_some());
    let refused = refused as f64 / runs(results).count().max(1) as f64;
    let first_refused = first_refused.map_or_else(String::new, |(m, run)| location(m, run));
    let mut unknown = results.iter().filter(|m| m.without_reference.is_some());
    let first_unknown = unknown.next();
    let unknown = unknown.count() + usize::from(first_unknown.is_some());
    let unknown = unknown as f64 / results.len().max(1) as f64;
    let first_unknown = first_unknown.map_or_else(String::new, |m| format!("machine {}", m.number));
    [
        Finding {
            comparison: "motions of random machines that are refused".to_owned(),
            scale: "the runs".to_owned(),
            tolerance_reason:
                "where a switch holds a speed there is no motion to follow; these are few"
                    .to_owned(),
            ..finding(
                "machines-refused",
                results,
                (refused, first_refused),
                MAX_REFUSED,
            )
        },
        Finding {
            comparison: "random machines that the reference cannot follow, either".to_owned(),
            scale: "the machines".to_owned(),
            tolerance_reason: "what has no reference is not checked".to_owned(),
            ..finding(
                "machines-without-reference",
                results,
                (unknown, first_unknown),
                MAX_UNKNOWN,
            )
        },
    ]
}

fn runs(results: &[MachineResult]) -> impl Iterator<Item = (&MachineResult, &MachineRun)> {
    results
        .iter()
        .flat_map(|m| m.runs.iter().map(move |run| (m, run)))
}

/// A finding on a number of the machines, with where it is and what is allowed.
fn finding(
    key: &str,
    results: &[MachineResult],
    (value, worst_at): (f64, String),
    allowed: f64,
) -> Finding {
    Finding {
        domain: format!(
            "{} machines with {} runs",
            results.len(),
            runs(results).count()
        ),
        worst_at,
        pass: value <= allowed && !results.is_empty(),
        ..Finding::new(key, Check::ClosedForms, [value; 2], allowed)
    }
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
