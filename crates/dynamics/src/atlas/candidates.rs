//! The coordinates in which a motion of one degree of freedom can be described.

use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{Actuator, BodyId, Coordinate, JointId, Mechanism};

/// What an angle between two moving bodies counts against one from the ground: it may fold sooner.
const RELATIVE_ANGLE_WEIGHT: f64 = 0.5;

/// A coordinate that a chart may have.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    pub(super) name: String,
    pub(super) coordinate: Coordinate,
    pub(super) measured: CoordinateFunction,
    /// What its speed is multiplied by to compare it.
    pub(super) weight: f64,
}

/// The mechanism with an actuator of another coordinate; none of a joint that is not there.
pub(super) fn with_actuator(
    mechanism: &Mechanism,
    name: String,
    coordinate: Coordinate,
) -> Option<Mechanism> {
    Some(Mechanism {
        actuators: vec![Actuator::of(name, coordinate, mechanism)?],
        ..mechanism.clone()
    })
}

/// The mechanism's own coordinate, the angles of all bodies and of all hinges, and all travels.
pub(super) fn candidates(mechanism: &Mechanism, size: f64) -> Vec<Candidate> {
    let mut found: Vec<Candidate> = Vec::new();
    let ground = BodyId(mechanism.ground);
    let mut add = |name: String, coordinate: Coordinate| {
        let reversed = |c: Coordinate| match c {
            Coordinate::Angle([a, b]) => Coordinate::Angle([b, a]),
            other => other,
        };
        let known =
            |c: &Candidate| c.coordinate == coordinate || c.coordinate == reversed(coordinate);
        if found.iter().any(known) {
            return;
        }
        let weight = match coordinate {
            Coordinate::Angle(bodies) if bodies.contains(&ground) => 1.0,
            Coordinate::Angle(_) => RELATIVE_ANGLE_WEIGHT,
            Coordinate::Travel(_) | Coordinate::Length { .. } => 1.0 / size,
        };
        if let Some(measured) = CoordinateFunction::find(mechanism, coordinate) {
            found.push(Candidate {
                name,
                coordinate,
                measured,
                weight,
            });
        }
    };
    if let Some(actuator) = mechanism.actuators.first() {
        add(actuator.name.clone(), actuator.coordinate());
    }
    for b in (0..mechanism.bodies.len()).map(BodyId) {
        if b != ground {
            let name = format!("angle of {}", mechanism.body_name(b));
            add(name, Coordinate::Angle([ground, b]));
        }
    }
    for (j, joint) in mechanism.joints.iter().enumerate() {
        if joint.kind.is_pin() {
            let name = format!("angle in {}", joint.name);
            add(name, Coordinate::Angle(joint.bodies));
        } else if joint.kind.travel_axis().is_some() {
            let name = format!("travel in {}", joint.name);
            add(name, Coordinate::Travel(JointId(j)));
        }
    }
    found
}
