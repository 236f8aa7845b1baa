//! The same numbers in the files and sentences of one run: CSV against NPZ, extrema of the summary against the rows, and
//! printed sentences against the summary.

use super::difference::Differences;
use super::largest_values::add_largest;
use super::program::Run;
use super::rows::Rows;
use super::units::{ANGLES, LENGTHS};
use serde_json::Value;
use std::collections::BTreeMap;

/// Differences between the files of a run.
#[derive(Debug, Default)]
pub(crate) struct Formats {
    /// CSV and NPZ, and rows beyond extrema of the summary.
    pub(crate) files: Differences,
    /// Extrema of the summary against interpolated rows.
    pub(crate) extrema: Differences,
    /// Slopes of interpolated rows at the places of extrema, over one row.
    pub(crate) places: Differences,
    /// Printed numbers.
    pub(crate) printed: Differences,
}

/// Judges `NAME-STEM.csv`, `NAME-STEM.npz` and `NAME-COMMAND.json` of a run.
pub(crate) fn formats(
    run: &Run,
    stem: &str,
    command: &str,
    corners: &[f64],
) -> Result<Formats, String> {
    let (csv, npz) = (
        run.csv(&format!("-{stem}.csv"))?,
        run.npz(&format!("-{stem}.npz"))?,
    );
    let summary = run.json(&format!("-{command}.json"))?;
    let headings = run.text(&format!("-{stem}.csv"))?;
    let mut files = same_bits(&csv, &npz, command);
    files.merge(same_headings(&headings, &npz, command));
    let mut found = Formats {
        files,
        ..Formats::default()
    };
    // An impact or a change of a mode makes a corner, too.
    let events = summary["events"].as_array().into_iter().flatten();
    let events = events.filter_map(|event| event["t"].as_f64());
    let corners: Vec<f64> = events.chain(corners.iter().copied()).collect();
    add_extrema(&mut found, &summary, &csv, command, &corners);
    for line in run.printed.lines() {
        add_sentence(&mut found.printed, line, &summary, command);
    }
    add_largest(&mut found.printed, &run.printed, &summary, command);
    Ok(found)
}

/// Every column of one file is in the other, with the same numbers.
fn same_bits(csv: &Rows, npz: &Rows, command: &str) -> Differences {
    let mut all = Differences::default();
    for (name, values) in &csv.columns {
        let others = npz.columns.get(name);
        let Some(others) = others.filter(|others| others.len() == values.len()) else {
            all.fail(format!(
                "{command}: the NPZ file has no column {name} of {} rows",
                values.len()
            ));
            continue;
        };
        for (row, (a, b)) in values.iter().zip(others).enumerate() {
            let difference = if a == b || (a.is_nan() && b.is_nan()) {
                0.0
            } else {
                a - b
            };
            all.add(difference, a.abs(), "", || {
                format!("{command}, row {row}, {name}, CSV and NPZ")
            });
        }
    }
    all
}

/// The headings of the CSV file with the names and units that the archive lists, one by one.
fn same_headings(csv: &str, npz: &Rows, command: &str) -> Differences {
    let mut all = Differences::default();
    let [names, units] = ["columns", "units"].map(|list| npz.words.get(list));
    let (Some(names), Some(units)) = (names, units) else {
        all.fail(format!(
            "{command}: the NPZ file lists no columns and units"
        ));
        return all;
    };
    let heading = |(name, unit): (&String, &String)| match unit.as_str() {
        "" => name.clone(),
        unit => format!("{name} [{unit}]"),
    };
    let listed: Vec<String> = names.iter().zip(units).map(heading).collect();
    let line = csv.lines().find(|line| !line.starts_with('#'));
    let written: Vec<&str> = line.unwrap_or("").split(',').collect();
    let other = written.iter().zip(&listed).find(|(a, b)| **a != b.as_str());
    match other {
        Some((csv, npz)) => all.fail(format!(
            "{command}: CSV has `{csv}` where NPZ lists `{npz}`"
        )),
        None if written.len() != listed.len() => {
            let counts = [written.len(), listed.len()];
            all.fail(format!(
                "{command}: CSV has {} columns, NPZ lists {}",
                counts[0], counts[1]
            ));
        }
        None => {}
    }
    all
}

/// An interpolation's error by its neighbour of a lower order counts this many times; where that is more than this part of
/// the scale, rows are too far apart, and nothing is compared.
const ERROR_FACTOR: f64 = 30.0;
const MAX_ERROR: f64 = 1e-3;

/// Extrema of the motion, also between rows: against a polynomial through the six nearest rows, less its own error by
/// that through four.
// Long because each end of each column is judged in three ways.
fn add_extrema(found: &mut Formats, summary: &Value, rows: &Rows, command: &str, corners: &[f64]) {
    let abscissa = summary["extrema_over"]["name"].as_str().unwrap_or("t");
    let (Some(x), Some(extrema)) = (rows.columns.get(abscissa), summary["extrema"].as_array())
    else {
        return;
    };
    let scales = scales(extrema);
    for entry in extrema {
        let quantity = entry["quantity"].as_str().unwrap_or("");
        let Some(values) = rows.columns.get(quantity) else {
            found.files.fail(format!(
                "{command}: the extremum of {} has no column",
                entry["quantity"]
            ));
            continue;
        };
        let scale = scales
            .get(entry["unit"].as_str().unwrap_or(""))
            .copied()
            .unwrap_or(0.0);
        for (end, sign) in [("min", -1.0), ("max", 1.0)] {
            let number = |key: &str| entry[end][key].as_f64();
            let (Some(value), Some(at)) = (number("value"), number("at")) else {
                found.files.fail(format!(
                    "{command}: {end} of {} is no number",
                    entry["quantity"]
                ));
                continue;
            };
            // What is zero but for rounding is written as zero.
            let is_zero = ["min", "max"]
                .iter()
                .all(|end| entry[end]["value"].as_f64() == Some(0.0));
            let scale = if is_zero { scale.max(1.0) } else { scale };
            let place = || format!("{command}, {end} of {} at {at}", entry["quantity"]);
            // No row is beyond an extremum.
            let beyond = values
                .iter()
                .map(|v| sign * (v - value))
                .fold(0.0, f64::max);
            found.files.add(beyond, scale, "", place);
            // An efficiency begins at rest as zero over zero.
            let is_smooth = ![".magnitude", ".direction", ".friction.", ".efficiency"]
                .iter()
                .any(|part| quantity.contains(part));
            let around = interpolated(x, values, at, corners).filter(|_| is_smooth);
            let Some([near, wide]) = around else {
                continue;
            };
            let error = ERROR_FACTOR * (near.value - wide.value).abs();
            let difference = ((value - wide.value).abs() - error).max(0.0);
            if error < MAX_ERROR * scale {
                found.extrema.add(difference, scale, "", place);
            }
            let error = ERROR_FACTOR * (near.slope - wide.slope).abs();
            let is_inside = x.first().is_some_and(|first| *first < at)
                && x.last().is_some_and(|last| at < *last);
            if is_inside && !is_zero && error < MAX_ERROR * scale && !is_of_rows(quantity) {
                let slope = (wide.slope.abs() - error).max(0.0);
                found.places.add(slope, scale, "", place);
            }
        }
    }
}

/// Whether the extrema of a column are those of its rows: errors, what is infinite in some positions, and rotations in space.
pub(super) fn is_of_rows(quantity: &str) -> bool {
    [
        "mechanical_advantage",
        "pole",
        "balance",
        "residual",
        ".rotation.",
    ]
    .iter()
    .any(|part| quantity.contains(part))
}

/// A polynomial through rows: its value, and its slope times the distance of two rows.
struct Through {
    value: f64,
    slope: f64,
}

/// By unit: the largest extremum. What is zero but for rounding is compared by others of its unit.
pub(super) fn scales(extrema: &[Value]) -> BTreeMap<&str, f64> {
    let mut all = BTreeMap::new();
    for entry in extrema {
        let largest: &mut f64 = all.entry(entry["unit"].as_str().unwrap_or("")).or_default();
        for end in ["min", "max"] {
            *largest = largest.max(entry[end]["value"].as_f64().unwrap_or(0.0).abs());
        }
    }
    all
}

/// Lagrange's polynomials through the four and six rows around a place; none where rows are missing, or not smooth.
fn interpolated(x: &[f64], y: &[f64], at: f64, corners: &[f64]) -> Option<[Through; 2]> {
    /// The part of a row in which a difference is a slope.
    const PART: f64 = 1e-3;
    let next = x.partition_point(|x| *x <= at);
    // Behind a corner of a law the curve is another; a direction jumps by a revolution.
    let nearby = [
        x.get(next.saturating_sub(4)),
        x.get((next + 3).min(x.len() - 1)),
    ];
    if let [Some(low), Some(high)] = nearby
        && corners.iter().any(|c| low <= c && c <= high)
    {
        return None;
    }
    let around = y.get(next.saturating_sub(3)..(next + 3).min(y.len()))?;
    if around
        .windows(2)
        .any(|pair| (pair[1] - pair[0]).abs() > std::f64::consts::PI)
    {
        return None;
    }
    let through = |half: usize| {
        let from = next
            .saturating_sub(half)
            .min(x.len().checked_sub(2 * half)?);
        let rows = from..from + 2 * half;
        let distance = (x[from + 2 * half - 1] - x[from]) / (2 * half - 1) as f64;
        let value = |at: f64| {
            let term = |i: usize| {
                let factors = rows
                    .clone()
                    .filter(|j| *j != i)
                    .map(|j| (at - x[j]) / (x[i] - x[j]));
                y[i] * factors.product::<f64>()
            };
            rows.clone().map(term).sum::<f64>()
        };
        let step = PART * distance;
        Some(Through {
            value: value(at),
            slope: (value(at + step) - value(at - step)) / (2.0 * PART),
        })
    };
    Some([through(2)?, through(3)?])
}

/// `NAME reaches VALUE UNIT at …`, to its printed digits.
fn add_sentence(to: &mut Differences, line: &str, summary: &Value, command: &str) {
    let Some((name, rest)) = line.trim().split_once(" reaches ") else {
        return;
    };
    let Some((said, _)) = rest.split_once(" at ") else {
        return;
    };
    let (number, unit) = said.split_once(' ').unwrap_or((said, ""));
    let extrema = summary["extrema"].as_array();
    let entry = extrema.and_then(|all| {
        all.iter()
            .find(|entry| entry["quantity"].as_str() == Some(name))
    });
    let (Some(entry), Ok(value), Some(factor)) = (entry, number.parse::<f64>(), unit_factor(unit))
    else {
        to.fail(format!(
            "{command} says `{}`, which its summary does not have",
            line.trim()
        ));
        return;
    };
    let ends = ["min", "max"].map(|end| entry[end]["value"].as_f64().unwrap_or(f64::NAN));
    let difference = ends
        .map(|end| (end - value * factor).abs())
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    // Half of the last printed digit is rounding.
    let excess = (difference - 0.5000001 * last_digit(number) * factor).max(0.0);
    to.add(excess, value * factor, "", || {
        format!("{command}, `{}`", line.trim())
    });
}

/// The value of one in the last printed digit.
pub(crate) fn last_digit(number: &str) -> f64 {
    let (digits, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let decimals = digits
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    let exponent: i32 = exponent.parse().unwrap_or(0);
    10_f64.powi(exponent - i32::try_from(decimals).unwrap_or(0))
}

/// A printed unit in SI units: lengths and angles, perhaps in a time or its square; all others are SI.
fn unit_factor(unit: &str) -> Option<f64> {
    let base = unit.split('/').next()?;
    let known = LENGTHS
        .iter()
        .chain(&ANGLES)
        .find(|(name, _)| *name == base);
    Some(known.map_or(1.0, |(_, factor)| *factor))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_digits_are_what_a_number_is_judged_by() {
        assert!((last_digit("128.091") - 1e-3).abs() < 1e-18);
        assert!((last_digit("-2.32246e6") - 10.0).abs() < 1e-12);
        assert_eq!(last_digit("4336"), 1.0);
        let summary = serde_json::json!({ "extrema": [
            { "quantity": "A.x", "min": { "value": -4336.2 }, "max": { "value": 1.0 } }] });
        for (line, agrees) in [
            ("A.x reaches -4336 N at t = 1 s", true),
            ("A.x reaches -4337 N at t = 1 s", false),
        ] {
            let mut found = Differences::default();
            add_sentence(&mut found, line, &summary, "statics");
            assert_eq!(found.largest() == 0.0, agrees, "{line}");
        }
    }
}
