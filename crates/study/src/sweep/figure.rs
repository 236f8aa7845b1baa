//! The figure of a sweep: results over the varied parameters, or their distribution.

use crate::number_format::{count, number};
use crate::output::scene_caption;
use crate::sweep::compute::{Axis as SweepAxis, Spread, SweepQuantity};
use crate::sweep::output::PreparedSweep;
use crate::sweep::store::Row;
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Series, Stroke};

/// Maximum number of charts on the page, and of curves in a chart.
const MAX_CHARTS: usize = 8;
pub(crate) const MAX_CURVES: usize = 6;
/// Smallest and largest number of bins of a histogram.
const BIN_COUNTS: [usize; 2] = [8, 40];

/// Results that share a chart, such as minimum and maximum of one quantity.
struct ChartGroup<'a> {
    title: &'a str,
    unit: &'static str,
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
    let listed: Vec<usize> = (0..design.axes.len())
        .filter(|&k| !design.axes[k].is_random() && design.axes[k].count() > 1)
        .collect();
    let (charts, caption) = match (listed.as_slice(), design.is_random()) {
        ([], false) => return Err("a single point has no curve"),
        ([], true) => (histograms(prepared, rows), HISTOGRAM),
        (&[abscissa], true) => (bands(prepared, rows, abscissa), BAND),
        (&[abscissa], false) => (curves(prepared, rows, abscissa, None), ""),
        (&[parameter, abscissa], false) => (curves(prepared, rows, abscissa, Some(parameter)), ""),
        _ => return Err("more than two numbers vary over lists, or two together with random ones"),
    };
    let charts: Vec<Chart> = charts.into_iter().flatten().collect();
    if charts.is_empty() {
        return Err("no result has a value");
    }
    let note = (charts.len() > MAX_CHARTS).then(|| {
        format!(
            "of {} only the first {MAX_CHARTS} are drawn: select results with --result",
            count(charts.len(), "chart")
        )
    });
    let charts = charts.into_iter().take(MAX_CHARTS);
    let scene = prepared.scene;
    let figure = Figure {
        name: "sweep".to_owned(),
        title: format!("Sweep over {}", axis_names(&design.axes)),
        caption: scene_caption(scene, caption),
        provenance: method_text(prepared, rows),
        columns: 2,
        panels: charts.map(Into::into).collect(),
    };
    Ok((figure, note))
}

const HISTOGRAM: &str = "How often each result falls into equal steps; the band holds 95 % of the samples, from the \
                         quantile of 2.5 to that of 97.5 %.";

const BAND: &str = "Mean of the samples at each value, and between which values 95 % of them lie.";

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
    let mut names: Vec<&str> = axes
        .iter()
        .take(MAX_NAMES)
        .map(|a| a.path.as_str())
        .collect();
    let more = axes.len().saturating_sub(MAX_NAMES);
    let rest = format!("{more} more");
    if more > 0 {
        names.push(&rest);
    }
    names.join(", ")
}

/// The results by chart.
fn chart_groups(quantities: &[SweepQuantity]) -> Vec<ChartGroup<'_>> {
    let mut all: Vec<ChartGroup<'_>> = Vec::new();
    for (index, quantity) in quantities.iter().enumerate() {
        let split = quantity.name.rsplit_once('.');
        let pair = split.filter(|(_, last)| matches!(*last, "least" | "most" | "from" | "to"));
        let (title, member) = pair.unwrap_or((&quantity.name, ""));
        match all.last_mut().filter(|last| last.title == title) {
            Some(last) => last.members.push((index, member)),
            None => all.push(ChartGroup {
                title,
                unit: quantity.unit,
                members: vec![(index, member)],
            }),
        }
    }
    all
}

fn chart_title(name: &str) -> String {
    let plain = match name {
        "m" => "Generalised inertia m",
        "m.min" => "Least m",
        "m.max" => "Largest m",
        "half_dm" => "½m′",
        "half_dm.min" => "Least ½m′",
        "half_dm.max" => "Largest ½m′",
        "range" => "Range of the coordinate",
        "range.lower" => "Lower end of the range",
        "range.upper" => "Upper end of the range",
        "period" => "Period of the free motion",
        "energy" => "Energy of the free motion",
        other => match other.strip_suffix(".max_abs") {
            Some(what) => return format!("Largest |{what}|"),
            None => other,
        },
    };
    plain.to_owned()
}

fn axis_label(name: &str) -> &str {
    match name {
        "m.min" | "m.max" => "m",
        "half_dm" | "half_dm.min" | "half_dm.max" => "½m′",
        "period" => "T",
        "energy" => "E",
        "range" | "range.lower" | "range.upper" => "q",
        other => other.strip_suffix(".max_abs").unwrap_or(other),
    }
}

/// A unit as a reader writes it.
fn unit_text(unit: &str) -> String {
    unit.replace("m2", "m²").replace("N m", "N·m")
}

fn axis_of(varied: &SweepAxis) -> Axis {
    Axis::new(&varied.path, unit_text(&varied.unit))
}

fn chart(chart_group: &ChartGroup<'_>, x: Axis, series: Vec<Series>) -> Option<Chart> {
    let has_values = |s: &Series| {
        s.points
            .iter()
            .any(|p| p[0].is_finite() && p[1].is_finite())
    };
    series.iter().any(has_values).then(|| Chart {
        title: chart_title(chart_group.title),
        x,
        y: Axis::new(axis_label(chart_group.title), unit_text(chart_group.unit)),
        series,
        ..Chart::default()
    })
}

/// Curves over one axis; of another, a few of its values.
fn curves(
    prepared: &PreparedSweep<'_>,
    rows: &[Row],
    abscissa: usize,
    parameter: Option<usize>,
) -> Vec<Option<Chart>> {
    let axis = &prepared.design.axes[abscissa];
    let mut values: Vec<f64> = parameter.map_or(vec![f64::NAN], |parameter| {
        rows.iter().map(|row| row.inputs[parameter]).collect()
    });
    values.sort_by(f64::total_cmp);
    values.dedup();
    // The first, the last, and some between them.
    let step = (values.len().saturating_sub(1))
        .div_ceil(MAX_CURVES - 1)
        .max(1);
    let last = values.last().copied();
    let mut chosen: Vec<f64> = values.iter().copied().step_by(step).collect();
    if chosen.last().copied().map(f64::to_bits) != last.map(f64::to_bits) {
        chosen.extend(last);
    }
    let one = |chart_group: &ChartGroup<'_>| {
        let mut series = Vec::new();
        for (number_of, &value) in chosen.iter().enumerate() {
            for &(index, member) in &chart_group.members {
                let of = rows
                    .iter()
                    .filter(|row| parameter.is_none_or(|parameter| row.inputs[parameter] == value));
                let points = sorted(of.map(|row| [row.inputs[abscissa], row.result.values[index]]));
                let name = match parameter {
                    None => member.to_owned(),
                    Some(parameter) => {
                        let varied = &prepared.design.axes[parameter];
                        let named =
                            format!("{} {} {member}", number(value), unit_text(&varied.unit));
                        named.trim_end().to_owned()
                    }
                };
                let dashed = parameter.is_some() && matches!(member, "least" | "from");
                let stroke = if dashed {
                    Stroke::Dashed
                } else {
                    Stroke::Solid
                };
                let mut line = Series::line(name, points).stroke(stroke);
                if parameter.is_some() {
                    line = line.color(Paint::Palette(number_of));
                }
                series.push(line);
            }
        }
        let mut chart = chart(chart_group, axis_of(axis), series)?;
        if let Some(parameter) = parameter {
            let varied = &prepared.design.axes[parameter];
            chart.title += &format!(", by {}", varied.path);
        }
        Some(chart)
    };
    chart_groups(&prepared.requested.quantities)
        .iter()
        .map(one)
        .collect()
}

fn sorted(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = points.collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// Mean and limits of the samples over one axis.
fn bands(prepared: &PreparedSweep<'_>, rows: &[Row], abscissa: usize) -> Vec<Option<Chart>> {
    let axis = &prepared.design.axes[abscissa];
    let mut by_value: Vec<&Row> = rows.iter().collect();
    by_value.sort_by(|a, b| a.inputs[abscissa].total_cmp(&b.inputs[abscissa]));
    let one = |(index, quantity): (usize, &SweepQuantity)| {
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
        let chart_group = ChartGroup {
            title: &quantity.name,
            unit: quantity.unit,
            members: Vec::new(),
        };
        let series = vec![
            line("mean", &|s| s.mean),
            line("97.5 %", &|s| s.quantiles[1]).stroke(Stroke::Dashed),
            line("2.5 %", &|s| s.quantiles[0]).stroke(Stroke::Dashed),
        ];
        chart(&chart_group, axis_of(axis), series)
    };
    let quantities = prepared.requested.quantities.iter().enumerate();
    quantities.map(one).collect()
}

/// Histograms of the results.
fn histograms(prepared: &PreparedSweep<'_>, rows: &[Row]) -> Vec<Option<Chart>> {
    let one = |(index, quantity): (usize, &SweepQuantity)| {
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
        let [from, to] = spread.quantiles;
        Some(Chart {
            title: chart_title(&quantity.name),
            x: Axis::new(axis_label(&quantity.name), unit_text(quantity.unit)),
            y: Axis::new("samples", "%"),
            series: vec![Series::line("", points).stroke(Stroke::Filled)],
            marks: vec![
                Mark::Band {
                    from,
                    to,
                    label: String::new(),
                },
                Mark::Vertical {
                    at: spread.mean,
                    label: format!("mean {}", number(spread.mean).replace('-', "−")),
                },
            ],
            ..Chart::default()
        })
    };
    let quantities = prepared.requested.quantities.iter().enumerate();
    quantities.map(one).collect()
}
