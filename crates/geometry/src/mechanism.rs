//! The description of a mechanism: bodies, the joints between them, and the actuators
//! whose coordinates are the independent ones. Lengths in m, angles in rad.

mod guessed_length;
mod joint_kind;
mod parts;
mod size;

pub use joint_kind::{BranchHint, Component, Condition, JointKind};

use crate::plane::Vec2;
use dwell_laws::Law;

/// Index of a body in [`Mechanism::bodies`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BodyId(pub usize);

/// Index of a joint in [`Mechanism::joints`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JointId(pub usize);

/// Index of an actuator in [`Mechanism::actuators`], and of its coordinate q.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ActuatorId(pub usize);

/// A planar mechanism. Points and axes are given in the frame of the body they belong to; the
/// frame of the ground is the frame of the plane.
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
    pub couplings: Vec<Coupling>,
}

/// A rigid body, known to geometry by its name alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// The name a message uses.
    pub name: String,
}

/// A joint between two bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// The name a message and a reaction use.
    pub name: String,
    /// The first and the second body; a reaction is the force or moment of the first on the second.
    pub bodies: [BodyId; 2],
    /// The joint's point on each body, in that body's frame, in m.
    pub points: [Vec2; 2],
    /// Its kind, which determines the allowed relative motion.
    pub kind: JointKind,
}

/// The line along which a joint slides, in the plane or in [space](crate::space).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guide<V = Vec2> {
    /// The joint's bodies.
    pub bodies: [BodyId; 2],
    /// Its point on each body, in that body's frame, m.
    pub points: [V; 2],
    /// Unit vector t of its axis in the first body's frame.
    pub axis: V,
}

/// A coordinate of a mechanism that can be measured, driven, or coupled to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate {
    /// Angle of the second body's frame from the first's, rad, whole revolutions counted.
    Angle([BodyId; 2]),
    /// Travel of a prismatic joint or a slot: t·(P₂ − P₁), m.
    Travel(JointId),
    /// Distance of two points, each in the frame of its body, m; never negative.
    Length {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each.
        points: [Vec2; 2],
    },
}

impl Coordinate {
    /// Whether it is an angle (rad) rather than a length (m).
    pub fn is_angle(self) -> bool {
        matches!(self, Self::Angle(_))
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        if self.is_angle() { "rad" } else { "m" }
    }

    /// Unit of the moment or force along it.
    pub fn force_unit(self) -> &'static str {
        if self.is_angle() { "N m" } else { "N" }
    }
}

/// Two coupled coordinates, in the plane or in space: `dependent` = law(`independent`). The joint's two bodies are those of `dependent`.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupling<K = Coordinate> {
    /// The coordinate that is a function of the other.
    pub dependent: K,
    /// The argument of the law.
    pub independent: K,
    /// The function, SI.
    pub law: Law,
}

/// An actuator: it imposes one independent coordinate q.
#[derive(Debug, Clone, PartialEq)]
pub struct Actuator {
    /// The name of the actuator and of its coordinate.
    pub name: String,
    /// The first and the second body: the actuator force τ is that of the first on the second.
    pub bodies: [BodyId; 2],
    /// Which of their coordinates it drives.
    pub kind: ActuatorKind,
}

/// The coordinate that an actuator drives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ActuatorKind {
    /// The angle of the second body's frame from the first's; τ is a couple, N·m.
    #[default]
    Angle,
    /// The travel of a prismatic joint or slot between the two bodies; τ is a force along its axis, N.
    Travel(JointId),
    /// The distance of two points, one on each body; τ is a force along their line, positive when
    /// it pushes them apart, N.
    Length([Vec2; 2]),
}

impl Actuator {
    /// The coordinate it drives.
    pub fn coordinate(&self) -> Coordinate {
        match self.kind {
            ActuatorKind::Angle => Coordinate::Angle(self.bodies),
            ActuatorKind::Travel(joint) => Coordinate::Travel(joint),
            ActuatorKind::Length(points) => Coordinate::Length {
                bodies: self.bodies,
                points,
            },
        }
    }
}

/// A reaction component of a named joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Reaction {
    /// The joint.
    pub joint: JointId,
    /// The component.
    pub component: Component,
}

impl Mechanism {
    /// Every reaction component of every joint: the joints in order, each with its components
    /// in the order of [`Mechanism::components`]. "Reaction k" everywhere means this order.
    pub fn reactions(&self) -> Vec<Reaction> {
        let of_joint = |(j, joint): (usize, &Joint)| {
            let components = joint.kind.components(&self.couplings).iter();
            components.map(move |&component| Reaction {
                joint: JointId(j),
                component,
            })
        };
        self.joints.iter().enumerate().flat_map(of_joint).collect()
    }

    /// The components of a joint's reaction, in the order of its constraint rows.
    pub fn components(&self, joint: JointId) -> &'static [Component] {
        let kind = self.joints.get(joint.0).map(|j| j.kind);
        kind.map_or(&[], |kind| kind.components(&self.couplings))
    }

    /// The reaction's name, such as `slide.normal`.
    pub fn reaction_name(&self, r: Reaction) -> String {
        format!("{}.{}", self.joints[r.joint.0].name, r.component.name())
    }

    /// The body's name.
    pub fn body_name(&self, b: BodyId) -> &str {
        &self.bodies[b.0].name
    }
}
