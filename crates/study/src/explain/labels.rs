//! Errors with their places in the scene file, and names of bodies and joints.

use crate::explain::{NamedScene, StudyError};
use dwell_geometry::{ActuatorId, BodyId, JointId, Mechanism};
use dwell_scene::{PlaneScene, SceneFile, SceneLocation};

/// Places in the scene file, each with its remark.
pub(crate) type Labels = Vec<(SceneLocation, String)>;

/// Bodies or joints that a message marks.
const MAX_MARKED: usize = 8;

/// An error of a scene with a suggestion (may be empty) and its places in the file.
pub fn scene_error<L: Into<String>>(
    scene: &SceneFile,
    message: impl Into<String>,
    help: impl Into<String>,
    labels: impl IntoIterator<Item = (SceneLocation, L)>,
) -> StudyError {
    let labels = labels.into_iter().map(|(at, text)| (at, text.into()));
    let help = Some(help.into()).filter(|help| !help.is_empty());
    let error = scene.error(message.into(), help, &labels.collect::<Labels>());
    error.into()
}

/// One remark at several places.
pub(crate) fn labels(places: impl Iterator<Item = SceneLocation>, text: &str) -> Labels {
    places.map(|at| (at, text.to_owned())).collect()
}

pub(crate) fn body_labels(bodies: &[BodyId], text: &str) -> Labels {
    let places = bodies.iter().map(|&b| SceneLocation::Body(b));
    labels(places.take(MAX_MARKED), text)
}

pub(crate) fn joint_labels(joints: &[JointId], text: &str) -> Labels {
    let places = joints.iter().map(|&j| SceneLocation::Joint(j));
    labels(places.take(MAX_MARKED), text)
}

/// Labels of all actuators; of the whole file if there are none.
pub(crate) fn actuator_labels(scene: &impl NamedScene, text: &str) -> Labels {
    let actuators = (0..).take_while(|k| scene.actuator(*k).is_some());
    let places = actuators.map(|k| SceneLocation::Actuator(ActuatorId(k)));
    match labels(places, text) {
        none if none.is_empty() => missing_section_label("actuators"),
        labels => labels,
    }
}

/// The label of a section that the file does not have.
pub(crate) fn missing_section_label(section: &str) -> Labels {
    let verb = if section.ends_with('s') { "are" } else { "is" };
    let text = format!("there {verb} no [{section}] in this file");
    vec![(SceneLocation::Whole, text)]
}

/// Labels of the assembly coordinates.
pub(crate) fn start_labels(scene: &PlaneScene) -> Labels {
    let actuators = (0..scene.mechanism.actuators.len()).map(ActuatorId);
    // A coordinate that is not written has the location of the initial state.
    let is_written = |&a: &ActuatorId| {
        let initial = SceneLocation::InitialCoordinate(a);
        scene.span(SceneLocation::AssemblyCoordinate(a)) != scene.span(initial)
    };
    let written = actuators.filter(is_written).take(MAX_MARKED);
    let written = written.map(SceneLocation::AssemblyCoordinate);
    match labels(written, "at this start") {
        none if none.is_empty() => labels([SceneLocation::Assembly].into_iter(), "at this start"),
        labels => labels,
    }
}

fn quoted<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<_> = names.map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

pub(crate) fn body_names(mechanism: &Mechanism, bodies: &[BodyId]) -> String {
    quoted(bodies.iter().map(|&b| mechanism.body_name(b)))
}

/// The names of bodies; "the mechanism" if there are none.
pub(crate) fn body_names_or_mechanism(mechanism: &Mechanism, bodies: &[BodyId]) -> String {
    match bodies {
        [] => "the mechanism".to_owned(),
        bodies => body_names(mechanism, bodies),
    }
}

pub(crate) fn joint_names(mechanism: &Mechanism, joints: &[JointId]) -> String {
    quoted(joints.iter().map(|j| mechanism.joints[j.0].name.as_str()))
}
