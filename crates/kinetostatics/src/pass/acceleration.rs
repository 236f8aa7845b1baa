//! The accelerations that a pass starts from.

use dwell_geometry::{Motion, Vec2};
use dwell_numerics::Scalar;

/// The accelerations of `N` passes: of the frames, of their constant vectors and along the slides.
pub(crate) trait AccelerationInput<T, const N: usize>: Copy {
    /// Angular acceleration of a frame, rad/s².
    fn angular_acceleration(self, frame: usize) -> [T; N];
    /// Angular velocity of a frame, squared, (rad/s)².
    fn squared_angular_velocity(self, frame: usize) -> [T; N];
    /// The share of a vector that turns with a frame in a point's acceleration: α ẑ×r − ω² r, m/s².
    fn vector_acceleration(self, frame: usize, vector: Vec2<T>) -> [Vec2<T>; N];
    /// The acceleration along a slide and, across it, the Coriolis acceleration, m/s².
    fn slide_acceleration(self, slide: usize, frame: usize, along: Vec2<T>) -> [Vec2<T>; N];
}

/// One pass with the velocities and accelerations of a motion.
#[derive(Clone, Copy)]
pub(crate) struct GivenMotion<'a, T>(pub(crate) &'a Motion<T>);

/// The two unit passes of a mechanism with one actuator, from its motion at q̇ = 1, q̈ = 0: that
/// motion itself, and the one with q̇ = 0, q̈ = 1, whose accelerations are the first one's velocities.
#[derive(Clone, Copy)]
pub(crate) struct UnitMotions<'a, T>(pub(crate) &'a Motion<T>);

/// One pass at rest whose accelerations are the velocities of a motion.
#[derive(Clone, Copy)]
pub(crate) struct UnitAcceleration<'a, T>(pub(crate) &'a Motion<T>);

/// A pass at rest.
#[derive(Clone, Copy)]
pub(crate) struct AtRest;

impl<T: Scalar> AccelerationInput<T, 1> for UnitAcceleration<'_, T> {
    #[inline(always)]
    fn angular_acceleration(self, frame: usize) -> [T; 1] {
        [self.0.velocity.angular[frame]]
    }

    #[inline(always)]
    fn squared_angular_velocity(self, _: usize) -> [T; 1] {
        [T::from_f64(0.0)]
    }

    #[inline(always)]
    fn vector_acceleration(self, frame: usize, vector: Vec2<T>) -> [Vec2<T>; 1] {
        [vector.perp() * self.0.velocity.angular[frame]]
    }

    #[inline(always)]
    fn slide_acceleration(self, slide: usize, _: usize, along: Vec2<T>) -> [Vec2<T>; 1] {
        [along * self.0.velocity.slide[slide]]
    }
}

impl<T: Scalar> AccelerationInput<T, 1> for AtRest {
    #[inline(always)]
    fn angular_acceleration(self, _: usize) -> [T; 1] {
        [T::from_f64(0.0)]
    }

    #[inline(always)]
    fn squared_angular_velocity(self, _: usize) -> [T; 1] {
        [T::from_f64(0.0)]
    }

    #[inline(always)]
    fn vector_acceleration(self, _: usize, _: Vec2<T>) -> [Vec2<T>; 1] {
        [Vec2::zero()]
    }

    #[inline(always)]
    fn slide_acceleration(self, _: usize, _: usize, _: Vec2<T>) -> [Vec2<T>; 1] {
        [Vec2::zero()]
    }
}

impl<T: Scalar> AccelerationInput<T, 1> for GivenMotion<'_, T> {
    #[inline(always)]
    fn angular_acceleration(self, frame: usize) -> [T; 1] {
        [self.0.acceleration.angular[frame]]
    }

    #[inline(always)]
    fn squared_angular_velocity(self, frame: usize) -> [T; 1] {
        let angular_velocity = self.0.velocity.angular[frame];
        [angular_velocity * angular_velocity]
    }

    #[inline(always)]
    fn vector_acceleration(self, frame: usize, vector: Vec2<T>) -> [Vec2<T>; 1] {
        let angular_velocity = self.0.velocity.angular[frame];
        [vector.perp() * self.0.acceleration.angular[frame]
            - vector * (angular_velocity * angular_velocity)]
    }

    #[inline(always)]
    fn slide_acceleration(self, slide: usize, frame: usize, along: Vec2<T>) -> [Vec2<T>; 1] {
        let across =
            T::from_f64(2.0) * self.0.velocity.angular[frame] * self.0.velocity.slide[slide];
        [along * self.0.acceleration.slide[slide] + along.perp() * across]
    }
}

impl<T: Scalar> AccelerationInput<T, 2> for UnitMotions<'_, T> {
    #[inline(always)]
    fn angular_acceleration(self, frame: usize) -> [T; 2] {
        let [first] = GivenMotion(self.0).angular_acceleration(frame);
        [first, self.0.velocity.angular[frame]]
    }

    #[inline(always)]
    fn squared_angular_velocity(self, frame: usize) -> [T; 2] {
        let [first] = GivenMotion(self.0).squared_angular_velocity(frame);
        [first, T::from_f64(0.0)]
    }

    #[inline(always)]
    fn vector_acceleration(self, frame: usize, vector: Vec2<T>) -> [Vec2<T>; 2] {
        let [first] = GivenMotion(self.0).vector_acceleration(frame, vector);
        [first, vector.perp() * self.0.velocity.angular[frame]]
    }

    #[inline(always)]
    fn slide_acceleration(self, slide: usize, frame: usize, along: Vec2<T>) -> [Vec2<T>; 2] {
        let [first] = GivenMotion(self.0).slide_acceleration(slide, frame, along);
        [first, along * self.0.velocity.slide[slide]]
    }
}
