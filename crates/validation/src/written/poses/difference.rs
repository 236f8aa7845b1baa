//! The largest of many differences, and the finding that it makes.

use dwell_findings::Finding;
use dwell_verify::{Comparison, FindingSpec, LargestDifference};

/// The largest difference relative to its scale. A failed comparison fails the finding; without comparisons there is no
/// finding.
#[derive(Debug, Clone, Default)]
pub(crate) struct Differences(LargestDifference);

impl Differences {
    /// Adds a difference with its scale; its place is only composed if it is the worst.
    pub(crate) fn add<S: Into<String>>(
        &mut self,
        difference: f64,
        scale: f64,
        unit: &'static str,
        at: impl FnOnce() -> S,
    ) {
        let comparison = Comparison::new([difference, scale.abs(), 0.0], unit, 1.0);
        self.0.record(&comparison, || at().into());
    }

    /// Adds a value that should be another, relative to a scale.
    pub(crate) fn compare<S: Into<String>>(
        &mut self,
        [found, wanted, scale]: [f64; 3],
        unit: &'static str,
        at: impl FnOnce() -> S,
    ) {
        self.add(found - wanted, scale, unit, at);
    }

    /// Adds the differences of successive rows, each with its place.
    pub(crate) fn add_rows(
        &mut self,
        differences: impl IntoIterator<Item = f64>,
        scale: f64,
        unit: &'static str,
        at: impl Fn(usize) -> String,
    ) {
        for (row, difference) in differences.into_iter().enumerate() {
            self.add(difference, scale, unit, || at(row));
        }
    }

    /// Something could not be compared: the finding fails with this reason.
    pub(crate) fn fail(&mut self, reason: impl Into<String>) {
        self.0.record_failure(reason.into());
    }

    /// Counts a required condition; if it does not hold, the finding fails.
    pub(crate) fn require(&mut self, holds: bool, reason: impl FnOnce() -> String) {
        self.add(0.0, 1.0, "", || "");
        if !holds {
            self.fail(reason());
        }
    }

    /// How many were compared.
    pub(crate) fn count(&self) -> usize {
        self.0.count
    }

    /// The largest relative difference.
    #[cfg(test)]
    pub(crate) fn largest(&self) -> f64 {
        self.0.relative_difference
    }

    /// Why something could not be compared.
    #[cfg(test)]
    pub(crate) fn failure(&self) -> Option<&str> {
        self.0.failure.as_deref()
    }

    /// The worse of both.
    pub(crate) fn merge(&mut self, other: Self) {
        self.0 = std::mem::take(&mut self.0).merge(other.0);
    }

    /// The finding over a domain, which states the number of comparisons; `None` if there was nothing to compare.
    pub(crate) fn counted_finding(self, spec: &FindingSpec<'_>, domain: &str) -> Option<Finding> {
        let domain = format!("{domain}, {} comparisons", self.0.count);
        self.finding(spec, &domain)
    }

    /// The finding over a domain; `None` if there was nothing to compare.
    pub(crate) fn finding(self, spec: &FindingSpec<'_>, domain: &str) -> Option<Finding> {
        let is_any = self.0.count > 0 || self.0.failure.is_some();
        is_any.then(|| spec.finding(domain.to_owned(), self.0))
    }
}
