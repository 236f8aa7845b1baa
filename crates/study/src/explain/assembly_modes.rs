//! Several assembly modes: which initial guesses in the scene select one of them.

use crate::explain::{
    StudyError, body_labels, body_names_or_mechanism, joint_labels, scene_error, start_labels,
};
use crate::number_format::number;
use dwell_geometry::{BodyId, BranchHint, JointId, Mechanism};
use dwell_scene::Scene;

/// Maximum number of assembly modes in a message.
const MAX_LISTED: usize = 6;

/// Explains that no initial guess selects one of the assembly modes. Each mode lists the angle of each body
/// (rad), then the travel or direction of each joint (m or rad).
pub(crate) fn explain_ambiguous(
    scene: &Scene,
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
    let message = format!("{names} has {count} assembly modes, and no initial guess selects one");
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

/// Entries for [assembly]: of one joint if it differs in every mode, else of all.
fn suggested_hints(scene: &Scene, joints: &[JointId], modes: &[Vec<f64>]) -> String {
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
    let rename = match free.is_empty() {
        true => "give the joint a name that no body or actuator has, and ",
        false => "",
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
