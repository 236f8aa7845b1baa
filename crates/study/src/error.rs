//! Errors of a study, each pointing into the scene file where one of its lines is to blame.

use dwell_dynamics::DynamicsError;
use dwell_geometry::{
    ActuatorId, AssemblyError, BodyId, JointId, Mechanism, PlaceError, Plan, StructureError,
};
use dwell_kinetostatics::ModelError;
use dwell_report::ReportError;
use dwell_scene::{Place, Scene, SceneError};
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
        ModelError::Masses => {
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
            let missing = if gap.is_finite() {
                format!(": {} m are missing", number(*gap))
            } else {
                String::new()
            };
            let mut labels = joint_labels(joints, "cannot be joined");
            labels.push((Place::Assembly, "at this start".to_owned()));
            scene.error(
                format!(
                    "{} cannot be put together at the start{missing}",
                    names(mechanism, bodies)
                ),
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
                format!("the mechanism has {dof} degrees of freedom and {given} actuators"),
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
            let free = mechanism.actuators.len().saturating_sub(*excess);
            scene.error(
                format!(
                    "{excess} constraint{} more than the bodies can follow ({}): with {} \
                     actuator{}, the joints leave {free} degrees of freedom",
                    if *excess == 1 { "" } else { "s" },
                    if joints.is_empty() {
                        "an actuator".to_owned()
                    } else {
                        joint_names(mechanism, joints)
                    },
                    mechanism.actuators.len(),
                    if mechanism.actuators.len() == 1 {
                        ""
                    } else {
                        "s"
                    },
                ),
                Some("take a joint, a bar or an actuator out".to_owned()),
                &labels,
            )
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
    let label = |a| (Place::Actuator(ActuatorId(a)), "an actuator".to_owned());
    let mut labels: Labels = (0..given).map(label).collect();
    if labels.is_empty() {
        labels.push((Place::Whole, String::new()));
    }
    scene
        .error(
            format!("the reduced model needs one degree of freedom; this scene drives {given}"),
            Some("give exactly one actuator in [actuators]".to_owned()),
            &labels,
        )
        .into()
}

/// Explains a motion or a position that failed.
pub(crate) fn explain_motion(scene: &Scene, plan: &Plan, error: &DynamicsError) -> StudyError {
    let motion = |message: String, help: Option<&str>, at: Place, words: &str| {
        scene
            .error(message, help.map(str::to_owned), &[(at, words.to_owned())])
            .into()
    };
    let speed = Place::Speed(ActuatorId(0));
    match error {
        DynamicsError::Place(place) => explain_place(scene, plan, place),
        DynamicsError::NoInertia { q, .. } => {
            let label = |b| (Place::Body(BodyId(b)), "no inertia that moves".to_owned());
            let moving = (0..scene.mechanism.bodies.len()).filter(|&b| b != scene.mechanism.ground);
            let labels: Labels = moving.take(8).map(label).collect();
            scene
                .error(
                    format!(
                        "the generalised inertia m is zero at {} = {} rad: no body with mass moves there",
                        scene.mechanism.actuators[0].name,
                        number(*q)
                    ),
                    Some("give the bodies mass and inertia".to_owned()),
                    &labels,
                )
                .into()
        }
        DynamicsError::AtRest => motion(
            "the free motion starts at rest, and nothing moves the mechanism".to_owned(),
            Some("give it a speed in [motion]"),
            speed,
            "no speed",
        ),
        DynamicsError::NoFullTurn { from, to } => motion(
            format!(
                "the actuator turns only from {} to {} rad, so the motion has no period of turning",
                number(*from),
                number(*to)
            ),
            Some("give `duration` (s) instead of `periods`"),
            Place::Length,
            "no whole turn is reached",
        ),
        other => motion(other.to_string(), None, Place::Motion, "this motion"),
    }
}

/// Explains a position that cannot be placed.
pub(crate) fn explain_place(scene: &Scene, plan: &Plan, error: &PlaceError) -> StudyError {
    let mut labels = Labels::new();
    let mut who = String::new();
    if let Some(group) = error.group() {
        let joints = plan.group_joints(group);
        labels = joint_labels(&joints, "cannot stay joined there");
        who = format!(" ({})", names(&scene.mechanism, &plan.group_bodies(group)));
    }
    if labels.is_empty() {
        labels.push((Place::Actuator(ActuatorId(0)), "this coordinate".to_owned()));
    }
    let help = "the actuator's range ends there; `dwell check` shows it".to_owned();
    scene
        .error(format!("{error}{who}"), Some(help), &labels)
        .into()
}

/// A number with six digits, plainly.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        let text = format!("{value:.6}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{value:.5e}")
    }
}
