//! Quantities of bodies that loads and laws depend on, from their frames and velocities alone.

use dwell_geometry::{BodyId, Coordinate, JointKind, Mechanism, Vec2, vec2};

/// The axis, in the first body, along which a joint has a travel.
pub(crate) fn slide_axis(kind: JointKind) -> Option<Vec2> {
    match kind {
        JointKind::Prismatic { axes } => Some(axes[0]),
        JointKind::Slot { axis } => Some(axis),
        _ => None,
    }
}

/// The frames [x, y, θ] of all bodies and their velocities, in m, rad and per s. Where a body does not
/// exist there is no value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyMotion<'a> {
    pub(crate) poses: &'a [[f64; 3]],
    pub(crate) velocities: &'a [[f64; 3]],
}

impl BodyMotion<'_> {
    pub(crate) fn rotation(&self, body: BodyId) -> Option<Vec2> {
        Some(Vec2::from_angle(self.poses.get(body.0)?[2]))
    }

    pub(crate) fn point(&self, body: BodyId, point: Vec2) -> Option<Vec2> {
        let [x, y, _] = *self.poses.get(body.0)?;
        Some(vec2(x, y) + point.rotate(self.rotation(body)?))
    }

    pub(crate) fn point_velocity(&self, body: BodyId, point: Vec2) -> Option<Vec2> {
        let [vx, vy, omega] = *self.velocities.get(body.0)?;
        Some(vec2(vx, vy) + point.rotate(self.rotation(body)?).perp() * omega)
    }

    /// A direction of a body, in the plane.
    pub(crate) fn direction(&self, body: BodyId, direction: Vec2) -> Option<Vec2> {
        Some(direction.rotate(self.rotation(body)?))
    }

    /// Value and velocity of a coordinate; none if the mechanism does not have it.
    pub(crate) fn coordinate(&self, mechanism: &Mechanism, of: Coordinate) -> Option<[f64; 2]> {
        match of {
            Coordinate::Angle(bodies) => self.angle(bodies),
            Coordinate::Length { bodies, points } => self.length(bodies, points),
            Coordinate::Travel(joint) => {
                let joint = mechanism.joints.get(joint.0)?;
                let axis = slide_axis(joint.kind)?;
                self.travel(joint.bodies, joint.points, axis)
            }
        }
    }

    /// A point of each of two bodies.
    pub(crate) fn points(&self, [a, b]: [BodyId; 2], points: [Vec2; 2]) -> Option<[Vec2; 2]> {
        Some([self.point(a, points[0])?, self.point(b, points[1])?])
    }

    /// The vector between two points, and its rate.
    pub(crate) fn gap(&self, bodies: [BodyId; 2], points: [Vec2; 2]) -> Option<[Vec2; 2]> {
        let [from, to] = self.points(bodies, points)?;
        let velocity = |i: usize| self.point_velocity(bodies[i], points[i]);
        Some([to - from, velocity(1)? - velocity(0)?])
    }

    /// Angle of the second body from the first, with the whole revolutions of their frames, and its rate.
    pub(crate) fn angle(&self, [first, second]: [BodyId; 2]) -> Option<[f64; 2]> {
        let of = |all: &[[f64; 3]]| Some(all.get(second.0)?[2] - all.get(first.0)?[2]);
        Some([of(self.poses)?, of(self.velocities)?])
    }

    /// t·(P₂ − P₁) along an axis of the first body, and its rate, in which the axis rotates with the body.
    pub(crate) fn travel(
        &self,
        bodies: [BodyId; 2],
        points: [Vec2; 2],
        axis: Vec2,
    ) -> Option<[f64; 2]> {
        let [gap, rate] = self.gap(bodies, points)?;
        let axis_in_plane = self.direction(bodies[0], axis)?;
        let axis_rate = axis_in_plane.perp() * self.velocities.get(bodies[0].0)?[2];
        let rate = axis_in_plane.dot(rate) + axis_rate.dot(gap);
        Some([axis_in_plane.dot(gap), rate])
    }

    /// The distance of two points, and its rate.
    pub(crate) fn length(&self, bodies: [BodyId; 2], points: [Vec2; 2]) -> Option<[f64; 2]> {
        let [gap, rate] = self.gap(bodies, points)?;
        let length = gap.norm();
        Some([length, gap.dot(rate) / length])
    }
}
