//! Watched results as plain numbers.

use super::mutating_scalar::MutatingScalar;
use dwell_geometry::{Plan, Pose, Vec2};
use dwell_kinetostatics::InverseDynamics;

/// A pose in plain numbers, for what only reads positions.
pub(super) fn pose_to_f64(plan: &Plan, pose: &Pose<MutatingScalar>) -> Pose<f64> {
    let mut out = plan.pose::<f64>();
    let numbers = |to: &mut Vec<f64>, from: &[MutatingScalar]| {
        to.clear();
        to.extend(from.iter().map(|v| v.0));
    };
    let vectors = |to: &mut Vec<Vec2>, from: &[Vec2<MutatingScalar>]| {
        to.clear();
        to.extend(from.iter().map(|v| dwell_geometry::vec2(v.x.0, v.y.0)));
    };
    numbers(&mut out.q, &pose.q);
    vectors(&mut out.rotation, &pose.rotation);
    numbers(&mut out.angle, &pose.angle);
    vectors(&mut out.vector, &pose.vector);
    numbers(&mut out.slide_travel, &pose.slide_travel);
    numbers(&mut out.closure_travel, &pose.closure_travel);
    out
}

/// Actions and reactions.
pub(super) fn result_to_f64(result: &InverseDynamics<MutatingScalar>) -> InverseDynamics<f64> {
    let values_f64 = |values: &[MutatingScalar]| values.iter().map(|v| v.0).collect();
    InverseDynamics {
        tau: values_f64(&result.tau),
        reactions: values_f64(&result.reactions),
    }
}
