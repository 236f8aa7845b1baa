//! A mechanism in one position, seen from one side: its parts as symbols of spatial kinematics.

use super::arrangement::{GUIDE_MARGIN, SpaceDrawing};
use super::direction::View;
use super::points::placed;
use super::projection::Picture;
use super::solids::{hull, named};
use crate::output::body_color;
use crate::symbols::spring_outline;
use dwell_geometry::space::{JointKind, Placement, Vec3, vec3};
use dwell_geometry::{BodyId, vec2};
use dwell_page::{Anchor, LinkLook, OutlineLook, Part};
use dwell_report::{Paint, Pen, Shape, TextPlacement};

/// Parts of a bar that are sorted by their distance.
const PARTS: usize = 12;
/// Width of bars, of guides and massless rods, and of the white rim that interrupts lines behind them, pixels.
const BAR: f64 = 6.0;
const ROD: f64 = 3.5;
const RIM: f64 = 4.0;
/// Half the width of a spring, in lengths of a hinge.
const SPRING: f64 = 0.6;
/// How far joints are drawn before the bars that they connect, in lengths of a hinge.
pub(super) const BEFORE: f64 = 2.0;

/// Details that are drawn in addition to the bodies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detail {
    /// Whether bodies have names, for the legend.
    pub(super) named: bool,
    /// Whether joints have names.
    pub(super) with_words: bool,
}

impl SpaceDrawing<'_> {
    /// The colour of a body.
    pub(super) fn color(&self, body: usize) -> Paint {
        body_color(self.scene.mechanism.ground, BodyId(body))
    }

    /// The parts of the mechanism seen from one side; without labels in animations.
    pub(super) fn drawn_from(
        &self,
        parts: &[Part],
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
        for part in parts {
            match part {
                Part::Outline { look, body, points } => scenery.outline(*look, *body, points),
                Part::Link {
                    look,
                    ends,
                    axis,
                    body,
                    ..
                } => {
                    scenery.link(*look, ends, axis, *body);
                }
                Part::Mark(mark) => scenery.mark(mark),
            }
        }
        let words = detail.with_words.then(|| scenery.words());
        let mut shapes = scenery.picture.into_shapes();
        shapes.extend(words.into_iter().flatten());
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
    fn at(&self, body: usize, p: &[f64]) -> Vec3 {
        placed(self.placements, BodyId(body), vec3(p[0], p[1], p[2]))
    }

    pub(super) fn place(&self, anchor: &Anchor) -> Vec3 {
        self.at(anchor.body, &anchor.point)
    }

    /// A direction of a body in the axes of the ground.
    pub(super) fn turned(&self, body: usize, d: &[f64]) -> Vec3 {
        self.placements[body].rotation.apply(vec3(d[0], d[1], d[2]))
    }

    /// A straight line in the picture.
    pub(super) fn segment(&self, ends: [Vec3; 2], pen: Pen) -> Shape {
        Shape::line(ends.map(|end| self.picture.view.place(end)).to_vec(), pen)
    }

    /// A bar, which interrupts what it passes in front of.
    fn bar(&mut self, ends: [Vec3; 2], color: Paint, width: f64, name: Option<&str>) {
        let view = self.picture.view;
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

    /// A bar, a guide, which ends at walls on the ground, a plate with its edges, or the line to a centre of mass, before everything.
    fn outline(&mut self, look: OutlineLook, body: usize, points: &[Vec<f64>]) {
        let color = self.drawing.color(body);
        let points: Vec<Vec3> = points.iter().map(|p| self.at(body, p)).collect();
        let ends = [points[0], points[1]];
        match look {
            OutlineLook::Guide => {
                self.bar(ends, color, ROD, None);
                if body == self.drawing.scene.mechanism.ground {
                    self.wall(ends[0], ends[0] - ends[1]);
                    self.wall(ends[1], ends[1] - ends[0]);
                }
            }
            OutlineLook::Plate => {
                let view = self.picture.view;
                let corners: Vec<[f64; 2]> = points.iter().map(|p| view.place(*p)).collect();
                let plate = Shape::area(hull(corners), Pen::new(color, 1.0), 0.18);
                let middle = points
                    .iter()
                    .fold(Vec3::ZERO, |sum, p| sum + p.scaled(1.0 / 3.0));
                self.picture.add(view.nearness(middle), vec![plate]);
                for k in 0..points.len() {
                    let edge = [points[k], points[(k + 1) % points.len()]];
                    self.bar(edge, color, BAR, self.name(body));
                }
            }
            OutlineLook::Arm => {
                let line = self.segment(ends, Pen::new(color, 1.6));
                self.picture.add(f64::INFINITY, vec![line]);
            }
            _ => self.bar(ends, color, BAR, self.name(body)),
        }
    }

    /// A rod, or what drives or loads a distance.
    fn link(&mut self, look: LinkLook, ends: &[Anchor; 2], axis: &[f64], body: Option<usize>) {
        let (view, unit) = (self.picture.view, self.drawing.unit);
        let in_space = [0, 1].map(|k| self.place(&ends[k]));
        let [a, b] = in_space.map(|end| view.place(end));
        let pen = Pen::new(Paint::Ink, 2.0).lightness(0.35);
        let middle = view.nearness((in_space[0] + in_space[1]).scaled(0.5));
        let (near, line) = match look {
            LinkLook::Shaft => {
                let axis = self.turned(ends[0].body, axis);
                let (at, margin) = (in_space[0], GUIDE_MARGIN * unit);
                let apart = axis.dot(in_space[1] - at);
                let ends =
                    [apart.min(0.0) - margin, apart.max(0.0) + margin].map(|s| at + axis.scaled(s));
                let color = body.map_or(Paint::Grey, |body| self.drawing.color(body));
                return self.bar(ends, color, ROD, None);
            }
            // Beside the rod, from one of its ends towards the other.
            LinkLook::Drive => {
                let [dx, dy] = [0, 1].map(|k| b[k] - a[k]);
                let long = dx.hypot(dy).max(f64::MIN_POSITIVE);
                let aside = [-dy, dx].map(|d| 1.2 * unit * d / long);
                let point = |s: f64| [0, 1].map(|k| a[k] + s * (b[k] - a[k]) + aside[k]);
                let near = view.nearness(in_space[1]) + 2.0 * BEFORE * unit;
                (near, driven([0.3, 0.7].map(point)))
            }
            LinkLook::Spring => {
                let [from, to] = [a, b].map(|[x, y]| vec2(x, y));
                let zigzag = spring_outline(from, to, SPRING * unit);
                (
                    middle,
                    Shape::line(zigzag.iter().map(|p| [p.x, p.y]).collect(), pen),
                )
            }
            LinkLook::Damper => (middle, Shape::line(vec![a, b], pen.dashed())),
            LinkLook::Rod | LinkLook::Cylinder => {
                return self.bar(in_space, Paint::Grey, ROD, None);
            }
        };
        self.picture.add(near, vec![line]);
    }

    /// The name of a body for the legend; the ground has none.
    pub(super) fn name(&self, body: usize) -> Option<&'a str> {
        let mechanism = &self.drawing.scene.mechanism;
        let is_named = self.named && body != mechanism.ground;
        is_named.then(|| mechanism.bodies[body].name.as_str())
    }

    /// The names of the joints; those in one place share a label.
    fn words(&self) -> Vec<Shape> {
        let (drawing, view) = (self.drawing, self.picture.view);
        let mut labels: Vec<([f64; 2], String)> = Vec::new();
        let joints = drawing.scene.mechanism.joints.iter().enumerate();
        for (j, joint) in joints.filter(|(_, joint)| !joint.kind.is_coupling()) {
            let anchor = |k| placed(self.placements, joint.side_body(k), drawing.anchor(j, k));
            let ends = [0, 1].map(|k| view.place(anchor(k)));
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

/// The arrow of an actuator.
pub(super) fn driven([from, to]: [[f64; 2]; 2]) -> Shape {
    Shape::Arrow {
        from,
        to,
        pen: Pen::new(Paint::Ink, 2.5),
        name: None,
    }
}
