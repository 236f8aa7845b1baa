//! The branch of claimed states: that of the assembly, by continuing its pose densely.

use super::DensePose;
use super::state::{SpaceCase, SpaceState};
use crate::comparison::{Comparison, FindingSpec, LargestDifference};
use crate::error::Result;
use dwell_findings::{Check, Finding};
use dwell_geometry::space::{Placement, Vec3};

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

/// Where the bodies are after the coordinates have moved from the assembly to other values on a straight line, closed densely all the way.
///
/// # Errors
/// [`DenseError`] where a pose on the way has no closed one beside it.
pub(super) fn continued(case: &SpaceCase<'_>, q: &[f64]) -> Result<Vec<Placement>> {
    let mut at = case.start.1.to_vec();
    for (_, coordinates) in case.positions_towards(q, BRANCH_STEP) {
        let wanted = (&coordinates[..], Some(&at[..]));
        let pose = DensePose::nearest(case.mechanism, &at, wanted, case.size)?;
        at = pose.placements.into_owned();
    }
    Ok(at)
}

/// How far a body is from another placement, parts of the size or rad; how it stands about the line of its two balls is nobody's.
fn apart(case: &SpaceCase<'_>, body: usize, [found, wanted]: [&Placement; 2]) -> f64 {
    let turned = |v: Vec3| (found.rotation.apply(v) - wanted.rotation.apply(v)).norm();
    let idle = case.idle.iter().find(|idle| idle.body.0 == body);
    let turn: f64 = match idle {
        Some(idle) => turned(idle.axis),
        None => Vec3::AXES.map(turned).into_iter().sum(),
    };
    let point = idle.map_or(Vec3::ZERO, |idle| idle.point);
    let at = |p: &Placement| p.position + p.rotation.apply(point);
    turn + (at(found) - at(wanted)).norm() / case.size
}

/// Checks that claimed states are on the branch of the assembly: their placements with those to which it leads, closed densely all the way.
/// It costs some closings for each rad.
pub fn check_branch_in_space(case: &SpaceCase<'_>, states: &[SpaceState]) -> Finding {
    let mut worst = LargestDifference::default();
    let mut poses = 0;
    let mut last: Option<&SpaceState> = None;
    for claimed in states {
        let is_known = last
            .replace(claimed)
            .is_some_and(|last| last.q == claimed.q && last.placements == claimed.placements);
        if is_known {
            continue;
        }
        poses += 1;
        let wanted = match continued(case, &claimed.q) {
            Ok(wanted) => wanted,
            Err(error) => {
                worst.record_failure(error.to_string());
                continue;
            }
        };
        for (body, both) in claimed.placements.iter().zip(&wanted).enumerate() {
            let distance = apart(case, body, [both.0, both.1]);
            let comparison = Comparison::new([distance, 1.0, 0.0], "", 1.0);
            let name = &case.mechanism.bodies[body].name;
            worst.record(&comparison, || format!("q = {:?}, {name}", claimed.q));
        }
    }
    BRANCH.finding(format!("{poses} poses"), worst)
}
