//! Explains why a scene cannot be compiled or assembled.

use crate::bodies::max_point_coordinate;
use crate::explain::{
    Labels, StudyError, body_labels, body_names, body_names_or_mechanism, explain_ambiguous,
    joint_labels, joint_names, non_finite_coupling, non_finite_coupling_error, start_labels,
};
use crate::number_format::{count, number};
use dwell_dynamics::MachineError;
use dwell_geometry::{ActuatorId, AssemblyError, StructureError};
use dwell_kinetostatics::ModelError;
use dwell_scene::{Scene, SceneError, SceneLocation};

/// A gap below this fraction of the mechanism's size may be rounding of the lengths.
const MARGINAL_GAP: f64 = 1e-6;

/// Explains why a scene could not be compiled.
pub fn explain_model(scene: &Scene, error: &ModelError) -> StudyError {
    let assembly = match error {
        ModelError::Assembly(assembly) => assembly,
        ModelError::Masses | ModelError::Reaction(_) => {
            let message = error.to_string();
            return scene
                .error(message, None, &[(SceneLocation::Whole, String::new())])
                .into();
        }
    };
    let mechanism = &scene.mechanism;
    let start = &scene.assembly.coordinates;
    if !matches!(assembly, AssemblyError::Structure(_))
        && let Some(coupling) = non_finite_coupling(mechanism, start)
    {
        return non_finite_coupling_error(scene, coupling, "at the assembly coordinates");
    }
    match assembly {
        AssemblyError::Structure(error) => explain_structure(scene, error),
        AssemblyError::NoAssembly {
            bodies,
            joints,
            gap,
        } => {
            let mut labels = joint_labels(joints, "cannot be joined");
            labels.extend(start_labels(scene));
            let names = body_names_or_mechanism(mechanism, bodies);
            if *gap <= MARGINAL_GAP * max_point_coordinate(scene) {
                return scene
                    .error(
                        format!(
                            "the start is a limit position, or just beyond one: {names} barely reach \
                             each other"
                        ),
                        Some("start a little farther from it".to_owned()),
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
                format!("{names} cannot be assembled at the start{missing}"),
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
            modes: choices,
        } => explain_ambiguous(scene, bodies, joints, choices),
        AssemblyError::NotMeshing {
            joint,
            distance,
            required: wanted,
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
            redundant_count: excess,
            gap,
        } => scene.error(
            format!(
                "the mechanism is overconstrained by {}, and the redundant constraints are \
                 inconsistent: closure error {gap:.2e} m",
                count(*excess, "constraint")
            ),
            Some(
                "redundant constraints must agree to the last digits: correct a length or a \
                 point, or remove a joint"
                    .to_owned(),
            ),
            &joint_labels(joints, "among the redundant constraints"),
        ),
        AssemblyError::SingularAssembly { bodies, joints } => {
            let mut labels = joint_labels(joints, "singular here");
            labels.extend(start_labels(scene));
            scene.error(
                format!(
                    "the start is a limit position: the actuator does not determine the motion of {}",
                    body_names(mechanism, bodies)
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
        let label = |a| {
            (
                SceneLocation::Actuator(ActuatorId(a)),
                "drives it".to_owned(),
            )
        };
        (0..mechanism.actuators.len()).map(label)
    };
    match error {
        StructureError::NotConnected { bodies } => scene.error(
            format!(
                "no chain of joints connects {} with the ground",
                body_names(mechanism, bodies)
            ),
            Some("add the missing joint, or remove the body".to_owned()),
            &body_labels(bodies, "not reached by any chain of joints"),
        ),
        StructureError::UnderActuated {
            degrees_of_freedom: dof,
            actuators: given,
            bodies,
            redundant_joints: redundant,
        } => {
            let mut labels = body_labels(bodies, "nothing determines its motion");
            labels.extend(joint_labels(redundant, "redundant"));
            labels.extend(actuators());
            scene.error(
                format!(
                    "the mechanism has {} and {}",
                    count(*dof, "degree of freedom"),
                    count(*given, "actuator")
                ),
                Some(if redundant.is_empty() {
                    "each degree of freedom needs an actuator: add one, or a joint that is missing"
                        .to_owned()
                } else {
                    "counting does not show it, because some constraints are redundant: remove one of \
                     those joints, and add a joint or an actuator where a degree of freedom is left"
                        .to_owned()
                }),
                &labels,
            )
        }
        StructureError::OverConstrained {
            redundant_count: excess,
            joints,
            actuators: too_many,
        } => {
            let mut labels = joint_labels(joints, "among the redundant constraints");
            let actuator_label =
                |&a: &ActuatorId| (SceneLocation::Actuator(a), "cannot drive this".to_owned());
            labels.extend(too_many.iter().map(actuator_label));
            let given = mechanism.actuators.len();
            let (body_count, joint_count) = (mechanism.bodies.len() - 1, mechanism.joints.len());
            let constraint_count = mechanism.reactions().len();
            let degrees_of_freedom = (3 * body_count).saturating_sub(constraint_count);
            let (message, help) = if degrees_of_freedom == 0 {
                (
                    format!(
                        "the joints leave the mechanism no degree of freedom: {} and {}, and \
                         3 · {body_count} − {constraint_count} constraints is not above zero",
                        count(body_count, "moving body"),
                        count(joint_count, "joint"),
                    ),
                    "remove a joint or a link; mechanisms that move only because of special lengths are \
                     not supported",
                )
            } else if given > degrees_of_freedom {
                labels.extend(actuators().filter(
                    |(place, _)| !matches!(place, SceneLocation::Actuator(a) if too_many.contains(a)),
                ));
                (
                    format!(
                        "the mechanism has {} and {}",
                        count(degrees_of_freedom, "degree of freedom"),
                        count(given, "actuator")
                    ),
                    "each degree of freedom needs one actuator: remove an actuator or a joint",
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
                    "remove a joint, a link or an actuator there; the mechanism as a whole has at least as \
                     many degrees of freedom as actuators",
                )
            };
            scene.error(message, Some(help.to_owned()), &labels)
        }
        StructureError::Malformed { .. } => scene.error(
            error.to_string(),
            None,
            &[(SceneLocation::Whole, String::new())],
        ),
    }
}

/// The error where exactly one actuator is needed and the scene has another number.
pub(crate) fn not_one_actuator(scene: &Scene) -> StudyError {
    let given = scene.mechanism.actuators.len();
    let label = |a| {
        (
            SceneLocation::Actuator(ActuatorId(a)),
            "drives it".to_owned(),
        )
    };
    let mut labels: Labels = (0..given).map(label).collect();
    if labels.is_empty() {
        labels.push((
            SceneLocation::Whole,
            "there are no [actuators] in this file".into(),
        ));
    }
    scene
        .error(
            format!(
                "the scene has {}: the reduced model needs exactly one",
                count(given, "actuator")
            ),
            Some("give exactly one actuator in [actuators]".to_owned()),
            &labels,
        )
        .into()
}

/// Explains a machine that cannot be built.
pub fn explain_machine(scene: &Scene, error: MachineError) -> StudyError {
    match error {
        MachineError::Load(load) => {
            let labels = [(SceneLocation::Load(load.load), "this load".to_owned())];
            scene.error(load.to_string(), None, &labels).into()
        }
        // The scene has checked its drives and laws: other errors have no location.
        other => scene.error(other.to_string(), None, &[]).into(),
    }
}
