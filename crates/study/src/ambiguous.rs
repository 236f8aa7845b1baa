//! A mechanism that closes in several ways, and what the scene can say to mean one of them.

use crate::error::{body_labels, joint_labels, names_or_whole, start_labels};
use crate::words::number;
use dwell_geometry::{BodyId, JointId, Mechanism, Told};
use dwell_scene::{Scene, SceneError};

/// Ways that a message lists.
const LISTED: usize = 6;

/// Explains that nothing says which of the ways is meant: each is given by the angle of each body,
/// rad, and the travel or direction of each joint, m or rad.
pub(crate) fn ambiguous(
    scene: &Scene,
    bodies: &[BodyId],
    joints: &[JointId],
    ways: &[Vec<f64>],
) -> SceneError {
    let mechanism = &scene.mechanism;
    let (labels, help) = match (bodies, joints) {
        ([], []) => (
            start_labels(scene),
            "no body and no joint tells them apart: drive another joint".to_owned(),
        ),
        (bodies, []) => (
            body_labels(bodies, "its angle is open"),
            format!(
                "give a rough angle of one of them in [assembly]; the ways are: {}",
                by_angles(mechanism, bodies, ways)
            ),
        ),
        ([], joints) => (
            joint_labels(joints, "where it stands is open"),
            to_add(scene, joints, ways),
        ),
        (bodies, joints) => {
            let mut labels = body_labels(bodies, "its angle is open");
            labels.extend(joint_labels(joints, "where it stands is open"));
            let after = |way: &Vec<f64>| way.get(bodies.len()..).unwrap_or_default().to_vec();
            let travels: Vec<_> = ways.iter().map(after).collect();
            (
                labels,
                format!(
                    "the angles of bodies do not tell all of them apart: they are {}; {}",
                    by_angles(mechanism, bodies, ways),
                    to_add(scene, joints, &travels)
                ),
            )
        }
    };
    scene.error(
        format!(
            "{} can be assembled in {} ways, and nothing says which is meant",
            names_or_whole(mechanism, bodies),
            ways.len()
        ),
        Some(help),
        &labels,
    )
}

fn by_angles(mechanism: &Mechanism, bodies: &[BodyId], ways: &[Vec<f64>]) -> String {
    let way = |angles: &Vec<f64>| {
        let angle = |(b, a): (&BodyId, &f64)| {
            let degrees = a.to_degrees();
            format!("{} {a:.3} rad ({degrees:.1}°)", mechanism.body_name(*b))
        };
        let all: Vec<_> = bodies.iter().zip(angles).map(angle).collect();
        all.join(", ")
    };
    let ways: Vec<_> = ways.iter().take(LISTED).map(way).collect();
    ways.join("; or ")
}

/// What to write in [assembly]: of one joint if it stands differently in each way, else of all.
fn to_add(scene: &Scene, joints: &[JointId], ways: &[Vec<f64>]) -> String {
    let mechanism = &scene.mechanism;
    let written = |k: usize, way: &[f64]| {
        let joint = &mechanism.joints[joints[k].0];
        let is_angle = joint.kind.told() == Some(Told::Direction);
        let si = way.get(k).copied().unwrap_or(f64::NAN);
        let (value, _) = scene.written(si, is_angle);
        format!("{} = {}", joint.name, number(value))
    };
    // In [assembly] the name of a body or an actuator means that.
    let taken = |k: usize| {
        let name = &mechanism.joints[joints[k].0].name;
        let mut bodies = mechanism.bodies.iter().map(|b| &b.name);
        let mut actuators = mechanism.actuators.iter().map(|a| &a.name);
        bodies.any(|other| other == name) || actuators.any(|other| other == name)
    };
    let tells = |k: usize| {
        let mut texts: Vec<_> = ways.iter().map(|way| written(k, way)).collect();
        texts.sort();
        texts.windows(2).all(|pair| pair[0] != pair[1])
    };
    let free: Vec<usize> = (0..joints.len()).filter(|&k| !taken(k)).collect();
    let one = free.iter().copied().find(|&k| tells(k));
    let (shown, rename) = match (one, free.is_empty()) {
        (Some(one), _) => (vec![one], ""),
        (None, false) => (free, ""),
        (None, true) => (
            (0..joints.len()).collect(),
            "name the joint unlike any body and any actuator, and ",
        ),
    };
    let way = |way: &Vec<f64>| {
        let each: Vec<_> = shown
            .iter()
            .map(|&k| format!("`{}`", written(k, way)))
            .collect();
        each.join(" and ")
    };
    let ways: Vec<_> = ways.iter().take(LISTED).map(way).collect();
    format!("{rename}add {} to [assembly]", ways.join(" or "))
}
