//! The mechanism in several positions, the paths of its points, and a body's dwell.

use dwell_geometry::{BodyId, Plan, Pose, Range, Vec2, vec2};
use dwell_kinetostatics::ReducedModel;
use dwell_report::{Axis, Chart, Drawing, Figure, Mark, Paint, Panel, Pen, Series, Shape};
use dwell_scene::{PathPoint, Scene};
use dwell_study::PreparedScene;
use dwell_study::StudyError;
use dwell_study::bodies::{BodyPose, point_position};
use dwell_study::explain::explain_position;
use dwell_study::number_format::count;
use dwell_study::output::MechanismDrawing;
use dwell_study::output::{caption, coordinate_label};
use std::f64::consts::TAU;

/// Positions of the paths.
const PATH_POSITIONS: usize = 720;
/// Number of positions in which the mechanism is drawn.
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
            body_poses.push(
                all.map(|(b, [x, y, _])| {
                    (vec2(x, y), body_rotation(plan, mechanism.ground, b, &pose))
                })
                .collect(),
            );
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

/// The figure, and the dwell that was asked for.
///
/// # Errors
/// [`StudyError::Scene`] where the mechanism cannot be placed.
pub(crate) fn mechanism(
    prepared: &PreparedScene<'_>,
) -> Result<(Figure, Option<Dwell>), StudyError> {
    let range_poses = RangePoses::new(prepared)?;
    let scene = prepared.scene;
    let full = prepared.model.range() == Range::Full;
    let dwell = scene
        .requests
        .dwell
        .as_ref()
        .map(|d| find_dwell(&range_poses, d.body, d.relative_band, full));
    let mut shapes = paths(scene, &range_poses);
    shapes.extend(faded_positions(
        prepared,
        &range_poses,
        full,
        dwell.as_ref(),
    ));
    let mut panels = vec![Panel::from(Drawing {
        title: String::new(),
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        shapes,
    })];
    if let Some(dwell) = &dwell {
        panels.push(body_angle_panel(prepared, &range_poses, dwell));
    }
    let first = prepared.model.model().plan().assembly_coordinates()[0].to_degrees();
    let text = match &dwell {
        Some(d) => format!(
            "Drawn in full at {}, lighter further on. The marked dwell: {} stays within {:.2}° of its {:.1}° swing for {:.0}° of the actuator.",
            degrees(first),
            scene.mechanism.body_name(d.body),
            d.variation.to_degrees(),
            d.swing.to_degrees(),
            (d.to - d.from).to_degrees(),
        ),
        None => format!("Drawn in full at {}, lighter further on.", degrees(first)),
    };
    let figure = Figure {
        name: "mechanism".to_owned(),
        title: scene.title.clone(),
        caption: caption(prepared, &text),
        columns: 1,
        panels,
        provenance: format!(
            "the mechanism at {}",
            count(range_poses.q.len(), "position")
        ),
    };
    Ok((figure, dwell))
}

/// A whole number of degrees, with a minus sign.
fn degrees(angle: f64) -> String {
    format!("{angle:.0}°").replace('-', "−")
}

/// The bodies in several positions, the lightest at the back.
fn faded_positions(
    prepared: &PreparedScene<'_>,
    range_poses: &RangePoses,
    full: bool,
    dwell: Option<&Dwell>,
) -> Vec<Shape> {
    let mut shapes = Vec::new();
    let drawing = MechanismDrawing::new(prepared.scene, &range_poses.body_poses);
    let start = prepared.model.model().plan().assembly_coordinates()[0];
    let last = range_poses.q.len() - 1;
    let nearest = |q: f64| {
        let span = range_poses.q[last] - range_poses.q[0];
        let fraction = if full {
            (q - range_poses.q[0]).rem_euclid(TAU) / span
        } else {
            ((q - range_poses.q[0]) / span).clamp(0.0, 1.0)
        };
        (fraction * last as f64).round() as usize
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
            shapes.extend(dwell_paths(prepared, range_poses, dwell));
        }
        let lightness = if k == 0 { 0.0 } else { 0.62 + 0.04 * k as f64 };
        drawing.draw(&range_poses.body_poses[position], lightness, &mut shapes);
    }
    shapes
}

/// The paths that were asked for.
pub(super) fn paths(scene: &Scene, range_poses: &RangePoses) -> Vec<Shape> {
    let requested = scene.requests.paths.iter();
    let path = |path: &PathPoint| {
        let points =
            (0..range_poses.body_poses.len()).map(|i| range_poses.point(i, path.body.0, path.at));
        let pen = Pen::new(Paint::Ink, 2.0).lightness(0.55);
        Shape::line(points.collect(), pen).named("paths")
    };
    requested.map(path).collect()
}

/// The part of each path that is passed during the dwell.
fn dwell_paths(
    prepared: &PreparedScene<'_>,
    range_poses: &RangePoses,
    dwell: &Dwell,
) -> Vec<Shape> {
    let requested = prepared.scene.requests.paths.iter();
    let path = |path: &PathPoint| {
        // A dwell may pass the end of the turn.
        let points = [0.0, TAU].into_iter().flat_map(|revolution| {
            (0..range_poses.q.len())
                .filter(move |&i| {
                    (dwell.from..=dwell.to).contains(&(range_poses.q[i] + revolution))
                })
                .map(|i| range_poses.point(i, path.body.0, path.at))
        });
        let pen = Pen::new(Paint::Ink, 5.0).lightness(0.1);
        Shape::line(points.collect(), pen).named("paths during the dwell")
    };
    requested.map(path).collect()
}

/// A body's angle over the range, the dwell marked.
fn body_angle_panel(
    prepared: &PreparedScene<'_>,
    range_poses: &RangePoses,
    dwell: &Dwell,
) -> Panel {
    let angles = unwrapped_angles(range_poses, dwell.body);
    let points = range_poses.q.iter().zip(&angles);
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

fn unwrapped_angles(range_poses: &RangePoses, body: BodyId) -> Vec<f64> {
    let mut angles: Vec<f64> = Vec::with_capacity(range_poses.q.len());
    for poses in &range_poses.body_poses {
        let angle = poses[body.0].1.angle();
        let revolutions = angles
            .last()
            .map_or(0.0, |last| ((last - angle) / TAU).round());
        angles.push(angle + revolutions * TAU);
    }
    angles
}

/// The longest interval in which a body's angle stays within `band` of its swing.
fn find_dwell(range_poses: &RangePoses, body: BodyId, band: f64, full: bool) -> Dwell {
    let mut angles = unwrapped_angles(range_poses, body);
    let extent = |some: &[f64]| {
        let (low, high) = some
            .iter()
            .fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
        high - low
    };
    let swing = extent(&angles);
    let mut q = range_poses.q.clone();
    let n = q.len();
    if full {
        // A dwell may pass the end of the turn.
        let gain = angles[n - 1] - angles[0];
        angles.extend(angles.clone().iter().skip(1).map(|a| a + gain));
        q.extend(range_poses.q.iter().skip(1).map(|q| q + TAU));
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
        variation: extent(&angles[best.0..=best.1]),
        swing,
    }
}
