//! A mechanism in one position, as it is seen from one side: bodies as bars and plates, joints by the symbols of spatial kinematics.

use super::arrangement::SpaceDrawing;
use super::direction::View;
use super::loads::link_of;
use super::points::placed;
use super::projection::Picture;
use super::segments::{line_of, nearest_of_segment};
use super::solids::{center_of_mass, circle, hull, named};
use crate::output::body_color;
use crate::symbols::spring_outline;
use dwell_geometry::space::{JointKind, Placement, Vec3};
use dwell_geometry::{BodyId, vec2};
use dwell_kinetostatics::space::LoadKind;
use dwell_page::LinkLook;
use dwell_report::{Paint, Pen, Shape, TextPlacement};

/// Parts of a bar that are sorted by their distance.
const PARTS: usize = 12;
/// Width of bars, and of the white rim that interrupts what is behind them, pixels.
const BAR: f64 = 6.0;
const RIM: f64 = 4.0;
/// Half the width of a spring, in lengths of a hinge.
const SPRING: f64 = 0.6;
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

impl SpaceDrawing<'_> {
    /// Whether a body is drawn as the block of a slide.
    fn is_block(&self, body: BodyId) -> bool {
        let joints = self.scene.mechanism.joints.iter();
        let mut slides = joints.filter(|joint| matches!(joint.kind, JointKind::Prismatic));
        slides.any(|joint| joint.bodies[1 - self.guide_side(joint)] == body)
    }

    /// As in the plane.
    pub(super) fn color(&self, body: BodyId) -> Paint {
        body_color(self.scene.mechanism.ground, body)
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
        for load in &self.scene.loads {
            scenery.load(&load.kind);
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
            let bar = named(line([from, to], Pen::new(color, width)), name);
            self.picture.add(near, vec![bar]);
        }
    }

    /// A bar between two points; a plate through more, or the bars from their middle.
    fn body(&mut self, body: BodyId) {
        let mechanism = &self.drawing.scene.mechanism;
        let name = mechanism.bodies[body.0].name.as_str();
        let color = self.drawing.color(body);
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

    /// A spring or a damper between two points, as in the plane.
    fn load(&mut self, load: &LoadKind) {
        let Some((look, ends)) = link_of(load) else {
            return;
        };
        let view = self.picture.view;
        let ends = ends.map(|(body, point)| self.at(body, point));
        let [a, b] = ends.map(|end| view.place(end));
        let pen = Pen::new(Paint::Ink, 2.0).lightness(0.35);
        let line = match look {
            LinkLook::Spring => {
                let [from, to] = [a, b].map(|[x, y]| vec2(x, y));
                let zigzag = spring_outline(from, to, SPRING * self.drawing.unit);
                Shape::line(zigzag.iter().map(|p| [p.x, p.y]).collect(), pen)
            }
            LinkLook::Damper | LinkLook::Rod | LinkLook::Cylinder => {
                Shape::line(vec![a, b], pen.dashed())
            }
        };
        let middle = (ends[0] + ends[1]).scaled(0.5);
        self.picture.add(view.nearness(middle), vec![line]);
    }

    /// A body of one point: a ring about it.
    fn ring(&mut self, body: BodyId, at: Vec3) {
        let view = self.picture.view;
        let outline = circle(view.place(at), 0.9 * self.drawing.unit);
        let line = Shape::line(outline, Pen::new(self.drawing.color(body), 4.0));
        let line = named(line, self.name(body));
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
