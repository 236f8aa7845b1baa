//! Explains friction that holds, and end stops.

use crate::explain::{StudyError, scene_error};
use crate::number_format::{coordinate_unit, number};
use dwell_geometry::{ActuatorId, Plan};
use dwell_scene::{Scene, SceneLocation};

/// Explains a joint whose surfaces can neither hold nor slide.
pub(super) fn explain_no_mode(scene: &Scene, load: usize) -> StudyError {
    let name = joint_of(scene, load);
    let message = format!(
        "the surfaces of joint `{name}` can neither hold nor slide: no direction of sliding agrees with the forces, and to \
         hold takes more than the static limit"
    );
    let help = "the joint locks: reduce a friction coefficient, or apply the force where the joint reactions are smaller; \
                with a `regularization-speed` it has a force at every speed";
    let label = "together with the other friction";
    scene_error(scene, message, help, [(SceneLocation::Load(load), label)])
}

/// Explains an analysis of smooth motions in which friction would hold.
pub(super) fn explain_sticking(scene: &Scene, load: usize, what: &str) -> StudyError {
    let name = joint_of(scene, load);
    let message = format!("the dry friction of joint `{name}` holds at rest: {what}");
    let help = "give it a `regularization-speed`, with which it is smooth and does not hold; `dwell simulate` computes the \
                motion with friction that holds";
    let label = "has no `regularization-speed`";
    scene_error(scene, message, help, [(SceneLocation::Load(load), label)])
}

/// The motion starts beyond an end stop.
pub(super) fn explain_beyond_stop(scene: &Scene, plan: &Plan, stop: usize, q: f64) -> StudyError {
    let actuator = scene
        .stops
        .get(stop)
        .map_or(ActuatorId(0), |stop| stop.actuator);
    let unit = coordinate_unit(plan.is_angle(actuator.0));
    let name = stop_name(scene, stop);
    let message = format!(
        "the motion starts at {} {unit}, beyond end stop `{name}`",
        number(q)
    );
    let help = "start between the limits, or move the stop";
    let places = [
        (SceneLocation::Stop(stop), "this stop"),
        (SceneLocation::InitialCoordinate(actuator), "beyond it"),
    ];
    scene_error(scene, message, help, places)
}

/// Explains an analysis of motions that meet no end stop.
pub(super) fn explain_stop(scene: &Scene, stop: usize, what: &str) -> StudyError {
    let message = format!("end stop `{}`: {what}", stop_name(scene, stop));
    let help = "leave out [stops]; `dwell simulate` computes the motion with them";
    let place = (SceneLocation::Stop(stop), "this end stop");
    scene_error(scene, message, help, [place])
}

/// Explains impacts that follow each other without end.
pub(super) fn explain_endless_impacts(scene: &Scene, stop: usize) -> StudyError {
    let name = stop_name(scene, stop);
    let message = format!("the impacts on end stop `{name}` follow each other without end");
    let place = (SceneLocation::Stop(stop), "this end stop");
    scene_error(scene, message, "give it a smaller restitution", [place])
}

fn stop_name(scene: &Scene, stop: usize) -> &str {
    scene.stops.get(stop).map_or("", |stop| stop.name.as_str())
}

/// The joint of a friction.
fn joint_of(scene: &Scene, load: usize) -> &str {
    let name = scene.loads.get(load).map_or("", |load| load.name.as_str());
    name.strip_suffix(".friction").unwrap_or(name)
}
