//! The initial value problem of a motion, in the plane or in space, as the search for a method to an accuracy knows it.

use crate::explain::StudyError;
use crate::free_motion::compute::{Difference, FreeMotionProblem, MotionProblem, SegmentedMotion};
use crate::ranges::extent;
use dwell_dynamics::{ObservedMachine, Options, Statistics, TabulatedMachine, solve_system};
use dwell_kinetostatics::TableDomain;

/// Accuracy of a table relative to the tolerance, and its finest value.
const TABLE_TOLERANCE_RATIO: f64 = 0.1;
const MIN_TABLE_TOLERANCE: f64 = 1e-13;
/// Margin of a table of a limited range beyond the coarse run, relative to the range of that run.
const TABLE_MARGIN: f64 = 0.05;

/// A motion that can be integrated by any method to any tolerance.
pub(crate) trait TriedMotion: MotionProblem {
    /// A computed motion.
    type Motion;

    /// The motion over a duration, s.
    fn by_method(&self, duration: f64, options: &Options) -> Result<Self::Motion, StudyError>;

    /// The interval of the only coordinate that a coarse run visits, where a table of the machine may serve.
    fn range_for_table(&self, _coarse: &Self::Motion) -> Option<[f64; 2]> {
        None
    }

    /// The motion on a table of this interval whose accuracy follows the tolerance. `None` if there is no such table, or the motion
    /// leaves it.
    fn on_table(
        &self,
        _visited: [f64; 2],
        _duration: f64,
        _options: &Options,
    ) -> Result<Option<Self::Motion>, StudyError> {
        Ok(None)
    }

    /// The difference of the second motion from the first.
    fn difference_of(&self, motions: [&Self::Motion; 2]) -> Result<Difference, StudyError>;

    /// The work done.
    fn statistics(motion: &Self::Motion) -> Statistics;

    /// Whether nothing ended a motion early.
    fn reached_end(motion: &Self::Motion) -> bool;
}

impl TriedMotion for FreeMotionProblem<'_> {
    type Motion = SegmentedMotion;

    fn by_method(&self, duration: f64, options: &Options) -> Result<SegmentedMotion, StudyError> {
        self.solve(duration, options)
    }

    /// Where the motion stays in its own coordinate and assembly mode.
    fn range_for_table(&self, coarse: &SegmentedMotion) -> Option<[f64; 2]> {
        let is_single_segment = coarse.segments.len() == 1 && coarse.charts.len() <= 1;
        let stays = is_single_segment && Self::reached_end(coarse);
        let coordinates = coarse.steps();
        let coordinates = coordinates.filter_map(|(_, point)| point.y.first().copied());
        (stays && self.machine.free() == [0]).then(|| extent(coordinates))
    }

    fn on_table(
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
        let outputs = ObservedMachine::new(&self.machine, &self.output_model).in_modes(ode.modes());
        let events = self.events();
        let solution = solve_system(&mut ode, outputs, &start, Some(duration), options, &events);
        let mut solution = solution.map_err(|e| self.explain(&e))?;
        solution.add_contact_events(ode.take_contact_events());
        solution.modes = ode.modes().take();
        let is_complete = solution.error.is_none();
        Ok(is_complete.then(|| SegmentedMotion::single_segment(solution)))
    }

    fn difference_of(&self, [one, two]: [&SegmentedMotion; 2]) -> Result<Difference, StudyError> {
        let difference = self.difference(one, two);
        let difference = difference.map_err(|error| self.explain(&error))?;
        Ok(difference.with_imbalance(self.imbalance(one)))
    }

    fn statistics(motion: &SegmentedMotion) -> Statistics {
        motion.statistics
    }

    fn reached_end(motion: &SegmentedMotion) -> bool {
        motion.failure.is_none()
    }
}
