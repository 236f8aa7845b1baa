//! Why a motion ends at the switches of a load.

use crate::explain::{NamedScene, StudyError, scene_error};
use crate::number_format::digits;
use dwell_scene::SceneLocation;

/// Explains a load that holds the motion at its switch.
pub(super) fn explain_chatter(scene: &impl NamedScene, load: usize, t: f64) -> StudyError {
    let name = scene.load_name(load).unwrap_or_default();
    let message = format!(
        "load `{name}` switches back and forth without end at t = {} s: on both sides of its switch it drives the motion \
         back to it",
        digits(t, 6)
    );
    let help = "only one such load at a time can hold the motion, not several together: end the motion there with an \
                event, or use a smooth function, such as tanh(speed/0.01) for sign(speed)";
    let label = "switches back and forth";
    scene_error(scene, message, help, [(SceneLocation::Load(load), label)])
}

/// Explains a load that switches so often, as where its switches accumulate, that the end is not reached: after how many switches how many
/// are left.
pub(crate) fn explain_switching(
    scene: &impl NamedScene,
    load: usize,
    t: f64,
    (switches, left): (usize, f64),
) -> StudyError {
    let name = scene.load_name(load).unwrap_or_default();
    let t = digits(t, 6);
    let message = format!(
        "load `{name}` switches too often: at t = {t} s, after {switches} switches, about {left:.0e} remain"
    );
    let help = "if the switches accumulate at an instant, end the motion there with an event, or use a smooth function, such as tanh(speed/0.01) for sign(speed)";
    let label = "switches more and more often";
    scene_error(scene, message, help, [(SceneLocation::Load(load), label)])
}

/// Explains a load that holds the motion at its switch while another switch or contact does so, too.
pub(super) fn explain_several(scene: &impl NamedScene, load: usize, t: f64) -> StudyError {
    let name = scene.load_name(load).unwrap_or_default();
    let message = format!(
        "at t = {} s load `{name}` holds the motion at its switch while another switch, friction or end stop changes or holds \
         it there",
        digits(t, 6)
    );
    let help = "one such switch at a time is computed: give the friction of a joint in [friction] instead of a load with \
                sign(speed), or use a smooth function, such as tanh(speed/0.01)";
    let label = "drives the motion back to its switch from both sides";
    scene_error(scene, message, help, [(SceneLocation::Load(load), label)])
}
