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
        let (unit, view) = (self.drawing.unit, self.picture.view);
        let [one, two] = joint.bodies;
        let ends = [self.anchor(j, 0), self.anchor(j, 1)];
        let at = ends[1];
        let axes = self.axes(joint, 0);
        let near = view.nearness(at) + BEFORE * unit;
        let hinge = [HINGE_RADIUS * unit, unit];
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
                self.picture
                    .add(near, cylinder(&view, at, &axes, hinge, paint));
                self.ground_mark(joint, at, Some(axes.axis));
            }
            JointKind::Spherical => {
                self.picture.add(near, ball(&view, at, BALL_RADIUS * unit));
                self.ground_mark(joint, at, None);
            }
            JointKind::Cylindrical if joint.bodies.iter().any(|b| self.drawing.is_ground(*b)) => {
                self.grounded_sleeve(j);
            }
            JointKind::Cylindrical => {
                self.guide(j);
                let sleeve = [HINGE_RADIUS * unit, SLEEVE * unit];
                self.picture.add(
                    near,
                    cylinder(&view, at, &axes, sleeve, (self.drawing.color(two), None)),
                );
            }
            JointKind::Helical { pitch } => {
                self.guide(j);
                let sleeve = [HINGE_RADIUS * unit, SLEEVE * unit];
                let mut shapes =
                    cylinder(&view, at, &axes, sleeve, (self.drawing.color(two), None));
                shapes.push(thread(&view, at, &axes, sleeve, pitch >= 0.0));
                self.picture.add(near, shapes);
            }
            JointKind::Prismatic => self.slide(j),
            JointKind::Universal => self.universal(j, at),
            JointKind::Planar => {
                let foot = axes.axis.scaled(-0.3 * unit);
                let plane = block(
                    &view,
                    at + foot,
                    &axes,
                    PLATE.map(|s| s * unit),
                    self.drawing.color(one),
                    None,
                );
                self.picture.add(near - unit, plane);
                self.picture.add(
                    near,
                    cylinder(
                        &view,
                        at,
                        &axes,
                        [unit, 0.3 * unit],
                        (self.drawing.color(two), None),
                    ),
                );
                self.ground_mark(joint, at, Some(axes.normal));
            }
            JointKind::Distance { .. } => {
                self.bar(ends, (Paint::Grey, ROD), None);
                for (end, body) in ends.into_iter().zip(joint.bodies) {
                    let near = view.nearness(end) + BEFORE * unit;
                    self.picture
                        .add(near, ball(&view, end, 0.75 * BALL_RADIUS * unit));
                    if self.drawing.is_ground(body) {
                        self.hatching(end, None, -(self.middle(two) - end));
                    }
                }
            }
            JointKind::Weld => {
                self.picture.add(near, ball(&view, at, 0.4 * unit));
                self.ground_mark(joint, at, None);
            }
            // The normal of the teeth, through the pitch point.
            JointKind::Gear { .. } => {
                let ends = [-0.9, 0.9].map(|s| view.place(at + axes.axis.scaled(s * unit)));
                let normal = Shape::line(ends.to_vec(), Pen::new(Paint::Ink, 2.5));
                self.picture.add(near, vec![normal]);
                self.picture.add(near, ball(&view, at, 0.3 * unit));
            }
        }
    }

    /// The axes of a joint on one of its bodies, in those of the ground.
    fn axes(&self, joint: &Joint, k: usize) -> Axes {
        let (body, side) = (joint.side_body(k), &joint.sides[k]);
        Axes::new(self.turned(body, side.axis), self.turned(body, side.normal))
    }

    /// The axis of a hinge beyond its ends.
    fn center_line(&mut self, at: Vec3, axis: Vec3) {
        let view = self.picture.view;
        let ends = [-2.1, 2.1].map(|s| view.place(at + axis.scaled(s * self.drawing.unit)));
        let line = Shape::line(ends.to_vec(), Pen::new(Paint::Ink, 1.3).dashed());
        self.picture.add(view.nearness(at), vec![line]);
    }

    /// A block on its guide: a hatched line of the ground, or a rod of the other body.
    fn slide(&mut self, j: usize) {
        let joint = &self.drawing.scene.mechanism.joints[j];
        let (unit, view) = (self.drawing.unit, self.picture.view);
        let on = self.drawing.guide_side(joint);
        let block_body = joint.bodies[1 - on];
        let (at, axes) = (self.anchor(j, 1 - on), self.axes(joint, on));
        let size = BLOCK.map(|s| s * unit);
        let near = view.nearness(at) + BEFORE * unit;
        let (color, name) = (self.drawing.color(block_body), self.name(block_body));
        self.picture
            .add(near, block(&view, at, &axes, size, color, name));
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
        let (unit, view) = (self.drawing.unit, self.picture.view);
        let on = self.drawing.guide_side(joint);
        let (at, rod, axes) = (
            self.anchor(j, on),
            self.anchor(j, 1 - on),
            self.axes(joint, on),
        );
        let sleeve = [HINGE_RADIUS * unit, SLEEVE * unit];
        let near = view.nearness(at) + BEFORE * unit;
        self.picture.add(
            near,
            cylinder(&view, at, &axes, sleeve, (Paint::Grey, None)),
        );
        self.ground_mark(joint, at, Some(axes.axis));
        let apart = axes.axis.dot(rod - at);
        let ends = [
            apart.min(0.0) - GUIDE_MARGIN * unit,
            apart.max(0.0) + GUIDE_MARGIN * unit,
        ];
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
        let (unit, view) = (self.drawing.unit, self.picture.view);
        let arm = ARM * unit;
        for k in 0..2 {
            let (body, axis) = (joint.bodies[k], self.axes(joint, k).axis);
            let stem = self.turned(body, self.drawing.stem(j, k));
            self.fork(
                [at, axis.scaled(arm), stem.scaled(arm)],
                self.drawing.color(body),
            );
            let ends = [-1.0, 1.0].map(|s| at + axis.scaled(s * arm));
            for half in ends {
                let line = Shape::line(
                    [at, half].map(|p| view.place(p)).to_vec(),
                    Pen::new(Paint::Ink, 4.0),
                );
                let middle = (at + half).scaled(0.5);
                self.picture
                    .add(view.nearness(middle) + BEFORE * unit, vec![line]);
                let near = view.nearness(half) + BEFORE * unit;
                self.picture.add(near, ball(&view, half, 0.24 * unit));
            }
            if self.drawing.is_ground(body) {
                self.hatching(at + stem.scaled(arm), None, stem);
            }
        }
        self.picture.add(
            view.nearness(at) + BEFORE * unit,
            ball(&view, at, 0.3 * unit),
        );
    }

    /// Half a ring from one end of the axis to the other.
    fn fork(&mut self, [at, axis, stem]: [Vec3; 3], color: Paint) {
        const STEPS: usize = 16;
        let view = self.picture.view;
        let point = |k: usize| {
            let (sin, cos) = (PI * k as f64 / STEPS as f64).sin_cos();
            at + axis.scaled(cos) + stem.scaled(sin)
        };
        for k in 0..STEPS {
            let [a, b] = [point(k), point(k + 1)];
            let line = Shape::line([a, b].map(|p| view.place(p)).to_vec(), Pen::new(color, 4.5));
            let near = view.nearness((a + b).scaled(0.5)) + BEFORE * self.drawing.unit;
            self.picture.add(near, vec![line]);
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
        match kind {
            ActuatorKind::Angle(_) => {
                const STEPS: usize = 24;
                let middle = at + axes.axis.scaled(1.7 * unit);
                let point = |k: usize| {
                    let (sin, cos) = (0.75 * TAU * k as f64 / STEPS as f64).sin_cos();
                    let rim = axes.normal.scaled(cos) + axes.across.scaled(sin);
                    view.place(middle + rim.scaled(1.15 * unit))
                };
                let arc: Vec<[f64; 2]> = (0..STEPS).map(point).collect();
                let arrow = Shape::Arrow {
                    from: point(STEPS - 3),
                    to: point(STEPS + 1),
                    pen,
                    name: None,
                };
                self.picture.add(near, vec![Shape::line(arc, pen), arrow]);
            }
            // Beside the rod, from one of its ends towards the other.
            ActuatorKind::Length(_) => {
                let ends = [self.anchor(j, 0), at].map(|end| view.place(end));
                let [dx, dy] = [0, 1].map(|k| ends[1][k] - ends[0][k]);
                let long = dx.hypot(dy).max(f64::MIN_POSITIVE);
                let aside = [-dy, dx].map(|d| 1.2 * unit * d / long);
                let point =
                    |s: f64| [0, 1].map(|k| ends[0][k] + s * (ends[1][k] - ends[0][k]) + aside[k]);
                let arrow = Shape::Arrow {
                    from: point(0.3),
                    to: point(0.7),
                    pen,
                    name: None,
                };
                self.picture.add(near, vec![arrow]);
            }
            ActuatorKind::Travel(_) => {
                let offset = axes.normal.scaled(1.5 * unit);
                let [from, to] =
                    [-1.6, 1.6].map(|s| view.place(at + offset + axes.axis.scaled(s * unit)));
                let arrow = Shape::Arrow {
                    from,
                    to,
                    pen,
                    name: None,
                };
                self.picture.add(near, vec![arrow]);
            }
        }
    }
}
