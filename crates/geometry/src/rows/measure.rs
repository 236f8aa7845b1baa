//! What rows are sums of: five quantities that can be measured between two bodies, each with its
//! derivative by the body coordinates and its second derivative along a motion.

use crate::plane::{Vec2, vec2};

/// First of a body's three columns; `None` for the ground.
pub(super) type Column = Option<usize>;

/// A point on a body.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub(super) column: Column,
    pub(super) point: Vec2,
}

/// A quantity of two bodies. With d = P2 − P1, all in the plane's directions:
#[derive(Debug, Clone, Copy)]
pub(super) enum Measure {
    /// θ2 − θ1, rad, as counted in x.
    Turn([Column; 2]),
    /// u·d, m, with u fixed in the plane.
    Fixed([End; 2], Vec2),
    /// u·d, m, with u fixed in the first body.
    Along([End; 2], Vec2),
    /// |d|, m. It has no derivative at zero, and gives numbers that are not finite there.
    Length([End; 2]),
    /// Direction of d, rad, in (−π, π]. It does not exist where d is zero.
    Bearing([End; 2]),
}

/// Coordinates, with the direction (cos θ, sin θ) of every moving body found once.
pub(super) struct Places<'a> {
    x: &'a [f64],
    turned: Vec<Vec2>,
}

/// How two points stand: their arms from the bodies' origins, and d from the first to the second.
struct Gap {
    arms: [Vec2; 2],
    d: Vec2,
}

impl<'a> Places<'a> {
    pub(super) fn new(x: &'a [f64]) -> Self {
        let turned = x.chunks_exact(3).map(|b| Vec2::from_angle(b[2])).collect();
        Self { x, turned }
    }

    fn direction(&self, column: Column) -> Vec2 {
        column.map_or(Vec2::IDENTITY, |c| self.turned[c / 3])
    }

    fn gap(&self, ends: [End; 2]) -> Gap {
        let arms = ends.map(|end| end.point.turn(self.direction(end.column)));
        let origins = ends.map(|end| {
            end.column
                .map_or(Vec2::ZERO, |c| vec2(self.x[c], self.x[c + 1]))
        });
        Gap {
            arms,
            // Origins first: two frames may stand far away, and close to each other.
            d: (origins[1] - origins[0]) + (arms[1] - arms[0]),
        }
    }
}

/// A body's angle, or its rate, out of coordinates or speeds.
pub(super) fn turning(column: Column, x: &[f64]) -> f64 {
    column.map_or(0.0, |c| x[c + 2])
}

/// ḋ, and the part of d̈ that comes from the bodies' ω² alone.
fn speeds(ends: [End; 2], arms: [Vec2; 2], x_dot: &[f64]) -> (Vec2, Vec2) {
    let of = |i: usize| {
        ends[i].column.map_or((Vec2::ZERO, Vec2::ZERO), |c| {
            let omega = x_dot[c + 2];
            (
                vec2(x_dot[c], x_dot[c + 1]) + arms[i].perp() * omega,
                -arms[i] * (omega * omega),
            )
        })
    };
    let (one, two) = (of(0), of(1));
    (two.0 - one.0, two.1 - one.1)
}

impl Measure {
    /// The value.
    pub(super) fn value(&self, at: &Places<'_>) -> f64 {
        match *self {
            Self::Turn([first, second]) => turning(second, at.x) - turning(first, at.x),
            Self::Fixed(ends, u) => u.dot(at.gap(ends).d),
            Self::Along(ends, u) => u.turn(at.direction(ends[0].column)).dot(at.gap(ends).d),
            Self::Length(ends) => at.gap(ends).d.norm(),
            Self::Bearing(ends) => at.gap(ends).d.angle(),
        }
    }

    /// Hands the derivative by [x, y, θ] of each of the two bodies, if it moves, to `add`.
    pub(super) fn gradient(&self, at: &Places<'_>, mut add: impl FnMut(usize, [f64; 3])) {
        let mut give = |column: Column, derivative: [f64; 3]| {
            if let Some(c) = column {
                add(c, derivative);
            }
        };
        // A quantity that changes by w·δP2 − w·δP1, and P moves by perp(arm) per radian.
        let mut pair = |ends: [End; 2], arms: [Vec2; 2], w: Vec2| {
            give(ends[0].column, [-w.x, -w.y, -arms[0].cross(w)]);
            give(ends[1].column, [w.x, w.y, arms[1].cross(w)]);
        };
        match *self {
            Self::Turn([first, second]) => {
                give(first, [0.0, 0.0, -1.0]);
                give(second, [0.0, 0.0, 1.0]);
            }
            Self::Fixed(ends, u) => pair(ends, at.gap(ends).arms, u),
            Self::Along(ends, u) => {
                let Gap { arms, d } = at.gap(ends);
                // The first body's arm reaches to P2, not to P1, because u turns with it.
                let reach = [arms[0] + d, arms[1]];
                pair(ends, reach, u.turn(at.direction(ends[0].column)));
            }
            Self::Length(ends) => {
                let Gap { arms, d } = at.gap(ends);
                pair(ends, arms, d * (1.0 / d.norm()));
            }
            Self::Bearing(ends) => {
                let Gap { arms, d } = at.gap(ends);
                pair(ends, arms, d.perp() * (1.0 / d.dot(d)));
            }
        }
    }

    /// The rate of the value under the speeds `x_dot`.
    pub(super) fn rate(&self, at: &Places<'_>, x_dot: &[f64]) -> f64 {
        let mut rate = 0.0;
        self.gradient(at, |c, [x, y, turn]| {
            rate += x * x_dot[c] + y * x_dot[c + 1] + turn * x_dot[c + 2];
        });
        rate
    }

    /// The second derivative along x + s ẋ at s = 0.
    pub(super) fn curvature(&self, at: &Places<'_>, x_dot: &[f64]) -> f64 {
        let moving = |ends: [End; 2]| {
            let Gap { arms, d } = at.gap(ends);
            let (speed, pull) = speeds(ends, arms, x_dot);
            (d, speed, pull)
        };
        match *self {
            Self::Turn(_) => 0.0,
            Self::Fixed(ends, u) => u.dot(moving(ends).2),
            Self::Along(ends, u) => {
                // d²(u·d) = ü·d + 2 u̇·ḋ + u·d̈, with u̇ = ω1 perp(u) and ü = −ω1² u.
                let (d, speed, pull) = moving(ends);
                let u = u.turn(at.direction(ends[0].column));
                let omega = turning(ends[0].column, x_dot);
                u.dot(pull) + 2.0 * omega * u.perp().dot(speed) - omega * omega * u.dot(d)
            }
            Self::Length(ends) => {
                // l l̇ = d·ḋ, so l l̈ = d·d̈ + ḋ·ḋ − l̇², of which the last two are the square of
                // the speed across d.
                let (d, speed, pull) = moving(ends);
                let l = d.norm();
                let e = d * (1.0 / l);
                let across = e.cross(speed);
                e.dot(pull) + across * across / l
            }
            Self::Bearing(ends) => {
                // l² ψ̇ = d × ḋ, so l² ψ̈ = d × d̈ − 2 (d·ḋ) ψ̇.
                let (d, speed, pull) = moving(ends);
                let square = d.dot(d);
                let turning = d.cross(speed) / square;
                (d.cross(pull) - 2.0 * d.dot(speed) * turning) / square
            }
        }
    }
}
