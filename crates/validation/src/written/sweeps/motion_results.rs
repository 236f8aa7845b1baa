//! The results of motions in a sweep: the end, the largest size, the mean and the root mean square of a column, against the rows of
//! `simulate` on the changed scene.

use crate::written::poses::difference::Differences;
use crate::written::poses::program::Program;
use crate::written::poses::rows::{Rows, largest};
use crate::written::poses::scene_text::{text_of, with_number};
use serde_json::Value;
use toml::Table;

/// A mass of the scene with two values near its own.
pub(super) struct VariedMass<'a> {
    pub(super) body: &'a str,
    pub(super) values: [f64; 2],
}

/// Sweeps the mass and compares the second row; skipped if the scene has no free motion.
pub(super) fn motion_differences(
    program: &Program,
    scene: &Table,
    mass: &VariedMass<'_>,
) -> Result<Differences, String> {
    let mut all = Differences::default();
    if !scene.contains_key("motion") {
        return Ok(all);
    }
    let [first, second] = mass.values;
    let vary = format!("{}.mass={first:?},{second:?}", mass.body);
    let arguments = ["sweep", "--result", "motion", "--vary", &vary];
    let run = program.run("sweep-motion", &text_of(scene)?, &arguments)?;
    // Messages have commas: the Parquet files have them in a column of their own.
    let swept = run.parquet("-sweep")?;
    let changed = with_number(scene, &["bodies", mass.body, "mass"], second);
    let changed = changed.ok_or("the body has no mass")?;
    let single = program.run("point-motion", &text_of(&changed)?, &["simulate"])?;
    let rows = single.csv("-motion.csv")?;
    let summary = single.json("-simulate.json")?;
    for (name, values) in swept
        .columns
        .iter()
        .filter(|(name, _)| name.starts_with("motion."))
    {
        let value = values.get(1).copied().unwrap_or(f64::NAN);
        let Some((column, what)) = name.trim_start_matches("motion.").rsplit_once('.') else {
            // The end of the motion itself.
            let end = rows.end();
            all.add(value - end, end, "", || name.clone());
            continue;
        };
        match expected(&rows, &summary, column, what) {
            Some([expected, scale]) => all.add(value - expected, scale, "", || name.clone()),
            None => all.fail(format!("`simulate` has no column for {name}")),
        }
    }
    if all.count() == 0 {
        all.fail("`sweep` has no results of the motion");
    }
    Ok(all)
}

/// The value of a result from the rows, and the largest size of its column.
fn expected(rows: &Rows, summary: &Value, column: &str, what: &str) -> Option<[f64; 2]> {
    let [values, times] = [column, "t"].map(|name| rows.columns.get(name));
    let (values, times) = (values?, times?);
    let extrema = summary["extrema"].as_array()?.iter();
    let of_column = extrema.filter(|entry| entry["quantity"] == column);
    let ends = of_column.flat_map(|entry| ["min", "max"].map(|end| entry[end]["value"].as_f64()));
    let between: Vec<f64> = ends.flatten().collect();
    let largest = largest(values.iter().chain(&between));
    // By trapezoids, as the rows are joined in a picture.
    let mean = |of: fn(f64) -> f64| {
        let pieces = (1..values.len())
            .map(|k| 0.5 * (times[k] - times[k - 1]) * (of(values[k - 1]) + of(values[k])));
        pieces.sum::<f64>() / (times.last().unwrap_or(&0.0) - times.first().unwrap_or(&0.0))
    };
    let value = match what {
        "end" => *values.last()?,
        "max_abs" => largest,
        "mean" => mean(|v| v),
        "rms" => mean(|v| v * v).sqrt(),
        _ => return None,
    };
    Some([value, largest])
}
