//! The mechanism in the plane on a page: its parts, and its bodies by row.

use super::columns::RowChoice;
use crate::bodies::BodyPose;
use crate::symbols::{DrawnIn, PlaneParts, anchor};
use dwell_geometry::BodyId;
use dwell_page::{Drawing, DrawnBody, DrawnPath, ForceArrow};
use dwell_scene::PlaneScene;

/// Colours of bodies: six of the palette, then ink.
const PAINTS: usize = 7;

/// The mechanism along the rows of a page.
/// `poses` are those of all bodies by row; bodies that are not modelled are omitted.
pub(super) fn plane_drawing(
    scene: &PlaneScene,
    poses: &[Vec<BodyPose>],
    modelled: &[bool],
    choice: &RowChoice,
    arrows: Vec<ForceArrow>,
) -> Drawing {
    let drawn = PlaneParts::new(scene, poses, modelled);
    let parts = drawn.parts.into_iter();
    let parts = parts.filter(|(_, drawn_in)| *drawn_in != DrawnIn::Light);
    let mechanism = &scene.mechanism;
    let body = |(b, body): (usize, &dwell_geometry::Body)| {
        let is_fixed = b == mechanism.ground || !modelled.get(b).copied().unwrap_or(true);
        let part = |k: usize| {
            choice.map(poses, |row: &Vec<BodyPose>| {
                let (origin, rotation) = row[b];
                [origin.x, origin.y, rotation.angle()][k]
            })
        };
        DrawnBody {
            name: body.name.clone(),
            paint: paint(mechanism.ground, b),
            placements: if is_fixed {
                Vec::new()
            } else {
                (0..3).map(part).collect()
            },
        }
    };
    Drawing {
        size: drawn.size,
        view: None,
        bodies: mechanism.bodies.iter().enumerate().map(body).collect(),
        parts: parts.map(|(part, _)| part).collect(),
        arrows,
        paths: paths(scene, modelled),
    }
}

/// The number of a body's colour; none of the ground.
pub(crate) fn paint(ground: usize, body: usize) -> Option<usize> {
    (body != ground).then(|| (body - usize::from(body > ground)) % PAINTS)
}

/// The paths that can be shown: those that are requested, and those of all named points of moving bodies, each once.
fn paths(scene: &PlaneScene, modelled: &[bool]) -> Vec<DrawnPath> {
    let mechanism = &scene.mechanism;
    let requested = &scene.requests.paths;
    let mut paths = Vec::new();
    for (b, points) in scene.points.iter().enumerate() {
        if b == mechanism.ground || !modelled.get(b).copied().unwrap_or(true) {
            continue;
        }
        for (name, at) in points {
            paths.push(DrawnPath {
                at: anchor(BodyId(b), *at),
                name: format!("{}.{name}", mechanism.bodies[b].name),
                requested: requested.iter().any(|p| p.body.0 == b && p.name == *name),
            });
        }
    }
    paths
}
