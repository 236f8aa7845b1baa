//! Errors of a study, each pointing into the scene file where one of its lines is to blame.

use crate::ambiguous::ambiguous;
use crate::run::broken_relation;
use crate::sweep::SweepError;
use crate::words::{count, number};
use dwell_dynamics::MachineError;
use dwell_geometry::{ActuatorId, AssemblyError, BodyId, JointId, Mechanism, StructureError};
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
    /// A sweep cannot be done.
    #[error(transparent)]
    Sweep(#[from] SweepError),
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

pub(crate) type Labels = Vec<(Place, String)>;

/// A gap below this part of the mechanism's size is a matter of the last digits.
const BARELY: f64 = 1e-6;

/// The largest coordinate of a point in its body, m.
pub(crate) fn size(scene: &Scene) -> f64 {
    let points = scene.points.iter().flatten();
    points.fold(0.0, |m, (_, at)| m.max(at.x.abs()).max(at.y.abs()))
}

pub(crate) fn body_labels(bodies: &[BodyId], words: &str) -> Labels {
    let label = |&b: &BodyId| (Place::Body(b), words.to_owned());
    bodies.iter().take(8).map(label).collect()
}

/// Where the scene says in which position it is put together.
pub(crate) fn start_labels(scene: &Scene) -> Labels {
    let written = |&a: &ActuatorId| {
        // What is not written stands where the motion's start does.
        scene.span(Place::Start(a)) != scene.span(Place::MotionStart(a))
    };
    let actuators = (0..scene.mechanism.actuators.len()).map(ActuatorId);
    let mut labels: Labels = actuators
        .filter(written)
        .take(8)
        .map(|a| (Place::Start(a), "at this start".to_owned()))
        .collect();
    if labels.is_empty() {
        labels.push((Place::Assembly, "at this start".to_owned()));
    }
    labels
}

pub(crate) fn joint_labels(joints: &[JointId], words: &str) -> Labels {
    let label = |&j: &JointId| (Place::Joint(j), words.to_owned());
    joints.iter().take(8).map(label).collect()
}

pub(crate) fn names(mechanism: &Mechanism, bodies: &[BodyId]) -> String {
    let list: Vec<_> = bodies
        .iter()
        .map(|&b| format!("`{}`", mechanism.body_name(b)))
        .collect();
    list.join(", ")
}

/// The same; what no body of the scene does, the mechanism does.
pub(crate) fn names_or_whole(mechanism: &Mechanism, bodies: &[BodyId]) -> String {
    match bodies {
        [] => "the mechanism".to_owned(),
        bodies => names(mechanism, bodies),
    }
}

fn joint_names(mechanism: &Mechanism, joints: &[JointId]) -> String {
    let list: Vec<_> = joints
        .iter()
        .map(|j| format!("`{}`", mechanism.joints[j.0].name))
        .collect();
    list.join(", ")
}

/// The error of a relation's function that is not finite: `what` of it at the joint's variable `x`.
pub(crate) fn broken(
    scene: &Scene,
    (joint, x, what): (JointId, f64, &str),
    place: &str,
) -> StudyError {
    let label = format!("no finite {what} at x = {}", number(x));
    scene
        .error(
            format!(
                "the function of relation `{}` has no finite {what} at x = {}, {place}",
                scene.mechanism.joints[joint.0].name,
                number(x)
            ),
            Some("a relation needs its value and two derivatives everywhere".to_owned()),
            &[(Place::Law(joint), label)],
        )
        .into()
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
    let start = &scene.assembly.start;
    if !matches!(assembly, AssemblyError::Structure(_))
        && let Some(relation) = broken_relation(mechanism, start)
    {
        return broken(scene, relation, "where the mechanism starts");
    }
    match assembly {
        AssemblyError::Structure(error) => explain_structure(scene, error),
        AssemblyError::CannotClose {
            bodies,
            joints,
            gap,
        } => {
            let mut labels = joint_labels(joints, "cannot be joined");
            labels.extend(start_labels(scene));
            let names = names_or_whole(mechanism, bodies);
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
        AssemblyError::Ambiguous {
            bodies,
            joints,
            choices,
        } => ambiguous(scene, bodies, joints, choices),
        AssemblyError::NotMeshing {
            joint,
            distance,
            wanted,
        } => scene.error(
            format!(
                "`{}` cannot mesh: the distance is {distance:.6} m at the start, and the radii ask for \
                 {wanted:.6} m",
                mechanism.joints[joint.0].name
            ),
            Some(
                "correct a radius or a centre; `internal = true` is for a ring gear, a negative \
                 radius for a pinion on the other side of its rack"
                    .to_owned(),
            ),
            &joint_labels(&[*joint], "does not mesh"),
        ),
        AssemblyError::Inconsistent {
            joints,
            excess,
            gap,
        } => scene.error(
            format!(
                "the joints have {} more than the bodies can follow, and the lengths do not allow it: \
                 {gap:.2e} m stay open",
                count(*excess, "constraint")
            ),
            Some(
                "joints that repeat others must agree with them to the last digits: correct a \
                 length or a point, or take a joint away"
                    .to_owned(),
            ),
            &joint_labels(joints, "among the constraints that are too many"),
        ),
        AssemblyError::SingularStart { bodies, joints } => {
            let mut labels = joint_labels(joints, "in line with the others");
            labels.extend(start_labels(scene));
            scene.error(
                format!(
                    "the start is a limit position: the actuator does not determine the motion of {}",
                    names(mechanism, bodies)
                ),
                Some("start a little away from it, or drive another joint".to_owned()),
                &labels,
            )
        }
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
            twice,
        } => {
            let mut labels = body_labels(bodies, "nothing determines its motion");
            labels.extend(joint_labels(twice, "holds what others hold already"));
            labels.extend(actuators());
            scene.error(
                format!(
                    "the mechanism has {} and {}",
                    count(*dof, "degree of freedom"),
                    count(*given, "actuator")
                ),
                Some(if twice.is_empty() {
                    "each degree of freedom needs an actuator: add one, or a joint that is missing"
                        .to_owned()
                } else {
                    "counting does not show it, because some joints hold the same thing twice: \
                     take one of those away and put a joint or an actuator where something is free"
                        .to_owned()
                }),
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
            let rows = mechanism.reactions().len();
            let freedom = (3 * moving).saturating_sub(rows);
            let (message, help) = if freedom == 0 {
                (
                    format!(
                        "the joints leave the mechanism no degree of freedom: {} and {}, and \
                         3 · {moving} − {rows} constraints is not above zero",
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

/// Explains a machine that cannot be built.
pub(crate) fn explain_machine(scene: &Scene, error: MachineError) -> StudyError {
    match error {
        MachineError::Load(load) => {
            let labels = [(Place::Load(load.load), "this load".to_owned())];
            scene.error(load.to_string(), None, &labels).into()
        }
        // The scene has checked its drives and laws: what is left needs no place.
        other => scene.error(other.to_string(), None, &[]).into(),
    }
}
