//! Positions, velocities and accelerations of the bodies from those of the freedoms, along the tree.

use super::tree::{FreedomKind, Link, Step, next_axis};
use super::vector::{Rotation, Vec3};
use super::wrench::Wrench;
use dwell_numerics::{Constant, Lift, Scalar};

/// A frame on a body, in that of the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame<T> {
    /// Its origin, m.
    pub position: Vec3<T>,
    /// Its orientation.
    pub rotation: Rotation<T>,
}

impl<T: Scalar> Default for Frame<T> {
    fn default() -> Self {
        Self {
            position: Vec3::zero(),
            rotation: Rotation::default(),
        }
    }
}

impl<T: Scalar> Frame<T> {
    /// A point of the body.
    #[inline(always)]
    pub fn point<C: Constant>(&self, point: Vec3<C>) -> Vec3<T>
    where
        T: Lift<C>,
    {
        self.position + self.rotation.apply(point.cast())
    }

    /// A frame fixed in this one.
    #[inline(always)]
    pub(super) fn then<C: Constant>(&self, inner: &Frame<C>) -> Self
    where
        T: Lift<C>,
    {
        Self {
            position: self.point(inner.position),
            rotation: self.rotation.after(&inner.rotation.cast()),
        }
    }

    /// The frame outside in this one.
    pub(super) fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self {
            position: -rotation.apply(self.position),
            rotation,
        }
    }

    /// A point in this frame, of its coordinates outside: the difference comes first, which is exact where both are far away.
    pub fn inner_point(&self, point: Vec3<T>) -> Vec3<T> {
        self.rotation.apply_inverse(point - self.position)
    }
}

/// The screw of a freedom: its axis, a point of it, and the frame's point through which it slides.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Screw<T> {
    pub(super) axis: Vec3<T>,
    pub(super) point: Vec3<T>,
}

/// The velocities of a body for a unit rate of a freedom: of one of its points, and angular.
#[derive(Debug, Clone, Copy)]
pub(super) struct Twist<T> {
    pub(super) linear: Vec3<T>,
    angular: Vec3<T>,
}

impl<T: Scalar> Twist<T> {
    /// The power of the force of a wrench about that point.
    #[inline(always)]
    pub(super) fn force_power(&self, wrench: &Wrench<T>) -> T {
        self.linear.dot(wrench.force)
    }

    /// The power of its moment.
    #[inline(always)]
    pub(super) fn moment_power(&self, wrench: &Wrench<T>) -> T {
        self.angular.dot(wrench.moment)
    }
}

impl<T: Scalar> Screw<T> {
    /// The velocity of a point for a rate of `units`.
    #[inline(always)]
    pub(super) fn velocity<C: Constant>(
        &self,
        kind: FreedomKind<C>,
        at: Vec3<T>,
        units: f64,
    ) -> Vec3<T>
    where
        T: Lift<C>,
    {
        self.twist(kind, at, units).linear
    }

    /// The power that a unit takes from a wrench about the origin of the frame that it places: turns come last, so that the origin is on
    /// their axes.
    #[inline(always)]
    pub(super) fn power_at_origin<C: Constant>(&self, kind: FreedomKind<C>, wrench: &Wrench<T>) -> T
    where
        T: Lift<C>,
    {
        match kind {
            FreedomKind::Turn | FreedomKind::BallTurn => self.axis.dot(wrench.moment),
            FreedomKind::Slide => self.axis.dot(wrench.force),
            FreedomKind::Screw(pitch) => {
                self.axis.dot(wrench.moment) + T::lift(pitch) * self.axis.dot(wrench.force)
            }
            FreedomKind::Length => T::from_f64(0.0),
        }
    }

    /// The twist at a point for a rate of `units`.
    #[inline(always)]
    pub(super) fn twist<C: Constant>(
        &self,
        kind: FreedomKind<C>,
        at: Vec3<T>,
        units: f64,
    ) -> Twist<T>
    where
        T: Lift<C>,
    {
        let axis = self.axis.scaled(T::from_f64(units));
        let turned = || axis.cross(at - self.point);
        let (linear, angular) = match kind {
            FreedomKind::Turn | FreedomKind::BallTurn => (turned(), axis),
            FreedomKind::Slide => (axis, Vec3::zero()),
            FreedomKind::Length => (Vec3::zero(), Vec3::zero()),
            FreedomKind::Screw(pitch) => (turned() + axis.scaled(T::lift(pitch)), axis),
        };
        Twist { linear, angular }
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

    /// From rest, with accelerations equal to these velocities.
    #[inline(always)]
    pub fn from_rest(&self) -> Self {
        Self {
            acceleration: self.velocity,
            angular_acceleration: self.angular_velocity,
            ..Self::default()
        }
    }

    /// The motion that the body gives to another one fixed to it, with an origin at this vector from its own.
    #[inline(always)]
    pub(super) fn carried(&self, arm: Vec3<T>) -> Self {
        Self {
            velocity: self.point_velocity(arm),
            acceleration: self.point_acceleration(arm),
            ..*self
        }
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

impl<C: Constant> Link<C> {
    /// The frame of its joint on the parent. The ground has the reference axes.
    #[inline(always)]
    pub(super) fn base<T: Lift<C>>(&self, parent: &Frame<T>, is_ground: bool) -> Frame<T> {
        if is_ground {
            return Frame {
                position: parent.position + self.on_parent.position.cast(),
                rotation: self.on_parent.rotation.cast(),
            };
        }
        parent.then(&self.on_parent)
    }

    /// The body's frame and the screws of the freedoms, from the joint's frame on the parent.
    #[inline]
    pub(super) fn place<T: Lift<C>>(
        &self,
        mut frame: Frame<T>,
        coordinates: &[T],
        balls: &[Rotation<T>],
        freedoms: &[FreedomKind<C>],
        screws: &mut [Screw<T>],
    ) -> Frame<T> {
        for step in &self.steps {
            match *step {
                Step::Turn(c) => {
                    let axis = frame.rotation.columns[2];
                    if let FreedomKind::Screw(pitch) = freedoms[c] {
                        frame.position += axis.scaled(coordinates[c] * T::lift(pitch));
                    }
                    let point = frame.position;
                    screws[c] = Screw { axis, point };
                    frame.rotation = frame.rotation.turned_about_z(coordinates[c].sin_cos());
                }
                Step::Slide(k, c) => {
                    let axis = frame.rotation.columns[k];
                    frame.position += axis.scaled(coordinates[c]);
                    let point = frame.position;
                    screws[c] = Screw { axis, point };
                }
                Step::NextAxis => frame.rotation = next_axis(&frame.rotation),
                Step::Ball(ball, first) => {
                    for (k, axis) in Vec3::AXES.iter().enumerate() {
                        screws[first + k] = Screw {
                            axis: axis.cast(),
                            point: frame.position,
                        };
                    }
                    frame.rotation = frame.rotation.after(&balls[ball]);
                }
            }
        }
        frame
    }

    /// The body's velocities, and its accelerations without those of the freedoms, from those of the parent and those that the body
    /// has if it moves with the parent.
    ///
    /// ```text
    /// ω̇ = ω̇_p + Σ ω×u ċ,     v̇ = v̇_p + ω̇_p×r + ω_p×(ω_p×r) + Σ 2 ω_p×u ċ                            (1)
    /// ```
    ///
    /// with ω that of the frame in which the axis u is fixed, and r from the parent's origin to the body's. The three
    /// freedoms of a ball are components of the relative ω along axes of the ground: their c̈ is the whole of its change.
    #[inline(always)]
    pub(super) fn motion<T: Lift<C>>(
        &self,
        mut state: BodyMotion<T>,
        of_parent: &BodyMotion<T>,
        rates: &[T],
        freedoms: &[FreedomKind<C>],
        screws: &[Screw<T>],
    ) -> BodyMotion<T> {
        for c in self.freedoms.clone() {
            let along = screws[c].axis.scaled(rates[c]);
            let slide = |state: &mut BodyMotion<T>, along: Vec3<T>| {
                let carried = of_parent.angular_velocity.cross(along);
                state.velocity += along;
                state.acceleration += carried + carried;
            };
            match freedoms[c] {
                FreedomKind::Slide => slide(&mut state, along),
                FreedomKind::Screw(pitch) => {
                    slide(&mut state, along.scaled(T::lift(pitch)));
                    state.angular_acceleration += state.angular_velocity.cross(along);
                    state.angular_velocity += along;
                }
                FreedomKind::Turn => {
                    state.angular_acceleration += state.angular_velocity.cross(along);
                    state.angular_velocity += along;
                }
                FreedomKind::BallTurn => state.angular_velocity += along,
                FreedomKind::Length => {}
            }
        }
        state
    }

    /// The contributions of the accelerations of the freedoms to those of the body's origin and rotation, from the contributions to the
    /// parent's.
    ///
    /// ```text
    /// Δω̇ = Δω̇_p + Σ u c̈,     Δv̇ = Δv̇_p + Δω̇_p×r + Σ u c̈                                            (2)
    /// ```
    #[inline(always)]
    pub(super) fn added<T: Lift<C>>(
        &self,
        arm: Vec3<T>,
        [origin, turn]: [Vec3<T>; 2],
        accelerations: &[T],
        freedoms: &[FreedomKind<C>],
        screws: &[Screw<T>],
    ) -> [Vec3<T>; 2] {
        let mut added = [origin + turn.cross(arm), turn];
        for c in self.freedoms.clone() {
            let along = screws[c].axis.scaled(accelerations[c]);
            match freedoms[c] {
                FreedomKind::Slide => added[0] += along,
                FreedomKind::Screw(pitch) => {
                    added[0] += along.scaled(T::lift(pitch));
                    added[1] += along;
                }
                FreedomKind::Turn | FreedomKind::BallTurn => added[1] += along,
                FreedomKind::Length => {}
            }
        }
        added
    }
}
