//! Watched results as plain numbers.

use super::watched::Watched;
use dwell_geometry::{BodyId, Plan, Pose, Vec2};
use dwell_kinetostatics::{Actions, Workspace};

/// A pose in plain numbers, for what only reads positions.
pub(crate) fn plain_pose(plan: &Plan, pose: &Pose<Watched>) -> Pose<f64> {
    let mut out = plan.pose::<f64>();
    let numbers = |to: &mut Vec<f64>, from: &[Watched]| {
        to.clear();
        to.extend(from.iter().map(|v| v.0));
    };
    let vectors = |to: &mut Vec<Vec2>, from: &[Vec2<Watched>]| {
        to.clear();
        to.extend(from.iter().map(|v| dwell_geometry::vec2(v.x.0, v.y.0)));
    };
    numbers(&mut out.q, &pose.q);
    vectors(&mut out.turn, &pose.turn);
    numbers(&mut out.angle, &pose.angle);
    vectors(&mut out.arm, &pose.arm);
    numbers(&mut out.slide, &pose.slide);
    numbers(&mut out.travel, &pose.travel);
    out
}

/// The second derivatives of the frames of all bodies.
pub(crate) fn accelerations(work: &Workspace<Watched>, bodies: usize) -> Vec<[f64; 3]> {
    let of = |b: usize| {
        let origin = work.states().point(BodyId(b), Vec2::ZERO).acceleration;
        [origin.x, origin.y, work.states().body(BodyId(b)).spin_rate].map(|v| v.0)
    };
    (0..bodies).map(of).collect()
}

/// Actions and reactions.
pub(crate) fn plain_actions(actions: &Actions<Watched>) -> Actions<f64> {
    let plain = |values: &[Watched]| values.iter().map(|v| v.0).collect();
    Actions {
        tau: plain(&actions.tau),
        reactions: plain(&actions.reactions),
    }
}
