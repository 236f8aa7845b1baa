//! The independent truths, one file each. The numbers are those of the finding's `truth`.

mod balance;
mod bodies;
mod closure;
mod energy;
mod power;
mod published;
mod released;
mod slope;
mod spectral;
mod values;

pub use balance::balance;
pub use bodies::bodies;
pub use closure::closure;
pub use energy::energy;
pub use power::power;
pub use published::{Point, Sample, published};
pub use released::released;
pub use slope::slope;
pub use spectral::spectral;
pub use values::{Value, Values, values};

use crate::bench::{Bench, Site};
use crate::closing::Closed;
use dwell_laws::Polynomial;

/// The (q̇, q̈) that a position is passed with, rad/s and rad/s²: both signs of each, of like
/// size, so that no term of a balance is small in all of them.
const MOTIONS: [[f64; 2]; 3] = [[1.0, 0.7], [-0.8, 0.5], [0.6, -1.2]];

/// The longest step of a difference turns no body by more than this (rad), nor moves one by more
/// than this many sizes, to first order. Measured on the test mechanisms: from 0.12 to
/// 0.8 the findings hardly differ, at 0.06 second differences lose a digit to rounding.
const FIRST_TURN: f64 = 0.3;

/// The longest step in the imposed value of a row with unit speeds `u`. Since it is measured by
/// what it does to the mechanism, it suits rows in m and in rad, and is shorter near a dead point.
fn row_step(bench: &Bench<'_>, u: &[f64]) -> f64 {
    FIRST_TURN / bench.dense.reach(u)
}

/// The longest step in time for a motion that passes a site: the time it takes to go one step of
/// q, t with |q̇| t + ½ |q̈| t² = h.
fn time_step(bench: &Bench<'_>, site: &Site, [q_dot, q_ddot]: [f64; 2]) -> f64 {
    let h = row_step(bench, site.speed());
    let speed = q_dot.abs();
    2.0 * h / (speed + (speed * speed + 2.0 * q_ddot.abs() * h).sqrt())
}

/// The mechanism at time `t` of a motion that starts at a site, with its speeds.
fn pass(bench: &Bench<'_>, site: &Site, law: &Polynomial, t: f64) -> Option<(Closed, Vec<f64>)> {
    let (dense, row) = (&bench.dense, bench.dense.actuator_row());
    let [q, q_dot, _] = law.at(t);
    let closed = dense.step(&site.closed, row, site.speed(), q).ok()?;
    let x_dot = dense
        .unit_speed(&closed, row)
        .iter()
        .map(|u| u * q_dot)
        .collect();
    Some((closed, x_dot))
}

/// `phi = 1.3 rad, 1 rad/s, 0.7 rad/s2`.
fn place_in(bench: &Bench<'_>, q: f64, [q_dot, q_ddot]: [f64; 2]) -> String {
    let unit = bench.unit();
    format!("{}, {q_dot} {unit}/s, {q_ddot} {unit}/s2", bench.place(q))
}

/// What a table of motions adds to "24 positions …".
fn over_motions(bench: &Bench<'_>) -> String {
    format!("{}, each passed in {} motions", bench.over(), MOTIONS.len())
}
