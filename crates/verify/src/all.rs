//! Everything at once.

use crate::case::Case;
use crate::checks::{
    PublishedSample, balances, closure, energy_slope, kinetic_energy, published,
    released_constraint, spectral,
};
use crate::context::CheckContext;
use crate::subject::Subject;
use dwell_findings::Finding;
use rayon::prelude::*;

/// Compares a subject with every check, in parallel. The findings come in a fixed order, that of
/// the checks' numbers. If the mechanism itself cannot be written in dense rows, there is one
/// failed finding that says why.
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
        kinetic_energy,
        energy_slope,
        spectral,
        released_constraint,
        balances,
    ];
    let all = checks.par_iter().flat_map_iter(|check| check(&context));
    let mut findings: Vec<Finding> = all.collect();
    findings.extend(published(case, subject, samples));
    findings
}
