//! Positions at which bodies and joints of a mechanism in space are drawn, in the frames of the bodies, for pictures and
//! for pages.

use super::points::placed;
use dwell_geometry::BodyId;
use dwell_geometry::space::{Condition, Joint, JointKind, Placement, Vec3};
use dwell_scene::SpaceScene;

/// Half the length of a hinge, in sizes of the picture; less where joints are closer, but no less than the second.
pub(super) const SYMBOL: f64 = 0.032;
const MIN_SYMBOL: f64 = 0.02;
/// Size of symbols, relative to distances of joints on one body.
const SYMBOL_OF_DISTANCE: f64 = 0.28;
/// Points of a body nearer than this, in sizes, are one.
const SAME: f64 = 1e-6;
/// Distance, along its axis, at which a joint is drawn beside another joint at the same point, in half lengths of a
/// hinge.
const SHIFT: f64 = 2.6;
/// Length of a fork's arm, in the same.
pub(super) const ARM: f64 = 1.4;
/// Length of a guide beyond the travel, in half lengths of a hinge.
pub(super) const GUIDE_MARGIN: f64 = 2.6;

/// A scene with the common data of its pictures.
pub(super) struct SpaceDrawing<'a> {
    pub(super) scene: &'a SpaceScene,
    /// Half the length of a hinge, m.
    pub(super) unit: f64,
    /// Length below which points are one, m.
    pub(super) same: f64,
    /// By joint: how far its symbol is moved along its axis, m.
    shifts: Vec<f64>,
    /// By joint: from where to where its second point goes along its axis, m.
    pub(super) travels: Vec<[f64; 2]>,
}

impl<'a> SpaceDrawing<'a> {
    /// For a picture of this size (m) of a scene in these positions.
    pub(super) fn new(
        scene: &'a SpaceScene,
        positions: &[(Vec<Placement>, String)],
        size: f64,
    ) -> Self {
        let mut drawing = Self {
            scene,
            unit: SYMBOL * size,
            same: SAME * size,
            shifts: vec![0.0; scene.mechanism.joints.len()],
            travels: Vec::new(),
        };
        let bodies = 0..scene.mechanism.bodies.len();
        let nearest = bodies.map(|b| drawing.nearest_joints(b));
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        drawing.unit = (SYMBOL_OF_DISTANCE * nearest).clamp(MIN_SYMBOL * size, SYMBOL * size);
        if let Some((first, _)) = positions.first() {
            drawing.shifts = drawing.shifted_joints(first);
        }
        let travel = |joint: &Joint| {
            let along = |(placements, _): &(Vec<Placement>, String)| {
                let [a, b] =
                    [0, 1].map(|k| placed(placements, joint.side_body(k), joint.sides[k].point));
                let frame = &placements[joint.side_body(0).0].rotation;
                let axis = frame.apply(joint.sides[0].axis);
                axis.dot(b - a)
            };
            crate::ranges::extent(positions.iter().map(along))
        };
        drawing.travels = scene.mechanism.joints.iter().map(travel).collect();
        drawing
    }

    /// The smallest distance of two joints on a body; infinite without two.
    fn nearest_joints(&self, body: usize) -> f64 {
        let joints = self.scene.mechanism.joints.iter();
        let points = joints.flat_map(|joint| {
            let sides = (0..2).filter(|k| joint.bodies[*k].0 == body);
            sides.map(|k| joint.sides[k].point)
        });
        let points: Vec<Vec3> = points.collect();
        let pairs = points
            .iter()
            .enumerate()
            .flat_map(|(i, a)| points[..i].iter().map(move |b| (*a - *b).norm()));
        pairs
            .filter(|d| *d > self.same)
            .fold(f64::INFINITY, f64::min)
    }

    /// The joints of a body with their points in its frame.
    fn joint_points(&self, body: usize) -> impl Iterator<Item = (usize, Vec3)> + '_ {
        self.sides(body).map(|(j, k)| (j, self.bar_end(j, k)))
    }

    /// The joints of a body, each with the number of its side on it.
    fn sides(&self, body: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let joints = self.scene.mechanism.joints.iter().enumerate();
        let drawn = joints.filter(|(_, joint)| !joint.kind.is_coupling());
        drawn.flat_map(move |(j, joint)| {
            let sides = (0..2).filter(move |k| joint.side_body(*k).0 == body);
            sides.map(move |k| (j, k))
        })
    }

    /// The points of the joints of a body, in its frame.
    fn points_of_joints(&self, body: usize) -> impl Iterator<Item = Vec3> + '_ {
        let joints = &self.scene.mechanism.joints;
        self.sides(body).map(|(j, k)| joints[j].sides[k].point)
    }

    /// The end of the bar of a joint's `k`th body at the joint: at the fork of a universal joint, or at its symbol.
    fn bar_end(&self, joint: usize, k: usize) -> Vec3 {
        let of = &self.scene.mechanism.joints[joint];
        match of.kind {
            JointKind::Universal if !self.is_ground(of.bodies[k]) => {
                self.anchor(joint, k) + self.stem(joint, k).scaled(ARM * self.unit)
            }
            _ => self.anchor(joint, k),
        }
    }

    /// From the cross of a universal joint to the fork of its `k`th body: a unit vector in the frame of the body.
    pub(super) fn stem(&self, joint: usize, k: usize) -> Vec3 {
        let of = &self.scene.mechanism.joints[joint];
        let (body, side) = (of.bodies[k].0, &of.sides[k]);
        let named = self.scene.points[body].iter().map(|(_, p)| *p);
        let away = self
            .points_of_joints(body)
            .chain(named)
            .map(|p| p - side.point);
        let toward = away.fold(Vec3::ZERO, |sum, d| sum + d);
        let flat = toward - side.axis.scaled(side.axis.dot(toward));
        let is_long = flat.norm() > self.same;
        flat.unit().filter(|_| is_long).unwrap_or(side.normal)
    }

    /// By joint: the distance along its axis at which it is drawn, because another joint of its body is at the same point.
    /// This applies to hinges whose axes cross, and to slides. The direction is away from the parts at the other joint.
    fn shifted_joints(&self, placements: &[Placement]) -> Vec<f64> {
        let joints = &self.scene.mechanism.joints;
        let mut shifts = vec![0.0; joints.len()];
        for (i, joint) in joints.iter().enumerate() {
            let is_hinge = matches!(joint.kind, JointKind::Revolute);
            if !is_hinge && !matches!(joint.kind, JointKind::Prismatic) {
                continue;
            }
            for (other, k, l) in self.meeting(i) {
                // A slide is drawn where its block is.
                if !is_hinge && k == self.guide_side(joint) {
                    continue;
                }
                let (own, of_other) = (&joint.sides[k], &joints[other].sides[l]);
                let stays = match joints[other].kind {
                    // Of a slide and a hinge the slide is moved.
                    JointKind::Prismatic if is_hinge => true,
                    JointKind::Revolute if is_hinge => own.axis.cross(of_other.axis).norm() < 0.1,
                    _ => false,
                };
                if stays {
                    continue;
                }
                let far = joints[other].bodies[1 - l];
                let from = self.middle_of_joints(far, placements)
                    - placed(placements, joint.bodies[k], own.point);
                let axis = placements[joint.bodies[k].0].rotation.apply(own.axis);
                let is_ahead = axis.dot(from) > self.same;
                let sign = if is_ahead { -1.0 } else { 1.0 };
                shifts[i] = sign * SHIFT * self.unit;
            }
        }
        shifts
    }

    /// Which body of a sliding joint has the guide: the first, unless both have the axis and the second is the ground.
    pub(super) fn guide_side(&self, joint: &Joint) -> usize {
        let both_have_axis = joint.kind.holds(Condition::Axes);
        usize::from(both_have_axis && self.is_ground(joint.bodies[1]))
    }

    /// The joints at the point of a joint, with the number of the common moving body in the one and the other.
    fn meeting(&self, joint: usize) -> Vec<(usize, usize, usize)> {
        let joints = &self.scene.mechanism.joints;
        let own = &joints[joint];
        let mut meeting = Vec::new();
        let others = joints.iter().enumerate();
        let others = others.filter(|(j, other)| *j != joint && !other.kind.is_coupling());
        for (j, other) in others {
            for (k, l) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let is_near = (own.sides[k].point - other.sides[l].point).norm() < self.same;
                if own.side_body(k) == other.side_body(l)
                    && is_near
                    && !self.is_ground(own.bodies[k])
                {
                    meeting.push((j, k, l));
                }
            }
        }
        meeting
    }

    /// The middle of a body's joints in the axes of the ground.
    fn middle_of_joints(&self, body: BodyId, placements: &[Placement]) -> Vec3 {
        let points = self.points_of_joints(body.0);
        let points: Vec<Vec3> = points.map(|p| placed(placements, body, p)).collect();
        let sum = points.iter().fold(Vec3::ZERO, |sum, p| sum + *p);
        sum.scaled(1.0 / points.len().max(1) as f64)
    }

    /// The position of the symbol of a joint on its `k`th body, in the frame of the body, m.
    pub(super) fn anchor(&self, joint: usize, k: usize) -> Vec3 {
        let side = self.scene.mechanism.joints[joint].sides[k];
        side.point + side.axis.scaled(self.shifts[joint])
    }

    /// Whether a body is drawn as the block of a slide.
    pub(super) fn is_block(&self, body: BodyId) -> bool {
        let joints = self.scene.mechanism.joints.iter();
        let mut slides = joints.filter(|joint| matches!(joint.kind, JointKind::Prismatic));
        slides.any(|joint| joint.bodies[1 - self.guide_side(joint)] == body)
    }

    /// The middle of a body's drawn points, in its frame, m.
    pub(super) fn middle(&self, body: BodyId) -> Vec3 {
        let points = self.drawn_points(body.0);
        let sum = points.iter().fold(Vec3::ZERO, |sum, p| sum + *p);
        sum.scaled(1.0 / points.len().max(1) as f64)
    }

    pub(super) fn is_ground(&self, body: BodyId) -> bool {
        body.0 == self.scene.mechanism.ground
    }

    /// The points of a body that are drawn: its joints, then its named points, each once.
    pub(super) fn drawn_points(&self, body: usize) -> Vec<Vec3> {
        let joints: Vec<(usize, Vec3)> = self.joint_points(body).collect();
        // Where a hinge is drawn beside its point, the point itself is none of the body.
        let is_joint = |p: &Vec3| {
            let joints = joints.iter();
            let mut bare = joints.map(|&(j, anchor)| (j, anchor, self.shifts[j]));
            bare.any(|(_, anchor, shift)| {
                (anchor - *p).norm() < shift.abs().max(ARM * self.unit) + self.same
            })
        };
        let named = self.scene.points[body].iter().map(|(_, p)| *p);
        let named: Vec<Vec3> = named.filter(|p| !is_joint(p)).collect();
        let mut points: Vec<Vec3> = Vec::new();
        for p in joints.iter().map(|(_, p)| *p).chain(named) {
            if points.iter().all(|other| (*other - p).norm() > self.same) {
                points.push(p);
            }
        }
        points
    }
}
