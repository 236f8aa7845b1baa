//! Writes tolerances: table, figure and summary.

use super::compute::{GradientScene, LimitYield, ResultTolerance, Tolerance, compute_tolerance};
use super::output::{DISTANCES, aligned, bars_of, kink};
use crate::explain::StudyError;
use crate::number_format::{count, digits, digits_within, number};
use crate::output::{Outcome, add_results_page, scene_caption};
use crate::progress::Progress;
use crate::sweep::SweepRequest;
use crate::sweep::figure::histogram;
use dwell_findings::Record;
use dwell_report::{Chart, Figure, Mark, Panel, Series};
use dwell_scene::SceneFile;

/// Numbers that the summary lists of each result, and results that are drawn.
const LISTED: usize = 12;
const DRAWN: usize = 4;
/// Points of either half of a normal curve, and its half width in deviations.
const CURVE_POINTS: i32 = 80;
const CURVE_REACH: f64 = 4.0;
/// Limits are drawn that are at most this many widths of a histogram from the value at the means.
const REACH: f64 = 1.5;
/// Mean shifts below this part of a deviation are printed as zero.
const ROUNDING: f64 = 1e-9;

/// The tolerances of results by random numbers of a scene.
///
/// # Errors
/// [`StudyError`] as of [`compute_tolerance`].
pub(crate) fn tolerance<S: GradientScene>(
    scene: &S,
    request: &SweepRequest<'_>,
    progress: Progress<'_>,
) -> Result<Outcome, StudyError> {
    let found = compute_tolerance(scene, request, progress)?;
    let mut outcome = Outcome {
        record: record(&found),
        ..Outcome::default()
    };
    let stem = format!("{}-gradient-tolerance", scene.name);
    let mut csv = "name,unit,value,standard_error\n".to_owned();
    for of in &outcome.record.numbers {
        let error = of.error.map_or(String::new(), |error| format!("{error:?}"));
        csv += &format!("{},{},{:?},{error}\n", of.name, of.unit, of.value);
    }
    outcome.files.add(format!("{stem}.csv"), csv);
    outcome.summary = summary(scene, request, &found);
    let figure = figure(scene, &found);
    add_results_page(&mut outcome, scene, "tolerances", &stem, figure);
    Ok(outcome)
}

/// All numbers of the study.
fn record(found: &Tolerance) -> Record {
    let mut record = Record::default();
    for result in &found.results {
        let (name, unit) = (&result.nominal.name, &result.nominal.unit);
        record.add(format!("{name}.nominal"), unit, result.nominal.value);
        let second = result.second.iter().map(|of| ("second_order", of));
        for (order, of) in [("first_order", &result.first)].into_iter().chain(second) {
            record.add(format!("{name}.{order}.mean_shift"), unit, of.shift);
            let deviation = format!("{name}.{order}.standard_deviation");
            record.add(deviation, unit, of.deviation);
            for (percent, toleranced) in percents(&of.parts).into_iter().zip(&found.numbers) {
                let part = format!("{name}.{order}.contribution.{}", toleranced.path);
                record.add(part, "%", percent);
            }
        }
        let (of, [mean, deviation]) = (&result.sampled, result.sampling_errors);
        let sampled = format!("{name}.monte_carlo");
        record.add_within(format!("{sampled}.mean_shift"), unit, of.shift, mean);
        let name = format!("{sampled}.standard_deviation");
        record.add_within(name, unit, of.deviation, deviation);
    }
    for of in &found.yields {
        let name = format!("yield of {}", limit_text(of));
        record.add(name.clone(), "%", 100.0 * of.share);
        for (end, share) in ["from", "to"].into_iter().zip(of.interval) {
            record.add(format!("{name} (95 % {end})"), "%", 100.0 * share);
        }
        let first = of.first.iter().map(|first| 100.0 * first);
        first.for_each(|first| record.add(format!("{name} (first order)"), "%", first));
    }
    record.add_count("samples", found.messages.len());
    record.add_count("samples.failed", found.messages.iter().flatten().count());
    record
}

/// Parts of a whole in percent.
fn percents(parts: &[f64]) -> Vec<f64> {
    let total: f64 = parts.iter().sum();
    let total = if total > 0.0 { total } else { 1.0 };
    parts.iter().map(|part| 100.0 * part / total).collect()
}

fn limit_text(of: &LimitYield) -> String {
    let limit = of.limit.as_ref();
    limit.map_or("all limits".to_owned(), ToString::to_string)
}

/// The printed summary.
fn summary(scene: &SceneFile, request: &SweepRequest<'_>, found: &Tolerance) -> String {
    let results = count(found.results.len(), "result");
    let numbers = count(found.numbers.len(), "number");
    let samples = count(found.messages.len(), "sample");
    let (title, seed) = (&scene.title, request.seed);
    let mut text =
        format!("{title}: tolerances of {results} by {numbers}, {samples} with seed {seed}\n");
    for result in &found.results {
        text += &result_text(result, found);
    }
    if let Some(message) = found.messages.iter().flatten().next() {
        let failed = count(found.messages.iter().flatten().count(), "sample");
        text += &format!("  {failed} without all results count as beyond the limits: {message}\n");
    }
    let percent = |share: f64| format!("{} %", digits(100.0 * share, 4));
    for of in &found.yields {
        let (limit, share, [from, to]) =
            (limit_text(of), percent(of.share), of.interval.map(percent));
        let first = of
            .first
            .map(|first| format!("; {} by first order", percent(first)));
        let first = first.unwrap_or_default();
        text += &format!(
            "  yield of {limit}: {share} of the samples, 95 % between {from} and {to}{first}\n"
        );
    }
    text
}

/// The lines about a result.
fn result_text(result: &ResultTolerance, found: &Tolerance) -> String {
    let (nominal, of) = (&result.nominal, &result.sampled);
    let (name, unit) = (&nominal.name, &nominal.unit);
    let mut text = format!("  {name} = {} {unit} at the means\n", number(nominal.value));
    if let Some(reason) = nominal.differenced {
        text += &format!("    derivatives by differences, since {reason}\n");
    }
    text += &kink(nominal);
    let mut rows = vec![["", "mean shift", "standard deviation"].map(str::to_owned)];
    let second = result.second.iter().map(|of| ("second order", of));
    for (order, of) in [("first order", &result.first)].into_iter().chain(second) {
        rows.push([
            order.to_owned(),
            // Without what rounding leaves of a difference of derivatives.
            digits_within(of.shift, ROUNDING * of.deviation, 4),
            digits(of.deviation, 4),
        ]);
    }
    let within = |value, error| format!("{} ± {}", digits(value, 4), digits(error, 2));
    let [mean, deviation] = result.sampling_errors;
    let (mean, deviation) = (within(of.shift, mean), within(of.deviation, deviation));
    rows.push(["Monte Carlo".to_owned(), mean, deviation]);
    text += &aligned(&rows);
    if result.second.is_none() {
        text += "    no second order: no derivatives one standard deviation from the means\n";
    } else if result.is_first_order_negligible() {
        text += "    first order says almost nothing here, as at an optimum: its derivatives vanish; use second order or Monte Carlo\n";
    }
    text + &contributions(result, found)
}

/// The numbers by their parts of the variance, the largest first.
fn sorted(result: &ResultTolerance) -> Vec<usize> {
    let parts = result.parts();
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by(|a, b| parts[*b].total_cmp(&parts[*a]));
    order
}

/// The contributions to the variance of a result in columns.
fn contributions(result: &ResultTolerance, found: &Tolerance) -> String {
    let header = [
        "contribution to the variance",
        "deviation",
        "first order",
        "second order",
    ];
    let mut rows = vec![header.map(str::to_owned)];
    let (order, first) = (sorted(result), percents(&result.first.parts));
    let second = result.second.as_ref().map(|second| percents(&second.parts));
    let percent = |of: f64| format!("{} %", digits(of, 4));
    for &k in order.iter().take(LISTED) {
        let of = &found.numbers[k];
        let deviation = format!("{} {}", number(of.deviation), of.unit);
        let second = second
            .as_ref()
            .map_or("-".to_owned(), |second| percent(second[k]));
        rows.push([of.path.clone(), deviation, percent(first[k]), second]);
    }
    let mut text = aligned(&rows);
    if order.len() > LISTED {
        let left = count(order.len() - LISTED, "number");
        text += &format!("    {left} more in the table\n");
    }
    text
}

/// Histograms beside bars.
fn figure(scene: &SceneFile, found: &Tolerance) -> Option<Figure> {
    let drawn = found.results.iter().filter_map(|result| {
        let parts = percents(result.parts());
        let bar = |k: usize| (found.numbers[k].path.clone(), parts[k]);
        let bars: Vec<(String, f64)> = sorted(result).into_iter().map(bar).collect();
        let order = if result.second.is_some() {
            "second"
        } else {
            "first"
        };
        let title = format!("Contributions to the variance by {order} order, %");
        Some([
            chart(result, &found.yields)?.into(),
            bars_of(title, &bars, DISTANCES[1]).into(),
        ])
    });
    let panels: Vec<Panel> = drawn.take(DRAWN).flatten().collect();
    let caption = "Histogram of the samples with the normal curve of first order and the limits near them, beside the part that each number has in the variance.";
    let samples = count(found.messages.len(), "sample");
    (!panels.is_empty()).then(|| Figure {
        name: "tolerance".to_owned(),
        title: format!("{}: tolerances", scene.title),
        caption: scene_caption(scene, caption),
        provenance: format!("{samples}, derivatives by reverse sweeps and differences"),
        columns: 2,
        panels,
    })
}

/// The distribution of a result.
fn chart(result: &ResultTolerance, yields: &[LimitYield]) -> Option<Chart> {
    let (nominal, deviation) = (&result.nominal, result.first.deviation);
    let mut chart = histogram(&result.values, &nominal.name, &nominal.unit)?;
    let bars = &chart.series[0].points;
    let (width, extent) = (
        bars[2][0] - bars[1][0],
        bars[bars.len() - 1][0] - bars[0][0],
    );
    let vertical = |at: f64, label: String| Mark::Vertical { at, label };
    // A narrower curve would be a peak far above the bars.
    if deviation > width {
        let height = 100.0 * width / (deviation * std::f64::consts::TAU.sqrt());
        let curve = (-CURVE_POINTS..=CURVE_POINTS).map(|k| {
            let z = CURVE_REACH * f64::from(k) / f64::from(CURVE_POINTS);
            [nominal.value + z * deviation, height * (-0.5 * z * z).exp()]
        });
        chart
            .series
            .push(Series::line("first order", curve.collect()));
    } else {
        chart.title += ", first order: no spread";
    }
    let limits = yields.iter().filter_map(|of| of.limit.as_ref());
    for limit in limits.filter(|limit| limit.result == nominal.name) {
        // A limit far away would leave no width for the bars.
        if (limit.limit - nominal.value).abs() < REACH * extent {
            let sign = if limit.is_upper { "≤" } else { "≥" };
            chart.marks.push(vertical(
                limit.limit,
                format!("{sign} {}", number(limit.limit)),
            ));
        }
    }
    Some(chart)
}
