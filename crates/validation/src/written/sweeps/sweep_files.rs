//! The findings over sweeps of a case: masses of its bodies, one by a grid, one drawn of a normal and one of an even
//! distribution; and a coordinate of one of its points.

use super::draws::{distance, normal, normal_distribution, uniform};
use super::motion_results::{VariedMass, motion_differences};
use super::statistics::Stated;
use crate::written::motions::sentences;
use crate::written::poses::compared::Compared;
use crate::written::poses::difference::Differences;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::reading::{Body, Reading};
use crate::written::poses::rows::Rows;
use crate::written::poses::scene_text::{Draws, requests_everything, text_of};
use crate::written::poses::variants::{beyond_rows, with_number};
use toml::{Table, Value};

/// Samples of every value of the grid.
const SAMPLES: usize = 192;
/// Values of the grid.
const VALUES: usize = 3;
/// Rows that `reduce` repeats.
const REPEATED: usize = 2;
/// √n times the distance from its distribution that one sample in 8000 exceeds (Smirnov, 1948).
const LARGEST_DISTANCE: f64 = 2.2;

/// How a mass varies, in the unit of the scene.
#[derive(Debug, Clone, Copy)]
enum Varied {
    Normal { mean: f64, deviation: f64 },
    Even { nominal: f64, percent: f64 },
    Grid { from: f64, to: f64 },
}

/// A mass of the scene that varies.
#[derive(Debug)]
struct Variation {
    body: String,
    varied: Varied,
}

/// Runs `sweep` on a scene with one actuator, and compares what it writes.
// Long because it is the list of all that a sweep writes.
pub(crate) fn compare(
    compared: &mut Compared,
    program: &Program,
    scene: &str,
) -> Result<(), String> {
    let reading = Reading::new(scene)?;
    let everything = requests_everything(scene)?;
    let mut draws = Draws::of(&format!("{scene}sweep"));
    let variations = variations(&everything, &reading, &mut draws);
    if reading.actuator_count != 1 || variations.is_empty() {
        return Ok(());
    }
    let seed = draws.below(1_000_000) as u64;
    let mut arguments: Vec<String> = ["sweep", "--result", "m"].map(str::to_owned).into();
    for variation in &variations {
        arguments.extend(["--vary".to_owned(), variation.text()]);
    }
    let counts = [SAMPLES.to_string(), seed.to_string()];
    arguments.extend(["--samples", &counts[0], "--seed", &counts[1]].map(str::to_owned));
    let mut arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    arguments.extend(["--export", "csv"]);
    let run = program.run("sweep", &text_of(&everything)?, &arguments)?;
    let rows = run.csv("-sweep.csv")?;
    compare_draws(compared, &variations, &rows, seed);
    // A second run, in another folder.
    *arguments.last_mut().ok_or("no arguments")? = "npz";
    let stored = program.run("sweep-again", &text_of(&everything)?, &arguments)?;
    compared.merge("written-sweep-files", same_files(&stored, &rows)?);
    let summary = run.json("-sweep.json")?;
    let mut results = ["m.min", "m.max"].into_iter();
    let is_whole = results.all(|name| rows.column(name).iter().all(|value| value.is_finite()));
    if is_whole && run.printed.contains("could not be computed completely") {
        let reason = "`sweep` says that points failed, and every row has its numbers";
        compared.fail("written-sweep-sentences", reason.to_owned());
    }
    let inputs: Vec<String> = variations.iter().map(Variation::path).collect();
    let mut stated = Stated::default();
    for result in ["m.min", "m.max"] {
        stated.add((&summary, &run.printed), &rows, (result, &inputs));
    }
    let count = format!("({} computed)", rows.count);
    if !run.printed.contains(&count) {
        stated
            .sentences
            .fail(format!("`sweep` does not print {count}"));
    }
    compared.merge("written-sweep-summary", stated.summary);
    compared.merge("written-sweep-sentences", stated.sentences);
    compared.merge("written-sweep-sentences", sentences(&run, &summary));
    for _ in 0..REPEATED {
        let row = draws.below(rows.count);
        let mut changed = everything.clone();
        for variation in &variations {
            let value = rows.get(row, &variation.path()).unwrap_or(f64::NAN);
            let path = ["bodies", &variation.body, "mass"];
            changed = with_number(&changed, &path, value).ok_or("the body has no mass")?;
        }
        compare_row(compared, program, &changed, (&rows, row))?;
    }
    if let Some(variation) = variations.first() {
        let motion = motion_differences(program, &everything, &near(&reading, variation))?;
        compared.merge("written-sweep-motion", motion);
    }
    compare_dimension(compared, program, &everything, &mut draws)
}

/// Two values near that of a mass of the scene.
fn near<'v>(reading: &Reading, variation: &'v Variation) -> VariedMass<'v> {
    let mut bodies = reading.bodies.iter();
    let body = bodies.find(|body| body.name == variation.body);
    let nominal = body.map_or(f64::NAN, |body| body.mass / reading.units.mass);
    VariedMass {
        body: &variation.body,
        values: [0.96 * nominal, 1.05 * nominal],
    }
}

/// A coordinate of a point that is drawn, at two values next to that of the scene; a variant that cannot be assembled has no row to compare.
fn compare_dimension(
    compared: &mut Compared,
    program: &Program,
    scene: &Table,
    draws: &mut Draws,
) -> Result<(), String> {
    let coordinates = coordinates(scene);
    if coordinates.is_empty() {
        return Ok(());
    }
    let (body, point, value) = &coordinates[draws.below(coordinates.len())];
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
    let tables = |value: Option<&Value>| value.and_then(Value::as_table).cloned();
    let mut found = Vec::new();
    for (body, keys) in tables(scene.get("bodies")).unwrap_or_default() {
        for (point, at) in tables(keys.get("points")).unwrap_or_default() {
            let first = at.as_array().and_then(|at| at.first());
            let number = first.and_then(|x| x.as_float().or(x.as_integer().map(|x| x as f64)));
            if let Some(value) = number.filter(|x| *x != 0.0) {
                found.push((body.clone(), point, value));
            }
        }
    }
    found
}

/// Up to three masses of the scene, in a drawn order.
fn variations(scene: &Table, reading: &Reading, draws: &mut Draws) -> Vec<Variation> {
    let is_written = |body: &str| {
        let bodies = scene.get("bodies").and_then(|bodies| bodies.get(body));
        bodies.and_then(|body| body.get("mass")).is_some()
    };
    let massive = reading.bodies.iter();
    let massive = massive.filter(|body| body.mass > 0.0 && is_written(&body.name));
    let mut bodies: Vec<_> = massive.collect();
    let mut drawn = Vec::new();
    while !bodies.is_empty() && drawn.len() < 3 {
        drawn.push(bodies.swap_remove(draws.below(bodies.len())));
    }
    let variation = |(k, body): (usize, &Body)| {
        let nominal = body.mass / reading.units.mass;
        Variation {
            body: body.name.clone(),
            varied: match k {
                0 => Varied::Normal {
                    mean: nominal,
                    deviation: 0.03 * nominal,
                },
                1 => Varied::Even {
                    nominal,
                    percent: 8.0,
                },
                _ => Varied::Grid {
                    from: 0.8 * nominal,
                    to: 1.3 * nominal,
                },
            },
        }
    };
    drawn.into_iter().enumerate().map(variation).collect()
}

impl Variation {
    /// The path of its number.
    fn path(&self) -> String {
        format!("{}.mass", self.body)
    }

    /// As the command line states it.
    fn text(&self) -> String {
        let path = self.path();
        match self.varied {
            Varied::Normal { mean, deviation } => format!("{path}~normal({mean:?},{deviation:?})"),
            Varied::Even { percent, .. } => format!("{path}±{percent}%"),
            Varied::Grid { from, to } => format!("{path}={from:?}:{to:?}:{VALUES}"),
        }
    }

    /// Its value in a row, by the second generator; `axis` is its number among all.
    fn value(&self, row: usize, (seed, axis): (u64, usize)) -> f64 {
        let uniform = uniform(
            seed,
            u32::try_from(axis).unwrap_or(0),
            (row % SAMPLES) as u64,
        );
        match self.varied {
            Varied::Normal { mean, deviation } => mean + deviation * normal(uniform),
            Varied::Even { nominal, percent } => {
                nominal * (1.0 + percent / 100.0 * (2.0 * uniform[0] - 1.0))
            }
            Varied::Grid { from, to } => {
                from + (to - from) * (row / SAMPLES) as f64 / (VALUES - 1) as f64
            }
        }
    }

    /// The part of all values that is below a value; none of a grid.
    fn share_below(&self, value: f64) -> Option<f64> {
        match self.varied {
            Varied::Normal { mean, deviation } => {
                Some(normal_distribution((value - mean) / deviation))
            }
            Varied::Even { nominal, percent } => {
                let width = 2.0 * percent / 100.0 * nominal;
                Some((0.5 + (value - nominal) / width).clamp(0.0, 1.0))
            }
            Varied::Grid { .. } => None,
        }
    }
}

/// The varied numbers of all rows.
fn compare_draws(compared: &mut Compared, variations: &[Variation], rows: &Rows, seed: u64) {
    let grids = variations
        .iter()
        .filter(|v| matches!(v.varied, Varied::Grid { .. }));
    let points = SAMPLES * VALUES.pow(u32::try_from(grids.count()).unwrap_or(0));
    compared.add(
        "written-sweep-draws",
        rows.count as f64 - points as f64,
        1.0,
        "",
        || "number of points",
    );
    for (axis, variation) in variations.iter().enumerate() {
        let Some(column) = rows.columns.get(&variation.path()) else {
            compared.fail(
                "written-sweep-draws",
                format!("no column {}", variation.path()),
            );
            continue;
        };
        for (row, value) in column.iter().enumerate() {
            let expected = variation.value(row, (seed, axis));
            let place = || format!("{}, point {row}", variation.path());
            compared.add("written-sweep-draws", value - expected, expected, "", place);
        }
        let first = &column[..SAMPLES.min(column.len())];
        if let Some(value) = first.first()
            && variation.share_below(*value).is_some()
        {
            let share = |value: f64| variation.share_below(value).unwrap_or(f64::NAN);
            let distance = distance(first.to_vec(), share);
            compared.add(
                "written-sweep-distribution",
                distance,
                LARGEST_DISTANCE,
                "",
                || variation.text(),
            );
        }
    }
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
