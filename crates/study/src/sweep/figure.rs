//! The picture of a study: results over what varies, or how they are spread.

use super::Prepared;
use super::axes::Axis as Varied;
use super::point::Quantity;
use super::spread::Spread;
use super::store::Row;
use crate::figures::foot;
use crate::words::{count, number};
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Series, Stroke};

/// Most charts on the page, and curves in a chart.
const CHARTS: usize = 8;
const CURVES: usize = 6;
/// Fewest and most steps of a histogram.
const STEPS: [usize; 2] = [8, 40];

/// Results that share a chart: the least and the most of one thing.
struct Shared<'a> {
    title: &'a str,
    unit: &'static str,
    /// Their places among the results, and their names within the chart.
    members: Vec<(usize, &'a str)>,
}

/// The figure of a study, and what is left out of it.
///
/// # Errors
/// In a few words, why there is none.
pub(super) fn figure(
    prepared: &Prepared<'_>,
    rows: &[Row],
) -> Result<(Figure, Option<String>), &'static str> {
    let design = &prepared.design;
    let listed: Vec<usize> = (0..design.axes.len())
        .filter(|&k| !design.axes[k].is_random() && design.axes[k].count() > 1)
        .collect();
    let (charts, words) = match (listed.as_slice(), design.is_random()) {
        ([], false) => return Err("one point makes no curve"),
        ([], true) => (histograms(prepared, rows), HISTOGRAM),
        (&[over], true) => (bands(prepared, rows, over), BAND),
        (&[over], false) => (curves(prepared, rows, over, None), ""),
        (&[by, over], false) => (curves(prepared, rows, over, Some(by)), ""),
        _ => return Err("more than two numbers vary over lists, or two beside random ones"),
    };
    let charts: Vec<Chart> = charts.into_iter().flatten().collect();
    if charts.is_empty() {
        return Err("no result has a value");
    }
    let note = (charts.len() > CHARTS).then(|| {
        format!(
            "of {} the first {CHARTS} are drawn: --want names those that are wanted",
            count(charts.len(), "chart")
        )
    });
    let charts = charts.into_iter().take(CHARTS);
    let scene = prepared.scene;
    let figure = Figure {
        name: "sweep".to_owned(),
        title: format!("Sweep over {}", names(&design.axes)),
        caption: foot(scene, words),
        provenance: how(prepared, rows),
        columns: 2,
        panels: charts.map(Into::into).collect(),
    };
    Ok((figure, note))
}

const HISTOGRAM: &str = "How often each result falls into equal steps; the band holds 95 % of the samples, from the \
                         quantile of 2.5 to that of 97.5 %.";
const BAND: &str = "Mean of the samples at each value, and between which values 95 % of them lie.";

fn how(prepared: &Prepared<'_>, rows: &[Row]) -> String {
    let failed = rows.iter().filter(|row| row.found.message.is_some());
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

fn names(axes: &[Varied]) -> String {
    const MOST: usize = 4;
    let mut names: Vec<&str> = axes.iter().take(MOST).map(|a| a.path.as_str()).collect();
    let more = axes.len().saturating_sub(MOST);
    let rest = format!("{more} more");
    if more > 0 {
        names.push(&rest);
    }
    names.join(", ")
}

/// The results by chart.
fn shared(quantities: &[Quantity]) -> Vec<Shared<'_>> {
    let mut all: Vec<Shared<'_>> = Vec::new();
    for (place, quantity) in quantities.iter().enumerate() {
        let split = quantity.name.rsplit_once('.');
        let pair = split.filter(|(_, last)| matches!(*last, "least" | "most" | "from" | "to"));
        let (title, member) = pair.unwrap_or((&quantity.name, ""));
        match all.last_mut().filter(|last| last.title == title) {
            Some(last) => last.members.push((place, member)),
            None => all.push(Shared {
                title,
                unit: quantity.unit,
                members: vec![(place, member)],
            }),
        }
    }
    all
}

fn title(name: &str) -> String {
    let plain = match name {
        "m" => "Generalised inertia m",
        "m.least" => "Least m",
        "m.most" => "Largest m",
        "half_dm" => "½m′",
        "half_dm.least" => "Least ½m′",
        "half_dm.most" => "Largest ½m′",
        "range" => "Range of the coordinate",
        "range.from" => "Lower end of the range",
        "range.to" => "Upper end of the range",
        "period" => "Period of the free motion",
        "energy" => "Energy of the free motion",
        other => match other.strip_suffix(".peak") {
            Some(what) => return format!("Largest |{what}|"),
            None => other,
        },
    };
    plain.to_owned()
}

fn label(name: &str) -> &str {
    match name {
        "m.least" | "m.most" => "m",
        "half_dm" | "half_dm.least" | "half_dm.most" => "½m′",
        "period" => "T",
        "energy" => "E",
        "range" | "range.from" | "range.to" => "q",
        other => other.strip_suffix(".peak").unwrap_or(other),
    }
}

/// A unit as a reader writes it.
fn pretty(unit: &str) -> String {
    unit.replace("m2", "m²").replace("N m", "N·m")
}

fn axis_of(varied: &Varied) -> Axis {
    Axis::new(&varied.path, pretty(&varied.unit))
}

fn chart(shared: &Shared<'_>, x: Axis, series: Vec<Series>) -> Option<Chart> {
    let drawn = |s: &Series| {
        s.points
            .iter()
            .any(|p| p[0].is_finite() && p[1].is_finite())
    };
    series.iter().any(drawn).then(|| Chart {
        title: title(shared.title),
        x,
        y: Axis::new(label(shared.title), pretty(shared.unit)),
        series,
        ..Chart::default()
    })
}

/// Curves over one axis; of another, a few of its values.
fn curves(
    prepared: &Prepared<'_>,
    rows: &[Row],
    over: usize,
    by: Option<usize>,
) -> Vec<Option<Chart>> {
    let axis = &prepared.design.axes[over];
    let mut values: Vec<f64> = by.map_or(vec![f64::NAN], |by| {
        rows.iter().map(|row| row.inputs[by]).collect()
    });
    values.sort_by(f64::total_cmp);
    values.dedup();
    // The first, the last, and some between them.
    let step = (values.len().saturating_sub(1)).div_ceil(CURVES - 1).max(1);
    let last = values.last().copied();
    let mut chosen: Vec<f64> = values.iter().copied().step_by(step).collect();
    if chosen.last().copied().map(f64::to_bits) != last.map(f64::to_bits) {
        chosen.extend(last);
    }
    let one = |shared: &Shared<'_>| {
        let mut series = Vec::new();
        for (number_of, &value) in chosen.iter().enumerate() {
            for &(place, member) in &shared.members {
                let of = rows
                    .iter()
                    .filter(|row| by.is_none_or(|by| row.inputs[by] == value));
                let points = sorted(of.map(|row| [row.inputs[over], row.found.values[place]]));
                let name = match by {
                    None => member.to_owned(),
                    Some(by) => {
                        let varied = &prepared.design.axes[by];
                        let named = format!("{} {} {member}", number(value), pretty(&varied.unit));
                        named.trim_end().to_owned()
                    }
                };
                let dashed = by.is_some() && matches!(member, "least" | "from");
                let stroke = if dashed {
                    Stroke::Dashed
                } else {
                    Stroke::Solid
                };
                let mut line = Series::line(name, points).stroke(stroke);
                if by.is_some() {
                    line = line.color(Paint::Palette(number_of));
                }
                series.push(line);
            }
        }
        let mut chart = chart(shared, axis_of(axis), series)?;
        if let Some(by) = by {
            let varied = &prepared.design.axes[by];
            chart.title += &format!(", by {}", varied.path);
        }
        Some(chart)
    };
    shared(&prepared.wanted.quantities)
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
fn bands(prepared: &Prepared<'_>, rows: &[Row], over: usize) -> Vec<Option<Chart>> {
    let axis = &prepared.design.axes[over];
    let mut by_value: Vec<&Row> = rows.iter().collect();
    by_value.sort_by(|a, b| a.inputs[over].total_cmp(&b.inputs[over]));
    let one = |(place, quantity): (usize, &Quantity)| {
        let groups = by_value.chunk_by(|a, b| a.inputs[over] == b.inputs[over]);
        let spread = |group: &[&Row]| {
            let values = group.iter().map(|row| row.found.values[place]);
            Some((group[0].inputs[over], Spread::of(values)?))
        };
        let spreads: Vec<(f64, Spread)> = groups.filter_map(spread).collect();
        let line = |name: &str, of: &dyn Fn(&Spread) -> f64| {
            let points = spreads.iter().map(|(x, spread)| [*x, of(spread)]);
            Series::line(name, points.collect()).color(Paint::Palette(0))
        };
        let shared = Shared {
            title: &quantity.name,
            unit: quantity.unit,
            members: Vec::new(),
        };
        let series = vec![
            line("mean", &|s| s.mean),
            line("97.5 %", &|s| s.limits[1]).stroke(Stroke::Dashed),
            line("2.5 %", &|s| s.limits[0]).stroke(Stroke::Dashed),
        ];
        chart(&shared, axis_of(axis), series)
    };
    let quantities = prepared.wanted.quantities.iter().enumerate();
    quantities.map(one).collect()
}

/// How often each result falls where.
fn histograms(prepared: &Prepared<'_>, rows: &[Row]) -> Vec<Option<Chart>> {
    let one = |(place, quantity): (usize, &Quantity)| {
        let values = || rows.iter().map(|row| row.found.values[place]);
        let spread = Spread::of(values())?;
        let width = spread.most - spread.least;
        // What does not depend on what varies has no spread to be drawn: nothing but its rounding.
        if width <= 1e-12 * spread.most.abs().max(spread.least.abs()) {
            return None;
        }
        let numbers = values().filter(|v| v.is_finite());
        let total = numbers.clone().count();
        // Rice's rule.
        let steps = ((2.0 * (total as f64).cbrt()) as usize).clamp(STEPS[0], STEPS[1]);
        let mut counts = vec![0_usize; steps];
        for value in numbers {
            let step = (value - spread.least) / width * steps as f64;
            counts[(step as usize).min(steps - 1)] += 1;
        }
        let edge = |k: usize| spread.least + width * k as f64 / steps as f64;
        let mut points = vec![[edge(0), 0.0]];
        for (k, &count) in counts.iter().enumerate() {
            let share = 100.0 * count as f64 / total as f64;
            points.extend([[edge(k), share], [edge(k + 1), share]]);
        }
        points.push([edge(steps), 0.0]);
        let [from, to] = spread.limits;
        Some(Chart {
            title: title(&quantity.name),
            x: Axis::new(label(&quantity.name), pretty(quantity.unit)),
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
    let quantities = prepared.wanted.quantities.iter().enumerate();
    quantities.map(one).collect()
}
