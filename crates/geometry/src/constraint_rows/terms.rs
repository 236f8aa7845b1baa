//! The terms of rows: five quantities between two bodies, each with its
//! derivative by the body coordinates and its second derivative along a motion.

use crate::plane::{Vec2, vec2};

/// First of a body's three columns; `None` for the ground.
pub(super) type Column = Option<usize>;

/// A point on a body.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyPoint {
    pub(super) column: Column,
    pub(super) point: Vec2,
}

/// A quantity of two bodies. With d = P2 − P1, all in the plane's directions:
#[derive(Debug, Clone, Copy)]
pub(super) enum ConstraintTerm {
    /// θ2 − θ1, rad, as counted in x.
    RelativeAngle([Column; 2]),
    /// u·d, m, with u fixed in the plane.
    GroundFixedComponent([BodyPoint; 2], Vec2),
    /// u·d, m, with u fixed in the first body.
    BodyFixedComponent([BodyPoint; 2], Vec2),
    /// |d|, m. It has no derivative at zero, and gives numbers that are not finite there.
    Distance([BodyPoint; 2]),
    /// Direction of d, rad, in (−π, π]. It does not exist where d is zero.
    LineDirection([BodyPoint; 2]),
}

/// Coordinates, with the direction (cos θ, sin θ) of every moving body found once.
pub(super) struct BodyCoordinates<'a> {
    x: &'a [f64],
    rotations: Vec<Vec2>,
}

/// Two points: their vectors from the bodies' origins, and d from the first to the second.
struct Gap {
    offsets: [Vec2; 2],
    d: Vec2,
}

impl<'a> BodyCoordinates<'a> {
    pub(super) fn new(x: &'a [f64]) -> Self {
        let rotations = x.chunks_exact(3).map(|b| Vec2::from_angle(b[2])).collect();
        Self { x, rotations }
    }

    fn rotation(&self, column: Column) -> Vec2 {
        column.map_or(Vec2::IDENTITY, |c| self.rotations[c / 3])
    }

    fn gap(&self, points: [BodyPoint; 2]) -> Gap {
        let offsets = points.map(|p| p.point.rotate(self.rotation(p.column)));
        let origin = |c: usize| vec2(self.x[c], self.x[c + 1]);
        let origins = points.map(|p| p.column.map_or(Vec2::ZERO, origin));
        Gap {
            offsets,
            // Origins first: two frames may stand far away, and close to each other.
            d: (origins[1] - origins[0]) + (offsets[1] - offsets[0]),
        }
    }
}

/// A body's angle, or its rate, out of coordinates or speeds.
pub(super) fn angle_of(column: Column, x: &[f64]) -> f64 {
    column.map_or(0.0, |c| x[c + 2])
}

impl ConstraintTerm {
    /// The value.
    pub(super) fn value(&self, at: &BodyCoordinates<'_>) -> f64 {
        match *self {
            Self::RelativeAngle([first, second]) => angle_of(second, at.x) - angle_of(first, at.x),
            Self::GroundFixedComponent(points, u) => u.dot(at.gap(points).d),
            Self::BodyFixedComponent(points, u) => u
                .rotate(at.rotation(points[0].column))
                .dot(at.gap(points).d),
            Self::Distance(points) => at.gap(points).d.norm(),
            Self::LineDirection(points) => at.gap(points).d.angle(),
        }
    }

    /// Calls `add` with the derivative by [x, y, θ] of each of the two bodies that moves.
    pub(super) fn gradient(&self, at: &BodyCoordinates<'_>, mut add: impl FnMut(usize, [f64; 3])) {
        let mut give = |column: Column, derivative: [f64; 3]| {
            if let Some(c) = column {
                add(c, derivative);
            }
        };
        // A quantity that changes by w·δP2 − w·δP1, and P moves by perp(vector) per radian.
        let mut pair = |points: [BodyPoint; 2], offsets: [Vec2; 2], w: Vec2| {
            give(points[0].column, [-w.x, -w.y, -offsets[0].cross(w)]);
            give(points[1].column, [w.x, w.y, offsets[1].cross(w)]);
        };
        match *self {
            Self::RelativeAngle([first, second]) => {
                give(first, [0.0, 0.0, -1.0]);
                give(second, [0.0, 0.0, 1.0]);
            }
            Self::GroundFixedComponent(points, u) => pair(points, at.gap(points).offsets, u),
            Self::BodyFixedComponent(points, u) => {
                let Gap { offsets, d } = at.gap(points);
                // The first body's vector reaches to P2, not to P1, because u turns with it.
                let offsets_to_second = [offsets[0] + d, offsets[1]];
                let u = u.rotate(at.rotation(points[0].column));
                pair(points, offsets_to_second, u);
            }
            Self::Distance(points) => {
                let Gap { offsets, d } = at.gap(points);
                pair(points, offsets, d * (1.0 / d.norm()));
            }
            Self::LineDirection(points) => {
                let Gap { offsets, d } = at.gap(points);
                pair(points, offsets, d.perp() * (1.0 / d.dot(d)));
            }
        }
    }

    /// The rate of the value under the speeds `x_dot`.
    pub(super) fn rate(&self, at: &BodyCoordinates<'_>, x_dot: &[f64]) -> f64 {
        let mut rate = 0.0;
        self.gradient(at, |c, [x, y, angle]| {
            rate += x * x_dot[c] + y * x_dot[c + 1] + angle * x_dot[c + 2];
        });
        rate
    }

    /// The second derivative along x + s ẋ at s = 0.
    pub(super) fn velocity_product(&self, at: &BodyCoordinates<'_>, x_dot: &[f64]) -> f64 {
        // d, ḋ, and the part of d̈ that comes from the bodies' ω² alone.
        let gap_motion = |points: [BodyPoint; 2]| {
            let Gap { offsets, d } = at.gap(points);
            let [one, two] = [0, 1].map(|i| match points[i].column {
                None => (Vec2::ZERO, Vec2::ZERO),
                Some(c) => {
                    let omega = x_dot[c + 2];
                    let velocity = vec2(x_dot[c], x_dot[c + 1]) + offsets[i].perp() * omega;
                    (velocity, -offsets[i] * (omega * omega))
                }
            });
            (d, two.0 - one.0, two.1 - one.1)
        };
        match *self {
            Self::RelativeAngle(_) => 0.0,
            Self::GroundFixedComponent(points, u) => u.dot(gap_motion(points).2),
            Self::BodyFixedComponent(points, u) => {
                // d²(u·d) = ü·d + 2 u̇·ḋ + u·d̈, with u̇ = ω1 perp(u) and ü = −ω1² u.
                let (d, velocity, centripetal) = gap_motion(points);
                let u = u.rotate(at.rotation(points[0].column));
                let omega = angle_of(points[0].column, x_dot);
                u.dot(centripetal) + 2.0 * omega * u.perp().dot(velocity) - omega * omega * u.dot(d)
            }
            Self::Distance(points) => {
                // l l̇ = d·ḋ, so l l̈ = d·d̈ + ḋ·ḋ − l̇², of which the last two are the square of
                // the speed across d.
                let (d, velocity, centripetal) = gap_motion(points);
                let l = d.norm();
                let e = d * (1.0 / l);
                let across = e.cross(velocity);
                e.dot(centripetal) + across * across / l
            }
            Self::LineDirection(points) => {
                // l² ψ̇ = d × ḋ, so l² ψ̈ = d × d̈ − 2 (d·ḋ) ψ̇.
                let (d, velocity, centripetal) = gap_motion(points);
                let square = d.dot(d);
                let line_rate = d.cross(velocity) / square;
                (d.cross(centripetal) - 2.0 * d.dot(velocity) * line_rate) / square
            }
        }
    }
}
