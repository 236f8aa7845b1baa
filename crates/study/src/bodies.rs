//! Poses of the bodies of a scene.

use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{BodyId, Mechanism, Vec2};

/// Pose of a body: its origin (m), and (cos, sin) of its angle.
pub type BodyPose = (Vec2, Vec2);

/// The position of a point of a body, m.
pub fn point_position(body_poses: &[BodyPose], body: usize, at: Vec2) -> [f64; 2] {
    let (origin, rotation) = body_poses[body];
    let position = origin + at.rotate(rotation);
    [position.x, position.y]
}

/// The poses of all bodies of a mechanism.
pub(crate) fn body_poses(states: &BodyStates, mechanism: &Mechanism) -> Vec<BodyPose> {
    let bodies = (0..mechanism.bodies.len()).map(BodyId);
    let pose = |b| {
        (
            states.point(b, Vec2::ZERO).position,
            states.body(b).rotation,
        )
    };
    bodies.map(pose).collect()
}
