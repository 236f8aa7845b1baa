//! Segments and lines through points of space.

use dwell_geometry::space::Vec3;

/// The point of a segment that is nearest to another.
pub(super) fn nearest_of_segment([a, b]: [Vec3; 2], to: Vec3) -> Vec3 {
    let along = b - a;
    let length = along.dot(along);
    let part = if length > 0.0 {
        (to - a).dot(along) / length
    } else {
        0.0
    };
    a + along.scaled(part.clamp(0.0, 1.0))
}

/// The ends of the straight line through all points; none if they are on none.
pub(super) fn line_of(points: &[Vec3], same: f64) -> Option<[Vec3; 2]> {
    let first = points[0];
    let far = |from: Vec3| {
        let all = points.iter().copied();
        all.max_by(|a, b| (*a - from).norm().total_cmp(&(*b - from).norm()))
    };
    let end = far(first)?;
    let start = far(end)?;
    let along = (end - start).unit()?;
    let is_on = |p: &Vec3| along.cross(*p - start).norm() < same;
    points.iter().all(is_on).then_some([start, end])
}
