//! What `kinematics` says of the movement, by how much bodies turn and slides travel: with the extrema of its summary and with its rows.

use super::difference::Differences;
use super::program::Run;
use super::reading::Reading;
use super::rows::Rows;
use super::stated::{Expected, sentence_differences};
use serde_json::Value;

/// An extent below this part of the mechanism, or of a radian, is rounding.
const ROUNDING: f64 = 1e-6;
/// Extents that differ by less than this part of them are the same, and named once.
const SAME: f64 = 1e-9;

/// Differences of the movement.
#[derive(Debug, Default)]
pub(super) struct Movement {
    /// Numbers of the summary.
    pub(super) numbers: Differences,
    /// Printed lines.
    pub(super) sentences: Differences,
}

/// The lines `NAME turns by …` and `NAME travels by …` of a run, and the numbers of its summary behind them.
pub(super) fn movement(run: &Run, reading: &Reading, rows: &Rows) -> Result<Movement, String> {
    let summary = run.json("-kinematics.json")?;
    let mut found = Movement::default();
    let results = summary["results"]
        .as_object()
        .ok_or("the summary has no results")?;
    let mut lines: Vec<(String, Vec<Expected>)> = Vec::new();
    let mut extents = Vec::new();
    for (key, entry) in results {
        let Some(name) = key.strip_suffix(".range") else {
            continue;
        };
        let of = |end: &str| results.get(&format!("{name}.range.{end}"))?["value"].as_f64();
        let (Some(by), Some(from), Some(to), Some(unit)) = (
            entry["value"].as_f64(),
            of("from"),
            of("to"),
            entry["unit"].as_str(),
        ) else {
            found.numbers.fail(format!("{key} has no ends"));
            continue;
        };
        add_extent(&mut found.numbers, [by, from, to], name, rows);
        extents.push((unit.to_owned(), by));
        let is_angle = unit == "rad";
        let (verb, end, factor) = match is_angle {
            true => ("turns", ".angle", reading.units.angle),
            false => ("travels", ".travel", reading.units.length),
        };
        let shown = name.strip_suffix(end).unwrap_or(name);
        let numbers = [by, from, to].map(|x| (x / factor, by / factor));
        lines.push((format!("{shown} {verb} by "), numbers.to_vec()));
    }
    found.sentences = sentence_differences(&run.printed, &lines, "kinematics");
    add_named(&mut found.sentences, &summary, reading, &extents);
    Ok(found)
}

/// An extent is the difference of its ends, and no row is beyond them.
fn add_extent(to: &mut Differences, [by, low, high]: [f64; 3], name: &str, rows: &Rows) {
    to.add(by - (high - low), by, "", || format!("range of {name}"));
    let Some(values) = rows.columns.get(name) else {
        to.fail(format!("the range of {name} has no column"));
        return;
    };
    let beyond = values.iter().map(|v| (low - v).max(v - high));
    // An end that is but rounding is written as zero.
    let beyond = beyond.fold(0.0_f64, f64::max) - ROUNDING * by;
    to.add(beyond.max(0.0), by, "", || {
        format!("rows beyond the range of {name}")
    });
}

/// What turns and what travels most is among what is named.
fn add_named(to: &mut Differences, summary: &Value, reading: &Reading, named: &[(String, f64)]) {
    let extrema = summary["extrema"].as_array().map_or(&[][..], Vec::as_slice);
    for (end, unit, size) in [(".angle", "rad", 1.0), (".travel", "m", reading.size())] {
        let of_kind = extrema.iter().filter(|entry| {
            let quantity = entry["quantity"].as_str().unwrap_or("");
            quantity.ends_with(end) && entry["unit"].as_str() == Some(unit)
        });
        let extent = |entry: &Value| {
            let of = |end: &str| entry[end]["value"].as_f64();
            Some(of("max")? - of("min")?)
        };
        let largest = of_kind.filter_map(extent).fold(0.0, f64::max);
        if largest <= ROUNDING * size {
            continue;
        }
        let listed = named.iter().filter(|(of, _)| of == unit);
        let most = listed.fold(0.0_f64, |max, (_, by)| max.max(*by));
        to.add(
            (largest - most - SAME * largest).max(0.0),
            largest,
            unit_of(unit),
            || format!("the largest extent of all columns `*{end}`"),
        );
    }
}

fn unit_of(unit: &str) -> &'static str {
    if unit == "rad" { "rad" } else { "m" }
}
