//! Checks that claimed states are on the branch of the assembly, by continuing its pose densely.

use super::{AssembledMechanism, ClaimedState, not_dense};
use crate::comparison::{Comparison, FindingSpec, LargestDifference};
use crate::constraint_closing::Configuration;
use crate::dense::DenseMechanism;
use crate::error::{DenseError, Result};
use crate::pose::Pose;
use dwell_findings::{Check, Finding};

const BRANCH: FindingSpec<'_> = FindingSpec {
    key: "state-branch",
    check: Check::ConstraintClosure,
    comparison: "the placements with those of the branch of the assembly, continued densely",
    scale: "the size of the mechanism, or one radian",
    // The largest seen is 1.1e-6, on the Bricard linkage.
    tolerance: 1e-4,
    tolerance_reason: "the root of rounding, where redundant rows are independent off the closed pose; other branches are much further away",
};

const MESH: FindingSpec<'_> = FindingSpec {
    key: "state-mesh",
    comparison: "the teeth of gears with those of the assembly, continued densely",
    scale: "the size of the mechanism, or one metre",
    // The largest seen in a case is 1.2e-14, after 20 rad.
    tolerance: 1e-13,
    tolerance_reason: "rounding, amplified by the condition of the equations",
    ..BRANCH
};

/// The mechanism in dense rows, and the pose of its assembly, closed.
fn closed(assembled: &AssembledMechanism<'_>) -> Result<(DenseMechanism, Configuration)> {
    let dense = assembled.dense()?;
    if assembled.q.len() != dense.actuators.len() {
        return Err(DenseError::InvalidPoses);
    }
    let (start, _) = dense.close_at(assembled.poses, assembled.q)?;
    Ok((dense, start))
}

/// The moved frames after the coordinates have moved from the assembly to other values on a straight line, closed densely all the way.
fn continued(dense: &DenseMechanism, start: &Configuration, q: &[f64]) -> Result<Vec<Pose>> {
    let mut row_values = start.row_values.clone();
    row_values[dense.actuator_row()..].copy_from_slice(q);
    Ok(dense.follow_to(start, &row_values)?.poses)
}

/// Checks that claimed states are on the branch of the assembly: their placements with those to which it leads, closed densely all the way.
/// It costs some closings for each rad.
pub fn check_branch(assembled: &AssembledMechanism<'_>, states: &[ClaimedState]) -> Finding {
    compare_continued(
        assembled,
        &BRANCH,
        states,
        |dense, claimed, [found, wanted], worst| {
            for (b, body) in dense.moving_bodies() {
                let distance = dense.body_distance(b, [&found[b], &wanted[b]]);
                let comparison = Comparison::new([distance, 1.0, 0.0], "", 1.0);
                worst.record(&comparison, || {
                    format!("q = {:?}, {}", claimed.q, body.name)
                });
            }
        },
    )
}

/// Checks that the teeth of gears in claimed states mesh as they did at the assembly.
pub(super) fn check_mesh(assembled: &AssembledMechanism<'_>, states: &[ClaimedState]) -> Finding {
    compare_continued(
        assembled,
        &MESH,
        states,
        |dense, claimed, [found, wanted], worst| {
            for (row, off) in dense.rows.teeth_off(wanted, found) {
                let comparison = Comparison::new([off, dense.size().max(1.0), 0.0], "m", 1.0);
                worst.record(&comparison, || {
                    format!("q = {:?}, {}", claimed.q, dense.row_names[row])
                });
            }
        },
    )
}

/// Compares the moved frames of claimed states with the frames continued from the assembly to their coordinates.
fn compare_continued(
    assembled: &AssembledMechanism<'_>,
    spec: &FindingSpec<'_>,
    states: &[ClaimedState],
    compare: impl Fn(&DenseMechanism, &ClaimedState, [&[Pose]; 2], &mut LargestDifference),
) -> Finding {
    let mut worst = LargestDifference::default();
    let mut count = 0;
    let mut last: Option<&ClaimedState> = None;
    let (dense, start) = match closed(assembled) {
        Ok(closed) => closed,
        Err(error) => return not_dense(spec, &error),
    };
    for claimed in states {
        let is_known = last
            .replace(claimed)
            .is_some_and(|last| last.q == claimed.q && last.poses == claimed.poses);
        if is_known {
            continue;
        }
        count += 1;
        let found = dense.moved_frames(&claimed.poses);
        let both = found.and_then(|found| {
            let wanted = continued(&dense, &start, &claimed.q)?;
            Ok((found, wanted))
        });
        match both {
            Ok((found, wanted)) => compare(&dense, claimed, [&found, &wanted], &mut worst),
            Err(error) => worst.record_failure(error.to_string()),
        }
    }
    spec.finding(format!("{count} poses"), worst)
}
