//! Predictions between stored poses: polynomials of degree five, which have the values and the first two derivatives of both.
//!
//! ```text
//! f(s) = Σ cₖ sᵏ,     f, f′, f″ given at s = 0 and s = h                                              (1)
//! g′ = ω − ½ g×ω + ¼ (g·ω) g                                                                          (2)
//! ```
//!
//! A ball is turned from its first pose by a vector g along the axis, twice the tangent of half the angle; (2) gives its derivatives
//! at the second pose (Bauchau, Flexible Multibody Dynamics, 2011, on Rodrigues parameters).

use super::follow::Node;
use super::plan::Pose;
use super::vector::{Rotation, Vec3, vec3};
use dwell_numerics::Scalar;

/// The poses between two stored ones.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    from: f64,
    coordinates: Vec<[f64; 6]>,
    balls: Vec<(Rotation, [Vec3; 6])>,
}

impl Piece {
    /// Between two stored poses.
    pub(super) fn new(first: &Node, second: &Node) -> Self {
        let h = second.q - first.q;
        let coordinates = first.coordinates.iter().zip(&second.coordinates);
        let balls = first.balls.iter().zip(&second.balls);
        let balls = balls.zip(first.turns.iter().zip(&second.turns));
        Self {
            from: first.q,
            coordinates: coordinates.map(|(a, b)| polynomial(*a, *b, h)).collect(),
            balls: balls
                .map(|((start, end), (turn, later))| {
                    let turned = end.after(&start.inverse()).tangent();
                    let [rate, second] = derivatives(turned, *later);
                    (
                        *start,
                        turns([Vec3::ZERO, turn[0], turn[1]], [turned, rate, second], h),
                    )
                })
                .collect(),
        }
    }

    /// Sets the coordinates to those of the polynomials at a coordinate.
    pub(super) fn predict<T: Scalar>(&self, q: f64, pose: &mut Pose<T>) {
        let s = q - self.from;
        for (coordinate, c) in pose.coordinates.iter_mut().zip(&self.coordinates) {
            *coordinate = T::from_f64(c.iter().rev().fold(0.0, |sum, c| sum * s + c));
        }
        for (ball, (start, c)) in pose.balls.iter_mut().zip(&self.balls) {
            let turn = c.iter().rev().fold(Vec3::ZERO, |sum, c| sum.scaled(s) + *c);
            *ball = start.turned_by(turn).cast();
        }
    }
}

/// The coefficients of (1).
fn polynomial([f, d, dd]: [f64; 3], [g, e, ee]: [f64; 3], h: f64) -> [f64; 6] {
    // What the parabola of the first pose misses at the second.
    let value = g - (f + h * (d + 0.5 * h * dd));
    let slope = (e - (d + h * dd)) * h;
    let bend = (ee - dd) * h * h;
    let cube = h * h * h;
    [
        f,
        d,
        0.5 * dd,
        (10.0 * value - 4.0 * slope + 0.5 * bend) / cube,
        (-15.0 * value + 7.0 * slope - bend) / (cube * h),
        (6.0 * value - 3.0 * slope + 0.5 * bend) / (cube * h * h),
    ]
}

/// The same of each component.
fn turns(first: [Vec3; 3], second: [Vec3; 3], h: f64) -> [Vec3; 6] {
    let of = |component: fn(&Vec3) -> f64| {
        polynomial(
            first.each_ref().map(component),
            second.each_ref().map(component),
            h,
        )
    };
    let [x, y, z] = [of(|v| v.x), of(|v| v.y), of(|v| v.z)];
    [0, 1, 2, 3, 4, 5].map(|k| vec3(x[k], y[k], z[k]))
}

/// g′ and g″ from ω and ω′, by (2).
fn derivatives(g: Vec3, [rate, second]: [Vec3; 2]) -> [Vec3; 2] {
    let by = |v: Vec3| v - g.cross(v).scaled(0.5) + g.scaled(0.25 * g.dot(v));
    let first = by(rate);
    let change = first.cross(rate).scaled(-0.5)
        + g.scaled(0.25 * first.dot(rate))
        + first.scaled(0.25 * g.dot(rate));
    [first, by(second) + change]
}
