//! The lines `NAME reaches …`: that of each unit the largest value is among them.

use super::difference::Differences;
use serde_json::Value;

/// Values that differ by less than this part of them are the same under another name.
const SAME: f64 = 1e-9;

/// Of each unit that a command lists, the line of the largest extremum of the summary, or that it is not known.
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
