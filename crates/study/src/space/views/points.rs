//! The points of a mechanism in space.

use dwell_geometry::BodyId;
use dwell_geometry::space::{Placement, Vec3};
use dwell_scene::SpaceScene;

/// A point of a body in the axes of the ground.
pub(crate) fn placed(placements: &[Placement], body: BodyId, point: Vec3) -> Vec3 {
    let placement = &placements[body.0];
    placement.position + placement.rotation.apply(point)
}

/// The points of all bodies in their frames: of the joints, and the named ones.
pub(super) fn local_points(scene: &SpaceScene) -> Vec<(BodyId, Vec3)> {
    let joints = scene.mechanism.joints.iter();
    let mut points: Vec<(BodyId, Vec3)> = joints
        .flat_map(|joint| [0, 1].map(|k| (joint.side_body(k), joint.sides[k].point)))
        .collect();
    for (b, named) in scene.points.iter().enumerate() {
        points.extend(named.iter().map(|(_, p)| (BodyId(b), *p)));
    }
    points
}

/// All points in a position, in the axes of the ground.
pub(super) fn points_of(scene: &SpaceScene, placements: &[Placement]) -> Vec<Vec3> {
    let points = local_points(scene).into_iter();
    points
        .map(|(body, point)| placed(placements, body, point))
        .collect()
}
