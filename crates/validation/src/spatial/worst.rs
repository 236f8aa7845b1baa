//! The largest difference of a comparison, as a finding.

use dwell_findings::{Check, Finding};

/// What is compared with what, and how close it must be.
pub(super) struct Comparison {
    pub(super) key: &'static str,
    pub(super) check: Check,
    pub(super) comparison: &'static str,
    pub(super) scale: &'static str,
    pub(super) tolerance: f64,
    pub(super) reason: &'static str,
}

/// The largest difference so far.
#[derive(Debug, Clone, Default)]
pub(super) struct Worst {
    absolute: f64,
    relative: f64,
    unit: &'static str,
    at: String,
    count: usize,
}

impl Worst {
    /// Takes a value that should be another, relative to a scale.
    pub(super) fn add(
        &mut self,
        [found, wanted, scale]: [f64; 3],
        unit: &'static str,
        at: impl FnOnce() -> String,
    ) {
        self.count += 1;
        let absolute = (found - wanted).abs();
        // What is zero throughout agrees where it is found to be zero.
        let relative = if absolute == 0.0 {
            0.0
        } else {
            absolute / scale
        };
        if relative.is_nan() || relative > self.relative || self.at.is_empty() {
            *self = Self {
                absolute,
                relative,
                unit,
                at: at(),
                count: self.count,
            };
        }
    }

    /// The finding over a domain; none where nothing was compared.
    pub(super) fn finding(self, of: &Comparison, domain: &str) -> Option<Finding> {
        (self.count > 0).then(|| Finding {
            comparison: of.comparison.to_owned(),
            domain: domain.to_owned(),
            unit: self.unit.to_owned(),
            scale: of.scale.to_owned(),
            worst_at: self.at,
            tolerance_reason: of.reason.to_owned(),
            ..Finding::new(
                of.key,
                of.check,
                [self.absolute, self.relative],
                of.tolerance,
            )
        })
    }
}
