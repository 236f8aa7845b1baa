//! Quotients of velocities: mechanical advantage, and the poles of a body. Where the divisor vanishes
//! they are undefined: NaN here, an empty cell in a table.

use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{BodyId, Vec2, vec2};

/// A speed below this fraction of the fastest body's is rounding: advantages beyond 1e9 and poles
/// farther away than 1e9 sizes are undefined.
const MIN_SPEED_RATIO: f64 = 1e-9;

/// The largest speed and acceleration of the bodies of one state.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SpeedScale {
    /// Length that relates angular to linear velocity, m.
    length: f64,
    /// m/s and m/s².
    speed: f64,
    acceleration: f64,
}

impl SpeedScale {
    pub(crate) fn new(states: &BodyStates, length: f64) -> Self {
        let mut scale = Self {
            length,
            ..Self::default()
        };
        for body in (0..states.len()).map(|b| states.body(BodyId(b))) {
            let rotation = acceleration_factor(body.angular_velocity, body.angular_acceleration);
            scale.speed = scale.speed.max(body.velocity.norm());
            scale.speed = scale.speed.max(body.angular_velocity.abs() * length);
            scale.acceleration = scale.acceleration.max(body.acceleration.norm());
            scale.acceleration = scale.acceleration.max(rotation * length);
        }
        scale
    }

    /// dq/dθ of a body, or dq/ds of one of its points, from the state at q̇ = 1: by virtual work the moment,
    /// or the force along the path, that one unit of actuator force balances.
    pub(crate) fn mechanical_advantage(
        &self,
        unit_speed: &BodyStates,
        body: BodyId,
        point: Option<Vec2>,
    ) -> f64 {
        let (speed, lever) = match point {
            None => (unit_speed.body(body).angular_velocity, self.length),
            Some(at) => (unit_speed.point(body, at).velocity.norm(), 1.0),
        };
        let moves = speed.abs() * lever > MIN_SPEED_RATIO * self.speed;
        if moves { 1.0 / speed } else { f64::NAN }
    }

    /// The point of a body that has no velocity, in ground axes: v + ω ẑ×r = 0.
    pub(crate) fn pole(&self, states: &BodyStates, body: BodyId) -> Vec2 {
        let state = states.body(body);
        if state.angular_velocity.abs() * self.length <= MIN_SPEED_RATIO * self.speed {
            return NO_POLE;
        }
        states.origin()
            + state.joint_origin
            + state.velocity.perp() * (1.0 / state.angular_velocity)
    }

    /// The point of a body that has no acceleration: a + α ẑ×r − ω² r = 0.
    pub(crate) fn acceleration_pole(&self, states: &BodyStates, body: BodyId) -> Vec2 {
        let state = states.body(body);
        let square = state.angular_velocity * state.angular_velocity;
        let angular_acceleration = state.angular_acceleration;
        let rotation = acceleration_factor(state.angular_velocity, angular_acceleration);
        if rotation * self.length <= MIN_SPEED_RATIO * self.acceleration {
            return NO_POLE;
        }
        let a = state.acceleration;
        let offset = (a * square + a.perp() * angular_acceleration) * (1.0 / (rotation * rotation));
        states.origin() + state.joint_origin + offset
    }
}

const NO_POLE: Vec2 = vec2(f64::NAN, f64::NAN);

/// Acceleration per distance from the acceleration pole: √(ω⁴ + α²), 1/s².
fn acceleration_factor(angular_velocity: f64, angular_acceleration: f64) -> f64 {
    (angular_velocity * angular_velocity).hypot(angular_acceleration)
}
