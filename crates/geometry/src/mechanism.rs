//! The plain description of a mechanism: bodies, the joints between them, and the actuators
//! whose coordinates are the independent ones. Lengths in m, angles in rad.

use crate::plane::Vec2;

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
    /// The first and the second body; a reaction is the action of the first on the second.
    pub bodies: [BodyId; 2],
    /// The joint's point on each body, in that body's frame, in m.
    pub points: [Vec2; 2],
    /// What it lets move.
    pub kind: JointKind,
}

/// What a joint lets move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// The two points coincide.
    Revolute,
    /// The second body's point stays on the line through the first body's point along the axis,
    /// and the two axes keep the same direction.
    Prismatic {
        /// Unit vector of the axis in each body's frame.
        axes: [Vec2; 2],
    },
}

/// An actuator: it imposes one independent coordinate q.
#[derive(Debug, Clone, PartialEq)]
pub struct Actuator {
    /// The name of the actuator and of its coordinate.
    pub name: String,
    /// The first and the second body: q is the angle of the second's frame from the first's,
    /// and the actuator's action τ is the couple of the first on the second, in N·m.
    pub bodies: [BodyId; 2],
}

/// One component of a joint's reaction, conjugate to one row of the joint's constraint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Component {
    /// Force along the ground's x axis, N (revolute).
    X,
    /// Force along the ground's y axis, N (revolute).
    Y,
    /// Force along the normal, the first body's axis turned +90°, N (prismatic).
    Normal,
    /// Couple about the second body's point, N·m (prismatic).
    Moment,
}

impl Component {
    /// The name used in scenes and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Normal => "normal",
            Self::Moment => "moment",
        }
    }

    /// Unit of the reaction.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Moment => "N m",
            _ => "N",
        }
    }
}

impl JointKind {
    /// The components of the joint's reaction, in the order of its constraint rows.
    pub fn components(self) -> [Component; 2] {
        match self {
            Self::Revolute => [Component::X, Component::Y],
            Self::Prismatic { .. } => [Component::Normal, Component::Moment],
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
    /// in the order of [`JointKind::components`]. "Reaction k" everywhere means this order.
    pub fn reactions(&self) -> Vec<Reaction> {
        let of_joint = |(j, joint): (usize, &Joint)| {
            joint.kind.components().map(|component| Reaction {
                joint: JointId(j),
                component,
            })
        };
        self.joints.iter().enumerate().flat_map(of_joint).collect()
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
