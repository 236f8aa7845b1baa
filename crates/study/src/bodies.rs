//! Sizes and poses of the bodies of a scene.

use dwell_geometry::Vec2;
use dwell_scene::Scene;

/// The largest coordinate of a point in its body, m.
pub(crate) fn max_point_coordinate(scene: &Scene) -> f64 {
    let points = scene.points.iter().flatten();
    points.fold(0.0, |m, (_, at)| m.max(at.x.abs()).max(at.y.abs()))
}

/// The largest distance of two points of a body, m.
pub(crate) fn max_point_distance(scene: &Scene) -> f64 {
    let of_body = |points: &Vec<(String, dwell_geometry::Vec2)>| {
        let pairs = points
            .iter()
            .flat_map(|(_, p)| points.iter().map(move |(_, r)| (*p - *r).norm()));
        pairs.fold(0.0, f64::max)
    };
    let largest = scene.points.iter().map(of_body).fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// Pose of a body: its origin (m), and (cos, sin) of its angle.
pub type BodyPose = (Vec2, Vec2);

/// The position of a point of a body, m.
pub fn point_position(body_poses: &[BodyPose], body: usize, at: Vec2) -> [f64; 2] {
    let (origin, rotation) = body_poses[body];
    let position = origin + at.rotate(rotation);
    [position.x, position.y]
}

/// The mean length of the bodies that have one, m.
pub(crate) fn mean_body_length(scene: &Scene) -> f64 {
    let extent = |points: &Vec<(String, Vec2)>| {
        let all = points
            .iter()
            .flat_map(|(_, p)| points.iter().map(|(_, r)| (*p - *r).norm()));
        all.fold(0.0, f64::max)
    };
    let lengths: Vec<f64> = scene
        .points
        .iter()
        .map(extent)
        .filter(|l| *l > 0.0)
        .collect();
    lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
}
