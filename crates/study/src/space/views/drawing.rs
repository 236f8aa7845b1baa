//! A mechanism in one position, as it is seen from one side: bodies as bars and plates, joints by the symbols of spatial kinematics.

use super::projection::{Picture, View};
use super::segments::{line_of, nearest_of_segment};
use super::solids::{center_of_mass, circle, hull};
use dwell_geometry::BodyId;
use dwell_geometry::space::{Joint, JointKind, Placement, Vec3};
use dwell_report::{Paint, Pen, Shape, TextPlacement};
use dwell_scene::SpaceScene;

/// Half the length of a hinge, in sizes of the picture; less where joints are closer, but no less than the second.
const SYMBOL: f64 = 0.032;
const MIN_SYMBOL: f64 = 0.02;
/// The same in distances of joints on one body.
const SYMBOL_OF_DISTANCE: f64 = 0.28;
/// Points of a body nearer than this, in sizes, are one.
pub(super) const SAME: f64 = 1e-6;
/// How far a joint is drawn beside another at the same point, along its axis; in half lengths of a hinge.
const SHIFT: f64 = 2.6;
/// Length of a fork's arm, in the same.
pub(super) const ARM: f64 = 1.4;
/// Parts of a bar that are sorted by their distance.
const PARTS: usize = 12;
/// Width of bars, and of the white rim that interrupts what is behind them, pixels.
const BAR: f64 = 6.0;
const RIM: f64 = 4.0;
/// How far joints are drawn before the bars that they connect, in lengths of a hinge.
pub(super) const BEFORE: f64 = 2.0;

/// What is drawn beside the bodies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detail {
    /// Whether bodies have names, for the legend.
    pub(super) named: bool,
    /// Whether joints have names.
    pub(super) with_words: bool,
}

/// A scene with what its pictures share.
pub(super) struct SpaceDrawing<'a> {
    pub(super) scene: &'a SpaceScene,
    /// Width of the picture, m.
    pub(super) size: f64,
    /// Half the length of a hinge, m.
    pub(super) unit: f64,
    /// Length below which points are one, m.
    same: f64,
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
            size,
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

    /// Length below which points are one, m.
    pub(super) fn same(&self) -> f64 {
        self.same
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
        let joints = self.scene.mechanism.joints.iter().enumerate();
        joints.flat_map(move |(j, joint)| {
            let sides = (0..2).filter(move |k| joint.side_body(*k).0 == body);
            sides.map(move |k| (j, self.bar_end(j, k)))
        })
    }

    /// Where the bar of a joint's `k`th body ends at the joint: at the fork of a universal joint, or where its symbol is.
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
        let others = self.scene.mechanism.joints.iter().flat_map(|other| {
            let sides = (0..2).filter(|i| other.side_body(*i).0 == body);
            sides.map(|i| other.sides[i].point)
        });
        let named = self.scene.points[body].iter().map(|(_, p)| *p);
        let away = others.chain(named).map(|p| p - side.point);
        let toward = away.fold(Vec3::ZERO, |sum, d| sum + d);
        let flat = toward - side.axis.scaled(side.axis.dot(toward));
        let is_long = flat.norm() > self.same;
        flat.unit().filter(|_| is_long).unwrap_or(side.normal)
    }

    /// By joint: how far it is drawn beside its point along its axis, as another joint of its body is there: hinges whose axes
    /// cross, and slides; away from what comes to the other joint.
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
                let sign = if axis.dot(from) > self.same {
                    -1.0
                } else {
                    1.0
                };
                shifts[i] = sign * SHIFT * self.unit;
            }
        }
        shifts
    }

    /// Which body of a sliding joint has the guide: the first, unless only the second is the ground.
    pub(super) fn guide_side(&self, joint: &Joint) -> usize {
        usize::from(self.is_ground(joint.bodies[1]))
    }

    /// Whether a body is drawn as the block of a slide.
    fn is_block(&self, body: BodyId) -> bool {
        let joints = self.scene.mechanism.joints.iter();
        let mut slides = joints.filter(|joint| matches!(joint.kind, JointKind::Prismatic));
        slides.any(|joint| joint.bodies[1 - self.guide_side(joint)] == body)
    }

    /// The joints at the point of a joint, with the number of the common moving body in the one and the other.
    fn meeting(&self, joint: usize) -> Vec<(usize, usize, usize)> {
        let joints = &self.scene.mechanism.joints;
        let own = &joints[joint];
        let mut meeting = Vec::new();
        for (j, other) in joints.iter().enumerate().filter(|(j, _)| *j != joint) {
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
        let joints = self.scene.mechanism.joints.iter();
        let points = joints.flat_map(|joint| {
            let sides = (0..2).filter(|k| joint.side_body(*k) == body);
            sides.map(|k| placed(placements, body, joint.sides[k].point))
        });
        let points: Vec<Vec3> = points.collect();
        let sum = points.iter().fold(Vec3::ZERO, |sum, p| sum + *p);
        sum.scaled(1.0 / points.len().max(1) as f64)
    }

    /// Where the symbol of a joint is on its `k`th body, in its frame, m.
    pub(super) fn anchor(&self, joint: usize, k: usize) -> Vec3 {
        let side = self.scene.mechanism.joints[joint].sides[k];
        side.point + side.axis.scaled(self.shifts[joint])
    }

    pub(super) fn is_ground(&self, body: BodyId) -> bool {
        body.0 == self.scene.mechanism.ground
    }

    /// Grey for the ground; six palette colours, then ink, then the colours again: as in the plane.
    pub(super) fn color(&self, body: BodyId) -> Paint {
        if self.is_ground(body) {
            return Paint::Grey;
        }
        match (body.0 - usize::from(body.0 > self.scene.mechanism.ground)) % 7 {
            6 => Paint::Ink,
            k => Paint::Palette(k),
        }
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

    /// The mechanism seen from one side; without words where it moves.
    pub(super) fn drawn_from(
        &self,
        view: View,
        placements: &[Placement],
        detail: Detail,
    ) -> Vec<Shape> {
        let mut scenery = Scenery {
            drawing: self,
            placements,
            picture: Picture::new(view),
            named: detail.named,
        };
        let bodies = (0..placements.len())
            .map(BodyId)
            .filter(|b| !self.is_ground(*b));
        for body in bodies.clone() {
            scenery.body(body);
        }
        for j in 0..self.scene.mechanism.joints.len() {
            scenery.joint(j);
        }
        for actuator in &self.scene.mechanism.actuators {
            scenery.driven(actuator.kind);
        }
        let mut marks = Vec::new();
        for body in bodies {
            marks.extend(scenery.center_of_mass(body));
        }
        if detail.with_words {
            marks.extend(scenery.words());
        }
        let mut shapes = scenery.picture.into_shapes();
        shapes.extend(marks);
        shapes
    }
}

/// One position in one view, with the parts drawn so far.
pub(super) struct Scenery<'a> {
    pub(super) drawing: &'a SpaceDrawing<'a>,
    placements: &'a [Placement],
    pub(super) picture: Picture,
    named: bool,
}

impl<'a> Scenery<'a> {
    /// A point of a body in the axes of the ground.
    pub(super) fn at(&self, body: BodyId, point: Vec3) -> Vec3 {
        placed(self.placements, body, point)
    }

    /// A direction of a body in the axes of the ground.
    pub(super) fn turned(&self, body: BodyId, direction: Vec3) -> Vec3 {
        self.placements[body.0].rotation.apply(direction)
    }

    /// Where a joint is drawn, on its `k`th body.
    pub(super) fn anchor(&self, joint: usize, k: usize) -> Vec3 {
        let body = self.drawing.scene.mechanism.joints[joint].side_body(k);
        self.at(body, self.drawing.anchor(joint, k))
    }

    /// The middle of a body's drawn points.
    pub(super) fn middle(&self, body: BodyId) -> Vec3 {
        let points = self.drawing.drawn_points(body.0);
        let sum = points.iter().fold(Vec3::ZERO, |sum, p| sum + *p);
        self.at(body, sum.scaled(1.0 / points.len().max(1) as f64))
    }

    /// A bar, which interrupts what it passes in front of.
    pub(super) fn bar(
        &mut self,
        ends: [Vec3; 2],
        (color, width): (Paint, f64),
        name: Option<&str>,
    ) {
        let view = self.picture.view;
        let name = name.filter(|_| self.named);
        let between = |part: f64| ends[0] + (ends[1] - ends[0]).scaled(part);
        let line = |parts: [f64; 2], pen| {
            Shape::line(parts.map(|part| view.place(between(part))).to_vec(), pen)
        };
        let step = (view.nearness(ends[1]) - view.nearness(ends[0])).abs() / PARTS as f64;
        for k in 0..PARTS {
            let [from, to] = [k, k + 1].map(|k| k as f64 / PARTS as f64);
            let near = view.nearness(between(0.5 * (from + to)));
            // At its ends it joins others.
            if k > 0 && k + 1 < PARTS {
                // Behind the neighbouring parts, or it would interrupt them.
                let rim = Pen::new(color, width + 2.0 * RIM).lightness(1.0);
                let behind = 1.5 * step + 0.1 * self.drawing.unit;
                self.picture.add(near - behind, vec![line([from, to], rim)]);
            }
            let bar = line([from, to], Pen::new(color, width));
            let bar = match name {
                Some(name) => bar.named(name),
                None => bar,
            };
            self.picture.add(near, vec![bar]);
        }
    }

    /// A bar between two points; a plate through more, or the bars from their middle.
    fn body(&mut self, body: BodyId) {
        let mechanism = &self.drawing.scene.mechanism;
        let (name, color) = (
            mechanism.bodies[body.0].name.as_str(),
            self.drawing.color(body),
        );
        let local = self.drawing.drawn_points(body.0);
        let points: Vec<Vec3> = local.iter().map(|p| self.at(body, *p)).collect();
        let bar = (color, BAR);
        match points[..] {
            [] => {}
            [point] => {
                if !self.drawing.is_block(body) {
                    self.ring(body, point);
                }
            }
            [a, b] => self.bar([a, b], bar, Some(name)),
            _ => {
                if let Some([a, b]) = line_of(&points, self.drawing.same) {
                    return self.bar([a, b], bar, Some(name));
                }
                if points.len() == 3 {
                    let view = self.picture.view;
                    let corners: Vec<[f64; 2]> = points.iter().map(|p| view.place(*p)).collect();
                    let plate = Shape::area(hull(corners), Pen::new(color, 1.0), 0.18);
                    let middle = points
                        .iter()
                        .fold(Vec3::ZERO, |sum, p| sum + p.scaled(1.0 / 3.0));
                    self.picture.add(view.nearness(middle), vec![plate]);
                    for k in 0..3 {
                        self.bar([points[k], points[(k + 1) % 3]], bar, Some(name));
                    }
                    return;
                }
                let middle = self.middle(body);
                for p in &points {
                    self.bar([middle, *p], bar, Some(name));
                }
            }
        }
    }

    /// A body of one point: a ring about it.
    fn ring(&mut self, body: BodyId, at: Vec3) {
        let view = self.picture.view;
        let outline = circle(view.place(at), 0.9 * self.drawing.unit);
        let line = Shape::line(outline, Pen::new(self.drawing.color(body), 4.0));
        let line = match self.name(body) {
            Some(name) => line.named(name),
            None => line,
        };
        self.picture.add(view.nearness(at), vec![line]);
    }

    /// The mark of a centre of mass, with a line to the body where it is beside it.
    fn center_of_mass(&self, body: BodyId) -> Vec<Shape> {
        let mass = &self.drawing.scene.masses[body.0];
        if mass.mass == 0.0 {
            return Vec::new();
        }
        let (view, center) = (self.picture.view, self.at(body, mass.center));
        let at = view.place(center);
        let mut shapes = Vec::new();
        let points = self.drawing.drawn_points(body.0);
        let points: Vec<Vec3> = points.iter().map(|p| self.at(body, *p)).collect();
        let foot = match points[..] {
            [] => center,
            [a, b] => nearest_of_segment([a, b], center),
            _ => self.middle(body),
        };
        if (foot - center).norm() > self.drawing.unit {
            let pen = Pen::new(self.drawing.color(body), 1.6);
            shapes.push(Shape::line(vec![view.place(foot), at], pen));
        }
        shapes.extend(center_of_mass(at, 0.33 * self.drawing.unit));
        shapes
    }

    /// The name of a body for the legend; the ground has none.
    pub(super) fn name(&self, body: BodyId) -> Option<&'a str> {
        let drawing: &'a SpaceDrawing<'a> = self.drawing;
        let is_named = self.named && !drawing.is_ground(body);
        is_named.then(|| drawing.scene.mechanism.bodies[body.0].name.as_str())
    }

    /// The names of the joints; those in one place share a label.
    fn words(&self) -> Vec<Shape> {
        let (drawing, view) = (self.drawing, self.picture.view);
        let mut labels: Vec<([f64; 2], String)> = Vec::new();
        for (j, joint) in drawing.scene.mechanism.joints.iter().enumerate() {
            let ends = [0, 1].map(|k| view.place(self.anchor(j, k)));
            let at = match joint.kind {
                JointKind::Distance { .. } => [0, 1].map(|k| 0.5 * (ends[0][k] + ends[1][k])),
                _ => ends[1],
            };
            let is_near =
                |other: &[f64; 2]| (other[0] - at[0]).hypot(other[1] - at[1]) < 0.8 * drawing.unit;
            match labels.iter_mut().find(|(other, _)| is_near(other)) {
                Some((_, names)) => *names += &format!(", {}", joint.name),
                None => labels.push((at, joint.name.clone())),
            }
        }
        let label = |(at, names)| Shape::text(at, names, TextPlacement::AboveRight);
        labels.into_iter().map(label).collect()
    }
}

/// A point of a body in the axes of the ground.
fn placed(placements: &[Placement], body: BodyId, point: Vec3) -> Vec3 {
    let placement = &placements[body.0];
    placement.position + placement.rotation.apply(point)
}
