//! From single differences of written values to a finding.

use dwell_findings::{Check, Finding};

/// The constant texts of a finding over written values, and its tolerance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WrittenSpec<'a> {
    /// Short stable key; all begin with `written-`.
    pub(crate) key: &'a str,
    pub(crate) check: Check,
    /// What is compared with what.
    pub(crate) comparison: &'a str,
    /// The largest relative difference allowed, and why.
    pub(crate) tolerance: f64,
    pub(crate) tolerance_reason: &'a str,
}

/// A comparison.
#[derive(Debug, Clone)]
struct Pair {
    written: f64,
    reference: f64,
    unit: String,
    /// What the reference or the printed digits leave open, in the unit.
    allowance: f64,
    at: String,
}

/// Written values with their references. The scale of a unit is its largest reference.
#[derive(Debug, Clone, Default)]
pub(crate) struct Comparisons {
    pairs: Vec<Pair>,
    /// Scales that are at least these, by unit.
    scales: Vec<(String, f64)>,
    failure: Option<String>,
}

impl Comparisons {
    /// Adds a written value with its reference; `at` says which value it is.
    pub(crate) fn add(&mut self, unit: &str, written: f64, reference: f64, at: impl Into<String>) {
        self.add_within(unit, written, reference, 0.0, at);
    }

    /// The same where the digits that are printed, or the error that is stated, leave something open: only what is
    /// beyond `allowance` is a difference.
    pub(crate) fn add_within(
        &mut self,
        unit: &str,
        written: f64,
        reference: f64,
        allowance: f64,
        at: impl Into<String>,
    ) {
        self.scale(unit, reference);
        self.pairs.push(Pair {
            written,
            reference,
            unit: unit.to_owned(),
            allowance,
            at: at.into(),
        });
    }

    /// The scale of a unit is at least this.
    pub(crate) fn scale(&mut self, unit: &str, least: f64) {
        let least = least.abs();
        match self.scales.iter_mut().find(|(of, _)| of == unit) {
            // A maximum drops what is not a number, but then the difference is not one either.
            Some((_, scale)) => *scale = scale.max(least),
            None => self.scales.push((unit.to_owned(), least.max(0.0))),
        }
    }

    /// Records that something could not be compared at all, which fails the finding.
    pub(crate) fn fail(&mut self, why: impl Into<String>) {
        self.failure.get_or_insert(why.into());
    }

    /// Whether nothing was compared, and nothing failed.
    pub(crate) fn is_empty(&self) -> bool {
        self.pairs.is_empty() && self.failure.is_none()
    }

    /// The finding of the largest difference, relative to the scale of its unit.
    pub(crate) fn finding(self, spec: &WrittenSpec<'_>, domain: impl Into<String>) -> Finding {
        let scale_of = |unit: &str| {
            let of = self.scales.iter().find(|(of, _)| of == unit);
            of.map_or(0.0, |(_, scale)| *scale)
        };
        let mut worst: Option<([f64; 2], &Pair)> = None;
        for pair in &self.pairs {
            let absolute = ((pair.written - pair.reference).abs() - pair.allowance).max(0.0);
            // A maximum drops what is not a number.
            let is_number = (pair.written - pair.reference - pair.allowance).is_finite();
            let absolute = if is_number { absolute } else { f64::NAN };
            // Zero agrees with zero even where nothing gives a scale.
            let relative = if absolute == 0.0 {
                0.0
            } else {
                absolute / scale_of(&pair.unit)
            };
            let is_worse = worst.is_none_or(|([_, so_far], _)| {
                !so_far.is_nan() && (relative.is_nan() || relative > so_far)
            });
            if is_worse {
                worst = Some(([absolute, relative], pair));
            }
        }
        let empty = Finding {
            key: spec.key.to_owned(),
            check: spec.check,
            tolerance: spec.tolerance,
            worst_at: "nothing was compared".to_owned(),
            ..Finding::default()
        };
        let found = match (&self.failure, worst) {
            (Some(why), _) => Finding {
                worst_at: why.clone(),
                ..empty
            },
            (None, None) => empty,
            (None, Some((differences, pair))) => Finding {
                unit: pair.unit.clone(),
                worst_at: pair.at.clone(),
                ..Finding::new(spec.key, spec.check, differences, spec.tolerance)
            },
        };
        Finding {
            comparison: spec.comparison.to_owned(),
            domain: domain.into(),
            scale: "the largest of the unit".to_owned(),
            tolerance_reason: spec.tolerance_reason.to_owned(),
            // What is written was computed by an integration, or rounded to its printed digits.
            integrated: true,
            ..found
        }
    }
}

impl WrittenSpec<'_> {
    /// The failed finding of what could not be run or read.
    pub(crate) fn failed(&self, why: impl Into<String>) -> Finding {
        let mut nothing = Comparisons::default();
        nothing.fail(why);
        nothing.finding(self, "what was written")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEC: WrittenSpec<'_> = WrittenSpec {
        key: "written-test",
        check: Check::WrittenRows,
        comparison: "this with that",
        tolerance: 1e-9,
        tolerance_reason: "a test",
    };

    #[test]
    fn differences_are_relative_to_the_largest_of_the_unit() {
        let mut all = Comparisons::default();
        all.add("N", 100.0 + 2e-8, 100.0, "A");
        all.add("N", 1e-3, 1e-3 + 1e-8, "B");
        all.add("m", 2.0, 2.0, "C");
        let finding = all.finding(&SPEC, "two rows");
        assert!(finding.pass && finding.worst_at == "A", "{finding:?}");
        assert!((finding.relative_difference - 2e-10).abs() < 1e-13);
    }

    #[test]
    fn nothing_compared_a_failure_and_what_is_no_number_fail() {
        assert!(!Comparisons::default().finding(&SPEC, "").pass);
        assert!(!SPEC.failed("no file").pass);
        let mut all = Comparisons::default();
        all.add("N", 1.0, 1.0, "A");
        all.add("N", f64::NAN, 1.0, "B");
        all.add("N", 3.0, 1.0, "C");
        let finding = all.finding(&SPEC, "");
        assert!(!finding.pass && finding.worst_at == "B", "{finding:?}");
    }

    #[test]
    fn only_what_is_beyond_the_printed_digits_is_a_difference() {
        let mut all = Comparisons::default();
        all.add_within("Hz", 0.5823, 0.582_27, 5e-5, "printed");
        assert_eq!(all.finding(&SPEC, "").relative_difference, 0.0);
        let mut all = Comparisons::default();
        all.add_within("Hz", 0.5824, 0.582_27, 5e-5, "printed");
        assert!(!all.finding(&SPEC, "").pass);
    }
}
