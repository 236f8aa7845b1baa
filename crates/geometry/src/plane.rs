//! Vectors of the plane. A rotation (cos θ, sin θ) is a `Vec2` of unit length, and rotates
//! another vector by complex multiplication.
//!
//! Operators report their caller's source line (`#[track_caller]`): a number type that records its operations (the
//! mutation tests) then sees the term that uses them.

use dwell_numerics::{Constant, Lift, Scalar};
use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// A vector of the plane, or a rotation as (cos θ, sin θ).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Vec2<T = f64> {
    /// Component along the x axis.
    pub x: T,
    /// Component along the y axis.
    pub y: T,
}

/// Shorthand for [`Vec2`].
#[inline]
pub const fn vec2<T>(x: T, y: T) -> Vec2<T> {
    Vec2 { x, y }
}

impl Vec2<f64> {
    /// The zero vector.
    pub const ZERO: Self = vec2(0.0, 0.0);
    /// The rotation by zero.
    pub const IDENTITY: Self = vec2(1.0, 0.0);

    /// The unit vector at `angle` (rad) from the x axis.
    pub fn from_angle(angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        vec2(cos, sin)
    }

    /// Angle from the x axis, in (−π, π] rad.
    pub fn angle(self) -> f64 {
        self.y.atan2(self.x)
    }

    /// Length, without overflow at the extremes.
    pub fn norm(self) -> f64 {
        self.x.hypot(self.y)
    }

    /// Both components are finite.
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }
}

impl<C: Constant> Vec2<C> {
    /// The vector in another number type, as constants.
    #[inline(always)]
    #[track_caller]
    pub fn cast<T: Lift<C>>(self) -> Vec2<T> {
        vec2(T::lift(self.x), T::lift(self.y))
    }
}

impl<T: Scalar> Vec2<T> {
    /// The values of its components, without derivatives.
    pub fn values(self) -> Vec2 {
        vec2(self.x.value(), self.y.value())
    }

    /// Zero, as any number type.
    #[inline(always)]
    #[track_caller]
    pub fn zero() -> Self {
        vec2(T::from_f64(0.0), T::from_f64(0.0))
    }

    /// Scalar product.
    #[inline(always)]
    #[track_caller]
    pub fn dot(self, other: Self) -> T {
        self.x * other.x + self.y * other.y
    }

    /// The out-of-plane component of the vector product, positive from `self` counter-clockwise to `other`.
    #[inline(always)]
    #[track_caller]
    pub fn cross(self, other: Self) -> T {
        self.x * other.y - self.y * other.x
    }

    /// The vector rotated by +90°.
    #[inline(always)]
    #[track_caller]
    pub fn perp(self) -> Self {
        vec2(-self.y, self.x)
    }

    /// The vector rotated by `by` = (cos, sin).
    #[inline(always)]
    #[track_caller]
    pub fn rotate(self, by: Self) -> Self {
        vec2(self.x * by.x - self.y * by.y, self.x * by.y + self.y * by.x)
    }

    /// The vector rotated by the inverse of `by` = (cos, sin).
    #[inline(always)]
    #[track_caller]
    pub fn rotate_inverse(self, by: Self) -> Self {
        vec2(self.x * by.x + self.y * by.y, self.y * by.x - self.x * by.y)
    }
}

impl<T: Scalar> Add for Vec2<T> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn add(self, o: Self) -> Self {
        vec2(self.x + o.x, self.y + o.y)
    }
}

impl<T: Scalar> Sub for Vec2<T> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn sub(self, o: Self) -> Self {
        vec2(self.x - o.x, self.y - o.y)
    }
}

impl<T: Scalar> Neg for Vec2<T> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn neg(self) -> Self {
        vec2(-self.x, -self.y)
    }
}

impl<T: Scalar> Mul<T> for Vec2<T> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn mul(self, k: T) -> Self {
        vec2(self.x * k, self.y * k)
    }
}

impl<T: Scalar> AddAssign for Vec2<T> {
    #[inline(always)]
    #[track_caller]
    fn add_assign(&mut self, o: Self) {
        self.x += o.x;
        self.y += o.y;
    }
}

impl<T: Scalar> SubAssign for Vec2<T> {
    #[inline(always)]
    #[track_caller]
    fn sub_assign(&mut self, o: Self) {
        self.x -= o.x;
        self.y -= o.y;
    }
}
