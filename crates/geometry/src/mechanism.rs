//! The description of a mechanism: bodies, the joints between them, and the actuators
//! whose coordinates are the independent ones. Lengths in m, angles in rad.

mod guessed_length;
mod parts;
mod size;

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
    /// Its kind: which relative motion it allows.
    pub kind: JointKind,
}

/// Which relative motion a joint allows. With P₁, P₂ the joint's points on its two bodies, θ₁, θ₂ the angles of
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
    /// ψ the direction of P₂ − P₁: r₂ (θ₂ − ψ) ± r₁ (θ₁ − ψ) keeps its value at assembly (+ for an
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
    /// Two coordinates are coupled by a law (a cam, a table): [`Mechanism::couplings`] of this index.
    Coupling(usize),
}

/// The line along which a joint slides, in the plane or in [space](crate::space).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guide<V = Vec2> {
    /// The joint's bodies.
    pub bodies: [BodyId; 2],
    /// Its point on each, m.
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

/// Two coupled coordinates: `dependent` = law(`independent`). The joint's two bodies are those of `dependent`.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupling {
    /// The coordinate that is a function of the other.
    pub dependent: Coordinate,
    /// The argument of the law.
    pub independent: Coordinate,
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

/// What an actuator drives.
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

/// One component of a joint's reaction, conjugate to one row of the joint's constraint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Component {
    /// Force along the ground's x axis, N (revolute).
    X,
    /// Force along the ground's y axis, N (revolute).
    Y,
    /// Force along the normal, the first body's axis turned +90°, N (prismatic, slot, rolling).
    Normal,
    /// Couple, N·m: about the second body's point (prismatic, weld), or of an angular coupling.
    Moment,
    /// Tangential tooth force at the pitch point, N: positive when it turns the second body
    /// counter-clockwise (gear), or pushes the pinion along the axis (rack).
    Tooth,
    /// Force along the axis at the point of contact, N (rolling).
    Tangent,
    /// Force along the line from the first point to the second, N: positive when it pushes the
    /// points apart (distance).
    Axial,
    /// Force along a coupled travel or length, N (coupling).
    Force,
}

impl Component {
    /// The name used in scenes and tables.
    pub fn name(self) -> &'static str {
        self.name_and_unit().0
    }

    /// Unit of the reaction.
    pub fn unit(self) -> &'static str {
        self.name_and_unit().1
    }

    fn name_and_unit(self) -> (&'static str, &'static str) {
        match self {
            Self::X => ("x", "N"),
            Self::Y => ("y", "N"),
            Self::Normal => ("normal", "N"),
            Self::Moment => ("moment", "N m"),
            Self::Tooth => ("tooth", "N"),
            Self::Tangent => ("tangent", "N"),
            Self::Axial => ("axial", "N"),
            Self::Force => ("force", "N"),
        }
    }
}

/// The coordinate of a joint that an approximate value at assembly is about
/// ([`AssemblyConfiguration::branch_hints`](crate::AssemblyConfiguration::branch_hints)).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BranchHint {
    /// The travel t·(P₂ − P₁) of a prismatic joint or a slot, m.
    Travel,
    /// The angle of the line from P₁ to P₂ of a distance, rad.
    Direction,
}

impl JointKind {
    /// The coordinate of such a joint by which an approximate value can select an assembly mode, if there is one.
    pub fn branch_hint(self) -> Option<BranchHint> {
        match self {
            Self::Distance { .. } => Some(BranchHint::Direction),
            other => other.travel_axis().map(|_| BranchHint::Travel),
        }
    }

    /// The axis t, in the first body's frame, along which [`Coordinate::Travel`] of such a joint is measured; none where
    /// the joint has no travel.
    pub fn travel_axis(self) -> Option<Vec2> {
        match self {
            Self::Prismatic { axes } => Some(axes[0]),
            Self::Slot { axis } => Some(axis),
            Self::Revolute
            | Self::Weld { .. }
            | Self::Gear { .. }
            | Self::Rack { .. }
            | Self::Rolling { .. }
            | Self::Distance { .. }
            | Self::Coupling(_) => None,
        }
    }

    /// Whether its two points coincide in every position: by a force in every direction.
    pub(crate) fn holds_points_together(self) -> bool {
        self.components(&[])
            .starts_with(&[Component::X, Component::Y])
    }

    /// The components of the reaction, in the order of the constraint rows.
    pub fn components(self, couplings: &[Coupling]) -> &'static [Component] {
        use Component::{Axial, Force, Moment, Normal, Tangent, Tooth, X, Y};
        match self {
            Self::Revolute => &[X, Y],
            Self::Prismatic { .. } => &[Normal, Moment],
            Self::Slot { .. } => &[Normal],
            Self::Weld { .. } => &[X, Y, Moment],
            Self::Gear { .. } | Self::Rack { .. } => &[Tooth],
            Self::Rolling { .. } => &[Normal, Tangent],
            Self::Distance { .. } => &[Axial],
            Self::Coupling(r) => match couplings.get(r) {
                Some(coupling) if coupling.dependent.is_angle() => &[Moment],
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
