//! The checks of sweeps of a case: masses of its bodies, one from a normal distribution, one from a uniform distribution, one from a grid;
//! a coordinate of one of its points; and its motion.

use super::motion_results::{VariedMass, motion_differences};
use crate::written::poses::compared::Compared;
use crate::written::poses::difference::Differences;
use crate::written::poses::printed_numbers::sentences;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::rows::{Rows, largest};
use crate::written::poses::scene_text::{Scene, entries, number, text_of, with_number};
use crate::written::poses::stated::{expected, sentence_differences};
use serde_json::Value as Json;
use toml::{Table, Value};

/// Runs `sweep` on a scene with one actuator, and compares its files.
pub(crate) fn compare(
    compared: &mut Compared,
    program: &Program,
    scene: &Scene,
) -> Result<(), String> {
    let everything = scene.everything();
    let of_body = |(body, keys): (&String, &Table)| {
        let mass = number(keys.get("mass")).filter(|mass| *mass > 0.0)?;
        Some((body.clone(), mass))
    };
    let masses: Vec<(String, f64)> = scene.moving_bodies().filter_map(of_body).collect();
    let ([_], Some((body, nominal))) = (&scene.actuators[..], masses.first()) else {
        return Ok(());
    };
    let variations = masses.iter().enumerate().take(3).map(|(k, (body, mass))| {
        let [low, high] = [0.8 * mass, 1.3 * mass];
        match k {
            0 => format!("{body}.mass~normal({mass:?},{:?})", 0.03 * mass),
            1 => format!("{body}.mass±8%"),
            _ => format!("{body}.mass={low:?}:{high:?}:3"),
        }
    });
    let variations: Vec<String> = variations.collect();
    let mut arguments = vec!["sweep", "--result", "m", "--samples", "24", "--seed", "7"];
    for variation in &variations {
        arguments.extend(["--vary", variation]);
    }
    let text = text_of(&everything)?;
    let run = program.run(
        "sweep",
        &text,
        &[&arguments[..], &["--export", "csv"]].concat(),
    )?;
    let rows = run.csv("-sweep.csv")?;
    // A second run, in another folder.
    let arguments = [&arguments[..], &["--export", "npz"]].concat();
    let stored = program.run("sweep-again", &text, &arguments)?;
    compared.merge("written-sweep-files", same_files(&stored, &rows)?);
    let varied: Vec<String> = masses
        .iter()
        .take(3)
        .map(|(b, _)| format!("{b}.mass"))
        .collect();
    compare_sentences(compared.of("written-sweep-sentences"), &run, &rows, &varied)?;
    let mass = VariedMass {
        body,
        values: [0.96 * nominal, 1.05 * nominal],
    };
    let motion = motion_differences(program, &everything, &mass)?;
    compared.merge("written-sweep-motion", motion);
    compare_dimension(compared, program, &everything)
}

/// The lines about each result and its places, how many points there are, and whether some failed.
fn compare_sentences(
    to: &mut Differences,
    run: &Run,
    rows: &Rows,
    varied: &[String],
) -> Result<(), String> {
    let summary = run.json("-sweep.json")?;
    let mut is_whole = true;
    for name in ["m.min", "m.max"] {
        is_whole &= rows.column(name).iter().all(|value| value.is_finite());
        add_result(to, &run.printed, &summary, name, varied);
    }
    to.require(
        !is_whole || !run.printed.contains("could not be computed completely"),
        || "`sweep` says that points failed, and every row has its numbers".to_owned(),
    );
    let count = format!("({} computed)", rows.count);
    to.require(run.printed.contains(&count), || {
        format!("`sweep` does not print {count}")
    });
    to.merge(sentences(run, &summary));
    Ok(())
}

/// The line that begins with a result, and the one below it about its places.
fn add_result(to: &mut Differences, printed: &str, summary: &Json, name: &str, varied: &[String]) {
    let number = |end: &str| expected(summary, &[&format!("{name}.{end}")], 1.0);
    let ends = [
        "smallest",
        "largest",
        "mean",
        "mean.standard_error",
        "standard_deviation",
    ];
    let mut values: Vec<_> = ends
        .iter()
        .filter_map(|end| number(end))
        .flatten()
        .collect();
    values.push((95.0, 95.0));
    let quantiles = ["quantile_2.5", "quantile_97.5"].iter();
    values.extend(quantiles.filter_map(|end| number(end)).flatten());
    to.require(values.len() == 8, || {
        format!("the summary has no statistics of {name}")
    });
    let start = format!("{name} [");
    let below = printed.split(&start).nth(1).unwrap_or("");
    let ends = ["smallest", "largest"].into_iter();
    let places = ends.flat_map(|end| varied.iter().map(move |at| format!("{end}.{at}")));
    // Where a result is always the same, it has no place.
    let places: Option<Vec<_>> = places.map(|place| number(&place)).collect();
    let line = [(start, values)];
    to.merge(sentence_differences(printed, &line, "sweep"));
    if let Some(places) = places {
        let line = [("smallest at ".to_owned(), places.concat())];
        to.merge(sentence_differences(below, &line, "sweep"));
    }
}

/// Varies a nonzero coordinate of a point at two values next to that of the scene; a variant that cannot be assembled has no row to
/// compare.
fn compare_dimension(
    compared: &mut Compared,
    program: &Program,
    scene: &Table,
) -> Result<(), String> {
    let coordinates = coordinates(scene);
    let Some((body, point, value)) = coordinates.get(coordinates.len() / 2) else {
        return Ok(());
    };
    let values = [0.998 * value, 1.001 * value];
    let [low, high] = values;
    let vary = format!("{body}.points.{point}[0]={low:?},{high:?}");
    let arguments = ["sweep", "--result", "m", "--vary", &vary];
    let run = program.run("sweep-dimension", &text_of(scene)?, &arguments)?;
    // Messages have commas: the Parquet files have them in a column of their own.
    let rows = run.parquet("-sweep")?;
    for (row, value) in values.into_iter().enumerate() {
        if rows.get(row, "m.min").is_some_and(f64::is_finite) {
            let changed = with_number(scene, &["bodies", body, "points", point, "0"], value);
            let changed = changed.ok_or("the point has no coordinate")?;
            compare_row(compared, program, &changed, (&rows, row))?;
        }
    }
    Ok(())
}

/// The first coordinates of all points that are not zero: body, point, value.
fn coordinates(scene: &Table) -> Vec<(String, String, f64)> {
    let of_body = |(body, keys): (&String, &Table)| -> Vec<(String, String, f64)> {
        let points = keys.get("points").and_then(Value::as_table);
        let first = |(point, at): (&String, &Value)| {
            let value = number(at.as_array()?.first())?;
            (value != 0.0).then(|| (body.clone(), point.clone(), value))
        };
        points.into_iter().flatten().filter_map(first).collect()
    };
    entries(scene, "bodies").flat_map(of_body).collect()
}

/// The archive and the Parquet files of a second run, each with the table of the first.
fn same_files(run: &Run, rows: &Rows) -> Result<Differences, String> {
    let mut same = Differences::default();
    for (file, other) in [
        ("NPZ", run.npz("-sweep.npz")?),
        ("Parquet", run.parquet("-sweep")?),
    ] {
        for (name, column) in rows.columns.iter().filter(|(name, _)| *name != "message") {
            let Some(values) = other.columns.get(name).filter(|v| v.len() == column.len()) else {
                same.fail(format!("{file} has not the rows of {name}"));
                continue;
            };
            for (row, (value, expected)) in values.iter().zip(column).enumerate() {
                let place = || format!("{file}, {name}, point {row}");
                same.add(value - expected, *expected, "", place);
            }
        }
    }
    Ok(same)
}

/// A row with a run of `reduce` on the scene with its numbers.
fn compare_row(
    compared: &mut Compared,
    program: &Program,
    changed: &Table,
    (rows, row): (&Rows, usize),
) -> Result<(), String> {
    let single = program.run("point", &text_of(changed)?, &["reduce"])?;
    let single = single.csv("-reduced.csv")?;
    let m = single.columns.get("m").ok_or("`reduce` has no m")?;
    for (name, sign) in [("m.min", -1.0), ("m.max", 1.0)] {
        let value = rows.get(row, name).unwrap_or(f64::NAN);
        let (beyond, scale) = beyond_rows(m, value, sign);
        let place = || format!("point {row}, {name}");
        compared.add("written-sweep", beyond, scale, "kg m2", place);
    }
    Ok(())
}

/// By how much an extremum is not between the highest row and a parabola's height above it, which is at most an eighth of
/// the second difference there; and the largest value.
fn beyond_rows(values: &[f64], extremum: f64, sign: f64) -> (f64, f64) {
    let of = |k: usize| sign * values[k];
    let highest = (0..values.len())
        .max_by(|a, b| of(*a).total_cmp(&of(*b)))
        .unwrap_or(0);
    let last = values.len() - 1;
    let neighbours = [
        highest.checked_sub(1).unwrap_or(last - 1),
        if highest == last { 1 } else { highest + 1 },
    ];
    let bend = neighbours.map(|k| of(highest) - of(k)).iter().sum::<f64>();
    let above = sign * extremum - of(highest);
    // Twice the eighth: the curve is no parabola.
    ((-above).max(above - 0.25 * bend).max(0.0), largest(values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_extremum_is_at_its_row_or_little_above() {
        let values: Vec<f64> = (0..=62)
            .map(|k| (f64::from(k) * 0.1 + 0.03).cos())
            .collect();
        let (beyond, _) = beyond_rows(&values, 1.0, 1.0);
        assert_eq!(beyond, 0.0);
        for wrong in [1.02, 0.97] {
            assert!(beyond_rows(&values, wrong, 1.0).0 > 1e-3, "{wrong}");
        }
    }
}
