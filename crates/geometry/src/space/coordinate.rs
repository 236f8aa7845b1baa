//! Coordinates of a mechanism in space beside those of its actuators: angles and travels of joints, and distances.
//!
//! With u the axis of a joint on its first body, n_a and n_b its normals, d = p_b − p_a and ω that of the second body from the first,
//!
//! ```text
//! angle     tan θ = u·(n_a × n_b) / n_a·n_b      θ̇ = u·ω          θ̈ = u·(ω̇_b − ω̇_a)
//! travel    s = u·d                              ṡ = u̇·d + u·ḋ    s̈ = ü·d + 2 u̇·ḋ + u·d̈
//! distance  |d|                                  e·ḋ              e·d̈ + (ḋ·ḋ − (e·ḋ)²) / |d|,   e = d/|d|
//! ```
//!
//! An angle counts whole revolutions: of a joint of the tree by its coordinate, of one that closes a loop by its angles along the
//! range.

use super::frames::BodyMotion;
use super::mechanism::{ActuatorKind, JointKind, Mechanism};
use super::plan::{Plan, Pose};
use super::vector::{Rotation, Vec3};
use crate::mechanism::{BodyId, JointId};
use dwell_numerics::Scalar;
use std::f64::consts::TAU;

/// A coordinate of a mechanism in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate {
    /// The angle of a revolute, cylindrical or helical joint, from the first body's normal to the second's about the axis, rad.
    Angle(JointId),
    /// The travel of a prismatic, cylindrical or helical joint, along the axis from the first point to the second, m.
    Travel(JointId),
    /// The distance of two points (m in the frames of their bodies), m.
    Distance {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each.
        points: [Vec3; 2],
    },
}

impl Coordinate {
    /// Whether it is an angle.
    pub fn is_angle(self) -> bool {
        matches!(self, Self::Angle(_))
    }
}

impl From<ActuatorKind> for Coordinate {
    fn from(kind: ActuatorKind) -> Self {
        match kind {
            ActuatorKind::Angle(joint) => Self::Angle(joint),
            ActuatorKind::Travel(joint) => Self::Travel(joint),
        }
    }
}

/// A [`Coordinate`] of a compiled mechanism. Points and directions are in the [evaluation frames](Plan::frame) of the bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CoordinateFunction {
    /// An angle about an axis.
    Angle {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The axis on the first.
        axis: Vec3,
        /// The direction on each between which it is counted.
        normals: [Vec3; 2],
        /// How its revolutions are counted.
        counting: Counting,
    },
    /// A travel along an axis.
    Travel {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each.
        points: [Vec3; 2],
        /// The axis on the first.
        axis: Vec3,
    },
    /// A distance.
    Distance {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each.
        points: [Vec3; 2],
    },
}

/// How the revolutions of an angle are counted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Counting {
    /// It is a freedom of the tree, or its negative.
    Freedom(usize, f64),
    /// The joint closes a loop: its place among the angles that are stored along the range.
    Stored(usize),
}

/// The angles of a joint that closes a loop at the stored poses, with their revolutions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StoredAngles {
    joint: JointId,
    /// By stored pose.
    angles: Vec<f64>,
}

/// Whether a joint has an angle about its axis, and whether it has a travel along it.
fn has(kind: JointKind) -> [bool; 2] {
    match kind {
        JointKind::Revolute => [true, false],
        JointKind::Prismatic => [false, true],
        JointKind::Cylindrical | JointKind::Helical { .. } => [true, true],
        JointKind::Weld
        | JointKind::Universal
        | JointKind::Spherical
        | JointKind::Planar
        | JointKind::Distance { .. } => [false; 2],
    }
}

impl Plan {
    /// A coordinate of the mechanism of which this plan was compiled.
    ///
    /// # Errors
    /// Why there is no such coordinate.
    pub fn coordinate_function(
        &self,
        mechanism: &Mechanism,
        coordinate: Coordinate,
    ) -> Result<CoordinateFunction, &'static str> {
        let unknown = "the mechanism does not have its coordinate";
        let in_frame = |body: BodyId, point: Vec3| {
            let inverse = self.tree.internal[body.0].inverse();
            inverse.position + inverse.rotation.apply(point)
        };
        if let Coordinate::Distance { bodies, points } = coordinate {
            if bodies.iter().any(|b| b.0 >= mechanism.bodies.len()) {
                return Err(unknown);
            }
            let points = [0, 1].map(|k| in_frame(bodies[k], points[k]));
            return Ok(CoordinateFunction::Distance { bodies, points });
        }
        let (Coordinate::Angle(id) | Coordinate::Travel(id)) = coordinate else {
            return Err(unknown);
        };
        let joint = mechanism.joints.get(id.0).ok_or(unknown)?;
        let [has_angle, has_travel] = has(joint.kind);
        let bodies = joint.bodies;
        let sides = [0, 1].map(|k| joint.sides[k].in_frame(&self.tree.internal[bodies[k].0]));
        let axis = sides[0].axis;
        match coordinate.is_angle() {
            true if has_angle => Ok(CoordinateFunction::Angle {
                bodies,
                axis,
                normals: sides.map(|side| side.normal),
                counting: self.counting(id)?,
            }),
            false if has_travel => Ok(CoordinateFunction::Travel {
                bodies,
                points: sides.map(|side| side.point),
                axis,
            }),
            true => Err("its joint has no angle about an axis"),
            false => Err("its joint has no travel along an axis"),
        }
    }

    /// How the revolutions of a joint are counted.
    fn counting(&self, joint: JointId) -> Result<Counting, &'static str> {
        if let Some((freedom, sign)) = self.tree.driven(ActuatorKind::Angle(joint)) {
            return Ok(Counting::Freedom(freedom, sign));
        }
        let stored = self.closure_angles.iter().position(|s| s.joint == joint);
        stored.map(Counting::Stored).ok_or(
            "its joint closes a loop of a mechanism with several coordinates, where its revolutions are not counted",
        )
    }

    /// Stores the angles of the joints that close loops along the range of one coordinate.
    pub(super) fn store_closure_angles(&mut self, mechanism: &Mechanism) {
        let closing = self.closures.iter().filter_map(|closure| closure.joint);
        let with_angle: Vec<JointId> = closing
            .filter(|joint| has(mechanism.joints[joint.0].kind)[0])
            .collect();
        if self.actuators() != 1 || with_angle.is_empty() {
            return;
        }
        let mut pose = self.pose::<f64>();
        let mut stored: Vec<StoredAngles> = with_angle
            .iter()
            .map(|&joint| StoredAngles {
                joint,
                angles: Vec::with_capacity(self.nodes.len()),
            })
            .collect();
        for node in &self.nodes {
            self.start_from(node, 0.0, &mut pose);
            let closed = self.close(&[node.q], &mut pose).is_ok();
            for StoredAngles { joint, angles } in &mut stored {
                let joint = &mechanism.joints[joint.0];
                let side = |k: usize| joint.sides[k].in_frame(&self.tree.internal[joint.bodies[k].0]);
                let (first, second) = (side(0), side(1));
                let last = angles.last().copied();
                let angle = self.wrapped_angle(&pose, joint.bodies, first.axis, [first.normal, second.normal]);
                angles.push(match last {
                    // A stored pose closes; were it not so, the angle before it is nearest.
                    Some(last) if !closed => last,
                    Some(last) => near(angle, last),
                    None => angle,
                });
            }
        }
        self.closure_angles = stored;
    }

    /// An angle without its revolutions, from −π to π.
    #[inline(always)]
    fn wrapped_angle<T: Scalar>(
        &self,
        pose: &Pose<T>,
        bodies: [BodyId; 2],
        axis: Vec3,
        normals: [Vec3; 2],
    ) -> T {
        let rotation = |k: usize| &pose.frames[bodies[k].0].rotation;
        let turned = |rotation: &Rotation<T>, v: Vec3| rotation.apply(v.cast());
        let [first, second] = [0, 1].map(|k| turned(rotation(k), normals[k]));
        let across = turned(rotation(0), axis.cross(normals[0]));
        second.dot(across).atan2(second.dot(first))
    }

    /// The revolutions that a stored quantity gains by whole periods of the coordinate; `ends` are its values at the ends of the range.
    #[inline(always)]
    fn gained(&self, pose_q: f64, ends: [f64; 2]) -> f64 {
        match self.range.period() {
            Some(period) => {
                let periods = ((pose_q - self.nodes[0].q) / period).floor();
                periods * (ends[1] - ends[0])
            }
            None => 0.0,
        }
    }

    /// The first coordinate at a pose.
    #[inline(always)]
    fn first_coordinate<T: Scalar>(&self, pose: &Pose<T>) -> f64 {
        let driver = self.drivers.first();
        driver.map_or(0.0, |&(freedom, sign)| pose.coordinates[freedom].value() * sign)
    }

    /// The value of an angle with its revolutions.
    #[inline(always)]
    fn counted_angle<T: Scalar>(
        &self,
        pose: &Pose<T>,
        bodies: [BodyId; 2],
        (axis, normals): (Vec3, [Vec3; 2]),
        counting: Counting,
    ) -> T {
        match counting {
            Counting::Freedom(freedom, sign) => {
                let value = pose.coordinates[freedom] * T::from_f64(sign);
                if self.drivers.iter().any(|(driver, _)| *driver == freedom) {
                    return value;
                }
                let [first, last] = [self.nodes.first(), self.nodes.last()]
                    .map(|node| node.map_or(0.0, |n| n.coordinates[freedom][0] * sign));
                value + T::from_f64(self.gained(self.first_coordinate(pose), [first, last]))
            }
            Counting::Stored(index) => {
                let wrapped = self.wrapped_angle(pose, bodies, axis, normals);
                let angles = &self.closure_angles[index].angles;
                let q = self.first_coordinate(pose);
                let expected = self.stored_near(q, angles);
                let turns = ((expected - wrapped.value()) / TAU).round();
                wrapped + T::from_revolutions(turns)
            }
        }
    }

    /// A stored quantity near a coordinate, by straight lines.
    fn stored_near(&self, q: f64, values: &[f64]) -> f64 {
        let (Some(first), Some(last)) = (values.first(), values.last()) else {
            return 0.0;
        };
        let gained = self.gained(q, [*first, *last]);
        let within = self.within_range(q).unwrap_or(q);
        let next = self.nodes.partition_point(|n| n.q < within);
        let (before, after) = (next.max(1) - 1, next.min(values.len() - 1));
        let [from, to] = [before, after].map(|k| self.nodes[k].q);
        let part = if to > from {
            ((within - from) / (to - from)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        gained + values[before] + part * (values[after] - values[before])
    }

    /// A coordinate with its rate and its acceleration, rad or m, per s and s²; the last after [`Plan::accelerations`].
    #[inline]
    pub fn coordinate<T: Scalar>(&self, pose: &Pose<T>, of: CoordinateFunction) -> [T; 3] {
        match of {
            CoordinateFunction::Angle {
                bodies,
                axis,
                normals,
                counting,
            } => {
                let value = self.counted_angle(pose, bodies, (axis, normals), counting);
                let [a, b] = bodies.map(|body| &pose.states[body.0]);
                let axis = pose.frames[bodies[0].0].rotation.apply(axis.cast());
                let rate = axis.dot(b.angular_velocity - a.angular_velocity);
                let acceleration = axis.dot(b.angular_acceleration - a.angular_acceleration);
                [value, rate, acceleration]
            }
            CoordinateFunction::Travel {
                bodies,
                points,
                axis,
            } => {
                let [d, first, second] = self.separation(pose, bodies, points);
                let frame = &pose.frames[bodies[0].0];
                let axis = frame.rotation.apply(axis.cast());
                let state: &BodyMotion<T> = &pose.states[bodies[0].0];
                let (turning, turning_rate) = state.direction_derivatives(axis);
                let two = T::from_f64(2.0);
                [
                    axis.dot(d),
                    turning.dot(d) + axis.dot(first),
                    turning_rate.dot(d) + two * turning.dot(first) + axis.dot(second),
                ]
            }
            CoordinateFunction::Distance { bodies, points } => {
                let [d, first, second] = self.separation(pose, bodies, points);
                let length = d.dot(d).sqrt();
                let rate = d.dot(first) / length;
                let across = first.dot(first) - rate * rate;
                [length, rate, (d.dot(second) + across) / length]
            }
        }
    }

    /// The vector from a point of one body to one of another, with its first and second derivatives. Points are in the evaluation frames.
    #[inline]
    pub fn separation<T: Scalar>(
        &self,
        pose: &Pose<T>,
        bodies: [BodyId; 2],
        points: [Vec3; 2],
    ) -> [Vec3<T>; 3] {
        let at = |k: usize| {
            let (frame, state) = (&pose.frames[bodies[k].0], &pose.states[bodies[k].0]);
            let arm = frame.rotation.apply(points[k].cast());
            let velocity = state.point_velocity(arm);
            [frame.origin + arm, velocity, state.point_acceleration(arm)]
        };
        let ([a, a1, a2], [b, b1, b2]) = (at(0), at(1));
        [b - a, b1 - a1, b2 - a2]
    }
}

/// An angle that differs by whole revolutions, nearest to another.
fn near(angle: f64, to: f64) -> f64 {
    angle + TAU * ((to - angle) / TAU).round()
}
