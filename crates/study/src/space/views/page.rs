//! A mechanism in space as the parts of a page, which can be turned there.

use super::arrangement::{GUIDE_MARGIN, SpaceDrawing};
use super::direction::best_view;
use super::loads::link_of;
use super::points::points_of;
use super::segments::{line_of, nearest_of_segment};
use crate::page::paint;
use crate::ranges::extent;
use dwell_geometry::BodyId;
use dwell_geometry::space::{Joint, JointKind, Placement, Vec3};
use dwell_page::{
    Anchor, Drawing, DrawnBody, DrawnPath, ForceArrow, LinkLook, Mark, MarkLook, OutlineLook, Part,
};
use dwell_scene::SpaceScene;

/// The mechanism in the rows of a page, by row the placements of all bodies.
pub(crate) fn page_drawing(
    scene: &SpaceScene,
    rows: Vec<Vec<Placement>>,
    arrows: Vec<ForceArrow>,
) -> Drawing {
    let positions: Vec<(Vec<Placement>, String)> =
        rows.into_iter().map(|row| (row, String::new())).collect();
    let first = positions.first().map_or(&[][..], |(first, _)| first);
    let points = points_of(scene, first);
    let view = best_view(&points);
    let all = positions.iter().flat_map(|(p, _)| points_of(scene, p));
    let all: Vec<Vec3> = all.collect();
    let sides = [0, 1, 2].map(|k| extent(all.iter().map(|p| Vec3::AXES[k].dot(*p))));
    let sides = sides.iter().map(|[low, high]| high - low);
    let size = sides.fold(0.0, f64::max);
    let is_extended = size > 0.0 && size.is_finite();
    let size = if is_extended { size } else { 1.0 };
    let mut parts = SpaceParts {
        drawing: SpaceDrawing::new(scene, &positions, size),
        parts: Vec::new(),
    };
    parts.all();
    let toward = view.toward();
    let [x, y, z] = Vec3::AXES.map(|axis| axis.dot(toward));
    let bodies = scene.mechanism.bodies.iter().enumerate();
    Drawing {
        size,
        view: Some([y.atan2(x), z.clamp(-1.0, 1.0).asin()]),
        bodies: bodies
            .map(|(b, body)| DrawnBody {
                name: body.name.clone(),
                paint: paint(scene.mechanism.ground, b),
                placements: placements(scene, &positions, b),
            })
            .collect(),
        parts: parts.parts,
        arrows,
        paths: paths(scene),
    }
}

/// Position and the first two columns of the rotation, by row; nothing of the ground.
fn placements(
    scene: &SpaceScene,
    positions: &[(Vec<Placement>, String)],
    body: usize,
) -> Vec<Vec<f64>> {
    if body == scene.mechanism.ground {
        return Vec::new();
    }
    let part = |k: usize| {
        let of = |(row, _): &(Vec<Placement>, String)| {
            let vector = match k / 3 {
                0 => row[body].position,
                column => row[body].rotation.columns[column - 1],
            };
            Vec3::AXES[k % 3].dot(vector)
        };
        positions.iter().map(of).collect()
    };
    (0..9).map(part).collect()
}

fn coordinates(p: Vec3) -> Vec<f64> {
    Vec3::AXES.map(|axis| axis.dot(p)).to_vec()
}

/// A point of a body on a page.
pub(crate) fn anchor(body: BodyId, p: Vec3) -> Anchor {
    Anchor {
        body: body.0,
        point: coordinates(p),
    }
}

/// All named points of moving bodies.
fn paths(scene: &SpaceScene) -> Vec<DrawnPath> {
    let (bodies, all) = (scene.points.iter().enumerate(), scene.paths.is_empty());
    let moving = bodies.filter(|(b, _)| *b != scene.mechanism.ground);
    let path = |(b, points): (usize, &Vec<(String, Vec3)>)| -> Vec<DrawnPath> {
        let body = &scene.mechanism.bodies[b].name;
        let one = |(name, p): &(String, Vec3)| DrawnPath {
            at: anchor(BodyId(b), *p),
            name: format!("{body}.{name}"),
            requested: all || scene.paths.iter().any(|of| of.body.0 == b && of.at == *p),
        };
        points.iter().map(one).collect()
    };
    moving.flat_map(path).collect()
}

/// The parts of a mechanism, collected.
struct SpaceParts<'a> {
    drawing: SpaceDrawing<'a>,
    parts: Vec<Part>,
}

impl SpaceParts<'_> {
    fn all(&mut self) {
        let scene = self.drawing.scene;
        let bodies = (0..scene.mechanism.bodies.len()).map(BodyId);
        let ground = BodyId(scene.mechanism.ground);
        for body in bodies.filter(|b| *b != ground) {
            self.body(body);
        }
        for (j, joint) in scene.mechanism.joints.iter().enumerate() {
            self.guide(j, joint);
            self.joint(j, joint);
        }
        for load in &scene.loads {
            let Some((look, ends)) = link_of(&load.kind) else {
                continue;
            };
            self.parts.push(Part::Link {
                look,
                ends: ends.map(|(body, point)| anchor(body, point)),
                bodies: [None; 2],
                title: load.name.clone(),
            });
        }
    }

    fn outline(&mut self, look: OutlineLook, body: BodyId, points: &[Vec3], closed: bool) {
        self.parts.push(Part::Outline {
            look,
            body: body.0,
            points: points.iter().map(|p| coordinates(*p)).collect(),
            closed,
        });
    }

    /// A bar between two points; a plate through three, or bars from the middle of more; and the centre of mass.
    fn body(&mut self, body: BodyId) {
        let points = self.drawing.drawn_points(body.0);
        let sum = points.iter().fold(Vec3::ZERO, |sum, p| sum + *p);
        let middle = sum.scaled(1.0 / points.len().max(1) as f64);
        let line = match points.len() {
            0 | 1 => None,
            _ => line_of(&points, self.drawing.same),
        };
        match (line, points.len()) {
            (Some(ends), _) => self.outline(OutlineLook::Bar, body, &ends, false),
            (None, 0 | 1) => {}
            (None, 3) => self.outline(OutlineLook::Plate, body, &points, true),
            (None, _) => {
                for p in &points {
                    self.outline(OutlineLook::Bar, body, &[middle, *p], false);
                }
            }
        }
        let mass = &self.drawing.scene.masses[body.0];
        if mass.mass == 0.0 {
            return;
        }
        let foot = line.map_or(middle, |ends| nearest_of_segment(ends, mass.center));
        if (foot - mass.center).norm() > self.drawing.unit && !points.is_empty() {
            self.outline(OutlineLook::Guide, body, &[foot, mass.center], false);
        }
        let name = &self.drawing.scene.mechanism.bodies[body.0].name;
        self.parts.push(Part::Mark(Mark {
            look: MarkLook::CenterOfMass,
            at: anchor(body, mass.center),
            axis: Vec::new(),
            on_ground: false,
            label: String::new(),
            title: format!("centre of mass of {name}"),
        }));
    }

    /// The rod on which a joint slides: of the body with the guide, or of the moving body through a sleeve of the ground.
    fn guide(&mut self, j: usize, joint: &Joint) {
        let slides = match joint.kind {
            JointKind::Prismatic | JointKind::Cylindrical | JointKind::Helical { .. } => true,
            JointKind::Weld
            | JointKind::Revolute
            | JointKind::Universal
            | JointKind::Spherical
            | JointKind::Planar
            | JointKind::Distance { .. }
            | JointKind::Gear { .. } => false,
        };
        let [low, high] = self.drawing.travels[j];
        if !slides || low > high {
            return;
        }
        let on = self.drawing.guide_side(joint);
        let is_sleeve = matches!(joint.kind, JointKind::Cylindrical) && self.is_grounded(joint);
        let side = if is_sleeve { 1 - on } else { on };
        let (low, high) = if side == 0 {
            (low, high)
        } else {
            (-high, -low)
        };
        let margin = GUIDE_MARGIN * self.drawing.unit;
        let (start, axis) = (self.drawing.anchor(j, side), joint.sides[side].axis);
        let ends = [low - margin, high + margin].map(|s| start + axis.scaled(s));
        self.outline(OutlineLook::Guide, joint.side_body(side), &ends, false);
    }

    fn joint(&mut self, j: usize, joint: &Joint) {
        let look = match joint.kind {
            JointKind::Revolute => MarkLook::Hinge,
            JointKind::Prismatic => MarkLook::Slide,
            JointKind::Cylindrical | JointKind::Helical { .. } => MarkLook::Sleeve,
            JointKind::Spherical => MarkLook::Ball,
            JointKind::Universal => MarkLook::Universal,
            JointKind::Planar => MarkLook::Planar,
            JointKind::Weld => MarkLook::Weld,
            JointKind::Gear { .. } => MarkLook::Teeth,
            JointKind::Distance { .. } => return self.rod(j, joint),
        };
        // A slide is where its block is, a sleeve on its side of the guide.
        let k = match joint.kind {
            JointKind::Prismatic => 1 - self.drawing.guide_side(joint),
            JointKind::Cylindrical if self.is_grounded(joint) => self.drawing.guide_side(joint),
            JointKind::Cylindrical | JointKind::Helical { .. } => {
                1 - self.drawing.guide_side(joint)
            }
            JointKind::Revolute
            | JointKind::Spherical
            | JointKind::Universal
            | JointKind::Planar
            | JointKind::Weld
            | JointKind::Gear { .. }
            | JointKind::Distance { .. } => 1,
        };
        let mark = self.mark(j, joint, (look, k), joint.name.clone());
        self.parts.push(Part::Mark(mark));
    }

    fn mark(&self, j: usize, joint: &Joint, (look, k): (MarkLook, usize), label: String) -> Mark {
        let bodies = &self.drawing.scene.mechanism.bodies;
        let [one, two] = joint.bodies.map(|b| bodies[b.0].name.as_str());
        Mark {
            look,
            at: anchor(joint.side_body(k), self.drawing.anchor(j, k)),
            axis: coordinates(joint.sides[k].axis),
            // Of a rod each end has its own ball.
            on_ground: match joint.kind {
                JointKind::Distance { .. } => self.drawing.is_ground(joint.bodies[k]),
                JointKind::Weld
                | JointKind::Revolute
                | JointKind::Prismatic
                | JointKind::Cylindrical
                | JointKind::Helical { .. }
                | JointKind::Universal
                | JointKind::Spherical
                | JointKind::Planar
                | JointKind::Gear { .. } => self.is_grounded(joint),
            },
            label,
            title: format!("{} (joint of {one} and {two})", joint.name),
        }
    }

    fn is_grounded(&self, joint: &Joint) -> bool {
        joint.bodies.iter().any(|b| self.drawing.is_ground(*b))
    }

    /// A massless rod with its balls.
    fn rod(&mut self, j: usize, joint: &Joint) {
        let ends = [0, 1].map(|k| anchor(joint.side_body(k), self.drawing.anchor(j, k)));
        self.parts.push(Part::Link {
            look: LinkLook::Rod,
            ends,
            bodies: [None; 2],
            title: joint.name.clone(),
        });
        for (k, label) in [(0, String::new()), (1, joint.name.clone())] {
            let mark = self.mark(j, joint, (MarkLook::Ball, k), label);
            self.parts.push(Part::Mark(mark));
        }
    }
}
