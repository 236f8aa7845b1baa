//! The files of `reduce` and what repeats them: runs, tables, generated code, sweeps, and drawn motions.

use super::closure::closure;
use super::described_again::described_again_differences;
use super::difference::Differences;
use super::drawn_laws::drawn_motions;
use super::equilibrium::equilibrium;
use super::generated_code::code_differences;
use super::headings::heading_differences;
use super::overshoot::warning_differences;
use super::positions::Case;
use super::printed_formulas::formula_differences;
use super::program::Run;
use super::range::range_differences;
use super::rates::rates;
use super::reading::Reading;
use super::reduced::{ReducedFiles, reduced};
use super::rows::{Rows, extent, largest};
use super::same_columns::same_columns;
use super::scene_text::{table_of, text_of, value_of, without_forces};
use super::stated::{Expected, result, sentence_differences, summary_differences};
use super::table_file::{table_differences, table_rows};
use super::variants::calibration_differences;

/// Runs `reduce` and its like on a scene with one actuator, as it is and with everything requested.
// Long because it is the list of all files of `reduce` and its like.
pub(super) fn compare_reduced(
    case: &mut Case<'_>,
    [scene, everything]: [&str; 2],
) -> Result<(), String> {
    let (program, reading) = (case.program, case.reading);
    let points = (181 + case.draws.below(180)).to_string();
    let run = |name: &str, scene: &str, command: &str| {
        program.run(name, scene, &[command, "--points", &points])
    };
    let whole_run = run("reduce", everything, "reduce")?;
    let all = whole_run.csv("-reduced.csv")?;
    let file = whole_run.text("-reduced.csv")?;
    let headings = heading_differences(&file, reading, "reduce");
    case.merge("written-headings", headings);
    compare_stated(case, &whole_run, &all)?;
    let contents = program.run("range", everything, &["check"])?;
    let coordinate = &reading.coordinates[0].name;
    let range = range_differences(
        (&contents.json("-check.json")?, &contents.printed),
        &all,
        coordinate,
    );
    case.merge("written-range", range);
    let requested = run("requested", scene, "reduce")?.npz("-reduced.npz")?;
    let swept = swept(everything, reading, &all)?;
    let run_i = run("sweep", &swept, "kinetostatics")?.npz("-kinetostatics.npz")?;
    compare_peak(case, everything, &all)?;
    let runs = run("runs", everything, "runs")?;
    let run_ii = runs.csv("-run-ii.csv")?;
    let both = [&runs.csv("-run-i.csv")?, &run_ii];
    case.merge("written-sentences", run_sentences(&runs.printed, both));
    if run_ii.count != all.count {
        let counts = format!("{} rows where `reduce` has {}", run_ii.count, all.count);
        case.compared
            .fail("written-runs", format!("run ii has {counts}"));
    }
    let files = ReducedFiles {
        reduced: &all,
        run_i: &run_i,
        run_ii: &run_ii,
    };
    let coordinate = &reading.coordinates[0].name;
    let of = reduced(reading, &files, coordinate);
    let range =
        [0, all.count.saturating_sub(1)].map(|row| all.get(row, coordinate).unwrap_or(f64::NAN));
    compare_laws(case, everything, range)?;
    compare_copies(case, everything, &files)?;
    let whole = table_of(everything)?;
    let calibrated = calibration_differences(program, &whole, reading)?;
    case.merge("written-calibration", calibrated);
    case.merge("written-reduced", of.sums);
    case.merge("written-coefficients", of.bodies);
    case.merge("written-slopes", of.slopes);
    case.merge("written-runs", of.runs);
    let same = same_columns(&requested, &all, "the requested file of `reduce`");
    case.merge("written-runs", same);
    for (rows, file) in [(&run_i, "run i"), (&run_ii, "run ii")] {
        case.merge("written-closure", closure(reading, rows, file).joints);
    }
    Ok(())
}

/// Smallest and largest m and ½m′ in the summary and the sentences of `reduce`.
fn compare_stated(case: &mut Case<'_>, run: &Run, rows: &Rows) -> Result<(), String> {
    let summary = run.json("-reduce.json")?;
    let ends = printed_extrema(rows, &summary);
    let named = |(name, [low, high]): &(&str, [Expected; 2])| {
        [("min", *low), ("max", *high)].map(|(end, value)| (format!("{name}.{end}"), value))
    };
    let numbers: Vec<_> = ends.iter().flat_map(named).collect();
    let numbers = numbers.iter().map(|(name, end)| (name.as_str(), *end));
    let summed = summary_differences(&summary, numbers, "reduce");
    case.merge("written-files", summed);
    let lines = ends.iter().zip(["m    from ", "½m′  from "]);
    let lines: Vec<_> = lines
        .map(|((_, ends), line)| (line.to_owned(), ends.to_vec()))
        .collect();
    let printed = sentence_differences(&run.printed, &lines, "reduce");
    case.merge("written-sentences", printed);
    Ok(())
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
/// What many rows may miss of the largest m between them.
const BETWEEN_ROWS: f64 = 1e-2;

/// Where few rows miss the largest m, `reduce` says how large it is: no smaller than in many rows, and where these have it.
fn compare_peak(case: &mut Case<'_>, scene: &str, many: &Rows) -> Result<(), String> {
    let few = case.run("few", scene, &["reduce", "--points", FEW_POINTS])?;
    let said = few.printed.lines();
    let line = said
        .map(str::trim)
        .find_map(|line| line.strip_prefix("between these positions m reaches "));
    let Some(line) = line else {
        return Ok(());
    };
    let found = case.compared.of("written-sentences");
    let first = |text: &str| text.split([' ', ',']).next()?.parse::<f64>().ok();
    let place = line.split_once(" = ").and_then(|(_, rest)| first(rest));
    let columns = [&case.reading.coordinates[0].name, "m"].map(|name| many.columns.get(name));
    let (Some(value), Some(place), [Some(q), Some(m)]) = (first(line), place, columns) else {
        found.fail(format!("`reduce` says `{line}`"));
        return Ok(());
    };
    let largest = m.iter().fold(f64::NEG_INFINITY, |max, m| max.max(*m));
    let outside = (largest - value).max(value - largest * (1.0 + BETWEEN_ROWS));
    // Printed are the digits that its error leaves.
    found.add((outside - 1e-6 * largest).max(0.0), largest, "", || {
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
    found.add(largest - here, largest, "", || {
        format!("the place of `{line}`")
    });
    Ok(())
}

/// What is nowhere above so many times its stated error is zero but for rounding, and so is what is below a part of m.
const ERRORS: f64 = 4.0;
const ROUNDING: f64 = 1e-12;

/// Smallest and largest m and ½m′ of the rows, as `reduce` prints them.
fn printed_extrema(rows: &Rows, summary: &serde_json::Value) -> [(&'static str, [Expected; 2]); 2] {
    let [m, half_dm] = ["m", "half_dm"].map(|name| extent(rows.column(name)));
    let error = result(summary, "rounding_error.half_dm");
    let zero = (ERRORS * error.unwrap_or(0.0)).max(ROUNDING) * largest(&m);
    let half_dm = match largest(&half_dm) <= zero {
        true => [0.0; 2],
        false => half_dm,
    };
    [("m", m), ("half_dm", half_dm)].map(|(name, ends)| {
        let scale = largest(&ends);
        (name, ends.map(|end| (end, scale)))
    })
}

/// The accuracy that tables are asked for.
const TABLE_ACCURACY: &str = "1e-7";

/// Differences of a text of `symbolic` from the rows of `reduce`, in a coordinate, with a reaction.
type Comparison = fn(&str, &Rows, &str, &str) -> Differences;

/// The reduced model once more: as a table, as code in three languages, and as formulas.
// Long because it is the list of all copies of the reduced model.
fn compare_copies(
    case: &mut Case<'_>,
    scene: &str,
    files: &ReducedFiles<'_>,
) -> Result<(), String> {
    let (program, reading) = (case.program, case.reading);
    let (coordinate, rows) = (&reading.coordinates[0].name, files.reduced);
    let arguments = [
        "reduce",
        "--points",
        "3",
        "--table-accuracy",
        TABLE_ACCURACY,
    ];
    match program.run("table", scene, &arguments) {
        Ok(run) => {
            let text = run.text(".table")?;
            case.merge("written-table", table_differences(&text, rows, coordinate));
            let of_table = table_rows(&text, rows, coordinate).ok_or("no rows of the table")?;
            let files = ReducedFiles {
                reduced: &of_table,
                ..*files
            };
            let of = reduced(reading, &files, coordinate);
            case.merge("written-table-sums", of.sums);
            case.merge("written-table-bodies", of.bodies);
        }
        // Not every mechanism has one, as its format says.
        Err(e) if e.contains("tables are of driven angles") || e.contains("no table:") => {}
        Err(e) => case.compared.fail("written-table", e),
    }
    let reaction = reading
        .joints
        .iter()
        .find(|joint| rows.columns.contains_key(&format!("{}.x.a", joint.name)));
    let Some(reaction) = reaction.map(|joint| format!("{}.x", joint.name)) else {
        return Ok(());
    };
    for (format, end) in [
        ("python", "-symbolic.py"),
        ("c", "-symbolic.c"),
        ("rust", "-symbolic.rs"),
        ("latex", "-symbolic.md"),
    ] {
        let arguments = ["symbolic", "--format", format, "--reaction", &reaction];
        match program.run("code", scene, &arguments) {
            Ok(run) => {
                let text = run.text(end)?;
                let (key, differences): (_, Comparison) = match format {
                    "latex" => ("written-formulas", formula_differences),
                    _ => ("written-code", code_differences),
                };
                case.merge(key, differences(&text, rows, coordinate, &reaction));
            }
            // Not every mechanism has a closed form; then the command says so.
            Err(e) if e.contains("closed form") => {}
            Err(e) => case.compared.fail("written-code", e),
        }
    }
    Ok(())
}

/// Laws of every kind and expressions of every function in drawn motions.
fn compare_laws(case: &mut Case<'_>, scene: &str, range: [f64; 2]) -> Result<(), String> {
    let program = case.program;
    for motion in drawn_motions(program, scene, case.reading, range, &mut case.draws)? {
        let (reading, rows) = (&motion.reading, &motion.rows);
        let of = closure(reading, rows, &motion.name);
        case.merge("written-closure", of.joints);
        case.merge("written-laws", of.laws);
        case.merge("written-law-rates", rates(reading, rows, &motion.name));
        let again = described_again_differences(program, &motion)?;
        case.merge("written-laws-again", again);
        if motion.name.ends_with("spline") {
            case.merge("written-warnings", warning_differences(program, &motion)?);
        }
        if motion.name.ends_with("expression") {
            let forces = equilibrium(reading, rows, &motion.name, false);
            case.merge("written-equilibrium", forces.bodies);
            case.merge("written-loads", forces.loads);
        }
    }
    Ok(())
}

/// The mechanism without forces, swept over the positions of a file of `reduce` at unit speed.
fn swept(scene: &str, reading: &Reading, rows: &Rows) -> Result<String, String> {
    let mut scene = without_forces(scene)?;
    let coordinate = &reading.coordinates[0];
    let unit = reading.unit_of(coordinate.measure);
    let column = rows.column(&coordinate.name);
    let (Some(first), Some(last)) = (column.first(), column.last()) else {
        return Err("`reduce` has no column of the coordinate".to_owned());
    };
    let ends = vec![first / unit, last / unit];
    let sweep = value_of([(coordinate.name.as_str(), ends.into())]);
    scene.insert("coordinate-sweep".to_owned(), sweep);
    text_of(&scene)
}
