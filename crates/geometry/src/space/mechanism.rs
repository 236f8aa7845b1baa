//! The description of a mechanism in space. Lengths in m, angles in rad.

use super::coordinate::Coordinate;
use super::frames::Frame;
use super::joint_kinds::{Condition, JointKind};
use super::vector::{Vec3, vec3};
use crate::mechanism::{Body, BodyId, Coupling, JointId};

/// A mechanism in space. Points and directions are given in the frame of the body they belong to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mechanism {
    /// Every body, the ground among them.
    pub bodies: Vec<Body>,
    /// Index of the fixed body.
    pub ground: usize,
    /// Every joint.
    pub joints: Vec<Joint>,
    /// Every actuator: one independent coordinate each.
    pub actuators: Vec<Actuator>,
    /// The couplings of the joints of kind [`JointKind::Coupling`].
    pub couplings: Vec<Coupling<Coordinate>>,
}

/// A joint between two bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// The name a message and a reaction use.
    pub name: String,
    /// The first and the second body; a reaction is the force and moment of the first on the second.
    pub bodies: [BodyId; 2],
    /// Its kind, which determines the allowed relative motion.
    pub kind: JointKind,
    /// The joint on each body.
    pub sides: [Side; 2],
}

/// A joint on one of its bodies: its point (m) and two directions at right angles, unit vectors, in the frame of the body; for a
/// gear pair, in the frame of the carrier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side<C = f64> {
    /// The joint's point.
    pub point: Vec3<C>,
    /// Its axis; for a planar joint, the normal of the plane. Spherical joints and distances ignore it.
    pub axis: Vec3<C>,
    /// The direction from which its angle is counted.
    pub normal: Vec3<C>,
}

/// The numbers of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointNumbers<C = f64> {
    /// The joint on each body.
    pub sides: [Side<C>; 2],
    /// The pitch of a helical joint, m/rad, or the length of a distance, m; zero of other joints.
    pub number: C,
}

impl Default for Side {
    fn default() -> Self {
        Self {
            point: Vec3::ZERO,
            axis: Vec3::AXES[2],
            normal: Vec3::AXES[0],
        }
    }
}

impl Joint {
    /// Its numbers.
    pub fn numbers(&self) -> JointNumbers {
        let number = match self.kind {
            JointKind::Helical { pitch } => pitch,
            JointKind::Distance { length } => length,
            _ => 0.0,
        };
        JointNumbers {
            sides: self.sides,
            number,
        }
    }

    /// The body in whose frame a side is given.
    pub fn side_body(&self, side: usize) -> BodyId {
        if let JointKind::Gear { carrier } = self.kind {
            return carrier;
        }
        self.bodies[side]
    }

    /// A joint between two bodies, by their numbers. Directions become unit vectors, and the normal the part of it at right
    /// angles to the axis; if that is zero, any direction at right angles. A direction of length zero is kept, and
    /// compiling rejects it.
    pub fn new(
        name: impl Into<String>,
        bodies: [impl Into<BodyId>; 2],
        kind: JointKind,
        sides: [Side; 2],
    ) -> Self {
        let orthonormal = |side: Side| {
            let Some(axis) = side.axis.unit() else {
                return side;
            };
            let part = side.normal - axis.scaled(axis.dot(side.normal));
            let off_axis = part.norm() > 1e-9 * side.normal.norm();
            let normal = part
                .unit()
                .filter(|_| off_axis)
                .unwrap_or_else(|| axis.any_normal());
            Side {
                axis,
                normal,
                ..side
            }
        };
        Self {
            name: name.into(),
            bodies: bodies.map(Into::into),
            kind,
            sides: sides.map(orthonormal),
        }
    }
}

/// An independent coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Actuator {
    /// The name of the coordinate.
    pub name: String,
    /// The coordinate that it drives.
    pub kind: ActuatorKind,
}

/// The kind of coordinate that an actuator drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActuatorKind {
    /// The angle of a revolute, cylindrical or helical joint, from the first body's normal to the second's about the axis, rad.
    Angle(JointId),
    /// The travel of a joint whose second point is on the axis of the first, along that axis from the first point, m.
    Travel(JointId),
    /// The length of a distance, m.
    Length(JointId),
}

impl ActuatorKind {
    /// The joint that is driven.
    pub fn joint(self) -> JointId {
        match self {
            Self::Angle(joint) | Self::Travel(joint) | Self::Length(joint) => joint,
        }
    }

    /// Whether joints of a kind have such a coordinate.
    pub fn is_of(self, kind: JointKind) -> bool {
        match self {
            Self::Angle(_) => kind.has_angle(),
            Self::Travel(_) => kind.has_travel(),
            Self::Length(_) => kind.holds(Condition::Length),
        }
    }
}

impl Actuator {
    /// The angle of a joint, by its number.
    pub fn angle(name: impl Into<String>, joint: usize) -> Self {
        Self {
            name: name.into(),
            kind: ActuatorKind::Angle(JointId(joint)),
        }
    }

    /// The travel of a joint, by its number.
    pub fn travel(name: impl Into<String>, joint: usize) -> Self {
        Self {
            name: name.into(),
            kind: ActuatorKind::Travel(JointId(joint)),
        }
    }

    /// The length of a distance, by the number of the joint.
    pub fn length(name: impl Into<String>, joint: usize) -> Self {
        Self {
            name: name.into(),
            kind: ActuatorKind::Length(JointId(joint)),
        }
    }
}

/// Position and orientation of a body: its frame in that of the ground.
pub type Placement = Frame<f64>;

/// Where a mechanism is assembled: the coordinates, and approximately where the bodies are.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Assembly {
    /// By actuator: its coordinate, rad or m.
    pub q: Vec<f64>,
    /// The approximate placement of each body. Bodies beyond the end of the list coincide with the ground's frame.
    pub placements: Vec<Placement>,
}

impl Assembly {
    /// At these coordinates, with every body's frame near that of the ground.
    pub fn at(q: &[f64]) -> Self {
        Self {
            q: q.to_vec(),
            placements: Vec::new(),
        }
    }

    /// Roughly where a body is.
    pub(super) fn placement(&self, body: usize) -> Placement {
        self.placements.get(body).copied().unwrap_or_default()
    }
}

impl Mechanism {
    /// A length of the order of the mechanism: the largest distance between two joints' points on one body, m.
    pub fn size(&self) -> f64 {
        let mut size = 0.0_f64;
        let by = |of: fn(f64, f64) -> f64, a: Vec3, b: Vec3| {
            vec3(of(a.x, b.x), of(a.y, b.y), of(a.z, b.z))
        };
        let mut boxes = vec![None; self.bodies.len()];
        for joint in &self.joints {
            for (k, side) in joint.sides.iter().enumerate() {
                let body = joint.side_body(k);
                let Some(corners) = boxes.get_mut(body.0) else {
                    continue;
                };
                let [low, high] = corners.get_or_insert([side.point; 2]);
                *low = by(f64::min, *low, side.point);
                *high = by(f64::max, *high, side.point);
                size = size.max((*high - *low).norm());
            }
            if let JointKind::Distance { length } = joint.kind {
                size = size.max(length.abs());
            }
        }
        if size > 0.0 { size } else { 1.0 }
    }

    /// Whether an actuator drives a joint.
    pub(super) fn is_driven(&self, joint: JointId) -> bool {
        self.actuators.iter().any(|a| a.kind.joint() == joint)
    }

    /// The inconsistency in the description of a joint, if there is any.
    fn joint_fault(&self, j: usize, joint: &Joint) -> Option<&'static str> {
        if joint.bodies.iter().any(|b| b.0 >= self.bodies.len()) {
            return Some("a joint refers to a body that does not exist");
        }
        if joint.bodies[0] == joint.bodies[1] {
            return Some("a joint connects a body with itself");
        }
        if let JointKind::Gear { carrier } = joint.kind
            && (carrier.0 >= self.bodies.len() || joint.bodies.contains(&carrier))
        {
            return Some("the carrier of a gear pair is not a third body");
        }
        if let JointKind::Coupling { index, .. } = joint.kind
            && let Some(fault) = self.coupling_fault(index)
        {
            return Some(fault);
        }
        let finite = |s: &Side| s.point.is_finite() && s.axis.is_finite() && s.normal.is_finite();
        let number = match joint.kind {
            JointKind::Helical { pitch } => pitch.is_finite(),
            JointKind::Distance { length } => {
                self.is_driven(JointId(j)) || length.is_finite() && length > 0.0
            }
            _ => true,
        };
        let square = |s: &Side| {
            let off = [
                s.axis.norm() - 1.0,
                s.normal.norm() - 1.0,
                s.axis.dot(s.normal),
            ];
            off.iter().all(|o| o.abs() < 1e-9)
        };
        if !joint.sides.iter().all(square) {
            return Some("a joint's axis and normal are not unit vectors at right angles");
        }
        if !(joint.sides.iter().all(finite) && number) {
            return Some(
                "a joint has a number that is not finite, or a length that is not positive",
            );
        }
        None
    }

    /// The inconsistency in the description, if there is any.
    pub(super) fn fault(&self) -> Option<&'static str> {
        if self.ground >= self.bodies.len() {
            return Some("there is no ground");
        }
        let mut joints = self.joints.iter().enumerate();
        if let Some(fault) = joints.find_map(|(j, joint)| self.joint_fault(j, joint)) {
            return Some(fault);
        }
        let drives = |a: &Actuator| {
            let joint = self.joints.get(a.kind.joint().0);
            joint.is_some_and(|joint| a.kind.is_of(joint.kind))
        };
        // Of a screw the travel is the angle.
        let coordinate = |i: usize| {
            let kind = self.actuators[i].kind;
            match self.joints[kind.joint().0].kind {
                JointKind::Helical { .. } => ActuatorKind::Angle(kind.joint()),
                _ => kind,
            }
        };
        let driven_twice = |i: usize| (0..i).any(|k| coordinate(k) == coordinate(i));
        if !self.actuators.iter().all(drives) {
            return Some("an actuator drives a joint that has no such coordinate");
        }
        (0..self.actuators.len())
            .any(driven_twice)
            .then_some("two actuators drive the same coordinate")
    }
}
