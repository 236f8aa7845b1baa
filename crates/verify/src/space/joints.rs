//! Positions of the sides of joints, and closure errors of joints.

use crate::description::space::mesh;
use dwell_geometry::space::{Joint, JointKind, Placement, Vec3};
use std::f64::consts::TAU;

/// The sides of a joint: axes u, w and normals n, p of both bodies, and d from the first point to the second.
pub(super) struct Sides {
    pub(super) u: Vec3,
    w: Vec3,
    n: Vec3,
    p: Vec3,
    pub(super) d: Vec3,
}

impl Sides {
    pub(super) fn of(joint: &Joint, placements: &[Placement]) -> Self {
        let of = |k: usize| (&placements[joint.bodies[k].0], &joint.sides[k]);
        let [a, b] = [0, 1].map(|k| {
            let (Placement { position, rotation }, side) = of(k);
            *position + rotation.apply(side.point)
        });
        let [u, w] = [0, 1].map(|k| of(k).0.rotation.apply(of(k).1.axis));
        let [n, p] = [0, 1].map(|k| of(k).0.rotation.apply(of(k).1.normal));
        Self {
            u,
            w,
            n,
            p,
            d: b - a,
        }
    }

    /// The angle from normal to normal about the first axis, without whole revolutions.
    pub(super) fn angle(&self) -> f64 {
        self.n.cross(self.p).dot(self.u).atan2(self.n.dot(self.p))
    }

    /// The difference of a screw's travel from that of its angle, m, without whole revolutions.
    fn screw_error(&self, pitch: f64) -> f64 {
        let turns = (self.d.dot(self.u) / pitch - self.angle()) / TAU;
        (turns - turns.round()) * TAU * pitch
    }
}

/// The closure error of a joint, m and rad, at placements of all bodies. The row of a gear pair is one of velocities:
/// [`mesh_error`] compares the travel of its wheels in two poses.
pub fn closure_error(joint: &Joint, placements: &[Placement]) -> f64 {
    let sides = Sides::of(joint, placements);
    let Sides { u, w, n, p, d } = sides;
    let (apart, tilt) = (d.norm(), (u - w).norm());
    let (off_line, turn) = (d.cross(u).norm(), (n - p).norm());
    let found: &[f64] = match joint.kind {
        JointKind::Weld => &[apart, tilt, turn],
        JointKind::Revolute => &[apart, tilt],
        JointKind::Prismatic => &[off_line, tilt, turn],
        JointKind::Cylindrical => &[off_line, tilt],
        JointKind::Helical { pitch } => &[off_line, tilt, sides.screw_error(pitch)],
        JointKind::Universal => &[apart, u.dot(w)],
        JointKind::Spherical => &[apart],
        JointKind::Planar => &[d.dot(u), tilt],
        JointKind::PointOnLine => &[off_line],
        JointKind::PointInPlane => &[d.dot(u)],
        JointKind::Distance { length } => &[apart - length],
        // Rows of velocities, and couplings: they are no conditions of two sides.
        JointKind::Gear { .. } | JointKind::Coupling { .. } => &[],
    };
    found.iter().fold(0.0, |all, part| all.max(part.abs()))
}

/// The mismatch of the teeth of a gear pair after a motion between two poses, m: their travel on the second wheel minus that on the first,
/// each relative to the carrier by the screw motion between the poses (its angle below half a revolution). `None` for other joints.
pub fn mesh_error(joint: &Joint, poses: [&[Placement]; 2]) -> Option<f64> {
    let mesh = mesh(joint)?;
    let [from, to] = poses.map(crate::pose::Pose::all_in_space);
    Some(mesh.travel(&from, &to))
}
