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

    /// Angle of the second body's frame from the first's in (−π, π] rad, its speed (rad/s) and
    /// acceleration (rad/s²).
    pub fn angle(&self, bodies: [BodyId; 2]) -> [T; 3] {
        let [one, two] = bodies.map(|b| self.body(b));
        [
            angle(two.turn.turn_back(one.turn)),
            two.spin - one.spin,
            two.spin_rate - one.spin_rate,
        ]
    }

    /// Value, speed and acceleration of a coordinate: rad or m, per s, per s². Angles are in
    /// (−π, π]. Where two points coincide, the derivatives of their length are those to the right.
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
mod tests {
    use super::*;
    use crate::mechanism::{Actuator, Body, Drive, Joint};
    use crate::plan::Start;
    use crate::scalar::Dual;

    const CRANK: BodyId = BodyId(1);
    const ROCKER: BodyId = BodyId(2);
    const BLOCK: BodyId = BodyId(3);

    /// A crank whose pin drives a slotted rocker by a block, standing at `place`.
    fn slotted_rocker(place: Vec2) -> Mechanism {
        let body = |name: &str| Body { name: name.into() };
        let joint = |name: &str, bodies: [usize; 2], points, kind| Joint {
            name: name.into(),
            bodies: bodies.map(BodyId),
            points,
            kind,
        };
        let along = vec2(0.8, 0.6);
        Mechanism {
            bodies: ["ground", "crank", "rocker", "block"].map(body).into(),
            ground: 0,
            joints: vec![
                joint("A", [0, 1], [place, vec2(0.3, 0.1)], JointKind::Revolute),
                joint(
                    "B",
                    [1, 3],
                    [vec2(0.4, 0.1), Vec2::ZERO],
                    JointKind::Revolute,
                ),
                joint(
                    "D",
                    [0, 2],
                    [place + vec2(-0.25, 0.05), vec2(0.2, 0.0)],
                    JointKind::Revolute,
                ),
                joint(
                    "slot",
                    [2, 3],
                    [vec2(0.2, 0.02), Vec2::ZERO],
                    JointKind::Prismatic {
                        axes: [along, vec2(0.0, 1.0)],
                    },
                ),
            ],
            actuators: vec![Actuator {
                name: "q".into(),
                bodies: [BodyId(0), CRANK],
                drive: Drive::Angle,
            }],
            relations: Vec::new(),
        }
    }

    fn plan(mechanism: &Mechanism) -> Plan {
        let start = Start {
            q: vec![0.3],
            rough: vec![None, None, Some(-0.6), None],
        };
        Plan::compile(mechanism, &start).unwrap()
    }

    /// The states at q, q̇ = `speed`, q̈ = 0, in any kind of number.
    fn states<T: Scalar>(plan: &Plan, q: T, speed: f64) -> BodyStates<T> {
        let (mut pose, mut motion) = (plan.pose(), plan.motion());
        plan.place(&[q], &mut pose).unwrap();
        plan.speeds(&pose, &[T::lift(speed)], &mut motion);
        plan.accelerations(&pose, &[T::lift(0.0)], &mut motion);
        let mut states = BodyStates::new(plan);
        states.fill(plan, &pose, &motion);
        states
    }

    fn coordinates() -> [Coordinate; 5] {
        let length = |bodies, points| Coordinate::Length { bodies, points };
        [
            Coordinate::Angle([BodyId(0), ROCKER]),
            Coordinate::Angle([CRANK, BLOCK]),
            Coordinate::Travel(JointId(3)),
            length([CRANK, ROCKER], [vec2(0.5, 0.3), vec2(-0.1, 0.7)]),
            length([BLOCK, BodyId(0)], [vec2(0.1, 0.2), vec2(0.9, -1.0)]),
        ]
    }

    /// At unit speed d/dt is d/dq: each of the three is the exact derivative of the one before.
    #[test]
    fn speeds_and_accelerations_are_derivatives() {
        let mechanism = slotted_rocker(Vec2::ZERO);
        let plan = plan(&mechanism);
        for k in 0..20 {
            let states = states(&plan, Dual::variable(0.3 * f64::from(k)), 1.0);
            let known = coordinates().map(|c| Measured::find(&mechanism, c));
            // Between points that no joint holds on the axis, too.
            let free = Measured::Travel {
                bodies: [CRANK, ROCKER],
                points: [vec2(0.5, 0.3), vec2(-0.1, 0.7)],
                axis: vec2(0.6, -0.8),
            };
            for measured in known.into_iter().flatten().chain([free]) {
                let [value, speed, acceleration] = states.measure(measured);
                // Values below 3, accelerations below 10: some roundings.
                assert!((value.d - speed.v).abs() < 1e-14, "{measured:?}");
                assert!((speed.d - acceleration.v).abs() < 1e-13, "{measured:?}");
            }
            for body in 0..4 {
                let point = states.point(BodyId(body), vec2(0.3, -0.7));
                let pairs = [
                    (point.position.x.d, point.velocity.x.v),
                    (point.position.y.d, point.velocity.y.v),
                    (point.velocity.x.d, point.acceleration.x.v),
                    (point.velocity.y.d, point.acceleration.y.v),
                ];
                assert!(
                    pairs.iter().all(|(d, v)| (d - v).abs() < 1e-13),
                    "{pairs:?}"
                );
            }
        }
    }

    /// The joints' points coincide, the crank's angle is q, the travel is a distance in the slot.
    #[test]
    fn values_are_those_of_the_mechanism() {
        let mechanism = slotted_rocker(Vec2::ZERO);
        let plan = plan(&mechanism);
        for k in 0..20 {
            let q = -3.0 + 0.3 * f64::from(k);
            let states = states(&plan, q, 2.0);
            assert!((states.angle([BodyId(0), CRANK])[0] - q).abs() < 1e-15);
            assert_eq!(states.angle([BodyId(0), CRANK])[1], 2.0);
            for joint in &mechanism.joints[..3] {
                let gap = states.separation(joint.bodies, joint.points);
                assert!(gap.length < 1e-15);
                assert!(gap.rate.norm() < 1e-14 && gap.acceleration.norm() < 1e-13);
            }
            let slot = &mechanism.joints[3];
            let travel = Coordinate::Travel(JointId(3));
            let measured = Measured::find(&mechanism, travel).unwrap();
            let [length, _, _] = states.measure(Measured::Length {
                bodies: slot.bodies,
                points: slot.points,
            });
            assert!((states.measure(measured)[0] - length).abs() < 1e-15);
        }
    }

    /// The same mechanism elsewhere has the same measures, to the last digits of where it stands.
    #[test]
    fn measures_do_not_depend_on_the_place() {
        let here = slotted_rocker(Vec2::ZERO);
        let place = vec2(8192.0, -4096.0);
        let there = slotted_rocker(place);
        let [one, two] = [&here, &there].map(|m| states(&plan(m), 0.7, 1.3));
        assert_eq!(two.origin() - one.origin(), place);
        for coordinate in &coordinates()[..4] {
            let [a, b] = [(&one, &here), (&two, &there)]
                .map(|(s, m)| s.measure(Measured::find(m, *coordinate).unwrap()));
            // Only the pivots' own coordinates were rounded, at 1e-12 m.
            let off = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-11, "{a:?} {b:?}");
        }
    }

    /// |v t + a t²/2|: what parts leaves with its speed, whatever the direction.
    #[test]
    fn points_that_coincide_part_with_their_speed() {
        let mechanism = slotted_rocker(Vec2::ZERO);
        let plan = plan(&mechanism);
        let states = states(&plan, 0.0, -3.0);
        // A circle of 0.1 m, from its rightmost point.
        let bodies = [BodyId(0), CRANK];
        let points = [vec2(0.1, 0.0), vec2(0.4, 0.1)];
        assert_eq!(states.separation(bodies, points).direction, None);
        let [length, speed, acceleration] = states.measure(Measured::Length { bodies, points });
        assert!(length < 1e-16);
        assert!((speed - 0.3).abs() < 1e-15);
        // Along the path, which is not speeding up.
        assert!(acceleration.abs() < 1e-14);
    }

    #[test]
    fn what_is_not_there_is_not_measured() {
        let mechanism = slotted_rocker(Vec2::ZERO);
        let missing = [
            Coordinate::Angle([BodyId(0), BodyId(4)]),
            Coordinate::Travel(JointId(0)),
            Coordinate::Travel(JointId(9)),
        ];
        for coordinate in missing {
            assert_eq!(Measured::find(&mechanism, coordinate), None);
        }
    }
}
