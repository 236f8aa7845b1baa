//! Labels that point into the scene file, and names of bodies and joints.

use dwell_geometry::{ActuatorId, BodyId, JointId, Mechanism};
use dwell_scene::{Scene, SceneLocation};

pub(crate) type Labels = Vec<(SceneLocation, String)>;

pub(crate) fn body_labels(bodies: &[BodyId], text: &str) -> Labels {
    let label = |&b: &BodyId| (SceneLocation::Body(b), text.to_owned());
    bodies.iter().take(8).map(label).collect()
}

/// Labels of the assembly coordinates.
pub(crate) fn start_labels(scene: &Scene) -> Labels {
    let is_written = |&a: &ActuatorId| {
        // A coordinate that is not written has the location of the initial state.
        scene.span(SceneLocation::AssemblyCoordinate(a))
            != scene.span(SceneLocation::InitialCoordinate(a))
    };
    let actuators = (0..scene.mechanism.actuators.len()).map(ActuatorId);
    let mut labels: Labels = actuators
        .filter(is_written)
        .take(8)
        .map(|a| {
            (
                SceneLocation::AssemblyCoordinate(a),
                "at this start".to_owned(),
            )
        })
        .collect();
    if labels.is_empty() {
        labels.push((SceneLocation::Assembly, "at this start".to_owned()));
    }
    labels
}

pub(crate) fn joint_labels(joints: &[JointId], text: &str) -> Labels {
    let label = |&j: &JointId| (SceneLocation::Joint(j), text.to_owned());
    joints.iter().take(8).map(label).collect()
}

pub(crate) fn body_names(mechanism: &Mechanism, bodies: &[BodyId]) -> String {
    let list: Vec<_> = bodies
        .iter()
        .map(|&b| format!("`{}`", mechanism.body_name(b)))
        .collect();
    list.join(", ")
}

/// The same; "the mechanism" if there are none.
pub(crate) fn body_names_or_mechanism(mechanism: &Mechanism, bodies: &[BodyId]) -> String {
    match bodies {
        [] => "the mechanism".to_owned(),
        bodies => body_names(mechanism, bodies),
    }
}

pub(crate) fn joint_names(mechanism: &Mechanism, joints: &[JointId]) -> String {
    let list: Vec<_> = joints
        .iter()
        .map(|j| format!("`{}`", mechanism.joints[j.0].name))
        .collect();
    list.join(", ")
}

/// Where a scene gives its initial state: without `[motion]`, in its assembly.
pub(crate) fn initial_state_location(scene: &Scene) -> SceneLocation {
    match scene.motion {
        Some(_) => SceneLocation::Motion,
        None => SceneLocation::AssemblyCoordinate(ActuatorId(0)),
    }
}
