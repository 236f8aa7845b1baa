//! Explains why a scene cannot be compiled or assembled.

use crate::explain::{
    Labels, StudyError, actuator_labels, body_labels, body_names, body_names_or_mechanism,
    joint_labels, joint_names, labels, non_finite_coupling, non_finite_coupling_error, own_length,
    scene_error, start_labels, uncovered_start_error,
};
use crate::number_format::{count, number};
use dwell_dynamics::MachineError;
use dwell_geometry::{
    ActuatorId, AssemblyError, BodyId, BranchHint, JointId, Mechanism, StructureError,
};
use dwell_kinetostatics::ModelError;
use dwell_scene::{PlaneScene, SceneFile, SceneLocation};

/// A gap below this fraction of the mechanism's size may be rounding of the lengths.
const MARGINAL_GAP: f64 = 1e-6;

/// Why a loop of a mechanism of this size does not close: by a gap, or, as a gap of rounding is no cause, by a limit position.
pub(crate) fn describe_gap(file: &SceneFile, gap: f64, size: f64) -> String {
    if gap <= MARGINAL_GAP * size {
        "a limit position, or just beyond one".to_owned()
    } else {
        format!("gap of {}", own_length(file, gap, 3))
    }
}

/// Maximum number of assembly modes in a message.
const MAX_LISTED: usize = 6;

/// Explains why a scene could not be compiled.
pub fn explain_model(scene: &PlaneScene, error: &ModelError) -> StudyError {
    let assembly = match error {
        ModelError::Assembly(assembly) => assembly,
        ModelError::VaryingInertia { body, what } => {
            let message = format!("body `{}`: {what}", scene.mechanism.body_name(*body));
            let help = "give its inertia over a whole revolution, or make its angle from the ground the only actuator";
            let label = (SceneLocation::VaryingInertia(*body), "this inertia");
            return scene_error(scene, message, help, [label]);
        }
        ModelError::Masses | ModelError::Reaction(_) => {
            return scene_error(scene, error.to_string(), "", [(SceneLocation::Whole, "")]);
        }
    };
    let is_sound = !matches!(assembly, AssemblyError::Structure(_));
    match non_finite_coupling(&scene.mechanism, &scene.assembly.coordinates) {
        Some(fault) if is_sound => {
            let position = "at the assembly coordinates";
            non_finite_coupling_error(scene, &scene.mechanism, &fault, position)
        }
        _ => explain_assembly(scene, assembly),
    }
}

/// Explains a mechanism whose structure is sound but which cannot be assembled. One arm for each error, so longer than
/// a screen.
fn explain_assembly(scene: &PlaneScene, error: &AssemblyError) -> StudyError {
    let mechanism = &scene.mechanism;
    let with_start = |joints: &[JointId], text: &str| {
        let mut labels = joint_labels(joints, text);
        labels.extend(start_labels(scene));
        labels
    };
    match error {
        AssemblyError::Structure(error) => explain_structure(scene, error),
        AssemblyError::NoAssembly {
            bodies,
            joints,
            gap,
        } => {
            let names = body_names_or_mechanism(mechanism, bodies);
            let (message, help) = if *gap <= MARGINAL_GAP * mechanism.size() {
                (
                    format!(
                        "the start is a limit position, or just beyond one: {names} barely reach each other"
                    ),
                    "start a little farther from the limit position",
                )
            } else {
                let missing = if gap.is_finite() {
                    format!(": a gap of {} remains", own_length(scene, *gap, 6))
                } else {
                    String::new()
                };
                (
                    format!("{names} cannot be assembled at the start{missing}"),
                    "check the lengths and points of these bodies, and the actuator's coordinate in [assembly]; \
                     a mechanism with a limited range may need another start",
                )
            };
            scene_error(scene, message, help, with_start(joints, "cannot be joined"))
        }
        AssemblyError::Ambiguous {
            bodies,
            joints,
            modes,
        } => explain_ambiguous(scene, bodies, joints, modes),
        AssemblyError::NotMeshing {
            joint,
            distance,
            required,
        } => scene_error(
            scene,
            format!(
                "`{}` cannot mesh: the distance is {} at the start, but the radii require {}",
                mechanism.joints[joint.0].name,
                own_length(scene, *distance, 6),
                own_length(scene, *required, 6)
            ),
            "correct a radius or a centre; `internal = true` is for a ring gear, a negative radius for a pinion \
             on the other side of its rack",
            joint_labels(&[*joint], "does not mesh"),
        ),
        AssemblyError::Inconsistent {
            joints,
            redundant_count,
            gap,
        } => {
            let help = "correct a length or a point, or remove a joint";
            inconsistent(scene, joints, *redundant_count, *gap, help)
        }
        // Only mechanisms in space yield it.
        AssemblyError::NotThroughout { .. } | AssemblyError::NearlyParallel { .. } => {
            scene_error(scene, error.to_string(), "", [(SceneLocation::Whole, "")])
        }
        AssemblyError::OffTable { coupling, .. } => {
            uncovered_start_error(scene, mechanism, *coupling, start_labels(scene))
        }
        AssemblyError::SingularAssembly { bodies, joints } => {
            let what = "the start is a limit position or a change point: the actuator does not determine the motion of";
            let message = format!("{what} {}", body_names(mechanism, bodies));
            let help = "start a little away from it, or drive another joint";
            scene_error(scene, message, help, with_start(joints, "singular here"))
        }
    }
}

fn explain_structure(scene: &PlaneScene, error: &StructureError) -> StudyError {
    match error {
        StructureError::NotConnected { bodies } => {
            not_connected(scene, &body_names(&scene.mechanism, bodies), bodies)
        }
        StructureError::UnderActuated {
            degrees_of_freedom,
            actuators,
            bodies,
            redundant_joints,
        } => {
            let mut labels = body_labels(bodies, "nothing determines its motion");
            labels.extend(joint_labels(redundant_joints, "redundant"));
            labels.extend(driven_labels(scene.mechanism.actuators.len()));
            let help = if redundant_joints.is_empty() {
                "each degree of freedom needs an actuator: add one, or a joint that is missing"
            } else {
                "counting does not show it, because some constraints are redundant: remove one of those joints, \
                 and add a joint or an actuator where a degree of freedom is left"
            };
            let message = freedom_text(*degrees_of_freedom, *actuators);
            scene_error(scene, message, help, labels)
        }
        StructureError::OverConstrained {
            redundant_count,
            joints,
            actuators,
        } => explain_over_constrained(scene, *redundant_count, joints, actuators),
        // The first is of mechanisms in space.
        StructureError::Gear { .. } | StructureError::Malformed { .. } => {
            scene_error(scene, error.to_string(), "", [(SceneLocation::Whole, "")])
        }
    }
}

/// The error of bodies that are not connected.
pub(crate) fn not_connected(scene: &SceneFile, names: &str, bodies: &[BodyId]) -> StudyError {
    let message = format!("no chain of joints connects {names} with the ground");
    let labels = body_labels(bodies, "not reached by any chain of joints");
    let help = "add the missing joint, or remove the body";
    scene_error(scene, message, help, labels)
}

/// The error of redundant constraints that leave a gap, m.
pub(crate) fn inconsistent(
    scene: &SceneFile,
    joints: &[JointId],
    redundant_count: usize,
    gap: f64,
    help: &str,
) -> StudyError {
    let redundant = count(redundant_count, "constraint");
    let message = format!(
        "the mechanism is overconstrained by {redundant}, and the redundant constraints are inconsistent: closure error {}",
        own_length(scene, gap, 3)
    );
    let help = format!("redundant constraints must agree to the last digits: {help}");
    let labels = joint_labels(joints, "among the redundant constraints");
    scene_error(scene, message, help, labels)
}

pub(crate) fn freedom_text(degrees_of_freedom: usize, actuators: usize) -> String {
    let freedom = count(degrees_of_freedom, "degree of freedom");
    let actuators = count(actuators, "actuator");
    format!("the mechanism has {freedom} and {actuators}")
}

/// The labels of all actuators.
pub(crate) fn driven_labels(actuators: usize) -> Labels {
    let actuators = (0..actuators).map(ActuatorId);
    labels(actuators.map(SceneLocation::Actuator), "drives it")
}

fn explain_over_constrained(
    scene: &PlaneScene,
    redundant_count: usize,
    joints: &[JointId],
    actuators: &[ActuatorId],
) -> StudyError {
    let mechanism = &scene.mechanism;
    let mut places = joint_labels(joints, "among the redundant constraints");
    let superfluous = actuators.iter().map(|&a| SceneLocation::Actuator(a));
    places.extend(labels(superfluous, "cannot drive this"));
    let (bodies, constraints) = (mechanism.bodies.len() - 1, mechanism.reactions().len());
    let degrees_of_freedom = (3 * bodies).saturating_sub(constraints);
    let (message, help) = if degrees_of_freedom == 0 {
        (
            format!(
                "the joints leave the mechanism no degree of freedom: {} with 3 · {bodies} freedoms, and {} with \
                 {constraints} constraints",
                count(bodies, "moving body"),
                count(mechanism.joints.len(), "joint"),
            ),
            "remove a joint or a link; mechanisms that move only because of special lengths are not supported",
        )
    } else if mechanism.actuators.len() > degrees_of_freedom {
        let is_other = |(at, _): &(SceneLocation, _)| !matches!(at, SceneLocation::Actuator(a) if actuators.contains(a));
        let driven = driven_labels(mechanism.actuators.len()).into_iter();
        places.extend(driven.filter(is_other));
        (
            freedom_text(degrees_of_freedom, mechanism.actuators.len()),
            "each degree of freedom needs one actuator: remove an actuator or a joint",
        )
    } else {
        let excess = match redundant_count {
            1 => "one constraint".to_owned(),
            n => count(n, "constraint"),
        };
        let names = match joints {
            [] => String::new(),
            joints => format!(" ({})", joint_names(mechanism, joints)),
        };
        (
            format!("{excess} too many{names} in a part of the mechanism"),
            "remove a joint, a link or an actuator there; the mechanism as a whole has at least as many degrees \
             of freedom as actuators",
        )
    };
    scene_error(scene, message, help, places)
}

/// The error where exactly one actuator is needed and the scene has another number.
pub(crate) fn not_one_actuator(scene: &PlaneScene) -> StudyError {
    let actuators = scene.mechanism.actuators.len();
    wrong_actuators(scene, actuators, actuator_labels(scene, "drives it"))
}

/// The error for a scene in the plane or in space, with labels of its actuators.
pub(crate) fn wrong_actuators(scene: &SceneFile, actuators: usize, labels: Labels) -> StudyError {
    let given = count(actuators, "actuator");
    let message = format!("the scene has {given}: the reduced model needs exactly one");
    let help = "give exactly one actuator in [actuators]";
    scene_error(scene, message, help, labels)
}

/// Explains a machine that cannot be built.
pub fn explain_machine(scene: &PlaneScene, error: MachineError) -> StudyError {
    match error {
        MachineError::Load(load) => {
            let place = (SceneLocation::Load(load.load), "this load");
            let message = match scene.loads.get(load.load) {
                Some(of) => format!("load `{}`: {}", of.name, load.what),
                None => load.to_string(),
            };
            scene_error(scene, message, "", [place])
        }
        // The scene has checked its drives and laws: other errors have no location.
        other => scene_error(scene, other.to_string(), "", Labels::new()),
    }
}

/// Explains that no initial guess selects one of the assembly modes. Each mode lists the angle of each body
/// (rad), then the travel or direction of each joint (m or rad).
fn explain_ambiguous(
    scene: &PlaneScene,
    bodies: &[BodyId],
    joints: &[JointId],
    modes: &[Vec<f64>],
) -> StudyError {
    let mechanism = &scene.mechanism;
    let mut labels = body_labels(bodies, "its angle is ambiguous");
    labels.extend(joint_labels(joints, "its position is ambiguous"));
    let by_angles = describe_by_angles(mechanism, bodies, modes);
    let help = match (bodies, joints) {
        ([], []) => {
            labels = start_labels(scene);
            "no body angle and no joint travel distinguishes them: drive another joint".to_owned()
        }
        (_, []) => format!(
            "give an approximate angle of one of them in [assembly]; the assembly modes are: {by_angles}"
        ),
        ([], _) => suggested_hints(scene, joints, modes),
        _ => {
            let after = |mode: &Vec<f64>| mode.get(bodies.len()..).unwrap_or_default().to_vec();
            let travels: Vec<_> = modes.iter().map(after).collect();
            let hints = suggested_hints(scene, joints, &travels);
            format!("body angles do not distinguish all of them: they are {by_angles}; {hints}")
        }
    };
    let names = body_names_or_mechanism(mechanism, bodies);
    let count = modes.len();
    let have = if bodies.len() > 1 { "have" } else { "has" };
    let message =
        format!("{names} {have} {count} assembly modes, and no initial guess selects one");
    scene_error(scene, message, help, labels)
}

fn describe_by_angles(mechanism: &Mechanism, bodies: &[BodyId], modes: &[Vec<f64>]) -> String {
    let mode = |angles: &Vec<f64>| {
        let angle = |(b, a): (&BodyId, &f64)| {
            let degrees = a.to_degrees();
            format!("{} {a:.3} rad ({degrees:.1}°)", mechanism.body_name(*b))
        };
        let all: Vec<_> = bodies.iter().zip(angles).map(angle).collect();
        all.join(", ")
    };
    let modes: Vec<_> = modes.iter().take(MAX_LISTED).map(mode).collect();
    modes.join("; or ")
}

/// Entries for [assembly]: of one joint if it differs in every mode, otherwise of all.
fn suggested_hints(scene: &PlaneScene, joints: &[JointId], modes: &[Vec<f64>]) -> String {
    let mechanism = &scene.mechanism;
    let joint = |k: usize| &mechanism.joints[joints[k].0];
    let hint_text = |k: usize, mode: &[f64]| {
        let is_angle = joint(k).kind.branch_hint() == Some(BranchHint::Direction);
        let si = mode.get(k).copied().unwrap_or(f64::NAN);
        let (value, _) = scene.to_scene_unit(si, is_angle);
        format!("{} = {}", joint(k).name, number(value))
    };
    // In [assembly] the name of a body or an actuator takes precedence.
    let is_taken = |k: usize| {
        let bodies = mechanism.bodies.iter().map(|b| &b.name);
        let mut names = bodies.chain(mechanism.actuators.iter().map(|a| &a.name));
        names.any(|other| *other == joint(k).name)
    };
    let distinguishes = |k: usize| {
        let mut texts: Vec<_> = modes.iter().map(|mode| hint_text(k, mode)).collect();
        texts.sort();
        texts.windows(2).all(|pair| pair[0] != pair[1])
    };
    let free: Vec<usize> = (0..joints.len()).filter(|&k| !is_taken(k)).collect();
    let one = free.iter().copied().find(|&k| distinguishes(k));
    let rename = if free.is_empty() {
        "give the joint a name that no body or actuator has, and "
    } else {
        ""
    };
    let listed = match one {
        Some(one) => vec![one],
        None if free.is_empty() => (0..joints.len()).collect(),
        None => free,
    };
    let mode = |mode: &Vec<f64>| {
        let each = listed.iter().map(|&k| format!("`{}`", hint_text(k, mode)));
        each.collect::<Vec<_>>().join(" and ")
    };
    let modes: Vec<_> = modes.iter().take(MAX_LISTED).map(mode).collect();
    format!("{rename}add {} to [assembly]", modes.join(" or "))
}
