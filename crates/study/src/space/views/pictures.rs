//! Pictures of a mechanism in space: from above, from the front and from the right, one axonometric view, and its animation.
//!
//! The views are in third-angle projection: the top view is above the front view, and the right side view to its right, all
//! to one scale.

use super::arrangement::{SYMBOL, SpaceDrawing};
use super::direction::View;
use super::direction::best_view;
use super::drawing::Detail;
use super::paths::paths;
use super::points::points_of;
use crate::output::figure;
use crate::ranges::extent;
use crate::symbols::link_of;
use crate::trajectory::figures::animated;
use dwell_geometry::space::{JointKind, Placement, Vec3};
use dwell_page::Part;
use dwell_report::{Animation, Axis, Drawing, Figure, Paint, Panel, Pen, Shape, TextPlacement};
use dwell_scene::SpaceScene;
use std::collections::BTreeMap;

/// The largest height of a panel, in its widths.
const HEIGHT: f64 = 0.9;
/// Where all joints are in one point: the width of the picture in the size of its symbols, and half the length of a hinge in the distance
/// of a centre of mass.
const ABOUT: f64 = 0.42;
const SYMBOL_OF_REACH: f64 = 0.2;
/// Length of the ground's axes in widths of the picture.
const AXES: f64 = 0.1;

const CAPTION: &str = "Top view (x–y) above the front view (x–z), next to it the side view from the right (y–z), and an axonometric view, all \
                       to one scale. Cylinders are hinges, long ones sleeves on rods, blocks slides, balls spherical joints, forks with a cross universal joints; \
                       hatching is the ground, an arrow the driven joint, a quartered disc a centre of mass. Light lines are paths of points.";
/// The note for scenes with springs or dampers.
const SPRINGS: &str = " Zigzag lines are springs, dashed ones dampers.";

/// Explanations of the symbols of rare kinds of joints, for those in the scene.
fn rare_joints(scene: &SpaceScene) -> String {
    let symbols = scene.mechanism.joints.iter().filter_map(|joint| {
        Some(match joint.kind {
            JointKind::Helical { .. } => (0, "Threaded cylinders are screws."),
            JointKind::Planar => (1, "A disc on a plate is a planar joint."),
            JointKind::Gear { .. } => (
                2,
                "A dot with a short line is where teeth meet, with their normal.",
            ),
            JointKind::PointOnLine => (5, "A ball on a rod is a point on a line."),
            JointKind::PointInPlane => (6, "A ball on a plate is a point in a plane."),
            JointKind::Distance { .. } => (3, "Grey lines are links without mass."),
            JointKind::Weld => (4, "A dot between two bodies is a weld."),
            _ => return None,
        })
    });
    let symbols: BTreeMap<usize, &str> = symbols.collect();
    let texts = symbols.into_values().map(|text| format!(" {text}"));
    texts.collect()
}

/// A mechanism in positions that follow each other.
pub(crate) struct SpacePositions<'a> {
    /// The scene.
    pub(crate) scene: &'a SpaceScene,
    /// The placements of all bodies in the position that is drawn.
    pub(crate) drawn: Vec<Placement>,
    /// A description of this position, such as `q = 12°`.
    pub(crate) drawn_at: String,
    /// The placements in all positions, through which paths are drawn, each with its description.
    pub(crate) all: Vec<(Vec<Placement>, String)>,
    /// The method that computed the positions.
    pub(crate) provenance: String,
}

/// The common data of all views.
struct Views<'a> {
    positions: &'a SpacePositions<'a>,
    drawing: SpaceDrawing<'a>,
    parts: Vec<Part>,
    axonometric: View,
    /// The bounds of the points in the axonometric view, for all of its pictures.
    axonometric_bounds: [[f64; 2]; 2],
    /// Everything that must be in view.
    points: Vec<Vec3>,
    /// Width of the part of space that each view shows, m.
    width: f64,
}

impl SpacePositions<'_> {
    /// The mechanism in three views and an axonometric one.
    pub(crate) fn figure(&self) -> Figure {
        let views = Views::new(self);
        let axonometric = views.axonometric_panel(&self.drawn, true);
        let panels = [
            views.panel(View::TOP, "Top view", ["x", "y"]),
            Panel::from(axonometric),
            views.panel(View::FRONT, "Front view", ["x", "z"]),
            views.panel(View::SIDE, "Side view, from the right", ["y", "z"]),
        ];
        let mut loads = self.scene.loads.iter();
        let springs = if loads.any(|load| link_of(&load.kind).is_some()) {
            SPRINGS
        } else {
            ""
        };
        let rare = rare_joints(self.scene);
        let text = format!("Drawn at {}. {CAPTION}{rare}{springs}", self.drawn_at);
        let (scene, title) = (self.scene, &self.scene.title);
        let figure = figure(
            &scene.file,
            "mechanism",
            title,
            &text,
            panels.into(),
            &self.provenance,
        );
        Figure {
            columns: 2,
            ..figure
        }
    }

    /// The axonometric view alone.
    pub(crate) fn axonometric(&self) -> Drawing {
        Drawing {
            title: String::new(),
            ..Views::new(self).axonometric_panel(&self.drawn, true)
        }
    }

    /// The axonometric view in motion.
    pub(crate) fn animation(&self) -> Animation {
        let views = Views::new(self);
        let frame = |k: usize| {
            let (placements, at) = &self.all[k];
            Drawing {
                title: at.clone(),
                ..views.axonometric_panel(placements, false)
            }
        };
        let is_closed = self.is_closed();
        animated(self.all.len(), is_closed, frame, &self.provenance)
    }

    /// Whether the last position equals the first.
    fn is_closed(&self) -> bool {
        let [(first, _), .., (last, _)] = &self.all[..] else {
            return false;
        };
        let size = first.iter().map(|p| p.position.norm()).fold(0.0, f64::max);
        let same = |(a, b): (&Placement, &Placement)| {
            let turned = (0..3).map(|k| (a.rotation.columns[k] - b.rotation.columns[k]).norm());
            (a.position - b.position).norm() <= 1e-6 * size && turned.fold(0.0, f64::max) <= 1e-6
        };
        first.iter().zip(last).all(same)
    }
}

impl<'a> Views<'a> {
    fn new(positions: &'a SpacePositions<'a>) -> Self {
        let (scene, all) = (positions.scene, &positions.all);
        let mut points: Vec<Vec3> = all.iter().flat_map(|(p, _)| points_of(scene, p)).collect();
        points.extend(points_of(scene, &positions.drawn));
        let axonometric = best_view(&points_of(scene, &positions.drawn));
        let axonometric_bounds = bounds(axonometric, &points);
        let views = [View::TOP, View::FRONT, View::SIDE].map(|view| bounds(view, &points));
        let mut width = 0.0_f64;
        for [[x0, x1], [y0, y1]] in views.into_iter().chain([axonometric_bounds]) {
            width = width.max(x1 - x0).max((y1 - y0) / HEIGHT);
        }
        let size = if width > 0.0 {
            width
        } else {
            size_about_a_point(positions)
        };
        let drawing = SpaceDrawing::new(scene, all, size);
        Self {
            parts: drawing.parts(),
            drawing,
            positions,
            axonometric,
            axonometric_bounds,
            points,
            width: if width > 0.0 { width } else { ABOUT * size },
        }
    }

    /// One of the three views.
    fn panel(&self, view: View, title: &str, [x, y]: [&str; 2]) -> Panel {
        // The axonometric view has the legend.
        let detail = Detail {
            named: false,
            with_words: true,
        };
        let shapes = self.shapes(view, &self.positions.drawn, detail);
        let [horizontal, vertical] = self.ranges(bounds(view, &self.points));
        Panel::from(Drawing {
            title: title.to_owned(),
            x: Axis::new(x, "m").with_range(horizontal[0], horizontal[1]),
            y: Axis::new(y, "m").with_range(vertical[0], vertical[1]),
            shapes,
            ..Drawing::default()
        })
    }

    /// The axonometric view, with the bodies in the legend and the axes of the ground in a corner.
    fn axonometric_panel(&self, placements: &[Placement], with_words: bool) -> Drawing {
        let view = self.axonometric;
        let [[x0, x1], [y0, y1]] = self.ranges(self.axonometric_bounds);
        // Left of and below everything, centres of mass included, which may be beside the bodies.
        let centers = self.positions.scene.masses.iter().zip(placements);
        let centers = centers.filter(|(mass, _)| mass.mass > 0.0);
        let centers = centers.map(|(mass, at)| at.position + at.rotation.apply(mass.center));
        let [[left, _], [below, _]] = bounds(view, &centers.collect::<Vec<_>>());
        let (x0, y0) = (x0.min(left), y0.min(below) - 1.2 * AXES * self.width);
        let mut shapes = self.legend();
        // Before the mechanism, so that its words make room for those of the axes.
        let corner = [x0 + AXES * self.width, y0];
        for (name, axis) in ["x", "y", "z"].into_iter().zip(Vec3::AXES) {
            let [u, v] = view.place(axis.scaled(AXES * self.width));
            let to = [corner[0] + u, corner[1] + v];
            shapes.push(Shape::Arrow {
                from: corner,
                to,
                pen: Pen::new(Paint::Ink, 2.0),
                name: None,
            });
            let placement = match (u.abs() > 2.0 * v.abs(), u > 0.0) {
                (true, true) => TextPlacement::Right,
                (true, false) => TextPlacement::Left,
                (false, _) => TextPlacement::Above,
            };
            if with_words {
                shapes.push(Shape::text(to, name, placement));
            }
        }
        let detail = Detail {
            named: true,
            with_words,
        };
        shapes.extend(self.shapes(view, placements, detail));
        Drawing {
            title: "Axonometric view".to_owned(),
            x: Axis::default().with_range(x0, x1),
            y: Axis::default().with_range(y0, y1),
            shapes,
            without_axes: true,
        }
    }

    /// The bodies in the order of the scene, for the legend: they are drawn in another.
    fn legend(&self) -> Vec<Shape> {
        let scene = self.positions.scene;
        let bodies = scene.mechanism.bodies.iter().enumerate();
        let moving = bodies.filter(|(b, _)| *b != scene.mechanism.ground);
        let entry = |(b, body): (usize, &dwell_geometry::Body)| {
            let pen = Pen::new(self.drawing.color(b), 6.0);
            Shape::line(Vec::new(), pen).named(&body.name)
        };
        moving.map(entry).collect()
    }

    fn shapes(&self, view: View, placements: &[Placement], detail: Detail) -> Vec<Shape> {
        let mut shapes = paths(&self.positions.all, &self.drawing, view);
        shapes.extend(
            self.drawing
                .drawn_from(&self.parts, view, placements, detail),
        );
        shapes
    }

    /// The shown ranges of a view with these bounds of the points, as wide as those of the others.
    fn ranges(&self, [[x0, x1], [y0, y1]]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let about = |a: f64, b: f64, width: f64| {
            let middle = 0.5 * (a + b);
            [middle - 0.5 * width, middle + 0.5 * width]
        };
        let is_point = x1 - x0 < 1e-6 * self.width && y1 - y0 < 1e-6 * self.width;
        let vertical = if is_point {
            about(y0, y1, HEIGHT * self.width)
        } else {
            [y0, y1]
        };
        [about(x0, x1, self.width), vertical]
    }
}

/// The size to which symbols are drawn where all joints and points are in one: so that centres of mass are among them, m.
fn size_about_a_point(positions: &SpacePositions<'_>) -> f64 {
    let scene = positions.scene;
    let bodies = scene.masses.iter().zip(&positions.drawn);
    let reach = bodies
        .filter(|(mass, _)| mass.mass > 0.0)
        .map(|(mass, at)| {
            let center = at.position + at.rotation.apply(mass.center);
            let points = points_of(scene, &positions.drawn).into_iter();
            points.map(|p| (center - p).norm()).fold(0.0, f64::max)
        });
    match reach.fold(0.0, f64::max) {
        0.0 => 1.0,
        reach => SYMBOL_OF_REACH * reach / SYMBOL,
    }
}

/// The extent of some points in a view.
fn bounds(view: View, points: &[Vec3]) -> [[f64; 2]; 2] {
    [0, 1].map(|k| extent(points.iter().map(|p| view.place(*p)[k])))
}
