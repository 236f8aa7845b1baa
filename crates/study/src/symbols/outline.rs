//! The outlines of bodies, in their frames, and the labels of joints.

use dwell_geometry::{ActuatorKind, BodyId, Joint, JointId, JointKind, Vec2};
use dwell_page::OutlineLook;
use dwell_scene::PlaneScene;

/// Half the height of a block that slides, in reference lengths, and its length in heights.
const BLOCK: f64 = 0.045;
const BLOCK_LENGTH: f64 = 1.6;

/// The largest distance of two points of a body, m.
pub(crate) fn reach(scene: &PlaneScene, body: usize) -> f64 {
    let points = &scene.points[body];
    let pairs = points
        .iter()
        .flat_map(|(_, p)| points.iter().map(move |(_, q)| (*p - *q).norm()));
    pairs.fold(0.0, f64::max)
}

/// The outline of a body in its frame, for symbols of this reference length, m: a small block that slides, a plate through three or more
/// points, or a bar through points of one line.
pub(crate) fn outline_of(scene: &PlaneScene, body: usize, size: f64) -> (OutlineLook, Vec<Vec2>) {
    let mut points: Vec<Vec2> = Vec::new();
    for (_, p) in &scene.points[body] {
        if !points.contains(p) {
            points.push(*p);
        }
    }
    if let (&[middle], Some(axis)) = (points.as_slice(), slide_axis(scene, body)) {
        return (OutlineLook::Block, block(middle, axis, size).into());
    }
    let sum = points.iter().fold(Vec2::ZERO, |sum, p| sum + *p);
    let middle = sum * (1.0 / points.len().max(1) as f64);
    let offsets = points.iter().map(|p| *p - middle);
    let farthest = offsets.max_by(|a, b| a.norm().total_cmp(&b.norm()));
    let line = farthest.unwrap_or(Vec2::ZERO);
    let off_line = |p: &Vec2| line.cross(*p - middle).abs() > 1e-6 * line.norm().powi(2);
    if points.len() > 2 && points.iter().any(off_line) {
        points.sort_by(|a, b| (*a - middle).angle().total_cmp(&(*b - middle).angle()));
        (OutlineLook::Plate, points)
    } else {
        points.sort_by(|a, b| line.dot(*a).total_cmp(&line.dot(*b)));
        (OutlineLook::Bar, points)
    }
}

/// The corners of a block that slides along an axis.
fn block(middle: Vec2, axis: Vec2, size: f64) -> [Vec2; 4] {
    let half = BLOCK * size;
    let (along, across) = (axis * (BLOCK_LENGTH * half), axis.perp() * half);
    let [behind, before] = [middle - along, middle + along];
    [
        behind - across,
        before - across,
        before + across,
        behind + across,
    ]
}

/// The blocks by which a body slides that is more than such a block itself, in its frame: without them it would look pinned.
pub(crate) fn blocks_on(scene: &PlaneScene, body: usize, size: f64) -> Vec<[Vec2; 4]> {
    let joints = scene.mechanism.joints.iter().enumerate();
    let slides = joints.filter(|(j, joint)| joint.bodies[1].0 == body && !is_cylinder(scene, *j));
    let of = |(_, joint): (usize, &Joint)| match joint.kind {
        JointKind::Prismatic { axes } => Some(block(joint.points[1], axes[1], size)),
        _ => None,
    };
    let is_more = body != scene.mechanism.ground && reach(scene, body) > 0.0;
    slides.filter(|_| is_more).filter_map(of).collect()
}

/// Whether a joint is a driven prismatic one between two moving bodies.
pub(crate) fn is_cylinder(scene: &PlaneScene, joint: usize) -> bool {
    let mechanism = &scene.mechanism;
    let drives = ActuatorKind::Travel(JointId(joint));
    let bodies = mechanism.joints[joint].bodies;
    let is_driven = mechanism.actuators.iter().any(|a| a.kind == drives);
    is_driven && bodies.iter().all(|b| b.0 != mechanism.ground)
}

/// The axis of a body's prismatic joint, in its frame.
fn slide_axis(scene: &PlaneScene, body: usize) -> Option<Vec2> {
    let joints = scene.mechanism.joints.iter().enumerate();
    let mut joints = joints.filter(|(j, _)| !is_cylinder(scene, *j));
    joints.find_map(|(_, joint)| match joint.kind {
        JointKind::Prismatic { axes } => {
            let end = joint.bodies.iter().position(|b| *b == BodyId(body))?;
            Some(axes[end])
        }
        _ => None,
    })
}

/// The common label of joints at one point: for a pin of several bodies, whose joints are named `pin-body`, the pin.
pub(crate) fn common_joint_name(scene: &PlaneScene, joints: &[&Joint]) -> String {
    let pin = |joint: &&Joint| {
        let body = scene.mechanism.body_name(joint.bodies[1]);
        let pin = joint.name.strip_suffix(body)?.strip_suffix('-')?;
        Some(pin.to_owned())
    };
    let pins: Option<Vec<String>> = joints.iter().map(pin).collect();
    match pins.as_deref() {
        Some([first, rest @ ..]) if !rest.is_empty() && rest.iter().all(|p| p == first) => {
            first.clone()
        }
        _ => {
            let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
            names.join(", ")
        }
    }
}
