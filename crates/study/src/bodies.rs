//! Poses of the bodies of a scene.

use dwell_geometry::Vec2;

/// Pose of a body: its origin (m), and (cos, sin) of its angle.
pub type BodyPose = (Vec2, Vec2);

/// The position of a point of a body, m.
pub fn point_position(body_poses: &[BodyPose], body: usize, at: Vec2) -> [f64; 2] {
    let (origin, rotation) = body_poses[body];
    let position = origin + at.rotate(rotation);
    [position.x, position.y]
}
