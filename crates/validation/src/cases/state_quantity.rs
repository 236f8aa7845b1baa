//! Quantities of a state by the names that tables and references use.

use crate::cases::model_states::StateValues;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{BodyId, Component, Coordinate, JointId, Vec2};
use dwell_scene::Scene;
use dwell_study::former_names;

/// The time derivative of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DerivativeOrder {
    /// None: an angle or a position.
    Value,
    /// The first.
    Velocity,
    /// The second.
    Acceleration,
}

/// A quantity of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum StateQuantity {
    /// Angle of a body, and its rates.
    BodyAngle(BodyId, DerivativeOrder),
    /// A coordinate along x (false) or y (true) of a point given in its body's frame, m.
    PointCoordinate(BodyId, Vec2, DerivativeOrder, bool),
    /// A coordinate of the mechanism.
    Coordinate(Coordinate, DerivativeOrder),
    /// A reaction, by its index in the mechanism.
    Reaction(usize, Component),
    /// An actuator force.
    ActuatorForce(usize),
}

/// Quantities that are compared relative to the largest of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum QuantityKind {
    /// Angles and positions.
    Positions,
    /// Their first rates.
    Velocities,
    /// Their second rates.
    Accelerations,
    /// Reactions of joints.
    Reactions,
    /// Actuator forces.
    ActuatorForces,
}

impl DerivativeOrder {
    /// One of a value and its two derivatives.
    fn of<T>(self, [value, velocity, acceleration]: [T; 3]) -> T {
        match self {
            Self::Value => value,
            Self::Velocity => velocity,
            Self::Acceleration => acceleration,
        }
    }
}

fn derivative_order(name: &str) -> Option<DerivativeOrder> {
    match name {
        "velocity" => Some(DerivativeOrder::Velocity),
        "acceleration" => Some(DerivativeOrder::Acceleration),
        _ => None,
    }
}

/// The name that a quantity has now, if `name` is one that it had before.
pub(crate) fn current_name(scene: &Scene, name: &str) -> Option<String> {
    if StateQuantity::find(scene, name).is_some() {
        return None;
    }
    former_names::current_columns(name).find(|name| StateQuantity::find(scene, name).is_some())
}

/// `x`, `vy`, `ax` …
fn point_component(name: &str) -> Option<(DerivativeOrder, bool)> {
    let (order, axis) = match name.as_bytes() {
        [axis] => (DerivativeOrder::Value, axis),
        [b'v', axis] => (DerivativeOrder::Velocity, axis),
        [b'a', axis] => (DerivativeOrder::Acceleration, axis),
        _ => return None,
    };
    match axis {
        b'x' => Some((order, false)),
        b'y' => Some((order, true)),
        _ => None,
    }
}

impl StateQuantity {
    /// The quantity of a name in a scene; none if it has no such quantity.
    pub(crate) fn find(scene: &Scene, name: &str) -> Option<Self> {
        let coordinate = |name, order| Some(Self::Coordinate(scene.coordinate(name)?, order));
        let Some((whose, what)) = name.split_once('.') else {
            return coordinate(name, DerivativeOrder::Value);
        };
        Self::of_body(scene, whose, what)
            .or_else(|| coordinate(whose, derivative_order(what)?))
            .or_else(|| Self::of_joint(scene, whose, what, name))
            .or_else(|| {
                let mut actuators = scene.mechanism.actuators.iter();
                let found = actuators.position(|a| a.name == whose && what == "actuator_force");
                found.map(Self::ActuatorForce)
            })
    }

    fn of_body(scene: &Scene, whose: &str, what: &str) -> Option<Self> {
        let mut bodies = scene.mechanism.bodies.iter();
        let body = bodies.position(|b| b.name == whose)?;
        let id = BodyId(body);
        let order = match what {
            "angle" => Some(DerivativeOrder::Value),
            "angular_velocity" => Some(DerivativeOrder::Velocity),
            "angular_acceleration" => Some(DerivativeOrder::Acceleration),
            _ => None,
        };
        if let Some(order) = order {
            return Some(Self::BodyAngle(id, order));
        }
        let (point, axis) = what.split_once('.')?;
        let (_, at) = scene.points[body].iter().find(|(name, _)| name == point)?;
        let (order, is_y) = point_component(axis)?;
        Some(Self::PointCoordinate(id, *at, order, is_y))
    }

    fn of_joint(scene: &Scene, whose: &str, what: &str, name: &str) -> Option<Self> {
        let mechanism = &scene.mechanism;
        if what == "travel" {
            let joint = mechanism.joints.iter().position(|j| j.name == whose)?;
            let travel = Coordinate::Travel(JointId(joint));
            CoordinateFunction::find(mechanism, travel)?;
            return Some(Self::Coordinate(travel, DerivativeOrder::Value));
        }
        let reactions = mechanism.reactions();
        let named = |&r| mechanism.reaction_name(r) == name;
        let found = reactions.iter().position(named)?;
        Some(Self::Reaction(found, reactions[found].component))
    }

    /// The quantities that it is compared with.
    pub(crate) fn kind(self) -> QuantityKind {
        match self {
            Self::BodyAngle(_, order)
            | Self::PointCoordinate(_, _, order, _)
            | Self::Coordinate(_, order) => order.of([
                QuantityKind::Positions,
                QuantityKind::Velocities,
                QuantityKind::Accelerations,
            ]),
            Self::Reaction(..) => QuantityKind::Reactions,
            Self::ActuatorForce(_) => QuantityKind::ActuatorForces,
        }
    }

    /// Its unit.
    pub(crate) fn unit(self, scene: &Scene) -> &'static str {
        const ANGLES: [&str; 3] = ["rad", "rad/s", "rad/s2"];
        const LENGTHS: [&str; 3] = ["m", "m/s", "m/s2"];
        match self {
            Self::BodyAngle(_, order) => order.of(ANGLES),
            Self::PointCoordinate(_, _, order, _) => order.of(LENGTHS),
            Self::Coordinate(c, order) => order.of(if c.is_angle() { ANGLES } else { LENGTHS }),
            Self::Reaction(_, component) => component.unit(),
            Self::ActuatorForce(k) => scene.mechanism.actuators[k].coordinate().force_unit(),
        }
    }

    /// Its value in a state, SI; not a number where it does not exist.
    pub(crate) fn value(self, evaluated: &StateValues<'_>) -> f64 {
        let states = evaluated.state.bodies();
        let result = evaluated.state.inverse_dynamics();
        match self {
            Self::BodyAngle(body, order) => {
                let state = states.body(body);
                order.of([
                    evaluated.angles[body.0],
                    state.angular_velocity,
                    state.angular_acceleration,
                ])
            }
            Self::PointCoordinate(body, at, order, is_y) => {
                let point = states.point(body, at);
                let vector = order.of([point.position, point.velocity, point.acceleration]);
                if is_y { vector.y } else { vector.x }
            }
            // Whole revolutions are counted by body.
            Self::Coordinate(Coordinate::Angle([one, two]), DerivativeOrder::Value) => {
                evaluated.angles[two.0] - evaluated.angles[one.0]
            }
            Self::Coordinate(coordinate, order) => {
                let found = CoordinateFunction::find(&evaluated.scene.mechanism, coordinate);
                order.of(found.map_or([f64::NAN; 3], |found| states.coordinate(found)))
            }
            Self::Reaction(k, _) => result.reactions[k],
            Self::ActuatorForce(k) => result.tau[k],
        }
    }
}
