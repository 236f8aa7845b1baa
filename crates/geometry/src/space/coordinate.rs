//! Coordinates of a mechanism in space other than those of its actuators: angles and travels of joints, and distances.
//!
//! With u the axis of a joint on its first body, n_a and n_b its normals, d = p_b − p_a and ω that of the second body from the first,
//!
//! ```text
//! angle     tan θ = u·(n_a × n_b) / n_a·n_b      θ̇ = u·ω          θ̈ = u·(ω̇_b − ω̇_a)
//! travel    s = u·d                              ṡ = u̇·d + u·ḋ    s̈ = ü·d + 2 u̇·ḋ + u·d̈
//! distance  |d|                                  e·ḋ              e·d̈ + (ḋ·ḋ − (e·ḋ)²) / |d|,   e = d/|d|
//! ```
//!
//! An angle counts whole revolutions. For a joint of the tree they follow from its coordinate, for a joint that closes a loop from
//! its angles along the range.

use super::closure::RowKind;
use super::frames::BodyMotion;
use super::mechanism::{ActuatorKind, Joint, JointNumbers, Mechanism};
use super::plan::{Plan, Pose};
use super::tree::FreedomKind;
use super::vector::{Rotation, Vec3};
use crate::mechanism::{BodyId, Guide, JointId};
use dwell_numerics::{Constant, Lift};
use std::f64::consts::TAU;

/// A coordinate of a mechanism in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate<C = f64> {
    /// The angle of a revolute, cylindrical or helical joint, from the first body's normal to the second's about the axis, rad.
    Angle(JointId),
    /// The travel of a joint whose second point is on the axis of the first, along that axis from the first point, m.
    Travel(JointId),
    /// The distance of two points (m in the frames of their bodies), m.
    Distance {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each.
        points: [Vec3<C>; 2],
    },
}

impl<C: Copy> Coordinate<C> {
    /// Whether it is an angle.
    pub fn is_angle(self) -> bool {
        matches!(self, Self::Angle(_))
    }
}

impl ActuatorKind {
    /// The coordinate that it drives, of this joint.
    pub fn coordinate(self, joint: &Joint) -> Coordinate {
        match self {
            Self::Angle(id) => Coordinate::Angle(id),
            Self::Travel(id) => Coordinate::Travel(id),
            Self::Length(_) => Coordinate::Distance {
                bodies: joint.bodies,
                points: joint.sides.map(|side| side.point),
            },
        }
    }
}

/// A [`Coordinate`] of a compiled mechanism. Points and directions are in the [evaluation frames](Plan::frame) of the bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CoordinateFunction<C = f64> {
    /// An angle about an axis.
    Angle {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The axis on the first.
        axis: Vec3<C>,
        /// The direction on each between which it is counted.
        normals: [Vec3<C>; 2],
        /// How its revolutions are counted.
        counting: Counting,
    },
    /// A travel along an axis.
    Travel(Guide<Vec3<C>>),
    /// A distance.
    Distance {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each.
        points: [Vec3<C>; 2],
    },
}

/// Stored angles of a revolution, or of a stroke of the size of the mechanism.
const ANGLES_PER_UNIT: f64 = 256.0;

/// How the revolutions of an angle are counted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Counting {
    /// It is a freedom of the tree, or its negative.
    Freedom(usize, f64),
    /// The joint closes a loop: its place among the angles that are stored along the range.
    Stored(usize),
    /// Revolutions are not counted: the value is between −π and π. A force along the coordinate needs only its axis.
    None,
}

/// Whether the revolutions of an angle have to be counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CountedRevolutions {
    /// They are.
    Always,
    /// They are where that is possible: of a coordinate along which something acts, or whose rate alone is needed.
    IfPossible,
}

/// The angles of a joint that closes a loop, with their revolutions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StoredAngles {
    joint: JointId,
    /// At equally spaced coordinates of the range.
    angles: Vec<f64>,
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
        let numbers = |joint: JointId| mechanism.joints[joint.0].numbers();
        self.function_of(mechanism, numbers, coordinate, CountedRevolutions::Always)
    }

    /// A coordinate along which something acts, or whose rate alone is needed: the revolutions of an angle are counted if possible.
    ///
    /// # Errors
    /// Why there is no such coordinate.
    pub fn direction_function(
        &self,
        mechanism: &Mechanism,
        coordinate: Coordinate,
    ) -> Result<CoordinateFunction, &'static str> {
        let numbers = |joint: JointId| mechanism.joints[joint.0].numbers();
        self.function_of(
            mechanism,
            numbers,
            coordinate,
            CountedRevolutions::IfPossible,
        )
    }

    /// Stores the angles that count revolutions along the range of one coordinate.
    pub(super) fn count_revolutions(&mut self, mechanism: &Mechanism) {
        let (1, Some([first, last])) = (self.actuators(), self.predictions.range()) else {
            return;
        };
        let mut pose = self.pose::<f64>();
        let at = |q: f64, pose: &mut Pose| {
            if let Some(at) = self.predictions.at(q) {
                self.predictions.predict(at, pose);
            }
            self.close(&[q], None, pose).is_ok()
        };
        let mut ends = [Vec::new(), Vec::new()];
        for (end, q) in ends.iter_mut().zip([first, last]) {
            at(q, &mut pose);
            end.clone_from(&pose.coordinates);
        }
        let closing = self.closures.iter().filter_map(|closure| closure.joint);
        let angles = closing.filter(|joint| mechanism.joints[joint.0].kind.has_angle());
        let mut stored: Vec<StoredAngles> = angles
            .map(|joint| StoredAngles {
                joint,
                angles: Vec::new(),
            })
            .collect();
        let unit = if self.is_angle(0) { TAU } else { self.size };
        let count = if stored.is_empty() {
            0
        } else {
            ((last - first) / unit * ANGLES_PER_UNIT).ceil().max(1.0) as usize
        };
        for k in 0..=count {
            let q = first + (last - first) * (k as f64 / count.max(1) as f64);
            let closed = at(q, &mut pose);
            for StoredAngles { joint, angles } in &mut stored {
                let joint = &mechanism.joints[joint.0];
                let [a, b] =
                    [0, 1].map(|k| joint.sides[k].in_frame(&self.tree.internal[joint.bodies[k].0]));
                let angle = self.wrapped_angle(&pose, joint.bodies, a.axis, [a.normal, b.normal]);
                angles.push(match angles.last() {
                    // Along the range every pose closes; were it not so, the angle before it is nearest.
                    Some(&last) if !closed => last,
                    Some(&last) => angle + TAU * ((last - angle) / TAU).round(),
                    None => angle,
                });
            }
        }
        let gains = ends[1].iter().zip(&ends[0]).map(|(b, a)| b - a);
        self.freedom_gains = gains.collect();
        self.geared = self.find_geared();
        self.closure_angles = stored;
    }

    /// The freedoms on the paths of gear pairs and couplings that no actuator moves; where the pose does not repeat all that gain.
    fn find_geared(&self) -> Vec<usize> {
        let counts = |kinds: &[RowKind]| matches!(kinds, [RowKind::Mesh(_) | RowKind::Coupled(..)]);
        let gears = self.closures.iter().filter(|c| counts(&c.kinds));
        let on_paths = gears.flat_map(|gear| gear.path.iter().map(|(freedom, _)| *freedom));
        let is_driven = |f: &usize| self.drivers.iter().any(|driver| driver.freedom == *f);
        let gains = |f: &usize| {
            let is_number = self.tree.freedoms[*f] != FreedomKind::BallTurn;
            self.repetition.is_some() && is_number && self.freedom_gains[*f] != 0.0
        };
        let gaining = (0..self.tree.freedoms.len()).filter(gains);
        let counted = on_paths.chain(gaining).filter(|f| !is_driven(f));
        let mut geared: Vec<usize> = counted.collect();
        geared.sort_unstable();
        geared.dedup();
        geared
    }
}

impl<C: Constant> Plan<C> {
    /// A coordinate of the mechanism with these numbers of its joints.
    ///
    /// # Errors
    /// Why there is no such coordinate.
    pub fn function_of(
        &self,
        mechanism: &Mechanism,
        numbers: impl Fn(JointId) -> JointNumbers<C>,
        coordinate: Coordinate<C>,
        revolutions: CountedRevolutions,
    ) -> Result<CoordinateFunction<C>, &'static str> {
        let unknown = "the mechanism does not have its coordinate";
        let in_frame = |body: BodyId, point| self.tree.internal[body.0].inner_point(point);
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
        let bodies = joint.bodies;
        let of_joint = numbers(id);
        let sides = [0, 1].map(|k| of_joint.sides[k].in_frame(&self.tree.internal[bodies[k].0]));
        let axis = sides[0].axis;
        if coordinate.is_angle() {
            if !joint.kind.has_angle() {
                return Err("its joint has no angle about an axis");
            }
            return Ok(CoordinateFunction::Angle {
                bodies,
                axis,
                normals: sides.map(|side| side.normal),
                counting: match (self.counting(id), revolutions) {
                    (Err(_), CountedRevolutions::IfPossible) => Counting::None,
                    (counting, _) => counting?,
                },
            });
        }
        if !joint.kind.has_travel() {
            return Err("its joint has no travel along an axis");
        }
        Ok(CoordinateFunction::Travel(Guide {
            bodies,
            points: sides.map(|side| side.point),
            axis,
        }))
    }

    /// How the revolutions of a joint are counted.
    fn counting(&self, joint: JointId) -> Result<Counting, &'static str> {
        if let Some(driver) = self.tree.driven(ActuatorKind::Angle(joint)) {
            return Ok(Counting::Freedom(driver.freedom, driver.factor.value()));
        }
        let stored = self.closure_angles.iter().position(|s| s.joint == joint);
        stored.map(Counting::Stored).ok_or(
            "its joint closes a loop of a mechanism with several coordinates, where its revolutions are not counted",
        )
    }

    /// An angle without its revolutions, from −π to π.
    #[inline(always)]
    fn wrapped_angle<T: Lift<C>>(
        &self,
        pose: &Pose<T>,
        bodies: [BodyId; 2],
        axis: Vec3<C>,
        normals: [Vec3<C>; 2],
    ) -> T {
        let rotation = |k: usize| &pose.frames[bodies[k].0].rotation;
        let turned = |rotation: &Rotation<T>, v: Vec3<C>| rotation.apply(v.cast());
        let [first, second] = [0, 1].map(|k| turned(rotation(k), normals[k]));
        let across = turned(rotation(0), axis.cross(normals[0]));
        second.dot(across).atan2(second.dot(first))
    }

    /// The whole periods of the only coordinate from the first stored pose.
    #[inline(always)]
    pub(super) fn periods(&self, q: f64) -> f64 {
        match (self.period(), self.predictions.range()) {
            (Some(period), Some([first, _])) => ((q - first) / period).floor(),
            _ => 0.0,
        }
    }

    /// The first coordinate at a pose.
    #[inline(always)]
    fn first_coordinate<T: Lift<C>>(&self, pose: &Pose<T>) -> f64 {
        let driver = self.drivers.first();
        driver.map_or(0.0, |driver| {
            pose.coordinates[driver.freedom].value() / driver.factor.value()
        })
    }

    /// The value of an angle with its revolutions.
    #[inline(always)]
    fn counted_angle<T: Lift<C>>(
        &self,
        pose: &Pose<T>,
        bodies: [BodyId; 2],
        axis: Vec3<C>,
        normals: [Vec3<C>; 2],
        counting: Counting,
    ) -> T {
        match counting {
            Counting::Freedom(freedom, sign) => {
                let value = pose.coordinates[freedom] * T::from_f64(sign);
                // Coordinates that actuators and teeth move count all periods themselves.
                let is_driven = self.drivers.iter().any(|driver| driver.freedom == freedom);
                if is_driven || self.geared.contains(&freedom) {
                    return value;
                }
                let gain = self.freedom_gains.get(freedom).copied().unwrap_or(0.0);
                value + T::from_f64(self.periods(self.first_coordinate(pose)) * gain * sign)
            }
            Counting::None => self.wrapped_angle(pose, bodies, axis, normals),
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

    /// A stored angle near a coordinate, by straight lines.
    fn stored_near(&self, q: f64, angles: &[f64]) -> f64 {
        let (Some([from, to]), [first, .., last]) = (self.predictions.range(), angles) else {
            return angles.first().copied().unwrap_or(0.0);
        };
        let within = self.within_range(q).unwrap_or(q);
        let intervals = (angles.len() - 1) as f64;
        let at = ((within - from) / (to - from) * intervals).clamp(0.0, intervals);
        let k = (at as usize).min(angles.len() - 2);
        let part = at - k as f64;
        let here = angles[k] + part * (angles[k + 1] - angles[k]);
        here + self.periods(q) * (last - first)
    }

    /// The rate of a coordinate, rad/s or m/s: without the value of an angle.
    #[inline]
    pub fn coordinate_rate<T: Lift<C>>(&self, pose: &Pose<T>, of: CoordinateFunction<C>) -> T {
        match of {
            CoordinateFunction::Angle { bodies, axis, .. } => {
                let [a, b] = bodies.map(|body| pose.motion.states[body.0].angular_velocity);
                let axis = pose.frames[bodies[0].0].rotation.apply(axis.cast());
                axis.dot(b - a)
            }
            CoordinateFunction::Travel { .. } | CoordinateFunction::Distance { .. } => {
                self.coordinate(pose, of)[1]
            }
        }
    }

    /// A coordinate with its rate and its acceleration, rad or m, per s and s²; the last after [`Plan::accelerations`].
    #[inline]
    pub fn coordinate<T: Lift<C>>(&self, pose: &Pose<T>, of: CoordinateFunction<C>) -> [T; 3] {
        match of {
            CoordinateFunction::Angle {
                bodies,
                axis,
                normals,
                counting,
            } => {
                let value = self.counted_angle(pose, bodies, axis, normals, counting);
                let [a, b] = bodies.map(|body| &pose.motion.states[body.0]);
                let axis = pose.frames[bodies[0].0].rotation.apply(axis.cast());
                let rate = axis.dot(b.angular_velocity - a.angular_velocity);
                let acceleration = axis.dot(b.angular_acceleration - a.angular_acceleration);
                [value, rate, acceleration]
            }
            CoordinateFunction::Travel(guide) => {
                let [d, first, second] = self.separation(pose, guide.bodies, guide.points);
                let body = guide.bodies[0].0;
                let axis = pose.frames[body].rotation.apply(guide.axis.cast());
                let state: &BodyMotion<T> = &pose.motion.states[body];
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
    pub fn separation<T: Lift<C>>(
        &self,
        pose: &Pose<T>,
        bodies: [BodyId; 2],
        points: [Vec3<C>; 2],
    ) -> [Vec3<T>; 3] {
        let at = |k: usize| {
            let (frame, state) = (&pose.frames[bodies[k].0], &pose.motion.states[bodies[k].0]);
            let arm = frame.rotation.apply(points[k].cast());
            let velocity = state.point_velocity(arm);
            [
                frame.position + arm,
                velocity,
                state.point_acceleration(arm),
            ]
        };
        let ([a, a1, a2], [b, b1, b2]) = (at(0), at(1));
        [b - a, b1 - a1, b2 - a2]
    }
}
