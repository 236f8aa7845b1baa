//! Pictures of a job: the mechanism before and after with its paths, the curve of the goal, the history, the sensitivities.

use super::compute::Optimised;
use crate::explain::StudyError;
use crate::gradient::output::bars_of;
use crate::output::scene_caption;
use crate::study_scene::StudyScene;
use crate::sweep::compute::{RequestedQuantities, signal_along};
use crate::trajectory::compute::{Point, Signal, Trajectory, analysis_along, curve_along};
use dwell_report::{
    Axis, Chart, Drawing, Figure, Mark, Paint, Panel, Pen, Scale, Series, Shape, Stroke,
};

/// How much lighter the mechanism before is.
const LIGHTER: f64 = 0.55;
/// Positions between which paths are drawn.
const DRAWN: usize = 72;
/// The distance of bars in lengths of the longest.
const DISTANCE: f64 = 0.22;
/// Changes of the goal below this part of it are none.
const VANISHING: f64 = 1e-5;

/// The picture of a job.
///
/// # Errors
/// [`StudyError`] if the better scene cannot be read or evaluated.
pub(super) fn figure<S: StudyScene>(
    scene: &S,
    found: &Optimised,
    better: &S,
) -> Result<Option<Figure>, StudyError> {
    let after = Curves::new(better, found)?;
    // The scene itself may not be assembled.
    let before = Curves::new(scene, found).ok();
    let mut panels: Vec<Panel> = Vec::new();
    let drawing = after.drawing(before.as_ref());
    panels.push(drawing.into());
    if let Some(chart) = after.chart(before.as_ref(), found) {
        panels.push(chart.into());
    }
    panels.push(history(found).into());
    panels.extend(sensitivities(found).map(Into::into));
    let caption = "Grey: the scene. Coloured: the better design. Curves over the completed part of the trajectory; rings are the extrema that tie. Bars: change of the goal in % of its first value for a number that changes by 1 % of its range.";
    Ok(Some(Figure {
        name: "optimise".to_owned(),
        title: format!("{}: {}", scene.title, found.job),
        caption: scene_caption(scene, caption),
        provenance: "sequential quadratic programming from many starts".to_owned(),
        columns: 2,
        panels,
    }))
}

/// What is drawn of a design.
struct Curves<'s, S: StudyScene> {
    scene: &'s S,
    /// The mechanism in its first position, with the paths of its points.
    mechanism: Option<Drawing>,
    /// The curve of the goal, with its unit.
    goal: Option<(Vec<Point>, String)>,
    /// The path of a point, and the points that it should go through, m.
    path: Option<[Vec<[f64; 2]>; 2]>,
}

impl<'s, S: StudyScene> Curves<'s, S> {
    fn new(scene: &'s S, found: &Optimised) -> Result<Self, StudyError> {
        let mut curves = Self {
            scene,
            mechanism: None,
            goal: None,
            path: None,
        };
        let rows = scene.rows()?;
        let Some(analysis) = analysis_along(scene) else {
            return Ok(curves);
        };
        let model = S::model_of(&rows);
        let trajectory = Trajectory::new(&scene.followed(model), analysis, None)?;
        let states = |u: f64| {
            let sample = trajectory.sample_at(u);
            let rest = vec![0.0; sample.q.len()];
            let states = scene.body_states(model, [&sample.q, &rest, &rest]);
            states.ok().map(|(states, _)| states)
        };
        let others = (0..=DRAWN).filter_map(|k| states(k as f64 / DRAWN as f64));
        let others: Vec<_> = others.collect();
        curves.mechanism = states(0.0).map(|at| scene.drawn(&*at, &others));
        let names = [found.goal.clone()];
        let Ok(requested) = RequestedQuantities::within(scene, &names, &[]) else {
            return Ok(curves);
        };
        let signal = signal_along(scene, &rows, analysis, &found.goal, &requested);
        match signal {
            Some(Signal::Distance(distance)) => {
                let [(x, wanted_x), (y, wanted_y)] = &distance.of[..] else {
                    return Ok(curves);
                };
                let along = |of: &Signal| curve_along(scene, &rows, analysis, of);
                let path = along(x)?.into_iter().zip(along(y)?);
                let wanted = wanted_x.iter().zip(wanted_y.iter());
                curves.path = Some([
                    path.map(|(x, y)| [x[1], y[1]]).collect(),
                    wanted.map(|(x, y)| [*x, *y]).collect(),
                ]);
            }
            Some(own) => {
                let curve = curve_along(scene, &rows, analysis, &own)?;
                curves.goal = Some((curve, found.unit.clone()));
            }
            None => {}
        }
        Ok(curves)
    }

    /// Lengths in the unit of the scene.
    fn in_scene_unit(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let unit = |v: f64| self.scene.to_scene_unit(v, false).0;
        points.iter().map(|p| p.map(unit)).collect()
    }

    /// The mechanism before and after in one drawing.
    fn drawing(&self, before: Option<&Self>) -> Drawing {
        let mut drawing = self.mechanism.clone().unwrap_or_default();
        drawing.title = "Before (grey) and after".to_owned();
        let mut shapes = Vec::new();
        if let Some(before) = before {
            let all = before.mechanism.iter().flat_map(|of| &of.shapes);
            shapes.extend(all.filter_map(lightened));
            if let Some([path, _]) = &before.path {
                let pen = Pen::new(Paint::Grey, 1.5).lightness(0.3);
                shapes.push(Shape::line(before.in_scene_unit(path), pen));
            }
        }
        shapes.append(&mut drawing.shapes);
        if let Some([path, wanted]) = &self.path {
            let pen = Pen::new(Paint::Ink, 2.0);
            shapes.push(Shape::line(self.in_scene_unit(path), pen));
            let discs = self.in_scene_unit(wanted).into_iter();
            shapes.extend(discs.map(|at| Shape::Disc {
                at,
                radius_px: 3.0,
                pen: Pen::new(Paint::Ink, 1.2),
                filled: false,
                name: Some("points of the table".to_owned()),
            }));
        }
        drawing.shapes = shapes;
        drawing
    }

    /// The curve of the goal before and after, with the extrema that tie.
    fn chart(&self, before: Option<&Self>, found: &Optimised) -> Option<Chart> {
        let (after, unit) = self.goal.as_ref()?;
        let quantity = found
            .goal
            .rsplit_once('.')
            .map_or(found.goal.as_str(), |(of, _)| of);
        let mut series = Vec::new();
        if let Some((curve, _)) = before.and_then(|of| of.goal.as_ref()) {
            series.push(Series::line("before", curve.clone()).color(Paint::Grey));
        }
        series.push(Series::line("after", after.clone()).color(Paint::Palette(0)));
        let value = |u: f64| {
            let k = (u * (after.len() - 1) as f64).round() as usize;
            after[k.min(after.len() - 1)][1]
        };
        let marks = found.peaks.iter().map(|peak| Mark::Point {
            at: [peak.place, value(peak.place)],
            label: String::new(),
        });
        Some(Chart {
            title: format!("{quantity} along the trajectory"),
            x: Axis::new("completed part", "").with_range(0.0, 1.0),
            y: Axis::new(quantity, unit),
            series,
            marks: marks.collect(),
            ..Chart::default()
        })
    }
}

/// A shape of the mechanism before: grey, without words and supports.
fn lightened(shape: &Shape) -> Option<Shape> {
    let grey = |pen: &Pen| Pen::new(Paint::Grey, pen.width).lightness(LIGHTER);
    match shape {
        Shape::Polyline {
            points,
            pen,
            closed,
            fill,
            ..
        } => Some(Shape::Polyline {
            points: points.clone(),
            pen: grey(pen),
            closed: *closed,
            fill: *fill,
            name: None,
        }),
        Shape::Disc {
            at,
            radius_px,
            pen,
            filled,
            ..
        } => Some(Shape::Disc {
            at: *at,
            radius_px: *radius_px,
            pen: grey(pen),
            filled: *filled,
            name: None,
        }),
        Shape::GroundLine { .. } | Shape::Arrow { .. } => None,
        Shape::GroundPin { .. } | Shape::Text { .. } => None,
    }
}

/// Goal and violation over the accepted points of the best start.
fn history(found: &Optimised) -> Chart {
    let points = |of: &dyn Fn(&super::compute::HistoryPoint) -> f64| {
        let each = found.history.iter();
        each.map(|at| [(at.iteration + 1) as f64, of(at)]).collect()
    };
    let mut goal = Axis::new("goal", &found.unit);
    let values = found.history.iter().map(|at| at.goal);
    let [low, high] = values.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], v| {
        [low.min(v), high.max(v)]
    });
    if low > 0.0 && high > 100.0 * low {
        goal.scale = Scale::Log;
    }
    let has_conditions = !found.conditions.is_empty();
    let mut series =
        vec![Series::line("goal", points(&|at| at.goal)).stroke(Stroke::LineAndPoints)];
    if has_conditions {
        let violation = points(&|at| at.violation.max(1e-16));
        let violation = Series::line("largest violation", violation).stroke(Stroke::LineAndPoints);
        series.push(violation.right());
    }
    Chart {
        title: "Best start".to_owned(),
        x: Axis::new("accepted point", ""),
        y: goal,
        y2: has_conditions.then(|| Axis::log("violation", "")),
        series,
        ..Chart::default()
    }
}

/// Bars of the derivatives of the goal by the numbers; none where all vanish, as without active conditions.
fn sensitivities(found: &Optimised) -> Option<Drawing> {
    let size = found.before.unwrap_or(found.after).abs();
    let percent = |of: &super::compute::OptimisedNumber| {
        let change = of.slope * (of.bounds[1] - of.bounds[0]) / size;
        (of.path.clone(), change)
    };
    let mut named: Vec<(String, f64)> = found.numbers.iter().map(percent).collect();
    named.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let largest = named.first().map_or(0.0, |(_, change)| change.abs());
    named.retain(|(_, change)| change.abs() > VANISHING * largest);
    let is_flat = named
        .iter()
        .all(|(_, change)| change.is_nan() || change.abs() < VANISHING);
    (!is_flat).then(|| bars_of("Sensitivities at the optimum".to_owned(), &named, DISTANCE))
}
