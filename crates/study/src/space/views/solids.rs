//! Projections of small solids: cylinders, boxes, balls, and the line of a thread.

use super::direction::View;
use dwell_geometry::space::Vec3;
use dwell_report::{Paint, Pen, Shape};
use std::f64::consts::TAU;

/// Corners of a circle.
const CORNERS: usize = 32;
/// Width of the edges of symbols, pixels.
const EDGE: f64 = 1.4;
/// Shades of surfaces seen from the side, and of surfaces that face the viewer.
const SIDE: f64 = 0.72;
const FACE: f64 = 0.9;

/// The frame of a symbol: two directions at right angles to its axis, and the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Axes {
    pub(super) normal: Vec3,
    pub(super) across: Vec3,
    pub(super) axis: Vec3,
}

impl Axes {
    /// By an axis and a direction at right angles to it, unit vectors.
    pub(super) fn new(axis: Vec3, normal: Vec3) -> Self {
        Self {
            normal,
            across: axis.cross(normal),
            axis,
        }
    }

    /// A point of the cylinder of this radius.
    fn rim(&self, angle: f64, radius: f64) -> Vec3 {
        let (sin, cos) = angle.sin_cos();
        self.normal.scaled(radius * cos) + self.across.scaled(radius * sin)
    }
}

/// A shape with a name, if there is one.
pub(super) fn named(shape: Shape, name: Option<&str>) -> Shape {
    match name {
        Some(name) => shape.named(name),
        None => shape,
    }
}

/// An opaque face with its edge; the name goes with the face.
pub(super) fn face(
    points: Vec<[f64; 2]>,
    color: Paint,
    lightness: f64,
    edge: Paint,
    name: Option<&str>,
) -> [Shape; 2] {
    let inside = Pen::new(color, 1.0).lightness(lightness);
    let area = named(Shape::area(points.clone(), inside, 1.0), name);
    let line = Shape::Polyline {
        points,
        pen: Pen::new(edge, EDGE),
        closed: true,
        fill: None,
        name: None,
    };
    [area, line]
}

fn rim(view: &View, at: Vec3, axes: &Axes, radius: f64) -> Vec<[f64; 2]> {
    let corner = |k: usize| {
        let angle = TAU * k as f64 / CORNERS as f64;
        view.place(at + axes.rim(angle, radius))
    };
    (0..CORNERS).map(corner).collect()
}

/// A cylinder about the axis, with a pin in the visible end.
pub(super) fn cylinder(
    view: &View,
    at: Vec3,
    axes: &Axes,
    [radius, half]: [f64; 2],
    color: Paint,
    name: Option<&str>,
) -> Vec<Shape> {
    let ends = [-half, half].map(|s| at + axes.axis.scaled(s));
    let outline = ends.iter().flat_map(|end| rim(view, *end, axes, radius));
    let mut shapes = face(hull(outline.collect()), color, SIDE, Paint::Ink, name).to_vec();
    let nearest = ends[usize::from(view.nearness(ends[1]) > view.nearness(ends[0]))];
    // Seen exactly from the side it has no end.
    if view.length(axes.axis) < 0.999 {
        shapes.extend(face(
            rim(view, nearest, axes, radius),
            color,
            FACE,
            Paint::Ink,
            name,
        ));
        let pin = rim(view, nearest, axes, 0.35 * radius);
        shapes.push(Shape::area(pin, Pen::new(Paint::Ink, 1.0), 1.0));
    }
    shapes
}

/// The visible part of a thread on a cylinder.
pub(super) fn thread(
    view: &View,
    at: Vec3,
    axes: &Axes,
    [radius, half]: [f64; 2],
    is_right_handed: bool,
) -> Shape {
    const TURNS: f64 = 3.0;
    const STEPS: usize = 120;
    let sign = if is_right_handed { 1.0 } else { -1.0 };
    let point = |k: usize| {
        let part = k as f64 / STEPS as f64;
        let rim = axes.rim(sign * TAU * TURNS * part, radius);
        let is_seen = view.nearness(rim) > 0.0;
        let p = at + rim + axes.axis.scaled(half * (2.0 * part - 1.0));
        if is_seen {
            view.place(p)
        } else {
            [f64::NAN; 2]
        }
    };
    Shape::line((0..=STEPS).map(point).collect(), Pen::new(Paint::Ink, EDGE))
}

/// A box about the axes.
pub(super) fn block(
    view: &View,
    at: Vec3,
    axes: &Axes,
    [half, length]: [f64; 2],
    color: Paint,
    name: Option<&str>,
) -> Vec<Shape> {
    let sides = [
        axes.normal.scaled(half),
        axes.across.scaled(half),
        axes.axis.scaled(length),
    ];
    let mut shapes = Vec::new();
    for k in 0..3 {
        for sign in [-1.0, 1.0] {
            let out = sides[k].scaled(sign);
            let facing = view.nearness(out) / out.norm();
            if facing < 1e-3 {
                continue;
            }
            let [b, c] = [sides[(k + 1) % 3], sides[(k + 2) % 3]];
            let corner = |[s, t]: [f64; 2]| view.place(at + out + b.scaled(s) + c.scaled(t));
            let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
            let lightness = 0.45 + 0.3 * facing;
            shapes.extend(face(
                square.map(corner).to_vec(),
                color,
                lightness,
                Paint::Ink,
                name,
            ));
        }
    }
    shapes
}

/// A ball with its light.
pub(super) fn ball(view: &View, at: Vec3, radius: f64) -> Vec<Shape> {
    let [x, y] = view.place(at);
    let round =
        |offset: f64, radius: f64| arc([x - offset, y + offset], radius, [0.0, 1.0], CORNERS);
    let mut shapes = face(round(0.0, radius), Paint::Grey, 0.45, Paint::Ink, None).to_vec();
    let light = [(0.12, 0.72, 0.62), (0.22, 0.48, 0.8), (0.3, 0.22, 0.97)];
    shapes.extend(light.map(|(offset, size, lightness)| {
        let pen = Pen::new(Paint::Grey, 1.0).lightness(lightness);
        Shape::area(round(offset * radius, size * radius), pen, 1.0)
    }));
    shapes
}

/// A circle in the picture, closed.
pub(super) fn circle(center: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    arc(center, radius, [0.0, 1.0], CORNERS + 1)
}

/// The first corners of a part of a circle that begins at an angle, rad.
fn arc([x, y]: [f64; 2], radius: f64, [from, part]: [f64; 2], corners: usize) -> Vec<[f64; 2]> {
    let corner = |k: usize| {
        let (sin, cos) = (from + part * TAU * k as f64 / CORNERS as f64).sin_cos();
        [x + radius * cos, y + radius * sin]
    };
    (0..corners).map(corner).collect()
}

/// The mark of a centre of mass: a disc of four quarters.
pub(super) fn center_of_mass(at: [f64; 2], radius: f64) -> Vec<Shape> {
    let outline = circle(at, radius);
    let mut shapes = face(outline, Paint::Ink, 1.0, Paint::Ink, None).to_vec();
    shapes.extend([0.0, 0.5].map(|start| {
        let mut quarter = arc(at, radius, [TAU * start, 0.25], CORNERS + 1);
        quarter.push(at);
        Shape::area(quarter, Pen::new(Paint::Ink, 0.5), 1.0)
    }));
    shapes
}

/// The corners of the convex polygon about some points, anticlockwise.
pub(super) fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let turn =
        |[a, b, c]: [[f64; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && turn([a, b, p]) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut all = half(&mut points.iter().copied());
    all.extend(half(&mut points.iter().rev().copied()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_of_a_square_with_points_inside_is_the_square() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let inside = [[0.5, 0.5], [0.2, 0.9], [0.5, 0.0]];
        let found = hull([&square[..], &inside].concat());
        assert_eq!(found, square);
    }

    #[test]
    fn a_box_shows_the_faces_that_look_at_the_reader() {
        let axes = Axes::new(Vec3::AXES[2], Vec3::AXES[0]);
        let faces = |view: View| {
            let shapes = block(&view, Vec3::ZERO, &axes, [1.0, 2.0], Paint::Ink, None);
            shapes.len() / 2
        };
        assert_eq!(faces(View::FRONT), 1);
        assert_eq!(faces(View::axonometric(-1.0, 0.4)), 3);
    }
}
