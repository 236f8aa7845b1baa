//! Predictions between stored poses: polynomials of degree five, which have the values and the first two derivatives of both. What they
//! leave open is closed with the inverses of the Jacobians, interpolated between both.
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

/// The poses stored along the range, as predictions between each and the next.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Predictions {
    /// The coordinates of the stored poses, ascending.
    ends: Vec<f64>,
    /// The predictions between them.
    pieces: Vec<Piece>,
    /// By equal part of the range: the piece in which it begins.
    parts: Vec<usize>,
    parts_per_unit: f64,
    /// The freedoms that are predicted as numbers: all but those of actuators and balls.
    scalars: Vec<usize>,
}

/// The poses between two stored ones.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    from: f64,
    coordinates: Vec<[f64; 6]>,
    balls: Vec<(Rotation, [Vec3; 6])>,
    /// The inverses of the groups' Jacobians at the first pose, and their slopes.
    inverses: Vec<[f64; 2]>,
}

impl Predictions {
    /// Between stored poses, of these freedoms and of all balls.
    pub(super) fn new(nodes: &[Node], scalars: Vec<usize>) -> Self {
        let pairs = nodes.windows(2);
        let pieces: Vec<Piece> = pairs
            .map(|pair| Piece::new(&pair[0], &pair[1], &scalars))
            .collect();
        let ends: Vec<f64> = nodes.iter().map(|n| n.q).collect();
        let (first, last) = (ends[0], ends[ends.len() - 1]);
        let count = pieces.len();
        let part = |k: usize| {
            let begin = first + (last - first) * k as f64 / count as f64;
            ends[1..count].partition_point(|end| *end <= begin)
        };
        Self {
            parts: (0..=count).map(part).collect(),
            parts_per_unit: count as f64 / (last - first),
            ends,
            pieces,
            scalars,
        }
    }

    /// The coordinates of the first and the last stored pose.
    pub(super) fn range(&self) -> Option<[f64; 2]> {
        Some([*self.ends.first()?, *self.ends.last()?])
    }

    /// The prediction at a coordinate; none where there is one stored pose only.
    #[inline(always)]
    pub(super) fn at(&self, q: f64) -> Option<&Piece> {
        let count = self.pieces.len();
        let first = self.ends.first()?;
        let part = ((q - first) * self.parts_per_unit) as usize;
        // Rounding may take a coordinate at the edge of a part for one of the next.
        let low = *self.parts.get(part.min(count).max(1) - 1)?;
        let high = *self.parts.get((part + 2).min(count))?;
        let ends = self.ends.get(low + 1..high + 1)?;
        self.pieces
            .get((low + ends.partition_point(|end| *end < q)).min(count.max(1) - 1))
    }

    /// Sets the coordinates to those of a piece at a coordinate.
    #[inline(always)]
    pub(super) fn predict<T: Scalar>(&self, piece: &Piece, q: f64, pose: &mut Pose<T>) {
        let s = q - piece.from;
        for (freedom, c) in self.scalars.iter().zip(&piece.coordinates) {
            pose.coordinates[*freedom] =
                T::from_f64(c.iter().rev().fold(0.0, |sum, c| sum * s + c));
        }
        for (ball, (start, c)) in pose.balls.iter_mut().zip(&piece.balls) {
            let turn = c.iter().rev().fold(Vec3::ZERO, |sum, c| sum.scaled(s) + *c);
            *ball = start.turned_by(turn).cast();
        }
    }
}

impl Piece {
    /// Between two stored poses.
    fn new(first: &Node, second: &Node, scalars: &[usize]) -> Self {
        let h = second.q - first.q;
        let coordinates = scalars.iter().map(|f| {
            let [a, b] = [first, second].map(|node| node.coordinates[*f]);
            polynomial(a, b, h)
        });
        let balls = first.balls.iter().zip(&second.balls);
        let balls = balls.zip(first.turns.iter().zip(&second.turns));
        let inverses = first.inverses.iter().zip(&second.inverses);
        Self {
            from: first.q,
            coordinates: coordinates.collect(),
            inverses: inverses.map(|(a, b)| [*a, (b - a) / h]).collect(),
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

    /// The predicted inverse of a group's Jacobian, whose entries begin at a number.
    #[inline(always)]
    pub(super) fn inverse(
        &self,
        first: usize,
        count: usize,
        q: f64,
    ) -> impl Iterator<Item = f64> + '_ {
        let s = q - self.from;
        let entries = self.inverses[first..][..count].iter();
        entries.map(move |[value, slope]| value + slope * s)
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
