//! The branch of claimed states: that of the assembly, by continuing its pose densely.

use super::state::{SpaceCase, SpaceState, poses};
use crate::comparison::{Comparison, FindingSpec, LargestDifference};
use crate::constraint_closing::Configuration;
use crate::dense::DenseMechanism;
use crate::error::Result;
use crate::pose::Pose;
use crate::state::not_dense;
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

impl SpaceCase<'_> {
    /// The pose of the assembly, closed.
    fn start(&self, dense: &DenseMechanism) -> Result<Configuration> {
        Ok(dense.close_at(&poses(self.start.1), self.start.0)?.0)
    }

    /// The moved frames after the coordinates have moved from the assembly to other values on a straight line, closed densely all the way.
    fn continued(dense: &DenseMechanism, start: &Configuration, q: &[f64]) -> Result<Vec<Pose>> {
        let mut row_values = start.row_values.clone();
        row_values[dense.actuator_row()..].copy_from_slice(q);
        Ok(dense.follow_to(start, &row_values)?.poses)
    }
}

/// Checks that claimed states are on the branch of the assembly: their placements with those to which it leads, closed densely all the way.
/// It costs some closings for each rad.
pub fn check_branch_in_space(case: &SpaceCase<'_>, states: &[SpaceState]) -> Finding {
    compare_continued(
        case,
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
pub(super) fn check_mesh(case: &SpaceCase<'_>, states: &[SpaceState]) -> Finding {
    compare_continued(
        case,
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

/// Compares the moved frames of claimed states with those that are continued from the assembly to their coordinates.
fn compare_continued(
    case: &SpaceCase<'_>,
    spec: &FindingSpec<'_>,
    states: &[SpaceState],
    compare: impl Fn(&DenseMechanism, &SpaceState, [&[Pose]; 2], &mut LargestDifference),
) -> Finding {
    let mut worst = LargestDifference::default();
    let mut count = 0;
    let mut last: Option<&SpaceState> = None;
    let assembled = case
        .dense()
        .and_then(|dense| Ok((case.start(&dense)?, dense)));
    let (start, dense) = match assembled {
        Ok(assembled) => assembled,
        Err(error) => return not_dense(spec, &error),
    };
    for claimed in states {
        let is_known = last
            .replace(claimed)
            .is_some_and(|last| last.q == claimed.q && last.placements == claimed.placements);
        if is_known {
            continue;
        }
        count += 1;
        let found = dense.moved_frames(&poses(&claimed.placements));
        let both = found.and_then(|found| {
            let wanted = SpaceCase::continued(&dense, &start, &claimed.q)?;
            Ok((found, wanted))
        });
        match both {
            Ok((found, wanted)) => compare(&dense, claimed, [&found, &wanted], &mut worst),
            Err(error) => worst.record_failure(error.to_string()),
        }
    }
    spec.finding(format!("{count} poses"), worst)
}
