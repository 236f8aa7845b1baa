//! Writes tolerances: table, figure and summary.

use super::compute::{
    GradientScene, LimitYield, ResultTolerance, SampleShare, Tolerance, compute_tolerance,
};
use super::output::{aligned, bars_of, kink};
use crate::explain::StudyError;
use crate::number_format::{count, digits, number};
use crate::output::{Outcome, add_results_page, scene_caption};
use crate::progress::Progress;
use crate::sweep::SweepRequest;
use crate::sweep::figure::histogram;
use dwell_report::{Chart, Figure, Mark, Panel, Series};
use dwell_scene::SceneFile;

/// Numbers that the summary lists of each result, and results that are drawn.
const LISTED: usize = 12;
const DRAWN: usize = 4;
/// Points of a normal curve, and its half width in deviations.
const CURVE_POINTS: i32 = 80;
const CURVE_REACH: f64 = 4.0;
const METHODS: [&str; 3] = ["first order", "second order", "Monte Carlo"];

/// A line of the table, which is recorded, too.
struct Line {
    result: String,
    unit: String,
    quantity: &'static str,
    method: &'static str,
    /// A number or a limit.
    of: String,
    value: f64,
    error: Option<f64>,
}

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
    let mut outcome = Outcome::default();
    let stem = format!("{}-gradient-tolerance", scene.name);
    let lines = lines(&found);
    for line in &lines {
        let parts = [&line.result, line.quantity, &line.of, line.method];
        let parts = parts.iter().filter(|part| !part.is_empty());
        let name: Vec<String> = parts.map(|part| part.replace(' ', "_")).collect();
        let (name, record) = (name.join("."), &mut outcome.record);
        match line.error {
            Some(error) => record.add_within(name, &line.unit, line.value, error),
            None => record.add(name, &line.unit, line.value),
        }
    }
    outcome.files.add(format!("{stem}.csv"), csv(&lines));
    outcome.summary = summary(scene, request, &found);
    let figure = figure(scene, &found);
    add_results_page(&mut outcome, scene, "tolerances", &stem, figure);
    Ok(outcome)
}

/// All numbers of the study.
fn lines(found: &Tolerance) -> Vec<Line> {
    let mut lines = Vec::new();
    for result in &found.results {
        let nominal = &result.nominal;
        let mut add = |quantity, unit: &str, method, of: &str, value, error| {
            lines.push(Line {
                result: nominal.name.clone(),
                unit: unit.to_owned(),
                quantity,
                method,
                of: of.to_owned(),
                value,
                error,
            });
        };
        let unit = nominal.unit.as_str();
        add("nominal", unit, "", "", nominal.value, None);
        let by_order = [Some(&result.first), result.second.as_ref().ok()];
        for (of, method) in by_order.into_iter().zip(METHODS) {
            let Some(of) = of else { continue };
            add("mean shift", unit, method, "", of.shift, None);
            add("standard deviation", unit, method, "", of.deviation, None);
            let total: f64 = of.parts.iter().sum();
            for (part, toleranced) in of.parts.iter().zip(&found.numbers) {
                let percent = 100.0 * part / total;
                add("contribution", "%", method, &toleranced.path, percent, None);
            }
        }
        let (of, method) = (&result.sampled, METHODS[2]);
        let (mean, deviation) = (Some(of.shift_error), Some(of.deviation_error));
        add("mean shift", unit, method, "", of.shift, mean);
        add(
            "standard deviation",
            unit,
            method,
            "",
            of.deviation,
            deviation,
        );
    }
    let mut add = |method, of: String, value: f64| {
        lines.push(Line {
            result: String::new(),
            unit: "%".to_owned(),
            quantity: "yield",
            method,
            of,
            value: 100.0 * value,
            error: None,
        });
    };
    for of in &found.limits {
        add(METHODS[0], of.limit.to_string(), of.first);
        add(METHODS[2], of.limit.to_string(), of.sampled.share);
    }
    if !found.limits.is_empty() {
        add(METHODS[2], "all limits".to_owned(), found.within_all.share);
        add(
            "95 % from",
            "all limits".to_owned(),
            found.within_all.interval[0],
        );
        add(
            "95 % to",
            "all limits".to_owned(),
            found.within_all.interval[1],
        );
    }
    lines
}

fn csv(lines: &[Line]) -> String {
    let mut text = "result,unit,quantity,method,number_or_limit,value,standard_error\n".to_owned();
    for of in lines {
        let error = of.error.map_or(String::new(), |error| format!("{error:?}"));
        let (result, unit, quantity) = (&of.result, &of.unit, of.quantity);
        let (method, value) = (of.method, of.value);
        text += &format!(
            "{result},{unit},{quantity},{method},{},{value:?},{error}\n",
            of.of
        );
    }
    text
}

/// The printed summary.
fn summary(scene: &SceneFile, request: &SweepRequest<'_>, found: &Tolerance) -> String {
    let mut text = format!(
        "{}: tolerances of {} by {}, {} with seed {}\n",
        scene.title,
        count(found.results.len(), "result"),
        count(found.numbers.len(), "number"),
        count(found.messages.len(), "sample"),
        request.seed
    );
    for result in &found.results {
        text += &result_text(result, found);
    }
    let mut failed = found.messages.iter().enumerate();
    let mut failed = failed
        .by_ref()
        .filter_map(|(k, of)| Some((k, of.as_ref()?)));
    if let Some((k, message)) = failed.next() {
        let all = count(1 + failed.count(), "sample");
        text += &format!(
            "  {all} without all results, beyond every limit: the first is sample {k}: {message}\n"
        );
    }
    for LimitYield {
        limit,
        sampled,
        first,
    } in &found.limits
    {
        let (share, first) = (share_text(sampled), percent(*first));
        text += &format!("  yield of {limit}: {share}; {first} by first order\n");
    }
    if found.limits.len() > 1 {
        text += &format!("  yield of all limits: {}\n", share_text(&found.within_all));
    }
    text
}

fn percent(share: f64) -> String {
    format!("{} %", digits(100.0 * share, 4))
}

fn share_text(of: &SampleShare) -> String {
    let [from, to] = of.interval.map(percent);
    format!(
        "{} of the samples, 95 % between {from} and {to}",
        percent(of.share)
    )
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
    let (shift, deviation) = ("mean shift".to_owned(), "standard deviation".to_owned());
    let mut rows = vec![[String::new(), shift, deviation]];
    let by_order = [Some(&result.first), result.second.as_ref().ok()];
    for (of, method) in by_order.into_iter().zip(METHODS) {
        let Some(of) = of else { continue };
        rows.push([
            method.to_owned(),
            digits(of.shift, 4),
            digits(of.deviation, 4),
        ]);
    }
    let within = |value, error| format!("{} ± {}", digits(value, 4), digits(error, 2));
    let (shift, deviation) = (
        within(of.shift, of.shift_error),
        within(of.deviation, of.deviation_error),
    );
    rows.push([METHODS[2].to_owned(), shift, deviation]);
    text += &aligned(&rows);
    match &result.second {
        Err(reason) => text += &format!("    no second order: {reason}\n"),
        Ok(_) if result.is_first_order_negligible() => {
            text += "    first order says almost nothing here, as at an optimum: its derivatives vanish; use second order or Monte Carlo\n";
        }
        Ok(_) => {}
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
    let order = sorted(result);
    for &k in order.iter().take(LISTED) {
        let toleranced = &found.numbers[k];
        let of = |parts: &[f64]| percent(parts[k] / parts.iter().sum::<f64>());
        let second = result.second.as_ref();
        rows.push([
            toleranced.path.clone(),
            format!("{} {}", number(toleranced.deviation), toleranced.unit),
            of(&result.first.parts),
            second.map_or("-".to_owned(), |second| of(&second.parts)),
        ]);
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
        let chart: Panel = chart(result, &found.limits)?.into();
        let parts = result.parts();
        let total: f64 = parts.iter().sum();
        let bar = |k: usize| (found.numbers[k].path.clone(), 100.0 * parts[k] / total);
        let bars: Vec<(String, f64)> = sorted(result).into_iter().map(bar).collect();
        let order = if result.second.is_ok() {
            METHODS[1]
        } else {
            METHODS[0]
        };
        let title = format!("Contributions to the variance by {order}, %");
        Some([chart, bars_of(title, &bars).into()])
    });
    let panels: Vec<Panel> = drawn.take(DRAWN).flatten().collect();
    let caption = "Histogram of the samples with the normal curve of first order and the limits, beside the part that each number has in the variance.";
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
fn chart(result: &ResultTolerance, limits: &[LimitYield]) -> Option<Chart> {
    let (nominal, deviation) = (&result.nominal, result.first.deviation);
    let mut chart = histogram(&result.values, &nominal.name, &nominal.unit)?;
    let bars = &chart.series[0].points;
    let width = bars[2][0] - bars[1][0];
    let vertical = |at: f64, label: String| Mark::Vertical { at, label };
    // A narrower curve would be a peak far above the bars.
    if deviation > width {
        let height = 100.0 * width / (deviation * std::f64::consts::TAU.sqrt());
        let curve = (-CURVE_POINTS..=CURVE_POINTS).map(|k| {
            let z = CURVE_REACH * f64::from(k) / f64::from(CURVE_POINTS);
            [nominal.value + z * deviation, height * (-0.5 * z * z).exp()]
        });
        let curve: Vec<[f64; 2]> = curve.collect();
        chart.series.push(Series::line("first order", curve));
    } else {
        let label = "at the means, and by first order almost always".to_owned();
        chart.marks.push(vertical(nominal.value, label));
    }
    let own = limits.iter().filter(|of| of.limit.result == nominal.name);
    for LimitYield { limit, .. } in own {
        let sign = if limit.is_upper { "≤" } else { "≥" };
        let value = number(limit.limit);
        chart
            .marks
            .push(vertical(limit.limit, format!("{sign} {value}")));
    }
    Some(chart)
}
