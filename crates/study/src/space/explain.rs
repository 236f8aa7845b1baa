//! Explains why a scene in space cannot be assembled, or has no pose at a coordinate.

use crate::explain::{
    Labels, StudyError, body_labels, describe_ends, joint_labels, labels, scene_error,
};
use crate::number_format::{coordinate_unit, count, digits, number};
use dwell_geometry::space::{JointKind, Plan};
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

/// Where the coordinates at assembly are written.
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
        ModelError::Assembly(error) => explain_assembly(scene, error),
        ModelError::UnbalancedRod { body } => {
            let name = &scene.mechanism.bodies[body.0].name;
            let message = format!(
                "`{name}` turns freely about the line of its two balls, and its mass couples that with the motion: the mechanism \
                 has a second degree of freedom"
            );
            let help = "replace one ball by a universal joint, or give the body a centre of mass on that line and equal moments of \
                        inertia across it";
            scene_error(
                scene,
                message,
                help,
                body_labels(&[*body], "turns about its own line"),
            )
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
                "{names} cannot be assembled at the start: {} m are missing",
                number(*gap)
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
            let message = format!(
                "the mechanism is overconstrained by {}, and the redundant constraints are inconsistent: closure error {gap:.2e} m",
                count(*redundant_count, "constraint")
            );
            let help = "redundant constraints must agree to the last digits: correct a length, a point or an axis, or replace a \
                        joint by one with more freedoms";
            scene_error(
                scene,
                message,
                help,
                joint_labels(joints, "among the redundant constraints"),
            )
        }
        AssemblyError::SingularAssembly { joints, .. } => {
            let message = "the start is a singular position: the actuator does not determine the motion there";
            let help = "start a little away from it, or drive another joint";
            scene_error(scene, message, help, with_start(joints, "singular here"))
        }
        // Only planar mechanisms yield these.
        AssemblyError::Ambiguous { .. } | AssemblyError::NotMeshing { .. } => {
            scene_error(scene, error.to_string(), "", [(SceneLocation::Whole, "")])
        }
    }
}

/// One arm for each error, so longer than a screen.
fn explain_structure(scene: &SpaceScene, error: &StructureError) -> StudyError {
    let driven = |text: &str| {
        let actuators = (0..scene.mechanism.actuators.len()).map(ActuatorId);
        labels(actuators.map(SceneLocation::Actuator), text)
    };
    match error {
        StructureError::NotConnected { bodies } => {
            let message = format!(
                "no chain of joints connects {} with the ground",
                names_of(scene, bodies)
            );
            let places = body_labels(bodies, "not reached by any chain of joints");
            scene_error(
                scene,
                message,
                "add the missing joint, or remove the body",
                places,
            )
        }
        StructureError::UnderActuated {
            degrees_of_freedom,
            actuators,
            bodies,
            ..
        } => {
            let freedom = count(*degrees_of_freedom, "degree of freedom");
            let message = format!(
                "the mechanism has {freedom} and {}",
                count(*actuators, "actuator")
            );
            let help = "each degree of freedom needs an actuator: add one, or a joint that is missing, or replace a joint by one \
                        with fewer freedoms";
            let mut places = body_labels(bodies, "nothing determines its motion");
            places.extend(driven("drives it"));
            if places.is_empty() {
                places.push((
                    SceneLocation::Whole,
                    "there are no [actuators] in this file".to_owned(),
                ));
            }
            scene_error(scene, message, help, places)
        }
        StructureError::OverConstrained {
            redundant_count, ..
        } => {
            let actuators = scene.mechanism.actuators.len();
            let message = format!(
                "the mechanism has {} and {}",
                count(
                    actuators.saturating_sub(*redundant_count),
                    "degree of freedom"
                ),
                count(actuators, "actuator")
            );
            let help = "each degree of freedom needs one actuator: remove an actuator, or replace a joint by one with more freedoms";
            scene_error(scene, message, help, driven("drives it"))
        }
        StructureError::Gear { joint, reason } => {
            let name = &scene.mechanism.joints[joint.0].name;
            let message = format!("the teeth of gear pair `{name}` cannot mesh: {reason}");
            let help = "both wheels need bearings whose axes keep their places in the carrier, the body of the pitch point; and \
                        the normal of the teeth must have an arm about each axis";
            let mut places = joint_labels(&[*joint], "this gear pair");
            places.push((
                SceneLocation::Axis(*joint),
                "the normal of its teeth".to_owned(),
            ));
            scene_error(scene, message, help, places)
        }
        StructureError::Malformed { reason } => scene_error(
            scene,
            (*reason).to_owned(),
            "",
            [(SceneLocation::Whole, "")],
        ),
    }
}

/// Explains a position that cannot be computed.
pub(super) fn explain_position(
    scene: &SpaceScene,
    plan: &Plan,
    error: &PositionError,
) -> StudyError {
    const RANGE_ENDS: &str = "this is outside the range; `dwell check` shows the range";
    let is_angle = super::prepared::is_angle(scene);
    let name = scene.mechanism.actuators.first().map_or("", |a| &a.name);
    let at = format!(
        "`{name}` = {} {}",
        number(error.coordinate()),
        coordinate_unit(is_angle)
    );
    let (message, help) = match *error {
        PositionError::OutOfRange { from, to, .. } => (
            format!(
                "{at} is outside its range, {}",
                describe_ends(from, to, is_angle)
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
                "the loops cannot be closed at {at}: gap of {} m",
                digits(gap, 3)
            ),
            RANGE_ENDS,
        ),
        _ => (
            format!("there is no position at {at}: the loops do not close there"),
            RANGE_ENDS,
        ),
    };
    let places = labels(
        std::iter::once(SceneLocation::Actuator(ActuatorId(0))),
        "its coordinate",
    );
    scene_error(scene, message, help, places)
}

/// The same model under the loads of the scene, the drives' last.
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

/// Explains a load, or a drive behind the loads, that does not fit the mechanism.
pub(super) fn explain_load_error(scene: &SpaceScene, error: &LoadError) -> StudyError {
    let load = scene.loads.get(error.load);
    if let Some(friction) = load.and_then(|load| load.friction()) {
        let joint = &scene.mechanism.joints[friction.joint.0].name;
        let message = format!("the friction of joint `{joint}` {}", error.what);
        if scene.mechanism.joints[friction.joint.0].kind == JointKind::Cylindrical
            && friction.regularization_speed.is_none()
            && scene.mechanism.actuators.len() != 1
        {
            let help = "add `regularization-speed`, in length units per second: then it is smooth and does not hold";
            let place = (SceneLocation::Load(error.load), "this friction");
            return scene_error(scene, message, help, [place]);
        }
        let help = "replace a joint of its loop by one with more freedoms, such as a spherical or a cylindrical joint; without \
                    `bearing-distance` or `guide-length` no moment counts; `dwell check` shows which reactions are determined";
        let place = (SceneLocation::Load(error.load), "this friction");
        return scene_error(scene, message, help, [place]);
    }
    let message = format!(
        "`{}` cannot act on the mechanism: {}",
        name_of_load(scene, error.load),
        error.what
    );
    let help = "let it act at another joint, or leave it out";
    scene_error(
        scene,
        message,
        help,
        [(SceneLocation::Load(error.load), "this one")],
    )
}

/// The name of a load, or of a drive behind them.
pub(super) fn name_of_load(scene: &SpaceScene, load: usize) -> &str {
    let loads = scene.loads.iter().map(|load| load.name.as_str());
    let mut names = loads.chain(scene.drives.iter().map(|drive| drive.name.as_str()));
    names.nth(load).unwrap_or_default()
}

/// Explains loads that cannot be evaluated at a state.
pub(super) fn explain_loads(
    scene: &SpaceScene,
    plan: &Plan,
    error: &KinetostaticsError,
) -> StudyError {
    let (message, help, at, label) = match *error {
        KinetostaticsError::Position(position) => return explain_position(scene, plan, &position),
        KinetostaticsError::NoDirection { load } => (
            format!(
                "`{}` has no direction: its two points coincide there",
                name_of_load(scene, load)
            ),
            "keep its points apart, or give a spring the free length 0",
            SceneLocation::Load(load),
            "between these points",
        ),
        KinetostaticsError::MagnitudeNotFinite { load } => (
            format!(
                "the magnitude of `{}` is not a finite number there",
                name_of_load(scene, load)
            ),
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
