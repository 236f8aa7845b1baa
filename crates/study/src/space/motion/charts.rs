//! Other coordinates in which a motion in space goes on.
//!
//! Next to a limit position of its coordinate, where that turns back and its inertia tends to infinity, a motion of one degree of
//! freedom continues in the coordinate of another joint: in a *chart*, the same scene driven there. It keeps loads, drives and
//! all else, and the bodies where they are; the coordinate of the scene is a function of the chart's.

use super::problem::SpaceMotionProblem;
use crate::explain::StudyError;
use crate::free_motion::compute::{
    ChartedProblem, Instant, MotionProblem as _, NumberedEvent, SegmentedMotion, first_changes,
};
use crate::number_format::digits;
use crate::space::trajectory::SpaceRows;
use crate::trajectory::compute::TrajectorySample;
use dwell_dynamics::{DynamicsError, Event, Machine, OdeState, Options, Solution};
use dwell_geometry::JointId;
use dwell_geometry::space::{
    Actuator, ActuatorKind, Condition, Coordinate, CoordinateFunction, Placement, Plan, Pose,
};
use dwell_kinetostatics::space::Model;
use dwell_kinetostatics::{MachineModel as _, Signal};
use dwell_scene::{EventTrigger, SpaceScene};
use std::borrow::Cow;
use std::f64::consts::TAU;

/// What an angle between two moving bodies counts against one from the ground: it may fold sooner.
const RELATIVE_ANGLE_WEIGHT: f64 = 0.5;
/// How far a chart may place a body, m by the size of the mechanism or rad, from where it was, and a coordinate from its value.
const SAME: f64 = 1e-7;

/// What a chart is to the scene's own coordinate.
#[derive(Debug, Clone, Copy)]
pub(super) struct OfChart {
    /// The scene's coordinate in the chart, and what it differs by, whole revolutions.
    own: CoordinateFunction,
    offset: f64,
}

/// A motion through one coordinate or more: its charts are those from number 1 on.
pub(super) type Motion = SegmentedMotion<SpaceMotionProblem<'static>>;

impl SpaceMotionProblem<'_> {
    /// The problem of each segment of a motion, and its solution.
    pub(super) fn parts<'p>(
        &'p self,
        motion: &'p Motion,
    ) -> impl DoubleEndedIterator<Item = (&'p SpaceMotionProblem<'p>, &'p Solution)> + Clone {
        let parts = motion.segments.iter();
        parts.map(move |(chart, solution)| (self.in_chart(motion, *chart), solution))
    }

    /// The problem in a chart.
    pub(super) fn in_chart<'p>(
        &'p self,
        motion: &'p Motion,
        chart: usize,
    ) -> &'p SpaceMotionProblem<'p> {
        let chart = chart.checked_sub(1).and_then(|k| motion.charts.get(k));
        chart.unwrap_or(self)
    }

    /// Lines of the summary: where the motion changes its coordinate.
    fn changes(&self, motion: &Motion) -> Vec<String> {
        let name = |chart: usize| {
            let scene = self.in_chart(motion, chart).scene();
            &scene.mechanism.actuators[0].name
        };
        let lines = motion.segments.windows(2).filter_map(|pair| {
            let [(from, _), (to, solution)] = pair else {
                return None;
            };
            let start = solution.steps.first().filter(|_| from != to)?;
            let (t, [from, to]) = (digits(start.t, 6), [*from, *to].map(name));
            Some(format!(
                "t = {t} s: coordinate changed from {from} (next to its dead point) to {to}"
            ))
        });
        lines.collect()
    }
}

impl ChartedProblem for SpaceMotionProblem<'_> {
    type Chart = SpaceMotionProblem<'static>;

    fn by_method(&self, duration: f64, options: &Options) -> Result<Motion, StudyError> {
        let motion = self.through_charts(options, duration);
        motion.map_err(|error| self.explain(&error))
    }

    fn events(&self) -> (Vec<Event<CoordinateFunction>>, &Model) {
        (self.events.clone(), &self.event_model)
    }

    fn rows(&self) -> &SpaceRows {
        &self.rows
    }

    fn charts<'p>(&'p self, motion: &'p Motion) -> Vec<(&'p SpaceScene, &'p SpaceRows)> {
        let charts = (0..=motion.charts.len()).map(|chart| self.in_chart(motion, chart));
        charts
            .map(|problem| (problem.scene(), &problem.rows))
            .collect()
    }

    fn result_reactions(&self) -> usize {
        self.rows.requested.len()
    }

    fn machine_in<'m>(&'m self, motion: &'m Motion, chart: usize) -> &'m Machine<Model> {
        &self.in_chart(motion, chart).machine
    }

    fn own_coordinate(
        &self,
        motion: &Motion,
        _: &Instant<'_>,
        sample: &TrajectorySample,
    ) -> Option<[f64; 3]> {
        let problem = self.in_chart(motion, sample.chart);
        problem.coordinate_of(problem.chart?, [&sample.q, &sample.q_dot, &sample.q_ddot])
    }

    fn describe_changes(&self, motion: &Motion) -> Vec<String> {
        let mut lines = first_changes(self.changes(motion));
        for (problem, solution) in self.parts(motion) {
            lines.extend(problem.describe_change_points(solution));
        }
        lines
    }

    fn coordinates_at(&self, motion: &Motion, event: &NumberedEvent) -> Option<Vec<f64>> {
        let problem = self.in_chart(motion, event.chart);
        let (at, mut workspace) = (&event.state, problem.machine.workspace());
        let state = problem.machine.evaluate(at.t, &at.y, &mut workspace).ok()?;
        let motion = [state.q(), state.q_dot(), state.q_ddot()];
        Some(match problem.chart {
            Some(chart) => problem.coordinate_of(chart, motion)?[..2].to_vec(),
            None => {
                let both = state.q().iter().zip(state.q_dot());
                both.flat_map(|(q, speed)| [*q, *speed]).collect()
            }
        })
    }

    fn explain_end(&self, motion: &Motion, error: &DynamicsError) -> StudyError {
        let last = self.parts(motion).next_back();
        let (problem, step) = last.map_or((self, None), |(p, s)| (p, s.steps.last()));
        problem.with_instant(error, problem.explain(error), step)
    }
}

impl SpaceMotionProblem<'_> {
    /// Whether the motion may change its coordinate: it has one, free, that an actuator of a joint drives, no contacts, whose modes
    /// belong to it, and no events that count revolutions from its start.
    pub(super) fn may_change_coordinate(&self) -> bool {
        let scene = self.scene();
        let [actuator] = &scene.mechanism.actuators[..] else {
            return false;
        };
        let counts = |event: &dwell_scene::NamedEvent<_, _>| {
            matches!(event.trigger, EventTrigger::Revolution(_))
        };
        !matches!(actuator.kind, ActuatorKind::Length(_))
            && self.machine.free() == [0]
            && !self.machine.has_contacts()
            && !self.spec.events.iter().any(counts)
    }

    /// The coordinate of the scene with its rate and acceleration, at a state of a chart.
    fn coordinate_of(&self, chart: OfChart, at: [&[f64]; 3]) -> Option<[f64; 3]> {
        let (plan, pose) = moved(self.machine.model().plan(), at)?;
        let [value, rate, acceleration] = plan.coordinate(&pose, chart.own);
        Some([value + chart.offset, rate, acceleration])
    }

    /// The chart in which a motion goes on from a state of this problem: one of those that there are, else a new one.
    pub(super) fn next_chart(
        &self,
        main: &SpaceMotionProblem<'_>,
        charts: &[SpaceMotionProblem<'static>],
        from: &OdeState,
    ) -> Option<NextChart> {
        let (q, q_dot) = (from.y[0], from.y[1]);
        let (plan, pose) = moved(self.machine.model().plan(), [&[q], &[q_dot], &[0.0]])?;
        let bodies = 0..self.scene().mechanism.bodies.len();
        let places: Vec<Placement> = bodies.map(|b| plan.placement(&pose, b)).collect();
        let own = match self.chart {
            Some(_) => self.own_value([q, q_dot])?,
            None => q,
        };
        self.candidates(plan, &pose)
            .into_iter()
            .find_map(|(kind, motion)| {
                let is_fit = |chart: &SpaceMotionProblem<'_>| {
                    chart.is_same(self, motion, &places, from) && chart.goes_on(motion)
                };
                let known = charts.iter().position(|chart| {
                    chart.drives(kind) && is_fit(chart) && chart.counts_from(own, motion)
                });
                if let Some(k) = known {
                    let state = charts[k].state_from(&self.machine, motion, from);
                    return Some(NextChart::Known(k + 1, state));
                }
                let chart = main.chart(kind, motion, &places)?;
                let chart = chart.counting_from(own, motion).filter(is_fit)?;
                let state = chart.state_from(&self.machine, motion, from);
                Some(NextChart::New(Box::new(chart), state))
            })
    }

    /// Whether the coordinate is not itself next to a limit position.
    fn goes_on(&self, [q, q_dot]: [f64; 2]) -> bool {
        let at = OdeState {
            t: 0.0,
            y: vec![q, q_dot],
        };
        !self
            .barriers(&at, true)
            .iter()
            .any(|barrier| barrier.is_beyond)
    }

    fn drives(&self, kind: ActuatorKind) -> bool {
        self.scene().mechanism.actuators[0].kind == kind
    }

    /// The coordinates of other joints, the fastest first, lengths by the size of the mechanism.
    fn candidates(&self, plan: &Plan, pose: &Pose) -> Vec<Candidate> {
        let mechanism = &self.scene().mechanism;
        let ground = mechanism.ground;
        let mut all = Vec::new();
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let id = JointId(j);
            // Of a screw the travel is the angle.
            let is_screw = joint.kind.holds(Condition::Thread);
            let angle = joint.kind.has_angle().then_some(ActuatorKind::Angle(id));
            let travel = joint.kind.has_travel() && !is_screw;
            let kinds = [angle, travel.then_some(ActuatorKind::Travel(id))];
            let weight = |kind: ActuatorKind| match kind {
                ActuatorKind::Angle(_) if joint.bodies.iter().any(|b| b.0 == ground) => 1.0,
                ActuatorKind::Angle(_) => RELATIVE_ANGLE_WEIGHT,
                ActuatorKind::Travel(_) | ActuatorKind::Length(_) => 1.0 / plan.size(),
            };
            for kind in kinds
                .into_iter()
                .flatten()
                .filter(|kind| !self.drives(*kind))
            {
                let function = plan.coordinate_function(mechanism, kind.coordinate(joint));
                if let Ok(function) = function {
                    let [value, rate, _] = plan.coordinate(pose, function);
                    let motion = [value, rate];
                    let speed = weight(kind) * rate.abs();
                    all.push((speed, (kind, motion)));
                }
            }
        }
        all.sort_by(|(one, _), (other, _)| other.total_cmp(one));
        all.into_iter().map(|(_, candidate)| candidate).collect()
    }

    /// The scene driven at another joint, with its bodies here; none where it cannot be driven there.
    fn chart(
        &self,
        kind: ActuatorKind,
        [q, q_dot]: [f64; 2],
        places: &[Placement],
    ) -> Option<SpaceMotionProblem<'static>> {
        let mut scene: SpaceScene = self.scene().clone();
        let own_joint = scene.mechanism.actuators[0].kind;
        let joint = &scene.mechanism.joints[kind.joint().0];
        let what = match kind {
            ActuatorKind::Angle(_) => "angle",
            ActuatorKind::Travel(_) | ActuatorKind::Length(_) => "travel",
        };
        let name = format!("{what} of {}", joint.name);
        scene.mechanism.actuators = vec![Actuator { name, kind }];
        scene.assembly.q = vec![q];
        scene.assembly.placements = places.to_vec();
        let spec = scene.motion.as_mut()?;
        spec.initial_coordinates = vec![q];
        spec.initial_velocities = vec![q_dot];
        let mut chart = SpaceMotionProblem::compiled(Cow::Owned(scene), Some(&self.rows)).ok()?;
        if let Some(tolerance) = self.tolerance {
            chart = chart.with_tolerance(tolerance);
        }
        let own = own_joint.coordinate(&self.scene().mechanism.joints[own_joint.joint().0]);
        let own = chart.event_model.coordinate_function(own).ok()?;
        chart.chart = Some(OfChart { own, offset: 0.0 });
        Some(chart)
    }

    /// Whether this chart goes on where another problem is: the bodies stand there, and the coordinates that anything depends on have
    /// their values. The scene's own coordinate takes its whole revolutions from there.
    fn is_same(
        &self,
        other: &SpaceMotionProblem<'_>,
        [q, q_dot]: [f64; 2],
        places: &[Placement],
        from: &OdeState,
    ) -> bool {
        let here = moved(self.machine.model().plan(), [&[q], &[q_dot], &[0.0]]);
        let (at, speed) = (from.y[0], from.y[1]);
        let there = moved(other.machine.model().plan(), [&[at], &[speed], &[0.0]]);
        let (Some((plan, pose)), Some((plan_there, pose_there))) = (here, there) else {
            return false;
        };
        let size = plan.size();
        let stands = |(b, place): (usize, &Placement)| {
            let found = plan.placement(&pose, b);
            let turned = place.rotation.inverse().after(&found.rotation).vector();
            let off = (found.position - place.position).norm() / size + turned.norm();
            off < SAME + 8.0 * f64::EPSILON * place.position.norm() / size
        };
        let mechanism = &self.scene().mechanism;
        let agrees = |of: &Coordinate| {
            let value = |plan: &Plan, pose: &Pose| {
                let function = plan.coordinate_function(mechanism, *of).ok()?;
                Some(plan.coordinate(pose, function)[0])
            };
            let both = value(plan, &pose).zip(value(plan_there, &pose_there));
            both.is_some_and(|(a, b)| (a - b).abs() < SAME * (1.0 + a.abs()))
        };
        places.iter().enumerate().all(stands) && self.used_coordinates().iter().all(agrees)
    }

    /// The coordinates whose values loads, drives, events and tables use: the scene's own among them.
    fn used_coordinates(&self) -> Vec<Coordinate> {
        let scene = self.scene();
        let mut all: Vec<Coordinate> = scene.coordinates.iter().map(|c| c.coordinate).collect();
        let signals = scene.loads.iter().map(|load| load.magnitude.signals());
        let inputs = scene.drives.iter();
        let signals = signals.chain(inputs.map(|drive| drive.kind.input().signals()));
        all.extend(signals.flatten().filter_map(|signal| match signal {
            Signal::Value(coordinate) => Some(*coordinate),
            Signal::Time | Signal::Velocity(_) => None,
        }));
        let by_kind = scene
            .loads
            .iter()
            .filter_map(|load| load.kind.angle_joint());
        all.extend(by_kind.map(Coordinate::Angle));
        all.extend(self.spec.events.iter().filter_map(|e| match e.trigger {
            EventTrigger::Reaches(of, _) | EventTrigger::Reversal(of) => Some(of),
            EventTrigger::Revolution(of) => Some(of),
            EventTrigger::Reaction(..) => None,
        }));
        all
    }

    /// A state of another coordinate's machine in this chart's: drives and works stay.
    fn state_from(
        &self,
        machine: &Machine<Model>,
        [q, q_dot]: [f64; 2],
        from: &OdeState,
    ) -> OdeState {
        let mut y = self.machine.initial_state(&[q], &[q_dot]);
        let (states, works) = (machine.drive_states(), machine.work_offset());
        y[self.machine.drive_states()].copy_from_slice(&from.y[states]);
        y[self.machine.work_offset()..].copy_from_slice(&from.y[works..]);
        OdeState { t: from.t, y }
    }

    /// The scene's own coordinate at a coordinate and a speed of this chart.
    fn own_value(&self, [q, q_dot]: [f64; 2]) -> Option<f64> {
        let found = self.coordinate_of(self.chart?, [&[q], &[q_dot], &[0.0]]);
        found.map(|[value, ..]| value)
    }

    /// Whether the scene's own coordinate has a value there.
    fn counts_from(&self, value: f64, at: [f64; 2]) -> bool {
        let found = self.own_value(at);
        found.is_some_and(|found| (found - value).abs() < SAME * (1.0 + value.abs()))
    }

    /// The same with the scene's own coordinate at a value there, which an angle may differ from by whole revolutions.
    fn counting_from(mut self, value: f64, at: [f64; 2]) -> Option<Self> {
        let found = self.own_value(at)?;
        let chart = self.chart.as_mut()?;
        if let CoordinateFunction::Angle { .. } = chart.own {
            chart.offset = TAU * ((value - found) / TAU).round();
        }
        self.counts_from(value, at).then_some(self)
    }

    /// The tolerance to which its machine crosses change points.
    pub(super) fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = Some(tolerance);
        self.machine = self.machine.with_change_points(tolerance);
        let impacts = self.impact_machine.take();
        self.impact_machine = impacts.map(|machine| machine.with_change_points(tolerance));
        self
    }
}

/// Where a motion goes on: the number of a chart, or a new one, with its state there.
pub(super) enum NextChart {
    Known(usize, OdeState),
    New(Box<SpaceMotionProblem<'static>>, OdeState),
}

/// A coordinate of another joint, its value and its rate.
type Candidate = (ActuatorKind, [f64; 2]);

/// A plan, and its pose at coordinates, speeds and accelerations.
fn moved<'p>(plan: &'p Plan, [q, q_dot, q_ddot]: [&[f64]; 3]) -> Option<(&'p Plan, Pose)> {
    let mut pose = plan.pose();
    plan.positions(q, &mut pose).ok()?;
    plan.velocities(q_dot, &mut pose);
    plan.accelerations(q_ddot, &mut pose);
    Some((plan, pose))
}
