//! Quantities of a state by the names that tables and references use.

use crate::claims::Moment;
use dwell_geometry::measure::Measured;
use dwell_geometry::{BodyId, Component, Coordinate, JointId, Vec2};
use dwell_scene::Scene;

/// How often a quantity is differentiated with time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rate {
    /// Not at all: an angle or a place.
    Value,
    /// Once.
    Speed,
    /// Twice.
    Acceleration,
}

/// What a name stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Quantity {
    /// Angle of a body, and its rates.
    Turn(BodyId, Rate),
    /// A coordinate along x (false) or y (true) of a point given in its body's frame, m.
    Place(BodyId, Vec2, Rate, bool),
    /// A coordinate of the mechanism.
    Coordinate(Coordinate, Rate),
    /// A reaction, by its index in the mechanism.
    Reaction(usize, Component),
    /// What an actuator does.
    Action(usize),
}

/// What quantities are judged together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Angles and places.
    Positions,
    /// Their first rates.
    Velocities,
    /// Their second rates.
    Accelerations,
    /// Reactions of joints.
    Reactions,
    /// Actions of actuators.
    Actions,
}

fn rate(name: &str) -> Option<Rate> {
    match name {
        "speed" => Some(Rate::Speed),
        "acceleration" => Some(Rate::Acceleration),
        _ => None,
    }
}

/// `x`, `vy`, `ax` …
fn along(name: &str) -> Option<(Rate, bool)> {
    let (rate, axis) = match name.as_bytes() {
        [axis] => (Rate::Value, axis),
        [b'v', axis] => (Rate::Speed, axis),
        [b'a', axis] => (Rate::Acceleration, axis),
        _ => return None,
    };
    match axis {
        b'x' => Some((rate, false)),
        b'y' => Some((rate, true)),
        _ => None,
    }
}

impl Quantity {
    /// What a name stands for in a scene; none if it has no such quantity.
    pub(crate) fn find(scene: &Scene, name: &str) -> Option<Self> {
        let Some((whose, what)) = name.split_once('.') else {
            return Some(Self::Coordinate(scene.coordinate(name)?, Rate::Value));
        };
        Self::of_body(scene, whose, what)
            .or_else(|| Some(Self::Coordinate(scene.coordinate(whose)?, rate(what)?)))
            .or_else(|| Self::of_joint(scene, whose, what, name))
            .or_else(|| {
                let mut actuators = scene.mechanism.actuators.iter();
                let found = actuators.position(|a| a.name == whose && what == "action");
                found.map(Self::Action)
            })
    }

    fn of_body(scene: &Scene, whose: &str, what: &str) -> Option<Self> {
        let mut bodies = scene.mechanism.bodies.iter();
        let body = bodies.position(|b| b.name == whose)?;
        let id = BodyId(body);
        if what == "angle" {
            return Some(Self::Turn(id, Rate::Value));
        }
        if let Some(rate) = rate(what) {
            return Some(Self::Turn(id, rate));
        }
        let (point, axis) = what.split_once('.')?;
        let (_, at) = scene.points[body].iter().find(|(name, _)| name == point)?;
        let (rate, up) = along(axis)?;
        Some(Self::Place(id, *at, rate, up))
    }

    fn of_joint(scene: &Scene, whose: &str, what: &str, name: &str) -> Option<Self> {
        let mechanism = &scene.mechanism;
        if what == "travel" {
            let joint = mechanism.joints.iter().position(|j| j.name == whose)?;
            let travel = Coordinate::Travel(JointId(joint));
            Measured::find(mechanism, travel)?;
            return Some(Self::Coordinate(travel, Rate::Value));
        }
        let reactions = mechanism.reactions();
        let named = |&r| mechanism.reaction_name(r) == name;
        let found = reactions.iter().position(named)?;
        Some(Self::Reaction(found, reactions[found].component))
    }

    /// What it is judged with.
    pub(crate) fn kind(self) -> Kind {
        match self {
            Self::Turn(_, rate) | Self::Place(_, _, rate, _) | Self::Coordinate(_, rate) => {
                match rate {
                    Rate::Value => Kind::Positions,
                    Rate::Speed => Kind::Velocities,
                    Rate::Acceleration => Kind::Accelerations,
                }
            }
            Self::Reaction(..) => Kind::Reactions,
            Self::Action(_) => Kind::Actions,
        }
    }

    /// Its unit.
    pub(crate) fn unit(self, scene: &Scene) -> &'static str {
        let of = |angle: bool, rate: Rate| match (angle, rate) {
            (true, Rate::Value) => "rad",
            (true, Rate::Speed) => "rad/s",
            (true, Rate::Acceleration) => "rad/s2",
            (false, Rate::Value) => "m",
            (false, Rate::Speed) => "m/s",
            (false, Rate::Acceleration) => "m/s2",
        };
        match self {
            Self::Turn(_, rate) => of(true, rate),
            Self::Place(_, _, rate, _) => of(false, rate),
            Self::Coordinate(coordinate, rate) => of(coordinate.is_angle(), rate),
            Self::Reaction(_, component) => component.unit(),
            Self::Action(actuator) => {
                let drive = scene.mechanism.actuators[actuator].coordinate();
                if drive.is_angle() { "N m" } else { "N" }
            }
        }
    }

    /// Its value at a moment, SI. What cannot be measured there is no number.
    pub(crate) fn at(self, moment: &Moment<'_>) -> f64 {
        let states = moment.work.states();
        match self {
            Self::Turn(body, Rate::Value) => moment.angles[body.0],
            Self::Turn(body, Rate::Speed) => states.body(body).spin,
            Self::Turn(body, Rate::Acceleration) => states.body(body).spin_rate,
            Self::Place(body, at, rate, up) => {
                let point = states.point(body, at);
                let vector = match rate {
                    Rate::Value => point.position,
                    Rate::Speed => point.velocity,
                    Rate::Acceleration => point.acceleration,
                };
                if up { vector.y } else { vector.x }
            }
            // Whole turns are counted by body.
            Self::Coordinate(Coordinate::Angle([one, two]), Rate::Value) => {
                moment.angles[two.0] - moment.angles[one.0]
            }
            Self::Coordinate(coordinate, rate) => {
                let found = Measured::find(&moment.scene.mechanism, coordinate);
                let [value, speed, acceleration] =
                    found.map_or([f64::NAN; 3], |found| states.measure(found));
                match rate {
                    Rate::Value => value,
                    Rate::Speed => speed,
                    Rate::Acceleration => acceleration,
                }
            }
            Self::Reaction(k, _) => moment.actions.reactions[k],
            Self::Action(k) => moment.actions.tau[k],
        }
    }
}
