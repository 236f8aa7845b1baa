//! Figures of a trajectory: mechanism, motion, forces, power, internal forces; and the animation.

mod forces;
mod free;
mod motion;
mod span;

pub use span::PictureSpan;

use self::span::DrawnRows;
use crate::bodies::{BodyPose, point_position};
use crate::explain::StudyError;
use crate::number_format::digits;
use crate::output::{MechanismDrawing, chart, coordinate_axis, figure, symbol};
use crate::ranges::extent;
use crate::trajectory::compute::{
    Analysis, Column, ComputedTrajectory, Quantity, TrajectoryResults,
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
    /// The method that computed the positions.
    method_text: String,
    x: Axis,
    /// The index of the abscissa's column.
    abscissa: usize,
    abscissa_values: Vec<f64>,
    /// The part of the rows that curves show.
    drawn: DrawnRows,
    /// Whether the trajectory starts and ends next to a limit position.
    limits: [bool; 2],
}

/// The figures of a trajectory without the animation, and a note if some are left out.
///
/// # Errors
/// [`StudyError::Scene`] where the span of the curves is not within the trajectory.
pub(crate) fn trajectory_figures(
    scene: &Scene,
    computed: &ComputedTrajectory<'_>,
    span: PictureSpan,
) -> Result<(Vec<Figure>, Option<String>), StudyError> {
    let context = FigureContext::new(scene, computed, span)?;
    let mut figures = vec![context.mechanism(last_drawn(computed))];
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
    figures.extend(context.drives());
    figures.extend(context.energies());
    figures.extend(context.phase_portraits());
    let links = context.results.sectioned_links.iter();
    figures.extend(links.filter_map(|link| context.internal_forces(link)));
    Ok((figures, note))
}

/// The animation of the mechanism, with the requested paths.
///
/// # Errors
/// None: it shows the whole trajectory.
pub(crate) fn animation(
    scene: &Scene,
    computed: &ComputedTrajectory<'_>,
) -> Result<Animation, StudyError> {
    let context = FigureContext::new(scene, computed, PictureSpan::default())?;
    let results = context.results;
    let drawing = MechanismDrawing::new(scene, &results.body_poses)
        .with_visible(&results.modelled)
        .with_paths(context.path_lines());
    let last = last_drawn(computed);
    let count = MAX_FRAMES.min(last + 1);
    // Over a whole period the last position equals the first.
    let is_closed = is_closed(&results.body_poses[..=last]);
    let steps = count.saturating_sub(usize::from(!is_closed));
    let frame = |i: usize| {
        let k = (i * last) / steps.max(1);
        let mut shapes = Vec::new();
        drawing.draw(&results.body_poses[k], 0.0, &mut shapes);
        // Moving labels would distract.
        shapes.retain(|s| !matches!(s, Shape::Text { .. }));
        plane(context.describe_position(k), shapes)
    };
    Ok(Animation {
        name: "mechanism".to_owned(),
        frames: (0..count).map(frame).collect(),
        delay_ms: DELAY_MS,
        width_px: WIDTH_PX,
        provenance: context.method_text,
    })
}

/// The last position that is drawn: the end of the trajectory, or of the first period of the only actuator.
fn last_drawn(computed: &ComputedTrajectory<'_>) -> usize {
    let results = &computed.results;
    let end_of_period = || {
        let k = results.column_index(Quantity::ActuatorCoordinate(0, 0))?;
        let rows = results.rows.iter();
        let mut rotated = rows.map(|row| (row[k] - results.rows[0][k]).abs());
        // Up to rounding.
        let full = computed.trajectory.period? * (1.0 - 1e-9);
        rotated.position(|q| q >= full)
    };
    end_of_period().unwrap_or(results.body_poses.len().saturating_sub(1))
}

/// Whether the last position equals the first.
fn is_closed(body_poses: &[Vec<BodyPose>]) -> bool {
    let [first, _, .., last] = body_poses else {
        return false;
    };
    let size = first.iter().map(|(p, _)| p.norm()).fold(0.0, f64::max);
    let same = |(a, b): (&BodyPose, &BodyPose)| {
        (a.0 - b.0).norm() <= 1e-6 * size && (a.1 - b.1).norm() <= 1e-6
    };
    first.iter().zip(last).all(same)
}

impl<'a> FigureContext<'a> {
    fn new(
        scene: &'a Scene,
        computed: &'a ComputedTrajectory<'_>,
        span: PictureSpan,
    ) -> Result<Self, StudyError> {
        let (trajectory, results) = (&computed.trajectory, &computed.results);
        let abscissa = results.abscissa(trajectory);
        let values = results.rows.iter().map(|row| row[abscissa]);
        let (mut x, abscissa_values) = match trajectory.swept_actuator() {
            None => (Axis::new("time", "s"), values.collect()),
            Some(actuator) => {
                let swept = &scene.mechanism.actuators[actuator];
                let is_angle = swept.coordinate().is_angle();
                let drawn = values.map(|q| if is_angle { q.to_degrees() } else { q });
                let axis = coordinate_axis(&symbol(&swept.name), is_angle);
                (axis, drawn.collect())
            }
        };
        // The span is in the scene's unit, and the axis in degrees or m.
        let swept = trajectory.swept_actuator();
        let swept = swept.map(|k| scene.mechanism.actuators[k].coordinate().is_angle());
        let abscissae = results.rows.iter().map(|row| row[abscissa]);
        let given: Vec<f64> = match swept {
            None => abscissae.collect(),
            Some(is_angle) => abscissae
                .map(|q| scene.to_scene_unit(q, is_angle).0)
                .collect(),
        };
        let unit = swept.map_or("s", |is_angle| scene.to_scene_unit(0.0, is_angle).1);
        let rows = DrawnRows::new(scene, span, &given, unit)?;
        let on_axis = |end: f64| match swept {
            None => end,
            Some(true) => scene.to_si(end, true).to_degrees(),
            Some(false) => scene.to_si(end, false),
        };
        x.range = rows.ends.map(|ends| ends.map(on_axis));
        let [start, end] = trajectory.ends_at_limit_position;
        Ok(Self {
            scene,
            results,
            analysis: trajectory.analysis,
            method_text: trajectory.method_text.clone(),
            x,
            abscissa,
            abscissa_values,
            drawn: rows,
            limits: [start, end || computed.early_stop.is_some()],
        })
    }

    /// The abscissa of the `k`th position that is drawn: `time = 0.25 s`, `φ = −12.5°`.
    fn describe_position(&self, k: usize) -> String {
        self.describe(self.abscissa_values.get(k).copied().unwrap_or(0.0))
    }

    /// The abscissa of the `row`th position, drawn or not.
    fn describe_row(&self, row: usize) -> String {
        let at = self.results.value_at(row, self.abscissa);
        self.describe(match self.x.scale {
            Scale::Degrees => at.to_degrees(),
            _ => at,
        })
    }

    /// A drawn value of the abscissa: `time = 0.25 s`, `φ = −12.5°`.
    fn describe(&self, at: f64) -> String {
        let label = &self.x.label;
        let text = match self.x.scale {
            Scale::Degrees => format!("{label} = {at:.1}°"),
            _ => format!("{label} = {} {}", digits(at, 4), self.x.unit),
        };
        text.replace('-', "−")
    }

    /// A figure whose curves may grow without bound towards a limit position.
    fn figure(
        &self,
        name: impl Into<String>,
        title: impl Into<String>,
        text: &str,
        panels: Vec<Panel>,
    ) -> Figure {
        let limit_note = match self.limits {
            [false, false] => "",
            _ => " Towards a limit position quantities may grow without bound.",
        };
        let span_note = self.span_note();
        let text = format!("{text}{limit_note}{span_note}");
        figure(self.scene, name, title, &text, panels, &self.method_text)
    }

    /// Which part of the trajectory the curves show, if not all of it.
    fn span_note(&self) -> String {
        let Some([from, to]) = self.x.range else {
            return String::new();
        };
        let unit = match self.x.scale {
            Scale::Degrees => "°".to_owned(),
            _ => format!(" {}", self.x.unit),
        };
        let [from, to] = [from, to].map(|v| digits(v, 6).replace('-', "−"));
        let label = &self.x.label;
        format!(" Shown: {label} from {from} to {to}{unit}; the files hold all rows.")
    }

    /// The rows that curves show.
    fn drawn_rows(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.results.rows[self.drawn.rows.clone()].iter()
    }

    /// A curve over the trajectory; angles in degrees.
    fn curve(&self, name: &str, k: usize) -> Series {
        let degrees = self.results.columns[k].unit == "rad";
        let value = |row: &Vec<f64>| if degrees { row[k].to_degrees() } else { row[k] };
        let values = self.drawn_rows().map(value);
        let points = self.abscissa_values[self.drawn.rows.clone()]
            .iter()
            .zip(values);
        Series::line(name, points.map(|(x, y)| [*x, y]).collect())
    }

    /// A chart of some columns of one unit, each with its name in the legend.
    fn chart(&self, title: &str, label: &str, curves: &[(String, usize)]) -> Chart {
        let line = |(i, (name, k)): (usize, &(String, usize))| {
            let name = if curves.len() > 1 { name.as_str() } else { "" };
            match self.curve(name, *k) {
                // From the seventh on colours alone would not do.
                curve if i >= 6 => curve.stroke(Stroke::Dashed),
                curve => curve,
            }
        };
        let series: Vec<Series> = curves.iter().enumerate().map(line).collect();
        let unit = curves.first().map(|(_, k)| self.results.columns[*k].unit);
        let mut y = match unit.unwrap_or_default() {
            "rad" => Axis::degrees(label),
            unit => Axis::new(label, unit.replace("s2", "s²")),
        };
        y.range = self.value_range(&series);
        let title = match curves {
            [(name, _)] if !title.is_empty() => format!("{title}: {name}"),
            _ => title.to_owned(),
        };
        chart(title, self.x.clone(), y, series)
    }

    /// A chart of some columns, if any of them is more than rounding.
    fn chart_of_some(&self, title: &str, label: &str, curves: &[(String, usize)]) -> Option<Chart> {
        self.is_any_nonzero(curves)
            .then(|| self.chart(title, label, curves))
    }

    /// The vertical range to show if curves grow without bound towards a limit position.
    fn value_range(&self, curves: &[Series]) -> Option<[f64; 2]> {
        let all = extent(curves.iter().flat_map(|c| &c.points).map(|[_, v]| *v));
        let inner = curves.iter().flat_map(|c| {
            let n = c.points.len();
            let [from, to] = self.limits.map(|limit| if limit { n / 20 } else { 0 });
            &c.points[from..n - to]
        });
        let inner = extent(inner.map(|[_, v]| *v));
        let [whole, part] = [all, inner].map(|[low, high]| high - low);
        let margin = 0.08 * part;
        (part > 0.0 && whole > DIVERGENCE_RATIO * part)
            .then(|| [inner[0] - margin, inner[1] + margin])
    }

    /// The indices of the columns that satisfy a condition.
    fn columns_where(&self, holds: impl Fn(&Column) -> bool) -> Vec<usize> {
        let columns = self.results.columns.iter().enumerate();
        columns.filter(|(_, c)| holds(c)).map(|(k, _)| k).collect()
    }

    /// Whether a column is zero at every position, but for rounding.
    fn is_zero(&self, k: usize) -> bool {
        self.results.is_rounding[k]
    }

    /// Whether any of some curves is more than rounding.
    fn is_any_nonzero(&self, curves: &[(String, usize)]) -> bool {
        curves.iter().any(|(_, k)| !self.is_zero(*k))
    }

    /// The columns of these indices, named without a suffix.
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
            let poses = self.results.body_poses.iter();
            let points = poses.map(|pose| point_position(pose, path.body.0, path.at));
            let pen = Pen::new(Paint::Ink, 2.0).lightness(0.55);
            Shape::line(points.collect(), pen).named("paths")
        };
        self.scene.requests.paths.iter().map(path).collect()
    }

    /// The mechanism in several positions up to the `last`th.
    fn mechanism(&self, last: usize) -> Figure {
        let drawing = MechanismDrawing::new(self.scene, &self.results.body_poses)
            .with_visible(&self.results.modelled)
            .with_paths(self.path_lines());
        let body_poses = &self.results.body_poses[..=last];
        let mut shapes = Vec::new();
        let drawn = DRAWN_POSITIONS - usize::from(!is_closed(body_poses));
        for k in (1..DRAWN_POSITIONS.min(body_poses.len())).rev() {
            let lightness = 0.62 + 0.04 * k as f64;
            drawing.draw(&body_poses[k * last / drawn], lightness, &mut shapes);
        }
        if let Some(first) = body_poses.first() {
            drawing.draw(first, 0.0, &mut shapes);
        }
        let unmodelled = match self.results.unmodelled_bodies(self.scene) {
            none if none.is_empty() => String::new(),
            bodies => {
                let bodies = bodies.join(", ");
                format!(" Not modelled, as no result depends on them: {bodies}.")
            }
        };
        let text = format!(
            "Drawn in full at {}, lighter further on.{unmodelled}",
            self.describe_position(0)
        );
        let panels = vec![plane(String::new(), shapes).into()];
        let (scene, title) = (self.scene, &self.scene.title);
        figure(scene, "mechanism", title, &text, panels, &self.method_text)
    }
}

/// A drawing in the plane of the mechanism.
fn plane(title: String, shapes: Vec<Shape>) -> Drawing {
    Drawing {
        title,
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        shapes,
    }
}

impl TrajectoryResults {
    /// The bodies that are not modelled, because nothing needs them.
    pub(crate) fn unmodelled_bodies(&self, scene: &Scene) -> Vec<String> {
        let bodies = scene.mechanism.bodies.iter().zip(&self.modelled);
        let unmodelled = bodies.filter(|(_, modelled)| !**modelled);
        unmodelled.map(|(body, _)| body.name.clone()).collect()
    }
}
