//! The lines `NAME reaches …`: each has an extremum of the summary, and of each unit the largest value is among them.

use super::difference::Differences;
use super::program::Run;
use super::stated::last_digit;
use super::units::{ANGLES, LENGTHS};
use serde_json::Value;
use std::collections::BTreeMap;

/// Values that differ by less than this part of them are the same under another name.
const SAME: f64 = 1e-9;
/// The largest rounding error of positions and forces that a case may state, relative to the largest of a unit; the
/// largest observed is 1e-13.
const MAX_ROUNDING: f64 = 1e-11;

/// The printed extrema of a run.
pub(crate) fn printed_extrema(run: &Run, command: &str) -> Result<Differences, String> {
    let summary = run.json(&format!("-{command}.json"))?;
    let mut found = Differences::default();
    for line in run.printed.lines() {
        add_sentence(&mut found, line, &summary, command);
    }
    add_largest(&mut found, &run.printed, &summary, command);
    add_rounding(&mut found, &run.printed);
    Ok(found)
}

/// By unit: the largest extremum. Values that are zero within rounding are compared by others of their unit.
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

/// A printed unit in SI units: lengths and angles, perhaps in a time or its square; all others are SI.
fn unit_factor(unit: &str) -> Option<f64> {
    let base = unit.split('/').next()?;
    let known = LENGTHS
        .iter()
        .chain(&ANGLES)
        .find(|(name, _)| *name == base);
    Some(known.map_or(1.0, |(_, factor)| *factor))
}

/// The rounding error that a command states of its own values: at most [`MAX_ROUNDING`] of them, so that no extremum is unknown.
fn add_rounding(to: &mut Differences, printed: &str) {
    let line = printed
        .lines()
        .find_map(|line| line.trim().strip_prefix("estimated rounding error below "));
    let stated = line.and_then(|rest| rest.split(' ').next()?.parse::<f64>().ok());
    // None where nothing was held, and all forces are zero.
    if let Some(stated) = stated {
        to.add((stated - MAX_ROUNDING).max(0.0), 1.0, "", || {
            format!("a stated rounding error of {stated:e}")
        });
    }
}

/// For each unit that a command lists: checks that the line has the largest extremum of the summary, or states that it
/// is unknown.
pub(super) fn add_largest(to: &mut Differences, printed: &str, summary: &Value, command: &str) {
    let units: &[&str] = match command {
        "kinematics" => &["rad/s", "m/s", "rad/s2", "m/s2"],
        _ => &["N", "N m", "W"],
    };
    let extrema = summary["extrema"].as_array().map_or(&[][..], Vec::as_slice);
    let size = |entry: &Value| {
        let of = |end: &str| entry[end]["value"].as_f64().map_or(0.0, f64::abs);
        of("min").max(of("max"))
    };
    for unit in units {
        let of_unit = extrema.iter().filter(|entry| {
            let quantity = entry["quantity"].as_str().unwrap_or("");
            entry["unit"].as_str() == Some(unit) && !quantity.contains('@')
        });
        let largest = of_unit.clone().map(size).fold(0.0, f64::max);
        if largest == 0.0 {
            continue;
        }
        let mut named = of_unit
            .filter(|entry| size(entry) >= (1.0 - SAME) * largest)
            .filter_map(|entry| entry["quantity"].as_str());
        let is_said = named.any(|name| {
            let starts = [
                format!("{name} reaches "),
                format!("{name}: its largest value is not known"),
            ];
            let mut lines = printed.lines().map(str::trim_start);
            lines.any(|line| starts.iter().any(|start| line.starts_with(start)))
        });
        to.require(is_said, || {
            format!("`{command}` does not say where {largest} {unit}, the largest of its unit, is reached")
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_digits_are_what_a_number_is_judged_by() {
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

    #[test]
    fn a_missing_line_is_found() {
        let summary = serde_json::json!({ "extrema": [
            { "quantity": "A.x", "unit": "N", "min": { "value": -5.0 }, "max": { "value": 1.0 } },
            { "quantity": "A.y", "unit": "N", "min": { "value": -2.0 }, "max": { "value": 3.0 } }] });
        for (printed, agrees) in [
            ("  A.x reaches -5 N at t = 1 s", true),
            ("  A.y reaches 3 N at t = 1 s", false),
            ("", false),
        ] {
            let mut found = Differences::default();
            add_largest(&mut found, printed, &summary, "statics");
            assert_eq!(found.failure().is_none(), agrees, "{printed}");
        }
    }
}
