//! The results on a case's files: differences by the key of their finding.

use super::difference::Differences;
use dwell_findings::{Check, Finding};
use dwell_verify::FindingSpec;
use std::collections::BTreeMap;

/// A finding's key, check, comparison, and tolerance: that measured over all cases, with room for another machine's
/// rounding; cases have their own.
type Spec = (&'static str, Check, &'static str, f64);

#[rustfmt::skip]
const SPECS: [Spec; 33] = [
    ("written-extrema-again", Check::WrittenTwice, "extrema of `kinematics`, `statics` and `kinetostatics` with those of fewer rows of the same motion", 2e-6),
    ("written-movement-sentences", Check::WrittenSentences, "what `kinematics` prints of it with the summary, to its digits", 1e-12),
    ("written-runs", Check::WrittenTwice, "m, ½m′, a and b of `reduce` with two runs of kinetostatics, and with the columns that are requested", 4e-11),
    ("written-code", Check::WrittenTwice, "code of `symbolic` in Rust, Python and C, run line by line, with the rows of `reduce`", 1e-11),
    ("written-formulas", Check::WrittenTwice, "formulas of `symbolic` in LaTeX, with the printed constants of 12 digits, computed line by line, with the rows of `reduce`", 1e-9),
    ("written-sweep", Check::WrittenTwice, "extrema of m in rows of `sweep` with `reduce` of each changed scene", 1e-13),
    ("written-sweep-files", Check::WrittenTwice, "archive and Parquet files of `sweep` with its table", 1e-15),
    ("written-sweep-motion", Check::WrittenTwice, "end, largest size, mean and root mean square of columns of motions in `sweep` with rows of `simulate` of the changed scene", 1e-14),
    ("written-sweep-sentences", Check::WrittenSentences, "numbers that `sweep` prints with its summary, to their digits", 1e-12),
    ("written-units", Check::WrittenUnits, "files of the scene with those of the scene in other units", 1e-11),
    ("written-motion-again", Check::WrittenTwice, "rows and events of `simulate` by its default method and by dop853", 2e-6),
    ("written-motion-extrema-again", Check::WrittenTwice, "extrema of `simulate` with those of the same motion by esdirk34 in other rows", 4e-5),
    ("written-motion-accuracy", Check::WrittenTwice, "coordinates of `simulate --accuracy 1e-8` with those by dop853 to 1e-12, and stated errors with the accuracy", 1e-8),
    ("written-motion-change-points", Check::WrittenSentences, "change points that `check` names with those that `simulate` says it crosses", 1e-12),
    ("written-motion-sentences", Check::WrittenSentences, "numbers that `simulate` prints with the summary, to their digits", 1e-12),
    ("written-linear", Check::WrittenForces, "A, B, C and D of `linearise` with differences of rows of `simulate` from neighbouring starts", 3e-10),
    ("written-rest", Check::WrittenForces, "accelerations of `simulate` that starts at rest in the equilibria of `equilibria`", 2e-14),
    ("written-rest-start", Check::WrittenTotals, "distances of equilibria from the start with the start of the motion, what was searched with one revolution, and neutral directions with 1 as their largest part", 1e-14),
    ("written-rest-words", Check::WrittenSentences, "the stability that `equilibria` and `linearise` print with their eigenvalues", 0.5),
    ("written-rest-nearest", Check::WrittenTotals, "the equilibrium that `linearise` takes from a start near each of the table with the distance between both", 5e-15),
    ("written-rest-again", Check::WrittenTwice, "the equilibrium of `linearise` and its modes with the table of `equilibria`", 1e-14),
    ("written-static-force", Check::WrittenTotals, "the smallest and the largest static force of `equilibria` with rows of `statics`, an equilibrium wherever it changes its sign, and none where every position is one", 1e-14),
    ("written-damped", Check::WrittenTotals, "the modes of `equilibria` with a damper of known damping ratio, with those of a damped oscillator", 1e-14),
    ("written-rest-modes", Check::WrittenTwice, "modes of `equilibria` with eigenvalues of `linearise` about the equilibria", 2e-14),
    ("written-linear-again", Check::WrittenTwice, "A, B, C and D of `linearise` with differences of its rates and outputs at neighbouring starts", 3e-10),
    ("written-point-sentences", Check::WrittenSentences, "numbers that `linearise` and `equilibria` print with their summaries, to their digits", 1e-12),
    ("written-cycle-period", Check::WrittenTwice, "the period of `cycle` with that of a long motion by `simulate`", 1e-8),
    ("written-cycle-multiplier", Check::WrittenTwice, "the largest Floquet multiplier of `cycle` with the decay of a long motion by `simulate`", 1e-2),
    ("written-cycle-flywheel", Check::WrittenTwice, "speeds of `cycle` with its flywheel, with those of the scene in which a body has that inertia", 1e-7),
    ("written-cycle-sentences", Check::WrittenSentences, "numbers that `cycle` prints with its summary, to their digits", 1e-12),
    ("written-contents-sentences", Check::WrittenSentences, "masses, centre of mass, size and angles that `check` prints with the scene's text, to their digits", 7e-15),
    ("written-warnings", Check::WrittenSentences, "warnings of splines that go beyond their points, with their curves from the scene's text, to the last printed digit", 0.51),
    ("written-sentences", Check::WrittenSentences, "printed numbers with the summary, to their digits", 1e-12),
];

/// Differences by key.
#[derive(Debug, Default)]
pub(crate) struct Compared {
    by_key: BTreeMap<&'static str, Differences>,
}

impl Compared {
    /// The differences of a key.
    pub(crate) fn of(&mut self, key: &'static str) -> &mut Differences {
        self.by_key.entry(key).or_default()
    }

    /// Adds differences to those of a key.
    pub(crate) fn merge(&mut self, key: &'static str, differences: Differences) {
        self.of(key).merge(differences);
    }

    /// Adds a difference of a key with its scale.
    pub(crate) fn add<S: Into<String>>(
        &mut self,
        key: &'static str,
        difference: f64,
        scale: f64,
        unit: &'static str,
        at: impl FnOnce() -> S,
    ) {
        self.of(key).add(difference, scale, unit, at);
    }

    /// Something of a key could not be compared.
    pub(crate) fn fail(&mut self, key: &'static str, reason: impl Into<String>) {
        self.of(key).fail(reason);
    }

    /// The findings, in the order of their checks.
    pub(crate) fn findings(mut self) -> Vec<Finding> {
        let finding = |(key, check, comparison, tolerance): Spec| {
            let spec = FindingSpec {
                key,
                check,
                comparison,
                scale: "the largest of its kind in the file",
                tolerance,
                tolerance_reason: match ["written-motion", "written-cycle"]
                    .iter()
                    .any(|start| key.starts_with(start))
                {
                    true => "error of the motion at its tolerance, measured over all cases",
                    false => "rounding of the written numbers, measured over all cases",
                },
            };
            self.by_key
                .remove(key)?
                .counted_finding(&spec, "all rows of the files")
        };
        SPECS.into_iter().filter_map(finding).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fails_is_a_finding_that_fails() {
        for (k, (key, ..)) in SPECS.iter().enumerate() {
            assert!(
                SPECS[..k].iter().all(|(other, ..)| other != key),
                "{key} twice"
            );
            let mut compared = Compared::default();
            compared.fail(key, "no file".to_owned());
            let findings = compared.findings();
            assert_eq!((findings.len(), findings[0].pass), (1, false));
            assert_eq!(findings[0].worst_at, "no file");
        }
        assert!(Compared::default().findings().is_empty());
    }
}
