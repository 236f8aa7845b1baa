//! Predictions between stored poses: polynomials of degree five with the values and the first two derivatives at both. The remaining
//! residual is closed with the inverses of the Jacobians, interpolated between both.
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

/// The poses stored along the range, as predictions between each and the next. The numbers of a piece stand together: an evaluation
/// at a new coordinate waits for them more than it computes with them.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Predictions {
    /// The coordinates of the stored poses, ascending.
    ends: Vec<f64>,
    /// By equal part of the range: the piece in which it begins.
    parts: Vec<u32>,
    parts_per_unit: f64,
    /// By piece: six coefficients of each scalar; of each ball its first rotation and six coefficients of its turn.
    numbers: Vec<f64>,
    /// Number of coefficients of a piece.
    stride: usize,
    /// By stored pose: the inverses of the groups' Jacobians.
    inverses: Vec<f64>,
    inverse_stride: usize,
    /// The freedoms that are predicted as numbers: all but those of actuators and balls.
    scalars: Vec<usize>,
}

/// Numbers of a ball in a piece.
const BALL: usize = 9 + 18;

/// A coordinate in a piece.
#[derive(Debug, Clone, Copy)]
pub(super) struct PiecePoint {
    index: usize,
    /// Distance from the first pose, rad or m.
    ahead: f64,
}

impl Predictions {
    /// Between stored poses, of these freedoms and of all balls.
    pub(super) fn new(nodes: &[Node], scalars: Vec<usize>) -> Self {
        let balls = nodes.first().map_or(0, |n| n.balls.len());
        let count = nodes.len().saturating_sub(1);
        let ends: Vec<f64> = nodes.iter().map(|n| n.q).collect();
        let span = ends.last().copied().unwrap_or(0.0) - ends.first().copied().unwrap_or(0.0);
        let part = |k: usize| {
            let begin = ends[0] + span * k as f64 / count as f64;
            ends[1..count].partition_point(|end| *end <= begin) as u32
        };
        let mut numbers = Vec::new();
        for pair in nodes.windows(2) {
            add_piece(&pair[0], &pair[1], &scalars, &mut numbers);
        }
        Self {
            parts: (0..count).map(part).collect(),
            parts_per_unit: count as f64 / span,
            ends,
            numbers,
            stride: 6 * scalars.len() + BALL * balls,
            inverses: nodes.iter().flat_map(|n| n.inverses.clone()).collect(),
            inverse_stride: nodes.first().map_or(0, |n| n.inverses.len()),
            scalars,
        }
    }

    /// The coordinates of the first and the last stored pose.
    #[inline(always)]
    pub(super) fn range(&self) -> Option<[f64; 2]> {
        Some([*self.ends.first()?, *self.ends.last()?])
    }

    /// By stored pose: its coordinate, and the inverses of the groups' Jacobians.
    pub(super) fn stored_inverses(&self) -> impl Iterator<Item = (f64, &[f64])> {
        let inverses = self.inverses.chunks_exact(self.inverse_stride.max(1));
        self.ends.iter().copied().zip(inverses)
    }

    /// The piece that contains a coordinate of the range; `None` if there is only one stored pose.
    #[inline(always)]
    pub(super) fn at(&self, q: f64) -> Option<PiecePoint> {
        let last = self.parts.len().checked_sub(1)?;
        let part = ((q - self.ends[0]) * self.parts_per_unit) as usize;
        let mut index = self.parts[part.min(last)] as usize;
        while index < last && self.ends[index + 1] < q {
            index += 1;
        }
        let ahead = q - self.ends[index];
        Some(PiecePoint { index, ahead })
    }

    /// Sets the coordinates to the predicted ones.
    #[inline(always)]
    pub(super) fn predict<T: Scalar>(&self, at: PiecePoint, pose: &mut Pose<T>) {
        let s = at.ahead;
        let (scalars, balls) =
            self.numbers[at.index * self.stride..][..self.stride].split_at(6 * self.scalars.len());
        for (freedom, c) in self.scalars.iter().zip(scalars.as_chunks::<6>().0) {
            pose.coordinates[*freedom] = T::from_f64(sum(s, |k| c[k]));
        }
        for (ball, c) in pose.balls.iter_mut().zip(balls.as_chunks::<BALL>().0) {
            let start = Rotation {
                columns: [
                    vec3(c[0], c[1], c[2]),
                    vec3(c[3], c[4], c[5]),
                    vec3(c[6], c[7], c[8]),
                ],
            };
            let component = |i: usize| sum(s, |k| c[9 + 3 * k + i]);
            let turn = vec3(component(0), component(1), component(2));
            *ball = start.turned_by(turn).cast();
        }
    }

    /// The predicted inverses of the groups' Jacobians, from an entry on.
    #[inline(always)]
    pub(super) fn inverse(&self, at: PiecePoint, first: usize) -> impl Iterator<Item = f64> + '_ {
        let part = at.ahead / (self.ends[at.index + 1] - self.ends[at.index]);
        let here = at.index * self.inverse_stride + first;
        let next = here + self.inverse_stride;
        let pairs = self.inverses[here..].iter().zip(&self.inverses[next..]);
        pairs.map(move |(a, b)| a + part * (b - a))
    }
}

/// The polynomial with these coefficients, by Horner's rule.
#[inline(always)]
fn sum(s: f64, c: impl Fn(usize) -> f64) -> f64 {
    (0..5).rev().fold(c(5), |sum, k| sum * s + c(k))
}

/// Adds the numbers of the piece between two stored poses.
fn add_piece(first: &Node, second: &Node, scalars: &[usize], numbers: &mut Vec<f64>) {
    let h = second.q - first.q;
    for f in scalars {
        numbers.extend(polynomial(first.coordinates[*f], second.coordinates[*f], h));
    }
    for (k, (start, end)) in first.balls.iter().zip(&second.balls).enumerate() {
        let turned = end.after(&start.inverse()).tangent();
        let [rate, change] = derivatives(turned, second.turns[k]);
        let [before, before_change] = first.turns[k];
        let coefficients = turns(
            [Vec3::ZERO, before, before_change],
            [turned, rate, change],
            h,
        );
        for v in start.columns.iter().chain(&coefficients) {
            numbers.extend([v.x, v.y, v.z]);
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

/// The polynomials of each component.
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
