//! Check 0: the subject's poses close every joint, and lie on one branch.
//!
//! Everything else is measured where the subject says the mechanism is, so that has to be right
//! first. With x the subject's pose and x* the nearest pose that meets all rows,
//!
//! ```text
//! Φ(x*) = 0,  D(x*) = q                                      (1)
//! |x − x*| → 0                                               (2)
//! ```
//!
//! A subject that changed its assembly branch between two positions would satisfy (1) and (2) at
//! both. So the branch is also followed from position to position, by Newton steps too short to
//! jump, and must arrive where the subject says (modulo whole turns of a body).

use crate::comparison::{Comparison, FindingSpec, LargestDifference};
use crate::context::{CheckContext, CheckedPosition};
use dwell_findings::{Check, Finding};
use std::f64::consts::TAU;

/// Both findings.
pub fn closure(context: &CheckContext<'_>) -> Vec<Finding> {
    let mut closing = context.for_each_position(|position, worst| {
        let comparison = position.comparison(
            position.closing_correction,
            1.0,
            position.pose_rounding_bound,
            "",
        );
        worst.record(&comparison, || context.location(position.q));
        Ok(())
    });
    for (q, reason) in &context.not_closed {
        closing.record_failure(format!("{}: {reason}", context.location(*q)));
    }
    vec![
        FindingSpec {
            key: "closure",
            check: Check::ConstraintClosure,
            comparison: "the subject's poses with the nearest ones that meet every dense row",
            scale: "the largest coordinate of a pose",
            tolerance: 1e-13,
            tolerance_reason: "a pose is given in rounded coordinates, and closed from rounded attachments",
        }
.finding(context.domain(), closing),
        FindingSpec {
            key: "branch",
            check: Check::ConstraintClosure,
            comparison: "the subject's poses with those reached by following the first one through the range",
            scale: "the mechanism's size, angles in rad",
            tolerance: 1e-12,
            tolerance_reason: "both ends are closed to rounding; another branch is another configuration",
        }
.finding(context.domain(), branch(context)),
    ]
}

fn branch(context: &CheckContext<'_>) -> LargestDifference {
    let (dense, row) = (&context.dense, context.dense.actuator_row());
    let mut sorted: Vec<&CheckedPosition> = context.positions.iter().collect();
    sorted.sort_by(|a, b| a.q.total_cmp(&b.q));
    let mut worst = LargestDifference::default();
    let Some((first, others)) = sorted.split_first() else {
        return worst;
    };
    let mut here = first.configuration.clone();
    worst.record(&comparison_at(0.0, first), || context.location(first.q));
    for position in others {
        match dense.follow_with_best_rows(&here, row, position.q) {
            Ok(next) => here = next,
            Err(error) => {
                worst.record_failure(format!(
                    "between the assembly and {}: {error}",
                    context.location(position.q)
                ));
                return worst;
            }
        }
        let mut difference: Vec<_> = here
            .x
            .iter()
            .zip(&position.configuration.x)
            .map(|(a, b)| a - b)
            .collect();
        for angle in difference.iter_mut().skip(2).step_by(3) {
            *angle -= TAU * (*angle / TAU).round();
        }
        worst.record(
            &comparison_at(dense.scaled_norm(&difference), position),
            || context.location(position.q),
        );
    }
    worst
}

fn comparison_at(difference: f64, position: &CheckedPosition) -> Comparison {
    position.comparison(difference, 1.0, 0.0, "")
}
