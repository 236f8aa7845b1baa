//! The independent checks, one file each, numbered as [`dwell_findings::Check`].

mod balances;
mod closure;
mod energy_slope;
mod kinetic_energy;
mod published;
mod reference_values;
mod released_constraint;
mod spectral;

pub use published::{PublishedPoint, PublishedSample, published};
pub use reference_values::{ComparedValue, compare_values};

use crate::case::Case;
use crate::context::CheckContext;
use crate::subject::Subject;
use dwell_findings::Finding;
use rayon::prelude::*;

/// Compares a subject with every check, in parallel. The findings come in a fixed order, that of the checks' numbers.
/// If the mechanism itself cannot be written in dense rows, there is one failed finding with the reason.
pub fn verify_all(
    case: &Case<'_>,
    subject: &dyn Subject,
    samples: &[PublishedSample],
) -> Vec<Finding> {
    let context = match CheckContext::new(case, subject) {
        Ok(context) => context,
        Err(error) => return vec![closure::not_dense(&error)],
    };
    let checks: [fn(&CheckContext<'_>) -> Vec<Finding>; 6] = [
        closure::closure,
        kinetic_energy::kinetic_energy,
        energy_slope::energy_slope,
        spectral::spectral,
        released_constraint::released_constraint,
        balances::balances,
    ];
    let all = checks.par_iter().flat_map_iter(|check| check(&context));
    let mut findings: Vec<Finding> = all.collect();
    findings.extend(published(case, subject, samples));
    findings
}

/// The longest step of a difference rotates no body by more than this (rad), nor moves one by more
/// than this many sizes, to first order. Measured on the test mechanisms: from 0.12 to
/// 0.8 the findings hardly differ, at 0.06 second differences lose a digit to rounding.
pub(crate) const MAX_DIFFERENCE_STEP: f64 = 0.3;

/// The longest step in the imposed value of a row with unit velocities `u`. Because it is measured by its effect on the
/// mechanism, it suits rows in m and in rad, and is shorter near a dead point.
fn row_step(context: &CheckContext<'_>, u: &[f64]) -> f64 {
    MAX_DIFFERENCE_STEP / context.dense.scaled_norm(u)
}

/// Units of a coefficient a and a coefficient b.
fn coefficient_units(moment: bool) -> [&'static str; 2] {
    if moment {
        ["N m per rad/s2", "N m per (rad/s)2"]
    } else {
        ["N per rad/s2", "N per (rad/s)2"]
    }
}
