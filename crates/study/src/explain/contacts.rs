//! Explains friction that holds, end stops, and functions of a program that jump.

use crate::explain::{NamedScene, StudyError, own_coordinate, scene_error};
use crate::number_format::digits;
use dwell_geometry::ActuatorId;
use dwell_scene::SceneLocation;

/// Explains a joint whose surfaces can neither hold nor slide.
pub(super) fn explain_no_mode(scene: &impl NamedScene, load: usize) -> StudyError {
    let name = joint_of(scene, load);
    let message = format!(
        "the surfaces of joint `{name}` can neither stick nor slide: no direction of sliding agrees with the forces, and \
         sticking needs more than the static limit"
    );
    let help = "the joint locks: reduce a friction coefficient, or apply the force where the joint reactions are smaller; \
                with a `regularization-speed` it has a force at every speed";
    let label = "together with the other friction";
    scene_error(scene, message, help, [(SceneLocation::Load(load), label)])
}

/// Explains an analysis of smooth motions in which friction would hold.
pub(super) fn explain_sticking(scene: &impl NamedScene, load: usize, what: &str) -> StudyError {
    let name = joint_of(scene, load);
    let message = format!("the dry friction of joint `{name}` holds at rest: {what}");
    let help = "give it a `regularization-speed`, with which it is smooth and does not hold; `dwell simulate` computes the \
                motion with friction that holds";
    let label = "has no `regularization-speed`";
    scene_error(scene, message, help, [(SceneLocation::Load(load), label)])
}

/// Explains steps that are so short that the motion makes no progress. If a load is given as a function of a program, the error
/// names it.
pub(super) fn explain_no_progress(
    scene: &impl NamedScene,
    function: Option<usize>,
    [t, step]: [f64; 2],
) -> StudyError {
    let at = digits(t, 6);
    let step = if step > 0.0 {
        format!("of {} s", digits(step, 2))
    } else {
        "below the rounding of time".to_owned()
    };
    let mut message = format!("the motion makes no progress at t = {at} s, in steps {step}");
    let name = function.and_then(|load| Some((load, scene.load_name(load)?)));
    let (help, place) = match name {
        Some((load, name)) => {
            message += &format!(
                "; load `{name}` is a function of your program, which may jump or have a kink there"
            );
            let help = "name these values of its signals as its `breakpoints`, or write it as an expression, whose switches are found";
            (help, (SceneLocation::Load(load), "its function jumps"))
        }
        None => {
            let help = "a limit position or a change point may be near, or a load varies without end: end the motion earlier, or use a larger tolerance";
            (help, (SceneLocation::Duration, "beyond that time"))
        }
    };
    scene_error(scene, message, help, [place])
}

/// The motion starts beyond an end stop.
pub(super) fn explain_beyond_stop(scene: &impl NamedScene, stop: usize, q: f64) -> StudyError {
    let (_, actuator) = scene.stop(stop).unwrap_or(("", ActuatorId(0)));
    let is_angle = scene.actuator(actuator.0).is_some_and(|(_, angle)| angle);
    let (name, at) = (stop_name(scene, stop), own_coordinate(scene, q, is_angle));
    let message = format!("the motion starts at {at}, beyond end stop `{name}`");
    let help = "start between the limits, or move the stop";
    let places = [
        (SceneLocation::Stop(stop), "this stop"),
        (SceneLocation::InitialCoordinate(actuator), "beyond it"),
    ];
    scene_error(scene, message, help, places)
}

/// Explains an analysis of motions that meet no end stop.
pub(super) fn explain_stop(scene: &impl NamedScene, stop: usize, what: &str) -> StudyError {
    let message = format!("end stop `{}`: {what}", stop_name(scene, stop));
    let help = "leave out [stops]; `dwell simulate` computes the motion with them";
    let place = (SceneLocation::Stop(stop), "this end stop");
    scene_error(scene, message, help, [place])
}

/// Explains impacts on an end stop, or changes between rest and motion, that follow each other without end.
pub(super) fn explain_endless_impacts(scene: &impl NamedScene, stop: usize) -> StudyError {
    let name = stop_name(scene, stop);
    let message = format!(
        "at end stop `{name}`, impacts or changes between rest and motion follow each other without end"
    );
    let place = (SceneLocation::Stop(stop), "this end stop");
    let help = "give it a smaller restitution, or keep other stops from being met at the same instant; one with a `stiffness` \
                has no impacts";
    scene_error(scene, message, help, [place])
}

fn stop_name(scene: &impl NamedScene, stop: usize) -> &str {
    scene.stop(stop).map_or("", |(name, _)| name)
}

/// The joint of a friction.
fn joint_of(scene: &impl NamedScene, load: usize) -> &str {
    let name = scene.load_name(load).unwrap_or_default();
    name.strip_suffix(".friction").unwrap_or(name)
}
