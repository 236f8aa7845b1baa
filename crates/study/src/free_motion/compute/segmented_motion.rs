//! A free motion as a sequence of segments.

use crate::trajectory::compute::TrajectorySample;
use dwell_dynamics::atlas::{Chart, CoordinateHistory};
use dwell_dynamics::{DynamicsError, EventOccurrence, OdeState, Orbit, Solution, Statistics};
use dwell_findings::Record;

/// A computed motion and its description.
pub(crate) struct ComputedMotion<C = Chart> {
    pub(crate) motion: SegmentedMotion<C>,
    /// The method, for captions and the summary.
    pub(crate) method_text: String,
    /// Further lines of the summary.
    pub(crate) remarks: String,
    /// The numbers in them.
    pub(crate) record: Record,
    /// The required accuracy and the estimated error, if an accuracy was required.
    pub(crate) accuracy: Option<[f64; 2]>,
    /// Why it is no result although nothing failed, if so.
    pub(crate) inaccuracy: Option<String>,
    /// A second computation, whose difference shows the errors.
    pub(crate) comparison: Option<SegmentedMotion<C>>,
    /// The samples of the motion and of the second computation, where they have been evaluated already.
    pub(crate) evaluated: [Option<Vec<TrajectorySample>>; 2],
    /// The relative error of all times, where the second computation is the same motion delayed.
    pub(crate) delay: Option<f64>,
}

impl<C> Default for ComputedMotion<C> {
    fn default() -> Self {
        Self {
            motion: SegmentedMotion::default(),
            method_text: String::new(),
            remarks: String::new(),
            record: Record::default(),
            accuracy: None,
            inaccuracy: None,
            comparison: None,
            evaluated: [None, None],
            delay: None,
        }
    }
}

impl<C> ComputedMotion<C> {
    /// Ends it and its second computation at their last samples up to a time, s.
    pub(crate) fn end_at(&mut self, t: f64) {
        let second = self.comparison.as_mut();
        let both = second.into_iter().chain([&mut self.motion]);
        both.for_each(|motion| motion.end_at(t));
    }
}

/// A free motion as a sequence of segments, each in one chart.
pub struct SegmentedMotion<C = Chart> {
    /// Empty if the mechanism's own coordinate is used throughout. In space without that coordinate, which is chart 0.
    pub charts: Vec<C>,
    /// By segment: its chart and its solution.
    pub segments: Vec<(usize, Solution)>,
    /// By segment, at its steps and its samples: the only actuator's coordinate with two derivatives.
    pub(crate) actuator_coordinates: CoordinateHistory,
    /// The orbit that it was computed from, which is known at every time.
    pub(crate) orbit: Option<Orbit>,
    /// Lines of the summary about chart changes and change points.
    pub(crate) chart_changes: Vec<String>,
    /// Why it ended early, if it did.
    pub failure: Option<DynamicsError>,
    pub(crate) statistics: Statistics,
}

impl<C> Default for SegmentedMotion<C> {
    fn default() -> Self {
        Self {
            charts: Vec::new(),
            segments: Vec::new(),
            actuator_coordinates: CoordinateHistory::default(),
            orbit: None,
            chart_changes: Vec::new(),
            failure: None,
            statistics: Statistics::default(),
        }
    }
}

impl<C> SegmentedMotion<C> {
    /// A motion in the mechanism's own coordinates, whose last instant is a sample.
    pub(crate) fn single_segment(mut solution: Solution) -> Self {
        solution.sample_end();
        Self {
            failure: solution.error.clone(),
            statistics: solution.statistics,
            segments: vec![(0, solution)],
            ..Self::default()
        }
    }

    /// A motion by quadrature.
    pub(crate) fn along_orbit(orbit: Orbit, solution: Solution) -> Self {
        Self {
            orbit: Some(orbit),
            ..Self::single_segment(solution)
        }
    }

    /// Ends it at its last sample up to a time, s: where the table of a load ends, what follows is not known.
    pub(crate) fn end_at(&mut self, t: f64) {
        self.segments
            .iter_mut()
            .for_each(|(_, solution)| solution.end_at(t));
        self.segments
            .retain(|(_, solution)| !solution.steps.is_empty());
        self.failure = None;
    }

    /// The events that happened, each with the chart of its segment.
    pub fn occurrences(&self) -> impl Iterator<Item = (usize, &EventOccurrence)> {
        let segments = self.segments.iter();
        segments.flat_map(|(chart, s)| s.event_occurrences.iter().map(|o| (*chart, o)))
    }

    /// The time at which it ends, s.
    pub fn end_time(&self) -> f64 {
        let last = self.segments.last().and_then(|(_, s)| s.steps.last());
        last.map_or(0.0, |state| state.t)
    }

    pub(crate) fn steps(&self) -> impl Iterator<Item = (usize, &OdeState)> {
        let segments = self.segments.iter();
        segments.flat_map(|(chart, s)| s.steps.iter().map(|state| (*chart, state)))
    }

    pub(crate) fn samples(&self) -> impl Iterator<Item = (usize, &OdeState)> {
        let segments = self.segments.iter();
        segments.flat_map(|(chart, s)| s.samples.iter().map(|state| (*chart, state)))
    }

    /// Where a time (s) is; none outside the motion.
    pub(crate) fn place_of(&self, t: f64) -> Option<PlaceInMotion<'_>> {
        let holds = |steps: &[OdeState]| {
            let ends = steps.first().zip(steps.last());
            ends.is_some_and(|(first, last)| first.t <= t && t <= last.t)
        };
        let mut segments = self.segments.iter().enumerate();
        let (segment, (chart, solution)) = segments.find(|(_, (_, s))| holds(&s.steps))?;
        let begun = solution.steps.partition_point(|step| step.t <= t);
        Some(PlaceInMotion {
            segment,
            chart: *chart,
            solution,
            step: begun.checked_sub(1)?,
        })
    }
}

/// A step of a motion.
pub(crate) struct PlaceInMotion<'m> {
    pub(crate) segment: usize,
    pub(crate) chart: usize,
    /// That of the segment.
    pub(crate) solution: &'m Solution,
    /// The number of the step in it.
    pub(crate) step: usize,
}

impl<'m> PlaceInMotion<'m> {
    /// The steps of the segment.
    pub(crate) fn steps(&self) -> &'m [OdeState] {
        &self.solution.steps
    }
}
