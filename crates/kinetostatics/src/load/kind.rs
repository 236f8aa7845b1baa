//! The kind of a load: its place, and the [`Strength`] law that gives its force from its magnitude. One type serves the plane and
//! [space](crate::space), which differ in vectors and coordinates.

use super::strength::{LoadSymbol, Strength};
use super::{Guide, Mesh};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{BodyId, Coordinate, Mechanism, Vec2};
use dwell_numerics::Constant;
use std::fmt::Debug;

/// A direction in the axes of the ground or of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Direction<V = Vec2> {
    /// In the axes of the ground.
    Ground(V),
    /// In the axes of the body on which the load acts, and turning with it.
    Body(V),
}

impl<V> Direction<V> {
    /// Its components in its own axes.
    pub fn vector(self) -> V {
        match self {
            Self::Ground(vector) | Self::Body(vector) => vector,
        }
    }
}

/// The place of a load, and the meaning of its magnitude F, with vectors `V`, coordinates `C`, the kinds `S` that exist only in the
/// plane or only in space, and numbers `N`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnyLoadKind<V, C, S, N = f64> {
    /// Weight of every body: F is the acceleration of gravity, m/s², along this unit vector of the ground.
    Gravity {
        /// Unit vector in the ground's frame.
        direction: V,
    },
    /// A force F, N, at a point of a body.
    Force {
        /// The body.
        body: BodyId,
        /// The point in its frame, m.
        point: V,
        /// Unit vector of the force.
        direction: Direction<V>,
    },
    /// A force or couple along a coordinate, positive in the direction in which the coordinate grows.
    Along(C, Strength<N>),
    /// The drag of a point of a body in a fluid at rest: F is its coefficient, N·s²/m²; the force −F |v| v.
    Drag {
        /// The body.
        body: BodyId,
        /// The point in its frame, m.
        point: V,
    },
    /// A kind that exists only in the plane or only in space.
    Special(S),
}

/// The kind of a load in the plane.
pub type LoadKind<C = f64> = AnyLoadKind<Vec2<C>, CoordinateFunction<C>, Mesh<C>, C>;

/// A coordinate along which a load can act.
pub trait LoadCoordinate: Copy {
    /// A point of a body.
    type Point: Copy;
    /// The parts with a relative angle: two bodies in the plane, a joint in space.
    type Turn;
    /// The part with a travel.
    type Slide;

    /// The distance of two points.
    fn distance(bodies: [BodyId; 2], points: [Self::Point; 2]) -> Self;
    /// A relative angle.
    fn angle(of: Self::Turn) -> Self;
    /// A travel.
    fn travel(of: Self::Slide) -> Self;
    /// Whether it is an angle.
    fn is_angle(self) -> bool;
    /// The points whose distance it is, if it is one.
    fn ends(self) -> Option<([BodyId; 2], [Self::Point; 2])>;
    /// The effect of a positive force or moment of this law along it.
    fn meaning(self, law: Strength) -> &'static str;
    /// A description of a load of this law along it, with the names of bodies and joints.
    fn label(self, law: Strength, names: &LoadNames<'_>) -> String;
}

/// The names of bodies and joints, in their order.
#[derive(Debug, Clone)]
pub struct LoadNames<'a> {
    /// Names of the bodies.
    pub bodies: Vec<&'a str>,
    /// Names of the joints.
    pub joints: Vec<&'a str>,
}

impl LoadNames<'_> {
    /// The text for an action between two bodies.
    pub(crate) fn between(&self, what: &str, [a, b]: [BodyId; 2]) -> String {
        format!(
            "{what} between {} and {}",
            self.bodies[a.0], self.bodies[b.0]
        )
    }

    /// The text for an action of the first of two bodies on the second.
    pub(crate) fn on_second(&self, what: &str, [a, b]: [BodyId; 2]) -> String {
        format!("{what} of {} on {}", self.bodies[a.0], self.bodies[b.0])
    }
}

/// The description of a force along the line through two points.
pub(crate) const BETWEEN_POINTS: &str = "force between the points; positive pushes them apart";

impl LoadCoordinate for CoordinateFunction {
    type Point = Vec2;
    type Turn = [BodyId; 2];
    type Slide = Guide;

    fn distance(bodies: [BodyId; 2], points: [Vec2; 2]) -> Self {
        Self::Length { bodies, points }
    }

    fn angle(of: [BodyId; 2]) -> Self {
        Self::Angle(of)
    }

    fn travel(of: Guide) -> Self {
        Self::Travel(of)
    }

    fn is_angle(self) -> bool {
        matches!(self, Self::Angle(_))
    }

    fn ends(self) -> Option<([BodyId; 2], [Vec2; 2])> {
        match self {
            Self::Length { bodies, points } => Some((bodies, points)),
            Self::Angle(_) | Self::Travel(_) => None,
        }
    }

    fn meaning(self, law: Strength) -> &'static str {
        match (self, law) {
            (Self::Angle(_), Strength::Direct) => "moment on the second body",
            (Self::Angle(_), _) => "moment of the first body on the second",
            (Self::Travel(_), _) => "force along the slide, of the first body on the second",
            (Self::Length { .. }, _) => BETWEEN_POINTS,
        }
    }

    fn label(self, law: Strength, names: &LoadNames<'_>) -> String {
        let word = law.words().load[usize::from(self.is_angle())];
        match (self, law) {
            (Self::Angle(bodies), Strength::Direct) => names.on_second(word, bodies),
            (Self::Angle(bodies) | Self::Length { bodies, .. }, _) => names.between(word, bodies),
            (Self::Travel(_), _) => format!("{word} along a slide"),
        }
    }
}

/// A kind of load that there is in the plane or in space alone.
pub trait SpecialKind {
    /// The effect of a positive force or moment of it; `None` if it has no column of its own.
    const MEANING: Option<&'static str>;
    /// Whether it is a couple.
    const IS_COUPLE: bool;
    /// Whether it can do work.
    const DOES_WORK: bool;

    /// A description with the names of bodies and joints.
    fn label(&self, names: &LoadNames<'_>) -> String;
}

impl SpecialKind for Mesh {
    const IS_COUPLE: bool = false;
    // It acts across the velocity of the teeth.
    const DOES_WORK: bool = false;
    // It is beside the tooth force.
    const MEANING: Option<&'static str> = None;

    fn label(&self, _: &LoadNames<'_>) -> String {
        "separating force of teeth".to_owned()
    }
}

impl<V, C: LoadCoordinate<Point = V>, S> AnyLoadKind<V, C, S> {
    /// A couple F, N·m, of the first body on the second.
    pub fn couple(of: C::Turn) -> Self {
        Self::Along(C::angle(of), Strength::Direct)
    }

    /// A torsional spring: F is its stiffness, N·m/rad; couple −F (angle − free) of the first body on the second. In the plane,
    /// [`Model::with_loads`](crate::Model::with_loads) describes how whole revolutions of the angle are counted.
    pub fn torsion_spring(of: C::Turn, free_angle: f64) -> Self {
        Self::Along(C::angle(of), Strength::Elastic { free: free_angle })
    }

    /// A torsional damper: F is its constant, N·m·s/rad; couple −F × relative speed on the second.
    pub fn rotational_damper(of: C::Turn) -> Self {
        Self::Along(C::angle(of), Strength::Viscous)
    }

    /// The drag of a fan: F is its coefficient, N·m·s²/rad²; couple −F |ω| ω on the second, with the relative speed ω.
    pub fn rotational_drag(of: C::Turn) -> Self {
        Self::Along(C::angle(of), Strength::Quadratic)
    }

    /// A force F, N, that pushes two points apart.
    pub fn point_to_point_force(bodies: [BodyId; 2], points: [V; 2]) -> Self {
        Self::Along(C::distance(bodies, points), Strength::Direct)
    }

    /// A spring between two points: F is its stiffness, N/m; it pulls with F (length − free).
    pub fn spring(bodies: [BodyId; 2], points: [V; 2], free_length: f64) -> Self {
        let strength = Strength::Elastic { free: free_length };
        Self::Along(C::distance(bodies, points), strength)
    }

    /// A damper between two points: F is its constant, N·s/m; it resists with F × d(length)/dt.
    pub fn damper(bodies: [BodyId; 2], points: [V; 2]) -> Self {
        Self::Along(C::distance(bodies, points), Strength::Viscous)
    }

    /// A force F, N, of a joint's first body on its second along their slide, at the second body's point.
    pub fn slide_force(of: C::Slide) -> Self {
        Self::Along(C::travel(of), Strength::Direct)
    }

    /// Viscous friction in a slide: F is its constant, N·s/m; it resists with F × speed of travel.
    pub fn slide_damper(of: C::Slide) -> Self {
        Self::Along(C::travel(of), Strength::Viscous)
    }
}

/// The properties of a kind of load, in the plane or in space.
pub trait LoadShape: Debug + Copy + PartialEq + Send + Sync + 'static {
    /// Its law.
    fn strength(&self) -> Strength;
    /// Whether it is gravity.
    fn is_gravity(&self) -> bool;
    /// Whether it is a couple.
    fn is_couple(&self) -> bool;
    /// Whether it can do work in some motion: all but the separating force of teeth.
    fn does_work(&self) -> bool;
    /// Whether it has a potential where its magnitude is constant: gravity, springs and forces of constant direction.
    fn has_potential(&self) -> bool;

    /// The effect of a positive force or moment of it; `None` for weight, and if it has no column.
    fn meaning(&self) -> Option<&'static str>;

    /// A description with the names of bodies and joints.
    fn label(&self, names: &LoadNames<'_>) -> String;

    /// The unit of its force or moment.
    fn force_unit(&self) -> &'static str {
        Strength::Direct.words().units[usize::from(self.is_couple())]
    }

    /// The unit of its magnitude.
    fn unit(&self) -> &'static str {
        if self.is_gravity() {
            "m/s2"
        } else {
            self.strength().words().units[usize::from(self.is_couple())]
        }
    }

    /// The units of w and of c of a force and of a moment, along an angle or a length.
    fn response_units(&self, is_angle: bool) -> [&'static str; 3] {
        if self.is_gravity() {
            [if is_angle { "kg m" } else { "kg" }, "kg", "kg m"]
        } else {
            self.strength().response_units(self.is_couple(), is_angle)
        }
    }

    /// The work of a unit of it over the size (m) of a mechanism of this mass (kg), or over one radian; zero for resistances. m, kg m, m²
    /// or 1.
    fn work_lever(&self, size: f64, mass: f64) -> f64 {
        match (self.is_gravity(), self.is_couple()) {
            _ if !self.does_work() => 0.0,
            (true, _) => size * mass,
            (false, true) => self.strength().work_lever(1.0),
            (false, false) => self.strength().work_lever(size),
        }
    }
}

impl<V, C, S> LoadShape for AnyLoadKind<V, C, S>
where
    Self: Debug + Copy + PartialEq + Send + Sync + 'static,
    C: LoadCoordinate<Point = V>,
    S: SpecialKind,
{
    fn strength(&self) -> Strength {
        match *self {
            Self::Along(_, strength) => strength,
            Self::Drag { .. } => Strength::Quadratic,
            Self::Gravity { .. } | Self::Force { .. } | Self::Special(_) => Strength::Direct,
        }
    }

    fn is_gravity(&self) -> bool {
        matches!(self, Self::Gravity { .. })
    }

    fn is_couple(&self) -> bool {
        match self {
            Self::Along(coordinate, _) => coordinate.is_angle(),
            Self::Special(_) => S::IS_COUPLE,
            Self::Gravity { .. } | Self::Force { .. } | Self::Drag { .. } => false,
        }
    }

    fn does_work(&self) -> bool {
        !matches!(self, Self::Special(_)) || S::DOES_WORK
    }

    fn has_potential(&self) -> bool {
        match self {
            Self::Gravity { .. } => true,
            Self::Force { direction, .. } => matches!(direction, Direction::Ground(_)),
            Self::Along(_, strength) => strength.free().is_some(),
            Self::Drag { .. } | Self::Special(_) => false,
        }
    }

    fn meaning(&self) -> Option<&'static str> {
        match self {
            Self::Gravity { .. } => None,
            Self::Force { .. } => Some("force along its direction"),
            Self::Along(coordinate, law) => Some(coordinate.meaning(*law)),
            Self::Drag { .. } => Some("force along the velocity of its point"),
            Self::Special(_) => S::MEANING,
        }
    }

    fn label(&self, names: &LoadNames<'_>) -> String {
        let word = self.strength().words().load[0];
        match self {
            Self::Gravity { .. } => "gravity".to_owned(),
            Self::Force { body, .. } | Self::Drag { body, .. } => {
                format!("{word} on {}", names.bodies[body.0])
            }
            Self::Along(coordinate, law) => coordinate.label(*law, names),
            Self::Special(special) => special.label(names),
        }
    }
}

impl<V, C, S, N: Constant> AnyLoadKind<V, C, S, N> {
    /// A unit of it, as of [`Strength::unit`], and its magnitude.
    pub(crate) fn unit_load(self) -> (Self, f64) {
        match self {
            Self::Along(coordinate, strength) => {
                let (strength, magnitude) = strength.unit();
                (Self::Along(coordinate, strength), magnitude)
            }
            other => (other, 1.0),
        }
    }
}

impl<V, C: LoadCoordinate<Point = V>, S> AnyLoadKind<V, C, S> {
    /// The symbol that is drawn between two points of bodies, with these bodies and points.
    pub fn symbol(&self) -> Option<(LoadSymbol, [BodyId; 2], [V; 2])> {
        let Self::Along(coordinate, strength) = self else {
            return None;
        };
        let (bodies, points) = coordinate.ends()?;
        Some((strength.symbol()?, bodies, points))
    }
}

impl LoadKind {
    /// The bodies it acts on; none of gravity, which acts on all that have mass.
    pub(crate) fn bodies(&self) -> &[BodyId] {
        match self {
            Self::Gravity { .. } => &[],
            Self::Force { body, .. } | Self::Drag { body, .. } => std::slice::from_ref(body),
            Self::Along(
                CoordinateFunction::Angle(bodies)
                | CoordinateFunction::Travel(Guide { bodies, .. })
                | CoordinateFunction::Length { bodies, .. },
                _,
            )
            | Self::Special(Mesh { bodies, .. }) => bodies,
        }
    }

    /// A couple or force along a coordinate, positive in the direction in which the coordinate grows; none if the
    /// mechanism has no such coordinate.
    pub fn along(mechanism: &Mechanism, coordinate: Coordinate) -> Option<Self> {
        let function = CoordinateFunction::find(mechanism, coordinate)?;
        Some(Self::Along(function, Strength::Direct))
    }

    /// The two bodies on whose relative angle, with whole revolutions, a load of this kind itself depends; none for most.
    pub fn angle_pair(self) -> Option<[BodyId; 2]> {
        match self {
            Self::Along(CoordinateFunction::Angle(bodies), law) => law.free().map(|_| bodies),
            _ => None,
        }
    }

    /// The coordinate along which two surfaces slide whose friction is a load of this kind: of a pin or of a guide. No
    /// other load is a friction.
    pub fn sliding_coordinate(self) -> Option<CoordinateFunction> {
        match self {
            Self::Along(coordinate, Strength::Direct) if coordinate.ends().is_none() => {
                Some(coordinate)
            }
            _ => None,
        }
    }
}
