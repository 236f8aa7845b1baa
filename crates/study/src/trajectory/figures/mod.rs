//! Figures of a trajectory: mechanism, motion, forces, power, internal forces; and the animation.

mod forces;
mod free;
mod motion;

use crate::bodies::{BodyPose, point_position};
use crate::number_format::digits;
use crate::output::{MechanismDrawing, scene_caption, symbol};
use crate::trajectory::compute::{
    Analysis, Column, ColumnQuantity, Trajectory, TrajectoryResults, is_requested,
};
use dwell_report::{
    Animation, Axis, Chart, Drawing, Figure, Paint, Panel, Pen, Scale, Series, Shape, Stroke,
};
use dwell_scene::Scene;

/// Maximum number of curves in a chart.
pub(crate) const MAX_CURVES: usize = 8;
/// Maximum number of bodies whose angles are drawn if none is requested.
pub(crate) const MAX_BODIES: usize = 6;
/// Number of positions in which the mechanism is drawn.
const DRAWN_POSITIONS: usize = 6;
/// Maximum number of frames of the animation, and the duration of each.
const MAX_FRAMES: usize = 60;
const DELAY_MS: u32 = 60;
const WIDTH_PX: u32 = 640;
/// Ratio of a curve's whole extent to that of its inner part above which it may leave its chart next to a
/// limit position.
const DIVERGENCE_RATIO: f64 = 3.0;

/// What all figures of a trajectory share.
pub(crate) struct FigureContext<'a> {
    scene: &'a Scene,
    results: &'a TrajectoryResults,
    analysis: Analysis,
    /// How the positions were come by.
    method_text: String,
    x: Axis,
    abscissa_values: Vec<f64>,
    /// Whether the trajectory starts and ends next to a limit position.
    limits: [bool; 2],
}

/// The figures of a trajectory without the animation, and a note if some are left out.
pub(crate) fn trajectory_figures(
    scene: &Scene,
    results: &TrajectoryResults,
    trajectory: &Trajectory<'_>,
    analysis: Analysis,
) -> (Vec<Figure>, Option<String>) {
    let context = FigureContext::new(scene, results, trajectory, analysis);
    let mut figures = vec![context.mechanism(last_drawn(results, trajectory.period))];
    figures.extend(context.angles());
    figures.extend(context.paths());
    figures.extend(context.lengths());
    figures.extend(context.transmission());
    figures.extend(context.coordinates());
    figures.extend(context.actuator_forces());
    let (reactions, note) = context.reactions();
    figures.extend(reactions);
    figures.extend(context.shaking_force());
    figures.extend(context.power());
    figures.extend(context.energies());
    figures.extend(context.phase_portraits());
    figures.extend(
        results
            .sectioned_links
            .iter()
            .filter_map(|link| context.internal_forces(link)),
    );
    (figures, note)
}

/// The animation of the mechanism, with the requested paths.
pub(crate) fn animation(
    scene: &Scene,
    results: &TrajectoryResults,
    trajectory: &Trajectory<'_>,
) -> Animation {
    let context = FigureContext::new(scene, results, trajectory, Analysis::Kinematics);
    let drawing = MechanismDrawing::new(scene, &results.body_poses).with_visible(&results.modelled);
    let last = last_drawn(results, trajectory.period);
    let count = MAX_FRAMES.min(last + 1);
    // Over a whole period the last position equals the first.
    let is_closed_curve = is_closed(&results.body_poses[..=last]);
    let steps = if is_closed_curve {
        count
    } else {
        count.saturating_sub(1)
    };
    let frame = |i: usize| {
        let k = (i * last) / steps.max(1);
        let mut shapes = context.path_lines();
        drawing.draw(&results.body_poses[k], 0.0, &mut shapes);
        // Moving labels would distract.
        shapes.retain(|s| !matches!(s, Shape::Text { .. }));
        Drawing {
            title: context.describe_position(k),
            x: Axis::new("x", "m"),
            y: Axis::new("y", "m"),
            shapes,
        }
    };
    Animation {
        name: "mechanism".to_owned(),
        frames: (0..count).map(frame).collect(),
        delay_ms: DELAY_MS,
        width_px: WIDTH_PX,
        provenance: trajectory.method_text.clone(),
    }
}

/// The last position that is drawn: the end of the trajectory, or of the first period of the only actuator.
fn last_drawn(results: &TrajectoryResults, period: Option<f64>) -> usize {
    let last = results.body_poses.len().saturating_sub(1);
    let Some(period) = period else { return last };
    let drive = |c: &Column| c.quantity == ColumnQuantity::ActuatorCoordinate(0, 0);
    let Some(k) = results.columns.iter().position(drive) else {
        return last;
    };
    let rows = results.rows.iter();
    let mut rotated = rows.map(|row| (row[k] - results.rows[0][k]).abs());
    // Up to rounding.
    rotated
        .position(|q| q >= period * (1.0 - 1e-9))
        .unwrap_or(last)
}

/// Whether the last position equals the first.
fn is_closed(body_poses: &[Vec<BodyPose>]) -> bool {
    let (Some(first), Some(last)) = (body_poses.first(), body_poses.last()) else {
        return false;
    };
    let size = first.iter().map(|(p, _)| p.norm()).fold(0.0, f64::max);
    let same = |(a, b): (&BodyPose, &BodyPose)| {
        (a.0 - b.0).norm() <= 1e-6 * size && (a.1 - b.1).norm() <= 1e-6
    };
    body_poses.len() > 2 && first.iter().zip(last).all(same)
}

impl<'a> FigureContext<'a> {
    fn new(
        scene: &'a Scene,
        results: &'a TrajectoryResults,
        trajectory: &Trajectory<'_>,
        analysis: Analysis,
    ) -> Self {
        let column_index =
            |quantity: ColumnQuantity| results.columns.iter().position(|c| c.quantity == quantity);
        let values = |k: Option<usize>| -> Vec<f64> {
            let k = k.unwrap_or(0);
            results.rows.iter().map(|row| row[k]).collect()
        };
        let (x, at) = match trajectory.swept_actuator() {
            None => (
                Axis::new("time", "s"),
                values(column_index(ColumnQuantity::Time)),
            ),
            Some(actuator) => {
                let at = values(column_index(ColumnQuantity::ActuatorCoordinate(
                    actuator, 0,
                )));
                let swept = &scene.mechanism.actuators[actuator];
                let name = symbol(&swept.name);
                if swept.coordinate().is_angle() {
                    let degrees = at.iter().map(|q| q.to_degrees()).collect();
                    (Axis::degrees(name), degrees)
                } else {
                    (Axis::new(name, "m"), at)
                }
            }
        };
        let [start, end] = trajectory.ends_at_limit_position;
        Self {
            scene,
            results,
            analysis,
            method_text: trajectory.method_text.clone(),
            x,
            abscissa_values: at,
            limits: [start, end || results.early_stop.is_some()],
        }
    }

    fn caption(&self, text: &str) -> String {
        scene_caption(self.scene, text)
    }

    /// The abscissa of the `k`th position: `time = 0.25 s`, `φ = −12.5°`.
    fn describe_position(&self, k: usize) -> String {
        let (label, at) = (
            &self.x.label,
            self.abscissa_values.get(k).copied().unwrap_or(0.0),
        );
        let text = match self.x.scale {
            Scale::Degrees => format!("{label} = {at:.1}°"),
            _ => format!("{label} = {} {}", digits(at, 4), self.x.unit),
        };
        text.replace('-', "−")
    }

    fn figure(&self, name: String, title: String, text: &str, panels: Vec<Panel>) -> Figure {
        let limit_note = if self.limits[0] || self.limits[1] {
            " Towards a limit position quantities may grow without bound."
        } else {
            ""
        };
        Figure {
            name,
            title,
            caption: self.caption(&format!("{text}{limit_note}")),
            columns: 1,
            panels,
            provenance: self.method_text.clone(),
        }
    }

    /// A curve over the trajectory; angles in degrees.
    fn curve(&self, name: &str, k: usize) -> Series {
        let degrees = self.results.columns[k].unit == "rad";
        let value = |row: &Vec<f64>| if degrees { row[k].to_degrees() } else { row[k] };
        let values = self.results.rows.iter().map(value);
        let points = self
            .abscissa_values
            .iter()
            .zip(values)
            .map(|(x, y)| [*x, y]);
        Series::line(name, points.collect())
    }

    /// A chart of some columns of one unit, each with its name in the legend.
    fn chart(&self, title: &str, label: &str, curves: &[(String, usize)]) -> Chart {
        let series: Vec<Series> = curves
            .iter()
            .enumerate()
            .map(|(i, (name, k))| {
                let name = if curves.len() > 1 { name.as_str() } else { "" };
                let curve = self.curve(name, *k);
                // From the seventh on colours alone would not do.
                if i < 6 {
                    curve
                } else {
                    curve.stroke(Stroke::Dashed)
                }
            })
            .collect();
        let unit = curves
            .first()
            .map_or("", |(_, k)| self.results.columns[*k].unit);
        let y = match unit {
            "rad" => Axis::degrees(label),
            unit => Axis::new(label, unit_text(unit)),
        };
        let title = match curves {
            [(name, _)] if !title.is_empty() => format!("{title}: {name}"),
            _ => title.to_owned(),
        };
        Chart {
            title,
            x: self.x.clone(),
            y: Axis {
                range: self.value_range(&series),
                ..y
            },
            series,
            ..Chart::default()
        }
    }

    /// The vertical range to show if curves grow without bound towards a limit position.
    fn value_range(&self, curves: &[Series]) -> Option<[f64; 2]> {
        let span = |points: &[[f64; 2]]| {
            let start = [f64::MAX, f64::MIN];
            points
                .iter()
                .fold(start, |[a, b], [_, v]| [a.min(*v), b.max(*v)])
        };
        let joined = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let none = [f64::MAX, f64::MIN];
        let inner = |c: &Series| {
            let n = c.points.len();
            let [from, to] = self.limits.map(|limit| if limit { n / 20 } else { 0 });
            span(&c.points[from..n - to])
        };
        let all = curves.iter().map(|c| span(&c.points)).fold(none, joined);
        let inner = curves.iter().map(inner).fold(none, joined);
        let [whole, part] = [all, inner].map(|[low, high]| high - low);
        let margin = 0.08 * part;
        (part > 0.0 && whole > DIVERGENCE_RATIO * part)
            .then(|| [inner[0] - margin, inner[1] + margin])
    }

    /// Whether a column is requested by name.
    fn is_requested(&self, column: &Column) -> bool {
        is_requested(self.scene, column)
    }

    /// The indices of the columns that satisfy a condition.
    fn columns_where(&self, holds: impl Fn(&Column) -> bool) -> Vec<usize> {
        let columns = self.results.columns.iter().enumerate();
        columns.filter(|(_, c)| holds(c)).map(|(k, _)| k).collect()
    }

    /// Whether the absolute values of a column never exceed `size`.
    fn is_zero(&self, k: usize, size: f64) -> bool {
        self.results.rows.iter().all(|row| row[k].abs() <= size)
    }

    fn labelled(&self, indices: &[usize], suffix: &str) -> Vec<(String, usize)> {
        let name = |&k: &usize| {
            let full = &self.results.columns[k].name;
            (full.strip_suffix(suffix).unwrap_or(full).to_owned(), k)
        };
        indices.iter().map(name).collect()
    }

    /// The requested paths.
    fn path_lines(&self) -> Vec<Shape> {
        let path = |path: &dwell_scene::PathPoint| {
            let body_poses = self.results.body_poses.iter();
            let points = body_poses
                .map(|f| point_position(f, path.body.0, path.at))
                .collect();
            Shape::line(points, Pen::new(Paint::Ink, 2.0).lightness(0.55)).named("paths")
        };
        self.scene.requests.paths.iter().map(path).collect()
    }

    /// The mechanism in several positions up to the `last`th.
    fn mechanism(&self, last: usize) -> Figure {
        let drawing = MechanismDrawing::new(self.scene, &self.results.body_poses)
            .with_visible(&self.results.modelled);
        let body_poses = &self.results.body_poses[..=last];
        let mut shapes = Vec::new();
        let drawn = if is_closed(body_poses) {
            DRAWN_POSITIONS
        } else {
            DRAWN_POSITIONS - 1
        };
        for k in (1..DRAWN_POSITIONS.min(body_poses.len())).rev() {
            drawing.draw(
                &body_poses[k * last / drawn],
                0.62 + 0.04 * k as f64,
                &mut shapes,
            );
        }
        // Drawn before the first position, above the slots of the others.
        shapes.extend(self.path_lines());
        if let Some(first) = body_poses.first() {
            drawing.draw(first, 0.0, &mut shapes);
        }
        let unmodelled = self.results.unmodelled_bodies(self.scene);
        let unmodelled = match unmodelled.is_empty() {
            true => String::new(),
            false => format!(
                " Not modelled, as no result depends on them: {}.",
                unmodelled.join(", ")
            ),
        };
        let text = format!(
            "Drawn in full at {}, lighter further on.{unmodelled}",
            self.describe_position(0)
        );
        Figure {
            name: "mechanism".to_owned(),
            title: self.scene.title.clone(),
            caption: self.caption(&text),
            columns: 1,
            panels: vec![Panel::from(Drawing {
                title: String::new(),
                x: Axis::new("x", "m"),
                y: Axis::new("y", "m"),
                shapes,
            })],
            provenance: self.method_text.clone(),
        }
    }
}

/// A unit as a chart writes it.
fn unit_text(unit: &str) -> String {
    unit.replace("s2", "s²")
}
