//! The points of a mechanism in space, and their paths.

use super::drawing::{SAME, SpaceDrawing};
use super::projection::View;
use dwell_geometry::BodyId;
use dwell_geometry::space::{Placement, Vec3};
use dwell_report::{Pen, Shape};
use dwell_scene::SpaceScene;

/// Lightness and width (pixels) of a path.
const LIGHTNESS: f64 = 0.6;
const WIDTH: f64 = 2.0;

/// The points of all bodies in their frames: of the joints, and the named ones.
fn local_points(scene: &SpaceScene) -> Vec<(BodyId, Vec3)> {
    let joints = scene.mechanism.joints.iter();
    let mut points: Vec<(BodyId, Vec3)> = joints
        .flat_map(|joint| [0, 1].map(|k| (joint.side_body(k), joint.sides[k].point)))
        .collect();
    for (b, named) in scene.points.iter().enumerate() {
        points.extend(named.iter().map(|(_, p)| (BodyId(b), *p)));
    }
    points
}

fn placed(placements: &[Placement], (body, point): (BodyId, Vec3)) -> Vec3 {
    let placement = &placements[body.0];
    placement.position + placement.rotation.apply(point)
}

/// All points in a position, in the axes of the ground.
pub(super) fn points_of(scene: &SpaceScene, placements: &[Placement]) -> Vec<Vec3> {
    let points = local_points(scene).into_iter();
    points.map(|point| placed(placements, point)).collect()
}

/// The paths of the points that move, each once, in the colours of their bodies.
pub(super) fn paths(
    all: &[(Vec<Placement>, String)],
    drawing: &SpaceDrawing<'_>,
    view: View,
) -> Vec<Shape> {
    let mut known: Vec<Vec<Vec3>> = Vec::new();
    let mut shapes = Vec::new();
    let same = SAME * drawing.size;
    for point in local_points(drawing.scene) {
        let path: Vec<Vec3> = all.iter().map(|(p, _)| placed(p, point)).collect();
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
        let pen = Pen::new(drawing.color(point.0), WIDTH).lightness(LIGHTNESS);
        let line = path.iter().map(|p| view.place(*p)).collect();
        shapes.push(Shape::line(line, pen));
        known.push(path);
    }
    shapes
}
