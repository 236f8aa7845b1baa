//! The kinds of joints: their names, and their conditions between the two sides. Everything else about a kind follows
//! from its conditions: rows of closures, freedoms, coordinates, which components of a reaction exist, symbols.

use crate::mechanism::BodyId;

/// Which relative motion a joint allows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// None: points, axes and normals coincide.
    Weld,
    /// Rotation about the common axis; the points coincide.
    Revolute,
    /// Translation along the common axis; the normals are parallel.
    Prismatic,
    /// Rotation about and translation along the common axis.
    Cylindrical,
    /// A screw: translation of `pitch` m for each rad of rotation about the common axis. It is zero where the normals are parallel.
    Helical {
        /// Travel over angle, m/rad.
        pitch: f64,
    },
    /// The points coincide, and the axis of the first body stays at right angles to that of the second: a Hooke joint with
    /// a massless cross.
    Universal,
    /// The points coincide.
    Spherical,
    /// The second point stays in the plane through the first at right angles to the common axis.
    Planar,
    /// The second point stays on the line through the first along the first body's axis.
    PointOnLine,
    /// The second point stays in the plane through the first at right angles to the first body's axis.
    PointInPlane,
    /// A massless rod with balls at its ends.
    Distance {
        /// Its length, m; ignored if an actuator drives it.
        length: f64,
    },
    /// The teeth of two wheels, or of a rack and a wheel, that touch at a pitch point of a third body, the carrier: there
    /// the wheels have the same velocity along the normal n of the teeth,
    ///
    /// ```text
    /// n·(v₂ − v₁) = 0,     with both sides of the joint, point and axis n, in the frame of the carrier
    /// ```
    ///
    /// Each wheel turns about, or slides along, one line of the carrier. The teeth mesh so that all joint angles and travels
    /// between the wheels are zero together.
    Gear {
        /// The body in which the pitch point and the normal are fixed.
        carrier: BodyId,
    },
    /// Two coordinates are coupled by a law (a cam, a table). Bodies and sides are those of the dependent coordinate.
    Coupling {
        /// Which of the mechanism's couplings.
        index: usize,
        /// How it acts along the dependent coordinate.
        action: CouplingAction,
    },
}

/// How a coupling acts along its dependent coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CouplingAction {
    /// A couple about the first body's axis: the coordinate is an angle.
    Couple,
    /// A force along the first body's axis: the coordinate is a travel.
    Force,
    /// A force along the line of the points: the coordinate is a distance.
    Line,
}

/// A condition that a joint holds, with d = p_b − p_a from the first side's point to the second's, axes u and normals n.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Condition {
    /// The points coincide: d = 0.
    Points,
    /// The second point is on the first axis: d × u_a = 0.
    OnLine,
    /// The second point is in the plane across the first axis: d·u_a = 0.
    InPlane,
    /// The axes are parallel: u_a = u_b.
    Axes,
    /// The axes are at right angles: u_a·u_b = 0.
    AxesAcross,
    /// The normals are parallel, where the axes are: n_a = n_b.
    Normals,
    /// The travel is the angle times the pitch.
    Thread,
    /// The points keep a distance.
    Length,
    /// Two wheels have the same velocity along the normal of their teeth.
    Teeth,
    /// Two coordinates are coupled.
    Coupled(CouplingAction),
}

use Condition::{
    Axes, AxesAcross, Coupled, InPlane, Length, Normals, OnLine, Points, Teeth, Thread,
};

/// The kinds, with numbers of no meaning.
const KINDS: [JointKind; 13] = [
    JointKind::Revolute,
    JointKind::Prismatic,
    JointKind::Cylindrical,
    JointKind::Helical { pitch: 0.0 },
    JointKind::Universal,
    JointKind::Spherical,
    JointKind::Planar,
    JointKind::PointOnLine,
    JointKind::PointInPlane,
    JointKind::Weld,
    JointKind::Distance { length: 0.0 },
    JointKind::Gear { carrier: BodyId(0) },
    JointKind::Coupling {
        index: 0,
        action: CouplingAction::Couple,
    },
];

impl JointKind {
    /// Its name in scenes, with its conditions, in the order of its rows.
    fn definition(self) -> (&'static str, &'static [Condition]) {
        match self {
            Self::Revolute => ("revolute", &[Points, Axes]),
            Self::Prismatic => ("prismatic", &[OnLine, Axes, Normals]),
            Self::Cylindrical => ("cylindrical", &[OnLine, Axes]),
            Self::Helical { .. } => ("helical", &[OnLine, Axes, Thread]),
            Self::Universal => ("universal", &[Points, AxesAcross]),
            Self::Spherical => ("spherical", &[Points]),
            Self::Planar => ("planar", &[InPlane, Axes]),
            Self::PointOnLine => ("point-on-line", &[OnLine]),
            Self::PointInPlane => ("point-in-plane", &[InPlane]),
            Self::Weld => ("weld", &[Points, Axes, Normals]),
            Self::Distance { .. } => ("distance", &[Length]),
            Self::Gear { .. } => ("gear", &[Teeth]),
            Self::Coupling { action, .. } => match action {
                CouplingAction::Couple => ("coupling", &[Coupled(CouplingAction::Couple)]),
                CouplingAction::Force => ("coupling", &[Coupled(CouplingAction::Force)]),
                CouplingAction::Line => ("coupling", &[Coupled(CouplingAction::Line)]),
            },
        }
    }

    /// Its name in scenes and messages.
    pub fn name(self) -> &'static str {
        self.definition().0
    }

    /// The kind of this name, with zero for its numbers; none if there is no such kind.
    pub fn named(name: &str) -> Option<Self> {
        KINDS.into_iter().find(|kind| kind.name() == name)
    }

    /// The conditions that it holds, in the order of its rows.
    pub fn conditions(self) -> &'static [Condition] {
        self.definition().1
    }

    /// Whether it holds a condition.
    pub fn holds(self, condition: Condition) -> bool {
        self.conditions().contains(&condition)
    }

    /// The number of relative freedoms, 0 to 5.
    pub fn freedoms(self) -> usize {
        let rows = |condition: &Condition| match condition {
            Points => 3,
            OnLine | Axes => 2,
            InPlane | AxesAcross | Normals | Thread | Length | Teeth | Coupled(_) => 1,
        };
        6 - self.conditions().iter().map(rows).sum::<usize>()
    }

    /// Whether both bodies turn or slide about one common axis.
    pub(super) fn has_common_axis(self) -> bool {
        self.holds(Axes) && !self.holds(InPlane)
    }

    /// Whether it has an angle about its axis that can be measured and driven.
    pub fn has_angle(self) -> bool {
        self.has_common_axis() && !self.holds(Normals)
    }

    /// Whether it has a travel along its axis that can be measured and driven.
    pub fn has_travel(self) -> bool {
        self.holds(OnLine)
    }

    /// Whether its axis has a meaning.
    pub fn has_axis(self) -> bool {
        !matches!(
            self.conditions(),
            [Points] | [Length] | [Coupled(CouplingAction::Line)]
        )
    }

    /// Whether it acts along the line of its points: a distance, or a coupling of one.
    pub fn acts_along_line(self) -> bool {
        matches!(self.conditions(), [Length | Coupled(CouplingAction::Line)])
    }

    /// Whether it couples two coordinates.
    pub fn is_coupling(self) -> bool {
        matches!(self, Self::Coupling { .. })
    }

    /// Whether a body can be placed by it alone: of a distance and of teeth there are no coordinates.
    pub(super) fn can_carry(self) -> bool {
        !self.holds(Length) && !self.holds(Teeth) && !self.is_coupling()
    }

    /// Whether it holds a body of this side (0 or 1) at a point alone, without any of its directions.
    pub fn is_point_on(self, side: usize) -> bool {
        matches!(
            (self.conditions(), side),
            ([Points] | [Length], _) | ([OnLine] | [InPlane], 1)
        )
    }

    /// Which components of its reaction can differ from zero in its own axes (normal, across, axis of the first body): those of the
    /// force, then those of the moment about the second point.
    pub fn reaction(self) -> [[bool; 3]; 2] {
        let mut components = [[false; 3]; 2];
        for condition in self.conditions() {
            let (force, moment) = match condition {
                Points | Length | Coupled(CouplingAction::Line) => ([true; 3], [false; 3]),
                OnLine => ([true, true, false], [false; 3]),
                InPlane | Teeth | Coupled(CouplingAction::Force) => {
                    ([false, false, true], [false; 3])
                }
                Coupled(CouplingAction::Couple) => ([false; 3], [false, false, true]),
                Axes | AxesAcross => ([false; 3], [true, true, false]),
                Normals => ([false; 3], [false, false, true]),
                Thread => ([false, false, true], [false, false, true]),
            };
            for k in 0..3 {
                components[0][k] |= force[k];
                components[1][k] |= moment[k];
            }
        }
        components
    }

    /// Whether its reaction is a moment, too.
    pub fn has_moment(self) -> bool {
        self.reaction()[1].contains(&true)
    }
}
