//! What can be measured on a placed and moving mechanism: points, angles, travels and lengths,
//! each with its speed and acceleration.
//!
//! A [`BodyStates`] is filled once for a pose and a motion; what is asked of it afterwards costs a
//! few multiplications and allocates nothing.

use crate::mechanism::{BodyId, Coordinate, JointId, JointKind, Mechanism};
use crate::motion::Motion;
use crate::plan::{Plan, Pose};
use crate::plane::{Vec2, vec2};
use crate::scalar::Scalar;

/// The state of one body, in ground axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyState<T = f64> {
    /// The body's root in its own frame, m.
    local: Vec2,
    /// Its root, from the [origin](BodyStates::origin) of the states, m.
    pub root: Vec2<T>,
    /// Velocity of the root, m/s.
    pub velocity: Vec2<T>,
    /// Acceleration of the root, m/s².
    pub acceleration: Vec2<T>,
    /// Orientation of the body's frame, (cos, sin).
    pub turn: Vec2<T>,
    /// The angle of its frame with whole turns, rad, where they are counted: where actuators turn it
    /// from the ground, or a relation or a load needs it.
    pub angle: Option<T>,
    /// Angular velocity ω, rad/s.
    pub spin: T,
    /// Angular acceleration α, rad/s².
    pub spin_rate: T,
}

impl<T: Scalar> BodyState<T> {
    /// From the body's root to one of its points (in its frame, m), in ground axes, m.
    #[inline]
    pub fn arm(&self, point: Vec2) -> Vec2<T> {
        (point - self.local).lift().turn(self.turn)
    }

    /// Velocity of the body at an arm (ground axes, m) from its root, m/s.
    #[inline]
    pub fn velocity_at(&self, arm: Vec2<T>) -> Vec2<T> {
        self.velocity + arm.perp() * self.spin
    }

    /// Acceleration of the body at an arm (ground axes, m) from its root, m/s².
    #[inline]
    pub fn acceleration_at(&self, arm: Vec2<T>) -> Vec2<T> {
        self.acceleration + arm.perp() * self.spin_rate - arm * (self.spin * self.spin)
    }
}

/// A point of a body, in ground axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointState<T = f64> {
    /// Where it is in the ground's frame, m.
    pub position: Vec2<T>,
    /// Its velocity, m/s.
    pub velocity: Vec2<T>,
    /// Its acceleration, m/s².
    pub acceleration: Vec2<T>,
}

/// What separates two points: P₂ − P₁ and its derivatives, in ground axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation<T = f64> {
    /// P₂ − P₁, m.
    pub gap: Vec2<T>,
    /// Its rate, m/s.
    pub rate: Vec2<T>,
    /// Its second derivative, m/s².
    pub acceleration: Vec2<T>,
    /// The distance, m.
    pub length: T,
    /// The unit vector from the first to the second; none where they coincide to the rounding of
    /// their positions.
    pub direction: Option<Vec2<T>>,
}

/// A coordinate with what its measurement needs of the mechanism.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measured {
    /// Angle of the second body from the first.
    Angle([BodyId; 2]),
    /// Travel t·(P₂ − P₁).
    Travel {
        /// The joint's bodies.
        bodies: [BodyId; 2],
        /// Its point on each, m.
        points: [Vec2; 2],
        /// The axis t in the first body's frame.
        axis: Vec2,
    },
    /// Distance of two points.
    Length {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each, m.
        points: [Vec2; 2],
    },
}

impl Measured {
    /// How a coordinate is measured; none if it names a body or joint that is not there, or the
    /// travel of a joint without one.
    pub fn find(mechanism: &Mechanism, coordinate: Coordinate) -> Option<Self> {
        let there = |bodies: [BodyId; 2]| bodies.iter().all(|b| b.0 < mechanism.bodies.len());
        match coordinate {
            Coordinate::Angle(bodies) => there(bodies).then_some(Self::Angle(bodies)),
            Coordinate::Travel(joint) => {
                let joint = mechanism.joints.get(joint.0)?;
                let axis = match joint.kind {
                    JointKind::Prismatic { axes } => axes[0],
                    JointKind::Slot { axis } => axis,
                    _ => return None,
                };
                there(joint.bodies).then_some(Self::Travel {
                    bodies: joint.bodies,
                    points: joint.points,
                    axis,
                })
            }
            Coordinate::Length { bodies, points } => {
                there(bodies).then_some(Self::Length { bodies, points })
            }
        }
    }
}

/// The state of every body at a pose and a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyStates<T = f64> {
    /// The ground's root, from which all positions are measured: what lies between two points
    /// does not depend on where the mechanism stands.
    origin: Vec2,
    /// By body, the ground included.
    bodies: Vec<BodyState<T>>,
}

impl<T: Scalar> BodyStates<T> {
    /// Room for the states of a plan's bodies, all at rest.
    pub fn new(plan: &Plan) -> Self {
        let rest = |&local: &Vec2| BodyState {
            local,
            root: Vec2::zero(),
            velocity: Vec2::zero(),
            acceleration: Vec2::zero(),
            turn: Vec2::IDENTITY.lift(),
            angle: Some(T::lift(0.0)),
            spin: T::lift(0.0),
            spin_rate: T::lift(0.0),
        };
        Self {
            origin: plan.tree().roots[plan.lowered.ground],
            bodies: plan.tree().roots.iter().map(rest).collect(),
        }
    }

    /// Takes the states from a pose and a motion. A motion without accelerations leaves those
    /// here without meaning.
    pub fn fill(&mut self, plan: &Plan, pose: &Pose<T>, motion: &Motion<T>) {
        for (carried, carry) in plan.carried().iter().zip(&plan.tree().carries) {
            let body = carried.body;
            let mut state = self.bodies[carry.parent];
            if let Some(arm) = carried.arm {
                let arm = pose.arm[arm];
                state.velocity = state.velocity_at(arm);
                state.acceleration = state.acceleration_at(arm);
                state.root += arm;
            } else {
                state.root += carry.arm.local.lift();
            }
            let attitude = plan.frames().attitudes[body];
            state.spin = motion.turn[attitude.frame];
            state.spin_rate = motion.turn_rate[attitude.frame];
            state.angle = plan.counted_angle(body, pose);
            state.turn = attitude.offset.lift().turn(pose.turn[attitude.frame]);
            state.local = self.bodies[body].local;
            if let Some((slide, direction)) = carried.slide {
                let along = pose.arm[direction];
                let reach = along * pose.slide[slide];
                let speed = motion.slide[slide];
                let coriolis = T::lift(2.0) * state.spin * speed;
                state.velocity = state.velocity_at(reach) + along * speed;
                state.acceleration = state.acceleration_at(reach)
                    + along * motion.slide_rate[slide]
                    + along.perp() * coriolis;
                state.root += reach;
            }
            self.bodies[body] = state;
        }
    }

    /// The point of the ground from which roots are measured, m.
    pub fn origin(&self) -> Vec2 {
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
    pub fn body(&self, body: BodyId) -> &BodyState<T> {
        &self.bodies[body.0]
    }

    /// A point of a body, given in its frame, m.
    pub fn point(&self, body: BodyId, point: Vec2) -> PointState<T> {
        let state = self.body(body);
        let arm = state.arm(point);
        PointState {
            position: self.origin.lift() + state.root + arm,
            velocity: state.velocity_at(arm),
            acceleration: state.acceleration_at(arm),
        }
    }

    /// What separates two points, each in its body's frame, m.
    pub fn separation(&self, bodies: [BodyId; 2], points: [Vec2; 2]) -> Separation<T> {
        let [one, two] = bodies.map(|b| self.body(b));
        let [a, b] = [one.arm(points[0]), two.arm(points[1])];
        let gap = (two.root - one.root) + (b - a);
        let length = gap.dot(gap).sqrt();
        let size = [one.root, two.root, a, b].map(|v| v.x.value().abs() + v.y.value().abs());
        // Below the rounding of the positions themselves a direction means nothing.
        let rounding = 8.0 * f64::EPSILON * size.iter().sum::<f64>();
        let apart = length.value() > rounding;
        Separation {
            gap,
            rate: two.velocity_at(b) - one.velocity_at(a),
            acceleration: two.acceleration_at(b) - one.acceleration_at(a),
            length,
            direction: apart.then(|| gap * (T::lift(1.0) / length)),
        }
    }

    /// Angle of the second body's frame from the first's, rad, its speed (rad/s) and acceleration
    /// (rad/s²). Whole turns are counted where they are for both bodies; else it is in (−π, π].
    pub fn angle(&self, bodies: [BodyId; 2]) -> [T; 3] {
        let [one, two] = bodies.map(|b| self.body(b));
        let counted = one.angle.zip(two.angle).map(|(one, two)| two - one);
        [
            counted.unwrap_or_else(|| angle(two.turn.turn_back(one.turn))),
            two.spin - one.spin,
            two.spin_rate - one.spin_rate,
        ]
    }

    /// Value, speed and acceleration of a coordinate: rad or m, per s, per s². Angles are
    /// those of [`angle`](Self::angle). Where two points coincide, the derivatives of their length are those to the right.
    pub fn measure(&self, measured: Measured) -> [T; 3] {
        match measured {
            Measured::Angle(bodies) => self.angle(bodies),
            Measured::Travel {
                bodies,
                points,
                axis,
            } => {
                let between = self.separation(bodies, points);
                let first = self.body(bodies[0]);
                let along = axis.lift().turn(first.turn);
                let (w, a) = (first.spin, first.spin_rate);
                // The separation as the first body sees it.
                let rate = between.rate - between.gap.perp() * w;
                let relative = between.acceleration
                    - between.gap.perp() * a
                    - rate.perp() * (T::lift(2.0) * w)
                    + between.gap * (w * w);
                [along.dot(between.gap), along.dot(rate), along.dot(relative)]
            }
            Measured::Length { bodies, points } => self.separation(bodies, points).lengths(),
        }
    }
}

impl<T: Scalar> Separation<T> {
    /// The distance with its two derivatives, m, m/s, m/s²; those to the right where it is zero.
    fn lengths(&self) -> [T; 3] {
        let Some(along) = self.direction else {
            return self.parting();
        };
        let across = along.cross(self.rate);
        let rate = along.dot(self.rate);
        let acceleration = along.dot(self.acceleration) + across * across / self.length;
        [self.length, rate, acceleration]
    }

    /// |v t + ½ a t²| just after t = 0.
    fn parting(&self) -> [T; 3] {
        let speed = self.rate.dot(self.rate).sqrt();
        let acceleration = if speed.value() > 0.0 {
            self.rate.dot(self.acceleration) / speed
        } else {
            self.acceleration.dot(self.acceleration).sqrt()
        };
        [self.length, speed, acceleration]
    }
}

impl Plan {
    /// The slope of the law by which a joint relates two coordinates, at a pose; none if it
    /// relates none.
    pub fn relation_slope<T: Scalar>(&self, joint: JointId, pose: &Pose<T>) -> Option<T> {
        let relation = self.parts(joint).1?;
        self.relation(relation)
            .law
            .is_some()
            .then(|| self.relation(relation).slope(&pose.angle, &pose.slide))
    }
}

/// The angle of a direction, in (−π, π] rad, in any kind of number: that of the values, corrected
/// to first order by what remains when the direction is turned back by it.
fn angle<T: Scalar>(direction: Vec2<T>) -> T {
    let values = vec2(direction.x.value(), direction.y.value());
    let found = values.angle();
    let rest = direction.turn_back(Vec2::from_angle(found).lift());
    T::lift(found) + rest.y / rest.x
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests;
