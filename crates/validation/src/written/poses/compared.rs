//! What was found of a case's files: differences by the key of their finding.

use super::difference::Differences;
use dwell_findings::{Check, Finding};
use dwell_verify::FindingSpec;
use std::collections::BTreeMap;

/// A finding's key, check, comparison, and tolerance: that measured over all cases, with room for another machine's
/// rounding; cases have their own.
type Spec = (&'static str, Check, &'static str, f64);

#[rustfmt::skip]
const SPECS: [Spec; 86] = [
    ("written-closure", Check::WrittenPositions, "joints, points and coordinates of every row with the scene's text: values, velocities, accelerations", 5e-13),
    ("written-rates", Check::WrittenRates, "changes between rows with the integrals of their rates", 1e-9),
    ("written-quotients", Check::WrittenRates, "velocity ratios with the velocities that they are of, and transmission angles with the places of the pins", 5e-14),
    ("written-slopes", Check::WrittenRates, "m and V of `reduce` with the integrals of ½m′ and w between rows", 1e-7),
    ("written-law-rates", Check::WrittenRates, "changes between rows of drawn laws with the integrals of their rates", 1e-6),
    ("written-extrema", Check::WrittenRates, "extrema of the summary with the rows around them", 1e-6),
    ("written-places", Check::WrittenRates, "slopes at the places of the summary's extrema by the rows around them, over one row", 1e-6),
    ("written-extrema-again", Check::WrittenTwice, "extrema of `kinematics`, `statics` and `kinetostatics` with those of fewer rows of the same motion", 2e-6),
    ("written-movement", Check::WrittenTotals, "by how much bodies turn and slides travel with the rows and the extrema of `kinematics`", 1e-13),
    ("written-movement-sentences", Check::WrittenSentences, "what `kinematics` prints of it with the summary, to its digits", 1e-12),
    ("written-range", Check::WrittenTotals, "the ends of the rows of `reduce` with the limit positions of `check`", 8e-15),
    ("written-equilibrium", Check::WrittenForces, "Newton's and Euler's equations of every body with the written forces", 2e-14),
    ("written-coefficients", Check::WrittenForces, "a, b and c of `reduce` in the equations of every body", 1e-13),
    ("written-sections", Check::WrittenForces, "internal forces of links with equilibrium of the part beyond each cut", 2e-14),
    ("written-totals", Check::WrittenTotals, "shaking forces, powers and energies with sums over all bodies", 2e-14),
    ("written-reduced", Check::WrittenTotals, "m, ½m′ and w of `reduce` with sums over all bodies", 1e-12),
    ("written-calibration", Check::WrittenTotals, "the period of the calibrated scene by quadrature of the rows of `reduce`", 1e-11),
    ("written-section-ends", Check::WrittenTotals, "internal forces at the end of a link with what acts there", 2e-14),
    ("written-envelope", Check::WrittenForces, "internal forces of a link in the row of its largest moment with their envelope over all rows", 1e-14),
    ("written-dwell", Check::WrittenTotals, "the dwell that a scene requests with all windows of its rows", 1e-14),
    ("written-contents", Check::WrittenTotals, "masses, centre of mass, size and angles of `check` with the scene's text and a row of the start", 1e-14),
    ("written-laws", Check::WrittenLaws, "actuators of every row with the laws of the scene's text and their derivatives", 4e-13),
    ("written-loads", Check::WrittenLaws, "forces of loads with expressions and tables of the scene's text", 2e-14),
    ("written-runs", Check::WrittenTwice, "m, ½m′, a and b of `reduce` with two runs of kinetostatics, and with the columns that are requested", 4e-11),
    ("written-files", Check::WrittenTwice, "CSV with NPZ, extrema and peaks of the summary with the rows", 1e-12),
    ("written-laws-again", Check::WrittenTwice, "motions of drawn laws with the same motions as expressions, or by tables turned by half a turn", 3e-12),
    ("written-table", Check::WrittenTwice, "the table of `reduce` with its rows, beyond the errors that it states", 1e-13),
    ("written-table-sums", Check::WrittenTotals, "m, ½m′ and w of the table of `reduce` with sums over all bodies", 2e-6),
    ("written-table-bodies", Check::WrittenForces, "a, b and c of the table of `reduce` in the equations of every body", 2e-6),
    ("written-code", Check::WrittenTwice, "code of `symbolic` in Rust, Python and C, run line by line, with the rows of `reduce`", 1e-11),
    ("written-formulas", Check::WrittenTwice, "formulas of `symbolic` in LaTeX, with the printed constants of 12 digits, computed line by line, with the rows of `reduce`", 1e-9),
    ("written-sweep", Check::WrittenTwice, "extrema of m in rows of `sweep` with `reduce` of each changed scene", 1e-13),
    ("written-sweep-draws", Check::WrittenLaws, "varied numbers of `sweep` with a second generator of random numbers and the grid", 1e-14),
    ("written-sweep-distribution", Check::WrittenTotals, "random numbers of `sweep` with their distribution function (Kolmogorov and Smirnov)", 1.0),
    ("written-sweep-files", Check::WrittenTwice, "archive and Parquet files of `sweep` with its table", 1e-15),
    ("written-sweep-summary", Check::WrittenTotals, "statistics of the summary of `sweep` with its rows", 1e-13),
    ("written-sweep-motion", Check::WrittenTwice, "end, largest size, mean and root mean square of columns of motions in `sweep` with rows of `simulate` of the changed scene", 1e-14),
    ("written-sweep-sentences", Check::WrittenSentences, "numbers that `sweep` prints with its summary, to their digits", 1e-12),
    ("written-units", Check::WrittenUnits, "files of the scene with those of the scene in other units", 1e-11),
    ("written-joint-forces", Check::WrittenTotals, "magnitudes, directions and components along bodies of pins' forces with their components along the ground, and the powers of friction with its forces", 8e-15),
    ("written-motion-joint-forces", Check::WrittenTotals, "the same in rows of `simulate`", 8e-15),
    ("written-headings", Check::WrittenUnits, "units of the columns of `kinematics`, `statics`, `kinetostatics` and `reduce` with their names", 0.5),
    ("written-motion-headings", Check::WrittenUnits, "units of the columns of `simulate` with their names", 0.5),
    ("written-motion-closure", Check::WrittenPositions, "joints, points and coordinates of every row of `simulate` with the scene's text", 1e-14),
    ("written-motion-rates", Check::WrittenRates, "changes between rows of `simulate` with the integrals of their rates", 2e-7),
    ("written-motion-equations", Check::WrittenForces, "Newton's and Euler's equations of every body in every row of `simulate`, with loads, drives and friction of the scene's text", 3e-14),
    ("written-motion-forces", Check::WrittenLaws, "forces of drives and powers of friction in rows of `simulate` with those of the scene's text", 1e-13),
    ("written-motion-energies", Check::WrittenTotals, "columns of energies and works of `simulate` with the powers of the scene's text", 1e-9),
    ("written-motion-again", Check::WrittenTwice, "rows and events of `simulate` by its default method and by dop853", 2e-6),
    ("written-motion-energy", Check::WrittenEnergy, "kinetic energy between rows of `simulate` with the power of the forces of the scene's text, and currents with their circuits", 3e-8),
    ("written-motion-files", Check::WrittenTwice, "CSV of `simulate` with NPZ, extrema of the summary with the rows", 1e-11),
    ("written-motion-extrema", Check::WrittenRates, "extrema of the summary of `simulate` with the rows around them", 1e-6),
    ("written-motion-places", Check::WrittenRates, "slopes at the places of extrema of `simulate` by the rows around them, over one row", 1e-6),
    ("written-motion-extrema-again", Check::WrittenTwice, "extrema of `simulate` with those of the same motion by esdirk34 in other rows", 4e-5),
    ("written-motion-accuracy", Check::WrittenTwice, "coordinates of `simulate --accuracy 1e-8` with those by dop853 to 1e-12, and stated errors with the accuracy", 1e-8),
    ("written-motion-motors", Check::WrittenLaws, "electrical powers of motors in rows of `simulate` with voltage and current of the scene's text", 1e-15),
    ("written-motion-efficiency", Check::WrittenTotals, "efficiencies of motors in rows of `simulate` with the power at the shaft", 1e-14),
    ("written-motion-summary", Check::WrittenTotals, "energies and events of the summary of `simulate` with rows and events", 5e-6),
    ("written-motion-events", Check::WrittenRates, "events of `simulate` with changes of sign between rows: none is missing", 0.5),
    ("written-motion-change-points", Check::WrittenSentences, "change points that `check` names with those that `simulate` says it crosses", 1e-12),
    ("written-motion-sentences", Check::WrittenSentences, "numbers that `simulate` prints with the summary, to their digits", 1e-12),
    ("written-eigenvalues", Check::WrittenForces, "eigenvalues of `linearise` in the characteristic polynomial of the written A, and their sum with its trace", 1e-13),
    ("written-modes", Check::WrittenTotals, "frequencies and damping ratios of `linearise` and `equilibria` with their eigenvalues", 1e-14),
    ("written-linear", Check::WrittenForces, "A, B, C and D of `linearise` with differences of rows of `simulate` from neighbouring starts", 3e-10),
    ("written-rest", Check::WrittenForces, "accelerations of `simulate` that starts at rest in the equilibria of `equilibria`", 2e-14),
    ("written-rest-order", Check::WrittenTotals, "stability of neighbouring equilibria of one coordinate: the force at rest crosses zero in turn", 0.5),
    ("written-rest-start", Check::WrittenTotals, "distances of equilibria from the start with the start of the motion, what was searched with one revolution, and neutral directions with 1 as their largest part", 1e-14),
    ("written-rest-words", Check::WrittenSentences, "the stability that `equilibria` and `linearise` print with their eigenvalues", 0.5),
    ("written-rest-nearest", Check::WrittenTotals, "the equilibrium that `linearise` takes from a start near each of the table with the distance between both", 5e-15),
    ("written-rest-again", Check::WrittenTwice, "the equilibrium of `linearise` and its modes with the table of `equilibria`", 1e-14),
    ("written-static-force", Check::WrittenTotals, "the smallest and the largest static force of `equilibria` with rows of `statics`, an equilibrium wherever it changes its sign, and none where every position is one", 1e-14),
    ("written-damped", Check::WrittenTotals, "the modes of `equilibria` with a damper of known damping ratio, with those of a damped oscillator", 1e-14),
    ("written-rest-modes", Check::WrittenTwice, "modes of `equilibria` with eigenvalues of `linearise` about the equilibria", 2e-14),
    ("written-linear-equations", Check::WrittenForces, "Newton's and Euler's equations of every body in these rows, with loads, drives and friction of the scene's text", 3e-14),
    ("written-linear-again", Check::WrittenTwice, "A, B, C and D of `linearise` with differences of its rates and outputs at neighbouring starts", 3e-10),
    ("written-point-files", Check::WrittenTwice, "the table of `equilibria` with its summary", 1e-14),
    ("written-point-sentences", Check::WrittenSentences, "numbers that `linearise` and `equilibria` print with their summaries, to their digits", 1e-12),
    ("written-cycle", Check::WrittenTotals, "speeds, fluctuation and works of the summary of `cycle` with its rows", 1e-8),
    ("written-cycle-rates", Check::WrittenRates, "changes between rows of `cycle` with the integrals of their rates", 6e-9),
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
