//! States of points, angles, travels and lengths at a pose and a motion: position, velocity and acceleration.
//!
//! A [`BodyStates`] is filled once for a pose and a motion; each query afterwards costs a few multiplications and
//! allocates nothing.

use crate::mechanism::{BodyId, Coordinate, Guide, JointId, Mechanism};
use crate::motion::Motion;
use crate::plan::{Plan, Pose};
use crate::plane::{Vec2, vec2};
use dwell_numerics::{Constant, Lift, Scalar};

/// The state of one body, in ground axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyState<T = f64, C = f64> {
    /// The body's joint origin in its own frame, m.
    local_origin: Vec2<C>,
    /// Its joint origin, from the [origin](BodyStates::origin) of the states, m.
    pub joint_origin: Vec2<T>,
    /// Velocity of the joint origin, m/s.
    pub velocity: Vec2<T>,
    /// Acceleration of the joint origin, m/s².
    pub acceleration: Vec2<T>,
    /// Orientation of the body's frame, (cos, sin).
    pub rotation: Vec2<T>,
    /// The angle of its frame with whole revolutions, rad. They are counted if actuators turn the frame from the
    /// ground, or if a coupling or a load needs them; otherwise `None`.
    pub angle: Option<T>,
    /// Angular velocity ω, rad/s.
    pub angular_velocity: T,
    /// Angular acceleration α, rad/s².
    pub angular_acceleration: T,
}

impl<C: Constant, T: Lift<C>> BodyState<T, C> {
    /// From the body's joint origin to one of its points (in its frame, m), in ground axes, m.
    #[inline]
    pub fn moment_arm(&self, point: Vec2<C>) -> Vec2<T> {
        (point - self.local_origin).cast().rotate(self.rotation)
    }

    /// Velocity of the body at a moment arm (ground axes, m) from its joint origin, m/s.
    #[inline]
    pub fn velocity_at(&self, moment_arm: Vec2<T>) -> Vec2<T> {
        self.velocity + moment_arm.perp() * self.angular_velocity
    }

    /// Acceleration of the body at a moment arm (ground axes, m) from its joint origin, m/s².
    #[inline]
    pub fn acceleration_at(&self, moment_arm: Vec2<T>) -> Vec2<T> {
        self.acceleration + moment_arm.perp() * self.angular_acceleration
            - moment_arm * (self.angular_velocity * self.angular_velocity)
    }
}

/// A point of a body, in ground axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointState<T = f64> {
    /// Position in the ground's frame, m.
    pub position: Vec2<T>,
    /// Its velocity, m/s.
    pub velocity: Vec2<T>,
    /// Its acceleration, m/s².
    pub acceleration: Vec2<T>,
}

/// The separation of two points: P₂ − P₁ and its derivatives, in ground axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation<T = f64> {
    /// P₂ − P₁, m.
    pub gap: Vec2<T>,
    /// Its rate, m/s.
    pub velocity: Vec2<T>,
    /// Its second derivative, m/s².
    pub acceleration: Vec2<T>,
    /// The distance, m.
    pub length: T,
    /// The unit vector from the first to the second; `None` if they coincide to the rounding of
    /// their positions.
    pub direction: Option<Vec2<T>>,
}

/// A coordinate with the bodies, points and axis that its evaluation needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CoordinateFunction<C = f64> {
    /// Angle of the second body from the first.
    Angle([BodyId; 2]),
    /// Travel t·(P₂ − P₁).
    Travel(Guide<Vec2<C>>),
    /// Distance of two points.
    Length {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each, m.
        points: [Vec2<C>; 2],
    },
}

impl CoordinateFunction {
    /// The function that evaluates a coordinate; none if it names a body or joint that does not exist, or the
    /// travel of a joint without one.
    pub fn find(mechanism: &Mechanism, coordinate: Coordinate) -> Option<Self> {
        let exist = |bodies: [BodyId; 2]| bodies.iter().all(|b| b.0 < mechanism.bodies.len());
        match coordinate {
            Coordinate::Angle(bodies) => exist(bodies).then_some(Self::Angle(bodies)),
            Coordinate::Travel(joint) => {
                let guide = mechanism.joints.get(joint.0)?.guide()?;
                exist(guide.bodies).then_some(Self::Travel(guide))
            }
            Coordinate::Length { bodies, points } => {
                exist(bodies).then_some(Self::Length { bodies, points })
            }
        }
    }
}

/// The state of every body at a pose and a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyStates<T = f64, C = f64> {
    /// The ground's joint origin, from which all positions are measured. Differences of positions therefore do not
    /// depend on the position of the mechanism.
    origin: Vec2<C>,
    /// One state for each body, including the ground.
    bodies: Vec<BodyState<T, C>>,
}

impl<C: Constant, T: Lift<C>> BodyStates<T, C> {
    /// Room for the states of a plan's bodies, all at rest.
    pub fn new(plan: &Plan<C>) -> Self {
        let rest = |&local: &Vec2<C>| BodyState {
            local_origin: local,
            joint_origin: Vec2::zero(),
            velocity: Vec2::zero(),
            acceleration: Vec2::zero(),
            rotation: Vec2::IDENTITY.cast(),
            angle: Some(T::from_f64(0.0)),
            angular_velocity: T::from_f64(0.0),
            angular_acceleration: T::from_f64(0.0),
        };
        Self {
            origin: plan.tree().joint_origins[plan.lowered.ground],
            bodies: plan.tree().joint_origins.iter().map(rest).collect(),
        }
    }

    /// Takes over the dimensions of a plan whose numbers have changed since these states were made.
    pub fn set_dimensions(&mut self, plan: &Plan<C>) {
        self.origin = plan.tree().joint_origins[plan.lowered.ground];
        let bodies = self.bodies.iter_mut().zip(&plan.tree().joint_origins);
        bodies.for_each(|(state, &local)| state.local_origin = local);
    }

    /// Takes over the states of others of the same plan.
    pub fn copy_from(&mut self, others: &Self) {
        self.origin = others.origin;
        self.bodies.clone_from(&others.bodies);
    }

    /// Fills the states from a pose and a motion with accelerations.
    pub fn fill(&mut self, plan: &Plan<C>, pose: &Pose<T>, motion: &Motion<T>) {
        self.fill_velocities(plan, pose, motion);
        self.fill_accelerations(plan, pose, motion);
    }

    /// Positions and velocities from a pose and a motion; the accelerations are not changed.
    pub fn fill_velocities(&mut self, plan: &Plan<C>, pose: &Pose<T>, motion: &Motion<T>) {
        for (moving_body, tree_joint) in plan.moving_bodies().iter().zip(&plan.tree().joints) {
            let body = moving_body.body;
            let parent = &self.bodies[tree_joint.parent];
            let (mut joint_origin, mut velocity) = (parent.joint_origin, parent.velocity);
            if let Some(vector) = moving_body.joint_vector {
                let vector = pose.vector[vector];
                velocity = parent.velocity_at(vector);
                joint_origin += vector;
            } else {
                joint_origin += tree_joint.joint_vector.local.cast();
            }
            let orientation = plan.frames().orientations[body];
            let rotation = pose.rotation[orientation.frame];
            let angle = plan.counted_angle(body, pose);
            let state = &mut self.bodies[body];
            state.angular_velocity = motion.velocity.angular[orientation.frame];
            state.angle = angle;
            state.rotation = orientation.offset.cast().rotate(rotation);
            (state.joint_origin, state.velocity) = (joint_origin, velocity);
            if let Some((slide, direction)) = moving_body.slide {
                let along = pose.vector[direction];
                let travel_vector = along * pose.slide_travel[slide];
                let speed = motion.velocity.slide[slide];
                state.velocity = state.velocity_at(travel_vector) + along * speed;
                state.joint_origin += travel_vector;
            }
        }
    }

    /// Accelerations from a pose and a motion whose velocities the states have.
    pub fn fill_accelerations(&mut self, plan: &Plan<C>, pose: &Pose<T>, motion: &Motion<T>) {
        for (moving_body, tree_joint) in plan.moving_bodies().iter().zip(&plan.tree().joints) {
            let body = moving_body.body;
            let parent = &self.bodies[tree_joint.parent];
            let joint_vector = moving_body.joint_vector.map(|vector| pose.vector[vector]);
            let acceleration = match joint_vector {
                Some(vector) => parent.acceleration_at(vector),
                None => parent.acceleration,
            };
            let frame = plan.frames().orientations[body].frame;
            let state = &mut self.bodies[body];
            state.acceleration = acceleration;
            state.angular_acceleration = motion.acceleration.angular[frame];
            if let Some((slide, direction)) = moving_body.slide {
                let along = pose.vector[direction];
                let travel_vector = along * pose.slide_travel[slide];
                let speed = motion.velocity.slide[slide];
                let coriolis = T::from_f64(2.0) * state.angular_velocity * speed;
                state.acceleration = state.acceleration_at(travel_vector)
                    + along * motion.acceleration.slide[slide]
                    + along.perp() * coriolis;
            }
        }
    }

    /// The point of the ground from which joint origins are measured, m.
    pub fn origin(&self) -> Vec2<C> {
        self.origin
    }

    /// Number of bodies, the ground included.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Whether there is no body at all.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// The state of a body.
    #[inline]
    pub fn body(&self, body: BodyId) -> &BodyState<T, C> {
        &self.bodies[body.0]
    }

    /// A point of a body, given in its frame, m.
    #[inline]
    pub fn point(&self, body: BodyId, point: Vec2<C>) -> PointState<T> {
        let state = self.body(body);
        let moment_arm = state.moment_arm(point);
        PointState {
            position: self.origin.cast() + state.joint_origin + moment_arm,
            velocity: state.velocity_at(moment_arm),
            acceleration: state.acceleration_at(moment_arm),
        }
    }

    /// The separation of two points, m. Each point is given in its body's frame.
    pub fn separation(&self, bodies: [BodyId; 2], points: [Vec2<C>; 2]) -> Separation<T> {
        let [one, two] = bodies.map(|b| self.body(b));
        let [a, b] = [one.moment_arm(points[0]), two.moment_arm(points[1])];
        let gap = (two.joint_origin - one.joint_origin) + (b - a);
        let length = gap.dot(gap).sqrt();
        let size = [one.joint_origin, two.joint_origin, a, b]
            .map(|v| v.x.value().abs() + v.y.value().abs());
        // Below the rounding of the positions themselves a direction means nothing.
        let rounding = 8.0 * f64::EPSILON * size.iter().sum::<f64>();
        let distinct = length.value() > rounding;
        Separation {
            gap,
            velocity: two.velocity_at(b) - one.velocity_at(a),
            acceleration: two.acceleration_at(b) - one.acceleration_at(a),
            length,
            direction: distinct.then(|| gap * (T::from_f64(1.0) / length)),
        }
    }

    /// Angle of the second body's frame from the first's, rad, its speed (rad/s) and acceleration
    /// (rad/s²). Whole revolutions are counted if they are counted for both bodies. Otherwise the angle is in (−π, π].
    pub fn angle(&self, bodies: [BodyId; 2]) -> [T; 3] {
        let [one, two] = bodies.map(|b| self.body(b));
        let counted = one.angle.zip(two.angle).map(|(one, two)| two - one);
        [
            counted.unwrap_or_else(|| angle(two.rotation.rotate_inverse(one.rotation))),
            two.angular_velocity - one.angular_velocity,
            two.angular_acceleration - one.angular_acceleration,
        ]
    }

    /// Value, speed and acceleration of a coordinate: rad or m, per s, per s². Angles are those of [`angle`](Self::angle).
    /// If two points coincide, the derivatives of their distance are one-sided, for increasing time.
    pub fn coordinate(&self, function: CoordinateFunction<C>) -> [T; 3] {
        match function {
            CoordinateFunction::Angle(bodies) => self.angle(bodies),
            CoordinateFunction::Travel(guide) => {
                let between = self.separation(guide.bodies, guide.points);
                let first = self.body(guide.bodies[0]);
                let along = guide.axis.cast().rotate(first.rotation);
                let (w, a) = (first.angular_velocity, first.angular_acceleration);
                // The separation as the first body sees it.
                let velocity = between.velocity - between.gap.perp() * w;
                let relative = between.acceleration
                    - between.gap.perp() * a
                    - velocity.perp() * (T::from_f64(2.0) * w)
                    + between.gap * (w * w);
                [
                    along.dot(between.gap),
                    along.dot(velocity),
                    along.dot(relative),
                ]
            }
            CoordinateFunction::Length { bodies, points } => {
                self.separation(bodies, points).length_derivatives()
            }
        }
    }
}

impl<T: Scalar> Separation<T> {
    /// The distance with its two derivatives, m, m/s, m/s². At distance zero they are one-sided, for increasing time.
    fn length_derivatives(&self) -> [T; 3] {
        let Some(along) = self.direction else {
            // |v t + ½ a t²| just after t = 0.
            let speed = self.velocity.dot(self.velocity).sqrt();
            let acceleration = if speed.value() > 0.0 {
                self.velocity.dot(self.acceleration) / speed
            } else {
                self.acceleration.dot(self.acceleration).sqrt()
            };
            return [self.length, speed, acceleration];
        };
        let across = along.cross(self.velocity);
        let velocity = along.dot(self.velocity);
        let acceleration = along.dot(self.acceleration) + across * across / self.length;
        [self.length, velocity, acceleration]
    }
}

impl Plan {
    /// The slope of the law by which a joint couples two coordinates, at a pose; none if it couples none by a law.
    pub fn coupling_slope<T: Scalar>(&self, joint: JointId, pose: &Pose<T>) -> Option<T> {
        let coupling = &self.couplings[self.joint_parts(joint).1?];
        coupling.law.as_ref()?;
        Some(coupling.slope(&pose.angle, &pose.slide_travel))
    }
}

/// The angle of a direction, in (−π, π] rad, in any number type: the angle of the values, corrected to first order by
/// the remainder after the direction is turned back by this angle.
fn angle<T: Scalar>(direction: Vec2<T>) -> T {
    let values = vec2(direction.x.value(), direction.y.value());
    let found = values.angle();
    let rest = direction.rotate_inverse(Vec2::from_angle(found).cast());
    T::from_f64(found) + rest.y / rest.x
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests;
