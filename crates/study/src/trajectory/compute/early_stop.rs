//! The early end of a trajectory: where, why, and its message.

use crate::explain::{
    StudyError, body_names_or_mechanism, joint_labels, non_finite_coupling,
    non_finite_coupling_error,
};
use crate::number_format::{digits, number};
use crate::trajectory::compute::{Trajectory, TrajectoryFault, TrajectorySample, table_of};
use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{Plan, PositionError};
use dwell_kinetostatics::{KinetostaticsError, LoadKind, Signal};
use dwell_scene::{Scene, SceneLocation};
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
pub(crate) enum StopCause {
    /// There is no pose, or a load is undefined.
    NoSolution(KinetostaticsError),
    /// There is a pose, but the trajectory is invalid there.
    Fault(TrajectoryFault),
}

impl<E: Into<KinetostaticsError>> From<E> for StopCause {
    fn from(error: E) -> Self {
        Self::NoSolution(error.into())
    }
}

/// Where a trajectory ends.
#[derive(Debug)]
pub(crate) struct EarlyStop {
    /// Why.
    pub(crate) cause: StopCause,
    /// The last position that can be reached; the first one if not even that can be.
    pub(crate) last_reached: TrajectorySample,
    /// A position a little beyond it that cannot be reached.
    first_failed: TrajectorySample,
    has_begun: bool,
}

impl EarlyStop {
    /// Finds the end between two completed fractions, the first of which is reached.
    pub(crate) fn find(
        plan: &Plan,
        trajectory: &Trajectory<'_>,
        [reached, beyond]: [f64; 2],
        cause: StopCause,
    ) -> Self {
        let (mut low, mut high) = (reached, beyond);
        if matches!(
            cause,
            StopCause::NoSolution(KinetostaticsError::Position(_))
        ) {
            let start = trajectory.sample_at(reached).q;
            let mut pose = plan.pose();
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                let q = trajectory.sample_at(middle).q;
                let unreachable =
                    plan.actuators() == 1 && unreachable_error(plan, start[0], q[0]).is_some();
                if !unreachable && plan.positions(&q, &mut pose).is_ok() {
                    low = middle;
                } else {
                    high = middle;
                }
            }
        }
        Self {
            cause,
            last_reached: trajectory.sample_at(low),
            first_failed: trajectory
                .sample_at((high + CAUSE_OFFSET * (beyond - reached)).min(beyond)),
            has_begun: beyond > reached,
        }
    }

    /// The error message, with its locations in the scene.
    pub(crate) fn explain(
        &self,
        scene: &Scene,
        plan: &Plan,
        trajectory: &Trajectory<'_>,
    ) -> StudyError {
        let position = describe_sample(scene, plan, trajectory, &self.last_reached);
        let when = match self.has_begun {
            true => format!("soon after {position}"),
            false => format!("at the first position, {position}"),
        };
        match self.cause {
            StopCause::NoSolution(KinetostaticsError::Position(error)) => {
                self.explain_limit(scene, plan, trajectory, &position, &error)
            }
            StopCause::NoSolution(KinetostaticsError::NoDirection { load }) => scene
                .error(
                    format!(
                        "load `{}` has no direction {when}: its two points coincide",
                        load_name(scene, load)
                    ),
                    Some(match scene.loads.get(load).map(|l| l.kind) {
                        Some(LoadKind::Spring { .. }) => {
                            "a spring of free length 0 needs none; or keep the points apart".into()
                        }
                        _ => "it acts along the line of its points: keep them apart".into(),
                    }),
                    &[(SceneLocation::Load(load), "between two points".to_owned())],
                )
                .into(),
            StopCause::NoSolution(KinetostaticsError::SelfLocking { load }) => scene
                .error(
                    format!("the mechanism is self-locking by friction {when}: the equations of motion have no unique solution"),
                    Some("reduce a friction coefficient, or apply the force where the joint reactions are smaller".into()),
                    &[(SceneLocation::Load(load), "together with the other friction loads".to_owned())],
                )
                .into(),
            StopCause::NoSolution(KinetostaticsError::MagnitudeNotFinite { load }) => scene
                .error(
                    format!(
                        "the magnitude of load `{}` is not finite {when}",
                        load_name(scene, load)
                    ),
                    Some("check its expression there for a square root, a logarithm or a division".into()),
                    &[(SceneLocation::Magnitude(load), "not a finite number".to_owned())],
                )
                .into(),
            StopCause::Fault(TrajectoryFault::OffTable { load, value }) => off_table_error(scene, load, value, &when),
            StopCause::Fault(TrajectoryFault::Discontinuity {
                joint,
                between: [a, b],
            }) => scene
                .error(
                    format!(
                        "the function of coupling `{}` is discontinuous {when}, at x = {}",
                        scene.mechanism.joints[joint.0].name,
                        jump_location(a, b)
                    ),
                    Some(CONTINUITY_HELP.to_owned()),
                    &[(SceneLocation::CouplingLaw(joint), format!("jumps at x = {}", jump_location(a, b)))],
                )
                .into(),
        }
    }

    fn explain_limit(
        &self,
        scene: &Scene,
        plan: &Plan,
        trajectory: &Trajectory<'_>,
        position: &str,
        error: &PositionError,
    ) -> StudyError {
        if let Some(relation) = non_finite_coupling(&scene.mechanism, &self.first_failed.q) {
            let at = if self.has_begun { "soon after" } else { "at" };
            return non_finite_coupling_error(scene, relation, &format!("{at} {position}"));
        }
        if !self.has_begun {
            return self.explain_first_position(scene, plan, trajectory, position, error);
        }
        let is_unexplored = match *error {
            // Beyond the range on a side where no limit was found.
            PositionError::OutOfRange { q, to, .. } => {
                plan.range_limits()[usize::from(q > to)].is_none()
            }
            _ => false,
        };
        if is_unexplored {
            return scene
                .error(
                    format!(
                        "the range was searched only up to {position}; no limit position was found, and positions \
                         beyond are not available"
                    ),
                    Some("the results end there; start nearer, or end the motion earlier".into()),
                    &[(trajectory.location, "continues beyond it".to_owned())],
                )
                .into();
        }
        let group = error
            .group()
            .or_else(|| diverging_group(plan, &self.last_reached.q));
        let bodies = group.map(|g| plan.group_bodies(g)).unwrap_or_default();
        let joints = group.map(|g| plan.group_joints(g)).unwrap_or_default();
        let who = body_names_or_mechanism(&scene.mechanism, &bodies);
        let why = match error {
            PositionError::NotFinite { .. } => {
                "a coordinate is not a finite number beyond".to_owned()
            }
            PositionError::NoAssembly { .. } => format!("{who} cannot reach each other beyond"),
            PositionError::Singular { .. } => {
                format!(
                    "{who} are in a singular configuration there, and the actuators do not determine their motion"
                )
            }
            PositionError::OtherBranch { .. } => {
                format!("{who} can only be assembled in another assembly mode beyond")
            }
            PositionError::NotConverged { .. } | PositionError::LanesDiverge { .. } => {
                format!("the positions of {who} could not be computed beyond")
            }
            PositionError::OutOfRange { .. } if group.is_some() => {
                format!("{who} are in a singular configuration there, at the limit of the range")
            }
            PositionError::OutOfRange { .. } => "the range ends there".to_owned(),
        };
        let mut labels = joint_labels(&joints, "cannot stay joined beyond");
        labels.push((trajectory.location, "continues beyond it".to_owned()));
        let help =
            "the results end there; end the motion or the sweep before it, or change a length";
        scene
            .error(
                format!("a limit position is reached at {position}: {why}"),
                Some(help.to_owned()),
                &labels,
            )
            .into()
    }
}

impl EarlyStop {
    /// The error where not even the first position can be reached.
    fn explain_first_position(
        &self,
        scene: &Scene,
        plan: &Plan,
        trajectory: &Trajectory<'_>,
        position: &str,
        error: &PositionError,
    ) -> StudyError {
        let joints = error.group().map(|g| plan.group_joints(g));
        let mut labels = joint_labels(&joints.unwrap_or_default(), "cannot be joined there");
        labels.push((trajectory.location, "starts there".to_owned()));
        let range = match plan.range().limits() {
            Some((from, to)) => {
                let unit = if plan.is_angle(0) { "rad" } else { "m" };
                let [from, to] = [from, to].map(number);
                match plan.range_limits() {
                    [Some(_), Some(_)] => format!(", outside the range of {from} to {to} {unit}"),
                    _ => format!("; the range was searched from {from} to {to} {unit} only"),
                }
            }
            None => String::new(),
        };
        scene
            .error(
                format!("the first position cannot be reached: {position}{range}"),
                Some("start within the range; `dwell check` shows it".to_owned()),
                &labels,
            )
            .into()
    }
}

/// Help for a discontinuous function.
pub(crate) const CONTINUITY_HELP: &str = "the function must be continuous: make its pieces meet, or join them with a \
     rise such as `cycloidal`; let an angle grow past 2π instead of resetting it";

/// The location of a discontinuity between two neighbouring numbers.
pub(crate) fn jump_location(a: f64, b: f64) -> String {
    // Bisection is certain to these digits.
    digits(if a.abs() > b.abs() { a } else { b }, 9)
}

fn load_name(scene: &Scene, load: usize) -> &str {
    scene.loads.get(load).map_or("", |l| l.name.as_str())
}

/// The error where a load's table does not cover a value of its argument.
fn off_table_error(scene: &Scene, load: usize, value: f64, when: &str) -> StudyError {
    let table = scene.loads.get(load).and_then(|l| table_of(&l.magnitude));
    let (signal, [first, last]) = match table {
        Some((signal, spline)) => (signal, spline.range()),
        None => (Signal::Time, [f64::NAN; 2]),
    };
    let (name, angle) = match signal {
        Signal::Time => ("t".to_owned(), false),
        Signal::Value(c) => (scene.name_of(c), c.is_angle()),
        Signal::Velocity(c) => (format!("{}.velocity", scene.name_of(c)), false),
    };
    let unit = match signal {
        Signal::Time => "s",
        Signal::Value(c) if c.is_angle() => "rad",
        Signal::Value(_) => "m",
        Signal::Velocity(c) if c.is_angle() => "rad/s",
        Signal::Velocity(_) => "m/s",
    };
    let value_text = |value: f64| match angle {
        true => format!("{} rad ({}°)", number(value), number(value.to_degrees())),
        false => format!("{} {unit}", number(value)),
    };
    let table_range = format!("from {} to {}", value_text(first), value_text(last));
    let help = match angle {
        true => format!(
            "extend the table to the angles of the motion, which are not reduced to one revolution; or write an \
             expression, in which `{name} - tau*floor({name}/tau)` is the angle within a revolution"
        ),
        false => "extend the table, or write an expression".to_owned(),
    };
    scene
        .error(
            format!(
                "the table of load `{}` covers {name} {table_range}, but {name} is {} {when}",
                load_name(scene, load),
                value_text(value)
            ),
            Some(help),
            &[(SceneLocation::Magnitude(load), table_range)],
        )
        .into()
}

/// The actuator coordinates, and the time unless it is a sweep.
fn describe_sample(
    scene: &Scene,
    plan: &Plan,
    trajectory: &Trajectory<'_>,
    at: &TrajectorySample,
) -> String {
    let one = |(i, q): (usize, &f64)| {
        let name = &scene.mechanism.actuators[i].name;
        match plan.is_angle(i) {
            true => format!(
                "{name} = {} rad ({}°)",
                digits(*q, 8),
                number(q.to_degrees())
            ),
            false => format!("{name} = {} m", digits(*q, 8)),
        }
    };
    let all: Vec<_> = at.q.iter().enumerate().map(one).collect();
    let all = all.join(", ");
    match trajectory.swept_actuator() {
        Some(_) => all,
        None => format!("t = {} s, {all}", digits(at.t, 6)),
    }
}

/// The first group with a body whose angular velocity diverges at unit speed of the actuators.
fn diverging_group(plan: &Plan, q: &[f64]) -> Option<usize> {
    let (mut pose, mut motion) = (plan.pose(), plan.motion());
    plan.positions(q, &mut pose).ok()?;
    plan.velocities(&pose, &vec![1.0; q.len()], &mut motion);
    let mut states = BodyStates::new(plan);
    states.fill(plan, &pose, &motion);
    (0..plan.group_methods().len()).find(|&g| {
        let bodies = plan.group_bodies(g);
        bodies
            .iter()
            .any(|&b| states.body(b).angular_velocity.abs() > DIVERGING_RATIO)
    })
}
