//! Loads in space: kinds, each with a magnitude.

use crate::load::{
    self, AnyLoadKind, BETWEEN_POINTS, Load as AnyLoad, LoadCoordinate, LoadNames, SpecialKind,
    Strength,
};
use dwell_geometry::space::{Coordinate, Mechanism, Vec3};
use dwell_geometry::{BodyId, JointId};

/// A load of a mechanism in space: a kind and a magnitude.
pub type Load = AnyLoad<LoadKind, Coordinate>;

/// The kind of a load in space. Gravity needs no direction if it is zero.
pub type LoadKind<C = f64> = AnyLoadKind<Vec3<C>, Coordinate<C>, DirectedCouple<C>, C>;

/// A direction in the axes of the ground or of a body.
pub type Direction<C = f64> = load::Direction<Vec3<C>>;

/// A torque F, N·m, on the second body, the opposite on the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectedCouple<C = f64> {
    /// The bodies.
    pub bodies: [BodyId; 2],
    /// Its direction, in the axes of the ground or of the first body.
    pub direction: Direction<C>,
}

impl SpecialKind for DirectedCouple {
    const IS_COUPLE: bool = true;
    const DOES_WORK: bool = true;
    const MEANING: Option<&'static str> = Some("moment about its axis on the second body");

    fn label(&self, names: &LoadNames<'_>) -> String {
        names.on_second("couple", self.bodies)
    }
}

impl LoadCoordinate for Coordinate {
    type Point = Vec3;
    type Turn = JointId;
    type Slide = JointId;

    fn distance(bodies: [BodyId; 2], points: [Vec3; 2]) -> Self {
        Self::Distance { bodies, points }
    }

    fn angle(of: JointId) -> Self {
        Self::Angle(of)
    }

    fn travel(of: JointId) -> Self {
        Self::Travel(of)
    }

    fn is_angle(self) -> bool {
        self.is_angle()
    }

    fn ends(self) -> Option<([BodyId; 2], [Vec3; 2])> {
        match self {
            Self::Distance { bodies, points } => Some((bodies, points)),
            Self::Angle(_) | Self::Travel(_) => None,
        }
    }

    fn meaning(self, _: Strength) -> &'static str {
        match self {
            Self::Angle(_) => "moment about the axis, of the first body on the second",
            Self::Travel(_) => "force along the axis, of the first body on the second",
            Self::Distance { .. } => BETWEEN_POINTS,
        }
    }

    fn label(self, law: Strength, names: &LoadNames<'_>) -> String {
        let word = law.words().load[usize::from(self.is_angle())];
        match (self, law) {
            (Self::Angle(joint), Strength::Direct) => {
                format!("moment about the axis of {}", names.joints[joint.0])
            }
            (Self::Angle(joint), _) => format!("{word} in {}", names.joints[joint.0]),
            (Self::Travel(joint), _) => format!("{word} along {}", names.joints[joint.0]),
            (Self::Distance { bodies, .. }, _) => names.between(word, bodies),
        }
    }
}

impl<C: Copy> LoadKind<C> {
    /// The bodies it acts on, by number; none of gravity, which acts on all that have mass.
    pub fn bodies(&self, mechanism: &Mechanism) -> Vec<BodyId> {
        match *self {
            Self::Gravity { .. } => Vec::new(),
            Self::Force { body, .. } | Self::Drag { body, .. } => vec![body],
            Self::Special(DirectedCouple { bodies, .. })
            | Self::Along(Coordinate::Distance { bodies, .. }, _) => bodies.to_vec(),
            Self::Along(Coordinate::Angle(joint) | Coordinate::Travel(joint), _) => {
                let joint = mechanism.joints.get(joint.0);
                joint.map_or_else(Vec::new, |joint| joint.bodies.to_vec())
            }
        }
    }
}

impl LoadKind {
    /// A torque about a direction of the ground or of the first body.
    pub fn torque(bodies: [BodyId; 2], direction: Direction) -> Self {
        Self::Special(DirectedCouple { bodies, direction })
    }

    /// The joint on whose relative angle, with whole revolutions, a load of this kind itself depends; none for most.
    pub fn angle_joint(self) -> Option<JointId> {
        match self {
            Self::Along(Coordinate::Angle(joint), law) => law.free().map(|_| joint),
            _ => None,
        }
    }
}
