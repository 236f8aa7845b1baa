//! The plain description of a mechanism: bodies, the joints between them, and the actuators
//! whose coordinates are the independent ones. Lengths in m, angles in rad.

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
    /// What joints of kind [`JointKind::Relation`] relate.
    pub relations: Vec<Relation>,
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

/// What a joint lets move. With P₁, P₂ the joint's points on its two bodies, θ₁, θ₂ the angles of
/// their frames, t the axis in the first body (in the plane's directions) and n that axis turned +90°.
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
    /// A pin of the second body in a straight slot of the first: n·(P₂ − P₁) = 0.
    Slot {
        /// Unit vector of the slot in the first body's frame.
        axis: Vec2,
    },
    /// The two points coincide and the second body keeps an angle to the first.
    Weld {
        /// Angle of the second body's frame from the first's, rad.
        angle: f64,
    },
    /// Two gears with their centres at the points; other joints keep these at their distance. With
    /// ψ the direction of P₂ − P₁: r₂ (θ₂ − ψ) ± r₁ (θ₁ − ψ) stays what it is at the start (+ for an
    /// external pair, − for an internal one).
    Gear {
        /// Pitch radii, m, both above zero.
        radii: [f64; 2],
        /// Whether one gear is a ring around the other.
        internal: bool,
    },
    /// A straight rack (first body) whose pitch line passes through P₁ along the axis, and a pinion
    /// centred at P₂: t·(P₂ − P₁) + r (θ₂ − θ₁) = 0. Other joints keep their distance.
    Rack {
        /// Unit vector of the pitch line in the first body's frame.
        axis: Vec2,
        /// Pitch radius r, m: positive with the pinion on the side of n, negative on the other.
        radius: f64,
    },
    /// A disc (second body, centred at P₂) rolls on a straight track of the first, through P₁ along
    /// the axis: n·(P₂ − P₁) = r and t·(P₂ − P₁) + r (θ₂ − θ₁) = 0.
    Rolling {
        /// Unit vector of the track in the first body's frame.
        axis: Vec2,
        /// Radius r, m: positive with the disc on the side of n, negative on the other.
        radius: f64,
    },
    /// The two points keep their distance, as if by a massless link.
    Distance {
        /// The distance, m, above zero.
        length: f64,
    },
    /// Two coordinates are related by a law (a cam, a table): [`Mechanism::relations`] of this index.
    Relation(usize),
}

/// Something that can be measured on a mechanism, driven, or related to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate {
    /// Angle of the second body's frame from the first's, rad, whole turns counted.
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
}

/// Two related coordinates: `of` = law(`by`). The joint's two bodies are those of `of`.
#[derive(Debug, Clone, PartialEq)]
pub struct Relation {
    /// The coordinate that is a function of the other.
    pub of: Coordinate,
    /// The other.
    pub by: Coordinate,
    /// The function, SI.
    pub law: Law,
}

/// An actuator: it imposes one independent coordinate q.
#[derive(Debug, Clone, PartialEq)]
pub struct Actuator {
    /// The name of the actuator and of its coordinate.
    pub name: String,
    /// The first and the second body: the actuator's action τ is that of the first on the second.
    pub bodies: [BodyId; 2],
    /// Which of their coordinates it drives.
    pub drive: Drive,
}

/// What an actuator drives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Drive {
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
        match self.drive {
            Drive::Angle => Coordinate::Angle(self.bodies),
            Drive::Travel(joint) => Coordinate::Travel(joint),
            Drive::Length(points) => Coordinate::Length {
                bodies: self.bodies,
                points,
            },
        }
    }
}

/// One component of a joint's reaction, conjugate to one row of the joint's constraint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Component {
    /// Force along the ground's x axis, N (revolute).
    X,
    /// Force along the ground's y axis, N (revolute).
    Y,
    /// Force along the normal, the first body's axis turned +90°, N (prismatic, slot, rolling).
    Normal,
    /// Couple, N·m: about the second body's point (prismatic, weld), or of an angular relation.
    Moment,
    /// Tangential tooth force at the pitch point, N: positive when it turns the second body
    /// counter-clockwise (gear), or pushes the pinion along the axis (rack).
    Tooth,
    /// Force along the axis at the point of contact, N (rolling).
    Tangent,
    /// Force along the line from the first point to the second, N: positive when it pushes the
    /// points apart (distance).
    Axial,
    /// Force along a related travel or length, N (relation).
    Force,
}

impl Component {
    /// The name used in scenes and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Normal => "normal",
            Self::Moment => "moment",
            Self::Tooth => "tooth",
            Self::Tangent => "tangent",
            Self::Axial => "axial",
            Self::Force => "force",
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

/// What a rough number tells of a joint at the start ([`Start::joints`](crate::Start::joints)).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Told {
    /// The travel t·(P₂ − P₁) of a prismatic joint or a slot, m.
    Travel,
    /// The angle of the line from P₁ to P₂ of a distance, rad.
    Direction,
}

impl JointKind {
    /// What a rough number can tell of such a joint at the start, if anything.
    pub fn told(self) -> Option<Told> {
        match self {
            Self::Prismatic { .. } | Self::Slot { .. } => Some(Told::Travel),
            Self::Distance { .. } => Some(Told::Direction),
            _ => None,
        }
    }

    /// The components of the reaction, in the order of the constraint rows.
    pub fn components(self, relations: &[Relation]) -> &'static [Component] {
        use Component::{Axial, Force, Moment, Normal, Tangent, Tooth, X, Y};
        match self {
            Self::Revolute => &[X, Y],
            Self::Prismatic { .. } => &[Normal, Moment],
            Self::Slot { .. } => &[Normal],
            Self::Weld { .. } => &[X, Y, Moment],
            Self::Gear { .. } | Self::Rack { .. } => &[Tooth],
            Self::Rolling { .. } => &[Normal, Tangent],
            Self::Distance { .. } => &[Axial],
            Self::Relation(r) => match relations.get(r) {
                Some(relation) if relation.of.is_angle() => &[Moment],
                _ => &[Force],
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
            let components = joint.kind.components(&self.relations).iter();
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
        kind.map_or(&[], |kind| kind.components(&self.relations))
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
