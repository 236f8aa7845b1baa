//! The mechanism in several positions, the paths of its points, and a body's dwell.

use dwell_geometry::{BodyId, Plan, Pose, Range, Vec2, vec2};
use dwell_kinetostatics::ReducedModel;
use dwell_report::{Axis, Chart, Drawing, Figure, Mark, Paint, Panel, Pen, Series, Shape};
use dwell_scene::{PathPoint, Scene};
use dwell_study::bodies::{BodyPose, point_position};
use dwell_study::explain::explain_position;
use dwell_study::number_format::count;
use dwell_study::output::{MechanismDrawing, chart, coordinate_label, figure};
use dwell_study::ranges::extent;
use dwell_study::{PreparedScene, StudyError};
use std::f64::consts::TAU;

/// Positions of the paths.
const PATH_POSITIONS: usize = 720;
/// Number of positions in which the mechanism is drawn.
const DRAWN: usize = 6;

/// The interval in which a body's angle stays within a band of its whole variation.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dwell {
    /// The body.
    pub(crate) body: BodyId,
    /// From and to, rad of the coordinate; it may pass a whole revolution.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// How far its angle moves in it, and over the whole range, rad.
    pub(crate) variation: f64,
    pub(crate) swing: f64,
}

/// The bodies over the range.
pub(super) struct RangePoses {
    pub(super) q: Vec<f64>,
    /// By position and body: origin and orientation.
    pub(super) body_poses: Vec<Vec<BodyPose>>,
}

impl RangePoses {
    fn new(prepared: &PreparedScene<'_>) -> Result<Self, StudyError> {
        let plan = prepared.model.model().plan();
        let mechanism = &prepared.scene.mechanism;
        let mut pose: Pose<f64> = plan.pose();
        let q = prepared.range_positions(PATH_POSITIONS);
        let mut body_poses = Vec::with_capacity(q.len());
        for &q in &q {
            plan.positions(&[q], &mut pose)
                .map_err(|e| explain_position(prepared.scene, plan, &e))?;
            let all = plan.body_frames(mechanism, &pose).into_iter().enumerate();
            let pose = |(b, [x, y, _]): (usize, [f64; 3])| {
                (vec2(x, y), body_rotation(plan, mechanism.ground, b, &pose))
            };
            body_poses.push(all.map(pose).collect());
        }
        Ok(Self { q, body_poses })
    }

    pub(super) fn point(&self, position: usize, body: usize, at: Vec2) -> [f64; 2] {
        point_position(&self.body_poses[position], body, at)
    }
}

fn body_rotation(plan: &Plan, ground: usize, body: usize, pose: &Pose<f64>) -> Vec2 {
    if body == ground {
        Vec2::IDENTITY
    } else {
        plan.body_rotation(BodyId(body), pose)
    }
}

/// The figure, and the requested dwell.
///
/// # Errors
/// [`StudyError::Scene`] where a position has no solution.
pub(crate) fn mechanism(
    prepared: &PreparedScene<'_>,
) -> Result<(Figure, Option<Dwell>), StudyError> {
    let poses = RangePoses::new(prepared)?;
    let scene = prepared.scene;
    let full = prepared.model.range() == Range::Full;
    let request = scene.requests.dwell.as_ref();
    let dwell = request.map(|d| find_dwell(&poses, d.body, d.relative_band, full));
    let shapes = faded_positions(prepared, &poses, full, dwell.as_ref());
    let mut panels = vec![drawing(shapes)];
    if let Some(dwell) = &dwell {
        panels.push(body_angle_panel(prepared, &poses, dwell));
    }
    let first = prepared.model.model().plan().assembly_coordinates()[0].to_degrees();
    let mut text = format!("Drawn in full at {}, lighter further on.", degrees(first));
    if let Some(d) = &dwell {
        text += &format!(
            " The marked dwell: {} stays within {:.2}° of its {:.1}° swing for {:.0}° of the actuator.",
            scene.mechanism.body_name(d.body),
            d.variation.to_degrees(),
            d.swing.to_degrees(),
            (d.to - d.from).to_degrees(),
        );
    }
    let positions = count(poses.q.len(), "position");
    let provenance = format!("the mechanism at {positions}");
    let figure = figure(scene, "mechanism", &scene.title, &text, panels, provenance);
    Ok((figure, dwell))
}

/// A panel of shapes in the plane.
pub(super) fn drawing(shapes: Vec<Shape>) -> Panel {
    Panel::from(Drawing {
        title: String::new(),
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        shapes,
    })
}

/// A whole number of degrees, with a minus sign.
fn degrees(angle: f64) -> String {
    format!("{angle:.0}°").replace('-', "−")
}

/// The bodies in several positions, the lightest at the back.
fn faded_positions(
    prepared: &PreparedScene<'_>,
    poses: &RangePoses,
    full: bool,
    dwell: Option<&Dwell>,
) -> Vec<Shape> {
    let mut shapes = Vec::new();
    let mut lines = paths(prepared.scene, poses);
    lines.extend(
        dwell
            .into_iter()
            .flat_map(|dwell| dwell_paths(prepared.scene, poses, dwell)),
    );
    let drawing = MechanismDrawing::new(prepared.scene, &poses.body_poses).with_paths(lines);
    let start = prepared.model.model().plan().assembly_coordinates()[0];
    let last = poses.q.len() - 1;
    let nearest = |q: f64| {
        let (from, span) = (poses.q[0], poses.q[last] - poses.q[0]);
        let fraction = match full {
            true => (q - from).rem_euclid(TAU) / span,
            false => ((q - from) / span).clamp(0.0, 1.0),
        };
        (fraction * last as f64).round() as usize
    };
    for k in (0..DRAWN).rev() {
        let position = match (k, full) {
            (0, _) => nearest(start),
            (_, true) => nearest(start + TAU * k as f64 / DRAWN as f64),
            (_, false) => k * last / (DRAWN - 1),
        };
        let lightness = if k == 0 { 0.0 } else { 0.62 + 0.04 * k as f64 };
        drawing.draw(&poses.body_poses[position], lightness, &mut shapes);
    }
    shapes
}

/// The requested paths.
pub(super) fn paths(scene: &Scene, poses: &RangePoses) -> Vec<Shape> {
    let pen = Pen::new(Paint::Ink, 2.0).lightness(0.55);
    let positions: Vec<usize> = (0..poses.body_poses.len()).collect();
    path_shapes(scene, poses, &positions, pen, "paths")
}

/// The part of each path that is passed during the dwell, which may pass the end of the revolution.
fn dwell_paths(scene: &Scene, poses: &RangePoses, dwell: &Dwell) -> Vec<Shape> {
    let pen = Pen::new(Paint::Ink, 5.0).lightness(0.1);
    let all = poses.q.iter().enumerate();
    let within = |offset: f64| {
        let passed = move |q: f64| (dwell.from..=dwell.to).contains(&(q + offset));
        let in_dwell = all.clone().filter(move |(_, q)| passed(**q));
        in_dwell.map(|(i, _)| i)
    };
    let positions: Vec<usize> = within(0.0).chain(within(TAU)).collect();
    let name = "paths during the dwell";
    path_shapes(scene, poses, &positions, pen, name)
}

fn path_shapes(
    scene: &Scene,
    poses: &RangePoses,
    positions: &[usize],
    pen: Pen,
    name: &str,
) -> Vec<Shape> {
    let path = |path: &PathPoint| {
        let at = |&i: &usize| poses.point(i, path.body.0, path.at);
        let points = positions.iter().map(at);
        Shape::line(points.collect(), pen).named(name)
    };
    scene.requests.paths.iter().map(path).collect()
}

/// A body's angle over the range, the dwell marked.
fn body_angle_panel(prepared: &PreparedScene<'_>, poses: &RangePoses, dwell: &Dwell) -> Panel {
    let angles = unwrapped_angles(poses, dwell.body);
    let points = poses.q.iter().zip(&angles);
    let points = points.map(|(q, a)| [q, a].map(|v| v.to_degrees()));
    let name = prepared.scene.mechanism.body_name(dwell.body);
    let (from, to) = (dwell.from.to_degrees(), dwell.to.to_degrees());
    let label = format!("dwell, {:.0}°", to - from);
    let band = |from, to, label| Mark::Band { from, to, label };
    let marks = match to > 360.0 {
        true => vec![
            band(from, 360.0, label),
            band(0.0, to - 360.0, String::new()),
        ],
        false => vec![band(from, to, label)],
    };
    let x = Axis::degrees(coordinate_label(prepared));
    let y = Axis::new(format!("angle of {name}"), "°");
    let line = vec![Series::line("", points.collect())];
    Panel::from(Chart {
        marks,
        ..chart(format!("Angle of {name}"), x, y, line)
    })
}

fn unwrapped_angles(poses: &RangePoses, body: BodyId) -> Vec<f64> {
    let mut angles: Vec<f64> = Vec::with_capacity(poses.q.len());
    for bodies in &poses.body_poses {
        let angle = bodies[body.0].1.angle();
        let last = angles.last();
        let revolutions = last.map_or(0.0, |last| ((last - angle) / TAU).round());
        angles.push(angle + revolutions * TAU);
    }
    angles
}

/// The longest interval in which a body's angle stays within `band` of its whole variation.
fn find_dwell(poses: &RangePoses, body: BodyId, band: f64, full: bool) -> Dwell {
    let mut angles = unwrapped_angles(poses, body);
    let width = |some: &[f64]| {
        let [low, high] = extent(some.iter().copied());
        high - low
    };
    let swing = width(&angles);
    let mut q = poses.q.clone();
    let n = q.len();
    if full {
        // A dwell may pass the end of the revolution.
        let gain = angles[n - 1] - angles[0];
        angles.extend(angles.clone().iter().skip(1).map(|a| a + gain));
        q.extend(poses.q.iter().skip(1).map(|q| q + TAU));
    }
    let (mut best, mut from) = ((0, 0), 0);
    for to in 0..q.len() {
        while width(&angles[from..=to]) > band * swing {
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
        variation: width(&angles[best.0..=best.1]),
        swing,
    }
}
