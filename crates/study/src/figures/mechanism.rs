//! The mechanism in several positions, the paths of its points, and a body's dwell.

use super::skeleton::{Frame, Skeleton, place};
use super::{caption, coordinate_label};
use crate::error::StudyError;
use crate::motion_error::explain_place;
use crate::prepare::Prepared;
use crate::words::count;
use dwell_geometry::{BodyId, Plan, Pose, Range, Vec2, vec2};
use dwell_kinetostatics::Reduced;
use dwell_report::{Axis, Chart, Drawing, Figure, Mark, Paint, Panel, Pen, Series, Shape};
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
    pub(super) frames: Vec<Vec<Frame>>,
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
        place(&self.frames[position], body, at)
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
        provenance: format!("the mechanism at {}", count(sweep.q.len(), "position")),
    };
    Ok((figure, dwell))
}

/// The bodies in several positions, the lightest at the back.
fn ghosts(prepared: &Prepared<'_>, sweep: &Sweep, full: bool, dwell: Option<&Dwell>) -> Vec<Shape> {
    let mut shapes = Vec::new();
    let skeleton = Skeleton::new(prepared.scene, &sweep.frames);
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
        skeleton.draw(&sweep.frames[position], lightness, &mut shapes);
    }
    shapes
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
