//! Monitors the steps in a chart: whether its coordinate folds, or a change point is passed.

use super::near_branch::{NearBranchStep, Passage};
use super::{Atlas, Candidate, Chart, FOLD_SPEED_RATIO, POSE_TOLERANCE};
use crate::error::{DynamicsError, Result};
use crate::machine::MachineWorkspace;
use crate::ode::{OdeState, Step, StepControl};
use dwell_geometry::Motion;
use dwell_geometry::body_states::BodyStates;
use dwell_numerics::root;

/// Times the ratio at which a chart is left that a good step may lead to.
const FOLD_OVERSHOOT: f64 = 2.0;

/// How a chart is left.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ChartExit {
    /// Its coordinate folds back.
    CoordinateFold(CandidateSpeeds),
    /// The solution in it ends.
    SolutionEnds(CandidateSpeeds),
    /// It is not left: a step of this length (s) is too long to distinguish a reversal from a fold, or the place that
    /// it passes needs shorter steps.
    StepTooLong(f64, Option<Passage>),
    /// It is not left: the steps may grow again behind such a place.
    PlacePassed,
    /// It ends where branches are too close to distinguish.
    BranchesTooClose {
        /// Where they are nearest, rad or m, and the half-width within which they are near.
        q: f64,
        half_width: f64,
    },
    /// The motion continues behind a change point.
    CrossesChangePoint { crossing: usize, above: bool },
}

/// How fast the candidates move, relative to the present coordinate.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CandidateSpeeds {
    /// Candidates with the ratios of their speeds, the fastest first, without the present one.
    ratios: Vec<(usize, f64)>,
}

impl CandidateSpeeds {
    /// The ratio of the fastest.
    pub(super) fn max_ratio(&self) -> f64 {
        self.ratios.first().map_or(0.0, |(_, ratio)| *ratio)
    }

    /// The candidates, the fastest first.
    pub(super) fn fastest_first(&self) -> impl Iterator<Item = usize> + '_ {
        let moving = self.ratios.iter().filter(|(_, ratio)| *ratio > 0.0);
        moving.map(|&(candidate, _)| candidate)
    }

    /// These, if the ratio of the fastest exceeds a factor.
    pub(super) fn faster_than(self, factor: f64) -> Option<Self> {
        (self.max_ratio() > factor).then_some(self)
    }
}

pub(super) struct ChartMonitor<'a, 's> {
    atlas: &'a Atlas<'s>,
    chart: &'a Chart,
    /// Whether the range of its coordinate has limits.
    has_limits: bool,
    /// Whether other branches come near its branch.
    has_near_branches: bool,
    /// The place for which the steps are short now.
    passage: Option<Passage>,
    workspace: MachineWorkspace<f64>,
    unit_motion: Motion<f64>,
    unit_states: BodyStates,
}

impl<'a, 's> ChartMonitor<'a, 's> {
    pub(super) fn new(atlas: &'a Atlas<'s>, index: usize, passage: Option<Passage>) -> Self {
        let chart = &atlas.charts[index];
        let plan = chart.machine.model.plan();
        Self {
            atlas,
            chart,
            has_limits: plan.range().limits().is_some(),
            has_near_branches: !plan.near_branches().is_empty(),
            passage,
            workspace: chart.machine.workspace(),
            unit_motion: plan.motion(),
            unit_states: BodyStates::new(plan),
        }
    }

    /// Whether the coordinate folds at a state.
    pub(super) fn exit_at_fold(&mut self, at: &OdeState) -> Result<Option<ChartExit>> {
        if !self.has_limits || self.is_in_fit_window(at) {
            return Ok(None);
        }
        let fold = self.candidate_speeds(at)?.faster_than(FOLD_SPEED_RATIO);
        Ok(fold.map(ChartExit::CoordinateFold))
    }

    /// Checks a step, and takes it by `take` where it is good. `exit` is then how the chart is left
    /// from the end of the last step taken.
    pub(super) fn observe(
        &mut self,
        step: &mut Step<'_>,
        exit: &mut Option<ChartExit>,
        take: impl FnOnce(&mut Step<'_>) -> Result<StepControl>,
    ) -> Result<StepControl> {
        if !self.has_limits && !self.has_near_branches {
            return take(step);
        }
        if let Some(refused) = self.refused_step(step) {
            *exit = Some(refused);
            return Ok(StepControl::Stop);
        }
        if !self.has_limits {
            let next = take(step)?;
            let passed = self.place_passed(step.now);
            *exit = passed.filter(|_| next == StepControl::Continue);
            return Ok(exit.as_ref().map_or(next, |_| StepControl::Stop));
        }
        if let Some(fold) = self.fold_within(step)? {
            // What follows the fold is on another branch: the step is discarded.
            *exit = Some(fold);
            return Ok(StepControl::Stop);
        }
        // An explicit method may step to where nothing can be evaluated: that step is not good.
        let exit_after = self.exit_after_step(step.now)?;
        if let Some(ChartExit::CoordinateFold(speeds)) = &exit_after
            && speeds.max_ratio() > FOLD_OVERSHOOT * FOLD_SPEED_RATIO
        {
            // The nearer the fold, the more an error of the coordinate changes all others.
            *exit = Some(ChartExit::StepTooLong(step.duration(), None));
            return Ok(StepControl::Stop);
        }
        let next = take(step)?;
        if next == StepControl::Continue {
            *exit = exit_after;
        }
        Ok(if exit.is_some() {
            StepControl::Stop
        } else {
            next
        })
    }

    /// How the chart is left after a good step, if it is.
    fn exit_after_step(&mut self, now: &OdeState) -> Result<Option<ChartExit>> {
        let q = now.y[0];
        let mut windows = self.chart.machine.fit_windows.iter();
        if let Some(window) = windows.find(|window| window.has_passed(q)) {
            return Ok(Some(ChartExit::CrossesChangePoint {
                crossing: window.crossing,
                above: !window.above,
            }));
        }
        let fold = self.exit_at_fold(now)?;
        Ok(fold.or_else(|| self.place_passed(now)))
    }

    /// Why a step is not taken: it leads over a gap of the range, or past a near branch that it does not resolve.
    fn refused_step(&self, step: &Step<'_>) -> Option<ChartExit> {
        let (ends, length) = ([step.before, step.now].map(|at| at.y[0]), step.duration());
        if self.chart.steps_over_gap(ends) {
            return Some(ChartExit::StepTooLong(length, None));
        }
        match self.chart.near_branch_step(ends) {
            NearBranchStep::Resolved => None,
            NearBranchStep::TooLong(place) => Some(ChartExit::StepTooLong(length, Some(place))),
            NearBranchStep::Unresolvable { q, half_width } => {
                Some(ChartExit::BranchesTooClose { q, half_width })
            }
        }
    }

    /// Whether the place for which the steps are short lies behind.
    fn place_passed(&self, now: &OdeState) -> Option<ChartExit> {
        let place = self.passage?;
        place.is_passed(now.y[0]).then_some(ChartExit::PlacePassed)
    }

    /// The distance of a coordinate from the nearest limit of the range.
    fn distance_to_limit(&self, q: f64) -> f64 {
        let range = self.chart.machine.model.plan().range();
        match (range.limits(), range.wrap(q)) {
            (Some((from, to)), Ok(q)) => (q - from).min(to - q),
            _ => f64::INFINITY,
        }
    }

    fn is_in_fit_window(&self, at: &OdeState) -> bool {
        self.chart.machine.fit_at(at.y.first()).is_some()
    }

    /// Whether the coordinate folds within a step: its speed changes sign while others continue. A step that is
    /// longer than the distance from there to the range's end does not prove a reversal.
    fn fold_within(&mut self, step: &mut Step<'_>) -> Result<Option<ChartExit>> {
        let (before, now) = (step.before, step.now);
        let mut last = before.clone();
        for t in step.root_subintervals() {
            let point = step.state_at(t)?;
            if last.y[1] * point.y[1] < 0.0 {
                let speed = |t: f64| Ok::<_, DynamicsError>(step.state_at(t)?.y[1]);
                let zero = root::find(speed, last.t, point.t)?;
                let at = step.state_at(zero.unwrap_or(point.t))?;
                if !self.is_in_fit_window(&at) {
                    match self.candidate_speeds(&at) {
                        Ok(speeds) if speeds.max_ratio() <= FOLD_SPEED_RATIO => {
                            let [to_start, to_end] = [before, now].map(|p| at.y[0] - p.y[0]);
                            let distance = to_start.abs().max(to_end.abs());
                            if distance > self.distance_to_limit(at.y[0]) {
                                return Ok(Some(ChartExit::StepTooLong(step.duration(), None)));
                            }
                        }
                        Ok(speeds) => return Ok(Some(ChartExit::CoordinateFold(speeds))),
                        // The zero lies beyond the range's end, by the error of the step.
                        Err(_) => {
                            let speeds = self.candidate_speeds(&last);
                            let speeds = speeds.or_else(|_| self.candidate_speeds(before))?;
                            return Ok(Some(ChartExit::CoordinateFold(speeds)));
                        }
                    }
                }
            }
            last = point;
        }
        Ok(None)
    }

    /// The speeds of the candidates at a state, from the motion at unit speed.
    pub(super) fn candidate_speeds(&mut self, at: &OdeState) -> Result<CandidateSpeeds> {
        let machine = &self.chart.machine;
        let plan = machine.model.plan();
        let state = machine.evaluate(at.t, &at.y, &mut self.workspace)?;
        plan.velocities(state.pose(), &[1.0], &mut self.unit_motion);
        self.unit_states.fill(plan, state.pose(), &self.unit_motion);
        let candidates = &self.atlas.candidates;
        let is_present = |c: &&Candidate| c.coordinate == self.chart.coordinate;
        let present = candidates.iter().find(is_present).map_or(1.0, |c| c.weight);
        let mut ratios: Vec<(usize, f64)> = Vec::with_capacity(candidates.len());
        for (i, candidate) in candidates.iter().enumerate() {
            if candidate.coordinate != self.chart.coordinate {
                let [_, speed, _] = self.unit_states.coordinate(candidate.measured);
                let ratio = (speed * candidate.weight).abs() / present;
                // A coordinate that moves only by rounding is no candidate.
                ratios.push((i, if ratio > POSE_TOLERANCE { ratio } else { 0.0 }));
            }
        }
        ratios.sort_by(|a, b| b.1.total_cmp(&a.1));
        Ok(CandidateSpeeds { ratios })
    }
}
