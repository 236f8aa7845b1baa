//! The branch of claimed states: that of the assembly, by continuing its pose densely.

use super::state::{SpaceCase, SpaceState, poses};
use crate::comparison::{Comparison, FindingSpec, LargestDifference};
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

/// Steps of the coordinates within which Newton's method stays on the branch: rad, or parts of the size.
const BRANCH_STEP: f64 = 0.1;

impl SpaceCase<'_> {
    /// The coordinates on a straight line from those at the assembly to others, in short steps.
    fn positions_towards(&self, q: &[f64]) -> impl Iterator<Item = Vec<f64>> {
        let both = move || self.start.0.iter().zip(q);
        let distances = both().enumerate();
        let distances = distances.map(|(k, (from, to))| (to - from).abs() / self.unit(k));
        let count = (distances.fold(0.0, f64::max) / BRANCH_STEP)
            .ceil()
            .max(1.0);
        (1..=count as usize).map(move |k| {
            let part = k as f64 / count;
            both().map(|(from, to)| from + part * (to - from)).collect()
        })
    }

    /// The moved frames after the coordinates have moved from the assembly to other values on a straight line, closed densely all the way.
    ///
    /// # Errors
    /// [`DenseError`](crate::DenseError) where a pose on the way has no closed one beside it.
    fn continued(&self, dense: &DenseMechanism, q: &[f64]) -> Result<Vec<Pose>> {
        let mut at = dense.moved_frames(&poses(self.start.1))?;
        let mut row_values = vec![0.0; dense.rows.len()];
        for coordinates in self.positions_towards(q) {
            row_values[dense.actuator_row()..].copy_from_slice(&coordinates);
            at = dense.close(&at, &row_values)?.poses;
        }
        Ok(at)
    }
}

/// Checks that claimed states are on the branch of the assembly: their placements with those to which it leads, closed densely all the way,
/// with the teeth of gears meshed as they were there. It costs some closings for each rad.
pub fn check_branch_in_space(case: &SpaceCase<'_>, states: &[SpaceState]) -> Finding {
    let mut worst = LargestDifference::default();
    let mut count = 0;
    let mut last: Option<&SpaceState> = None;
    let dense = match case.dense() {
        Ok(dense) => dense,
        Err(error) => return not_dense(&BRANCH, &error),
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
        let both = found.and_then(|found| Ok((found, case.continued(&dense, &claimed.q)?)));
        let (found, wanted) = match both {
            Ok(both) => both,
            Err(error) => {
                worst.record_failure(error.to_string());
                continue;
            }
        };
        for (b, body) in dense.moving_bodies() {
            let distance = dense.body_distance(b, [&found[b], &wanted[b]]);
            let comparison = Comparison::new([distance, 1.0, 0.0], "", 1.0);
            worst.record(&comparison, || {
                format!("q = {:?}, {}", claimed.q, body.name)
            });
        }
    }
    BRANCH.finding(format!("{count} poses"), worst)
}
