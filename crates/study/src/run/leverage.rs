//! What follows from speeds by a division: mechanical advantage, and the poles of a body. Where there
//! is nothing to divide by they have no value, which is NaN here and an empty cell in a table.

use dwell_geometry::measure::BodyStates;
use dwell_geometry::{BodyId, Vec2};

/// A speed below this part of the fastest body's is rounding: advantages beyond a billion and poles
/// farther than a billion sizes away are told as none.
const STILL: f64 = 1e-9;

/// How fast the bodies of one state are at most.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pace {
    /// A length to compare turning with travelling by, m.
    size: f64,
    /// m/s and m/s².
    speed: f64,
    acceleration: f64,
}

impl Pace {
    pub(crate) fn of(states: &BodyStates, size: f64) -> Self {
        let mut pace = Self {
            size,
            ..Self::default()
        };
        for body in (0..states.len()).map(|b| states.body(BodyId(b))) {
            let turning = bent(body.spin, body.spin_rate);
            pace.speed = pace.speed.max(body.velocity.norm());
            pace.speed = pace.speed.max(body.spin.abs() * size);
            pace.acceleration = pace.acceleration.max(body.acceleration.norm());
            pace.acceleration = pace.acceleration.max(turning * size);
        }
        pace
    }

    /// dq/dθ of a body, or dq/ds of one of its points, at unit speed q̇: by virtual work the couple
    /// or the force along its path that a unit of the actuator's action balances.
    pub(crate) fn advantage(&self, unit: &BodyStates, body: BodyId, point: Option<Vec2>) -> f64 {
        let (rate, lever) = match point {
            None => (unit.body(body).spin, self.size),
            Some(at) => (unit.point(body, at).velocity.norm(), 1.0),
        };
        let moves = rate.abs() * lever > STILL * self.speed;
        if moves { 1.0 / rate } else { f64::NAN }
    }

    /// The point of a body that has no velocity, in ground axes: v + ω ẑ×r = 0.
    pub(crate) fn pole(&self, states: &BodyStates, body: BodyId) -> Vec2 {
        let state = states.body(body);
        if state.spin.abs() * self.size <= STILL * self.speed {
            return NOWHERE;
        }
        states.origin() + state.root + state.velocity.perp() * (1.0 / state.spin)
    }

    /// The point of a body that has no acceleration: a + α ẑ×r − ω² r = 0.
    pub(crate) fn acceleration_pole(&self, states: &BodyStates, body: BodyId) -> Vec2 {
        let state = states.body(body);
        let (square, rate) = (state.spin * state.spin, state.spin_rate);
        let turning = bent(state.spin, rate);
        if turning * self.size <= STILL * self.acceleration {
            return NOWHERE;
        }
        let a = state.acceleration;
        let away = (a * square + a.perp() * rate) * (1.0 / (turning * turning));
        states.origin() + state.root + away
    }
}

const NOWHERE: Vec2 = Vec2 {
    x: f64::NAN,
    y: f64::NAN,
};

/// What turns a distance into an acceleration: √(ω⁴ + α²), 1/s².
fn bent(spin: f64, rate: f64) -> f64 {
    (spin * spin).hypot(rate)
}
