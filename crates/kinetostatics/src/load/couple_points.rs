//! Where a couple between two bodies acts.

use dwell_geometry::{BodyId, Joint, JointKind, Mechanism, Plan, Vec2};

/// The points of two bodies at which a couple between them acts: those of a joint between them, of a revolute one
/// if there is one; else the origins of the bodies.
pub(crate) fn find_couple_points(
    mechanism: &Mechanism,
    plan: &Plan,
    bodies: [BodyId; 2],
) -> [Vec2; 2] {
    let joints = || {
        let between = |j: &&Joint| j.bodies == bodies || j.bodies == [bodies[1], bodies[0]];
        mechanism.joints.iter().filter(between)
    };
    let pin = joints().find(|j| j.kind == JointKind::Revolute);
    match pin.or_else(|| joints().next()) {
        Some(joint) if joint.bodies == bodies => joint.points,
        Some(joint) => [joint.points[1], joint.points[0]],
        None => bodies.map(|b| plan.tree().joint_origins[b.0]),
    }
}
