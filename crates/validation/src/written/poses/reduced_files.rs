//! The files of `reduce`, and other outputs with the same numbers: `runs`, fewer rows, requested columns, generated
//! code and formulas.

use super::compared::Compared;
use super::difference::Differences;
use super::generated_code::code_differences;
use super::printed_formulas::formula_differences;
use super::program::Program;
use super::rows::Rows;
use super::same_columns::same_columns;
use super::scene_text::{Scene, entries, text_of};
use super::stated::{expected, sentence_differences};
use toml::Table;

/// Rows of `reduce`.
const POINTS: &str = "261";

/// Runs `reduce` and related commands on a scene with one actuator, unchanged and with everything requested.
pub(super) fn compare_reduced(
    compared: &mut Compared,
    program: &Program,
    (scene, everything): (&Scene, &Table),
) -> Result<(), String> {
    let everything = &text_of(everything)?;
    let run = |name: &str, scene: &str, command: &str| {
        program.run(name, scene, &[command, "--points", POINTS])
    };
    let whole = run("reduce", everything, "reduce")?;
    let all = whole.csv("-reduced.csv")?;
    let found = compared.of("written-sentences");
    let summary = whole.json("-reduce.json")?;
    let lines = [("m", "m    from "), ("half_dm", "½m′  from ")];
    let lines = lines.into_iter().filter_map(|(name, line)| {
        let ends = ["min", "max"].map(|end| format!("{name}.{end}"));
        let numbers = expected(&summary, &[&ends[0], &ends[1]], 1.0)?;
        Some((line.to_owned(), numbers))
    });
    let lines: Vec<_> = lines.collect();
    found.require(lines.len() == 2, || {
        "the summary of `reduce` has no m or ½m′".to_owned()
    });
    found.merge(sentence_differences(&whole.printed, &lines, "reduce"));
    let coordinate = &scene.actuators[0].name;
    // In space the search between few positions may stop at the second of two peaks.
    if !scene.is_in_space() {
        compare_peak(found, program, (everything, coordinate), &all)?;
    }
    let runs = run("runs", everything, "runs")?;
    let both = [&runs.csv("-run-i.csv")?, &runs.csv("-run-ii.csv")?];
    found.merge(run_sentences(&runs.printed, both));
    if both[1].count != all.count {
        let counts = format!("{} rows where `reduce` has {}", both[1].count, all.count);
        compared.fail("written-runs", format!("run ii has {counts}"));
    }
    let requested = run("requested", &text_of(&scene.table)?, "reduce")?;
    let mut requested = requested.npz("-reduced.npz")?;
    // In space axes can be requested that are not written without a request.
    if scene.is_in_space() {
        requested
            .columns
            .retain(|name, _| all.columns.contains_key(name));
    }
    let same = same_columns(&requested, &all, "the requested file of `reduce`");
    compared.merge("written-runs", same);
    let reaction = entries(&scene.table, "joints")
        .map(|(joint, _)| format!("{joint}.x"))
        .find(|reaction| all.columns.contains_key(&format!("{reaction}.a")));
    match reaction {
        Some(reaction) => {
            compare_code(compared, program, everything, (&all, coordinate, &reaction))
        }
        None => Ok(()),
    }
}

/// Speed or acceleration, the end and the number of columns of both runs.
fn run_sentences(printed: &str, both: [&Rows; 2]) -> Differences {
    let starts = ["run i: speed ", "run ii: acceleration "];
    let lines = starts.into_iter().zip(both).map(|(start, rows)| {
        let end = rows.end();
        let columns = rows.columns.len() as f64;
        let numbers = [1.0, end, columns].map(|number| (number, number));
        (start.to_owned(), numbers.to_vec())
    });
    sentence_differences(printed, &lines.collect::<Vec<_>>(), "runs")
}

/// Positions of a file of `reduce` that miss the largest m.
const FEW_POINTS: &str = "7";
/// Largest fraction of the largest m that may be missing between many rows.
const BETWEEN_ROWS: f64 = 1e-2;

/// If few rows miss the largest m, `reduce` states its size: not smaller than in many rows, and at the same position.
fn compare_peak(
    to: &mut Differences,
    program: &Program,
    (text, coordinate): (&str, &str),
    many: &Rows,
) -> Result<(), String> {
    let few = program.run("few", text, &["reduce", "--points", FEW_POINTS])?;
    let said = few.printed.lines();
    let line = said
        .map(str::trim)
        .find_map(|line| line.strip_prefix("between these positions m reaches "));
    let Some(line) = line else {
        return Ok(());
    };
    let first = |text: &str| text.split([' ', ',']).next()?.parse::<f64>().ok();
    let place = line.split_once(" = ").and_then(|(_, rest)| first(rest));
    let columns = [coordinate, "m"].map(|name| many.columns.get(name));
    let (Some(value), Some(place), [Some(q), Some(m)]) = (first(line), place, columns) else {
        to.fail(format!("`reduce` says `{line}`"));
        return Ok(());
    };
    let largest = m.iter().fold(f64::NEG_INFINITY, |max, m| max.max(*m));
    let outside = (largest - value).max(value - largest * (1.0 + BETWEEN_ROWS));
    // Printed are the digits that its error leaves.
    to.add((outside - 1e-6 * largest).max(0.0), largest, "", || {
        format!("`{line}`")
    });
    let step = q
        .windows(2)
        .fold(0.0_f64, |max, pair| max.max((pair[1] - pair[0]).abs()));
    let near = q
        .iter()
        .zip(m)
        .filter(|(q, _)| (*q - place).abs() <= 1.01 * step);
    let here = near.fold(f64::NEG_INFINITY, |max, (_, m)| max.max(*m));
    to.add(largest - here, largest, "", || {
        format!("the place of `{line}`")
    });
    Ok(())
}

/// Differences of a text of `symbolic` from the rows of `reduce`, in a coordinate, with a reaction.
type Comparison = fn(&str, &Rows, &str, &str) -> Differences;

/// The reduced model as code in three languages, and as formulas.
fn compare_code(
    compared: &mut Compared,
    program: &Program,
    text: &str,
    (rows, coordinate, reaction): (&Rows, &str, &str),
) -> Result<(), String> {
    for (format, end) in [
        ("python", "-symbolic.py"),
        ("c", "-symbolic.c"),
        ("rust", "-symbolic.rs"),
        ("latex", "-symbolic.md"),
    ] {
        let arguments = ["symbolic", "--format", format, "--reaction", reaction];
        match program.run("code", text, &arguments) {
            Ok(run) => {
                let code = run.text(end)?;
                let (key, differences): (_, Comparison) = match format {
                    "latex" => ("written-formulas", formula_differences),
                    _ => ("written-code", code_differences),
                };
                compared.merge(key, differences(&code, rows, coordinate, reaction));
            }
            // Not every mechanism has a closed form, and none in space; then the command says so.
            Err(e) if e.contains("closed form") || e.contains("in space") => {}
            Err(e) => compared.fail("written-code", e),
        }
    }
    Ok(())
}
