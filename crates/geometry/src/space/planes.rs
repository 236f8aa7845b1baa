//! Planar loops. If all turns between the two bodies of a closure are about one direction n, and all slides between them are along n or
//! across it, then n is fixed in both bodies at all coordinates, and the closure's rows separate:
//!
//! ```text
//! turns about n, slides across n    move    points along directions across n, and angles about n
//! slides along n                    move    points along n
//! nothing                           moves   directions along n: they stay parallel
//! ```
//!
//! The rows of the closure are therefore given along n and across it, in the first body, and those that a freedom never changes are known
//! to be so, not merely found to be zero. A planar loop is then a group with two rows, or three, where its joints have five or six, and
//! what its plane leaves to its other freedoms, as the slide of a cylindrical joint, is a group of its own. Rows that nothing moves are in
//! no group. Their multipliers, forces along n and moments across it, are undetermined and set to zero.

use super::closure::{Closure, RowKind, rows_of};
use super::joint_kinds::JointKind;
use super::mechanism::{Mechanism, Side};
use super::plan::{Plan, Pose};
use super::positions::OPEN;
use super::tree::FreedomKind;
use super::vector::Vec3;
use dwell_numerics::Constant;

/// Directions are parallel, or at right angles, to this tolerance, the rounding of the numbers of a scene. An axis with a larger tilt is
/// solved as tilted, and its results have all digits.
const ALIGNED: f64 = 1e-13;

/// Whether two unit vectors have the same direction, or opposite ones.
pub(super) fn is_parallel(a: Vec3, b: Vec3) -> bool {
    a.cross(b).norm() < ALIGNED
}

/// Whether two unit vectors are at right angles.
pub(super) fn is_across(a: Vec3, b: Vec3) -> bool {
    a.dot(b).abs() < ALIGNED
}

/// The rows of a joint of this kind, with its number and its sides, along and across the plane that has this normal on both bodies.
pub(super) fn rows_along<C: Constant>(
    kind: JointKind,
    number: C,
    sides: [Side<C>; 2],
    own: [Vec3; 2],
) -> Option<Vec<RowKind<C>>> {
    let in_plane = |k: usize| {
        let (side, own) = (sides[k], own[k].cast::<C>());
        // The normals of a slide in the plane are that of the plane.
        let across = own - side.axis.scaled(side.axis.dot(own));
        let is_slide = kind == JointKind::Prismatic && is_across(side.axis.values(), own.values());
        let has_normal = is_slide && across.values().unit().is_some();
        Side {
            normal: if has_normal {
                across.normalised()
            } else {
                side.normal
            },
            ..side
        }
    };
    let u = own[0].any_normal();
    let axes = [u, own[0].cross(u), own[0]];
    let along = |row: RowKind<C>| match row {
        RowKind::Point(k) => RowKind::Along(axes[k].cast()),
        other => other,
    };
    let rows = rows_of(kind, number, &[in_plane(0), in_plane(1)])?;
    Some(rows.into_iter().map(along).collect())
}

impl Plan {
    /// Whether a loop keeps to a plane.
    pub fn keeps_to_planes(&self) -> bool {
        self.closures
            .iter()
            .any(|closure| !closure.unmoved.is_empty())
    }

    /// Gives each closure that keeps to a plane its rows along the plane and across it, at the assembled pose.
    pub(super) fn find_planes(&mut self, mechanism: &Mechanism, pose: &Pose) {
        for c in 0..self.closures.len() {
            let Some(normal) = self.normal_of(&self.closures[c], pose) else {
                continue;
            };
            if let Some((kinds, own)) = self.rows_in_plane(mechanism, c, normal, pose) {
                (self.closures[c].kinds, self.closures[c].plane) = (kinds, Some(own));
            }
            self.closures[c].unmoved = self.unmoved(&self.closures[c], normal, pose);
        }
    }

    /// The direction about which all turns on the path of a closure are; `None` if there is none, or a slide is oblique to it.
    // The axes are parallel at every pose if they are at one: nothing else turns the bodies between them.
    fn normal_of(&self, closure: &Closure, pose: &Pose) -> Option<Vec3> {
        let axis = |freedom: usize| pose.screws[freedom].axis;
        let kind = |freedom: usize| self.tree.freedoms[freedom];
        let mut path = closure.path.iter().map(|(freedom, _)| *freedom);
        let normal = axis(path.clone().find(|f| kind(*f) == FreedomKind::Turn)?);
        let fits = |freedom: usize| match kind(freedom) {
            FreedomKind::Turn => is_parallel(axis(freedom), normal),
            FreedomKind::Slide => {
                is_parallel(axis(freedom), normal) || is_across(axis(freedom), normal)
            }
            FreedomKind::Screw(_) | FreedomKind::BallTurn | FreedomKind::Length => false,
        };
        let is_loop = closure.joint.is_some() && closure.coupled.is_none();
        (is_loop && closure.on == closure.bodies && path.all(fits)).then_some(normal)
    }

    /// The rows of a closure along and across the plane with this normal, and that normal on both bodies; `None` if they would not be
    /// closed at the pose.
    fn rows_in_plane(
        &self,
        mechanism: &Mechanism,
        c: usize,
        normal: Vec3,
        pose: &Pose,
    ) -> Option<(Vec<RowKind>, [Vec3; 2])> {
        let closure = &self.closures[c];
        let joint = &mechanism.joints[closure.joint?.0];
        let own = closure
            .bodies
            .map(|body| pose.frames[body].rotation.apply_inverse(normal));
        let side = |k: usize| joint.sides[k].in_frame(&self.tree.internal[closure.bodies[k]]);
        let kinds = rows_along(joint.kind, joint.numbers().number, [side(0), side(1)], own)?;
        let [_, _, d] = closure.ends(&pose.frames);
        let is_closed = |kind: &RowKind| {
            let unit = if kind.is_length() { self.size } else { 1.0 };
            let row = closure.row(*kind, &pose.frames, &pose.coordinates, d);
            row.residual.abs() <= OPEN * unit
        };
        (kinds.len() == closure.kinds.len() && kinds.iter().all(is_closed)).then_some((kinds, own))
    }

    /// By row of a closure and freedom of its path: whether the freedom never changes the row.
    fn unmoved(&self, closure: &Closure, normal: Vec3, pose: &Pose) -> Vec<bool> {
        let [a, b] = closure.bodies.map(|body| &pose.frames[body].rotation);
        let is_unmoved = |kind: RowKind, freedom: usize| {
            let is_turn = self.tree.freedoms[freedom] == FreedomKind::Turn;
            let along_normal = is_parallel(pose.screws[freedom].axis, normal);
            match kind {
                RowKind::Along(u) | RowKind::InPlane(u) => {
                    let u = a.apply(u);
                    match (is_turn, along_normal) {
                        (true, _) | (false, false) => is_parallel(u, normal),
                        (false, true) => is_across(u, normal),
                    }
                }
                RowKind::Parallel(v, w) => {
                    let stays = is_parallel(a.apply(v), normal) || is_parallel(b.apply(w), normal);
                    !is_turn || stays
                }
                RowKind::Point(_) | RowKind::Length(_) | RowKind::Driven(_) => false,
                RowKind::Mesh(_) | RowKind::NoSpin(_) | RowKind::Coupled(..) => false,
            }
        };
        let of_row = |kind: &RowKind| {
            let kind = *kind;
            let path = closure.path.iter();
            path.map(move |(freedom, _)| is_unmoved(kind, *freedom))
        };
        closure.kinds.iter().flat_map(of_row).collect()
    }
}
