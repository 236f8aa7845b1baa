//! Quantities of a state by the names that tables and references use.

use crate::cases::model_states::StateValues;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{BodyId, Component, Coordinate, JointId, Vec2};
use dwell_scene::PlaneScene;

/// The kinds of quantities, as findings call them: each is compared relative to the largest of its unit.
pub(crate) const KINDS: [&str; 5] = [
    "positions",
    "velocities",
    "accelerations",
    "reactions",
    "actuator-forces",
];

/// A quantity of a state. An order is 0 for a position, 1 for its velocity, 2 for its acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum StateQuantity {
    /// Angle of a body, and its rates.
    BodyAngle(BodyId, usize),
    /// x, y of a point given in its body's frame (m), then their velocities, then their accelerations.
    PointCoordinate(BodyId, Vec2, usize),
    /// A coordinate of the mechanism.
    Coordinate(Coordinate, usize),
    /// A reaction, by its index in the mechanism.
    Reaction(usize, Component),
    /// An actuator force.
    ActuatorForce(usize),
}

/// The index of a word.
fn position(words: &[&str], word: &str) -> Option<usize> {
    words.iter().position(|other| *other == word)
}

impl StateQuantity {
    /// The quantity of a name in a scene; none if it has no such quantity.
    pub(crate) fn find(scene: &PlaneScene, name: &str) -> Option<Self> {
        let coordinate = |name, order| Some(Self::Coordinate(scene.coordinate(name)?, order));
        let Some((whose, what)) = name.split_once('.') else {
            return coordinate(name, 0);
        };
        Self::of_body(scene, whose, what)
            .or_else(|| coordinate(whose, 1 + position(&["velocity", "acceleration"], what)?))
            .or_else(|| Self::of_joint(scene, whose, what, name))
            .or_else(|| {
                let mut actuators = scene.mechanism.actuators.iter();
                let found = actuators.position(|a| a.name == whose && what == "actuator_force");
                found.map(Self::ActuatorForce)
            })
    }

    fn of_body(scene: &PlaneScene, whose: &str, what: &str) -> Option<Self> {
        let mut bodies = scene.mechanism.bodies.iter();
        let body = bodies.position(|b| b.name == whose)?;
        let id = BodyId(body);
        let angles = ["angle", "angular_velocity", "angular_acceleration"];
        if let Some(order) = position(&angles, what) {
            return Some(Self::BodyAngle(id, order));
        }
        let (point, part) = what.split_once('.')?;
        let (_, at) = scene.points[body].iter().find(|(name, _)| name == point)?;
        let part = position(&["x", "y", "vx", "vy", "ax", "ay"], part)?;
        Some(Self::PointCoordinate(id, *at, part))
    }

    fn of_joint(scene: &PlaneScene, whose: &str, what: &str, name: &str) -> Option<Self> {
        let mechanism = &scene.mechanism;
        if what == "travel" {
            let joint = mechanism.joints.iter().position(|j| j.name == whose)?;
            let travel = Coordinate::Travel(JointId(joint));
            CoordinateFunction::find(mechanism, travel)?;
            return Some(Self::Coordinate(travel, 0));
        }
        let reactions = mechanism.reactions();
        let named = |&r| mechanism.reaction_name(r) == name;
        let found = reactions.iter().position(named)?;
        Some(Self::Reaction(found, reactions[found].component))
    }

    /// Its kind, one of [`KINDS`].
    pub(crate) fn kind(self) -> &'static str {
        KINDS[match self {
            Self::BodyAngle(_, order) | Self::Coordinate(_, order) => order,
            Self::PointCoordinate(_, _, part) => part / 2,
            Self::Reaction(..) => 3,
            Self::ActuatorForce(_) => 4,
        }]
    }

    /// Its unit.
    pub(crate) fn unit(self, scene: &PlaneScene) -> &'static str {
        const ANGLES: [&str; 3] = ["rad", "rad/s", "rad/s2"];
        const LENGTHS: [&str; 3] = ["m", "m/s", "m/s2"];
        match self {
            Self::BodyAngle(_, order) => ANGLES[order],
            Self::PointCoordinate(_, _, part) => LENGTHS[part / 2],
            Self::Coordinate(c, order) if c.is_angle() => ANGLES[order],
            Self::Coordinate(_, order) => LENGTHS[order],
            Self::Reaction(_, component) => component.unit(),
            Self::ActuatorForce(k) => scene.mechanism.actuators[k].coordinate().force_unit(),
        }
    }

    /// Its value in a state, SI; not a number where it does not exist.
    pub(crate) fn value(self, evaluated: &StateValues<'_>) -> f64 {
        let states = evaluated.state.bodies();
        let result = evaluated.state.inverse_dynamics();
        match self {
            Self::BodyAngle(body, 0) => evaluated.angles[body.0],
            Self::BodyAngle(body, 1) => states.body(body).angular_velocity,
            Self::BodyAngle(body, _) => states.body(body).angular_acceleration,
            Self::PointCoordinate(body, at, part) => {
                let point = states.point(body, at);
                let vector = [point.position, point.velocity, point.acceleration][part / 2];
                [vector.x, vector.y][part % 2]
            }
            // Whole revolutions are counted by body.
            Self::Coordinate(Coordinate::Angle([one, two]), 0) => {
                evaluated.angles[two.0] - evaluated.angles[one.0]
            }
            Self::Coordinate(coordinate, order) => {
                let found = CoordinateFunction::find(&evaluated.scene.mechanism, coordinate);
                found.map_or(f64::NAN, |found| states.coordinate(found)[order])
            }
            Self::Reaction(k, _) => result.reactions[k],
            Self::ActuatorForce(k) => result.tau[k],
        }
    }
}
