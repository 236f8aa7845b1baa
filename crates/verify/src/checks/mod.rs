//! The independent checks, one file each, numbered as [`dwell_findings::Check`].

mod balances;
pub(crate) mod closure;
mod energy_slope;
mod kinetic_energy;
mod published;
mod reference_values;
mod released_constraint;
mod spectral;

pub(crate) use balances::balances;
pub(crate) use energy_slope::energy_slope;
pub(crate) use kinetic_energy::kinetic_energy;
pub use published::{PublishedPoint, PublishedSample, published};
pub use reference_values::{ComparedValue, compare_values};
pub(crate) use released_constraint::released_constraint;
pub(crate) use spectral::spectral;

use crate::context::CheckContext;

/// The longest step of a difference rotates no body by more than this (rad), nor moves one by more
/// than this many sizes, to first order. Measured on the test mechanisms: from 0.12 to
/// 0.8 the findings hardly differ, at 0.06 second differences lose a digit to rounding.
pub(crate) const MAX_DIFFERENCE_STEP: f64 = 0.3;

/// The longest step in the imposed value of a row with unit velocities `u`. Since it is measured by
/// what it does to the mechanism, it suits rows in m and in rad, and is shorter near a dead point.
fn row_step(context: &CheckContext<'_>, u: &[f64]) -> f64 {
    MAX_DIFFERENCE_STEP / context.dense.scaled_norm(u)
}

/// Units of a coefficient a and a coefficient b.
fn coefficient_units(moment: bool) -> [&'static str; 2] {
    match moment {
        true => ["N m per rad/s2", "N m per (rad/s)2"],
        false => ["N per rad/s2", "N per (rad/s)2"],
    }
}
