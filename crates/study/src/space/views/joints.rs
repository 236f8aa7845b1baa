//! The symbols of joints in space.

use super::arrangement::ARM;
use super::drawing::{BEFORE, Scenery, driven};
use super::solids::{Axes, ball, block, center_of_mass, circle, cylinder, named, thread};
use dwell_geometry::space::Vec3;
use dwell_page::{Mark, MarkLook};
use dwell_report::{Paint, Pen, Shape};
use std::f64::consts::{PI, TAU};

/// Radii of hinges and balls, half a block's width and length, half the length of a sleeve: in half lengths of a hinge.
const HINGE_RADIUS: f64 = 0.5;
const BALL_RADIUS: f64 = 0.55;
const BLOCK: [f64; 2] = [0.8, 1.3];
const SLEEVE: f64 = 1.3;
const PLATE: [f64; 2] = [2.4, 0.08];

impl Scenery<'_> {
    /// A mark, with the ground's hatching.
    //
    // Long: a few lines for each mark.
    pub(super) fn mark(&mut self, mark: &Mark) {
        let (unit, view) = (self.drawing.unit, self.picture.view);
        let at = self.place(&mark.at);
        let direction = |of: &Self, d: &[f64]| match d {
            [] => Vec3::ZERO,
            d => of.turned(mark.frame, d),
        };
        let axes = Axes::new(direction(self, &mark.axis), direction(self, &mark.normal));
        let (color, name) = (self.drawing.color(mark.body), self.name(mark.body));
        let sleeve = [HINGE_RADIUS * unit, SLEEVE * unit];
        match mark.look {
            MarkLook::Hinge => {
                self.center_line(at, axes.axis);
                self.cylinder(at, &axes, [HINGE_RADIUS * unit, unit], color, name);
            }
            MarkLook::Ball => self.ball(at, BALL_RADIUS),
            MarkLook::RodEnd => self.ball(at, 0.75 * BALL_RADIUS),
            MarkLook::Weld => self.ball(at, 0.4),
            MarkLook::Cross => self.ball(at, 0.3),
            MarkLook::Sleeve => self.cylinder(at, &axes, sleeve, color, None),
            MarkLook::Screw | MarkLook::LeftScrew => {
                self.cylinder(at, &axes, sleeve, color, None);
                let thread = thread(&view, at, &axes, sleeve, mark.look == MarkLook::Screw);
                self.picture.add(self.before(at), vec![thread]);
            }
            MarkLook::Slide => {
                let size = BLOCK.map(|s| s * unit);
                let block = block(&view, at, &axes, size, color, name);
                self.picture.add(self.before(at), block);
                return self.rail(mark, at);
            }
            MarkLook::Fork => return self.fork(mark, at, &axes),
            MarkLook::Plate => {
                let foot = at + axes.axis.scaled(-0.3 * unit);
                let plane = block(&view, foot, &axes, PLATE.map(|s| s * unit), color, None);
                self.picture.add(self.before(at) - unit, plane);
            }
            MarkLook::Disc => self.cylinder(at, &axes, [unit, 0.3 * unit], color, None),
            // The normal of the teeth, through the pitch point.
            MarkLook::Teeth => {
                let ends = [-0.9, 0.9].map(|s| at + axes.axis.scaled(s * unit));
                let normal = self.segment(ends, Pen::new(Paint::Ink, 2.5));
                self.picture.add(self.before(at), vec![normal]);
                self.ball(at, 0.3);
            }
            MarkLook::Turned | MarkLook::Pushed => {
                let arrow = self.arrow(mark.look, at, &axes);
                self.picture
                    .add(view.nearness(at) + 2.0 * BEFORE * unit, arrow);
            }
            // About a body of one point.
            MarkLook::Ring => {
                let outline = circle(view.place(at), 0.9 * unit);
                let ring = named(Shape::line(outline, Pen::new(color, 4.0)), name);
                self.picture.add(view.nearness(at), vec![ring]);
            }
            MarkLook::CenterOfMass => {
                let shapes = center_of_mass(view.place(at), 0.33 * unit);
                self.picture.add(f64::INFINITY, shapes);
            }
            MarkLook::Pin | MarkLook::Support => {}
        }
        let along = match mark.look {
            MarkLook::Hinge | MarkLook::Sleeve => Some(axes.axis),
            MarkLook::Disc => Some(axes.normal),
            _ => None,
        };
        // On the side away from the moving body.
        if let [middle] = &mark.ground[..] {
            self.hatching(at, along, at - self.place(middle));
        }
    }

    /// How near the symbol of a joint at a point is drawn: before the bars that it connects.
    fn before(&self, at: Vec3) -> f64 {
        self.picture.view.nearness(at) + BEFORE * self.drawing.unit
    }

    fn cylinder(
        &mut self,
        at: Vec3,
        axes: &Axes,
        size: [f64; 2],
        color: Paint,
        name: Option<&str>,
    ) {
        let shapes = cylinder(&self.picture.view, at, axes, size, color, name);
        self.picture.add(self.before(at), shapes);
    }

    /// A ball, its radius in half lengths of a hinge.
    fn ball(&mut self, at: Vec3, radius: f64) {
        let shapes = ball(&self.picture.view, at, radius * self.drawing.unit);
        self.picture.add(self.before(at), shapes);
    }

    /// The axis of a hinge beyond its ends.
    fn center_line(&mut self, at: Vec3, axis: Vec3) {
        let ends = [-2.1, 2.1].map(|s| at + axis.scaled(s * self.drawing.unit));
        let line = self.segment(ends, Pen::new(Paint::Ink, 1.3).dashed());
        self.picture.add(self.picture.view.nearness(at), vec![line]);
    }

    /// Draws the ground beside a block that slides on it.
    fn rail(&mut self, mark: &Mark, at: Vec3) {
        let (unit, view) = (self.drawing.unit, self.picture.view);
        let [from, to] = &mark.ground[..] else {
            return;
        };
        if view.length(self.turned(mark.frame, &mark.axis)) < 0.4 {
            return self.hatching(at, None, -view.up());
        }
        let [from, to] = [from, to].map(|end| view.place(self.place(end)));
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let mut normal = [(to[1] - from[1]) / length, (from[0] - to[0]) / length];
        if normal[1] > 0.0 {
            normal = normal.map(|n| -n);
        }
        let middle = [0, 1].map(|k| 0.5 * (from[k] + to[k]) + 1.1 * BLOCK[0] * unit * normal[k]);
        self.ground_line(middle, normal, 0.5 * length, view.nearness(at));
    }

    /// A hatched wall across the end of a guide; from its end below it.
    pub(super) fn wall(&mut self, at: Vec3, out: Vec3) {
        let (view, unit) = (self.picture.view, self.drawing.unit);
        if view.length(out) < 0.4 * out.norm() {
            return self.hatching(at, None, -view.up());
        }
        let [x, y] = view.place(at);
        let [u, v] = view.place(out);
        let length = u.hypot(v);
        let [n, m] = [u / length, v / length];
        self.ground_line([x, y], [n, m], 0.8 * unit, view.nearness(at));
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

    /// Half of a Hooke joint: the arm of the cross, and the fork about it.
    fn fork(&mut self, mark: &Mark, at: Vec3, axes: &Axes) {
        let arm = ARM * self.drawing.unit;
        let stem = axes.normal.scaled(arm);
        self.half_ring(
            [at, axes.axis.scaled(arm), stem],
            self.drawing.color(mark.body),
        );
        for half in [-1.0, 1.0].map(|s| at + axes.axis.scaled(s * arm)) {
            self.line_before(at, half, Pen::new(Paint::Ink, 4.0));
            self.ball(half, 0.24);
        }
        if !mark.ground.is_empty() {
            self.hatching(at + stem, None, axes.normal);
        }
    }

    /// A line between two points, as near as its middle.
    fn line_before(&mut self, from: Vec3, to: Vec3, pen: Pen) {
        let line = self.segment([from, to], pen);
        let near = self.before((from + to).scaled(0.5));
        self.picture.add(near, vec![line]);
    }

    /// Half a ring from one end of the axis to the other.
    fn half_ring(&mut self, [at, axis, stem]: [Vec3; 3], color: Paint) {
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
    fn arrow(&self, look: MarkLook, at: Vec3, axes: &Axes) -> Vec<Shape> {
        const STEPS: usize = 24;
        let (unit, view) = (self.drawing.unit, self.picture.view);
        if look == MarkLook::Pushed {
            let offset = axes.normal.scaled(1.5 * unit);
            let point = |s: f64| view.place(at + offset + axes.axis.scaled(s * unit));
            return vec![driven([-1.6, 1.6].map(point))];
        }
        let middle = at + axes.axis.scaled(1.7 * unit);
        let point = |k: usize| {
            let (sin, cos) = (0.75 * TAU * k as f64 / STEPS as f64).sin_cos();
            let rim = axes.normal.scaled(cos) + axes.across.scaled(sin);
            view.place(middle + rim.scaled(1.15 * unit))
        };
        let arc = (0..STEPS).map(point).collect();
        let head = driven([STEPS - 3, STEPS + 1].map(point));
        vec![Shape::line(arc, Pen::new(Paint::Ink, 2.5)), head]
    }
}
