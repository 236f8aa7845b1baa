//! Springs and dampers between points.

use dwell_geometry::BodyId;
use dwell_geometry::space::Vec3;
use dwell_kinetostatics::space::LoadKind;
use dwell_page::LinkLook;

/// What is drawn between two points of bodies, in their frames, for a load; most loads have nothing there.
pub(super) fn link_of(load: &LoadKind) -> Option<(LinkLook, [(BodyId, Vec3); 2])> {
    let (look, bodies, points) = match *load {
        LoadKind::Spring { bodies, points, .. } => (LinkLook::Spring, bodies, points),
        LoadKind::Damper { bodies, points } => (LinkLook::Damper, bodies, points),
        LoadKind::Gravity(_)
        | LoadKind::Force { .. }
        | LoadKind::Torque { .. }
        | LoadKind::PointToPointForce { .. }
        | LoadKind::JointTorque(_)
        | LoadKind::TorsionSpring { .. }
        | LoadKind::RotationalDamper(_)
        | LoadKind::SlideForce(_)
        | LoadKind::SlideDamper(_) => return None,
    };
    Some((look, [0, 1].map(|k| (bodies[k], points[k]))))
}
