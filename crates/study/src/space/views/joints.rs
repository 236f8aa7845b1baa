//! The symbols of joints in space.

use super::arrangement::{ARM, GUIDE_MARGIN};
use super::drawing::{BEFORE, Scenery};
use super::solids::{Axes, ball, block, cylinder, thread};
use dwell_geometry::JointId;
use dwell_geometry::space::{ActuatorKind, Joint, JointKind, Vec3};
use dwell_report::{Paint, Pen, Shape};
use std::f64::consts::{PI, TAU};

/// Radii of hinges and balls, half a block's width and length, half the length of a sleeve: in half lengths of a hinge.
const HINGE_RADIUS: f64 = 0.5;
const BALL_RADIUS: f64 = 0.55;
const BLOCK: [f64; 2] = [0.8, 1.3];
const SLEEVE: f64 = 1.3;
const PLATE: [f64; 2] = [2.4, 0.08];
/// Width of guides and massless rods, pixels.
const ROD: f64 = 3.5;

impl<'a> Scenery<'a> {
    /// The symbol of a joint, with the ground's hatching.
    //
    // Long: a few lines for each kind of joint.
    pub(super) fn joint(&mut self, j: usize) {
        let joint = &self.drawing.scene.mechanism.joints[j];
        let unit = self.drawing.unit;
        let [one, two] = joint.bodies;
        let ends = [self.anchor(j, 0), self.anchor(j, 1)];
        let at = ends[1];
        let axes = self.axes(joint, 0);
        let sleeve = [HINGE_RADIUS * unit, SLEEVE * unit];
        let plain = |of: &Self| (of.drawing.color(two), None);
        match joint.kind {
            JointKind::Revolute => {
                self.center_line(at, axes.axis);
                // In the colour of the body that moves, so that one of two hinges close together is seen, too.
                let body = if self.drawing.is_ground(two) {
                    one
                } else {
                    two
                };
                let paint = (self.drawing.color(body), self.name(body));
                self.cylinder(at, &axes, [HINGE_RADIUS * unit, unit], paint);
                self.ground_mark(joint, at, Some(axes.axis));
            }
            JointKind::Spherical => {
                self.ball(at, BALL_RADIUS);
                self.ground_mark(joint, at, None);
            }
            JointKind::Cylindrical if joint.bodies.iter().any(|b| self.drawing.is_ground(*b)) => {
                self.grounded_sleeve(j);
            }
            JointKind::Cylindrical => {
                self.guide(j);
                self.cylinder(at, &axes, sleeve, plain(self));
            }
            JointKind::Helical { pitch } => {
                self.guide(j);
                self.cylinder(at, &axes, sleeve, plain(self));
                let thread = thread(&self.picture.view, at, &axes, sleeve, pitch >= 0.0);
                self.picture.add(self.before(at), vec![thread]);
            }
            JointKind::Prismatic => self.slide(j),
            JointKind::Universal => self.universal(j, at),
            JointKind::Planar => {
                let foot = at + axes.axis.scaled(-0.3 * unit);
                let size = PLATE.map(|s| s * unit);
                let plate = self.drawing.color(one);
                let plane = block(&self.picture.view, foot, &axes, size, plate, None);
                self.picture.add(self.before(at) - unit, plane);
                self.cylinder(at, &axes, [unit, 0.3 * unit], plain(self));
                self.ground_mark(joint, at, Some(axes.normal));
            }
            JointKind::Distance { .. } => {
                self.bar(ends, (Paint::Grey, ROD), None);
                for (end, body) in ends.into_iter().zip(joint.bodies) {
                    self.ball(end, 0.75 * BALL_RADIUS);
                    if self.drawing.is_ground(body) {
                        self.hatching(end, None, -(self.middle(two) - end));
                    }
                }
            }
            JointKind::Weld => {
                self.ball(at, 0.4);
                self.ground_mark(joint, at, None);
            }
            // The normal of the teeth, through the pitch point.
            JointKind::Gear { .. } => {
                let ends = [-0.9, 0.9].map(|s| at + axes.axis.scaled(s * unit));
                let normal = self.segment(ends, Pen::new(Paint::Ink, 2.5));
                self.picture.add(self.before(at), vec![normal]);
                self.ball(at, 0.3);
            }
        }
    }

    /// How near the symbol of a joint at a point is drawn: before the bars that it connects.
    fn before(&self, at: Vec3) -> f64 {
        self.picture.view.nearness(at) + BEFORE * self.drawing.unit
    }

    fn cylinder(&mut self, at: Vec3, axes: &Axes, size: [f64; 2], paint: (Paint, Option<&str>)) {
        let shapes = cylinder(&self.picture.view, at, axes, size, paint);
        self.picture.add(self.before(at), shapes);
    }

    /// A ball, its radius in half lengths of a hinge.
    fn ball(&mut self, at: Vec3, radius: f64) {
        let shapes = ball(&self.picture.view, at, radius * self.drawing.unit);
        self.picture.add(self.before(at), shapes);
    }

    fn segment(&self, ends: [Vec3; 2], pen: Pen) -> Shape {
        Shape::line(ends.map(|end| self.picture.view.place(end)).to_vec(), pen)
    }

    /// The axes of a joint on one of its bodies, in those of the ground.
    fn axes(&self, joint: &Joint, k: usize) -> Axes {
        let (body, side) = (joint.side_body(k), &joint.sides[k]);
        Axes::new(self.turned(body, side.axis), self.turned(body, side.normal))
    }

    /// The axis of a hinge beyond its ends.
    fn center_line(&mut self, at: Vec3, axis: Vec3) {
        let ends = [-2.1, 2.1].map(|s| at + axis.scaled(s * self.drawing.unit));
        let line = self.segment(ends, Pen::new(Paint::Ink, 1.3).dashed());
        self.picture.add(self.picture.view.nearness(at), vec![line]);
    }

    /// A block on its guide: a hatched line of the ground, or a rod of the other body.
    fn slide(&mut self, j: usize) {
        let joint = &self.drawing.scene.mechanism.joints[j];
        let (unit, view) = (self.drawing.unit, self.picture.view);
        let on = self.drawing.guide_side(joint);
        let block_body = joint.bodies[1 - on];
        let (at, axes) = (self.anchor(j, 1 - on), self.axes(joint, on));
        let size = BLOCK.map(|s| s * unit);
        let (color, name) = (self.drawing.color(block_body), self.name(block_body));
        let block = block(&view, at, &axes, size, color, name);
        self.picture.add(self.before(at), block);
        if !self.drawing.is_ground(joint.bodies[on]) {
            return self.guide(j);
        }
        if view.length(axes.axis) < 0.4 {
            return self.hatching(at, None, -view.up());
        }
        let [from, to] = self.guide_ends(j).map(|end| view.place(end));
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let mut normal = [(to[1] - from[1]) / length, (from[0] - to[0]) / length];
        if normal[1] > 0.0 {
            normal = normal.map(|n| -n);
        }
        let middle = [0, 1].map(|k| 0.5 * (from[k] + to[k]) + 1.1 * BLOCK[0] * unit * normal[k]);
        self.ground_line(middle, normal, 0.5 * length, view.nearness(at));
    }

    /// The ends of the guide of a sliding joint.
    fn guide_ends(&self, j: usize) -> [Vec3; 2] {
        let joint = &self.drawing.scene.mechanism.joints[j];
        let (on, unit) = (self.drawing.guide_side(joint), self.drawing.unit);
        let (start, axis) = (self.anchor(j, on), self.axes(joint, on).axis);
        let [low, high] = self.drawing.travels[j];
        let [low, high] = if on == 0 { [low, high] } else { [-high, -low] };
        [low - GUIDE_MARGIN * unit, high + GUIDE_MARGIN * unit].map(|s| start + axis.scaled(s))
    }

    /// The straight rod of one body on which the other one slides.
    fn guide(&mut self, j: usize) {
        let joint = &self.drawing.scene.mechanism.joints[j];
        let on = self.drawing.guide_side(joint);
        let (body, axis) = (joint.bodies[on], self.axes(joint, on).axis);
        let ends = self.guide_ends(j);
        self.bar(ends, (self.drawing.color(body), ROD), None);
        if self.drawing.is_ground(body) {
            for (end, sign) in ends.into_iter().zip([-1.0, 1.0]) {
                self.wall(end, axis.scaled(sign));
            }
        }
    }

    /// A sleeve on the ground, through which a rod of the other body goes.
    fn grounded_sleeve(&mut self, j: usize) {
        let joint = &self.drawing.scene.mechanism.joints[j];
        let (unit, on) = (self.drawing.unit, self.drawing.guide_side(joint));
        let (at, rod) = (self.anchor(j, on), self.anchor(j, 1 - on));
        let axes = self.axes(joint, on);
        let sleeve = [HINGE_RADIUS * unit, SLEEVE * unit];
        self.cylinder(at, &axes, sleeve, (Paint::Grey, None));
        self.ground_mark(joint, at, Some(axes.axis));
        let apart = axes.axis.dot(rod - at);
        let margin = GUIDE_MARGIN * unit;
        let ends = [apart.min(0.0) - margin, apart.max(0.0) + margin];
        let body = joint.bodies[1 - on];
        let ends = ends.map(|s| at + axes.axis.scaled(s));
        self.bar(ends, (self.drawing.color(body), ROD), None);
    }

    /// A hatched wall across the end of a guide; from its end below it.
    fn wall(&mut self, at: Vec3, out: Vec3) {
        let (view, unit) = (self.picture.view, self.drawing.unit);
        if view.length(out) < 0.4 {
            return self.hatching(at, None, -view.up());
        }
        let [x, y] = view.place(at);
        let [u, v] = view.place(out);
        let length = u.hypot(v);
        let [n, m] = [u / length, v / length];
        self.ground_line([x, y], [n, m], 0.8 * unit, view.nearness(at));
    }

    /// The hatching of a joint on the ground, along a direction, on the side away from the moving body.
    fn ground_mark(&mut self, joint: &Joint, at: Vec3, along: Option<Vec3>) {
        let Some(k) = (0..2).find(|k| self.drawing.is_ground(joint.bodies[*k])) else {
            return;
        };
        let away = at - self.middle(joint.bodies[1 - k]);
        self.hatching(at, along, away);
    }

    fn hatching(&mut self, at: Vec3, along: Option<Vec3>, away: Vec3) {
        let (view, unit) = (self.picture.view, self.drawing.unit);
        let along = along.filter(|u| view.length(*u) > 0.4);
        let [u, v] = along.map_or([1.0, 0.0], |u| view.place(u));
        let length = u.hypot(v);
        let mut normal = [v / length, -u / length];
        let [ax, ay] = view.place(away);
        let side = normal[0] * ax + normal[1] * ay;
        // Below, where the body is on neither side.
        let is_level = side.abs() < 0.2 * ax.hypot(ay).max(unit);
        if (is_level && normal[1] > 0.0) || (!is_level && side < 0.0) {
            normal = normal.map(|n| -n);
        }
        let [x, y] = view.place(at);
        let offset = HINGE_RADIUS * unit;
        let base = [x + offset * normal[0], y + offset * normal[1]];
        self.ground_line(base, normal, 1.1 * unit, view.nearness(at));
    }

    /// A line hatched on the side of the normal.
    fn ground_line(&mut self, [x, y]: [f64; 2], [n, m]: [f64; 2], half: f64, near: f64) {
        let [from, to] = [-half, half].map(|s| [x - s * m, y + s * n]);
        self.picture.add(near, vec![Shape::GroundLine { from, to }]);
    }

    /// A Hooke joint: the cross, and the fork of each body.
    fn universal(&mut self, j: usize, at: Vec3) {
        let joint = &self.drawing.scene.mechanism.joints[j];
        let arm = ARM * self.drawing.unit;
        for k in 0..2 {
            let (body, axis) = (joint.bodies[k], self.axes(joint, k).axis);
            let stem = self.turned(body, self.drawing.stem(j, k));
            let color = self.drawing.color(body);
            self.fork([at, axis.scaled(arm), stem.scaled(arm)], color);
            let ends = [-1.0, 1.0].map(|s| at + axis.scaled(s * arm));
            for half in ends {
                self.line_before(at, half, Pen::new(Paint::Ink, 4.0));
                self.ball(half, 0.24);
            }
            if self.drawing.is_ground(body) {
                self.hatching(at + stem.scaled(arm), None, stem);
            }
        }
        self.ball(at, 0.3);
    }

    /// A line between two points, as near as its middle.
    fn line_before(&mut self, from: Vec3, to: Vec3, pen: Pen) {
        let line = self.segment([from, to], pen);
        let near = self.before((from + to).scaled(0.5));
        self.picture.add(near, vec![line]);
    }

    /// Half a ring from one end of the axis to the other.
    fn fork(&mut self, [at, axis, stem]: [Vec3; 3], color: Paint) {
        const STEPS: usize = 16;
        let point = |k: usize| {
            let (sin, cos) = (PI * k as f64 / STEPS as f64).sin_cos();
            at + axis.scaled(cos) + stem.scaled(sin)
        };
        for k in 0..STEPS {
            self.line_before(point(k), point(k + 1), Pen::new(color, 4.5));
        }
    }

    /// The arrow of an actuator: about the axis of its joint, or along it.
    pub(super) fn driven(&mut self, kind: ActuatorKind) {
        let JointId(j) = kind.joint();
        let joint = &self.drawing.scene.mechanism.joints[j];
        let (unit, view) = (self.drawing.unit, self.picture.view);
        let (at, axes) = (self.anchor(j, 1), self.axes(joint, 0));
        let pen = Pen::new(Paint::Ink, 2.5);
        let near = view.nearness(at) + 2.0 * BEFORE * unit;
        let arrow = |[from, to]: [[f64; 2]; 2]| Shape::Arrow {
            from,
            to,
            pen,
            name: None,
        };
        let shapes = match kind {
            ActuatorKind::Angle(_) => {
                const STEPS: usize = 24;
                let middle = at + axes.axis.scaled(1.7 * unit);
                let point = |k: usize| {
                    let (sin, cos) = (0.75 * TAU * k as f64 / STEPS as f64).sin_cos();
                    let rim = axes.normal.scaled(cos) + axes.across.scaled(sin);
                    view.place(middle + rim.scaled(1.15 * unit))
                };
                let arc: Vec<[f64; 2]> = (0..STEPS).map(point).collect();
                let head = arrow([STEPS - 3, STEPS + 1].map(point));
                vec![Shape::line(arc, pen), head]
            }
            // Beside the rod, from one of its ends towards the other.
            ActuatorKind::Length(_) => {
                let ends = [self.anchor(j, 0), at].map(|end| view.place(end));
                let [dx, dy] = [0, 1].map(|k| ends[1][k] - ends[0][k]);
                let long = dx.hypot(dy).max(f64::MIN_POSITIVE);
                let aside = [-dy, dx].map(|d| 1.2 * unit * d / long);
                let point =
                    |s: f64| [0, 1].map(|k| ends[0][k] + s * (ends[1][k] - ends[0][k]) + aside[k]);
                vec![arrow([0.3, 0.7].map(point))]
            }
            ActuatorKind::Travel(_) => {
                let offset = axes.normal.scaled(1.5 * unit);
                let point = |s: f64| view.place(at + offset + axes.axis.scaled(s * unit));
                vec![arrow([-1.6, 1.6].map(point))]
            }
        };
        self.picture.add(near, shapes);
    }
}
