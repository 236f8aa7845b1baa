//! Drawing of a mechanism in one position: bodies as bars, plates and blocks, joints and springs.

use crate::bodies::{BodyPose, point_position};
use crate::page::paint;
use crate::symbols::{
    BodyOutline, PitchCurve, RAIL_DISTANCE, SLOT_DISTANCE, TOOTH, TRACK_MARGIN, blocks_on, circle,
    common_joint_name, is_cylinder, outline_of, pitch_curve, rack_outline, reach, spring_outline,
    symbol_size, travels,
};
use dwell_geometry::{ActuatorKind, BodyId, Joint, JointKind, Vec2, vec2};
use dwell_kinetostatics::LoadKind;
use dwell_report::{Paint, Pen, Shape, TextPlacement};
use dwell_scene::PlaneScene;

/// Draws a mechanism in some of its positions.
pub struct MechanismDrawing<'a> {
    scene: &'a PlaneScene,
    /// Reference length of the symbols, m.
    size: f64,
    /// By joint: range of its second point along its axis over all positions, m.
    travels: Vec<Option<[f64; 2]>>,
    /// By body: whether it is drawn.
    visible: Vec<bool>,
    /// The pitch curves of cams.
    cams: Vec<PitchCurve>,
    /// What is drawn over the bodies and under the joints.
    paths: Vec<Shape>,
}

fn array(at: Vec2) -> [f64; 2] {
    [at.x, at.y]
}

impl<'a> MechanismDrawing<'a> {
    /// For a scene at these positions.
    pub fn new(scene: &'a PlaneScene, positions: &[Vec<BodyPose>]) -> Self {
        let couplings = scene.mechanism.couplings.iter();
        let cams = couplings.filter_map(|coupling| pitch_curve(scene, coupling, positions));
        Self {
            cams: cams.collect(),
            paths: Vec::new(),
            scene,
            size: symbol_size(scene, positions),
            travels: travels(scene, positions),
            visible: vec![true; scene.mechanism.bodies.len()],
        }
    }

    /// Draws these lines, too, over the bodies of the position that is drawn in full.
    pub fn with_paths(mut self, paths: Vec<Shape>) -> Self {
        self.paths = paths;
        self
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
        let mut position = DrawnPosition {
            drawing: self,
            body_poses,
            lightness,
            shapes,
        };
        if lightness == 0.0 {
            position.name_bodies();
        }
        position.draw_background();
        position.draw_bodies();
        if lightness == 0.0 {
            position.draw_loads();
            position.shapes.extend(self.paths.iter().cloned());
        }
        position.draw_joints();
    }

    fn is_ground(&self, body: BodyId) -> bool {
        body.0 == self.scene.mechanism.ground
    }

    /// Whether a joint is on the ground.
    fn is_fixed(&self, joint: &Joint) -> bool {
        joint.bodies.iter().any(|b| self.is_ground(*b))
    }

    fn color(&self, body: BodyId) -> Paint {
        body_color(self.scene.mechanism.ground, body)
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

/// One position of a mechanism, with the shapes drawn so far.
struct DrawnPosition<'a> {
    drawing: &'a MechanismDrawing<'a>,
    body_poses: &'a [BodyPose],
    lightness: f64,
    shapes: &'a mut Vec<Shape>,
}

impl DrawnPosition<'_> {
    fn point(&self, body: BodyId, at: Vec2) -> Vec2 {
        let [x, y] = point_position(self.body_poses, body.0, at);
        vec2(x, y)
    }

    fn points(&self, bodies: [BodyId; 2], points: [Vec2; 2]) -> [Vec2; 2] {
        [0, 1].map(|i| self.point(bodies[i], points[i]))
    }

    fn rotation(&self, body: BodyId) -> Vec2 {
        self.body_poses[body.0].1
    }

    fn pen(&self, color: Paint, width: f64) -> Pen {
        Pen::new(color, width).lightness(self.lightness)
    }

    fn line(&mut self, points: &[Vec2], pen: Pen) {
        let points = points.iter().copied().map(array);
        self.shapes.push(Shape::line(points.collect(), pen));
    }

    /// Draws what lies behind the bodies: pitch circles, tracks, slots and cylinders.
    fn draw_background(&mut self) {
        let (drawing, is_first) = (self.drawing, self.lightness == 0.0);
        let mechanism = &drawing.scene.mechanism;
        for (j, (joint, travel)) in mechanism.joints.iter().zip(&drawing.travels).enumerate() {
            if !drawing.is_visible(joint.bodies) {
                continue;
            }
            let [one, two] = joint.bodies;
            let at = self.points(joint.bodies, joint.points);
            match joint.kind {
                // Wheels are drawn in the first position only.
                JointKind::Gear { radii, .. } if is_first => {
                    for i in 0..2 {
                        self.disc(joint.bodies[i], at[i], radii[i]);
                    }
                }
                JointKind::Rack { axis, radius } | JointKind::Rolling { axis, radius } => {
                    self.track(joint, axis, *travel);
                    self.disc(two, at[1], radius.abs());
                }
                JointKind::Slot { axis } if is_first => self.track(joint, axis, *travel),
                JointKind::Prismatic { axes } if is_cylinder(drawing.scene, j) => {
                    let min_travel = travel.map_or(0.0, |[low, _]| 0.85 * low);
                    let end = at[0] + axes[0].rotate(self.rotation(one)) * min_travel;
                    self.named_line(two, &at, 5.0);
                    self.named_line(one, &[at[0], end], 12.0);
                }
                JointKind::Prismatic { axes } if is_first || !drawing.is_fixed(joint) => {
                    self.track(joint, axes[0], *travel);
                }
                JointKind::Distance { .. } => self.line(&at, self.pen(Paint::Grey, 4.0)),
                // Below the bodies: it would hide the end of a link that hangs from it.
                JointKind::Revolute if is_first && drawing.is_fixed(joint) => {
                    self.shapes.push(Shape::GroundPin { at: array(at[0]) });
                }
                // Pins are drawn on top of the bodies; of a slide, a slot or teeth one drawing is enough.
                JointKind::Gear { .. }
                | JointKind::Revolute
                | JointKind::Slot { .. }
                | JointKind::Prismatic { .. }
                | JointKind::Weld { .. }
                | JointKind::Coupling(_) => {}
            }
        }
        if is_first {
            self.draw_cams();
        }
        let actuators = mechanism.actuators.iter();
        for actuator in actuators.filter(|a| drawing.is_visible(a.bodies)) {
            if let ActuatorKind::Length(points) = actuator.kind {
                let [a, b] = self.points(actuator.bodies, points);
                self.line(&[a, b], self.pen(Paint::Grey, 4.0));
                self.line(&[a, (a + b) * 0.5], self.pen(Paint::Grey, 11.0));
            }
        }
    }

    /// The curves that the followers' points follow on their cams.
    fn draw_cams(&mut self) {
        let drawing = self.drawing;
        for cam in drawing.cams.iter().filter(|cam| drawing.visible[cam.body]) {
            let body = BodyId(cam.body);
            let points = cam
                .points
                .iter()
                .map(|p| array(self.point(body, *p)))
                .collect();
            let pen = self.pen(drawing.color(body), 3.0);
            let shape = match cam.closed {
                true => Shape::area(points, pen, 0.2),
                false => Shape::line(points, pen),
            };
            self.shapes.push(self.named(body, shape));
        }
    }

    /// The shape with the name of its body, in the position that is drawn in full.
    fn named(&self, body: BodyId, shape: Shape) -> Shape {
        let mechanism = &self.drawing.scene.mechanism;
        match self.lightness == 0.0 && !self.drawing.is_ground(body) {
            true => shape.named(mechanism.body_name(body)),
            false => shape,
        }
    }

    /// A line that is a part of a body.
    fn named_line(&mut self, body: BodyId, points: &[Vec2], width: f64) {
        let pen = self.pen(self.drawing.color(body), width);
        let line = Shape::line(points.iter().copied().map(array).collect(), pen);
        self.shapes.push(self.named(body, line));
    }

    /// The bodies in their order for the legend: they are drawn in another.
    fn name_bodies(&mut self) {
        for body in self.drawn_bodies() {
            let mut shape = self.named(BodyId(body), self.body_shape(body));
            if let Shape::Polyline { points, .. } = &mut shape {
                points.clear();
            }
            self.shapes.push(shape);
        }
    }

    /// A disc, with a line that shows how it rotates unless it is fixed.
    fn disc(&mut self, body: BodyId, at: Vec2, radius: f64) {
        let color = self.drawing.color(body);
        self.named_line(body, &circle(at, radius), 2.5);
        if !self.drawing.is_ground(body) {
            let rim = at + self.rotation(body) * radius;
            self.line(&[at, rim], self.pen(color, 2.0));
        }
    }

    /// The straight line on the first body along which the joint's second point goes.
    fn track(&mut self, joint: &Joint, axis: Vec2, travel: Option<[f64; 2]>) {
        let one = joint.bodies[0];
        let start = self.point(one, joint.points[0]);
        let direction = axis.rotate(self.rotation(one));
        let [low, high] = travel.unwrap_or([0.0; 2]);
        let margin = TRACK_MARGIN * self.drawing.size;
        let [from, to] = [low - margin, high + margin].map(|s| start + direction * s);
        let radius = match joint.kind {
            JointKind::Rack { radius, .. } | JointKind::Rolling { radius, .. } => Some(radius),
            _ => None,
        };
        let is_first = self.lightness == 0.0;
        if let (JointKind::Rack { radius, .. }, true) = (&joint.kind, is_first) {
            // The wheel is on the left of the track where its radius is positive.
            let normal = direction.perp() * radius.signum();
            let outline = rack_outline([from, to], normal, TOOTH * self.drawing.size);
            let pen = Pen::new(self.drawing.color(one), 2.5);
            let rack = Shape::area(outline.into_iter().map(array).collect(), pen, 0.2);
            self.shapes.push(self.named(one, rack));
        } else if !self.drawing.is_ground(one) {
            let color = self.drawing.color(one);
            let wide = Pen::new(color, if radius.is_some() { 3.0 } else { 17.0 });
            self.line(&[from, to], wide.lightness(self.lightness));
            if radius.is_none() {
                self.line(&[from, to], Pen::new(color, 11.0).lightness(1.0));
            }
        } else if let (Some(radius), true) = (radius, is_first) {
            // The hatching is on the right of the track: away from the disc.
            self.ground_line(if radius < 0.0 { [to, from] } else { [from, to] });
        } else if is_first {
            // Two rails, each hatched on its outer side.
            let share = match joint.kind {
                JointKind::Slot { .. } => SLOT_DISTANCE,
                _ => RAIL_DISTANCE,
            };
            let across = direction.perp() * (share * self.drawing.size);
            self.ground_line([from - across, to - across]);
            self.ground_line([to + across, from + across]);
        }
    }

    fn ground_line(&mut self, ends: [Vec2; 2]) {
        let [from, to] = ends.map(array);
        self.shapes.push(Shape::GroundLine { from, to });
    }

    fn drawn_bodies(&self) -> Vec<usize> {
        let drawing = self.drawing;
        let is_drawn = |b: &usize| !drawing.is_ground(BodyId(*b)) && drawing.visible[*b];
        (0..drawing.visible.len()).filter(is_drawn).collect()
    }

    /// The large ones first: where two lie on each other, the small one stays in sight.
    fn draw_bodies(&mut self) {
        let reach = |b: usize| reach(self.drawing.scene, b);
        let is_block = |b: &usize| reach(*b) == 0.0;
        let mut bodies = self.drawn_bodies();
        bodies.sort_by(|a, b| {
            let blocks = is_block(a).cmp(&is_block(b));
            blocks.then(reach(*b).total_cmp(&reach(*a)))
        });
        for b in bodies {
            let shape = self.named(BodyId(b), self.body_shape(b));
            self.shapes.push(shape);
            for corners in blocks_on(self.drawing.scene, b, self.drawing.size) {
                let corners = corners.map(|p| array(self.point(BodyId(b), p))).to_vec();
                let pen = self.pen(self.drawing.color(BodyId(b)), 3.0);
                let block = self.named(BodyId(b), Shape::area(corners, pen, 0.35));
                self.shapes.push(block);
            }
        }
    }

    /// A small block that slides, a plate through three or more points, or a bar through points of one line.
    fn body_shape(&self, body: usize) -> Shape {
        let (drawing, id) = (self.drawing, BodyId(body));
        let pen = |width| self.pen(drawing.color(id), width);
        let at = |points: &[Vec2]| points.iter().map(|p| array(self.point(id, *p))).collect();
        match outline_of(drawing.scene, body, drawing.size) {
            BodyOutline::Block(corners) => Shape::area(at(&corners), pen(3.0), 0.35),
            BodyOutline::Plate(points) => Shape::area(at(&points), pen(4.0), 0.15),
            BodyOutline::Bar(points) => Shape::line(at(&points), pen(6.0)),
        }
    }

    fn draw_joints(&mut self) {
        let (drawing, lightness) = (self.drawing, self.lightness);
        let named = lightness == 0.0;
        let pin = |at: Vec2| Shape::pin(array(at), Paint::Ink, lightness);
        // Joints at one point share a label.
        let mut labels: Vec<(Vec2, Vec<&Joint>, TextPlacement)> = Vec::new();
        let mut label = |at: Vec2, joint, side: TextPlacement| {
            let is_near = |other: Vec2| (other - at).norm() < 0.02 * drawing.size;
            match labels.iter_mut().find(|l| is_near(l.0)) {
                Some((_, joints, _)) => joints.push(joint),
                None => labels.push((at, vec![joint], side)),
            }
        };
        let joints = drawing.scene.mechanism.joints.iter();
        for joint in joints.filter(|j| drawing.is_visible(j.bodies)) {
            let ends = self.points(joint.bodies, joint.points);
            match joint.kind {
                JointKind::Revolute if drawing.is_fixed(joint) && !named => {}
                JointKind::Revolute => {
                    self.shapes.push(pin(ends[0]));
                    let sides = [TextPlacement::AboveRight, TextPlacement::AboveLeft];
                    let side = sides[usize::from(drawing.is_fixed(joint))];
                    if named {
                        label(ends[0], joint, side);
                    }
                }
                JointKind::Slot { .. } => self.shapes.push(pin(ends[1])),
                JointKind::Distance { .. } => self.shapes.extend(ends.map(pin)),
                JointKind::Weld { .. } => self.shapes.push(Shape::Disc {
                    at: array(ends[0]),
                    radius_px: 6.0,
                    pen: self.pen(Paint::Ink, 2.0),
                    filled: true,
                    name: None,
                }),
                // A prismatic joint is drawn by its line and block, gears and wheels by their circles.
                JointKind::Prismatic { .. }
                | JointKind::Gear { .. }
                | JointKind::Rack { .. }
                | JointKind::Rolling { .. }
                | JointKind::Coupling(_) => {}
            }
        }
        for (at, joints, side) in labels {
            let name = common_joint_name(drawing.scene, &joints);
            self.shapes.push(Shape::text(array(at), name, side));
        }
    }

    /// Springs and dampers between points.
    fn draw_loads(&mut self) {
        let pen = Pen::new(Paint::Ink, 2.0).lightness(0.35);
        let half_width = 0.05 * self.drawing.size;
        for load in &self.drawing.scene.loads {
            match load.kind {
                LoadKind::Spring { bodies, points, .. } => {
                    let [a, b] = self.points(bodies, points);
                    self.line(&spring_outline(a, b, half_width), pen);
                }
                LoadKind::Damper { bodies, points } => {
                    self.line(&self.points(bodies, points), pen.dashed());
                }
                LoadKind::Gravity { .. }
                | LoadKind::Force { .. }
                | LoadKind::Torque { .. }
                | LoadKind::TorsionSpring { .. }
                | LoadKind::RotationalDamper { .. }
                | LoadKind::PointToPointForce { .. }
                | LoadKind::SlideForce(_)
                | LoadKind::SlideDamper(_)
                | LoadKind::SeparatingForce(_) => {}
            }
        }
    }
}
