//! Motions of two mechanisms in the plane and three in space by Dwell, beside what full multibody codes took in the same hour: `validation/peers/run.py`
//! measures those and calls `cargo run --release --example peers -- THEIRS.csv`, which writes `reports/peers.md` and `.png`.
#![allow(clippy::print_stdout, reason = "a study, run by hand")]

mod dwell_runs;
mod motion;
mod report;
mod space_runs;
mod speedups;

use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

/// The mechanisms in the plane: cases of `validation/`.
const CASES: [&str; 2] = ["crank-rocker", "single-dwell"];
/// Those in space, of `validation/spatial/`, which of the loads of its reference moves each, and whether it turns: otherwise it swings
/// and is compared at the instants of the reference.
const SPACE_CASES: [(&str, &str, bool); 3] = [
    ("slider-crank-haug", "as defined", true),
    ("rsur-haug", "none", true),
    ("bricard-a04", "gravity", false),
];
/// Periods of a run of a mechanism that turns.
const PERIODS: f64 = 10.0;
/// A crank angle of ten turns is known to one rounding, rad: a smaller error is no error.
const ANGLE_ROUNDING: f64 = 2.0 * PI * PERIODS * f64::EPSILON;

/// The names of all cases.
fn all_cases() -> impl Iterator<Item = &'static str> {
    CASES.into_iter().chain(SPACE_CASES.map(|(case, ..)| case))
}

/// A run of a motion.
#[derive(Debug, Clone, PartialEq)]
struct Run {
    case: String,
    /// What integrated it, with its version.
    tool: String,
    /// Method, step, tolerance.
    setting: String,
    /// Least time of all repetitions, s.
    wall_time: f64,
    /// Of the crank angle at the end, rad, or the largest at the instants of the reference.
    error: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1);
    let theirs = file.ok_or("say where what the others took is: a CSV file")?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut runs = read(&std::fs::read_to_string(theirs)?)?;
    let mut stages_by_case = Vec::new();
    for case in CASES {
        let (dwell_runs, stages) = dwell_runs::measure(case, &root.join("validation").join(case))?;
        runs.extend(dwell_runs);
        stages_by_case.push(stages);
    }
    for case in SPACE_CASES {
        let (dwell_runs, stages) = space_runs::measure(case, &root.join("validation/spatial"))?;
        runs.extend(dwell_runs);
        stages_by_case.push(stages);
    }
    let speedups = speedups::speedup_lines(&runs);
    println!("{}", speedups.join("\n"));
    let reports = root.join("reports");
    std::fs::create_dir_all(&reports)?;
    let figure = report::figure(&runs);
    std::fs::write(reports.join("peers.png"), dwell_report::png(&figure)?)?;
    let document = report::document(&runs, &stages_by_case, &speedups);
    std::fs::write(reports.join("peers.md"), document.markdown())?;
    Ok(())
}

/// Rows of mechanism, tool, setting, wall time, error.
fn read(text: &str) -> Result<Vec<Run>, Box<dyn Error>> {
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let &[case, tool, setting, wall, error] = cells.as_slice() else {
            return Err(format!("not five cells: {line}").into());
        };
        Ok(Run {
            case: case.to_owned(),
            tool: tool.to_owned(),
            setting: setting.to_owned(),
            wall_time: wall.trim().parse()?,
            error: error.trim().parse::<f64>()?.max(ANGLE_ROUNDING),
        })
    };
    text.lines().skip(1).map(row).collect()
}

/// The runs of a case and a tool (by the beginning of its name) that nothing quicker surpasses, the quickest first.
///
/// An error may pass through zero on its way down. So a run counts with the largest error of itself and of all finer
/// runs of its method.
fn fastest_runs(runs: &[Run], case: &str, tool: &str) -> Vec<Run> {
    let of = |run: &&Run| run.case == case && run.tool.starts_with(tool);
    let mut all: Vec<Run> = runs.iter().filter(of).cloned().collect();
    // What is before the comma is the method, before the equals sign the step; they stand from coarse to fine.
    let method = |run: &Run| run.setting.split([',', '=']).next().map(str::to_owned);
    for k in (1..all.len()).rev() {
        if method(&all[k - 1]) == method(&all[k]) {
            all[k - 1].error = all[k - 1].error.max(all[k].error);
        }
    }
    all.sort_by(|a, b| a.wall_time.total_cmp(&b.wall_time));
    let mut min = f64::INFINITY;
    all.retain(|run| {
        let better = run.error < min;
        min = min.min(run.error);
        better
    });
    all
}
