//! Everything at once.

use crate::case::Case;
use crate::checks::{self, PublishedSample};
use crate::comparison::{FindingSpec, LargestDifference};
use crate::context::CheckContext;
use crate::subject::Subject;
use dwell_findings::{Check, Finding};
use rayon::prelude::*;

/// Holds a subject against every check, in parallel. The findings come in a fixed order, that of
/// the checks' numbers. If the mechanism itself cannot be written in dense rows, there is one
/// failed finding that says why.
pub fn verify_all(
    case: &Case<'_>,
    subject: &dyn Subject,
    published: &[PublishedSample],
) -> Vec<Finding> {
    let context = match CheckContext::new(case, subject) {
        Ok(context) => context,
        Err(error) => return vec![not_dense(error.to_string())],
    };
    let checks: [fn(&CheckContext<'_>) -> Vec<Finding>; 8] = [
        checks::closure,
        checks::kinetic_energy,
        checks::energy_slope,
        checks::spectral,
        checks::released_constraint,
        checks::power,
        checks::momentum,
        checks::newton_euler,
    ];
    let mut findings: Vec<Finding> = checks
        .par_iter()
        .flat_map_iter(|check| check(&context))
        .collect();
    findings.extend(checks::published(case, subject, published));
    findings
}

fn not_dense(message: String) -> Finding {
    let mut worst = LargestDifference::default();
    worst.record_failure(message);
    FindingSpec {
        key: "closure",
        check: Check::ConstraintClosure,
        comparison: "the mechanism with as many dense rows as it has coordinates",
        scale: "none",
        tolerance: 0.0,
        tolerance_reason: "the checks need a determinate mechanism of one degree of freedom",
    }
    .finding("the mechanism as a whole".to_owned(), worst)
}
