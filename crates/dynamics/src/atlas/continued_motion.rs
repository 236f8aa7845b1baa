//! A motion through several charts.

use super::Atlas;
use crate::error::{DynamicsError, Result};
use crate::ode::OdeState;
use crate::options::Statistics;
use crate::solve::{EventOccurrence, Solution};
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use std::f64::consts::TAU;

/// A motion through one or more charts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ContinuedMotion {
    /// The parts of it in one chart each, in order; samples go on from one to the next.
    pub segments: Vec<Segment>,
    /// Where and why the chart was changed: one fewer than the segments, or as many if it ended with one.
    pub changes: Vec<ChartChange>,
    /// Whether an event ended it.
    pub terminated_by_event: bool,
    /// The error that ended it early, if one did.
    pub error: Option<DynamicsError>,
}

/// A part of a motion in one chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Index in [`Atlas::charts`].
    pub chart: usize,
    /// The motion, in states of that chart's machine. Its `error` is set too where another chart
    /// continues the motion.
    pub solution: Solution,
}

/// A change of chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChartChange {
    /// When, s.
    pub t: f64,
    /// From which chart, and to which.
    pub from: usize,
    /// To which chart.
    pub to: usize,
    /// Why.
    pub reason: ChartChangeReason,
}

/// Why a chart was left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ChartChangeReason {
    /// Its coordinate folds back: another moved many times as fast.
    CoordinateFold {
        /// The ratio of their speeds, lengths by the mechanism's size.
        speed_ratio: f64,
    },
    /// It could not be continued.
    SolutionEnds,
    /// A change point was crossed, to the same coordinate on the branch behind.
    CrossesChangePoint {
        /// Index in [`Atlas::change_point_fits`].
        fit: usize,
    },
}

/// A coordinate along a motion: value, speed and acceleration, rad or m, per s, per s².
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CoordinateHistory {
    /// By segment, at its steps.
    pub steps: Vec<Vec<[f64; 3]>>,
    /// By segment, at its samples.
    pub samples: Vec<Vec<[f64; 3]>>,
}

impl ContinuedMotion {
    /// Adds the solution in one chart; it continues the last segment if the chart is the same.
    pub(super) fn append(&mut self, chart: usize, solution: Solution) {
        let same = self.segments.len() == self.changes.len() + 1;
        let Some(segment) = self.segments.last_mut().filter(|_| same) else {
            self.segments.push(Segment { chart, solution });
            return;
        };
        let whole = &mut segment.solution;
        whole.steps.extend(solution.steps.into_iter().skip(1));
        whole.samples.extend(solution.samples);
        let occurrences = solution.event_occurrences;
        whole.event_occurrences.extend(occurrences);
        whole.contact_events.extend(solution.contact_events);
        whole.terminated_by_event = solution.terminated_by_event;
        whole.error = solution.error;
        whole.statistics = whole.statistics.plus(solution.statistics);
    }

    /// The events in order, each with its segment.
    pub fn event_occurrences(&self) -> impl Iterator<Item = (usize, &EventOccurrence)> {
        let segments = self.segments.iter().enumerate();
        segments.flat_map(|(i, segment)| {
            let occurrences = segment.solution.event_occurrences.iter();
            occurrences.map(move |o| (i, o))
        })
    }

    /// The work of all segments together.
    pub fn statistics(&self) -> Statistics {
        let each = self.segments.iter().map(|s| s.solution.statistics);
        each.fold(Statistics::default(), Statistics::plus)
    }
}

impl Atlas<'_> {
    /// The coordinate of the mechanism's own actuator.
    pub fn actuator_coordinate(&self) -> CoordinateFunction {
        self.candidates[0].measured
    }

    /// A coordinate along a motion. Angles have no jumps: where no chart counts their revolutions, they continue
    /// from the last value; the first is in the chart's own count.
    ///
    /// # Errors
    /// [`DynamicsError`] where a state cannot be evaluated.
    pub fn coordinate_history(
        &self,
        motion: &ContinuedMotion,
        measured: CoordinateFunction,
    ) -> Result<CoordinateHistory> {
        let mut history = CoordinateHistory::default();
        let mut last: Option<(f64, [f64; 3])> = None;
        for Segment { chart, solution } in &motion.segments {
            let machine = &self.charts[*chart].machine;
            let mut workspace = machine.workspace();
            let mut found = [Vec::new(), Vec::new()];
            // The whole revolutions by which this chart's count differs, if it counts.
            let mut revolution_offset: Option<f64> = None;
            let steps = solution.steps.iter().map(|point| (0, point));
            let samples = solution.samples.iter().map(|point| (1, point));
            let mut points: Vec<(usize, &OdeState)> = steps.chain(samples).collect();
            points.sort_by(|(_, one), (_, other)| one.t.total_cmp(&other.t));
            for (list, point) in points {
                let mut state = machine.evaluate(point.t, &point.y, &mut workspace)?;
                let states = state.bodies();
                let mut now = states.coordinate(measured);
                if let (CoordinateFunction::Angle(_), Some((t, before))) = (measured, last) {
                    let near = before[0] + 0.5 * (before[1] + now[1]) * (point.t - t);
                    let whole_revolutions = TAU * ((near - now[0]) / TAU).round();
                    now[0] += revolution_offset.unwrap_or(whole_revolutions);
                    if counts_revolutions(measured, states) {
                        revolution_offset.get_or_insert(whole_revolutions);
                    }
                } else if last.is_none() {
                    revolution_offset = counts_revolutions(measured, states).then_some(0.0);
                }
                last = Some((point.t, now));
                found[list].push(now);
            }
            let [steps, samples] = found;
            history.steps.push(steps);
            history.samples.push(samples);
        }
        Ok(history)
    }
}

/// Whether the whole revolutions of an angle are counted.
fn counts_revolutions(measured: CoordinateFunction, states: &BodyStates) -> bool {
    match measured {
        CoordinateFunction::Angle(bodies) => {
            bodies.into_iter().all(|b| states.body(b).angle.is_some())
        }
        CoordinateFunction::Travel { .. } | CoordinateFunction::Length { .. } => false,
    }
}
