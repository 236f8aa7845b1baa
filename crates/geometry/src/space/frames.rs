//! Positions, velocities and accelerations of the bodies from those of the freedoms, along the tree.

use super::mechanism::Placement;
use super::tree::{FreedomKind, Link, Step, next_axis};
use super::vector::{Rotation, Vec3};
use super::wrench::Wrench;
use dwell_numerics::Scalar;

/// A frame on a body, in that of the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame<T> {
    /// Its origin, m.
    pub origin: Vec3<T>,
    /// Its orientation.
    pub rotation: Rotation<T>,
}

impl<T: Scalar> Default for Frame<T> {
    fn default() -> Self {
        Self {
            origin: Vec3::zero(),
            rotation: Rotation::default(),
        }
    }
}

impl<T: Scalar> Frame<T> {
    /// A point of the body.
    #[inline(always)]
    pub fn point(&self, point: Vec3) -> Vec3<T> {
        self.origin + self.rotation.apply(point.cast())
    }

    /// A frame fixed in this one.
    #[inline(always)]
    pub(super) fn then(&self, inner: &Placement) -> Self {
        Self {
            origin: self.point(inner.position),
            rotation: self.rotation.after(&inner.rotation.cast()),
        }
    }
}

/// The screw of a freedom: its axis, a point of it, and the frame's point through which it slides.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Screw<T> {
    pub(super) axis: Vec3<T>,
    pub(super) point: Vec3<T>,
}

impl<T: Scalar> Screw<T> {
    /// The power of a wrench about a point, at unit speed.
    #[inline(always)]
    pub(super) fn power(&self, kind: FreedomKind, wrench: Wrench<T>, at: Vec3<T>) -> T {
        let Wrench { force, moment } = wrench;
        match kind {
            FreedomKind::Turn | FreedomKind::BallTurn => {
                self.axis.dot(moment + (at - self.point).cross(force))
            }
            FreedomKind::Slide => self.axis.dot(force),
            FreedomKind::Screw(pitch) => {
                let moment = moment + (at - self.point).cross(force);
                self.axis.dot(moment + force.scaled(T::from_f64(pitch)))
            }
        }
    }
}

/// Velocities and accelerations of a body in the axes of the ground, with those of the origin of a frame on it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BodyMotion<T = f64> {
    /// Velocity of the origin, m/s.
    pub velocity: Vec3<T>,
    /// Angular velocity, rad/s.
    pub angular_velocity: Vec3<T>,
    /// Acceleration of the origin, m/s².
    pub acceleration: Vec3<T>,
    /// Angular acceleration, rad/s².
    pub angular_acceleration: Vec3<T>,
}

impl<T: Scalar> BodyMotion<T> {
    /// Velocity of a point at this vector from the origin.
    #[inline(always)]
    pub fn point_velocity(&self, arm: Vec3<T>) -> Vec3<T> {
        self.velocity + self.angular_velocity.cross(arm)
    }

    /// Acceleration of a point at this vector from the origin.
    #[inline(always)]
    pub fn point_acceleration(&self, arm: Vec3<T>) -> Vec3<T> {
        self.acceleration + self.direction_derivatives(arm).1
    }

    /// First and second derivative of a vector fixed in the body: ω × u and ω̇ × u + ω × (ω × u).
    #[inline(always)]
    pub fn direction_derivatives(&self, u: Vec3<T>) -> (Vec3<T>, Vec3<T>) {
        let first = self.angular_velocity.cross(u);
        (
            first,
            self.angular_acceleration.cross(u) + self.angular_velocity.cross(first),
        )
    }
}

impl Link {
    /// The body's frame and the screws of the freedoms, from the parent's frame.
    #[inline]
    pub(super) fn place<T: Scalar>(
        &self,
        parent: &Frame<T>,
        coordinates: &[T],
        balls: &[Rotation<T>],
        freedoms: &[FreedomKind],
        screws: &mut [Screw<T>],
    ) -> Frame<T> {
        let mut frame = parent.then(&self.on_parent);
        for step in &self.steps {
            match *step {
                Step::Turn(c) => {
                    let axis = frame.rotation.columns[2];
                    if let FreedomKind::Screw(pitch) = freedoms[c] {
                        frame.origin += axis.scaled(coordinates[c] * T::from_f64(pitch));
                    }
                    screws[c] = Screw {
                        axis,
                        point: frame.origin,
                    };
                    frame.rotation = frame.rotation.turned_about_z(coordinates[c].sin_cos());
                }
                Step::Slide(k, c) => {
                    let axis = frame.rotation.columns[k];
                    frame.origin += axis.scaled(coordinates[c]);
                    screws[c] = Screw {
                        axis,
                        point: frame.origin,
                    };
                }
                Step::NextAxis => frame.rotation = next_axis(&frame.rotation),
                Step::Ball(ball, first) => {
                    for (k, axis) in Vec3::AXES.iter().enumerate() {
                        screws[first + k] = Screw {
                            axis: axis.cast(),
                            point: frame.origin,
                        };
                    }
                    frame.rotation = frame.rotation.after(&balls[ball]);
                }
            }
        }
        frame
    }

    /// The body's velocities and accelerations from those of the parent and of the freedoms.
    ///
    /// ```text
    /// ω̇ = ω̇_p + Σ u c̈ + ω×u ċ,     v̇ = v̇_p + ω̇_p×r + ω_p×(ω_p×r) + Σ u c̈ + 2 ω_p×u ċ
    /// ```
    ///
    /// with ω that of the frame in which the axis u is fixed, and r from the parent's origin to the body's. The three
    /// freedoms of a ball are components of the relative ω along axes of the ground: their c̈ is the whole of its change.
    #[inline]
    pub(super) fn motion<T: Scalar>(
        &self,
        [parent, frame]: [&Frame<T>; 2],
        of_parent: &BodyMotion<T>,
        [rates, accelerations]: [&[T]; 2],
        freedoms: &[FreedomKind],
        screws: &[Screw<T>],
    ) -> BodyMotion<T> {
        let arm = frame.origin - parent.origin;
        let mut state = BodyMotion {
            velocity: of_parent.point_velocity(arm),
            acceleration: of_parent.point_acceleration(arm),
            ..*of_parent
        };
        let two = T::from_f64(2.0);
        for c in self.freedoms.clone() {
            let (axis, rate, acceleration) = (screws[c].axis, rates[c], accelerations[c]);
            let (turn, slide) = freedoms[c].parts();
            if slide != 0.0 {
                let (slide, carried) = (T::from_f64(slide), of_parent.angular_velocity.cross(axis));
                state.velocity += axis.scaled(rate * slide);
                state.acceleration +=
                    (axis.scaled(acceleration) + carried.scaled(two * rate)).scaled(slide);
            }
            if turn != 0.0 {
                state.angular_acceleration += axis.scaled(acceleration);
                if freedoms[c] != FreedomKind::BallTurn {
                    state.angular_acceleration += state.angular_velocity.cross(axis).scaled(rate);
                }
                state.angular_velocity += axis.scaled(rate);
            }
        }
        state
    }
}
