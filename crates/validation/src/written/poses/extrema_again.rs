//! The extrema of two runs over the same motion whose rows are at other places: between rows they are found by the motion itself, so that
//! they are the same.

use super::difference::Differences;
use super::largest_values::scales;
use serde_json::Value;

/// Columns whose extrema are those of their rows: columns that jump, or are zero over zero at the start, errors, columns that are infinite
/// in some positions, and rotations in space.
const OF_ROWS: [&str; 7] = [
    ".direction",
    ".efficiency",
    "mechanical_advantage",
    "pole",
    "balance",
    "residual",
    ".rotation.",
];

/// The extrema of two summaries, each relative to the largest of its unit.
pub(crate) fn same_extrema([one, other]: [&Value; 2], what: &str) -> Differences {
    let mut to = Differences::default();
    let list = |of: &Value| of["extrema"].as_array().cloned().unwrap_or_default();
    let (first, second) = (list(one), list(other));
    let scales = scales(&second);
    for entry in &first {
        let quantity = entry["quantity"].as_str().unwrap_or("");
        if OF_ROWS.iter().any(|part| quantity.contains(part)) {
            continue;
        }
        let again = second.iter().find(|e| e["quantity"] == entry["quantity"]);
        let Some(again) = again else {
            to.fail(format!(
                "{what}: {quantity} has an extremum in one run alone"
            ));
            continue;
        };
        let unit = entry["unit"].as_str().unwrap_or("");
        let scale = scales.get(unit).copied().unwrap_or(0.0);
        for end in ["min", "max"] {
            let of = |entry: &Value| entry[end]["value"].as_f64().unwrap_or(f64::NAN);
            to.add(of(entry) - of(again), scale, "", || {
                format!("{what}, {end} of {quantity}")
            });
        }
    }
    to
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_extremum_that_other_rows_miss_is_found() {
        let of = |max: f64| {
            serde_json::json!({ "extrema": [
                { "quantity": "A.x", "unit": "N", "min": { "value": -2.0 }, "max": { "value": max } }] })
        };
        assert_eq!(
            same_extrema([&of(1.0), &of(1.0)], "simulate").largest(),
            0.0
        );
        assert!(same_extrema([&of(1.0), &of(0.9)], "simulate").largest() > 0.04);
        let none = serde_json::json!({ "extrema": [] });
        assert!(
            same_extrema([&of(1.0), &none], "simulate")
                .failure()
                .is_some()
        );
    }
}
