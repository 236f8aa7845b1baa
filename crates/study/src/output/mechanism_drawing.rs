//! Drawing of a mechanism in one position: bodies as bars, plates and blocks, joints and springs.

use crate::bodies::{BodyPose, point_position};
use dwell_geometry::{ActuatorKind, BodyId, Joint, JointId, JointKind, Vec2, vec2};
use dwell_kinetostatics::LoadKind;
use dwell_report::{Paint, Pen, Shape, TextPlacement};
use dwell_scene::Scene;
use std::f64::consts::TAU;

/// Number of corners of a circle.
const CIRCLE_POINTS: usize = 72;
/// Number of coils of a spring.
const SPRING_COILS: usize = 7;

/// Draws a mechanism in some of its positions.
pub struct MechanismDrawing<'a> {
    scene: &'a Scene,
    /// Reference length of the symbols, m.
    size: f64,
    /// By joint: range of its second point along its axis over all positions, m.
    travels: Vec<Option<[f64; 2]>>,
    /// By body: whether it is drawn.
    visible: Vec<bool>,
}

/// The outline of a body.
enum Outline {
    /// A small block that slides.
    Block([Vec2; 4]),
    /// A plate through three or more points.
    Plate(Vec<Vec2>),
    /// A bar through points of one line.
    Bar(Vec<Vec2>),
}

fn vector([x, y]: [f64; 2]) -> Vec2 {
    vec2(x, y)
}

impl<'a> MechanismDrawing<'a> {
    /// For a scene at these positions.
    pub fn new(scene: &'a Scene, positions: &[Vec<BodyPose>]) -> Self {
        let travel = |joint: &Joint| {
            let axis = axis_of(joint.kind)?;
            let [one, two] = joint.bodies.map(|b| b.0);
            let travel_along = |body_poses: &Vec<BodyPose>| {
                let [a, b] = [(one, joint.points[0]), (two, joint.points[1])]
                    .map(|(body, at)| vector(point_position(body_poses, body, at)));
                axis.rotate(body_poses[one].1).dot(b - a)
            };
            let all = positions.iter().map(travel_along);
            let limits = all.fold([f64::MAX, f64::MIN], |[l, h], s| [l.min(s), h.max(s)]);
            (limits[0] <= limits[1]).then_some(limits)
        };
        Self {
            scene,
            size: mean_body_length(scene),
            travels: scene.mechanism.joints.iter().map(travel).collect(),
            visible: vec![true; scene.mechanism.bodies.len()],
        }
    }

    /// Draws only these bodies, and the joints between them.
    pub fn with_visible(mut self, bodies: &[bool]) -> Self {
        for (visible, &body) in self.visible.iter_mut().zip(bodies) {
            *visible = body;
        }
        self
    }

    fn is_visible(&self, bodies: [BodyId; 2]) -> bool {
        bodies.iter().all(|b| self.visible[b.0])
    }

    /// Draws all bodies, then all joints, in one position; labels only at `lightness` 0.
    pub fn draw(&self, body_poses: &[BodyPose], lightness: f64, shapes: &mut Vec<Shape>) {
        self.draw_background(body_poses, lightness, shapes);
        self.draw_bodies(body_poses, lightness, shapes);
        self.draw_loads(body_poses, lightness, shapes);
        self.draw_joints(body_poses, lightness, shapes);
    }

    /// Grey for the ground; six palette colours, then ink, then the colours again.
    fn color(&self, body: BodyId) -> Paint {
        let ground = self.scene.mechanism.ground;
        if body.0 == ground {
            return Paint::Grey;
        }
        match (body.0 - usize::from(body.0 > ground)) % 7 {
            6 => Paint::Ink,
            k => Paint::Palette(k),
        }
    }

    /// Draws what lies behind the bodies: pitch circles, tracks, slots and cylinders.
    fn draw_background(&self, body_poses: &[BodyPose], lightness: f64, shapes: &mut Vec<Shape>) {
        let mechanism = &self.scene.mechanism;
        for (j, (joint, travel)) in mechanism.joints.iter().zip(&self.travels).enumerate() {
            if !self.is_visible(joint.bodies) {
                continue;
            }
            let [one, two] = joint.bodies;
            let pen = |body, width| Pen::new(self.color(body), width).lightness(lightness);
            let at = [0, 1].map(|i| point_position(body_poses, joint.bodies[i].0, joint.points[i]));
            match joint.kind {
                JointKind::Gear { radii, .. } => {
                    for i in 0..2 {
                        let body = joint.bodies[i];
                        // Wheels are drawn in the first position only.
                        if lightness == 0.0 {
                            shapes.push(circle(at[i], radii[i], pen(body, 2.5)));
                            shapes.extend(self.spoke(body_poses, body, at[i], radii[i], lightness));
                        }
                    }
                }
                JointKind::Rack { axis, radius } | JointKind::Rolling { axis, radius } => {
                    self.track(body_poses, joint, axis, travel.as_ref(), lightness, shapes);
                    shapes.push(circle(at[1], radius.abs(), pen(two, 2.5)));
                    shapes.extend(self.spoke(body_poses, two, at[1], radius.abs(), lightness));
                }
                JointKind::Slot { axis } if lightness == 0.0 => {
                    self.track(body_poses, joint, axis, travel.as_ref(), lightness, shapes);
                }
                JointKind::Prismatic { axes } => {
                    let on_ground = joint.bodies.iter().any(|b| b.0 == mechanism.ground);
                    if self.is_cylinder(j) {
                        let a = vector(at[0]);
                        let min_travel = travel.map_or(0.0, |[low, _]| 0.85 * low);
                        let end = a + axes[0].rotate(body_poses[one.0].1) * min_travel;
                        shapes.push(Shape::line(at.to_vec(), pen(two, 5.0)));
                        shapes.push(Shape::line(
                            vec![[a.x, a.y], [end.x, end.y]],
                            pen(one, 12.0),
                        ));
                    } else if !on_ground || lightness == 0.0 {
                        self.track(
                            body_poses,
                            joint,
                            axes[0],
                            travel.as_ref(),
                            lightness,
                            shapes,
                        );
                    }
                }
                JointKind::Distance { .. } => {
                    let link = Pen::new(Paint::Grey, 4.0).lightness(lightness);
                    shapes.push(Shape::line(at.to_vec(), link));
                }
                _ => {}
            }
        }
        for actuator in &mechanism.actuators {
            if let (ActuatorKind::Length(points), true) =
                (actuator.kind, self.is_visible(actuator.bodies))
            {
                let [a, b] =
                    [0, 1].map(|i| point_position(body_poses, actuator.bodies[i].0, points[i]));
                let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
                let pen = |width| Pen::new(Paint::Grey, width).lightness(lightness);
                shapes.push(Shape::line(vec![a, b], pen(4.0)));
                shapes.push(Shape::line(vec![a, middle], pen(11.0)));
            }
        }
    }

    /// Whether a joint is a driven prismatic one between two moving bodies.
    fn is_cylinder(&self, joint: usize) -> bool {
        let mechanism = &self.scene.mechanism;
        let drives = ActuatorKind::Travel(JointId(joint));
        let bodies = mechanism.joints[joint].bodies;
        let moving = bodies.iter().all(|b| b.0 != mechanism.ground);
        moving && mechanism.actuators.iter().any(|a| a.kind == drives)
    }

    /// A line on a disc that shows how it turns.
    fn spoke(
        &self,
        body_poses: &[BodyPose],
        body: BodyId,
        at: [f64; 2],
        radius: f64,
        lightness: f64,
    ) -> Option<Shape> {
        if body.0 == self.scene.mechanism.ground {
            return None;
        }
        let rim = vector(at) + body_poses[body.0].1 * radius;
        let pen = Pen::new(self.color(body), 2.0).lightness(lightness);
        Some(Shape::line(vec![at, [rim.x, rim.y]], pen))
    }

    /// The straight line on the first body along which the joint's second point goes.
    fn track(
        &self,
        body_poses: &[BodyPose],
        joint: &Joint,
        axis: Vec2,
        travel: Option<&[f64; 2]>,
        lightness: f64,
        shapes: &mut Vec<Shape>,
    ) {
        let one = joint.bodies[0];
        let start = vector(point_position(body_poses, one.0, joint.points[0]));
        let direction = axis.rotate(body_poses[one.0].1);
        let [low, high] = travel.copied().unwrap_or([0.0; 2]);
        let margin = 0.25 * self.size;
        let [from, to] = [low - margin, high + margin]
            .map(|s| start + direction * s)
            .map(|p| [p.x, p.y]);
        let fixed = one.0 == self.scene.mechanism.ground;
        let solid = matches!(
            joint.kind,
            JointKind::Rack { .. } | JointKind::Rolling { .. }
        );
        if fixed && solid && lightness == 0.0 {
            // The hatching is on the right of the track: away from the disc.
            let radius = match joint.kind {
                JointKind::Rack { radius, .. } | JointKind::Rolling { radius, .. } => radius,
                _ => 0.0,
            };
            let (from, to) = if radius < 0.0 { (to, from) } else { (from, to) };
            shapes.push(Shape::GroundLine { from, to });
        } else if fixed && lightness == 0.0 {
            shapes.push(Shape::GroundLine { from, to });
        } else if !fixed {
            let color = self.color(one);
            let wide = Pen::new(color, if solid { 3.0 } else { 17.0 });
            shapes.push(Shape::line(
                vec![from, to],
                wide.lightness(lightness.max(0.55)),
            ));
            if !solid {
                let inner = Pen::new(color, 11.0).lightness(1.0);
                shapes.push(Shape::line(vec![from, to], inner));
            }
        }
    }

    fn draw_bodies(&self, body_poses: &[BodyPose], lightness: f64, shapes: &mut Vec<Shape>) {
        let mechanism = &self.scene.mechanism;
        let moving = (0..mechanism.bodies.len()).filter(|&b| b != mechanism.ground);
        for body in moving.filter(|&b| self.visible[b]) {
            let pen = Pen::new(self.color(BodyId(body)), 6.0).lightness(lightness);
            let at = |points: &[Vec2]| {
                points
                    .iter()
                    .map(|p| point_position(body_poses, body, *p))
                    .collect()
            };
            let shape = match self.outline(body) {
                Outline::Block(corners) => {
                    Shape::area(at(&corners), Pen { width: 3.0, ..pen }, 0.35)
                }
                Outline::Plate(corners) => {
                    Shape::area(at(&corners), Pen { width: 4.0, ..pen }, 0.15)
                }
                Outline::Bar(ends) => Shape::line(at(&ends), pen),
            };
            shapes.push(match lightness == 0.0 {
                true => shape.named(mechanism.bodies[body].name.clone()),
                false => shape,
            });
        }
    }

    fn draw_joints(&self, body_poses: &[BodyPose], lightness: f64, shapes: &mut Vec<Shape>) {
        let mechanism = &self.scene.mechanism;
        let named = lightness == 0.0;
        // Joints at one point share a label.
        let mut labels: Vec<([f64; 2], Vec<&Joint>, TextPlacement)> = Vec::new();
        let mut label = |at: [f64; 2], joint, side: TextPlacement| {
            let near = |l: &&mut ([f64; 2], Vec<&Joint>, TextPlacement)| {
                (vector(l.0) - vector(at)).norm() < 0.02 * self.size
            };
            match labels.iter_mut().find(near) {
                Some((_, joints, _)) => joints.push(joint),
                None => labels.push((at, vec![joint], side)),
            }
        };
        for joint in mechanism
            .joints
            .iter()
            .filter(|j| self.is_visible(j.bodies))
        {
            let on_ground = joint.bodies.iter().any(|b| b.0 == mechanism.ground);
            let ends =
                [0, 1].map(|i| point_position(body_poses, joint.bodies[i].0, joint.points[i]));
            match joint.kind {
                JointKind::Revolute if on_ground && named => {
                    shapes.push(Shape::GroundPin { at: ends[0] });
                    label(ends[0], joint, TextPlacement::AboveLeft);
                }
                JointKind::Revolute if on_ground => {}
                JointKind::Revolute => {
                    shapes.push(Shape::pin(ends[0], Paint::Ink, lightness));
                    if named {
                        label(ends[0], joint, TextPlacement::AboveRight);
                    }
                }
                JointKind::Slot { .. } => shapes.push(Shape::pin(ends[1], Paint::Ink, lightness)),
                JointKind::Distance { .. } => {
                    shapes.extend(ends.map(|at| Shape::pin(at, Paint::Ink, lightness)));
                }
                JointKind::Weld { .. } => shapes.push(Shape::Disc {
                    at: ends[0],
                    radius_px: 6.0,
                    pen: Pen::new(Paint::Ink, 2.0).lightness(lightness),
                    filled: true,
                    name: None,
                }),
                _ => {}
            }
        }
        let grouped = labels.into_iter();
        shapes.extend(
            grouped.map(|(at, joints, side)| Shape::text(at, self.common_name(&joints), side)),
        );
    }

    /// The common label of joints at one point: for a pin of several bodies, whose joints are named `pin-body`, the pin.
    fn common_name(&self, joints: &[&Joint]) -> String {
        let pin = |joint: &&Joint| {
            let body = self.scene.mechanism.body_name(joint.bodies[1]);
            let pin = joint.name.strip_suffix(body)?.strip_suffix('-')?;
            Some(pin.to_owned())
        };
        let pins: Option<Vec<String>> = joints.iter().map(pin).collect();
        match pins.as_deref() {
            Some([first, second, rest @ ..])
                if [second].into_iter().chain(rest).all(|p| p == first) =>
            {
                first.clone()
            }
            _ => {
                let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
                names.join(", ")
            }
        }
    }

    /// Springs and dampers between points, at `lightness` 0 only.
    fn draw_loads(&self, body_poses: &[BodyPose], lightness: f64, shapes: &mut Vec<Shape>) {
        if lightness > 0.0 {
            return;
        }
        let pen = Pen::new(Paint::Ink, 2.0).lightness(0.35);
        for load in &self.scene.loads {
            let (LoadKind::Spring { bodies, points, .. } | LoadKind::Damper { bodies, points }) =
                load.kind
            else {
                continue;
            };
            let [a, b] = [0, 1].map(|i| vector(point_position(body_poses, bodies[i].0, points[i])));
            let outline = match load.kind {
                LoadKind::Spring { .. } => spring_outline(a, b, 0.05 * self.size),
                _ => vec![[a.x, a.y], [b.x, b.y]],
            };
            let pen = match load.kind {
                LoadKind::Spring { .. } => pen,
                _ => pen.dashed(),
            };
            shapes.push(Shape::line(outline, pen));
        }
    }

    fn outline(&self, body: usize) -> Outline {
        let named = self.scene.points[body].iter();
        let mut points: Vec<Vec2> = Vec::new();
        for (_, p) in named {
            if !points.contains(p) {
                points.push(*p);
            }
        }
        if let (&[at], Some(axis)) = (points.as_slice(), self.slide_axis(body)) {
            let half = 0.045 * self.size;
            let (along, across) = (axis * (1.6 * half), axis.perp() * half);
            return Outline::Block([
                at - along - across,
                at + along - across,
                at + along + across,
                at - along + across,
            ]);
        }
        let middle =
            points.iter().fold(Vec2::ZERO, |sum, p| sum + *p) * (1.0 / points.len().max(1) as f64);
        let farthest_offset = points
            .iter()
            .map(|p| *p - middle)
            .max_by(|a, b| a.norm().total_cmp(&b.norm()))
            .unwrap_or(Vec2::ZERO);
        let off_line = |p: &Vec2| {
            farthest_offset.cross(*p - middle).abs() > 1e-6 * farthest_offset.norm().powi(2)
        };
        if points.len() > 2 && points.iter().any(off_line) {
            points.sort_by(|a, b| (*a - middle).angle().total_cmp(&(*b - middle).angle()));
            Outline::Plate(points)
        } else {
            points.sort_by(|a, b| farthest_offset.dot(*a).total_cmp(&farthest_offset.dot(*b)));
            Outline::Bar(points)
        }
    }

    /// The axis of a body's prismatic joint, in its frame.
    fn slide_axis(&self, body: usize) -> Option<Vec2> {
        let joints = self.scene.mechanism.joints.iter().enumerate();
        joints.into_iter().find_map(|(j, joint)| {
            let JointKind::Prismatic { axes } = joint.kind else {
                return None;
            };
            if self.is_cylinder(j) {
                return None;
            }
            let end = joint.bodies.iter().position(|b| b.0 == body)?;
            Some(axes[end])
        })
    }
}

fn axis_of(kind: JointKind) -> Option<Vec2> {
    match kind {
        JointKind::Prismatic { axes } => Some(axes[0]),
        JointKind::Slot { axis }
        | JointKind::Rack { axis, .. }
        | JointKind::Rolling { axis, .. } => Some(axis),
        _ => None,
    }
}

fn circle([x, y]: [f64; 2], radius: f64, pen: Pen) -> Shape {
    let corner = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / CIRCLE_POINTS as f64).sin_cos();
        [x + radius * cos, y + radius * sin]
    };
    Shape::line((0..=CIRCLE_POINTS).map(corner).collect(), pen)
}

/// A zigzag between two points.
fn spring_outline(a: Vec2, b: Vec2, half: f64) -> Vec<[f64; 2]> {
    let gap = b - a;
    if gap.norm() == 0.0 {
        return Vec::new();
    }
    let across = gap.perp() * (half / gap.norm());
    let zigzag_point = |k: usize| {
        let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let fraction = 0.15 + 0.7 * (k as f64 + 0.5) / (2 * SPRING_COILS) as f64;
        a + gap * fraction + across * sign
    };
    let mut points = vec![a, a + gap * 0.15];
    points.extend((0..2 * SPRING_COILS).map(zigzag_point));
    points.extend([a + gap * 0.85, b]);
    points.into_iter().map(|p| [p.x, p.y]).collect()
}

/// The mean length of the bodies that have one, m.
pub(crate) fn mean_body_length(scene: &Scene) -> f64 {
    let extent = |points: &Vec<(String, Vec2)>| {
        let all = points
            .iter()
            .flat_map(|(_, p)| points.iter().map(|(_, r)| (*p - *r).norm()));
        all.fold(0.0, f64::max)
    };
    let lengths: Vec<f64> = scene
        .points
        .iter()
        .map(extent)
        .filter(|l| *l > 0.0)
        .collect();
    lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
}
