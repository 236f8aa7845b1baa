//! The two groups whose positions are closed forms throughout: two bodies pinned to each other (a triangle), and a body
//! guided along a line.

use crate::error::PositionError;
use crate::plan::{GuidedPoint, LoopClosure, Pose, RrrDyad};
use crate::plane::Vec2;
use crate::structure::tree::FrameVector;
use dwell_numerics::{Constant, Lift, Scalar, map_array};

/// Below this determinant, relative to the lengths that make it, no digit of the result is significant.
const SINGULAR: f64 = 1e-14;

/// The tolerance for a number type. More precise types reject the same positions as `f64`, because they measure its
/// rounding.
pub(crate) const fn singular_tolerance<T: Scalar>() -> f64 {
    SINGULAR.max(32.0 * T::EPSILON)
}

/// Whether a number type resolves the rounding of constants derived from lengths: these are then derived again in it.
pub(crate) const fn is_finer_than_f64<T: Scalar>() -> bool {
    T::EPSILON < f64::EPSILON
}

/// Whether what follows from constants alone is computed in each evaluation: in finer numbers, and from constants that an
/// evaluation is to depend on.
const fn derives_constants<C: Constant, T: Scalar>() -> bool {
    !C::IS_PREPARED || is_finer_than_f64::<T>()
}

/// Whether numbers have neither derivatives nor more digits than `f64`.
pub(crate) const fn is_plain<T: Scalar>() -> bool {
    !T::HAS_DERIVATIVES && !is_finer_than_f64::<T>()
}

/// A constant vector and some rotated vectors, summed.
#[inline(always)]
fn vector_sum<C: Constant, T: Lift<C>>(
    fixed: Vec2<C>,
    vectors: &[(usize, usize)],
    vector: &[Vec2<T>],
) -> Vec2<T> {
    let mut sum = fixed.cast();
    for &(a, _) in vectors {
        sum += vector[a];
    }
    sum
}

/// L = P₂ − P₁, the sum of the vectors and slides of a loop, m.
#[inline]
pub(crate) fn gap<C: Constant, T: Lift<C>>(
    closure: &LoopClosure<C>,
    vector: &[Vec2<T>],
    slide: &[T],
) -> Vec2<T> {
    let mut sum = vector_sum(closure.fixed, &closure.vectors, vector);
    for &(s, a, _) in &closure.slides {
        sum += vector[a] * slide[s];
    }
    sum
}

/// Two vectors of known length that close a triangle with the known part D of the loop.
#[inline(always)]
pub(super) fn rrr_dyad_positions<C: Constant, T: Lift<C>>(
    dyad: &RrrDyad<C>,
    vectors: &[FrameVector<C>],
    group: usize,
    pose: &mut Pose<T>,
) -> Result<(), PositionError> {
    let (per_square, [sum_squared, difference_squared, square_difference]) =
        triangle_constants(dyad, vectors);
    let known = vector_sum(dyad.fixed, &dyad.known, &pose.vector);
    let square = known.dot(known);
    // (2 × area)² by factors that keep their digits near a stretched or folded triangle.
    let rest = (sum_squared - square) * (square - difference_squared);
    let size = |lane| square.lane(lane) * square.lane(lane);
    let q = pose.first_coordinate();
    let missing = || {
        let distance = square.value().sqrt();
        (distance - dyad.sum_squared.sqrt()).max(dyad.difference_squared.sqrt() - distance)
    };
    let double_area = checked_sqrt(rest, size, || square * square, group, q, missing)?
        * T::from_f64(0.5 * dyad.branch);
    let half = T::from_f64(0.5);
    let inverse = T::from_f64(1.0) / square;
    let across = known.perp() * double_area;
    let first = (known * (half * (square_difference - square)) + across) * inverse;
    let second = (known * (half * (-square_difference - square)) - across) * inverse;
    pose.vector[dyad.vectors[0]] = first;
    pose.vector[dyad.vectors[1]] = second;
    pose.rotation[dyad.frames[0]] = first.rotate_inverse(per_square[0]);
    pose.rotation[dyad.frames[1]] = second.rotate_inverse(per_square[1]);
    // vector₁ × vector₂ = the signed double area.
    pose.inverse_determinant[group] = T::from_f64(1.0) / double_area;
    Ok(())
}

/// The vectors over their squares, and (l₁ + l₂)², (l₁ − l₂)², l₂² − l₁² of their lengths.
#[inline(always)]
fn triangle_constants<C: Constant, T: Lift<C>>(
    dyad: &RrrDyad<C>,
    vectors: &[FrameVector<C>],
) -> ([Vec2<T>; 2], [T; 3]) {
    if !derives_constants::<C, T>() {
        let lengths = [
            dyad.sum_squared,
            dyad.difference_squared,
            dyad.square_difference,
        ];
        return (
            map_array(dyad.per_square, Vec2::cast),
            map_array(lengths, T::from_f64),
        );
    }
    let local = dyad.vectors.map(|a| vectors[a].local.cast::<T>());
    let squares = local.map(|vector| vector.dot(vector));
    let [one, two] = squares.map(T::sqrt);
    let (sum, gap) = (one + two, one - two);
    let per_square = [0, 1].map(|k| local[k] * (T::from_f64(1.0) / squares[k]));
    (per_square, [sum * sum, gap * gap, squares[1] - squares[0]])
}

/// A vector of length one, to the last digit of finer numbers too.
#[inline(always)]
pub(crate) fn unit<T: Scalar>(vector: Vec2<T>) -> Vec2<T> {
    if is_finer_than_f64::<T>() {
        normalised(vector)
    } else {
        vector
    }
}

/// The unit vector of a direction.
#[inline(always)]
fn normalised<T: Scalar>(vector: Vec2<T>) -> Vec2<T> {
    vector * (T::from_f64(1.0) / vector.dot(vector).sqrt())
}

/// A unit vector e that turns — the line's normal, or the vector's direction — so that n·L = 0.
#[inline(always)]
pub(super) fn guided_point_positions<C: Constant, T: Lift<C>>(
    guided: &GuidedPoint<C>,
    vectors: &[FrameVector<C>],
    group: usize,
    pose: &mut Pose<T>,
) -> Result<(), PositionError> {
    let known = vector_sum(guided.fixed, &guided.known, &pose.vector);
    let branch = T::from_f64(guided.branch);
    let q = pose.first_coordinate();
    let local = guided.local.cast::<T>();
    let constant_direction = match (C::IS_PREPARED, guided.line_rotates) {
        (true, _) => unit(guided.unit.cast::<T>()),
        (false, true) => normalised(vectors[guided.axis.0].local.cast::<T>().perp()),
        (false, false) => normalised(local),
    };
    let (direction, slope) = if guided.line_rotates {
        // n·D = −n₀·w with n₀, w constant in the turning frame.
        let kappa = -constant_direction.dot(local);
        let square = known.dot(known);
        let size = |l| square.lane(l);
        let missing = || kappa.value().abs() - square.value().sqrt();
        let half_chord =
            branch * checked_sqrt(square - kappa * kappa, size, || square, group, q, missing)?;
        let direction = (known * kappa + known.perp() * half_chord) * (T::from_f64(1.0) / square);
        // axis·D = reach.
        pose.closure_travel[guided.closure] = half_chord + local.cross(constant_direction);
        pose.vector[guided.found_vector] = -direction.perp();
        (direction, half_chord)
    } else {
        // n·(e |w|) = −n·D with n known.
        let along = pose.vector[guided.axis.0];
        let normal = along.perp();
        let length = if derives_constants::<C, T>() {
            local.dot(local).sqrt()
        } else {
            T::from_f64(guided.length)
        };
        let kappa = -normal.dot(known);
        let square = length * length;
        let size = |l| square.lane(l);
        let missing = || kappa.value().abs() - length.value();
        let half_chord =
            branch * checked_sqrt(square - kappa * kappa, size, || square, group, q, missing)?;
        let vector = normal * kappa - along * half_chord;
        pose.closure_travel[guided.closure] = along.dot(known) - half_chord;
        pose.vector[guided.found_vector] = vector;
        (vector * (T::from_f64(1.0) / length), half_chord)
    };
    pose.rotation[guided.frame] = direction.rotate_inverse(constant_direction);
    pose.inverse_determinant[group] = -T::from_f64(1.0) / slope;
    Ok(())
}

/// Square root of the rest of a squared length, or an error with the missing length, m. The rest is compared
/// with `size` of one lane, or with `sizes` of all at once.
#[inline(always)]
pub(crate) fn checked_sqrt<T: Scalar>(
    rest: T,
    size: impl Fn(usize) -> f64,
    sizes: impl Fn() -> T,
    group: usize,
    q: f64,
    missing: impl Fn() -> f64,
) -> Result<T, PositionError> {
    let tolerance = singular_tolerance::<T>() * singular_tolerance::<T>();
    // A number alone is compared by its value: its derivatives decide nothing.
    let is_clear = match T::LANES {
        1 => rest.value() > tolerance * size(0),
        _ => rest.exceeds(sizes() * T::from_f64(tolerance)),
    };
    if is_clear {
        return Ok(rest.sqrt());
    }
    sqrt_error(rest.value(), size(0), group, q, missing)
}

#[cold]
fn sqrt_error<T>(
    value: f64,
    size: f64,
    group: usize,
    q: f64,
    missing: impl Fn() -> f64,
) -> Result<T, PositionError> {
    if value.is_nan() {
        return Err(PositionError::NotFinite);
    }
    if value < 0.0 {
        return Err(PositionError::NoAssembly {
            group,
            q,
            gap: missing(),
        });
    }
    Err(PositionError::Singular {
        group,
        q,
        relative_determinant: (value / size).sqrt(),
    })
}
