//! Bodies, joints and actuators made in one expression.

use super::{Actuator, ActuatorKind, Body, BodyId, Coordinate, Guide, Joint, JointKind, Mechanism};
use crate::plane::Vec2;

impl From<usize> for BodyId {
    fn from(index: usize) -> Self {
        Self(index)
    }
}

impl Body {
    /// A body of this name.
    ///
    /// ```
    /// use dwell_geometry::Body;
    ///
    /// let bodies: Vec<Body> = ["ground", "crank"].map(Body::named).into();
    /// assert_eq!(bodies[1].name, "crank");
    /// ```
    pub fn named(name: impl Into<String>) -> Self {
        Self { name: name.into() }
    }
}

impl Joint {
    /// A joint between two bodies, given by their [`BodyId`] or its number, at a point of each in that body's frame, m.
    ///
    /// ```
    /// use dwell_geometry::{Joint, JointKind, vec2};
    ///
    /// let weld = Joint::new("tip", [1, 2], [vec2(0.4, 0.0), vec2(0.0, 0.0)], JointKind::Weld { angle: 0.5 });
    /// assert_eq!(weld.bodies[1].0, 2);
    /// ```
    pub fn new(
        name: impl Into<String>,
        bodies: [impl Into<BodyId>; 2],
        points: [Vec2; 2],
        kind: JointKind,
    ) -> Self {
        Self {
            name: name.into(),
            bodies: bodies.map(Into::into),
            points,
            kind,
        }
    }

    /// A revolute joint: the two points, m in the frames of their bodies, coincide.
    ///
    /// ```
    /// use dwell_geometry::{Joint, Vec2, vec2};
    ///
    /// let crank_pin = Joint::revolute("B", [1, 2], [vec2(0.1, 0.0), Vec2::ZERO]);
    /// assert_eq!(crank_pin.points[0].x, 0.1);
    /// ```
    pub fn revolute(
        name: impl Into<String>,
        bodies: [impl Into<BodyId>; 2],
        points: [Vec2; 2],
    ) -> Self {
        Self::new(name, bodies, points, JointKind::Revolute)
    }

    /// A prismatic joint through two points, m in the frames of their bodies, along an axis at an angle, rad, in each of
    /// the two frames.
    ///
    /// ```
    /// use dwell_geometry::{Joint, JointKind, Vec2};
    ///
    /// let guide = Joint::prismatic("guide", [0, 3], [Vec2::ZERO; 2], [0.0; 2]);
    /// assert_eq!(guide.kind, JointKind::Prismatic { axes: [Vec2::IDENTITY; 2] });
    /// ```
    pub fn prismatic(
        name: impl Into<String>,
        bodies: [impl Into<BodyId>; 2],
        points: [Vec2; 2],
        axis_angles: [f64; 2],
    ) -> Self {
        let axes = axis_angles.map(Vec2::from_angle);
        Self::new(name, bodies, points, JointKind::Prismatic { axes })
    }

    /// The line along which it slides; none of a joint that has no travel.
    pub fn guide(&self) -> Option<Guide> {
        let (bodies, points) = (self.bodies, self.points);
        self.kind.travel_axis().map(|axis| Guide {
            bodies,
            points,
            axis,
        })
    }
}

impl Actuator {
    /// An actuator between two bodies, given by their [`BodyId`] or its number.
    ///
    /// ```
    /// use dwell_geometry::{Actuator, ActuatorKind, JointId};
    ///
    /// let piston = Actuator::new("s", [0, 3], ActuatorKind::Travel(JointId(3)));
    /// assert_eq!(piston.coordinate().unit(), "m");
    /// ```
    pub fn new(
        name: impl Into<String>,
        bodies: [impl Into<BodyId>; 2],
        kind: ActuatorKind,
    ) -> Self {
        Self {
            name: name.into(),
            bodies: bodies.map(Into::into),
            kind,
        }
    }

    /// An actuator of the angle, rad, of the second body from the first.
    ///
    /// ```
    /// use dwell_geometry::Actuator;
    ///
    /// assert!(Actuator::angle("phi", [0, 1]).coordinate().is_angle());
    /// ```
    pub fn angle(name: impl Into<String>, bodies: [impl Into<BodyId>; 2]) -> Self {
        Self::new(name, bodies, ActuatorKind::Angle)
    }

    /// An actuator of a coordinate of a mechanism; `None` if it is the travel of a joint that the mechanism does not have.
    ///
    /// ```
    /// use dwell_geometry::{Actuator, Coordinate, JointId, Mechanism};
    ///
    /// let travel = Coordinate::Travel(JointId(0));
    /// assert_eq!(Actuator::of("s", travel, &Mechanism::default()), None);
    /// ```
    pub fn of(
        name: impl Into<String>,
        coordinate: Coordinate,
        mechanism: &Mechanism,
    ) -> Option<Self> {
        let (bodies, kind) = match coordinate {
            Coordinate::Angle(bodies) => (bodies, ActuatorKind::Angle),
            Coordinate::Travel(joint) => {
                let bodies = mechanism.joints.get(joint.0)?.bodies;
                (bodies, ActuatorKind::Travel(joint))
            }
            Coordinate::Length { bodies, points } => (bodies, ActuatorKind::Length(points)),
        };
        Some(Self::new(name, bodies, kind))
    }
}
