//! The initial value problem of a motion, in the plane or in space, as the search for a method to an accuracy knows it.

use crate::explain::StudyError;
use crate::free_motion::compute::{Difference, FreeMotionProblem, MotionProblem, SegmentedMotion};
use crate::ranges::extent;
use dwell_dynamics::{Options, Statistics};

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
        self.solve_on_table(visited, duration, options)
    }

    fn difference_of(&self, [one, two]: [&SegmentedMotion; 2]) -> Result<Difference, StudyError> {
        let difference = self.difference(one, two);
        difference.map_err(|error| self.explain(&error))
    }

    fn statistics(motion: &SegmentedMotion) -> Statistics {
        motion.statistics
    }

    fn reached_end(motion: &SegmentedMotion) -> bool {
        motion.failure.is_none()
    }
}
