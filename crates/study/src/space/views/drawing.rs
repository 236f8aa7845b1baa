//! A mechanism in one position, as it is seen from one side: bodies as bars and plates, joints by the symbols of spatial kinematics.

use super::projection::{Picture, View};
use super::solids::{center_of_mass, hull};
use dwell_geometry::BodyId;
use dwell_geometry::space::{Joint, JointKind, Placement, Vec3};
use dwell_report::{Paint, Pen, Shape, TextPlacement};
use dwell_scene::SpaceScene;

/// Half the length of a hinge, in sizes of the picture; less where joints are closer, but no less than the second.
const SYMBOL: f64 = 0.026;
const MIN_SYMBOL: f64 = 0.013;
/// The same in distances of joints on one body.
const SYMBOL_OF_DISTANCE: f64 = 0.36;
/// Points of a body nearer than this, in sizes, are one.
pub(super) const SAME: f64 = 1e-6;
/// How far hinges of one body with crossing axes are moved along these, in lengths of a hinge.
const SHIFT: f64 = 2.6;
/// Parts of a bar that are sorted by their distance.
const PARTS: usize = 12;
/// Width of bars, and of the white rim that interrupts what is behind them, pixels.
const BAR: f64 = 6.0;
const RIM: f64 = 4.0;
/// How far joints are drawn before the bars that they connect, in lengths of a hinge.
pub(super) const BEFORE: f64 = 2.0;

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
        drawing.shifts = drawing.shifted_hinges();
        let travel = |joint: &Joint| {
            let along = |(placements, _): &(Vec<Placement>, String)| {
                let [a, b] = [0, 1].map(|k| {
                    let placement = &placements[joint.bodies[k].0];
                    placement.position + placement.rotation.apply(joint.sides[k].point)
                });
                let axis = placements[joint.bodies[0].0]
                    .rotation
                    .apply(joint.sides[0].axis);
                axis.dot(b - a)
            };
            crate::ranges::extent(positions.iter().map(along))
        };
        drawing.travels = scene.mechanism.joints.iter().map(travel).collect();
        drawing
    }

    /// The smallest distance of two joints on a body; infinite without two.
    fn nearest_joints(&self, body: usize) -> f64 {
        let points: Vec<Vec3> = self.joint_points(body).map(|(_, p)| p).collect();
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
            let sides = (0..2).filter(move |k| joint.bodies[*k].0 == body);
            sides.map(move |k| (j, self.anchor(j, k)))
        })
    }

    /// Hinges whose axes cross in one point of a body are drawn beside it, each on its axis.
    fn shifted_hinges(&self) -> Vec<f64> {
        let joints = &self.scene.mechanism.joints;
        let mut shifts = vec![0.0; joints.len()];
        let is_hinge = |j: usize| matches!(joints[j].kind, JointKind::Revolute);
        for i in (0..joints.len()).filter(|&j| is_hinge(j)) {
            for j in (0..i).filter(|&j| is_hinge(j)) {
                let shared = [0, 1].map(|k| [0, 1].map(|l| (k, l)));
                let mut shared = shared.into_iter().flatten();
                let meets = shared.any(|(k, l)| {
                    let [one, two] = [joints[i].sides[k], joints[j].sides[l]];
                    joints[i].bodies[k] == joints[j].bodies[l]
                        && (one.point - two.point).norm() < self.same
                        && one.axis.cross(two.axis).norm() > 0.1
                });
                if meets {
                    shifts[i] = SHIFT * self.unit;
                    shifts[j] = SHIFT * self.unit;
                }
            }
        }
        shifts
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
            bare.any(|(_, anchor, shift)| (anchor - *p).norm() < shift.abs() + self.same)
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
    pub(super) fn seen(
        &self,
        view: View,
        placements: &[Placement],
        with_words: bool,
    ) -> Vec<Shape> {
        let mut scenery = Scenery {
            drawing: self,
            placements,
            picture: Picture::new(view),
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
        if with_words {
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
}

impl Scenery<'_> {
    /// A point of a body in the axes of the ground.
    pub(super) fn at(&self, body: BodyId, point: Vec3) -> Vec3 {
        let placement = &self.placements[body.0];
        placement.position + placement.rotation.apply(point)
    }

    /// A direction of a body in the axes of the ground.
    pub(super) fn turned(&self, body: BodyId, direction: Vec3) -> Vec3 {
        self.placements[body.0].rotation.apply(direction)
    }

    /// Where a joint is drawn, on its `k`th body.
    pub(super) fn anchor(&self, joint: usize, k: usize) -> Vec3 {
        let body = self.drawing.scene.mechanism.joints[joint].bodies[k];
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
        let between = |part: f64| ends[0] + (ends[1] - ends[0]).scaled(part);
        for k in 0..PARTS {
            let [from, to] = [k, k + 1].map(|k| k as f64 / PARTS as f64);
            let overlap = 0.15 / PARTS as f64;
            let drawn = [(from - overlap).max(0.0), (to + overlap).min(1.0)];
            let line = |parts: [f64; 2], pen| {
                Shape::line(parts.map(|part| view.place(between(part))).to_vec(), pen)
            };
            let mut shapes = Vec::new();
            // At its ends it joins others.
            if k > 0 && k + 1 < PARTS {
                let rim = Pen::new(color, width + 2.0 * RIM).lightness(1.0);
                shapes.push(line([from, to], rim));
            }
            let bar = line(drawn, Pen::new(color, width));
            shapes.push(match name {
                Some(name) => bar.named(name),
                None => bar,
            });
            self.picture
                .add(view.nearness(between(0.5 * (from + to))), shapes);
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
            [] | [_] => {}
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

    fn center_of_mass(&self, body: BodyId) -> Vec<Shape> {
        let mass = &self.drawing.scene.masses[body.0];
        if mass.mass == 0.0 {
            return Vec::new();
        }
        let at = self.picture.view.place(self.at(body, mass.center));
        center_of_mass(at, 0.36 * self.drawing.unit)
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

/// The ends of the straight line through all points; none if they are on none.
fn line_of(points: &[Vec3], same: f64) -> Option<[Vec3; 2]> {
    let first = points[0];
    let far = |from: Vec3| {
        let all = points.iter().copied();
        all.max_by(|a, b| (*a - from).norm().total_cmp(&(*b - from).norm()))
    };
    let end = far(first)?;
    let start = far(end)?;
    let along = (end - start).unit()?;
    let is_on = |p: &Vec3| along.cross(*p - start).norm() < same;
    points.iter().all(is_on).then_some([start, end])
}
