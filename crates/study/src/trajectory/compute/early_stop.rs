//! The early end of a trajectory: where, why, and its message.

use crate::explain::{
    NamedScene as _, StudyError, TABLE_HELP, body_names_or_mechanism, describe_coordinate,
    describe_ends, describe_limit, discontinuous_coupling_error, joint_labels, non_finite_coupling,
    non_finite_coupling_error, off_table_error, scene_error,
};
use crate::number_format::digits;
use crate::trajectory::compute::{Trajectory, TrajectorySample};
use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{BodyId, Coordinate, JointId, Plan, PositionError, RangeLimit};
use dwell_kinetostatics::{KinetostaticsError, LoadShape as _};
use dwell_scene::{PlaneScene, SceneLocation};
use std::f64::consts::TAU;

/// Halvings between the last position that was reached and the first that was not.
const BISECTIONS: usize = 60;
/// Fraction of a step beyond a limit position at which its cause is evaluated.
const CAUSE_OFFSET: f64 = 1e-6;
/// Ratio of a body's angular velocity to its actuator's above which a limit position is near.
const DIVERGING_RATIO: f64 = 1e3;

/// The error if the next position of a limited angle lies in another revolution than the one before: the
/// mechanism may close there again, but cannot move there.
pub(crate) fn unreachable_error(plan: &Plan, previous: f64, q: f64) -> Option<PositionError> {
    let (from, to) = plan.range().limits()?;
    let revolution = |q: f64| ((q - from) / TAU).floor();
    (plan.is_angle(0) && to - from < TAU && revolution(previous) != revolution(q))
        .then_some(PositionError::OutOfRange { q, from, to })
}

/// Why a trajectory ends.
#[derive(Debug, Clone, Copy)]
pub enum StopCause {
    /// There is no pose, or a load is undefined.
    NoSolution(KinetostaticsError),
    /// The table of a load does not cover this value of its argument.
    OffTable { load: usize, value: f64 },
    /// A coupling function is discontinuous between two neighbouring values of its variable.
    Discontinuity { joint: JointId, between: [f64; 2] },
}

impl<E: Into<KinetostaticsError>> From<E> for StopCause {
    fn from(error: E) -> Self {
        Self::NoSolution(error.into())
    }
}

/// Where a trajectory ends.
pub struct EarlyStop<'a> {
    pub(crate) trajectory: &'a Trajectory<'a>,
    /// The completed fractions of the last position that was reached and of the first that was not.
    pub(crate) fractions: [f64; 2],
    /// Why.
    pub(crate) cause: StopCause,
    /// The last position that was reached; `None` if not even the first was.
    pub(crate) last: Option<TrajectorySample>,
    pub(crate) failed: TrajectorySample,
}

impl EarlyStop<'_> {
    /// The error message in the plane, with its locations in the scene.
    pub(super) fn in_plane(&self, scene: &PlaneScene, plan: &Plan) -> StudyError {
        PlaneStop::find(plan, self).explain(scene)
    }
}

/// Where a trajectory ends in the plane.
struct PlaneStop<'a> {
    plan: &'a Plan,
    trajectory: &'a Trajectory<'a>,
    /// Why.
    cause: StopCause,
    /// The last position that can be reached; the first one if not even that can be.
    last_reached: TrajectorySample,
    /// A position a little beyond it that cannot be reached.
    first_failed: TrajectorySample,
    /// Whether at least the first position can be reached.
    has_begun: bool,
}

impl<'a> PlaneStop<'a> {
    /// Finds the end between the last position that was reached and the next.
    fn find(plan: &'a Plan, stop: &EarlyStop<'a>) -> Self {
        let (trajectory, [reached, beyond]) = (stop.trajectory, stop.fractions);
        let (mut low, mut high) = (reached, beyond);
        if let StopCause::NoSolution(KinetostaticsError::Position(_)) = stop.cause {
            let start = trajectory.sample_at(reached).q;
            let mut pose = plan.pose();
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                let q = trajectory.sample_at(middle).q;
                let unreachable =
                    plan.actuators() == 1 && unreachable_error(plan, start[0], q[0]).is_some();
                let is_reached = !unreachable && plan.positions(&q, &mut pose).is_ok();
                if is_reached {
                    low = middle;
                } else {
                    high = middle;
                }
            }
        }
        let failed = (high + CAUSE_OFFSET * (beyond - reached)).min(beyond);
        Self {
            plan,
            trajectory,
            cause: stop.cause,
            last_reached: trajectory.sample_at(low),
            first_failed: trajectory.sample_at(failed),
            has_begun: beyond > reached,
        }
    }

    /// The error message, with its locations in the scene.
    fn explain(&self, scene: &PlaneScene) -> StudyError {
        let position = self.describe_position(scene);
        let when = if self.has_begun {
            format!("soon after {position}")
        } else {
            format!("at the first position, {position}")
        };
        match self.cause {
            StopCause::NoSolution(KinetostaticsError::Position(error)) => {
                self.explain_limit(scene, &position, &error)
            }
            StopCause::NoSolution(error) => explain_load(scene, error, &when),
            StopCause::OffTable { load, value } => {
                let magnitude = &scene.loads[load].magnitude;
                let name_of = |c| scene.name_of(c);
                let is_angle = |c: Coordinate| c.is_angle();
                off_table_error(scene, magnitude, name_of, is_angle, load, value, &when)
                    .unwrap_or_else(|| {
                        let error = KinetostaticsError::MagnitudeNotFinite { load };
                        explain_load(scene, error, &when)
                    })
            }
            StopCause::Discontinuity { joint, between } => {
                discontinuous_coupling_error(scene, &scene.mechanism, joint, between, &when)
            }
        }
    }

    /// The error where the trajectory cannot continue. One arm for each cause, so longer than a screen.
    fn explain_limit(
        &self,
        scene: &PlaneScene,
        position: &str,
        error: &PositionError,
    ) -> StudyError {
        let plan = self.plan;
        if let Some(fault) = non_finite_coupling(&scene.mechanism, &self.first_failed.q) {
            let at = if self.has_begun { "soon after" } else { "at" };
            let position = format!("{at} {position}");
            return non_finite_coupling_error(scene, &scene.mechanism, &fault, &position);
        }
        if !self.has_begun {
            return self.explain_first_position(scene, position, error);
        }
        let location = self.trajectory.location(scene);
        let beyond = (location, "continues beyond it".to_owned());
        // Beyond the range on a side where no limit was found.
        if let PositionError::OutOfRange { q, to, .. } = *error
            && plan.range_limits()[usize::from(q > to)].is_none()
        {
            return scene_error(
                scene,
                format!(
                    "the range was searched only up to {position}; no limit position was found, and positions beyond \
                     are not available"
                ),
                "the results end there; start nearer, or end the motion earlier",
                [beyond],
            );
        }
        if let Some((limit, revolutions)) = self.limit(error) {
            return self.explain_range_limit(scene, limit, revolutions);
        }
        let group = error.group();
        let group = group.or_else(|| diverging_group(plan, &self.last_reached.q));
        let bodies = group.map(|g| plan.group_bodies(g)).unwrap_or_default();
        let joints = group.map(|g| plan.group_joints(g)).unwrap_or_default();
        let who = body_names_or_mechanism(&scene.mechanism, &bodies);
        let why = match error {
            PositionError::NotFinite => "a coordinate is not a finite number beyond".into(),
            PositionError::OffTable { coupling, .. } => {
                return self.explain_table(scene, *coupling, position);
            }
            PositionError::NoAssembly { .. } => format!("{who} cannot be assembled beyond"),
            PositionError::Singular { .. } => format!(
                "{who} are in a singular configuration there, and the actuators do not determine their motion"
            ),
            PositionError::OtherBranch { .. } => {
                format!("{who} can only be assembled in another assembly mode beyond")
            }
            PositionError::NotConverged { .. } | PositionError::LanesDiverge { .. } => {
                format!("the positions of {who} could not be computed beyond")
            }
            PositionError::OutOfRange { .. } => "the range ends there".to_owned(),
        };
        let mut labels = joint_labels(&joints, "cannot stay joined beyond");
        labels.push(beyond);
        scene_error(
            scene,
            format!("a limit position is reached at {position}: {why}"),
            "the results end there; end the motion or the sweep before it, or change a length",
            labels,
        )
    }

    /// The limit of a single actuator's range that is reached, with the revolutions in which it is.
    fn limit(&self, error: &PositionError) -> Option<(RangeLimit, f64)> {
        let PositionError::OutOfRange { .. } = error else {
            return None;
        };
        let reached = self.last_reached.q[0];
        let turns = |limit: &RangeLimit| ((reached - limit.q) / TAU).round();
        let distance = |limit: &RangeLimit| {
            if self.plan.is_angle(0) {
                (reached - limit.q - TAU * turns(limit)).abs()
            } else {
                (reached - limit.q).abs()
            }
        };
        let limits = self.plan.range_limits().into_iter().flatten();
        let limit = limits.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let is_angle = self.plan.is_angle(0);
        let revolutions = if is_angle { turns(&limit) } else { 0.0 };
        Some((limit, revolutions))
    }

    /// The error where the range of a single actuator ends.
    fn explain_range_limit(
        &self,
        scene: &PlaneScene,
        limit: RangeLimit,
        revolutions: f64,
    ) -> StudyError {
        let plan = self.plan;
        if let Some(coupling) = limit.table {
            let q = limit.q + TAU * revolutions;
            let name = &scene.mechanism.actuators[0].name;
            let position = describe_coordinate(scene, name, q, plan.is_angle(0));
            return self.explain_table(scene, coupling, &position);
        }
        let name = describe_limit(scene, &scene.mechanism, plan, limit, revolutions);
        let when = match self.trajectory.swept_actuator() {
            Some(_) => String::new(),
            None => format!(" at t = {} s", digits(self.last_reached.t, 6)),
        };
        let why = match (limit.change_point, limit.separation) {
            (true, Some(_)) => "they are too close for positions beyond it",
            (true, None) => "another assembly mode begins there",
            (false, _) => "the actuator cannot move on there",
        };
        let joints = if limit.group < plan.group_methods().len() {
            plan.group_joints(limit.group)
        } else {
            Vec::new()
        };
        let mut labels = joint_labels(&joints, "cannot stay joined beyond");
        let beyond = self.trajectory.location(scene);
        labels.push((beyond, "continues beyond it".to_owned()));
        let help =
            "the results end there; end the motion or the sweep before it, or change a length";
        let message = format!("the {name} is reached{when}: {why}");
        scene_error(scene, message, help, labels)
    }

    /// The error where the table of a coupling ends.
    fn explain_table(&self, scene: &PlaneScene, coupling: JointId, position: &str) -> StudyError {
        let name = &scene.mechanism.joints[coupling.0].name;
        let message = format!("the table of coupling `{name}` ends at {position}");
        let table = SceneLocation::CouplingLaw(coupling);
        let beyond = self.trajectory.location(scene);
        let labels = [
            (table, "has no value beyond".to_owned()),
            (beyond, "continues beyond it".to_owned()),
        ];
        scene_error(scene, message, TABLE_HELP, labels)
    }

    /// The error where not even the first position can be reached.
    fn explain_first_position(
        &self,
        scene: &PlaneScene,
        position: &str,
        error: &PositionError,
    ) -> StudyError {
        let plan = self.plan;
        let joints = error.group().map(|g| plan.group_joints(g));
        let mut labels = joint_labels(&joints.unwrap_or_default(), "cannot be joined there");
        labels.push((self.trajectory.location(scene), "starts there".to_owned()));
        let range = plan.range().limits().map(|(from, to)| {
            let range = describe_ends(scene, from, to, plan.is_angle(0));
            match plan.range_limits() {
                [Some(_), Some(_)] => format!(", outside the range of {range}"),
                _ => format!("; the range was searched from {range} only"),
            }
        });
        let range = range.unwrap_or_default();
        let message = format!("the first position cannot be reached: {position}{range}");
        let help = "start within the range, which `dwell check` shows";
        scene_error(scene, message, help, labels)
    }

    /// The actuator coordinates of the last position, and the time unless it is a sweep.
    fn describe_position(&self, scene: &PlaneScene) -> String {
        let at = &self.last_reached;
        let one = |(i, q): (usize, &f64)| {
            let name = &scene.mechanism.actuators[i].name;
            describe_coordinate(scene, name, *q, self.plan.is_angle(i))
        };
        let all: Vec<_> = at.q.iter().enumerate().map(one).collect();
        let all = all.join(", ");
        match self.trajectory.swept_actuator() {
            Some(_) => all,
            None => format!("t = {} s, {all}", digits(at.t, 6)),
        }
    }
}

/// The error where a load or the equations of motion are undefined.
fn explain_load(scene: &PlaneScene, error: KinetostaticsError, when: &str) -> StudyError {
    let load = error.load().unwrap_or(0);
    let name = scene.load_name(load).unwrap_or_default();
    let (message, help, place) = match error {
        KinetostaticsError::NoDirection { .. } => (
            format!("load `{name}` has no direction {when}: its two points coincide"),
            match scene.loads.get(load).map(|l| l.kind.strength().free()) {
                Some(Some(_)) => "a spring of free length 0 needs none; or keep the points apart",
                _ => "it acts along the line of its points: keep them apart",
            },
            (SceneLocation::Load(load), "between two points"),
        ),
        KinetostaticsError::SelfLocking { .. } => (
            format!(
                "the mechanism is self-locking by friction {when}: the equations of motion have no unique solution"
            ),
            "reduce a friction coefficient, or apply the force where the joint reactions are smaller",
            (
                SceneLocation::Load(load),
                "together with the other friction loads",
            ),
        ),
        KinetostaticsError::MagnitudeNotFinite { .. } | KinetostaticsError::Position(_) => (
            format!("the magnitude of load `{name}` is not finite {when}"),
            "check its expression there for a square root, a logarithm or a division",
            (SceneLocation::Magnitude(load), "not a finite number"),
        ),
    };
    scene_error(scene, message, help, [place])
}

/// The first group with a body whose angular velocity diverges at unit speed of the actuators.
fn diverging_group(plan: &Plan, q: &[f64]) -> Option<usize> {
    let (mut pose, mut motion) = (plan.pose(), plan.motion());
    plan.positions(q, &mut pose).ok()?;
    plan.velocities(&pose, &vec![1.0; q.len()], &mut motion);
    let mut states = BodyStates::new(plan);
    states.fill(plan, &pose, &motion);
    let diverges = |b: &BodyId| states.body(*b).angular_velocity.abs() > DIVERGING_RATIO;
    (0..plan.group_methods().len()).find(|&g| plan.group_bodies(g).iter().any(diverges))
}
