//! The independent checks, one file each. The numbers are those of the finding's `truth`.

mod balance;
mod closure;
mod energy_slope;
mod kinetic_energy;
mod momentum;
mod newton_euler;
mod power;
mod published;
mod reference_values;
mod released_constraint;
mod spectral;

pub use closure::closure;
pub use energy_slope::energy_slope;
pub use kinetic_energy::kinetic_energy;
pub use momentum::momentum;
pub use newton_euler::newton_euler;
pub use power::power;
pub use published::{PublishedPoint, PublishedSample, published};
pub use reference_values::{ComparedValue, compare_values};
pub use released_constraint::released_constraint;
pub use spectral::spectral;

use crate::constraint_closing::ClosedConfiguration;
use crate::context::{CheckContext, CheckedPosition};
use dwell_laws::Polynomial;

/// The (q̇, q̈) that a position is passed with, rad/s and rad/s²: both signs of each, of like
/// size, so that no term of a balance is small in all of them.
const MOTIONS: [[f64; 2]; 3] = [[1.0, 0.7], [-0.8, 0.5], [0.6, -1.2]];

/// The longest step of a difference turns no body by more than this (rad), nor moves one by more
/// than this many sizes, to first order. Measured on the test mechanisms: from 0.12 to
/// 0.8 the findings hardly differ, at 0.06 second differences lose a digit to rounding.
const MAX_DIFFERENCE_STEP: f64 = 0.3;

/// The longest step in the imposed value of a row with unit velocities `u`. Since it is measured by
/// what it does to the mechanism, it suits rows in m and in rad, and is shorter near a dead point.
fn row_step(context: &CheckContext<'_>, u: &[f64]) -> f64 {
    MAX_DIFFERENCE_STEP / context.dense.scaled_norm(u)
}

/// The longest step in time for a motion that passes a site: the time it takes to go one step of
/// q, t with |q̇| t + ½ |q̈| t² = h.
fn time_step(
    context: &CheckContext<'_>,
    position: &CheckedPosition,
    [q_dot, q_ddot]: [f64; 2],
) -> f64 {
    let h = row_step(context, position.unit_velocity());
    let speed = q_dot.abs();
    2.0 * h / (speed + (speed * speed + 2.0 * q_ddot.abs() * h).sqrt())
}

/// The mechanism at time `t` of a motion that starts at a site, with its speeds.
fn state_at(
    context: &CheckContext<'_>,
    position: &CheckedPosition,
    law: &Polynomial,
    t: f64,
) -> Option<(ClosedConfiguration, Vec<f64>)> {
    let (dense, row) = (&context.dense, context.dense.actuator_row());
    let [q, q_dot, ..] = law.eval(t);
    let configuration = dense
        .step_row(&position.configuration, row, position.unit_velocity(), q)
        .ok()?;
    let x_dot = dense
        .unit_velocity(&configuration, row)
        .iter()
        .map(|u| u * q_dot)
        .collect();
    Some((configuration, x_dot))
}

/// `phi = 1.3 rad, 1 rad/s, 0.7 rad/s2`.
fn motion_location(context: &CheckContext<'_>, q: f64, [q_dot, q_ddot]: [f64; 2]) -> String {
    let unit = context.unit();
    format!(
        "{}, {q_dot} {unit}/s, {q_ddot} {unit}/s2",
        context.location(q)
    )
}

/// What a table of motions adds to "24 positions …".
fn motions_domain(context: &CheckContext<'_>) -> String {
    format!(
        "{}, each passed in {} motions",
        context.domain(),
        MOTIONS.len()
    )
}
