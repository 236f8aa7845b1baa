//! The figure of a sweep: results over the varied parameters, or their distribution.

use crate::number_format::{count, number};
use crate::output::{self, scene_caption};
use crate::sweep::compute::{Axis as SweepAxis, Row, SweepQuantity};
use crate::sweep::output::PreparedSweep;
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

/// The figure of a sweep, and a note about charts that are left out.
///
/// # Errors
/// Why there is no figure.
pub(crate) fn figure(
    prepared: &PreparedSweep<'_>,
    rows: &[Row],
) -> Result<(Figure, Option<String>), &'static str> {
    let design = &prepared.design;
    let is_listed = |k: &usize| !design.axes[*k].is_random() && design.axes[*k].count() > 1;
    let listed: Vec<usize> = (0..design.axes.len()).filter(is_listed).collect();
    let quantities = prepared.requested.quantities.iter().enumerate();
    let of_each = |chart: &dyn Fn(usize, &SweepQuantity) -> Option<Chart>| {
        let charts = quantities.filter_map(|(k, quantity)| chart(k, quantity));
        charts.collect()
    };
    let (charts, caption): (Vec<Chart>, _) = match (listed.as_slice(), design.is_random()) {
        ([], false) => return Err("a single point has no curve"),
        ([], true) => (of_each(&|k, of| histogram(rows, k, of)), HISTOGRAM),
        (&[abscissa], true) => (
            of_each(&|k, of| band(&design.axes, rows, abscissa, k, of)),
            BAND,
        ),
        (&[abscissa], false) => (curves(prepared, rows, abscissa, None), ""),
        (&[parameter, abscissa], false) => (curves(prepared, rows, abscissa, Some(parameter)), ""),
        _ => return Err("more than two numbers vary over lists, or two together with random ones"),
    };
    if charts.is_empty() {
        return Err("no result has a value");
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
        provenance: method_text(prepared, rows),
        columns: 2,
        panels: charts.map(Into::into).collect(),
    };
    Ok((figure, note))
}

const HISTOGRAM: &str = "Histogram of each result; the band from the 2.5 % to the 97.5 % quantile holds 95 % of the samples.";

const BAND: &str = "Mean of the samples at each value, with the band between the 2.5 % and the 97.5 % quantile, which holds 95 % of them.";

fn method_text(prepared: &PreparedSweep<'_>, rows: &[Row]) -> String {
    let failed = rows.iter().filter(|row| row.result.message.is_some());
    let points = count(rows.len(), "point");
    let seed = match prepared.design.is_random() {
        true => format!(", seed {}", prepared.design.seed),
        false => String::new(),
    };
    match failed.count() {
        0 => format!("{points}{seed}"),
        failed => format!("{points}{seed}, {failed} of them without all results"),
    }
}

fn axis_names(axes: &[SweepAxis]) -> String {
    const MAX_NAMES: usize = 4;
    let names = axes.iter().take(MAX_NAMES).map(|a| a.path.clone());
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

fn axis_of(varied: &SweepAxis) -> Axis {
    Axis::new(&varied.path, unit_text(&varied.unit))
}

fn chart(name: &str, unit: &str, x: Axis, series: Vec<Series>) -> Option<Chart> {
    let has_value = |p: &[f64; 2]| p[0].is_finite() && p[1].is_finite();
    let (title, label) = title_and_label(name);
    let mut points = series.iter().flat_map(|s| &s.points);
    points
        .any(has_value)
        .then(|| output::chart(title, x, Axis::new(label, unit_text(unit)), series))
}

/// The values of an axis that get curves: the first, the last, and some between them.
fn chosen_values(rows: &[Row], axis: usize) -> Vec<f64> {
    let mut values: Vec<f64> = rows.iter().map(|row| row.inputs[axis]).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let last = values.len().saturating_sub(1);
    let step = last.div_ceil(MAX_CURVES - 1).max(1);
    let mut chosen: Vec<f64> = values.iter().copied().step_by(step).collect();
    if !last.is_multiple_of(step) {
        chosen.extend(values.last());
    }
    chosen
}

/// Curves over one axis; of another, a few of its values.
fn curves(
    prepared: &PreparedSweep<'_>,
    rows: &[Row],
    abscissa: usize,
    parameter: Option<usize>,
) -> Vec<Chart> {
    let axes = &prepared.design.axes;
    let line = |index: usize, of: &dyn Fn(&Row) -> bool| {
        let points = rows.iter().filter(|row| of(row));
        sorted(points.map(|row| [row.inputs[abscissa], row.result.values[index]]))
    };
    let one = |group: &ChartGroup<'_>| {
        let members = group.members.iter();
        let mut series = Vec::new();
        match parameter {
            None => series.extend(members.map(|&(index, member)| {
                let points = line(index, &|_| true);
                Series::line(member, points)
            })),
            Some(parameter) => {
                let unit = unit_text(&axes[parameter].unit);
                for (k, value) in chosen_values(rows, parameter).into_iter().enumerate() {
                    series.extend(members.clone().map(|&(index, member)| {
                        let name = format!("{} {unit} {member}", number(value));
                        let points = line(index, &|row| row.inputs[parameter] == value);
                        let stroke = match member {
                            "min" | "lower" => Stroke::Dashed,
                            _ => Stroke::Solid,
                        };
                        let line = Series::line(name.trim_end(), points).stroke(stroke);
                        line.color(Paint::Palette(k))
                    }));
                }
            }
        }
        let mut chart = chart(group.title, group.unit, axis_of(&axes[abscissa]), series)?;
        if let Some(parameter) = parameter {
            chart.title += &format!(", by {}", axes[parameter].path);
        }
        Some(chart)
    };
    let groups = chart_groups(&prepared.requested.quantities);
    groups.iter().filter_map(one).collect()
}

fn sorted(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = points.collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// Mean and limits of the samples of a result over one axis.
fn band(
    axes: &[SweepAxis],
    rows: &[Row],
    abscissa: usize,
    index: usize,
    quantity: &SweepQuantity,
) -> Option<Chart> {
    let mut by_value: Vec<&Row> = rows.iter().collect();
    by_value.sort_by(|a, b| a.inputs[abscissa].total_cmp(&b.inputs[abscissa]));
    let groups = by_value.chunk_by(|a, b| a.inputs[abscissa] == b.inputs[abscissa]);
    let spread = |group: &[&Row]| {
        let values = group.iter().map(|row| row.result.values[index]);
        Some((group[0].inputs[abscissa], Spread::of(values)?))
    };
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
    let x = axis_of(&axes[abscissa]);
    chart(&quantity.name, &quantity.unit, x, series)
}

/// The histogram of a result.
fn histogram(rows: &[Row], index: usize, quantity: &SweepQuantity) -> Option<Chart> {
    let values = || rows.iter().map(|row| row.result.values[index]);
    let spread = Spread::of(values())?;
    let width = spread.max - spread.min;
    // A result that does not depend on the inputs varies by rounding only.
    if width <= 1e-12 * spread.max.abs().max(spread.min.abs()) {
        return None;
    }
    let numbers = values().filter(|v| v.is_finite());
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
    let ([from, to], mean) = (spread.quantiles, number(spread.mean).replace('-', "−"));
    let (title, label) = title_and_label(&quantity.name);
    let x = Axis::new(label, unit_text(&quantity.unit));
    let bars = Series::line("", points).stroke(Stroke::Filled);
    let mut chart = output::chart(title, x, Axis::new("samples", "%"), vec![bars]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::compute::RequestedQuantities;
    use dwell_scene::Scene;

    #[test]
    fn smallest_and_largest_values_share_a_chart() {
        let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
        let scene = Scene::read(format!("{cases}/single-dwell/scene.toml")).expect("a scene");
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
