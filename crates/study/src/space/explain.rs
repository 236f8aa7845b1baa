//! Explains why a scene in space cannot be assembled, or has no pose at a coordinate.

use crate::explain::{
    CONTINUITY_HELP, Labels, NamedScene as _, StudyError, body_labels, describe_ends, describe_gap,
    driven_labels, freedom_text, inconsistent, joint_labels, labels, missing_section_label,
    non_finite_coupling, non_finite_coupling_error, not_connected, own_coordinate, own_length,
    scene_error, uncovered_coupling_error, uncovered_start_error,
};
use dwell_geometry::space::{CouplingEnd, JointKind, Plan};
use dwell_geometry::{ActuatorId, AssemblyError, BodyId, JointId, PositionError, StructureError};
use dwell_kinetostatics::space::{Model, ModelError};
use dwell_kinetostatics::{KinetostaticsError, LoadError, MachineModel as _};
use dwell_scene::{SceneLocation, SpaceScene};

/// Names of bodies in a sentence; more are only counted.
const MAX_NAMED: usize = 6;

/// `bodies a, b and 3 more`; the mechanism if there are none.
fn names_of(scene: &SpaceScene, bodies: &[BodyId]) -> String {
    if bodies.is_empty() {
        return "the mechanism".to_owned();
    }
    let names = bodies.iter().take(MAX_NAMED);
    let names: Vec<_> = names
        .map(|b| format!("`{}`", scene.mechanism.bodies[b.0].name))
        .collect();
    let rest = match bodies.len().saturating_sub(MAX_NAMED) {
        0 => String::new(),
        rest => format!(" and {rest} more"),
    };
    names.join(", ") + &rest
}

/// The places of the coordinates at assembly.
fn start_labels(scene: &SpaceScene) -> Labels {
    let actuators = (0..scene.mechanism.actuators.len()).map(ActuatorId);
    labels(
        actuators.map(SceneLocation::AssemblyCoordinate),
        "assembled here",
    )
}

/// Explains why a scene could not be compiled.
pub(super) fn explain_model(scene: &SpaceScene, error: &ModelError) -> StudyError {
    match error {
        ModelError::Assembly(error) => {
            let is_sound = !matches!(error, AssemblyError::Structure(_));
            match non_finite_coupling(&scene.mechanism, &scene.assembly.q) {
                Some(fault) if is_sound => {
                    let position = "at the assembly coordinates";
                    non_finite_coupling_error(scene, &scene.mechanism, &fault, position)
                }
                _ => explain_assembly(scene, error),
            }
        }
        ModelError::UnbalancedRod { body } => {
            let name = &scene.mechanism.bodies[body.0].name;
            let message = format!(
                "`{name}` rotates freely about the line through its spherical joints, and its mass couples this rotation with the \
                 motion: the mechanism has a second degree of freedom"
            );
            let help = "replace one spherical joint by a universal joint, or give the body a centre of mass on that line and equal \
                        moments of inertia about the axes normal to it";
            let labels = body_labels(&[*body], "rotates about this line");
            scene_error(scene, message, help, labels)
        }
        ModelError::Masses | ModelError::Reaction(_) => {
            scene_error(scene, error.to_string(), "", [(SceneLocation::Whole, "")])
        }
    }
}

fn explain_assembly(scene: &SpaceScene, error: &AssemblyError) -> StudyError {
    let with_start = |joints: &[JointId], text: &str| {
        let mut places = joint_labels(joints, text);
        places.extend(start_labels(scene));
        places
    };
    match error {
        AssemblyError::Structure(error) => explain_structure(scene, error),
        AssemblyError::NoAssembly {
            bodies,
            joints,
            gap,
        } => {
            let names = names_of(scene, bodies);
            let message = format!(
                "{names} cannot be assembled at the start: a gap of {} remains",
                own_length(scene, *gap, 6)
            );
            let help = "check points, axes and lengths, the coordinate in [assembly], and the placements there: \
                        each body should be near where it belongs";
            scene_error(scene, message, help, with_start(joints, "cannot be joined"))
        }
        AssemblyError::Inconsistent {
            joints,
            redundant_count,
            gap,
        } => {
            let help = "correct a length, a point or an axis, or replace a joint by one with more freedoms";
            inconsistent(scene, joints, *redundant_count, *gap, help)
        }
        AssemblyError::NotThroughout {
            joints,
            q,
            gap,
            nearly_parallel,
        } => explain_not_throughout(scene, joints, [*q, *gap], *nearly_parallel),
        AssemblyError::NearlyParallel {
            joints,
            angle,
            degrees_of_freedom,
        } => {
            let freedoms = freedom_text(*degrees_of_freedom, scene.mechanism.actuators.len());
            explain_nearly_parallel(scene, &freedoms, *joints, *angle)
        }
        AssemblyError::SingularAssembly { joints, .. } => {
            let message = "the start is a singular position: the actuator does not determine the motion there";
            let help = "start a little away from it, or drive another joint";
            scene_error(scene, message, help, with_start(joints, "singular here"))
        }
        AssemblyError::OffTable { coupling, .. } => {
            uncovered_start_error(scene, &scene.mechanism, *coupling, start_labels(scene))
        }
        // Only planar mechanisms yield these.
        AssemblyError::Ambiguous { .. } | AssemblyError::NotMeshing { .. } => {
            scene_error(scene, error.to_string(), "", [(SceneLocation::Whole, "")])
        }
    }
}

/// Redundant constraints that agree at the start alone.
fn explain_not_throughout(
    scene: &SpaceScene,
    joints: &[JointId],
    [q, gap]: [f64; 2],
    nearly_parallel: Option<([JointId; 2], f64)>,
) -> StudyError {
    let name = scene.mechanism.actuators.first().map_or("", |a| &a.name);
    let at = own_coordinate(scene, q, super::prepared::is_angle(scene));
    let gap = own_length(scene, gap, 3);
    let message = format!(
        "redundant constraints agree at the start, but not along the motion: at `{name}` = {at} they leave a gap of {gap}"
    );
    let Some((pair, angle)) = nearly_parallel else {
        let help = "redundant constraints must agree to the last digits: correct a length, a point or an axis, or replace a joint \
                    by one with more freedoms";
        let labels = joint_labels(joints, "among the redundant constraints");
        return scene_error(scene, message, help, labels);
    };
    explain_nearly_parallel(scene, &message, pair, angle)
}

/// Explains an error caused by two axes that are nearly parallel.
fn explain_nearly_parallel(
    scene: &SpaceScene,
    consequence: &str,
    pair: [JointId; 2],
    angle: f64,
) -> StudyError {
    let [a, b] = pair.map(|joint| &scene.mechanism.joints[joint.0].name);
    let angle = own_coordinate(scene, angle, true);
    let message = format!("{consequence}; the axes of `{a}` and `{b}` are {angle} from parallel");
    let help = "give both joints the same axis to the last digit, or replace one by a joint with more freedoms";
    scene_error(scene, message, help, joint_labels(&pair, "nearly parallel"))
}

/// One arm for each error, so longer than a screen.
fn explain_structure(scene: &SpaceScene, error: &StructureError) -> StudyError {
    let driven = driven_labels(scene.mechanism.actuators.len());
    match error {
        StructureError::NotConnected { bodies } => {
            not_connected(scene, &names_of(scene, bodies), bodies)
        }
        StructureError::UnderActuated {
            degrees_of_freedom,
            actuators,
            bodies,
            ..
        } => {
            let message = freedom_text(*degrees_of_freedom, *actuators);
            let help = "each degree of freedom needs an actuator: add one, or a joint that is missing, or replace a joint by one \
                        with fewer freedoms";
            let mut places = body_labels(bodies, "nothing determines its motion");
            places.extend(driven);
            if places.is_empty() {
                places = missing_section_label("actuators");
            }
            scene_error(scene, message, help, places)
        }
        StructureError::OverConstrained {
            redundant_count, ..
        } => {
            let actuators = scene.mechanism.actuators.len();
            let message = freedom_text(actuators.saturating_sub(*redundant_count), actuators);
            let help = "each degree of freedom needs one actuator: remove an actuator, or replace a joint by one with more freedoms";
            scene_error(scene, message, help, driven)
        }
        StructureError::Gear { joint, reason } => {
            let name = &scene.mechanism.joints[joint.0].name;
            let message = format!("the teeth of gear pair `{name}` cannot mesh: {reason}");
            let help = "both wheels need bearings whose axes keep their places in the carrier, the body of the pitch point; and \
                        the normal of the teeth must have an arm about each axis";
            let mut places = joint_labels(&[*joint], "this gear pair");
            let normal = "the normal of its teeth".to_owned();
            places.push((SceneLocation::Axis(*joint), normal));
            scene_error(scene, message, help, places)
        }
        StructureError::Malformed { reason } => {
            scene_error(scene, *reason, "", [(SceneLocation::Whole, "")])
        }
    }
}

/// Explains a position that cannot be computed.
pub(super) fn explain_position(
    scene: &SpaceScene,
    plan: &Plan,
    error: &PositionError,
) -> StudyError {
    const RANGE_ENDS: &str = "this is outside the range; `dwell check` shows the range";
    if scene.mechanism.actuators.len() > 1
        && let Some(joints) = error
            .group()
            .and_then(|g| plan.described_groups().into_iter().nth(g))
            .map(|group| group.joints)
    {
        return explain_several(scene, &joints, error);
    }
    let is_angle = super::prepared::is_angle(scene);
    let name = scene.mechanism.actuators.first().map_or("", |a| &a.name);
    let place = |q| format!("`{name}` = {}", own_coordinate(scene, q, is_angle));
    let at = error.coordinate().map_or_else(String::new, place);
    if let Some(explained) = explain_coupling_end(scene, plan, error, &at) {
        return explained;
    }
    let (message, help) = match *error {
        PositionError::OutOfRange { from, to, .. } => (
            format!(
                "{at} is outside its range, {}",
                describe_ends(scene, from, to, is_angle)
            ),
            "stay within the range; `dwell check` shows it",
        ),
        PositionError::Singular { .. } => (
            format!(
                "the mechanism is in a singular position at {at}: `{name}` does not determine its motion there"
            ),
            match plan.range().limits() {
                None => "it is a change point: change a length, or drive another joint",
                Some(_) => {
                    "at a limit position its coordinate turns back: drive a joint that moves on there; `dwell check` shows the range"
                }
            },
        ),
        PositionError::NoAssembly { gap, .. } => (
            format!(
                "the loops cannot be closed at {at}: {}",
                describe_gap(scene, gap, scene.mechanism.size())
            ),
            RANGE_ENDS,
        ),
        PositionError::NotFinite => (
            format!("`{name}` is not a finite number"),
            "check the numbers of the motion",
        ),
        _ => (
            format!("there is no position at {at}: the loops do not close there"),
            RANGE_ENDS,
        ),
    };
    let place = SceneLocation::Actuator(ActuatorId(0));
    scene_error(scene, message, help, [(place, "its coordinate")])
}

/// Explains a position at which the function of a coupling has no value, or before which it jumps.
fn explain_coupling_end(
    scene: &SpaceScene,
    plan: &Plan,
    error: &PositionError,
    at: &str,
) -> Option<StudyError> {
    let (joint, end) = match *error {
        PositionError::OutOfRange { q, to, .. } => plan.coupling_ends()[usize::from(q > to)]?,
        PositionError::OffTable { coupling, .. } => (coupling, CouplingEnd::Table),
        _ => return None,
    };
    if end == CouplingEnd::Table {
        let mechanism = &scene.mechanism;
        return Some(uncovered_coupling_error(scene, mechanism, joint, at));
    }
    let name = &scene.mechanism.joints[joint.0].name;
    let message = format!("the function of coupling `{name}` jumps before {at}");
    let labels = labels([SceneLocation::CouplingLaw(joint)].into_iter(), "jumps");
    Some(scene_error(scene, message, CONTINUITY_HELP, labels))
}

/// Explains a position of several coordinates at which some joints close loops that have no position.
fn explain_several(scene: &SpaceScene, joints: &[JointId], error: &PositionError) -> StudyError {
    let ground = scene.mechanism.ground;
    let mut bodies: Vec<BodyId> = Vec::new();
    for body in joints
        .iter()
        .flat_map(|j| scene.mechanism.joints[j.0].bodies)
    {
        if body.0 != ground && !bodies.contains(&body) {
            bodies.push(body);
        }
    }
    let names = names_of(scene, &bodies);
    let message = match error {
        PositionError::Singular { .. } => format!(
            "{names} are in a singular position there: the coordinates do not determine their motion"
        ),
        _ => {
            format!("there is no position of {names}: the loops of their joints do not close there")
        }
    };
    let help =
        "the motion cannot continue in this assembly mode: end it earlier, or drive other joints";
    scene_error(
        scene,
        message,
        help,
        joint_labels(joints, "in a loop that does not close"),
    )
}

/// The model under the loads of the scene; those of the drives are last.
pub(super) fn with_loads(scene: &SpaceScene, model: Model) -> Result<Model, StudyError> {
    let mut loads = scene.loads.clone();
    for drive in &scene.drives {
        let load = loads.len();
        let wrong = |what| explain_load_error(scene, &LoadError { load, what });
        loads.push(model.drive_load(drive).map_err(wrong)?);
    }
    let loaded = model.with_loads(loads);
    loaded.map_err(|error| explain_load_error(scene, &error))
}

/// Explains a load, or a drive (drives follow the loads), that does not fit the mechanism.
pub(super) fn explain_load_error(scene: &SpaceScene, error: &LoadError) -> StudyError {
    let load = scene.loads.get(error.load);
    if let Some(friction) = load.and_then(|load| load.friction()) {
        let joint = &scene.mechanism.joints[friction.joint.0].name;
        let message = format!("the friction of joint `{joint}` {}", error.what);
        let would_hold = scene.mechanism.joints[friction.joint.0].kind == JointKind::Cylindrical
            && friction.regularization_speed.is_none()
            && scene.mechanism.actuators.len() != 1;
        let help = if would_hold {
            "add `regularization-speed`, in length units per second: then it is smooth and does not hold"
        } else {
            "replace a joint of its loop by one with more freedoms, such as a spherical or a cylindrical joint; without \
                 `bearing-distance` or `guide-length` no moment counts; `dwell check` shows which reactions are determined"
        };
        let place = (SceneLocation::Load(error.load), "this friction");
        return scene_error(scene, message, help, [place]);
    }
    let name = scene.load_name(error.load).unwrap_or_default();
    let message = format!("`{name}` cannot act on the mechanism: {}", error.what);
    let help = "let it act at another joint, or leave it out";
    let place = (SceneLocation::Load(error.load), "this one");
    scene_error(scene, message, help, [place])
}

/// Explains loads that cannot be evaluated at a state.
pub(super) fn explain_loads(
    scene: &SpaceScene,
    plan: &Plan,
    error: &KinetostaticsError,
) -> StudyError {
    let name = error.load().and_then(|load| scene.load_name(load));
    let name = name.unwrap_or_default();
    let (message, help, at, label) = match *error {
        KinetostaticsError::Position(position) => return explain_position(scene, plan, &position),
        KinetostaticsError::NoDirection { load } => (
            format!("`{name}` has no direction: its two points coincide there"),
            "keep its points apart, or give a spring the free length 0",
            SceneLocation::Load(load),
            "between these points",
        ),
        KinetostaticsError::MagnitudeNotFinite { load } => (
            format!("the magnitude of `{name}` is not a finite number there"),
            "extend its table, or change its expression where it has no value",
            SceneLocation::Magnitude(load),
            "no finite value",
        ),
        KinetostaticsError::SelfLocking { load } => (
            "the mechanism is self-locking by friction there: the equations of motion have no unique solution".to_owned(),
            "reduce a friction coefficient, or apply the force where the joint reactions are smaller",
            SceneLocation::Load(load),
            "together with the other friction loads",
        ),
    };
    scene_error(scene, message, help, [(at, label)])
}
