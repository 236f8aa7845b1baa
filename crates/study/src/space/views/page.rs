//! A mechanism in space on a page, where it can be turned: its parts, and its bodies by row.

use super::arrangement::SpaceDrawing;
use super::direction::best_view;
use super::parts::anchor;
use super::points::points_of;
use crate::page::paint;
use crate::ranges::extent;
use dwell_geometry::BodyId;
use dwell_geometry::space::{Placement, Vec3};
use dwell_page::{Drawing, DrawnBody, DrawnPath, ForceArrow};
use dwell_scene::SpaceScene;

/// The mechanism in the rows of a page, by row the placements of all bodies.
pub(crate) fn page_drawing(
    scene: &SpaceScene,
    rows: Vec<Vec<Placement>>,
    arrows: Vec<ForceArrow>,
) -> Drawing {
    let positions: Vec<(Vec<Placement>, String)> =
        rows.into_iter().map(|row| (row, String::new())).collect();
    let first = positions.first().map_or(&[][..], |(first, _)| first);
    let points = points_of(scene, first);
    let view = best_view(&points);
    let all = positions.iter().flat_map(|(p, _)| points_of(scene, p));
    let all: Vec<Vec3> = all.collect();
    let sides = [0, 1, 2].map(|k| extent(all.iter().map(|p| Vec3::AXES[k].dot(*p))));
    let sides = sides.iter().map(|[low, high]| high - low);
    let size = sides.fold(0.0, f64::max);
    let is_extended = size > 0.0 && size.is_finite();
    let size = if is_extended { size } else { 1.0 };
    let drawing = SpaceDrawing::new(scene, &positions, size);
    let toward = view.toward();
    let [x, y, z] = Vec3::AXES.map(|axis| axis.dot(toward));
    let bodies = scene.mechanism.bodies.iter().enumerate();
    Drawing {
        size: drawing.unit,
        view: Some([y.atan2(x), z.clamp(-1.0, 1.0).asin()]),
        bodies: bodies
            .map(|(b, body)| DrawnBody {
                name: body.name.clone(),
                paint: paint(scene.mechanism.ground, b),
                placements: placements(scene, &positions, b),
            })
            .collect(),
        parts: drawing.parts(),
        arrows,
        paths: paths(scene),
    }
}

/// Position and the first two columns of the rotation, by row; empty for the ground.
fn placements(
    scene: &SpaceScene,
    positions: &[(Vec<Placement>, String)],
    body: usize,
) -> Vec<Vec<f64>> {
    if body == scene.mechanism.ground {
        return Vec::new();
    }
    let part = |k: usize| {
        let of = |(row, _): &(Vec<Placement>, String)| {
            let vector = match k / 3 {
                0 => row[body].position,
                column => row[body].rotation.columns[column - 1],
            };
            Vec3::AXES[k % 3].dot(vector)
        };
        positions.iter().map(of).collect()
    };
    (0..9).map(part).collect()
}

/// All named points of moving bodies.
fn paths(scene: &SpaceScene) -> Vec<DrawnPath> {
    let (bodies, listed) = (scene.points.iter().enumerate(), &scene.requests.paths);
    let all = listed.is_empty();
    let moving = bodies.filter(|(b, _)| *b != scene.mechanism.ground);
    let path = |(b, points): (usize, &Vec<(String, Vec3)>)| -> Vec<DrawnPath> {
        let body = &scene.mechanism.bodies[b].name;
        let one = |(name, p): &(String, Vec3)| DrawnPath {
            at: anchor(BodyId(b), *p),
            name: format!("{body}.{name}"),
            requested: all || listed.iter().any(|of| of.body.0 == b && of.at == *p),
        };
        points.iter().map(one).collect()
    };
    moving.flat_map(path).collect()
}
