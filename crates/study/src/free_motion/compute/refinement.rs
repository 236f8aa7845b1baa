//! A motion at finer and finer tolerances, until two runs agree.

use crate::explain::StudyError;
use crate::free_motion::compute::{Difference, FreeMotionProblem, SegmentedMotion};
use dwell_dynamics::{Method, ObservedMachine, Options, TabulatedMachine, solve_system};
use dwell_kinetostatics::TableDomain;

/// Tolerance of the coarse run.
pub(super) const COARSE_TOLERANCE: f64 = 1e-4;
/// The finest tolerances: below them only rounding changes, and Newton's method cannot meet them.
pub(super) const MIN_TOLERANCE: f64 = 1e-14;
const MIN_IMPLICIT_TOLERANCE: f64 = 1e-13;
/// First tolerance, relative to the required accuracy: an integrator's error is tens of times its tolerance.
pub(super) const FIRST_TOLERANCE_RATIO: f64 = 1e-2;
/// Error aimed at after an error that was too large, relative to the required accuracy.
const TARGET_ERROR_RATIO: f64 = 0.2;
/// Smallest and largest factor of one refinement of the tolerance.
const TOLERANCE_FACTORS: [f64; 2] = [1e-4, 0.1];
/// The error of the finer run is a tenth to a half of the difference from the run before; the worst ratio measured
/// is 2.2 (nine cases, eleven accuracies each).
const SAFETY_FACTOR: f64 = 2.5;
/// Accuracy of a table relative to the tolerance, and its finest value.
const TABLE_TOLERANCE_RATIO: f64 = 0.1;
const MIN_TABLE_TOLERANCE: f64 = 1e-13;
/// Margin of a table of a limited range beyond the coarse run, relative to the range of that run.
const TABLE_MARGIN: f64 = 0.05;
/// How many times as many steps the finer of two runs must take for their difference to be an error of all parts of the
/// motion; else the error is at least the tolerance.
const INDEPENDENT_STEPS: f64 = 1.2;
/// The factor to the next tolerance where the last one changed no step.
const EQUAL_STEPS_FACTOR: f64 = 1e-3;
/// Maximum number of runs.
const MAX_RUNS: usize = 6;

/// How a motion may be computed: by a method, and on a table if the interval that it visits is given.
pub(super) type Candidate = (Method, Option<[f64; 2]>);

/// The result of a refinement.
pub(super) struct Refinement {
    pub(super) tolerance: f64,
    pub(super) motion: SegmentedMotion,
    /// The run before, with which it was compared.
    pub(super) before: SegmentedMotion,
    pub(super) difference: Difference,
    pub(super) runs: usize,
}

impl FreeMotionProblem<'_> {
    /// The motion on a table whose accuracy follows the tolerance, so that the difference of two runs contains both
    /// errors. `None` if there is no such table, or the motion leaves it.
    pub(super) fn solve_on_table(
        &self,
        visited: [f64; 2],
        duration: f64,
        options: &Options,
    ) -> Result<Option<SegmentedMotion>, StudyError> {
        let [low, high] = visited;
        let margin = TABLE_MARGIN * (high - low);
        let domain = match self.machine.model().plan().range().limits() {
            None => TableDomain::Full,
            Some((from, to)) => {
                TableDomain::Between((low - margin).max(from), (high + margin).min(to))
            }
        };
        let accuracy = (TABLE_TOLERANCE_RATIO * options.rtol).max(MIN_TABLE_TOLERANCE);
        let Ok(table) = TabulatedMachine::new(&self.machine, accuracy, domain) else {
            return Ok(None);
        };
        let start = self.initial_state();
        let work = self.machine.largest_work(start.t, duration);
        let ode = table.ode(start.t, &start.y, work);
        let mut ode = ode.map_err(|e| self.explain(&e))?;
        let outputs = ObservedMachine::new(&self.machine, &self.output_model);
        let events = self.events();
        let solution = solve_system(&mut ode, outputs, &start, Some(duration), options, &events);
        let solution = solution.map_err(|e| self.explain(&e))?;
        let is_complete = solution.error.is_none();
        Ok(is_complete.then(|| SegmentedMotion::single_segment(solution)))
    }

    /// Repeats the motion at finer tolerances until two runs agree; keeps the last. `None` if a run cannot be made.
    pub(super) fn refine(
        &self,
        accuracy: f64,
        method: Method,
        last: Option<(f64, SegmentedMotion)>,
        solve: &dyn Fn(f64) -> Result<Option<SegmentedMotion>, StudyError>,
    ) -> Result<Option<Refinement>, StudyError> {
        let min_tolerance = match method.is_implicit() {
            true => MIN_IMPLICIT_TOLERANCE,
            false => MIN_TOLERANCE,
        };
        let first =
            (FIRST_TOLERANCE_RATIO * accuracy).clamp(10.0 * min_tolerance, COARSE_TOLERANCE);
        // The coarse run serves as the first comparison.
        let (mut tolerance, mut kept) = match last {
            Some((tolerance, motion)) if 0.1 * tolerance <= first => (tolerance, motion),
            _ => match solve(first)? {
                Some(motion) => (first, motion),
                None => return Ok(None),
            },
        };
        let mut next = (0.1 * tolerance).min(first).max(min_tolerance);
        let mut runs = 1;
        loop {
            let Some(motion) = solve(next)? else {
                return Ok(None);
            };
            let difference = self.difference(&kept, &motion);
            let difference = difference.map_err(|e| self.explain(&e))?;
            tolerance = next;
            runs += 1;
            // Switches may divide a motion into parts of a step each, which two tolerances take alike: their difference
            // shows nothing.
            let [steps, kept_steps] = [&motion, &kept].map(|run| run.statistics.steps as f64);
            if steps <= kept_steps && next > 1.01 * min_tolerance && runs < MAX_RUNS {
                next = (EQUAL_STEPS_FACTOR * next).max(min_tolerance);
                continue;
            }
            let least = f64::from(u8::from(steps < INDEPENDENT_STEPS * kept_steps)) * next;
            let difference = difference.scaled(SAFETY_FACTOR).with_minimum(least);
            let largest = difference.largest();
            let before = std::mem::replace(&mut kept, motion);
            if largest <= accuracy || next <= 1.01 * min_tolerance || runs >= MAX_RUNS {
                return Ok(Some(Refinement {
                    tolerance,
                    motion: kept,
                    before,
                    difference,
                    runs,
                }));
            }
            let [min_factor, max_factor] = TOLERANCE_FACTORS;
            let factor = match largest.is_finite() {
                true => TARGET_ERROR_RATIO * accuracy / largest,
                false => max_factor,
            };
            next = (tolerance * factor.clamp(min_factor, max_factor)).max(min_tolerance);
        }
    }
}
