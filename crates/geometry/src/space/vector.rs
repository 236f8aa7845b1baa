//! Vectors and rotations of space.
//!
//! Operators report their caller's source line (`#[track_caller]`): a number type that records its operations (the
//! mutation tests) then sees the term that uses them.

use dwell_numerics::{Constant, Lift, Scalar, map_array};
use std::ops::{Add, AddAssign, Neg, Sub, SubAssign};

/// A vector of space.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Vec3<T = f64> {
    /// Component along the x axis.
    pub x: T,
    /// Component along the y axis.
    pub y: T,
    /// Component along the z axis.
    pub z: T,
}

/// Shorthand for [`Vec3`].
#[inline]
pub const fn vec3<T>(x: T, y: T, z: T) -> Vec3<T> {
    Vec3 { x, y, z }
}

impl Vec3<f64> {
    /// The zero vector.
    pub const ZERO: Self = vec3(0.0, 0.0, 0.0);
    /// The axes of a frame.
    pub const AXES: [Self; 3] = [
        vec3(1.0, 0.0, 0.0),
        vec3(0.0, 1.0, 0.0),
        vec3(0.0, 0.0, 1.0),
    ];

    /// Length, without overflow at the extremes.
    pub fn norm(self) -> f64 {
        self.x.hypot(self.y).hypot(self.z)
    }

    /// All components are finite.
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }

    /// The unit vector of this direction; none of zero, nor of a length whose inverse is infinite.
    pub fn unit(self) -> Option<Self> {
        let norm = self.norm();
        (norm >= f64::MIN_POSITIVE && norm.is_finite()).then(|| self.scaled(1.0 / norm))
    }
}

impl<C: Constant> Vec3<C> {
    /// This value in another number type, as constants.
    #[inline(always)]
    #[track_caller]
    pub fn cast<T: Lift<C>>(self) -> Vec3<T> {
        vec3(T::lift(self.x), T::lift(self.y), T::lift(self.z))
    }
}

impl<C: Constant> Vec3<C> {
    /// The vector of length 1 of this direction, which is not zero.
    pub(super) fn normalised(self) -> Self {
        self.scaled(C::from_f64(1.0) / C::length([self.x, self.y, self.z]))
    }

    /// A unit vector at right angles to this unit vector.
    pub fn any_normal(self) -> Self {
        let size = |v: &Vec3| self.dot(v.cast()).value().abs();
        let mut axes = Vec3::AXES;
        axes.sort_by(|a, b| size(a).total_cmp(&size(b)));
        self.cross(axes[0].cast()).normalised()
    }
}

impl<T: Scalar> Vec3<T> {
    /// Zero, as any number type.
    #[inline(always)]
    #[track_caller]
    pub fn zero() -> Self {
        Vec3::ZERO.cast()
    }

    /// The values of its components, without derivatives.
    pub fn values(self) -> Vec3 {
        vec3(self.x.value(), self.y.value(), self.z.value())
    }

    /// Scalar product.
    #[inline(always)]
    #[track_caller]
    pub fn dot(self, o: Self) -> T {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Vector product.
    #[inline(always)]
    #[must_use]
    #[track_caller]
    pub fn cross(self, o: Self) -> Self {
        vec3(
            self.y * o.z - self.z * o.y,
            self.z * o.x - self.x * o.z,
            self.x * o.y - self.y * o.x,
        )
    }

    /// The component along the axis of this number.
    #[inline(always)]
    pub(super) fn component(self, axis: usize) -> T {
        [self.x, self.y, self.z][axis]
    }

    /// The vector times a number.
    #[inline(always)]
    #[must_use]
    #[track_caller]
    pub fn scaled(self, by: T) -> Self {
        vec3(self.x * by, self.y * by, self.z * by)
    }
}

impl<T: Scalar> Add for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn add(self, o: Self) -> Self {
        vec3(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl<T: Scalar> Sub for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn sub(self, o: Self) -> Self {
        vec3(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl<T: Scalar> Neg for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn neg(self) -> Self {
        vec3(-self.x, -self.y, -self.z)
    }
}

impl<T: Scalar> AddAssign for Vec3<T> {
    #[inline(always)]
    #[track_caller]
    fn add_assign(&mut self, o: Self) {
        self.x += o.x;
        self.y += o.y;
        self.z += o.z;
    }
}

impl<T: Scalar> SubAssign for Vec3<T> {
    #[inline(always)]
    #[track_caller]
    fn sub_assign(&mut self, o: Self) {
        self.x -= o.x;
        self.y -= o.y;
        self.z -= o.z;
    }
}

/// A rotation, by the images of the three axes: the columns of its matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation<T = f64> {
    /// Images of the axes x, y, z.
    pub columns: [Vec3<T>; 3],
}

impl Rotation<f64> {
    /// The identity.
    pub const IDENTITY: Self = Self {
        columns: Vec3::AXES,
    };

    /// A rotation from the rows of its matrix, which are made orthonormal; `None` if they are far from orthonormal.
    pub fn of_rows(rows: [[f64; 3]; 3]) -> Option<Self> {
        let column = |k: usize| vec3(rows[0][k], rows[1][k], rows[2][k]);
        let z = column(2).unit()?;
        let x = column(0) - z.scaled(z.dot(column(0)));
        let found = Self::of_axes(z, x.unit()?);
        let off = |k: usize| (found.columns[k] - column(k)).norm();
        (0..3).all(|k| off(k) < 0.1).then_some(found)
    }

    /// The rotation about a vector by its length, rad.
    pub fn of_vector(turn: Vec3) -> Self {
        let Some(axis) = turn.unit() else {
            return Self::IDENTITY;
        };
        let (sin, cos) = turn.norm().sin_cos();
        let turned = |v: Vec3| {
            let across = axis.cross(v);
            v + across.scaled(sin) + axis.cross(across).scaled(1.0 - cos)
        };
        Self {
            columns: Vec3::AXES.map(turned),
        }
    }

    /// The vector by which [`Rotation::turned_by`] makes this rotation: along its axis, twice the tangent of half its angle.
    pub(super) fn tangent(&self) -> Vec3 {
        let turn = self.vector();
        match turn.unit() {
            Some(axis) => axis.scaled(2.0 * (0.5 * turn.norm()).tan()),
            None => turn,
        }
    }

    /// The angle of this rotation as a vector along its axis, rad.
    pub fn vector(&self) -> Vec3 {
        let [x, y, z] = self.columns;
        let axial = vec3(y.z - z.y, z.x - x.z, x.y - y.x).scaled(0.5);
        let (sin, cos) = (axial.norm(), 0.5 * (x.x + y.y + z.z - 1.0));
        if sin > 1e-6 {
            return axial.scaled(sin.atan2(cos) / sin);
        }
        if cos > 0.0 {
            return axial;
        }
        // Near a half turn: R + 1 is twice the projection onto the axis.
        let projected = (0..3).map(|k| self.columns[k] + Vec3::AXES[k]);
        let largest = projected.max_by(|a, b| a.norm().total_cmp(&b.norm()));
        let axis = largest.and_then(Vec3::unit).unwrap_or(Vec3::ZERO);
        axis.scaled(std::f64::consts::PI)
    }
}

impl<C: Constant> Rotation<C> {
    /// This value in another number type, as constants.
    #[inline(always)]
    pub fn cast<T: Lift<C>>(&self) -> Rotation<T> {
        Rotation {
            columns: map_array(self.columns, Vec3::cast),
        }
    }
}

impl<T: Scalar> Default for Rotation<T> {
    fn default() -> Self {
        Rotation::IDENTITY.cast()
    }
}

impl<T: Scalar> Rotation<T> {
    /// The frame with this unit vector as its z axis and another at right angles to it as its x axis.
    pub fn of_axes(z: Vec3<T>, x: Vec3<T>) -> Self {
        Self {
            columns: [x, z.cross(x), z],
        }
    }

    /// A vector of the rotated frame in the axes of the other.
    #[inline(always)]
    #[track_caller]
    pub fn apply(&self, v: Vec3<T>) -> Vec3<T> {
        let [x, y, z] = self.columns;
        x.scaled(v.x) + y.scaled(v.y) + z.scaled(v.z)
    }

    /// A vector in the axes of the rotated frame.
    #[inline(always)]
    #[track_caller]
    pub fn apply_inverse(&self, v: Vec3<T>) -> Vec3<T> {
        vec3(
            self.columns[0].dot(v),
            self.columns[1].dot(v),
            self.columns[2].dot(v),
        )
    }

    /// This rotation after another.
    #[inline(always)]
    #[must_use]
    #[track_caller]
    pub fn after(&self, other: &Self) -> Self {
        let [x, y, z] = other.columns;
        Self {
            columns: [self.apply(x), self.apply(y), self.apply(z)],
        }
    }

    /// The inverse.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let [x, y, z] = self.columns;
        Self {
            columns: [
                vec3(x.x, y.x, z.x),
                vec3(x.y, y.y, z.y),
                vec3(x.z, y.z, z.z),
            ],
        }
    }

    /// The frame turned about its own z axis by the angle of this sine and cosine.
    #[inline(always)]
    #[must_use]
    #[track_caller]
    pub fn turned_about_z(&self, (sin, cos): (T, T)) -> Self {
        let [x, y, z] = self.columns;
        Self {
            columns: [
                x.scaled(cos) + y.scaled(sin),
                y.scaled(cos) - x.scaled(sin),
                z,
            ],
        }
    }

    /// Turned by a rotation about `turn` whose angle is its length to third order: the rotation of the quaternion
    /// (1, turn/2), which stays orthogonal to rounding.
    #[inline]
    #[must_use]
    pub fn turned_by(&self, turn: Vec3<T>) -> Self {
        let one = T::from_f64(1.0);
        let h = turn.scaled(T::from_f64(0.5));
        let factor = T::from_f64(2.0) / (one + h.dot(h));
        let turned = |v: Vec3<T>| {
            let first = h.cross(v);
            v + (first + h.cross(first)).scaled(factor)
        };
        Self {
            columns: [
                turned(self.columns[0]),
                turned(self.columns[1]),
                turned(self.columns[2]),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The last step of Newton's method may be a turn of the smallest numbers there are: it must not make a pose that is no number.
    #[test]
    fn a_turn_too_small_for_an_axis_is_none() {
        let tiny = vec3(f64::from_bits(1), 0.0, 0.0);
        assert_eq!(tiny.unit(), None);
        assert_eq!(Rotation::of_vector(tiny), Rotation::IDENTITY);
    }
}
