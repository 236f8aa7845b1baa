//! Dimensions, masses, moments of inertia and centres of mass, drawn in one position.

use super::mechanism::drawing;
use crate::case_report::dwell::RangePoses;
use dwell_geometry::{BodyId, Vec2};
use dwell_report::{Paint, Panel, Pen, Shape, TextPlacement};
use dwell_scene::PlaneScene;
use dwell_study::number_format::{digits, number};
use dwell_study::output::MechanismDrawing;

/// Most moving bodies whose dimensions fit into a drawing.
const MAX_BODIES: usize = 5;
/// Lightness of the mechanism, so that the numbers stand out.
const LIGHTNESS: f64 = 0.55;
/// Points that are nearer to each other, in sizes of the mechanism, have no distance between them to be written.
const NEAR: f64 = 1e-3;

/// The mechanism with the lengths of its links, the places of its fixed points and its centres of mass; nothing of a
/// mechanism with more bodies than can be labelled.
pub(super) fn dimensions(scene: &PlaneScene, poses: &RangePoses, position: usize) -> Option<Panel> {
    let ground = scene.mechanism.ground;
    let bodies = scene.mechanism.bodies.len();
    if bodies > MAX_BODIES + 1 {
        return None;
    }
    let mut shapes = Vec::new();
    let mechanism = MechanismDrawing::new(scene, &poses.body_poses);
    mechanism.draw(&poses.body_poses[position], LIGHTNESS, &mut shapes);
    let drawn = DrawnDimensions {
        scene,
        poses,
        position,
    };
    for body in (0..bodies).filter(|&body| body != ground) {
        drawn.lengths(body, &mut shapes);
        drawn.center(body, &mut shapes);
    }
    drawn.fixed_points(&mut shapes);
    let (_, unit) = scene.file.to_scene_unit(0.0, false);
    let title = format!("Dimensions ({unit}), masses, inertias about the centres of mass");
    Some(drawing(&title, shapes))
}

struct DrawnDimensions<'a> {
    scene: &'a PlaneScene,
    poses: &'a RangePoses,
    position: usize,
}

impl DrawnDimensions<'_> {
    fn at(&self, body: usize, point: Vec2) -> [f64; 2] {
        self.poses.point(self.position, body, point)
    }

    /// A length in the scene's unit, as the axes have it.
    fn length(&self, length: f64) -> String {
        let (length, _) = self.scene.file.to_scene_unit(length, false);
        digits(length, 4).replace('-', "−")
    }

    /// The distances of a body's points from the one before, beside the middle between them.
    fn lengths(&self, body: usize, shapes: &mut Vec<Shape>) {
        let near = NEAR * self.scene.mechanism.size();
        let points = self.scene.points.get(body).into_iter().flatten();
        let points: Vec<&(String, Vec2)> = points.collect();
        for two in points.windows(2) {
            let [(one, a), (other, b)] = two else {
                continue;
            };
            let length = (*b - *a).norm();
            if length < near {
                continue;
            }
            let text = format!("{one}–{other} {}", self.length(length));
            let middle = (*a + *b) * 0.5;
            shapes.push(Shape::text(
                self.at(body, middle),
                text,
                TextPlacement::AboveLeft,
            ));
        }
    }

    /// The centre of mass, with the mass and the moment of inertia about it.
    fn center(&self, body: usize, shapes: &mut Vec<Shape>) {
        let Some(mass) = self.scene.masses.get(body).filter(|mass| mass.mass > 0.0) else {
            return;
        };
        let at = self.at(body, mass.center);
        let disc = Shape::Disc {
            at,
            radius_px: 5.0,
            pen: Pen::new(Paint::Ink, 2.0),
            filled: true,
            name: None,
        };
        shapes.push(disc.named("centre of mass"));
        let name = self.scene.mechanism.body_name(BodyId(body));
        let (mass, inertia) = (number(mass.mass), digits(mass.inertia, 4));
        let text = format!("{name} {mass} kg, {inertia} kg m²");
        shapes.push(Shape::text(at, text, TextPlacement::BelowRight));
    }

    /// The fixed points with their coordinates.
    fn fixed_points(&self, shapes: &mut Vec<Shape>) {
        let ground = self.scene.mechanism.ground;
        for (name, at) in self.scene.points.get(ground).into_iter().flatten() {
            let [x, y] = [at.x, at.y].map(|v| self.length(v));
            let text = format!("{name} ({x}, {y})");
            shapes.push(Shape::text([at.x, at.y], text, TextPlacement::BelowLeft));
        }
    }
}
