//! The mechanism in several positions, the paths of its points, and a body's dwell.

use super::dimensions::dimensions;
use crate::case_report::dwell::{Dwell, RangePoses, requested_dwell, unwrapped_angles};
use dwell_geometry::Range;
use dwell_kinetostatics::ReducedModel;
use dwell_report::{Axis, Chart, Drawing, Figure, Mark, Paint, Panel, Pen, Series, Shape};
use dwell_scene::{PathPoint, PlaneScene};
use dwell_study::number_format::count;
use dwell_study::output::{MechanismDrawing, chart, coordinate_label, figure};
use dwell_study::{PreparedScene, StudyError};
use std::f64::consts::TAU;

/// Number of positions in which the mechanism is drawn.
const DRAWN: usize = 6;

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
    let dwell = requested_dwell(prepared, &poses);
    let first_coordinate = prepared.model.model().plan().assembly_coordinates()[0];
    let shapes = faded_positions(prepared, &poses, full, dwell.as_ref());
    let mut panels = vec![drawing("", shapes)];
    let position = poses.nearest(first_coordinate, full);
    panels.extend(dimensions(scene, &poses, position));
    if let Some(dwell) = &dwell {
        panels.push(body_angle_panel(prepared, &poses, dwell));
    }
    let mut text = format!(
        "Drawn in full at {}, lighter further on.",
        degrees(first_coordinate.to_degrees())
    );
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
pub(super) fn drawing(title: &str, shapes: Vec<Shape>) -> Panel {
    Panel::from(Drawing {
        title: title.to_owned(),
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        shapes,
        ..Drawing::default()
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
    let in_dwell = dwell.map(|dwell| dwell_paths(prepared.scene, poses, dwell));
    lines.extend(in_dwell.unwrap_or_default());
    let drawing = MechanismDrawing::new(prepared.scene, &poses.body_poses).with_paths(lines);
    let start = prepared.model.model().plan().assembly_coordinates()[0];
    let last = poses.q.len() - 1;
    let nearest = |q: f64| poses.nearest(q, full);
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
pub(super) fn paths(scene: &PlaneScene, poses: &RangePoses) -> Vec<Shape> {
    let pen = Pen::new(Paint::Ink, 2.0).lightness(0.55);
    let positions: Vec<usize> = (0..poses.body_poses.len()).collect();
    path_shapes(scene, poses, &positions, pen, "paths")
}

/// The part of each path that is passed during the dwell, which may pass the end of the revolution.
fn dwell_paths(scene: &PlaneScene, poses: &RangePoses, dwell: &Dwell) -> Vec<Shape> {
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
    scene: &PlaneScene,
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
