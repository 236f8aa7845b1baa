//! Writes gradients: table, figure and summary.

use super::compute::{
    Gradient, GradientScene, NumberSlope, ResultGradient, SlopeMethod, compute_gradient,
};
use crate::explain::StudyError;
use crate::number_format::{count, digits, number};
use crate::output::{Outcome, add_results_page, scene_caption};
use crate::progress::Progress;
use dwell_findings::Record;
use dwell_report::{Axis, Drawing, Figure, Paint, Pen, Shape, TextPlacement};
use dwell_scene::SceneFile;

/// Numbers that the summary lists of each result, and bars of the figure.
const LISTED: usize = 12;
/// Results whose bars are drawn, and how many of them one below another.
const DRAWN: usize = 6;
const IN_ONE_COLUMN: usize = 3;
/// The distance of bars where panels have the whole width or half of it, in lengths of the longest bar, and their half thickness in
/// distances.
pub(super) const DISTANCES: [f64; 2] = [0.09, 0.17];
const HALF: f64 = 0.32;

/// The gradients of results by all numbers of a scene.
///
/// # Errors
/// [`StudyError`] where the scene has no such result, or cannot be evaluated.
pub(crate) fn gradient<S: GradientScene>(
    scene: &S,
    results: &[String],
    has_check: bool,
    progress: Progress<'_>,
) -> Result<Outcome, StudyError> {
    let found = compute_gradient(scene, results, has_check, progress)?;
    let mut outcome = Outcome::default();
    let stem = format!("{}-gradient", scene.name);
    outcome.files.add(format!("{stem}.csv"), csv(&found));
    outcome.summary = summary(scene, &found, &mut outcome.record);
    let figure = figure(scene, &found);
    add_results_page(&mut outcome, scene, "gradient", &stem, figure);
    Ok(outcome)
}

/// A derivative with its unit.
fn with_unit(slope: f64, of: &str, by: &str) -> String {
    let value = digits(slope, 6);
    match (of, by) {
        ("", "") => value,
        (of, "") => format!("{value} {of}"),
        ("", by) => format!("{value} per {by}"),
        (of, by) => format!("{value} {of} per {by}"),
    }
}

/// The words of a method.
fn method(of: SlopeMethod) -> &'static str {
    match of {
        SlopeMethod::Exact => "exact",
        SlopeMethod::Differences(_) => "differences",
    }
}

/// The printed summary; its numbers are recorded.
fn summary(scene: &SceneFile, found: &Gradient, record: &mut Record) -> String {
    let mut text = format!(
        "{}: derivatives of {} by the numbers of the scene\n",
        scene.title,
        count(found.results.len(), "result")
    );
    for result in &found.results {
        let (name, unit) = (&result.name, &result.unit);
        record.add(name.clone(), unit, result.value);
        text += &format!("  {name} = {} {unit}\n", number(result.value));
        if let Some(reason) = result.differenced {
            text += &format!("    by differences, since {reason}\n");
        }
        if !result.undefined.is_empty() {
            let numbers = result.undefined.join(", ");
            text += &format!("    no value where one of these changes: {numbers}\n");
        }
        text += &kink(result);
        for of in &result.numbers {
            let by = format!("{name}.by.{}", of.path);
            let unit = ratio(unit, &of.unit);
            match of.method {
                SlopeMethod::Exact => record.add(by, &unit, of.slope),
                SlopeMethod::Differences(error) => record.add_within(by, &unit, of.slope, error),
            }
        }
        text += &listed(result);
    }
    text += &fixed(found);
    text
}

/// What is to be said of extrema that tie.
pub(super) fn kink(result: &ResultGradient) -> String {
    if result.ties.is_empty() {
        return String::new();
    }
    let places: Vec<String> = result.ties.iter().map(|q| number(*q)).collect();
    format!(
        "    as large at {} rad or m, too: the derivative is that of one extremum, and has a kink here\n",
        places.join(", ")
    )
}

/// The numbers that cannot be changed by themselves, by the first line of the reason.
fn fixed(found: &Gradient) -> String {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for (path, reason) in &found.fixed {
        let reason = reason.lines().next().unwrap_or_default();
        match reasons.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, paths)) => paths.push(path),
            None => reasons.push((reason, vec![path])),
        }
    }
    let line = |(reason, paths): (&str, Vec<&str>)| {
        let mut names = paths[..paths.len().min(LISTED)].join(", ");
        if paths.len() > LISTED {
            names += &format!(" and {} more", paths.len() - LISTED);
        }
        format!("  not varied by itself: {names}: {reason}\n")
    };
    reasons.into_iter().map(line).collect()
}

/// The unit of a derivative.
fn ratio(of: &str, by: &str) -> String {
    match (of, by) {
        (of, "") => of.to_owned(),
        ("", by) => format!("1/({by})"),
        (of, by) => format!("{of}/({by})"),
    }
}

/// The strongest numbers of a result, in columns.
fn listed(result: &ResultGradient) -> String {
    let mut rows = vec![["number", "value", "derivative", "% per %", ""].map(str::to_owned)];
    for of in result.numbers.iter().take(LISTED) {
        let percent = result.percent(of).map_or("-".to_owned(), |p| digits(p, 4));
        let mark = if of.value == 0.0 { "*" } else { "" };
        let mut note = match of.method {
            SlopeMethod::Exact => String::new(),
            SlopeMethod::Differences(error) => {
                format!("by differences, within {}", digits(error, 2))
            }
        };
        if let Some([slope, error]) = of.check {
            let apart = digits((slope - of.slope).abs(), 2);
            note = format!("differences: {apart} apart, within {}", digits(error, 2));
        }
        let value = format!("{} {}", number(of.value), of.unit);
        let derivative = with_unit(of.slope, &result.unit, &of.unit);
        rows.push([of.path.clone(), value, derivative, percent + mark, note]);
    }
    let mut text = aligned(&rows);
    let left = result.numbers.len().saturating_sub(LISTED);
    if left > 0 {
        text += &format!("    {} more in the table\n", count(left, "number"));
    }
    if result.numbers.iter().take(LISTED).any(|of| of.value == 0.0) {
        text += "    * of a number that is zero: per 1 % of the size of the mechanism\n";
    }
    text
}

/// Rows in columns, indented.
pub(crate) fn aligned<const COLUMNS: usize>(rows: &[[String; COLUMNS]]) -> String {
    let length = |k: usize| rows.iter().map(move |row| row[k].chars().count()).max();
    let widths: Vec<usize> = (0..COLUMNS).map(|k| length(k).unwrap_or(0)).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths);
        let cells: Vec<String> = cells
            .map(|(cell, width)| format!("{cell:<width$}"))
            .collect();
        text += &format!("    {}", cells.join("  ").trim_end());
        text.push('\n');
    }
    text
}

/// The derivatives as CSV.
fn csv(found: &Gradient) -> String {
    let mut text = "result,unit,result_value,number,number_unit,value,derivative,percent_per_percent,method,error,by_differences,error_of_differences\n".to_owned();
    for result in &found.results {
        for of in &result.numbers {
            let error = match of.method {
                SlopeMethod::Exact => String::new(),
                SlopeMethod::Differences(error) => format!("{error:?}"),
            };
            let percent = result
                .percent(of)
                .map_or(String::new(), |p| format!("{p:?}"));
            let [check, within] = of.check.map_or_else(Default::default, |check| {
                check.map(|value| format!("{value:?}"))
            });
            text += &format!(
                "{},{},{:?},{},{},{:?},{:?},{percent},{},{error},{check},{within}\n",
                result.name,
                result.unit,
                result.value,
                of.path,
                of.unit,
                of.value,
                of.slope,
                method(of.method),
            );
        }
    }
    text
}

/// Bars of the strongest numbers of each result.
fn figure(scene: &SceneFile, found: &Gradient) -> Option<Figure> {
    let is_drawn = |result: &&ResultGradient| result.value != 0.0 && !result.numbers.is_empty();
    let drawn = found.results.iter().filter(is_drawn).take(DRAWN);
    let drawn: Vec<&ResultGradient> = drawn.collect();
    let columns = if drawn.len() > IN_ONE_COLUMN { 2 } else { 1 };
    let panels = drawn.iter().take(drawn.len() / columns * columns);
    let panels = panels.map(|result| bars(result, DISTANCES[columns - 1]));
    let panels: Vec<Drawing> = panels.collect();
    let caption = "Change of the result in % for a change of each number by 1 %, the strongest first; of a number that is zero, by 1 % of the size of the mechanism.";
    (!panels.is_empty()).then(|| Figure {
        name: "gradient".to_owned(),
        title: format!("{}: which numbers the results depend on", scene.title),
        caption: scene_caption(scene, caption),
        provenance: "derivatives by reverse sweeps and, where so marked, differences".to_owned(),
        columns,
        panels: panels.into_iter().map(Into::into).collect(),
    })
}

/// The bars of a result.
fn bars(result: &ResultGradient, distance: f64) -> Drawing {
    let percent = |of: &NumberSlope| (of.path.clone(), result.percent(of).unwrap_or(0.0));
    let listed: Vec<(String, f64)> = result.numbers.iter().map(percent).collect();
    let (value, unit) = (number(result.value), &result.unit);
    bars_of(
        format!("{} = {value} {unit}", result.name),
        &listed,
        distance,
    )
}

/// Bars of the first of named values, at a distance.
pub(crate) fn bars_of(title: String, named: &[(String, f64)], distance: f64) -> Drawing {
    let listed = || named.iter().take(LISTED);
    let longest = listed().map(|(_, value)| value.abs()).fold(0.0, f64::max);
    let mut shapes = Vec::new();
    for (k, (name, value)) in listed().enumerate() {
        let (y, value) = (-distance * k as f64, *value);
        let half = HALF * distance;
        let end = value / longest;
        let color = Paint::Palette(if value < 0.0 { 1 } else { 0 });
        let corners = vec![
            [0.0, y - half],
            [end, y - half],
            [end, y + half],
            [0.0, y + half],
        ];
        shapes.push(Shape::area(corners, Pen::new(color, 1.0), 0.6));
        // The name is on the other side of the axis.
        let [outside, inside] = match value < 0.0 {
            true => [TextPlacement::Left, TextPlacement::Right],
            false => [TextPlacement::Right, TextPlacement::Left],
        };
        shapes.push(Shape::text([end, y], digits(value, 3), outside));
        shapes.push(Shape::text([0.0, y], name.clone(), inside));
    }
    let bottom = -distance * (listed().count() as f64 - 0.5);
    let zero = vec![[0.0, 0.5 * distance], [0.0, bottom]];
    shapes.push(Shape::line(zero, Pen::new(Paint::Ink, 1.5)));
    Drawing {
        title,
        shapes,
        x: Axis {
            range: Some([-1.3, 1.3]),
            ..Axis::default()
        },
        without_axes: true,
        ..Drawing::default()
    }
}
