//! The paths of the points of a mechanism in space.

use super::arrangement::SpaceDrawing;
use super::direction::View;
use super::points::{local_points, placed};
use dwell_geometry::space::{Placement, Vec3};
use dwell_report::{Pen, Shape};

/// Lightness and width (pixels) of a path.
const LIGHTNESS: f64 = 0.6;
const WIDTH: f64 = 2.0;

/// The paths of the requested points, or else of all that move, each once, in the colours of their bodies.
pub(super) fn paths(
    all: &[(Vec<Placement>, String)],
    drawing: &SpaceDrawing<'_>,
    view: View,
) -> Vec<Shape> {
    let mut known: Vec<Vec<Vec3>> = Vec::new();
    let mut shapes = Vec::new();
    let same = drawing.same;
    let listed = &drawing.scene.requests.paths;
    let requested = listed.iter().map(|path| (path.body, path.at));
    let points = if listed.is_empty() {
        local_points(drawing.scene)
    } else {
        requested.collect()
    };
    for point in points {
        let path: Vec<Vec3> = all
            .iter()
            .map(|(p, _)| placed(p, point.0, point.1))
            .collect();
        let Some(first) = path.first().copied() else {
            continue;
        };
        let stays = path.iter().all(|p| (*p - first).norm() < same);
        let is_known = known.iter().any(|other| {
            let mut both = other.iter().zip(&path);
            both.all(|(a, b)| (*a - *b).norm() < same)
        });
        if stays || is_known || drawing.is_ground(point.0) {
            continue;
        }
        let pen = Pen::new(drawing.color(point.0.0), WIDTH).lightness(LIGHTNESS);
        let line = path.iter().map(|p| view.place(*p)).collect();
        shapes.push(Shape::line(line, pen));
        known.push(path);
    }
    shapes
}
