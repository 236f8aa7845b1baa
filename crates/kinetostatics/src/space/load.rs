//! Loads in space: shapes, each times a magnitude.

use crate::load::Load as AnyLoad;
use dwell_geometry::space::{Coordinate, Mechanism, Vec3};
use dwell_geometry::{BodyId, JointId};

/// A load of a mechanism in space: a shape times a magnitude.
pub type Load = AnyLoad<LoadKind, Coordinate>;

/// A direction in the axes of the ground or of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Direction {
    /// In those of the ground.
    Ground(Vec3),
    /// In those of the body that the load acts on.
    Body(Vec3),
}

/// The shape of a load, and what its magnitude F means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadKind {
    /// On every mass, along this direction of the ground: F in N/kg.
    Gravity(Vec3),
    /// A force F, N, at a point (m in the body's frame).
    Force {
        /// The body.
        body: BodyId,
        /// Its point.
        point: Vec3,
        /// The direction.
        direction: Direction,
    },
    /// A torque F, N·m, on the second body, the opposite on the first, about a direction of the first or the ground.
    Torque {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The direction.
        direction: Direction,
    },
    /// A force F, N, that pushes two points (m in the frames of the bodies) apart.
    PointToPointForce {
        /// The bodies.
        bodies: [BodyId; 2],
        /// Their points.
        points: [Vec3; 2],
    },
    /// A spring between two points: F is its stiffness, N/m; it pulls with F (length − free).
    Spring {
        /// The bodies.
        bodies: [BodyId; 2],
        /// Their points.
        points: [Vec3; 2],
        /// Free length, m.
        free_length: f64,
    },
    /// A damper between two points: F is its constant, N·s/m; it resists with F × d(length)/dt.
    Damper {
        /// The bodies.
        bodies: [BodyId; 2],
        /// Their points.
        points: [Vec3; 2],
    },
    /// A couple F, N·m, of a joint's first body on its second about the joint's axis.
    JointTorque(JointId),
    /// A torsional spring about a joint's axis: F is its stiffness, N·m/rad; couple −F (angle − free) on the second body.
    TorsionSpring {
        /// The joint.
        joint: JointId,
        /// Free angle, rad, with its whole revolutions.
        free_angle: f64,
    },
    /// A damper about a joint's axis: F is its constant, N·m·s/rad; couple −F × rate of the angle on the second body.
    RotationalDamper(JointId),
    /// A force F, N, of a joint's first body on its second along the joint's axis, at the second body's point.
    SlideForce(JointId),
    /// Viscous friction along a joint's axis: F is its constant, N·s/m; it resists with F × rate of the travel.
    SlideDamper(JointId),
}

impl LoadKind {
    /// The bodies it acts on, by number; none of gravity, which acts on all that have mass.
    pub fn bodies(&self, mechanism: &Mechanism) -> Vec<BodyId> {
        match *self {
            Self::Gravity(_) => Vec::new(),
            Self::Force { body, .. } => vec![body],
            Self::Torque { bodies, .. }
            | Self::PointToPointForce { bodies, .. }
            | Self::Spring { bodies, .. }
            | Self::Damper { bodies, .. } => bodies.to_vec(),
            Self::JointTorque(joint)
            | Self::TorsionSpring { joint, .. }
            | Self::RotationalDamper(joint)
            | Self::SlideForce(joint)
            | Self::SlideDamper(joint) => {
                let joint = mechanism.joints.get(joint.0);
                joint.map_or_else(Vec::new, |joint| joint.bodies.to_vec())
            }
        }
    }

    /// Whether it has a potential where its magnitude is constant: gravity, springs and forces of constant direction.
    pub fn is_conservative(&self) -> bool {
        match self {
            Self::Gravity(_)
            | Self::Spring { .. }
            | Self::TorsionSpring { .. }
            | Self::Force {
                direction: Direction::Ground(_),
                ..
            } => true,
            Self::Force {
                direction: Direction::Body(_),
                ..
            }
            | Self::Torque { .. }
            | Self::PointToPointForce { .. }
            | Self::Damper { .. }
            | Self::JointTorque(_)
            | Self::RotationalDamper(_)
            | Self::SlideForce(_)
            | Self::SlideDamper(_) => false,
        }
    }

    /// A couple or force along a coordinate, positive in the direction in which the coordinate grows.
    pub fn along(coordinate: Coordinate) -> Self {
        match coordinate {
            Coordinate::Angle(joint) => Self::JointTorque(joint),
            Coordinate::Travel(joint) => Self::SlideForce(joint),
            Coordinate::Distance { bodies, points } => Self::PointToPointForce { bodies, points },
        }
    }
}
