//! A motion of one degree of freedom continued through dead points and change points.
//!
//! At a dead point a coordinate folds back (a slider at the end of its stroke), and its inertia tends to infinity.
//! The motion then continues in another coordinate of the same mechanism: another *chart*, which replaces the
//! actuator and keeps all else, loads and drives. A chart is left when some coordinate moves 8 times as fast as its
//! own, lengths by the mechanism's size; the new one is the fastest, so that it is not left again soon.
//!
//! A change point, where assembly branches meet, needs no other coordinate, but a chart on the branch
//! behind it, and a [`ChangePointFit`] across.

mod candidates;
mod continued_motion;
mod crossing;
mod monitor;
mod near_branch;
mod revolutions;

use crate::change_point_fit::{ChangePointFit, ChangePointFitError};
use crate::error::{DynamicsError, Result};
use crate::integrate::integrate;
use crate::machine::{CoordinateMode, Machine, MachineError};
use crate::machine_ode::MachineOde;
use crate::modes::SharedModes;
use crate::ode::{DenseOutput, OdeState, Step};
use crate::options::Options;
use crate::solve::{Event, ObservedMachine, RecorderState, Solution};
use candidates::{Candidate, candidates, with_actuator};
pub use continued_motion::{
    ChartChange, ChartChangeReason, ContinuedMotion, CoordinateHistory, Segment,
};
use crossing::ChangePointCrossing;
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_geometry::mechanism::BranchHint;
use dwell_geometry::{
    AssemblyConfiguration, BodyId, Coordinate, Joint, JointId, Mechanism, Reaction,
};
use dwell_kinetostatics::{Drive, Load, Mass, Model, ModelError, VaryingInertia};
use monitor::{ChartExit, ChartMonitor};
use near_branch::Passage;
use revolutions::load_angles;

/// A chart is left when another coordinate moves this many times as fast as its own.
const FOLD_SPEED_RATIO: f64 = 8.0;
/// Coordinates tried for the next chart before the motion ends.
const MAX_CANDIDATES: usize = 6;
/// Successive charts without a step after which the motion ends.
const MAX_IDLE_CHARTS: usize = 3;
/// The factor of the longest step after one that was too long.
const STEP_REDUCTION: f64 = 0.25;
/// How far steps that may have jumped over a fit window are shortened at most.
const MIN_STEP_RATIO: f64 = 1e-2;
/// Poses that differ by less, rad, count as equal.
const POSE_TOLERANCE: f64 = 1e-6;

/// A mechanism of one degree of freedom with its loads and drives.
#[derive(Debug, Clone, Copy)]
pub struct MachineDescription<'s> {
    /// The mechanism, with one actuator, whose coordinate is free.
    pub mechanism: &'s Mechanism,
    /// By body.
    pub masses: &'s [Mass],
    /// The bodies whose moment of inertia is a function of their angle.
    pub varying_inertias: &'s [VaryingInertia],
    /// Its assembly configuration.
    pub assembly: &'s AssemblyConfiguration,
    /// Its loads.
    pub loads: &'s [Load],
    /// Its drives.
    pub drives: &'s [Drive],
    /// The reactions of the output models.
    pub reactions: &'s [Reaction],
}

/// The mechanism in one of its coordinates, on one assembly branch.
#[derive(Debug, Clone)]
pub struct Chart {
    /// The name of the coordinate: the actuator's name at first, then `angle of crank` and the like.
    pub name: String,
    /// The coordinate.
    pub coordinate: Coordinate,
    /// The machine that moves.
    pub machine: Machine,
    /// The model with all loads (the drives' last) and the requested reactions.
    pub output_model: Model,
    /// By end of its range: whether a change-point fit was tried.
    limits_searched: [bool; 2],
}

/// Why an atlas cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AtlasError {
    /// The mechanism cannot be assembled.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Its loads or drives do not fit.
    #[error(transparent)]
    Machine(#[from] MachineError),
}

/// The charts of a mechanism that were needed so far.
#[derive(Debug, Clone)]
pub struct Atlas<'s> {
    description: MachineDescription<'s>,
    candidates: Vec<Candidate>,
    charts: Vec<Chart>,
    crossings: Vec<ChangePointCrossing>,
    uncrossable: Vec<(f64, ChangePointFitError)>,
    /// The tolerance that the change-point fits were made for.
    tolerance: f64,
    /// By coordinate: the period, rad, after which its branches repeat, where known.
    periods: Vec<(Coordinate, f64)>,
    /// Of the mechanism: the length that lengths are compared with, m.
    size: f64,
}

impl<'s> Atlas<'s> {
    /// Begins with the chart of the mechanism's own actuator.
    ///
    /// # Errors
    /// [`AtlasError`] where that cannot be built.
    pub fn new(description: MachineDescription<'s>) -> Result<Self, AtlasError> {
        let size = description.mechanism.size();
        let candidates = candidates(description.mechanism, size);
        let mut atlas = Self {
            description,
            candidates,
            charts: Vec::new(),
            crossings: Vec::new(),
            uncrossable: Vec::new(),
            tolerance: f64::INFINITY,
            periods: Vec::new(),
            size,
        };
        if description.mechanism.actuators.len() != 1 {
            return Err(MachineError::CoordinateModes.into());
        }
        let first = atlas.build_chart(description.mechanism, description.assembly)?;
        atlas.charts.push(first);
        Ok(atlas)
    }

    /// The charts that were needed so far; the first is that of the mechanism's own actuator.
    pub fn charts(&self) -> &[Chart] {
        &self.charts
    }

    /// The change-point fits that were needed so far.
    pub fn change_point_fits(&self) -> impl ExactSizeIterator<Item = &ChangePointFit> {
        self.crossings.iter().map(|c| c.fit.as_ref())
    }

    /// Those of the change points that a motion comes to.
    pub fn change_points_of(&self, motion: &ContinuedMotion) -> Vec<&ChangePointFit> {
        let is_reached = |crossing: usize| {
            motion.segments.iter().any(|segment| {
                let windows = self.charts[segment.chart].machine.fit_windows.iter();
                let mut windows = windows.filter(|window| window.crossing == crossing);
                let steps = &segment.solution.steps;
                windows.any(|window| {
                    let mut pairs = steps.windows(2);
                    pairs.any(|pair| window.is_reached([pair[0].y[0], pair[1].y[0]]))
                })
            })
        };
        let fits = self.change_point_fits().enumerate();
        let met = fits.filter(|(crossing, _)| is_reached(*crossing));
        met.map(|(_, fit)| fit).collect()
    }

    /// The change points that cannot be crossed, and why.
    pub fn uncrossable(&self) -> &[(f64, ChangePointFitError)] {
        &self.uncrossable
    }

    fn build_chart(
        &self,
        mechanism: &Mechanism,
        assembly: &AssemblyConfiguration,
    ) -> Result<Chart, AtlasError> {
        let description = self.description;
        let (loads, drives) = (description.loads, description.drives);
        // Auxiliary bodies have no mass.
        let mut masses = description.masses.to_vec();
        masses.resize(mechanism.bodies.len().max(masses.len()), Mass::default());
        let compiled = |reactions: &[Reaction]| {
            Model::new(mechanism, &masses, assembly, reactions)?
                .with_varying_inertias(description.varying_inertias)
        };
        let model = compiled(&[])?;
        let modes = vec![CoordinateMode::Free; model.plan().actuators()];
        let machine = Machine::new(model, loads, modes, drives)?;
        let output_model = compiled(description.reactions)?;
        let output_model = output_model.with_loads(machine.model().loads().to_vec());
        let (name, coordinate) = match mechanism.actuators.first() {
            Some(actuator) => (actuator.name.clone(), actuator.coordinate()),
            None => return Err(MachineError::CoordinateModes.into()),
        };
        Ok(Chart {
            name,
            coordinate,
            machine,
            output_model: output_model.map_err(MachineError::from)?,
            limits_searched: [false; 2],
        })
    }

    /// Drops the change-point fits if they were made for a looser tolerance.
    fn tighten_tolerance(&mut self, tolerance: f64) {
        if tolerance < self.tolerance {
            self.tolerance = tolerance;
            self.crossings.clear();
            self.uncrossable.clear();
            self.periods.clear();
            for chart in &mut self.charts {
                chart.machine.fit_windows.clear();
                chart.limits_searched = [false; 2];
            }
        }
    }

    /// Integrates the motion from a state of the first chart until `end` (s), through as many charts as it
    /// takes. Where the first is enough, the result is that of [`solve`](crate::solve()), bit for bit.
    ///
    /// # Errors
    /// [`DynamicsError`] where not even the start can be evaluated, or an option cannot be used. What
    /// ends the motion later is in [`ContinuedMotion::error`].
    // Long because it is one loop: what ends a segment decides how the next one begins.
    pub fn solve(
        &mut self,
        start: &OdeState,
        end: f64,
        options: &Options,
        events: &[Event],
    ) -> Result<ContinuedMotion> {
        self.tighten_tolerance(options.rtol);
        let mut motion = ContinuedMotion::default();
        let mut recorder_state = RecorderState::new(start.t, events, options);
        let (mut chart, mut at) = (0, start.clone());
        let requested = options;
        let (mut options, mut max_step) = (*requested, None);
        let mut passage: Option<Passage> = None;
        let mut idle = 0;
        loop {
            self.prepare_crossings(chart);
            let within = (&at, end, passage);
            let (mut solution, exit) =
                match self.solve_chart(chart, within, &options, &mut recorder_state) {
                    // Nothing is left of the duration after a change.
                    Err(DynamicsError::DurationTooShort) if !motion.segments.is_empty() => {
                        return Ok(motion);
                    }
                    Err(error) if !motion.segments.is_empty() => {
                        motion.error = Some(error);
                        return Ok(motion);
                    }
                    found => found?,
                };
            let moved = solution.steps.len() > 1;
            idle = if moved { 0 } else { idle + 1 };
            options.max_steps = options.max_steps.saturating_sub(solution.statistics.steps);
            if let Some(last) = solution.steps.last() {
                at.clone_from(last);
            }
            if let Some(
                DynamicsError::MaxStepsReached { max_steps, .. }
                | DynamicsError::TooSlow { max_steps, .. },
            ) = &mut solution.error
            {
                // Those of the whole motion.
                *max_steps = requested.max_steps;
            }
            motion.terminated_by_event = solution.terminated_by_event;
            motion.error = solution.error.clone();
            motion.append(chart, solution);
            if motion.terminated_by_event || (motion.error.is_none() && at.t >= end) {
                return Ok(motion);
            }
            let exit = match exit {
                Some(ChartExit::StepTooLong(step, place)) => {
                    options.max_step = Some(STEP_REDUCTION * step);
                    passage = passage.or(place);
                    continue;
                }
                Some(ChartExit::PlacePassed) => {
                    (passage, options.max_step) = (None, requested.max_step);
                    continue;
                }
                Some(ChartExit::BranchesTooClose { q, half_width }) => {
                    let t = at.t;
                    motion.error = Some(DynamicsError::NearBranches { t, q, half_width });
                    return Ok(motion);
                }
                None if self.shorten_steps(chart, &at, &mut max_step) => {
                    options.max_step = max_step;
                    continue;
                }
                None if let Some((place, step)) =
                    self.charts[chart].shorter_step(&at, options.max_step) =>
                {
                    (passage, options.max_step) = (Some(place), Some(step));
                    continue;
                }
                None => self.fallback_exit(chart, &at),
                exit => exit,
            };
            (max_step, options.max_step) = (None, requested.max_step);
            passage = None;
            // A chart that must be left and cannot be ends the motion; so do charts that only lead to
            // each other.
            let exit = exit.filter(|_| idle < MAX_IDLE_CHARTS);
            let next = exit.and_then(|exit| self.switch_chart(chart, &at, &exit));
            let Some((to, y, reason)) = next else {
                let (t, q) = (at.t, at.y.first().copied().unwrap_or(f64::NAN));
                motion
                    .error
                    .get_or_insert(DynamicsError::LimitPosition { t, q });
                return Ok(motion);
            };
            motion.changes.push(ChartChange {
                t: at.t,
                from: chart,
                to,
                reason,
            });
            (chart, at.y) = (to, y);
        }
    }

    /// Integrates in one chart until the motion ends or leaves it.
    fn solve_chart(
        &self,
        chart: usize,
        (at, end, passage): (&OdeState, f64, Option<Passage>),
        options: &Options,
        recorder_state: &mut RecorderState<'_>,
    ) -> Result<(Solution, Option<ChartExit>)> {
        let current = &self.charts[chart];
        let modes = SharedModes::default();
        let observed = ObservedMachine::new(&current.machine, &current.output_model);
        let observed = observed.in_modes(&modes);
        let mut recorder = recorder_state.recorder(observed, at)?;
        let mut solution = recorder.begin_solution(at, options);
        let mut monitor = ChartMonitor::new(self, chart, passage);
        if let Some(exit_at_start) = monitor.exit_at_fold(at)? {
            return Ok((solution, Some(exit_at_start)));
        }
        let mut ode = MachineOde::until(&current.machine, at.t, &at.y, Some(end))?.in_modes(&modes);
        let mut exit = None;
        let mut observer = |before: &OdeState, now: &OdeState, dense: DenseOutput<'_>| {
            monitor.observe(&mut Step { before, now, dense }, &mut exit, |step| {
                recorder.record_step(&mut solution, options, step)
            })
        };
        let termination = integrate(&mut ode, at, Some(end), options, &mut observer)?;
        if termination.error.is_none() && exit.is_none() {
            recorder.record_end(&mut solution);
        }
        solution.add_contact_events(ode.take_contact_events());
        solution.modes = modes.take();
        solution.error = termination.error;
        solution.statistics = termination.statistics;
        Ok((solution, exit))
    }

    /// Shorter steps for a chart that failed, if the last ones may have led over its fit window.
    fn shorten_steps(&self, chart: usize, at: &OdeState, max_step: &mut Option<f64>) -> bool {
        let windows = self.charts[chart].machine.fit_windows.iter();
        let min_radius = windows.map(|window| window.fit.fit_radius).reduce(f64::min);
        let (Some(fit_radius), Some(&speed)) = (min_radius, at.y.get(1)) else {
            return false;
        };
        let first = 0.5 * fit_radius / speed.abs();
        let next = max_step.map_or(first, |last| 0.25 * last);
        let worth = next.is_finite() && next > MIN_STEP_RATIO * first;
        *max_step = Some(next);
        worth
    }

    /// The fastest other coordinates where a chart ends, if they are faster than its own.
    fn fallback_exit(&self, chart: usize, at: &OdeState) -> Option<ChartExit> {
        let speeds = ChartMonitor::new(self, chart, None)
            .candidate_speeds(at)
            .ok()?;
        speeds.faster_than(1.0).map(ChartExit::SolutionEnds)
    }

    /// The chart in which a motion continues, with its state there.
    fn switch_chart(
        &mut self,
        from: usize,
        at: &OdeState,
        exit: &ChartExit,
    ) -> Option<(usize, Vec<f64>, ChartChangeReason)> {
        let (speeds, reason) = match exit {
            ChartExit::StepTooLong(..)
            | ChartExit::PlacePassed
            | ChartExit::BranchesTooClose { .. } => return None,
            ChartExit::CrossesChangePoint { crossing, above } => {
                let to = self.crossings[*crossing].charts[usize::from(*above)];
                let reason = ChartChangeReason::CrossesChangePoint { fit: *crossing };
                return Some((to, at.y.clone(), reason));
            }
            ChartExit::CoordinateFold(speeds) => {
                let speed_ratio = speeds.max_ratio();
                (speeds, ChartChangeReason::CoordinateFold { speed_ratio })
            }
            ChartExit::SolutionEnds(speeds) => (speeds, ChartChangeReason::SolutionEnds),
        };
        let mut tried = speeds.fastest_first().take(MAX_CANDIDATES);
        tried.find_map(|candidate| {
            let (to, y) = self.state_in_chart(from, at, candidate)?;
            Some((to, y, reason))
        })
    }

    /// The state in the chart of another coordinate, which may have to be built.
    fn state_in_chart(
        &mut self,
        from: usize,
        at: &OdeState,
        candidate: usize,
    ) -> Option<(usize, Vec<f64>)> {
        let chosen = self.candidates[candidate].clone();
        let coordinate = chosen.coordinate;
        let machine = &self.charts[from].machine;
        let mut workspace = machine.workspace();
        let mut state = machine.evaluate(at.t, &at.y, &mut workspace).ok()?;
        let states = state.bodies().clone();
        let [q, q_dot, _] = states.coordinate(chosen.measured);
        let mut y = at.y.clone();
        (y[0], y[1]) = (q, q_dot);
        let target = OdeState { t: at.t, y };
        for (to, chart) in self.charts.iter().enumerate() {
            if chart.coordinate == coordinate {
                let mut target = target.clone();
                // Within its own range: which fit lies at which end depends on whole revolutions.
                target.y[0] = chart.machine.model.plan().range().wrap(q).unwrap_or(q);
                if self.matches_pose(chart, &target, &states) {
                    return Some((to, target.y));
                }
            }
        }
        let mechanism = with_actuator(self.description.mechanism, chosen.name, coordinate)?;
        let (mechanism, initial_guess) = self.with_counted_revolutions(mechanism, &states);
        let mut joints = branch_hints(self.description.mechanism, &states);
        joints.resize(mechanism.joints.len(), None);
        let assembly = AssemblyConfiguration {
            q: vec![q],
            initial_guess,
            branch_hints: joints,
        };
        let chart = self.build_chart(&mechanism, &assembly).ok()?;
        if !self.matches_pose(&chart, &target, &states) {
            return None;
        }
        self.charts.push(chart);
        Some((self.charts.len() - 1, target.y))
    }

    /// Whether a chart has the same pose, and the same angles on which loads depend.
    fn matches_pose(&self, chart: &Chart, at: &OdeState, states: &BodyStates) -> bool {
        let mut workspace = chart.machine.workspace();
        let Ok(mut state) = chart.machine.evaluate(at.t, &at.y, &mut workspace) else {
            return false;
        };
        let chart_states = state.bodies();
        // Beyond the mechanism's bodies come those that its actuator adds.
        let mut bodies = (0..self.description.mechanism.bodies.len()).map(BodyId);
        let counted = |s: &BodyStates, b: BodyId| s.body(b).angle.is_some();
        let alike = |bodies: [BodyId; 2]| {
            let difference = chart_states.angle(bodies)[0] - states.angle(bodies)[0];
            let loses = bodies
                .iter()
                .any(|&b| counted(states, b) && !counted(chart_states, b));
            difference.abs() < POSE_TOLERANCE && !loses
        };
        bodies.all(|b| {
            (chart_states.body(b).rotation - states.body(b).rotation).norm() < POSE_TOLERANCE
        }) && load_angles(&self.description).into_iter().all(alike)
    }
}

/// The branch hint of each joint at a state of the bodies: its travel, or the direction of its line.
fn branch_hints(mechanism: &Mechanism, states: &BodyStates) -> Vec<Option<f64>> {
    let joints = mechanism.joints.iter().enumerate();
    let of = |(j, joint): (usize, &Joint)| match joint.kind.branch_hint()? {
        BranchHint::Travel => {
            let travel = CoordinateFunction::find(mechanism, Coordinate::Travel(JointId(j)))?;
            Some(states.coordinate(travel)[0])
        }
        BranchHint::Direction => {
            let line = states.separation(joint.bodies, joint.points).direction?;
            Some(line.angle())
        }
    };
    joints.map(of).collect()
}
