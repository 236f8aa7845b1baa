//! A mechanism along the states in which it was judged, and what its actuators do there.

use super::foot;
use super::mechanism::{Sweep, linkage, paths};
use crate::states::Judged;
use dwell_geometry::{Drive, JointKind, Vec2, vec2};
use dwell_report::{Axis, Chart, Drawing, Figure, Paint, Panel, Pen, Series, Shape};
use dwell_scene::Scene;
use std::f64::consts::TAU;

/// Positions in which the mechanism is drawn, the first in full.
const DRAWN: usize = 5;
/// Corners of a circle.
const CORNERS: usize = 72;

/// The mechanism in several states, with the paths of its points.
pub(crate) fn drawing(scene: &Scene, judged: &Judged) -> Figure {
    let frames = judged.frames.iter().map(|bodies| {
        let frame = |&[x, y, angle]: &[f64; 3]| (vec2(x, y), Vec2::from_angle(angle));
        bodies.iter().map(frame).collect()
    });
    let sweep = Sweep {
        q: Vec::new(),
        frames: frames.collect(),
    };
    let last = sweep.frames.len().saturating_sub(1);
    let mut shapes = paths(scene, &sweep);
    for k in (0..DRAWN).rev() {
        let position = k * last / DRAWN;
        let lightness = if k == 0 { 0.0 } else { 0.62 + 0.05 * k as f64 };
        rounds(scene, &sweep, position, lightness, &mut shapes);
        linkage(scene, &sweep, position, lightness, &mut shapes);
    }
    Figure {
        name: "a-mechanism".to_owned(),
        title: scene.title.clone(),
        caption: foot(
            scene,
            &format!(
                "Drawn in full at the beginning of {}, lighter further on.",
                judged.motion
            ),
        ),
        columns: 1,
        panels: vec![Panel::from(Drawing {
            title: String::new(),
            x: Axis::new("x", "m"),
            y: Axis::new("y", "m"),
            shapes,
        })],
    }
}

/// What is neither a body nor a pin: wheels, slots, racks, massless links and rams.
fn rounds(scene: &Scene, sweep: &Sweep, position: usize, lightness: f64, shapes: &mut Vec<Shape>) {
    let pen = Pen::new(Paint::Ink, 2.0).lightness(lightness.max(0.35));
    let at = |body: usize, point: Vec2| sweep.point(position, body, point);
    let circle = |body: usize, center: Vec2, radius: f64| {
        let corner = |k: usize| Vec2::from_angle(TAU * k as f64 / CORNERS as f64) * radius;
        let around = (0..=CORNERS).map(|k| at(body, center + corner(k)));
        Shape::line(around.collect(), pen)
    };
    let mut found = Vec::new();
    for joint in &scene.mechanism.joints {
        let [one, two] = joint.bodies.map(|b| b.0);
        let [first, second] = joint.points;
        // Along an axis of the first body, as far as the second's point comes.
        let along = |axis: Vec2| {
            let reach = (0..sweep.frames.len()).map(|k| {
                let (origin, turn) = sweep.frames[k][one];
                let [x, y] = sweep.point(k, two, second);
                axis.dot((vec2(x, y) - origin).turn_back(turn) - first)
            });
            let (low, high) = reach.fold((0.0_f64, 0.0_f64), |(a, b), s| (a.min(s), b.max(s)));
            let ends = [low, high].map(|s| at(one, first + axis * s));
            Shape::line(ends.to_vec(), pen)
        };
        match joint.kind {
            JointKind::Gear { radii, .. } => {
                found.push(circle(one, first, radii[0]));
                found.push(circle(two, second, radii[1]));
            }
            JointKind::Rack { axis, radius } | JointKind::Rolling { axis, radius } => {
                found.push(circle(two, second, radius));
                found.push(along(axis));
            }
            JointKind::Slot { axis } => found.push(along(axis)),
            JointKind::Distance { .. } => {
                found.push(Shape::line(vec![at(one, first), at(two, second)], pen));
            }
            _ => {}
        }
    }
    for actuator in &scene.mechanism.actuators {
        let points = match actuator.drive {
            Drive::Angle => continue,
            Drive::Length(points) => [0, 1].map(|i| (actuator.bodies[i].0, points[i])),
            Drive::Travel(joint) => {
                let joint = &scene.mechanism.joints[joint.0];
                [0, 1].map(|i| (joint.bodies[i].0, joint.points[i]))
            }
        };
        let ends = points.map(|(body, point)| at(body, point));
        found.push(Shape::line(ends.to_vec(), pen.dashed()));
    }
    shapes.extend(found);
}

/// What the actuators do along those states.
pub(crate) fn actions(scene: &Scene, judged: &Judged) -> Figure {
    let drawn = &judged.states[..judged.drawn];
    let panel = |(k, actuator): (usize, &dwell_geometry::Actuator)| {
        let (what, unit) = match actuator.coordinate().is_angle() {
            true => ("couple", "N m"),
            false => ("force", "N"),
        };
        Panel::from(Chart {
            title: format!("Action of {}", actuator.name),
            x: Axis::new("time", "s"),
            y: Axis::new(what, unit),
            series: vec![Series::line(
                "",
                drawn.iter().map(|state| [state.t, state.tau[k]]).collect(),
            )],
            ..Chart::default()
        })
    };
    let actuators = scene.mechanism.actuators.iter().enumerate();
    Figure {
        name: "b-actions".to_owned(),
        title: "What the actuators do".to_owned(),
        caption: foot(scene, &format!("Along {}, under the loads.", judged.motion)),
        columns: 1,
        panels: actuators.map(panel).collect(),
    }
}
