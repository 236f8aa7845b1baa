//! The mechanism in several positions, the paths of its points, and a body's dwell.

use super::{caption, coordinate_label};
use crate::error::StudyError;
use crate::motion_error::explain_place;
use crate::prepare::Prepared;
use dwell_geometry::{BodyId, JointKind, Plan, Pose, Range, Vec2, vec2};
use dwell_kinetostatics::Reduced;
use dwell_report::{Axis, Chart, Drawing, Figure, Mark, Paint, Panel, Pen, Series, Shape, Side};
use dwell_scene::{PathPoint, Scene};
use std::f64::consts::TAU;

/// Positions of the paths.
const FINE: usize = 720;
/// Positions in which the mechanism is drawn, the first in full.
const DRAWN: usize = 6;

/// Where a body's angle stays within a band of its swing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dwell {
    /// The body.
    pub(crate) body: BodyId,
    /// From and to, rad of the coordinate; it may pass a whole turn.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// How far its angle moves in it, and over the whole range, rad.
    pub(crate) moves: f64,
    pub(crate) swing: f64,
}

/// The bodies over the range.
pub(super) struct Sweep {
    pub(super) q: Vec<f64>,
    /// By position and body: origin and orientation.
    pub(super) frames: Vec<Vec<(Vec2, Vec2)>>,
}

impl Sweep {
    fn new(prepared: &Prepared<'_>) -> Result<Self, StudyError> {
        let plan = prepared.model.model().plan();
        let mechanism = &prepared.scene.mechanism;
        let mut pose: Pose<f64> = plan.pose();
        let q = prepared.sweep(FINE);
        let mut frames = Vec::with_capacity(q.len());
        for &q in &q {
            plan.place(&[q], &mut pose)
                .map_err(|e| explain_place(prepared.scene, plan, &e))?;
            let all = plan.body_frames(mechanism, &pose).into_iter().enumerate();
            frames.push(
                all.map(|(b, [x, y, _])| (vec2(x, y), plan_turn(plan, mechanism.ground, b, &pose)))
                    .collect(),
            );
        }
        Ok(Self { q, frames })
    }

    pub(super) fn point(&self, position: usize, body: usize, at: Vec2) -> [f64; 2] {
        let (origin, turn) = self.frames[position][body];
        let place = origin + at.turn(turn);
        [place.x, place.y]
    }
}

fn plan_turn(plan: &Plan, ground: usize, body: usize, pose: &Pose<f64>) -> Vec2 {
    if body == ground {
        Vec2::IDENTITY
    } else {
        plan.body_turn(BodyId(body), pose)
    }
}

/// The figure, and the dwell that was asked for.
///
/// # Errors
/// [`StudyError::Scene`] where the mechanism cannot be placed.
pub(crate) fn mechanism(prepared: &Prepared<'_>) -> Result<(Figure, Option<Dwell>), StudyError> {
    let sweep = Sweep::new(prepared)?;
    let scene = prepared.scene;
    let full = prepared.model.range() == Range::Full;
    let dwell = scene
        .requests
        .dwell
        .as_ref()
        .map(|d| find_dwell(&sweep, d.body, d.band, full));
    let mut shapes = paths(scene, &sweep);
    shapes.extend(ghosts(prepared, &sweep, full, dwell.as_ref()));
    let mut panels = vec![Panel::from(Drawing {
        title: String::new(),
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        shapes,
    })];
    if let Some(dwell) = &dwell {
        panels.push(swing(prepared, &sweep, dwell));
    }
    let first = prepared.model.model().plan().start()[0].to_degrees();
    let words = match &dwell {
        Some(d) => format!(
            "Drawn in full at {first:.0}°, lighter further on. The marked dwell: {} stays within {:.2}° of its {:.1}° swing for {:.0}° of the actuator.",
            scene.mechanism.body_name(d.body),
            d.moves.to_degrees(),
            d.swing.to_degrees(),
            (d.to - d.from).to_degrees(),
        ),
        None => format!("Drawn in full at {first:.0}°, lighter further on."),
    };
    let figure = Figure {
        name: "a-mechanism".to_owned(),
        title: scene.title.clone(),
        caption: caption(prepared, &words),
        columns: 1,
        panels,
    };
    Ok((figure, dwell))
}

/// The bodies in several positions, the lightest at the back.
fn ghosts(prepared: &Prepared<'_>, sweep: &Sweep, full: bool, dwell: Option<&Dwell>) -> Vec<Shape> {
    let mut shapes = Vec::new();
    let start = prepared.model.model().plan().start()[0];
    let last = sweep.q.len() - 1;
    let nearest = |q: f64| {
        let span = sweep.q[last] - sweep.q[0];
        let part = if full {
            (q - sweep.q[0]).rem_euclid(TAU) / span
        } else {
            ((q - sweep.q[0]) / span).clamp(0.0, 1.0)
        };
        (part * last as f64).round() as usize
    };
    for k in (0..DRAWN).rev() {
        let position = if k == 0 {
            nearest(start)
        } else if full {
            nearest(start + TAU * k as f64 / DRAWN as f64)
        } else {
            k * last / (DRAWN - 1)
        };
        if let (0, Some(dwell)) = (k, dwell) {
            shapes.extend(dwelling(prepared, sweep, dwell));
        }
        let lightness = if k == 0 { 0.0 } else { 0.62 + 0.04 * k as f64 };
        linkage(prepared.scene, sweep, position, lightness, &mut shapes);
    }
    shapes
}

/// All bodies, then all pins, in one position.
pub(super) fn linkage(
    scene: &Scene,
    sweep: &Sweep,
    position: usize,
    lightness: f64,
    shapes: &mut Vec<Shape>,
) {
    let mechanism = &scene.mechanism;
    let moving = (0..mechanism.bodies.len()).filter(|&b| b != mechanism.ground);
    for (color, body) in moving.enumerate() {
        let pen = Pen::new(Paint::Palette(color), 6.0).lightness(lightness);
        let mut shape = match outline(scene, body) {
            Outline::Block(corners) => {
                let at = corners.map(|c| sweep.point(position, body, c));
                Shape::area(at.to_vec(), Pen { width: 3.0, ..pen }, 0.35)
            }
            Outline::Plate(corners) => {
                let at = corners.iter().map(|c| sweep.point(position, body, *c));
                Shape::area(at.collect(), Pen { width: 4.0, ..pen }, 0.15)
            }
            Outline::Bar(ends) => {
                let at = ends.iter().map(|c| sweep.point(position, body, *c));
                Shape::line(at.collect(), pen)
            }
        };
        if lightness == 0.0 {
            shape = shape.named(mechanism.bodies[body].name.clone());
        }
        shapes.push(shape);
    }
    let mut named = Vec::new();
    for joint in &mechanism.joints {
        let [one, _] = joint.bodies.map(|b| b.0);
        let on_ground = joint.bodies.iter().any(|b| b.0 == mechanism.ground);
        let at = sweep.point(position, one, joint.points[0]);
        match joint.kind {
            JointKind::Revolute if on_ground && lightness == 0.0 => {
                shapes.push(Shape::GroundPin { at });
                named.push((at, joint.name.as_str(), Side::AboveLeft));
            }
            JointKind::Revolute if on_ground => {}
            JointKind::Revolute => {
                shapes.push(Shape::pin(at, Paint::Ink, lightness));
                if lightness == 0.0 {
                    named.push((at, joint.name.as_str(), Side::AboveRight));
                }
            }
            JointKind::Prismatic { axes } if on_ground && lightness == 0.0 => {
                let size = size(scene);
                let (_, turn) = sweep.frames[position][one];
                let along = axes[0].turn(turn) * (0.5 * size);
                let middle = vec2(at[0], at[1]);
                let [from, to] = [middle - along, middle + along].map(|p| [p.x, p.y]);
                shapes.push(Shape::GroundLine { from, to });
            }
            _ => {}
        }
    }
    shapes.extend(labels(scene, &named));
}

/// The names of pins: those in one place, such as `E-k3` and `E-k4`, by what they share.
fn labels(scene: &Scene, named: &[([f64; 2], &str, Side)]) -> Vec<Shape> {
    let near = 1e-6 * size(scene);
    let together = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) <= near;
    let mut shapes = Vec::new();
    for (k, &(at, name, side)) in named.iter().enumerate() {
        if named[..k].iter().any(|(other, ..)| together(*other, at)) {
            continue;
        }
        let mut names: Vec<&str> = named
            .iter()
            .filter(|(other, ..)| together(*other, at))
            .map(|(_, name, _)| *name)
            .collect();
        let stem = |name: &&str| name.rsplit_once('-').map(|(stem, _)| stem.to_owned());
        let first = stem(&name);
        let text = match first {
            Some(shared)
                if names.len() > 1 && names.iter().all(|n| stem(n).as_ref() == Some(&shared)) =>
            {
                shared
            }
            _ => {
                names.dedup();
                names.join(", ")
            }
        };
        shapes.push(Shape::text(at, text, side));
    }
    shapes
}

/// How a body is drawn.
enum Outline {
    /// A small block that slides.
    Block([Vec2; 4]),
    /// A plate through three or more points.
    Plate(Vec<Vec2>),
    /// A bar through points of one line.
    Bar(Vec<Vec2>),
}

fn outline(scene: &Scene, body: usize) -> Outline {
    let mut points: Vec<Vec2> = scene.points[body].iter().map(|(_, p)| *p).collect();
    points.dedup();
    if let ([at], Some(axis)) = (points.as_slice(), slide_axis(scene, body)) {
        let half = 0.045 * size(scene);
        let (along, across) = (axis * (1.6 * half), axis.perp() * half);
        let at = *at;
        return Outline::Block([
            at - along - across,
            at + along - across,
            at + along + across,
            at - along + across,
        ]);
    }
    let middle =
        points.iter().fold(Vec2::ZERO, |sum, p| sum + *p) * (1.0 / points.len().max(1) as f64);
    let farthest = points
        .iter()
        .map(|p| *p - middle)
        .max_by(|a, b| a.norm().total_cmp(&b.norm()))
        .unwrap_or(Vec2::ZERO);
    let off_line = |p: &Vec2| farthest.cross(*p - middle).abs() > 1e-6 * farthest.norm().powi(2);
    if points.len() > 2 && points.iter().any(off_line) {
        points.sort_by(|a, b| (*a - middle).angle().total_cmp(&(*b - middle).angle()));
        Outline::Plate(points)
    } else {
        points.sort_by(|a, b| farthest.dot(*a).total_cmp(&farthest.dot(*b)));
        Outline::Bar(points)
    }
}

/// The axis of a body's prismatic joint, in its frame.
fn slide_axis(scene: &Scene, body: usize) -> Option<Vec2> {
    scene.mechanism.joints.iter().find_map(|joint| {
        let JointKind::Prismatic { axes } = joint.kind else {
            return None;
        };
        let end = joint.bodies.iter().position(|b| b.0 == body)?;
        Some(axes[end])
    })
}

/// A length to measure symbols by: the mean length of the bodies that have one, m.
fn size(scene: &Scene) -> f64 {
    let extent = |points: &Vec<(String, Vec2)>| {
        let all = points
            .iter()
            .flat_map(|(_, p)| points.iter().map(|(_, r)| (*p - *r).norm()));
        all.fold(0.0, f64::max)
    };
    let lengths: Vec<f64> = scene
        .points
        .iter()
        .map(extent)
        .filter(|l| *l > 0.0)
        .collect();
    lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
}

/// The paths that were asked for.
pub(super) fn paths(scene: &Scene, sweep: &Sweep) -> Vec<Shape> {
    let wanted = scene.requests.paths.iter();
    let path = |path: &PathPoint| {
        let points = (0..sweep.frames.len()).map(|i| sweep.point(i, path.body.0, path.at));
        let pen = Pen::new(Paint::Ink, 2.0).lightness(0.55);
        Shape::line(points.collect(), pen).named("paths")
    };
    wanted.map(path).collect()
}

/// The part of each path that is passed during the dwell.
fn dwelling(prepared: &Prepared<'_>, sweep: &Sweep, dwell: &Dwell) -> Vec<Shape> {
    let wanted = prepared.scene.requests.paths.iter();
    let path = |path: &PathPoint| {
        // A dwell may pass the end of the turn.
        let within = [0.0, TAU].into_iter().flat_map(|turn| {
            (0..sweep.q.len())
                .filter(move |&i| (dwell.from..=dwell.to).contains(&(sweep.q[i] + turn)))
                .map(|i| sweep.point(i, path.body.0, path.at))
        });
        let pen = Pen::new(Paint::Ink, 5.0).lightness(0.1);
        Shape::line(within.collect(), pen).named("paths during the dwell")
    };
    wanted.map(path).collect()
}

/// A body's angle over the range, the dwell marked.
fn swing(prepared: &Prepared<'_>, sweep: &Sweep, dwell: &Dwell) -> Panel {
    let angles = unwrapped(sweep, dwell.body);
    let points = sweep.q.iter().zip(&angles);
    let name = prepared.scene.mechanism.body_name(dwell.body);
    let (from, to) = (dwell.from.to_degrees(), dwell.to.to_degrees());
    let label = format!("dwell, {:.0}°", to - from);
    let marks = if to > 360.0 {
        vec![
            Mark::Band {
                from,
                to: 360.0,
                label,
            },
            Mark::Band {
                from: 0.0,
                to: to - 360.0,
                label: String::new(),
            },
        ]
    } else {
        vec![Mark::Band { from, to, label }]
    };
    Panel::from(Chart {
        title: format!("Angle of {name}"),
        x: Axis::degrees(coordinate_label(prepared)),
        y: Axis::new(format!("angle of {name}"), "°"),
        series: vec![Series::line(
            "",
            points
                .map(|(q, a)| [q.to_degrees(), a.to_degrees()])
                .collect(),
        )],
        marks,
        ..Chart::default()
    })
}

fn unwrapped(sweep: &Sweep, body: BodyId) -> Vec<f64> {
    let mut angles: Vec<f64> = Vec::with_capacity(sweep.q.len());
    for frame in &sweep.frames {
        let angle = frame[body.0].1.angle();
        let turns = angles
            .last()
            .map_or(0.0, |last| ((last - angle) / TAU).round());
        angles.push(angle + turns * TAU);
    }
    angles
}

/// The longest interval in which a body's angle stays within `band` of its swing.
fn find_dwell(sweep: &Sweep, body: BodyId, band: f64, full: bool) -> Dwell {
    let mut angles = unwrapped(sweep, body);
    let extent = |some: &[f64]| {
        let (low, high) = some
            .iter()
            .fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
        high - low
    };
    let swing = extent(&angles);
    let mut q = sweep.q.clone();
    let n = q.len();
    if full {
        // A dwell may pass the end of the turn.
        let gain = angles[n - 1] - angles[0];
        angles.extend(angles.clone().iter().skip(1).map(|a| a + gain));
        q.extend(sweep.q.iter().skip(1).map(|q| q + TAU));
    }
    let (mut best, mut from) = ((0, 0), 0);
    for to in 0..q.len() {
        while extent(&angles[from..=to]) > band * swing {
            from += 1;
        }
        if to - from > best.1 - best.0 && from < n && to - from < n {
            best = (from, to);
        }
    }
    Dwell {
        body,
        from: q[best.0],
        to: q[best.1],
        moves: extent(&angles[best.0..=best.1]),
        swing,
    }
}
