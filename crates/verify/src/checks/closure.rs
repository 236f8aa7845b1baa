//! Check 0: the subject's poses close every joint, and lie on one branch.
//!
//! Everything else is measured in the subject's poses, so they are checked
//! first. With x the subject's pose and x* the nearest pose that meets all rows,
//!
//! ```text
//! Φ(x*) = 0,  D(x*) = q                                      (1)
//! |x − x*| → 0                                               (2)
//! ```
//!
//! A subject that changed its assembly branch between two positions would satisfy (1) and (2) at both. Therefore the
//! branch is also followed from position to position, by Newton steps too short to jump, and must arrive at the pose of
//! the subject (modulo whole revolutions of a body).

use crate::comparison::{FindingSpec, LargestDifference};
use crate::context::{CheckContext, CheckedPosition};
use crate::error::DenseError;
use dwell_findings::{Check, Finding};

const CLOSURE: FindingSpec<'_> = FindingSpec {
    key: "closure",
    check: Check::ConstraintClosure,
    comparison: "the subject's poses with the nearest ones that meet every dense row",
    scale: "the largest coordinate of a pose",
    tolerance: 1e-13,
    tolerance_reason: "a pose is given in rounded coordinates, and closed from rounded attachments",
};
const BRANCH: FindingSpec<'_> = FindingSpec {
    key: "branch",
    comparison: "the subject's poses with those reached by following the first one through the range",
    scale: "the mechanism's size, angles in rad",
    tolerance: 1e-12,
    tolerance_reason: "both ends are closed to rounding; another branch is another configuration",
    ..CLOSURE
};
const NOT_DENSE: FindingSpec<'_> = FindingSpec {
    comparison: "the mechanism with as many dense rows as it has coordinates",
    scale: "none",
    tolerance: 0.0,
    tolerance_reason: "the checks need a determinate mechanism of one degree of freedom",
    ..CLOSURE
};

/// Both findings.
pub(crate) fn closure(context: &CheckContext<'_>) -> Vec<Finding> {
    let [mut closing] = context.for_each_position(|position, [worst]| {
        let (correction, bound) = (position.closing_correction, position.pose_rounding_bound);
        let numbers = [correction, 1.0, bound];
        position.record(worst, numbers, "", || context.location(position.q));
        Ok(())
    });
    for (q, reason) in &context.not_closed {
        closing.record_failure(format!("{}: {reason}", context.location(*q)));
    }
    vec![
        CLOSURE.finding(context.domain(), closing),
        BRANCH.finding(context.domain(), branch(context)),
    ]
}

/// The one finding of a mechanism that has no dense rows.
pub(crate) fn not_dense(error: &DenseError) -> Finding {
    let failed = LargestDifference::failed(error.to_string());
    NOT_DENSE.finding("the mechanism as a whole".to_owned(), failed)
}

fn branch(context: &CheckContext<'_>) -> LargestDifference {
    let (dense, row) = (&context.dense, context.dense.actuator_row());
    let mut sorted: Vec<&CheckedPosition> = context.positions.iter().collect();
    sorted.sort_by(|a, b| a.q.total_cmp(&b.q));
    let mut worst = LargestDifference::default();
    let mut here = sorted.first().map(|first| first.configuration.clone());
    for position in sorted {
        let location = || context.location(position.q);
        let Some(before) = &here else { break };
        match dense.follow(before, row, position.q) {
            Ok(next) => {
                let distance = dense.distance(&next, &position.configuration);
                position.record(&mut worst, [distance, 1.0, 0.0], "", location);
                here = Some(next);
            }
            Err(error) => {
                let between = format!("between the assembly and {}: {error}", location());
                worst.record_failure(between);
                break;
            }
        }
    }
    worst
}
