//! Everything at once.

use crate::bench::Bench;
use crate::case::Case;
use crate::judge::{Check, Worst};
use crate::subject::Subject;
use crate::truths::{self, Sample};
use dwell_findings::Finding;
use rayon::prelude::*;

/// Holds a subject against every truth, in parallel. The findings come in a fixed order, that of
/// the truths' numbers. If the mechanism itself cannot be written in dense rows, there is one
/// failed finding that says why.
pub fn verify_all(case: &Case<'_>, subject: &dyn Subject, published: &[Sample]) -> Vec<Finding> {
    let bench = match Bench::new(case, subject) {
        Ok(bench) => bench,
        Err(error) => return vec![not_dense(error.to_string())],
    };
    let truths: [fn(&Bench<'_>) -> Vec<Finding>; 8] = [
        truths::closure,
        truths::energy,
        truths::slope,
        truths::spectral,
        truths::released,
        truths::power,
        truths::balance,
        truths::bodies,
    ];
    let mut findings: Vec<Finding> = truths
        .par_iter()
        .flat_map_iter(|truth| truth(&bench))
        .collect();
    findings.extend(truths::published(case, subject, published));
    findings
}

fn not_dense(message: String) -> Finding {
    let mut worst = Worst::default();
    worst.refuse(message);
    Check {
        key: "closure",
        truth: "0 closure",
        compared: "the mechanism with as many dense rows as it has coordinates",
        over: "the mechanism as a whole".to_owned(),
        scale: "none",
        tolerance: 0.0,
        why: "the truths need a determinate mechanism of one degree of freedom",
    }
    .judge(worst)
}
