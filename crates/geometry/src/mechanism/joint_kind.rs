//! The kinds of joints: their names, the components of their reactions, and their conditions between the two bodies. Constraint rows,
//! wrenches, meshing, travels and sizes follow from the conditions.

use super::Coupling;
use crate::plane::Vec2;

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

/// A condition that a joint holds, with d = P₂ − P₁, angles θ of the bodies, and axes t and their normals n in the first body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Condition {
    /// The points coincide: d = 0.
    Together,
    /// The second point is on a line at this height (m) over the first point: n·d = height.
    OnLine {
        /// Unit vector t of the line in the first body's frame.
        axis: Vec2,
        /// Height over the line through the first point, m.
        height: f64,
    },
    /// The second body keeps an angle to the first: θ₂ − θ₁ = angle.
    Turned {
        /// The angle, rad.
        angle: f64,
    },
    /// The points keep their distance: |d| = length.
    Apart {
        /// The distance, m.
        length: f64,
    },
    /// A circle about the second point rolls on a line: t·d + radius (θ₂ − θ₁) = 0.
    Rolled {
        /// Unit vector t of the line in the first body's frame.
        axis: Vec2,
        /// Radius of the circle, m: positive on the side of n.
        radius: f64,
    },
    /// Circles about both points roll on each other, as [`JointKind::Gear`] says.
    Meshed {
        /// Radii, m.
        radii: [f64; 2],
        /// Whether one is a ring around the other.
        internal: bool,
    },
    /// Two coordinates are coupled by [`Mechanism::couplings`](super::Mechanism::couplings) of this index.
    Coupled(usize),
}

impl JointKind {
    /// Its name in scenes, and the components of its reaction, in the order of the constraint rows; of a coupling, that of a force.
    fn definition(self) -> (&'static str, &'static [Component]) {
        use Component::{Axial, Force, Moment, Normal, Tangent, Tooth, X, Y};
        match self {
            Self::Revolute => ("revolute", &[X, Y]),
            Self::Prismatic { .. } => ("prismatic", &[Normal, Moment]),
            Self::Slot { .. } => ("slot", &[Normal]),
            Self::Weld { .. } => ("weld", &[X, Y, Moment]),
            Self::Gear { .. } => ("gear", &[Tooth]),
            Self::Rack { .. } => ("rack", &[Tooth]),
            Self::Rolling { .. } => ("rolling", &[Normal, Tangent]),
            Self::Distance { .. } => ("distance", &[Axial]),
            Self::Coupling(_) => ("coupling", &[Force]),
        }
    }

    /// The conditions that it holds, in the order of the constraint rows.
    pub fn conditions(self) -> impl Iterator<Item = Condition> {
        use Condition::{Apart, Coupled, Meshed, OnLine, Rolled, Together, Turned};
        let on = |axis, height| Some(OnLine { axis, height });
        let conditions = match self {
            Self::Revolute => [Some(Together), None],
            Self::Weld { angle } => [Some(Together), Some(Turned { angle })],
            Self::Prismatic { axes } => {
                let angle = axes[0].angle() - axes[1].angle();
                [on(axes[0], 0.0), Some(Turned { angle })]
            }
            Self::Slot { axis } => [on(axis, 0.0), None],
            Self::Rack { axis, radius } => [Some(Rolled { axis, radius }), None],
            Self::Rolling { axis, radius } => [on(axis, radius), Some(Rolled { axis, radius })],
            Self::Gear { radii, internal } => [Some(Meshed { radii, internal }), None],
            Self::Distance { length } => [Some(Apart { length }), None],
            Self::Coupling(coupling) => [Some(Coupled(coupling)), None],
        };
        conditions.into_iter().flatten()
    }

    /// Its name in scenes and messages.
    pub fn name(self) -> &'static str {
        self.definition().0
    }

    /// The components of the reaction, in the order of the constraint rows.
    pub fn components(self, couplings: &[Coupling]) -> &'static [Component] {
        match self {
            Self::Coupling(r) if couplings.get(r).is_some_and(|c| c.dependent.is_angle()) => {
                &[Component::Moment]
            }
            _ => self.definition().1,
        }
    }

    /// The coordinate of such a joint by which an approximate value can select an assembly mode, if there is one.
    pub fn branch_hint(self) -> Option<BranchHint> {
        match self {
            Self::Distance { .. } => Some(BranchHint::Direction),
            other => other.travel_axis().map(|_| BranchHint::Travel),
        }
    }

    /// The axis t, in the first body's frame, along which [`Coordinate::Travel`](super::Coordinate::Travel) of such a joint is measured;
    /// `None` if the joint has no travel.
    pub fn travel_axis(self) -> Option<Vec2> {
        self.line().filter(|_| self.rolled().is_none())
    }

    /// The axis, in the first body's frame, of the line along which the second point moves; `None` if there is no such
    /// line.
    pub fn line(self) -> Option<Vec2> {
        self.conditions().find_map(|condition| match condition {
            Condition::OnLine { axis, .. } | Condition::Rolled { axis, .. } => Some(axis),
            _ => None,
        })
    }

    /// Axis and radius (m) of a circle that rolls on a line.
    pub fn rolled(self) -> Option<(Vec2, f64)> {
        self.conditions().find_map(|condition| match condition {
            Condition::Rolled { axis, radius } => Some((axis, radius)),
            _ => None,
        })
    }

    /// Whether its reaction is the force of teeth.
    pub fn has_teeth(self) -> bool {
        self.definition().1 == [Component::Tooth]
    }

    /// Whether its bodies turn freely about one point.
    pub fn is_pin(self) -> bool {
        self.definition().1 == [Component::X, Component::Y]
    }

    /// Whether its two points coincide in every position: by a force in every direction.
    pub(crate) fn holds_points_together(self) -> bool {
        self.conditions().any(|c| c == Condition::Together)
    }

    /// The largest length that is a number of the joint, m; zero without one.
    pub(super) fn length(self) -> f64 {
        let lengths = self.conditions().map(|condition| match condition {
            Condition::Apart { length } => length,
            Condition::Rolled { radius, .. } => radius.abs(),
            Condition::Meshed { radii, .. } => radii[0].max(radii[1]),
            Condition::Together
            | Condition::OnLine { .. }
            | Condition::Turned { .. }
            | Condition::Coupled(_) => 0.0,
        });
        lengths.fold(0.0, f64::max)
    }
}
