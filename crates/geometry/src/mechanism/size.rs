//! The size of a mechanism: the length that lengths are compared with.

use super::{ActuatorKind, Coordinate, JointKind, Mechanism};
use crate::plane::Vec2;

impl Mechanism {
    /// The largest distance between two attachments of one body, pitch radius or length of a [`JointKind::Distance`], m;
    /// 1 m where the mechanism has no length at all.
    ///
    /// Attachments are the points at which joints, driven lengths and coupled lengths act on a body. The size therefore
    /// depends neither on where the frame of a body lies or how it is turned, nor on where the mechanism stands, nor
    /// on the order of its parts. Points that only loads or results name do not count.
    ///
    /// ```
    /// use dwell_geometry::{Body, Joint, Mechanism, vec2};
    ///
    /// let pin = |points| Joint::revolute("pin", [0, 1], points);
    /// let mut rod = Mechanism {
    ///     bodies: ["ground", "rod"].map(Body::named).into(),
    ///     joints: vec![pin([vec2(9.0, 9.0), vec2(7.0, 5.0)])],
    ///     ..Mechanism::default()
    /// };
    /// assert_eq!(rod.size(), 1.0); // one attachment a body: no length
    /// rod.joints.push(pin([vec2(9.0, 9.5), vec2(7.0, 8.0)]));
    /// assert_eq!(rod.size(), 3.0); // between the two attachments of the rod
    /// ```
    pub fn size(&self) -> f64 {
        let mut attachments = vec![Vec::new(); self.bodies.len()];
        let mut size = 0.0_f64;
        let mut attach = |bodies: [super::BodyId; 2], points: [Vec2; 2]| {
            for (body, point) in bodies.iter().zip(points) {
                if let Some(of_body) = attachments.get_mut(body.0) {
                    of_body.push(point);
                }
            }
        };
        for joint in &self.joints {
            // A coupling is of coordinates: its points mean nothing.
            if !matches!(joint.kind, JointKind::Coupling(_)) {
                size = size.max(joint.kind.length());
                attach(joint.bodies, joint.points);
            }
        }
        for actuator in &self.actuators {
            if let ActuatorKind::Length(points) = actuator.kind {
                attach(actuator.bodies, points);
            }
        }
        for coupling in &self.couplings {
            for coordinate in [coupling.dependent, coupling.independent] {
                if let Coordinate::Length { bodies, points } = coordinate {
                    attach(bodies, points);
                }
            }
        }
        size = attachments.into_iter().map(diameter).fold(size, f64::max);
        if size > 0.0 { size } else { 1.0 }
    }
}

/// The largest distance between two of some points: it is attained between corners of their convex hull (Andrew's
/// monotone chain), so that a frame with thousands of pins costs little.
fn diameter(mut points: Vec<Vec2>) -> f64 {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut hull: Vec<Vec2> = Vec::new();
    for _upper_and_lower in 0..2 {
        let start = hull.len();
        for &point in &points {
            while let [.., before, last] = hull[start..]
                && (last - before).cross(point - last) <= 0.0
            {
                hull.pop();
            }
            hull.push(point);
        }
        points.reverse();
    }
    let pairs = (1..hull.len()).flat_map(|k| (0..k).map(move |i| (i, k)));
    pairs
        .map(|(i, k)| (hull[i] - hull[k]).norm())
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::vec2;

    #[test]
    fn the_diameter_is_the_largest_of_all_distances_in_any_frame() {
        let points: Vec<Vec2> = (0..60)
            .map(|k| {
                let part = |by: f64| (f64::from(k) * by).fract();
                vec2(3.0 * part(0.618_033_98), part(0.414_213_56))
            })
            .collect();
        let mut want = 0.0_f64;
        for a in &points {
            want = points.iter().map(|b| (*a - *b).norm()).fold(want, f64::max);
        }
        assert_eq!(diameter(points.clone()), want);
        let moved = points
            .iter()
            .map(|p| p.rotate(Vec2::from_angle(0.7)) + vec2(40.0, -3.0));
        assert!((diameter(moved.rev().collect()) - want).abs() < 1e-13);
        assert_eq!(diameter(vec![vec2(2.0, 1.0); 3]), 0.0);
        assert_eq!(diameter(Vec::new()), 0.0);
    }
}
