//! Errors of a study, each pointing into the scene file where one of its lines is to blame.

use crate::words::{count, digits, number};
use dwell_dynamics::DynamicsError;
use dwell_geometry::{
    ActuatorId, AssemblyError, BodyId, JointId, Mechanism, PlaceError, Plan, Range, StructureError,
};
use dwell_kinetostatics::ModelError;
use dwell_report::ReportError;
use dwell_scene::{Place, Scene, SceneError};
use std::f64::consts::TAU;
use thiserror::Error;

/// A study that cannot be done.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The scene is to blame. Boxed: it carries the text it points into.
    #[error(transparent)]
    Scene(Box<SceneError>),
    /// The report cannot be made.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A reference file cannot be read.
    #[error("{path}: {reason}")]
    Reference {
        /// The file.
        path: String,
        /// What is wrong with it.
        reason: String,
    },
}

impl From<SceneError> for StudyError {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}

type Labels = Vec<(Place, String)>;

/// A gap below this part of the mechanism's size is a matter of the last digits.
const BARELY: f64 = 1e-6;

/// The largest coordinate of a point in its body, m.
fn size(scene: &Scene) -> f64 {
    let points = scene.points.iter().flatten();
    points.fold(0.0, |m, (_, at)| m.max(at.x.abs()).max(at.y.abs()))
}

fn body_labels(bodies: &[BodyId], words: &str) -> Labels {
    let label = |&b: &BodyId| (Place::Body(b), words.to_owned());
    bodies.iter().take(8).map(label).collect()
}

fn joint_labels(joints: &[JointId], words: &str) -> Labels {
    let label = |&j: &JointId| (Place::Joint(j), words.to_owned());
    joints.iter().take(8).map(label).collect()
}

fn names(mechanism: &Mechanism, bodies: &[BodyId]) -> String {
    let list: Vec<_> = bodies
        .iter()
        .map(|&b| format!("`{}`", mechanism.body_name(b)))
        .collect();
    list.join(", ")
}

fn joint_names(mechanism: &Mechanism, joints: &[JointId]) -> String {
    let list: Vec<_> = joints
        .iter()
        .map(|j| format!("`{}`", mechanism.joints[j.0].name))
        .collect();
    list.join(", ")
}

/// Explains why no model could be made of a scene.
pub(crate) fn explain_model(scene: &Scene, error: &ModelError) -> StudyError {
    let assembly = match error {
        ModelError::Assembly(assembly) => assembly,
        ModelError::Masses | ModelError::Reaction(_) => {
            let message = error.to_string();
            return scene
                .error(message, None, &[(Place::Whole, String::new())])
                .into();
        }
    };
    let mechanism = &scene.mechanism;
    match assembly {
        AssemblyError::Structure(error) => explain_structure(scene, error),
        AssemblyError::CannotClose {
            bodies,
            joints,
            gap,
        } => {
            let mut labels = joint_labels(joints, "cannot be joined");
            labels.push((Place::Assembly, "at this start".to_owned()));
            let names = names(mechanism, bodies);
            if *gap <= BARELY * size(scene) {
                return scene
                    .error(
                        format!(
                            "the start is a limit position, or just beyond it: {names} barely reach \
                             each other"
                        ),
                        Some("start a little away from it".to_owned()),
                        &labels,
                    )
                    .into();
            }
            let missing = if gap.is_finite() {
                format!(": {} m are missing", number(*gap))
            } else {
                String::new()
            };
            scene.error(
                format!("{names} cannot be put together at the start{missing}"),
                Some(
                    "check the lengths and points of these bodies, and the actuator's coordinate \
                     in [assembly]; a mechanism with a limited range may need another start"
                        .to_owned(),
                ),
                &labels,
            )
        }
        AssemblyError::Ambiguous { bodies, choices } => {
            let way = |angles: &Vec<f64>| {
                let angle = |(b, a): (&BodyId, &f64)| {
                    let degrees = a.to_degrees();
                    format!("{} {a:.3} rad ({degrees:.1}°)", mechanism.body_name(*b))
                };
                let all: Vec<_> = bodies.iter().zip(angles).map(angle).collect();
                all.join(", ")
            };
            let ways: Vec<_> = choices.iter().take(6).map(way).collect();
            scene.error(
                format!(
                    "{} can be assembled in {} ways, and nothing says which is meant",
                    names(mechanism, bodies),
                    choices.len()
                ),
                Some(format!(
                    "give a rough angle of one of them in [assembly]; the ways are: {}",
                    ways.join("; or ")
                )),
                &body_labels(bodies, "its angle is open"),
            )
        }
        AssemblyError::SingularStart { bodies, joints } => {
            let mut labels = joint_labels(joints, "in line with the others");
            labels.push((Place::Assembly, "at this start".to_owned()));
            scene.error(
                format!(
                    "the start is a limit position: the actuator does not determine the motion of {}",
                    names(mechanism, bodies)
                ),
                Some("start a little away from it, or drive another joint".to_owned()),
                &labels,
            )
        }
        AssemblyError::NotPeriodic { bodies } => scene.error(
            format!(
                "after a whole turn of the actuator {} are not back where they were",
                names(mechanism, bodies)
            ),
            Some("mechanisms that repeat only after several turns are not supported yet".to_owned()),
            &body_labels(bodies, "elsewhere after a turn"),
        ),
    }
    .into()
}

fn explain_structure(scene: &Scene, error: &StructureError) -> SceneError {
    let mechanism = &scene.mechanism;
    let actuators = || {
        let label = |a| (Place::Actuator(ActuatorId(a)), "drives it".to_owned());
        (0..mechanism.actuators.len()).map(label)
    };
    match error {
        StructureError::Detached { bodies } => scene.error(
            format!(
                "nothing connects {} with the ground",
                names(mechanism, bodies)
            ),
            Some("add the joint that holds it, or leave the body out".to_owned()),
            &body_labels(bodies, "not reached by any chain of joints"),
        ),
        StructureError::UnderDriven {
            dof,
            actuators: given,
            bodies,
        } => {
            let mut labels = body_labels(bodies, "nothing determines its motion");
            labels.extend(actuators());
            scene.error(
                format!(
                    "the mechanism has {} and {}",
                    count(*dof, "degree of freedom"),
                    count(*given, "actuator")
                ),
                Some(
                    "each degree of freedom needs an actuator: add one, or a joint that is missing"
                        .to_owned(),
                ),
                &labels,
            )
        }
        StructureError::OverConstrained {
            excess,
            joints,
            actuators: too_many,
        } => {
            let mut labels = joint_labels(joints, "among the constraints that are too many");
            let driven = |&a: &ActuatorId| (Place::Actuator(a), "cannot drive this".to_owned());
            labels.extend(too_many.iter().map(driven));
            let given = mechanism.actuators.len();
            let (moving, held) = (mechanism.bodies.len() - 1, mechanism.joints.len());
            let freedom = (3 * moving).saturating_sub(2 * held);
            let (message, help) = if freedom == 0 {
                (
                    format!(
                        "the joints leave the mechanism no degree of freedom: {} and {}, and \
                         3 · {moving} − 2 · {held} is not above zero",
                        count(moving, "moving body"),
                        count(held, "joint"),
                    ),
                    "take a joint or a bar out; a mechanism that moves in spite of this count, by its \
                     special lengths, is not supported",
                )
            } else if given > freedom {
                labels.extend(actuators().filter(
                    |(place, _)| !matches!(place, Place::Actuator(a) if too_many.contains(a)),
                ));
                (
                    format!(
                        "the mechanism has {} and {}",
                        count(freedom, "degree of freedom"),
                        count(given, "actuator")
                    ),
                    "each degree of freedom needs one actuator: take one out, or a joint",
                )
            } else {
                (
                    format!(
                        "{} too many{} in a part of the mechanism",
                        match excess {
                            1 => "one constraint".to_owned(),
                            n => count(*n, "constraint"),
                        },
                        match joints.as_slice() {
                            [] => String::new(),
                            joints => format!(" ({})", joint_names(mechanism, joints)),
                        },
                    ),
                    "take a joint, a bar or an actuator out there; as a whole it has as many \
                     degrees of freedom as actuators, or more",
                )
            };
            scene.error(message, Some(help.to_owned()), &labels)
        }
        StructureError::Malformed { .. } => {
            scene.error(error.to_string(), None, &[(Place::Whole, String::new())])
        }
        StructureError::GroupNeedsOneActuator { size, bodies } => scene.error(
            format!(
                "{} form one group of {size} unknowns, which needs a single actuator so far",
                names(mechanism, bodies)
            ),
            None,
            &body_labels(bodies, "in the group"),
        ),
    }
}

/// The error where one degree of freedom is needed and the scene has another number.
pub(crate) fn not_one_actuator(scene: &Scene) -> StudyError {
    let given = scene.mechanism.actuators.len();
    let label = |a| (Place::Actuator(ActuatorId(a)), "drives it".to_owned());
    let mut labels: Labels = (0..given).map(label).collect();
    if labels.is_empty() {
        labels.push((Place::Whole, "there are no [actuators] in this file".into()));
    }
    scene
        .error(
            format!(
                "the scene has {}: only mechanisms of one degree of freedom can be reduced so far",
                count(given, "actuator")
            ),
            Some("give exactly one actuator in [actuators]".to_owned()),
            &labels,
        )
        .into()
}

/// The name of the coordinate, quoted.
fn coordinate(scene: &Scene) -> String {
    let first = scene.mechanism.actuators.first();
    first.map_or_else(|| "the coordinate".to_owned(), |a| format!("`{}`", a.name))
}

/// Explains a motion that failed.
pub(crate) fn explain_motion(scene: &Scene, plan: &Plan, error: &DynamicsError) -> StudyError {
    let phi = coordinate(scene);
    let motion = |message: String, help: &str, at: Place, label: &str| {
        let labels = [(at, label.to_owned())];
        scene.error(message, Some(help.to_owned()), &labels).into()
    };
    let speed = Place::Speed(ActuatorId(0));
    match error {
        DynamicsError::Place(place) => explain_place(scene, plan, place),
        DynamicsError::Limit { t, q } => {
            let limit = match plan.range() {
                Range::Full => String::new(),
                Range::Between(from, to) => {
                    // In the turn in which the motion is.
                    let turns = TAU * ((q - from) / TAU).floor();
                    let nearest = if q - turns - from < to + turns - q {
                        from
                    } else {
                        to
                    };
                    format!(", {} rad,", number(nearest + turns))
                }
            };
            motion(
                format!(
                    "the motion reaches a limit position of {phi}{limit} soon after t = {} s, and \
                     passes to another assembly branch there, which {phi} cannot tell from this one",
                    digits(*t, 3)
                ),
                &match below(*t) {
                    Some(t) => format!(
                        "end it before: `duration = {t}` (s); or drive a joint that turns fully"
                    ),
                    None => "start farther from it, or drive a joint that turns fully".to_owned(),
                },
                Place::Length,
                "longer than that",
            )
        }
        DynamicsError::NoInertia { q, .. } => {
            let label = |b| (Place::Body(BodyId(b)), "no inertia that moves".to_owned());
            let moving = (0..scene.mechanism.bodies.len()).filter(|&b| b != scene.mechanism.ground);
            let labels: Labels = moving.take(8).map(label).collect();
            scene
                .error(
                    format!(
                        "the generalised inertia m is zero at {phi} = {} rad: no body with mass \
                         moves there",
                        number(*q)
                    ),
                    Some("give the bodies that move mass and inertia".to_owned()),
                    &labels,
                )
                .into()
        }
        DynamicsError::AtRest => motion(
            "the free motion starts at rest, and nothing moves the mechanism".to_owned(),
            "give it a speed in [motion]",
            speed,
            "no speed",
        ),
        DynamicsError::BadEnergy { q_dot, energy } => motion(
            format!(
                "the kinetic energy at {} rad/s is {} J: too far from 1 to compute with",
                number(*q_dot),
                number(*energy)
            ),
            "take a speed of a size that occurs; without loads it only scales time and reactions",
            speed,
            "this speed",
        ),
        DynamicsError::NoFullTurn { from, to } => motion(
            format!(
                "{phi} turns only from {} to {} rad, so the motion has no period of turning",
                number(*from),
                number(*to)
            ),
            "give `duration` (s) instead of `periods`",
            Place::Length,
            "no whole turn is reached",
        ),
        DynamicsError::NotResolved { points, left } => motion(
            format!(
                "the inertia changes too sharply within a turn to find the period by quadrature: \
                 {points} points leave {} of it open",
                digits(*left, 2)
            ),
            "bars may nearly be in line, at a change point: `dwell reduce` shows where; a motion with \
             a `duration` is followed without a period",
            Place::Length,
            "a period is needed",
        ),
        DynamicsError::Budget { t, steps } => motion(
            format!(
                "{steps} steps take the motion only to t = {} s",
                digits(*t, 2)
            ),
            "end it before, or follow it less exactly, with a larger --rtol",
            Place::Length,
            "too long to be followed",
        ),
        DynamicsError::SmallStep { t } => motion(
            format!(
                "the motion changes too fast to be followed from t = {} s on: the integrator's steps \
                 become too small",
                number(*t)
            ),
            "a limit position or a change point may be near: end it before, or check the lengths",
            Place::Length,
            "until there",
        ),
        DynamicsError::TooShort => motion(
            "the motion is too short to compute: its end is its start, to rounding".to_owned(),
            "give it more time",
            Place::Length,
            "too short",
        ),
        DynamicsError::NotFinite { t } => motion(
            format!("the motion is no longer finite after t = {} s", number(*t)),
            "check the speed and the inertias",
            Place::Motion,
            "this motion",
        ),
        other => motion(
            other.to_string(),
            "check the numbers of the motion",
            Place::Motion,
            "this motion",
        ),
    }
}

/// A time of two digits before `t`, if that leaves any.
fn below(t: f64) -> Option<String> {
    let unit = 10_f64.powf(t.log10().floor() - 1.0);
    let time = (t / unit).floor() * unit;
    (time.is_normal() && time > 0.0).then(|| digits(time, 2))
}

/// Explains a position that cannot be placed.
pub(crate) fn explain_place(scene: &Scene, plan: &Plan, error: &PlaceError) -> StudyError {
    let phi = coordinate(scene);
    let joints = error.group().map(|g| plan.group_joints(g));
    let who = error.group().map_or_else(String::new, |g| {
        names(&scene.mechanism, &plan.group_bodies(g))
    });
    let range_ends = "the range ends there; `dwell check` shows it";
    let (message, help) = match *error {
        PlaceError::Unreachable { q, gap, .. } => (
            format!(
                "{who} cannot reach each other at {phi} = {} rad: {} m are missing",
                number(q),
                digits(gap, 3)
            ),
            range_ends,
        ),
        PlaceError::Singular { q, .. } => (
            format!(
                "{who} are in line at {phi} = {} rad: {phi} does not determine their motion there",
                number(q)
            ),
            match plan.range() {
                Range::Full => "it is a change point: change a length, or drive another joint",
                Range::Between(..) => range_ends,
            },
        ),
        PlaceError::OtherBranch { q, .. } => (
            format!(
                "{who} can be placed on another assembly branch only at {phi} = {} rad",
                number(q)
            ),
            "two branches come close to each other there",
        ),
        PlaceError::NotClosed { q, residual, .. } => (
            format!(
                "{who} could not be placed at {phi} = {} rad: {} m stay open",
                number(q),
                digits(residual, 3)
            ),
            range_ends,
        ),
        PlaceError::OutOfRange { q, from, to } => (
            format!(
                "{phi} = {} rad is outside its range, {} to {} rad",
                number(q),
                number(from),
                number(to)
            ),
            "start within the range; `dwell check` shows it",
        ),
        PlaceError::NotFinite { q } => (
            format!("{phi} = {q} rad is not a finite number"),
            "check the numbers of the motion",
        ),
    };
    let labels = match joints {
        Some(joints) if !joints.is_empty() => joint_labels(&joints, "cannot stay joined there"),
        _ => vec![(Place::MotionStart(ActuatorId(0)), "this coordinate".into())],
    };
    scene.error(message, Some(help.to_owned()), &labels).into()
}
