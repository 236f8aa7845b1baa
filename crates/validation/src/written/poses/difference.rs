//! The largest of many differences, and the finding that it makes.

use dwell_findings::Finding;
use dwell_verify::FindingSpec;

/// The largest difference relative to its scale. What could not be compared fails.
#[derive(Debug, Clone, Default)]
pub(crate) struct Differences {
    pub(crate) count: usize,
    absolute: f64,
    relative: f64,
    unit: &'static str,
    worst_at: String,
    failure: Option<String>,
}

impl Differences {
    /// Adds a difference with its scale; its place is only composed if it is the worst.
    pub(crate) fn add<S: Into<String>>(
        &mut self,
        difference: f64,
        scale: f64,
        unit: &'static str,
        at: impl FnOnce() -> S,
    ) {
        let relative = match difference.abs() {
            0.0 => 0.0,
            size => size / scale.abs(),
        };
        let is_worse = !self.relative.is_nan() && (relative.is_nan() || relative > self.relative);
        if self.count == 0 || is_worse {
            (self.absolute, self.relative, self.unit) = (difference.abs(), relative, unit);
            self.worst_at = at().into();
        }
        self.count += 1;
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
        self.failure.get_or_insert(reason.into());
    }

    /// Counts what must hold; where it does not, the finding fails.
    pub(crate) fn require(&mut self, holds: bool, reason: impl FnOnce() -> String) {
        self.add(0.0, 1.0, "", || "");
        if !holds {
            self.fail(reason());
        }
    }

    /// The largest relative difference.
    #[cfg(test)]
    pub(crate) fn largest(&self) -> f64 {
        self.relative
    }

    /// Why something could not be compared.
    #[cfg(test)]
    pub(crate) fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    /// The worse of both.
    pub(crate) fn merge(&mut self, other: Self) {
        let failure = self.failure.take().or(other.failure.clone());
        let count = self.count + other.count;
        let is_worse = other.count > 0
            && (self.count == 0
                || (!self.relative.is_nan()
                    && (other.relative.is_nan() || other.relative > self.relative)));
        if is_worse {
            *self = other;
        }
        (self.failure, self.count) = (failure, count);
    }

    /// The finding over a domain, which says how many comparisons there were; none where there was nothing to compare.
    pub(crate) fn counted_finding(self, spec: &FindingSpec<'_>, domain: &str) -> Option<Finding> {
        let domain = format!("{domain}, {} comparisons", self.count);
        self.finding(spec, &domain)
    }

    /// The finding over a domain; none where there was nothing to compare.
    pub(crate) fn finding(self, spec: &FindingSpec<'_>, domain: &str) -> Option<Finding> {
        if self.count == 0 && self.failure.is_none() {
            return None;
        }
        let numbers = match self.failure {
            Some(_) => [f64::NAN; 2],
            None => [self.absolute, self.relative],
        };
        Some(Finding {
            comparison: spec.comparison.to_owned(),
            domain: domain.to_owned(),
            unit: self.unit.to_owned(),
            scale: spec.scale.to_owned(),
            worst_at: self.failure.unwrap_or(self.worst_at),
            tolerance_reason: spec.tolerance_reason.to_owned(),
            ..Finding::new(spec.key, spec.check, numbers, spec.tolerance)
        })
    }
}
