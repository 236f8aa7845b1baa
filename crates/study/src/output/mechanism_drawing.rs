//! Pictures of a mechanism in the plane: its parts, drawn in one position.

use crate::bodies::{BodyPose, point_position};
use crate::page::paint;
use crate::symbols::{DrawnIn, PlaneParts, circle, spring_outline};
use dwell_geometry::{BodyId, Vec2, vec2};
use dwell_page::{Anchor, LinkLook, Mark, MarkLook, OutlineLook, Part};
use dwell_report::{Paint, Pen, Shape, TextPlacement};
use dwell_scene::PlaneScene;

/// Half the width of a spring, in reference lengths.
const SPRING: f64 = 0.05;

/// Draws a mechanism in some of its positions.
pub struct MechanismDrawing<'a> {
    positions: &'a [Vec<BodyPose>],
    parts: PlaneParts<'a>,
    /// Shapes over the bodies and under the joints.
    paths: Vec<Shape>,
}

impl<'a> MechanismDrawing<'a> {
    /// For a scene at these positions.
    pub fn new(scene: &'a PlaneScene, positions: &'a [Vec<BodyPose>]) -> Self {
        Self {
            positions,
            parts: PlaneParts::new(scene, positions, &[]),
            paths: Vec::new(),
        }
    }

    /// Draws these lines, too, over the bodies of the position that is drawn in full.
    pub fn with_paths(mut self, paths: Vec<Shape>) -> Self {
        self.paths = paths;
        self
    }

    /// Draws only these bodies, and the joints between them.
    pub fn with_visible(mut self, bodies: &'a [bool]) -> Self {
        self.parts = PlaneParts::new(self.parts.scene, self.positions, bodies);
        self
    }

    /// Draws all bodies, then all joints, in one position; labels only at `lightness` 0.
    pub fn draw(&self, body_poses: &[BodyPose], lightness: f64, shapes: &mut Vec<Shape>) {
        let position = DrawnPosition {
            drawing: &self.parts,
            body_poses,
            lightness,
        };
        let is_full = lightness == 0.0;
        let parts = self.parts.parts.iter();
        let other = if is_full {
            DrawnIn::Light
        } else {
            DrawnIn::Full
        };
        let parts = parts.filter(|(_, drawn_in)| *drawn_in != other);
        let is_joint =
            |part: &Part| matches!(part, Part::Mark(mark) if mark.look != MarkLook::Support);
        let (joints, below): (Vec<_>, Vec<_>) =
            parts.map(|(part, _)| part).partition(|part| is_joint(part));
        if is_full {
            shapes.extend(position.legend());
        }
        shapes.extend(below.into_iter().flat_map(|part| position.shapes(part)));
        if is_full {
            shapes.extend(self.paths.iter().cloned());
        }
        shapes.extend(joints.into_iter().flat_map(|part| position.shapes(part)));
        if is_full {
            shapes.extend(position.labels());
        }
    }
}

/// Grey for the ground; six palette colours, then ink, then the colours again.
pub(crate) fn body_color(ground: usize, body: BodyId) -> Paint {
    match paint(ground, body.0) {
        None => Paint::Grey,
        Some(6) => Paint::Ink,
        Some(k) => Paint::Palette(k),
    }
}

/// One position of a mechanism.
struct DrawnPosition<'a> {
    drawing: &'a PlaneParts<'a>,
    body_poses: &'a [BodyPose],
    lightness: f64,
}

impl DrawnPosition<'_> {
    fn place(&self, body: usize, at: &[f64]) -> [f64; 2] {
        point_position(self.body_poses, body, vec2(at[0], at[1]))
    }

    fn pen(&self, color: Paint, width: f64) -> Pen {
        Pen::new(color, width).lightness(self.lightness)
    }

    fn color(&self, body: usize) -> Paint {
        body_color(self.drawing.scene.mechanism.ground, BodyId(body))
    }

    /// The shape with the name of its body, in the position that is drawn in full.
    fn named(&self, body: usize, shape: Shape) -> Shape {
        let mechanism = &self.drawing.scene.mechanism;
        if self.lightness == 0.0 && body != mechanism.ground {
            shape.named(mechanism.body_name(BodyId(body)))
        } else {
            shape
        }
    }

    /// The bodies in their order for the legend: they are drawn in another.
    fn legend(&self) -> Vec<Shape> {
        let entry = |body: usize| {
            let is_its = |part: &Part| match part {
                Part::Outline { body: of, look, .. } => {
                    use OutlineLook::{Bar, Block, Plate};
                    *of == body && matches!(look, Bar | Block | Plate)
                }
                Part::Link { .. } | Part::Mark(_) => false,
            };
            let mut parts = self.drawing.parts.iter().map(|(part, _)| part);
            let mut shape = self.shapes(parts.find(|part| is_its(part))?).pop()?;
            if let Shape::Polyline { points, .. } = &mut shape {
                points.clear();
            }
            Some(shape)
        };
        (0..self.body_poses.len()).filter_map(entry).collect()
    }

    fn shapes(&self, part: &Part) -> Vec<Shape> {
        match part {
            Part::Outline { look, body, points } => self.outline(*look, *body, points),
            Part::Link {
                look, ends, body, ..
            } => self.link(*look, ends, *body),
            Part::Mark(mark) => self.mark(mark),
        }
    }

    fn outline(&self, look: OutlineLook, body: usize, local: &[Vec<f64>]) -> Vec<Shape> {
        let color = self.color(body);
        let points: Vec<[f64; 2]> = local.iter().map(|p| self.place(body, p)).collect();
        let line = |width| Shape::line(points.clone(), self.pen(color, width));
        let area = |width, fill| Shape::area(points.clone(), self.pen(color, width), fill);
        let named = |shape| vec![self.named(body, shape)];
        match look {
            OutlineLook::Bar => named(line(6.0)),
            OutlineLook::Plate => named(area(4.0, 0.15)),
            OutlineLook::Block => named(area(3.0, 0.35)),
            OutlineLook::Barrel => named(line(12.0)),
            OutlineLook::Cam => named(area(3.0, 0.2)),
            OutlineLook::OpenCam => named(line(3.0)),
            OutlineLook::Rack => named(area(2.5, 0.2)),
            OutlineLook::Guide | OutlineLook::Arm => vec![line(3.0)],
            OutlineLook::Slot => {
                let inside = Pen::new(color, 11.0).lightness(1.0);
                vec![line(17.0), Shape::line(points.clone(), inside)]
            }
            OutlineLook::GroundLine => vec![Shape::GroundLine {
                from: points[0],
                to: points[1],
            }],
            // With a line that shows how it rotates unless it is fixed.
            OutlineLook::Wheel => {
                let ([x, y], radius) = (points[0], local[1][0]);
                let at = vec2(x, y);
                let rim = circle(at, radius).into_iter().map(array).collect();
                let mut shapes = named(Shape::line(rim, self.pen(color, 2.5)));
                if body != self.drawing.scene.mechanism.ground {
                    let spoke = at + self.body_poses[body].1 * radius;
                    shapes.push(Shape::line(
                        vec![[x, y], array(spoke)],
                        self.pen(color, 2.0),
                    ));
                }
                shapes
            }
        }
    }

    fn link(&self, look: LinkLook, ends: &[Anchor; 2], body: Option<usize>) -> Vec<Shape> {
        let ends = [0, 1].map(|k| self.place(ends[k].body, &ends[k].point));
        let [a, b] = ends.map(|[x, y]| vec2(x, y));
        let grey = |to, width| Shape::line(vec![ends[0], to], self.pen(Paint::Grey, width));
        let load = Pen::new(Paint::Ink, 2.0).lightness(0.35);
        match (look, body) {
            (LinkLook::Rod | LinkLook::Shaft | LinkLook::Drive, Some(body)) => {
                let pen = self.pen(self.color(body), 5.0);
                vec![self.named(body, Shape::line(ends.to_vec(), pen))]
            }
            (LinkLook::Rod | LinkLook::Shaft | LinkLook::Drive, None) => vec![grey(ends[1], 4.0)],
            (LinkLook::Cylinder, _) => vec![grey(ends[1], 4.0), grey(array((a + b) * 0.5), 11.0)],
            (LinkLook::Spring, _) => {
                let zigzag = spring_outline(a, b, SPRING * self.drawing.size);
                vec![Shape::line(zigzag.into_iter().map(array).collect(), load)]
            }
            (LinkLook::Damper, _) => vec![Shape::line(ends.to_vec(), load.dashed())],
        }
    }

    /// The marks that there are in the plane.
    fn mark(&self, mark: &Mark) -> Vec<Shape> {
        let at = self.place(mark.at.body, &mark.at.point);
        match mark.look {
            MarkLook::Support => vec![Shape::GroundPin { at }],
            MarkLook::Weld => vec![Shape::Disc {
                at,
                radius_px: 6.0,
                pen: self.pen(Paint::Ink, 2.0),
                filled: true,
                name: None,
            }],
            _ => vec![Shape::pin(at, Paint::Ink, self.lightness)],
        }
    }

    /// Joints at one point share a label.
    fn labels(&self) -> Vec<Shape> {
        let joints = &self.drawing.scene.mechanism.joints;
        let label = |(j, name): (usize, String)| {
            let joint = &joints[j];
            let at = point_position(self.body_poses, joint.bodies[0].0, joint.points[0]);
            let placement = if self.drawing.is_fixed(joint) {
                TextPlacement::AboveLeft
            } else {
                TextPlacement::AboveRight
            };
            Shape::text(at, name, placement)
        };
        let labels = self.drawing.labels(self.body_poses);
        labels.into_iter().map(label).collect()
    }
}

fn array(at: Vec2) -> [f64; 2] {
    [at.x, at.y]
}
