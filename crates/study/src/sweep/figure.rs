//! The figure of a sweep: results over the varied parameters, or their distribution.

use crate::explain::SweepError;
use crate::number_format::{count, number};
use crate::output::{self, scene_caption};
use crate::sweep::compute::SweptScene;
use crate::sweep::compute::{Axis as SweepAxis, SweepQuantity};
use crate::sweep::output::PreparedSweep;
use crate::sweep::parts::StoredRows;
use crate::sweep::spread::Spread;
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Series, Stroke};

/// Maximum number of charts on the page, and of curves in a chart.
const MAX_CHARTS: usize = 8;
pub(crate) const MAX_CURVES: usize = 6;
/// Smallest and largest number of bins of a histogram.
const BIN_COUNTS: [usize; 2] = [8, 40];

/// Results that share a chart, such as minimum and maximum of one quantity.
struct ChartGroup<'a> {
    title: &'a str,
    unit: &'a str,
    /// Their indices among the results, and their names within the chart.
    members: Vec<(usize, &'a str)>,
}

/// The drawn results of a sweep.
pub(crate) enum Drawn {
    /// The figure, and a note about charts that are left out.
    Figure(Box<Figure>, Option<String>),
    /// Why there is no figure.
    Nothing(&'static str),
}

/// The figure of a sweep.
pub(crate) fn figure(
    prepared: &PreparedSweep<'_, impl SweptScene>,
    stored: &StoredRows<'_>,
    failed: usize,
) -> Result<Drawn, SweepError> {
    let design = &prepared.design;
    let is_listed = |k: &usize| !design.axes[*k].is_random() && design.axes[*k].count() > 1;
    let listed: Vec<usize> = (0..design.axes.len()).filter(is_listed).collect();
    let of_each = |chart: &dyn Fn(&[f64], &SweepQuantity) -> Option<Chart>| {
        let quantities = prepared.requested.quantities.iter().enumerate();
        let charts = quantities.filter_map(|(k, quantity)| match stored.values(k) {
            Ok(values) => chart(&values, quantity).map(Ok),
            Err(error) => Some(Err(error)),
        });
        charts.collect::<Result<Vec<Chart>, SweepError>>()
    };
    let sweep = SweptCurves { prepared, stored };
    let (charts, caption): (Vec<Chart>, _) = match (listed.as_slice(), design.is_random()) {
        ([], false) => return Ok(Drawn::Nothing("a single point has no curve")),
        ([], true) => (of_each(&marked_histogram)?, HISTOGRAM),
        (&[abscissa], true) => {
            let (axis, places) = (&design.axes[abscissa], sweep.inputs(abscissa));
            let of = |values: &[f64], of: &SweepQuantity| band(axis, &places, values, of);
            (of_each(&of)?, BAND)
        }
        (&[abscissa], false) => (sweep.charts(abscissa, None)?, ""),
        (&[one, other], false) => {
            // Few curves of many points.
            let mut both = [one, other];
            both.sort_by_key(|axis| design.axes[*axis].count());
            (sweep.charts(both[1], Some(both[0]))?, "")
        }
        _ => {
            let why = "more than two numbers vary over lists, or two together with random ones";
            return Ok(Drawn::Nothing(why));
        }
    };
    if charts.is_empty() {
        return Ok(Drawn::Nothing("no result has a value"));
    }
    let all = count(charts.len(), "chart");
    let note = (charts.len() > MAX_CHARTS).then(|| {
        format!("of {all} only the first {MAX_CHARTS} are drawn: select results with --result")
    });
    let charts = charts.into_iter().take(MAX_CHARTS);
    let figure = Figure {
        name: "sweep".to_owned(),
        title: format!("Sweep over {}", axis_names(&design.axes)),
        caption: scene_caption(prepared.scene, caption),
        provenance: method_text(prepared, stored.count(), failed),
        columns: 2,
        panels: charts.map(Into::into).collect(),
    };
    Ok(Drawn::Figure(Box::new(figure), note))
}

const HISTOGRAM: &str = "Histogram of each result; the band from the 2.5 % to the 97.5 % quantile holds 95 % of the samples.";

const BAND: &str = "Mean of the samples at each value, with the band between the 2.5 % and the 97.5 % quantile, which holds 95 % of them.";

fn method_text(
    prepared: &PreparedSweep<'_, impl SweptScene>,
    stored: usize,
    failed: usize,
) -> String {
    let points = count(stored, "point");
    let seed = if prepared.design.is_random() {
        format!(", seed {}", prepared.design.seed)
    } else {
        String::new()
    };
    match failed {
        0 => format!("{points}{seed}"),
        failed => format!("{points}{seed}, {failed} of them without all results"),
    }
}

fn axis_names(axes: &[SweepAxis]) -> String {
    const MAX_NAMES: usize = 4;
    let names = axes.iter().take(MAX_NAMES).map(|a| label_of(&a.path));
    let mut names: Vec<String> = names.collect();
    if axes.len() > MAX_NAMES {
        names.push(format!("{} more", axes.len() - MAX_NAMES));
    }
    names.join(", ")
}

/// The results by chart.
fn chart_groups(quantities: &[SweepQuantity]) -> Vec<ChartGroup<'_>> {
    let mut all: Vec<ChartGroup<'_>> = Vec::new();
    for (index, quantity) in quantities.iter().enumerate() {
        let split = quantity.name.rsplit_once('.');
        let pair = split.filter(|(_, last)| matches!(*last, "min" | "max" | "lower" | "upper"));
        let (title, member) = pair.unwrap_or((&quantity.name, ""));
        match all.last_mut().filter(|last| last.title == title) {
            Some(last) => last.members.push((index, member)),
            None => all.push(ChartGroup {
                title,
                unit: &quantity.unit,
                members: vec![(index, member)],
            }),
        }
    }
    all
}

/// Results, each with its title and its axis label.
const TITLES: [(&str, &str, &str); 11] = [
    ("m", "Generalised inertia m", "m"),
    ("m.min", "Smallest m", "m"),
    ("m.max", "Largest m", "m"),
    ("half_dm", "½m′", "½m′"),
    ("half_dm.min", "Smallest ½m′", "½m′"),
    ("half_dm.max", "Largest ½m′", "½m′"),
    ("range", "Range of the coordinate", "q"),
    ("range.lower", "Lower end of the range", "q"),
    ("range.upper", "Upper end of the range", "q"),
    ("period", "Period of the free motion", "T"),
    ("energy", "Energy of the free motion", "E"),
];

/// Title and axis label of a result, or of results that share a chart.
fn title_and_label(name: &str) -> (String, &str) {
    if let Some((_, title, label)) = TITLES.iter().find(|(of, ..)| *of == name) {
        return ((*title).to_owned(), label);
    }
    match name.strip_suffix(".max_abs") {
        Some(what) => (format!("Largest |{what}|"), what),
        None => (name.to_owned(), name),
    }
}

/// A unit as a reader writes it.
fn unit_text(unit: &str) -> String {
    unit.replace("m2", "m²")
}

/// The path of a number as a reader would call it: `mass of crank`, `x of crank.B`, `center y of rod`.
fn label_of(path: &str) -> String {
    let sections = ["loads.", "joints.", "drives."].iter();
    let path = sections.fold(path, |path, section| path.trim_start_matches(section));
    let Some((owner, key)) = path.rsplit_once('.') else {
        return path.to_owned();
    };
    let key = key
        .replace("[0]", " x")
        .replace("[1]", " y")
        .replace("[2]", " z");
    match (owner.strip_suffix(".points"), key.rsplit_once(' ')) {
        (Some(body), Some((point, component))) => format!("{component} of {body}.{point}"),
        _ => format!("{} of {owner}", key.replace('-', " ")),
    }
}

fn axis_of(varied: &SweepAxis) -> Axis {
    Axis::new(label_of(&varied.path), unit_text(&varied.unit))
}

fn chart(name: &str, unit: &str, x: Axis, series: Vec<Series>) -> Option<Chart> {
    let has_value = |p: &[f64; 2]| p[0].is_finite() && p[1].is_finite();
    let (title, label) = title_and_label(name);
    let mut points = series.iter().flat_map(|s| &s.points);
    points
        .any(has_value)
        .then(|| output::chart(title, x, Axis::new(label, unit_text(unit)), series))
}

/// The values, each once, rising.
fn distinct(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// The values of a parameter that get curves: the first, the last, and some between them.
fn chosen_values(values: Vec<f64>) -> Vec<f64> {
    let values = distinct(values);
    let last = values.len().saturating_sub(1);
    let step = last.div_ceil(MAX_CURVES - 1).max(1);
    let mut chosen: Vec<f64> = values.iter().copied().step_by(step).collect();
    if !last.is_multiple_of(step) {
        chosen.extend(values.last());
    }
    chosen
}

/// The curves of a sweep over lists.
struct SweptCurves<'a, S> {
    prepared: &'a PreparedSweep<'a, S>,
    stored: &'a StoredRows<'a>,
}

impl<S: SweptScene> SweptCurves<'_, S> {
    /// The values of an axis at all points.
    fn inputs(&self, axis: usize) -> Vec<f64> {
        let design = &self.prepared.design;
        let points = 0..design.points;
        points.map(|point| design.values(point)[axis]).collect()
    }

    /// Curves over one axis; of another, a few of its values.
    fn charts(&self, abscissa: usize, parameter: Option<usize>) -> Result<Vec<Chart>, SweepError> {
        let axes = &self.prepared.design.axes;
        let places = self.inputs(abscissa);
        let parameter = parameter.map(|axis| (&axes[axis], self.inputs(axis)));
        let mut charts = Vec::new();
        for group in chart_groups(&self.prepared.requested.quantities) {
            let series = self.series(&group, &places, parameter.as_ref())?;
            let chart = chart(group.title, group.unit, axis_of(&axes[abscissa]), series);
            let Some(mut chart) = chart else { continue };
            if let Some((axis, inputs)) = &parameter {
                chart.title += &format!(", by {}", label_of(&axis.path));
                let drawn = chosen_values(inputs.clone()).len();
                let all = distinct(inputs.clone()).len();
                if drawn < all {
                    chart.title += &format!(" ({drawn} of its {all} values)");
                }
            }
            charts.push(chart);
        }
        Ok(charts)
    }

    fn series(
        &self,
        group: &ChartGroup<'_>,
        places: &[f64],
        parameter: Option<&(&SweepAxis, Vec<f64>)>,
    ) -> Result<Vec<Series>, SweepError> {
        let member = |&(index, member): &(usize, _)| Ok((member, self.stored.values(index)?));
        let members: Result<Vec<(&str, Vec<f64>)>, SweepError> =
            group.members.iter().map(member).collect();
        let members = members?;
        let points = |values: &[f64]| {
            let points = places.iter().zip(values);
            points.map(|(x, y)| [*x, *y]).collect::<Vec<_>>()
        };
        let Some((axis, of_points)) = parameter else {
            let line = |(name, values): &(&str, Vec<f64>)| {
                Series::line(*name, sorted(points(values).into_iter()))
            };
            return Ok(members.iter().map(line).collect());
        };
        let mut series = Vec::new();
        let unit = unit_text(&axis.unit);
        for (k, value) in chosen_values(of_points.clone()).into_iter().enumerate() {
            for (member, values) in &members {
                let name = format!("{} {unit} {member}", number(value));
                let on_curve = points(values).into_iter().zip(of_points);
                let on_curve = on_curve.filter(|(_, parameter)| **parameter == value);
                let points = sorted(on_curve.map(|(point, _)| point));
                let stroke = match *member {
                    "min" | "lower" => Stroke::Dashed,
                    _ => Stroke::Solid,
                };
                let line = Series::line(name.trim_end(), points).stroke(stroke);
                series.push(line.color(Paint::Palette(k)));
            }
        }
        Ok(series)
    }
}

fn sorted(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = points.collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// Mean and limits of the samples of a result over one axis.
fn band(
    axis: &SweepAxis,
    places: &[f64],
    values: &[f64],
    quantity: &SweepQuantity,
) -> Option<Chart> {
    let points = places.iter().zip(values).map(|(x, y)| [*x, *y]);
    let points = sorted(points);
    let groups = points.chunk_by(|a, b| a[0] == b[0]);
    let spread = |group: &[[f64; 2]]| Some((group[0][0], Spread::of(group.iter().map(|p| p[1]))?));
    let spreads: Vec<(f64, Spread)> = groups.filter_map(spread).collect();
    let line = |name: &str, of: &dyn Fn(&Spread) -> f64| {
        let points = spreads.iter().map(|(x, spread)| [*x, of(spread)]);
        Series::line(name, points.collect()).color(Paint::Palette(0))
    };
    let series = vec![
        line("mean", &|s| s.mean),
        line("97.5 %", &|s| s.quantiles[1]).stroke(Stroke::Dashed),
        line("2.5 %", &|s| s.quantiles[0]).stroke(Stroke::Dashed),
    ];
    chart(&quantity.name, &quantity.unit, axis_of(axis), series)
}

/// The histogram of a result.
fn marked_histogram(values: &[f64], quantity: &SweepQuantity) -> Option<Chart> {
    let mut chart = histogram(values, &quantity.name, &quantity.unit)?;
    let spread = Spread::of(values.iter().copied())?;
    let ([from, to], mean) = (spread.quantiles, number(spread.mean).replace('-', "−"));
    chart.marks = vec![
        Mark::Band {
            from,
            to,
            label: String::new(),
        },
        Mark::Vertical {
            at: spread.mean,
            label: format!("mean {mean}"),
        },
    ];
    Some(chart)
}

/// The distribution of a result; `None` if it does not vary.
pub(crate) fn histogram(values: &[f64], name: &str, unit: &str) -> Option<Chart> {
    let spread = Spread::of(values.iter().copied())?;
    let width = spread.max - spread.min;
    // A result that does not depend on the inputs varies by rounding only.
    if width <= 1e-12 * spread.max.abs().max(spread.min.abs()) {
        return None;
    }
    let numbers = values.iter().copied().filter(|v| v.is_finite());
    let total = numbers.clone().count();
    // Rice's rule.
    let bins = ((2.0 * (total as f64).cbrt()) as usize).clamp(BIN_COUNTS[0], BIN_COUNTS[1]);
    let mut counts = vec![0_usize; bins];
    for value in numbers {
        let bin = (value - spread.min) / width * bins as f64;
        counts[(bin as usize).min(bins - 1)] += 1;
    }
    let edge = |k: usize| spread.min + width * k as f64 / bins as f64;
    let mut points = vec![[edge(0), 0.0]];
    for (k, &count) in counts.iter().enumerate() {
        let share = 100.0 * count as f64 / total as f64;
        points.extend([[edge(k), share], [edge(k + 1), share]]);
    }
    points.push([edge(bins), 0.0]);
    let (title, label) = title_and_label(name);
    let x = Axis::new(label, unit_text(unit));
    let bars = Series::line("", points).stroke(Stroke::Filled);
    let chart = output::chart(title, x, Axis::new("samples", "%"), vec![bars]);
    Some(chart)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::compute::RequestedQuantities;
    use dwell_scene::PlaneScene;

    #[test]
    fn numbers_have_the_names_that_readers_give_them() {
        let labels = [
            "crank.mass",
            "crank.points.B[0]",
            "rod.center[1]",
            "loads.s.free-length",
        ];
        let named = [
            "mass of crank",
            "x of crank.B",
            "center y of rod",
            "free length of s",
        ];
        assert_eq!(labels.map(label_of), named);
    }

    #[test]
    fn smallest_and_largest_values_share_a_chart() {
        let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
        let scene = PlaneScene::read(format!("{cases}/single-dwell/scene.toml")).expect("a scene");
        let requested = RequestedQuantities::new(&scene, &[]).expect("results");
        let groups = chart_groups(&requested.quantities);
        let names: Vec<&str> = groups.iter().map(|group| group.title).collect();
        assert_eq!(
            names,
            [
                "m",
                "half_dm",
                "range",
                "period",
                "energy",
                "slide.normal.max_abs"
            ]
        );
        assert_eq!(groups[0].members, [(0, "min"), (1, "max")]);
    }
}
