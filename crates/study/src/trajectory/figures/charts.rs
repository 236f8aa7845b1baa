//! Charts of the columns of a trajectory over its abscissa.

use super::MAX_CURVES;
use super::last_revolution::last_revolution;
use super::span::{DrawnRows, PictureSpan};
use crate::explain::StudyError;
use crate::number_format::digits;
use crate::output::{chart, coordinate_axis, figure, symbol};
use crate::ranges::extent;
use crate::trajectory::compute::{
    Analysis, Column, ComputedTrajectory, Quantity, TrajectoryResults,
};
use dwell_report::{Axis, Chart, Figure, Panel, Scale, Series, Stroke};
use dwell_scene::SceneFile;

/// Ratio of a curve's whole extent to that of its inner part above which it may leave its chart next to a
/// limit position.
const DIVERGENCE_RATIO: f64 = 3.0;

/// A value of an abscissa in a unit of SI: `time = 0.25 s`, `φ = -12.5°`; a length in the scene's unit.
pub(crate) fn describe_abscissa(scene: &SceneFile, label: &str, unit: &str, at: f64) -> String {
    let (at, unit) = match unit {
        "rad" => return format!("{label} = {:.1}°", at.to_degrees()),
        "m" => scene.to_scene_unit(at, false),
        unit => (at, unit),
    };
    format!("{label} = {} {unit}", digits(at, 4))
}

/// The common data of the charts of a trajectory, in the plane or in space.
pub(crate) struct ChartContext<'a> {
    pub(super) scene: &'a SceneFile,
    pub(super) results: &'a TrajectoryResults,
    pub(super) analysis: Analysis,
    /// The method that computed the positions.
    pub(super) method_text: String,
    pub(super) x: Axis,
    /// The index of the abscissa's column.
    pub(super) abscissa: usize,
    pub(super) abscissa_values: Vec<f64>,
    /// The part of the rows that curves show.
    pub(super) drawn: DrawnRows,
    /// The first row of the last of many revolutions, which is drawn again separately.
    pub(super) last_revolution: Option<usize>,
    /// Whether the trajectory starts and ends next to a limit position.
    pub(super) limits: [bool; 2],
}

impl<'a> ChartContext<'a> {
    /// The context for a scene in the plane or in space; `swept` is the name of the swept coordinate, and whether it is
    /// an angle.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if the span of the curves is not within the trajectory.
    pub(crate) fn new(
        scene: &'a SceneFile,
        swept: Option<(&str, bool)>,
        computed: &'a ComputedTrajectory<'_>,
        span: PictureSpan,
    ) -> Result<Self, StudyError> {
        let (trajectory, results) = (&computed.trajectory, &computed.results);
        let abscissa = results.abscissa(trajectory);
        let values = results.rows.iter().map(|row| row[abscissa]);
        let (mut x, abscissa_values) = match swept {
            None => (Axis::new("time", "s"), values.collect()),
            Some((name, is_angle)) => {
                let drawn = values.map(|q| if is_angle { q.to_degrees() } else { q });
                (coordinate_axis(&symbol(name), is_angle), drawn.collect())
            }
        };
        // The span is in the scene's unit, and the axis in degrees or m.
        let swept = swept.map(|(_, is_angle)| is_angle);
        let in_unit = |row: &Vec<f64>| match swept {
            None => row[abscissa],
            Some(is_angle) => scene.to_scene_unit(row[abscissa], is_angle).0,
        };
        let given: Vec<f64> = results.rows.iter().map(in_unit).collect();
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
            last_revolution: last_revolution(results).filter(|_| rows.ends.is_none()),
            drawn: rows,
            limits: [start, end || computed.early_stop.is_some()],
        })
    }

    /// The abscissa of the `k`th position that is drawn.
    pub(crate) fn describe_position(&self, k: usize) -> String {
        let row = self.results.rows.get(k);
        self.describe(row.map_or(0.0, |row| row[self.abscissa]))
    }

    /// The abscissa of the `row`th position, drawn or not.
    pub(crate) fn describe_row(&self, row: usize) -> String {
        self.describe(self.results.value_at(row, self.abscissa))
    }

    fn describe(&self, at: f64) -> String {
        let unit = self.results.columns[self.abscissa].unit;
        describe_abscissa(self.scene, &self.x.label, unit, at)
    }

    /// A figure whose curves may grow without bound towards a limit position.
    pub(crate) fn figure(
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
        let figure = figure(self.scene, name, title, &text, panels, &self.method_text);
        self.with_last_revolution(figure)
    }

    /// Which part of the trajectory the curves show, if not all of it.
    pub(crate) fn span_note(&self) -> String {
        let Some([from, to]) = self.x.range else {
            return String::new();
        };
        let (factor, unit) = match (self.x.scale, self.x.unit.as_str()) {
            (Scale::Degrees, _) => (1.0, "°"),
            (_, "m") => self.scene.to_scene_unit(1.0, false),
            (_, unit) => (1.0, unit),
        };
        let unit = if unit == "°" {
            unit.to_owned()
        } else {
            format!(" {unit}")
        };
        let [from, to] = [from, to].map(|v| digits(v * factor, 6));
        let label = &self.x.label;
        format!(" Shown: {label} from {from} to {to}{unit}; the files hold all rows.")
    }

    /// The rows that curves show.
    pub(crate) fn drawn_rows(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.results.rows[self.drawn.rows.clone()].iter()
    }

    /// A curve over the trajectory, through its rows and the extrema between them; angles in degrees.
    pub(crate) fn curve(&self, name: &str, k: usize) -> Series {
        let in_degrees = |column: usize, value: f64| match self.results.columns[column].unit {
            "rad" => value.to_degrees(),
            _ => value,
        };
        let places = &self.abscissa_values[self.drawn.rows.clone()];
        let rows = places.iter().zip(self.drawn_rows());
        let mut points: Vec<[f64; 2]> = rows.map(|(x, row)| [*x, in_degrees(k, row[k])]).collect();
        let [low, high] = extent(places.iter().copied());
        let extrema = self.results.extrema.of_curve(k);
        let extrema = extrema.map(|e| [in_degrees(self.abscissa, e.at), in_degrees(k, e.value)]);
        points.extend(extrema.filter(|[x, _]| *x > low && *x < high));
        let ends = places.first().zip(places.last());
        let sign = ends.map_or(1.0, |(first, last)| last - first);
        points.sort_by(|a, b| (sign * a[0]).total_cmp(&(sign * b[0])));
        Series::line(name, points)
    }

    /// A chart of some columns of one unit, each with its name in the legend.
    pub(crate) fn chart(&self, title: &str, label: &str, curves: &[(String, usize)]) -> Chart {
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
    pub(crate) fn chart_of_some(
        &self,
        title: &str,
        label: &str,
        curves: &[(String, usize)],
    ) -> Option<Chart> {
        self.is_any_nonzero(curves)
            .then(|| self.chart(title, label, curves))
    }

    /// Charts of the columns that are not zero within rounding, distributed evenly, so that no chart has a single leftover curve.
    /// Titles number several charts.
    pub(crate) fn even_charts(
        &self,
        title: &str,
        label: &str,
        mut curves: Vec<(String, usize)>,
    ) -> Vec<Panel> {
        curves.retain(|(_, k)| !self.is_zero(*k));
        let count = curves.len().div_ceil(MAX_CURVES).max(1);
        let charts = curves.chunks(curves.len().div_ceil(count).max(1));
        let title = |k: usize| match count {
            1 => title.to_owned(),
            _ => format!("{title}, {} of {count}", k + 1),
        };
        let chart = |(k, some)| self.chart(&title(k), label, some).into();
        charts.enumerate().map(chart).collect()
    }

    /// The vertical range to show if curves grow without bound towards a limit position.
    pub(crate) fn value_range(&self, curves: &[Series]) -> Option<[f64; 2]> {
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
    pub(crate) fn columns_where(&self, holds: impl Fn(&Column) -> bool) -> Vec<usize> {
        let columns = self.results.columns.iter().enumerate();
        columns.filter(|(_, c)| holds(c)).map(|(k, _)| k).collect()
    }

    /// Whether a column is zero at every position within rounding.
    pub(crate) fn is_zero(&self, k: usize) -> bool {
        self.results.is_rounding[k]
    }

    /// Whether any of some curves is more than rounding.
    pub(crate) fn is_any_nonzero(&self, curves: &[(String, usize)]) -> bool {
        curves.iter().any(|(_, k)| !self.is_zero(*k))
    }

    /// The columns of these indices, named without a suffix.
    pub(crate) fn labelled(&self, indices: &[usize], suffix: &str) -> Vec<(String, usize)> {
        let name = |&k: &usize| {
            let full = &self.results.columns[k].name;
            (full.strip_suffix(suffix).unwrap_or(full).to_owned(), k)
        };
        indices.iter().map(name).collect()
    }

    pub(crate) fn actuator_forces(&self) -> Option<Figure> {
        let is_force = |c: &Column| matches!(c.quantity, Quantity::ActuatorForce(_));
        let kinds = [("N m", "Moments", "moment"), ("N", "Forces", "force")];
        let chart = |(unit, title, label)| {
            let indices = self.columns_where(|c| is_force(c) && c.unit == unit);
            let mut curves = self.labelled(&indices, ".actuator_force");
            curves.iter_mut().for_each(|(name, _)| *name = symbol(name));
            curves.retain(|(_, k)| !self.is_zero(*k));
            Some(self.chart_of_some(title, label, &curves)?.into())
        };
        let panels: Vec<Panel> = kinds.into_iter().filter_map(chart).collect();
        let text = "Required actuator forces: the force or moment of the first body on the second.";
        let moments = self.columns_where(|c| is_force(c) && c.unit == "N m");
        let has_moments = moments.iter().any(|k| !self.is_zero(*k));
        let title = match (has_moments, panels.len() > 1) {
            (true, true) => "Actuator forces and moments",
            (true, false) => "Actuator moments",
            (false, _) => "Actuator forces",
        };
        (!panels.is_empty()).then(|| self.figure("actuator-forces", title, text, panels))
    }

    pub(crate) fn shaking_force(&self) -> Option<Figure> {
        let indices = self.columns_where(|c| matches!(c.quantity, Quantity::ShakingForce(_)));
        let named = |names: &[&str], of: &[usize]| -> Vec<(String, usize)> {
            names
                .iter()
                .map(|n| (*n).to_owned())
                .zip(of.iter().copied())
                .collect()
        };
        let axes = ["x", "y", "z"];
        let kinds = match indices[..] {
            [fx, fy, m] => [named(&axes, &[fx, fy]), named(&["moment"], &[m])],
            [ref force @ .., _, _, _] if force.len() == 3 => {
                [named(&axes, force), named(&axes, &indices[3..])]
            }
            _ => return None,
        };
        let charts = ["force", "moment"].into_iter().zip(&kinds);
        let charts = charts.filter_map(|(label, curves)| self.chart_of_some("", label, curves));
        let charts: Vec<_> = charts.collect();
        if charts.is_empty() {
            return None;
        }
        let text =
            "Resultant of joint, actuator and load forces on the frame; moment about its origin.";
        let title = match self.analysis {
            Analysis::Kinetostatics | Analysis::FreeMotion => "Shaking force and moment",
            _ => "Force and moment on the frame",
        };
        let panels = vec![charts.into()];
        Some(self.figure("shaking-force", title, text, panels))
    }

    pub(crate) fn power(&self) -> Option<Figure> {
        let total = |(of, label): (usize, &str)| {
            Some((
                label.to_owned(),
                self.results.column_index(Quantity::Power(of))?,
            ))
        };
        let totals = [(0, "actuators"), (1, "loads"), (2, "kinetic")];
        let mut curves: Vec<_> = totals.into_iter().filter_map(total).collect();
        let powers = self.columns_where(|c| matches!(c.quantity, Quantity::LoadPower(_)));
        let mut each = self.labelled(&powers, ".power");
        each.retain(|(_, k)| !self.is_zero(*k));
        // Of few loads and drives each has a curve.
        if curves.len() == 3 && !self.results.is_limited && each.len() + 2 <= MAX_CURVES {
            curves.splice(1..2, each);
        }
        curves.retain(|(_, k)| !self.is_zero(*k));
        let mut chart = self.chart_of_some("", "power", &curves)?;
        // With one other curve it coincides.
        let kinetic = chart.series.last_mut();
        if let Some(kinetic) = kinetic.filter(|series| series.name == "kinetic") {
            kinetic.stroke = Stroke::Dashed;
        }
        let text = "Power of the actuators, loads and drives; their sum is the rate of the kinetic energy (dashed).";
        Some(self.figure("power-balance", "Power balance", text, vec![chart.into()]))
    }
}
