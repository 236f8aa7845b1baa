//! All checks of a case's files about positions, as findings.

use super::closure::closure;
use super::difference::{Differences, Texts};
use super::drawn_laws::drawn_motions;
use super::equilibrium::equilibrium;
use super::formats::formats;
use super::generated_code::code_differences;
use super::other_units::in_other_units;
use super::program::{Program, Run};
use super::rates::rates;
use super::reading::Reading;
use super::reduced::{ReducedFiles, reduced};
use super::rows::Rows;
use super::scene_text::{Draws, requests_everything, text_of};
use super::sections::{Link, links, sections};
use super::table_file::table_differences;
use super::variants::{calibration_differences, sweep_differences};
use dwell_findings::{Check, Finding};
use std::collections::BTreeMap;
use std::path::Path;

/// Differences by the check that they belong to.
#[derive(Debug, Default)]
struct Judged {
    closure: Differences,
    laws: Differences,
    law_rates: Differences,
    rates: Differences,
    equilibrium: Differences,
    loads: Differences,
    totals: Differences,
    reduced_sums: Differences,
    reduced_bodies: Differences,
    reduced_slopes: Differences,
    reduced_runs: Differences,
    files: Differences,
    extrema: Differences,
    printed: Differences,
    cuts: Differences,
    ends: Differences,
    units: Differences,
    table: Differences,
    code: Differences,
    variants: Differences,
    calibration: Differences,
}

const RULE: &str = "rounding of the written numbers, measured over all cases";

/// Runs the program at `path` on a case and judges the files. A run that fails is a failed finding.
pub(crate) fn findings(path: &Path, name: &str, scene: &str) -> Vec<Finding> {
    let mut judged = Judged::default();
    if let Err(reason) = judge(&mut judged, path, name, scene) {
        judged.closure.fail(reason);
    }
    judged.findings()
}

fn judge(judged: &mut Judged, path: &Path, name: &str, scene: &str) -> Result<(), String> {
    let program = Program::new(path, name).map_err(|e| format!("no folder for the files: {e}"))?;
    let reading = Reading::new(scene)?;
    let mut draws = Draws::of(scene);
    let everything = text_of(&requests_everything(scene)?)?;
    judge_kinematics(judged, &program, &reading, &everything)?;
    judge_forces(judged, &program, &reading, &everything, &mut draws)?;
    judge_units(judged, &program, &reading, &everything, &mut draws)?;
    if reading.actuator_count == 1 {
        judge_reduced(judged, &program, &reading, [scene, &everything], &mut draws)?;
    }
    Ok(())
}

fn judge_kinematics(
    judged: &mut Judged,
    program: &Program,
    reading: &Reading,
    scene: &str,
) -> Result<(), String> {
    let run = program
        .run("kinematics", scene, &["kinematics"])
        .map_err(|e| e.to_string())?;
    let rows = run.csv("-kinematics.csv")?;
    judged.add_formats(&run, reading, "kinematics")?;
    let of = closure(reading, &rows, "kinematics");
    judged.closure.merge(of.joints);
    judged.laws.merge(of.laws);
    if let Some(time) = rows.columns.get("t") {
        judged
            .rates
            .merge(rates(&rows, time, &corners(reading), "kinematics"));
    }
    Ok(())
}

/// Systems of units in which each case is written again.
const SYSTEMS: usize = 2;

/// The same files from the scene in other units.
fn judge_units(
    judged: &mut Judged,
    program: &Program,
    reading: &Reading,
    scene: &str,
    draws: &mut Draws,
) -> Result<(), String> {
    let table: toml::Table = scene
        .parse()
        .map_err(|e| format!("the scene is no TOML: {e}"))?;
    let has_motion = ["prescribed", "coordinate-sweep"]
        .iter()
        .any(|key| table.contains_key(*key));
    let command = if has_motion {
        "kinetostatics"
    } else {
        "kinematics"
    };
    let file = format!("-{command}.npz");
    let run = |name: &str, scene: &str| {
        let run = program.run(name, scene, &[command, "--points", "31"]);
        run.map_err(|e| e.to_string())?.npz(&file)
    };
    let expected = run("units", scene)?;
    for _ in 0..SYSTEMS {
        let (other, units) = in_other_units(&table, reading, draws);
        match run("other-units", &text_of(&other)?) {
            Ok(rows) => judged.units.merge(same_columns(
                &rows,
                &expected,
                &format!("the scene in {units}"),
            )),
            Err(reason) => judged.units.fail(format!("the scene in {units}: {reason}")),
        }
    }
    Ok(())
}

/// Where laws of the prescribed motion have corners, s.
fn corners(reading: &Reading) -> Vec<f64> {
    reading
        .laws
        .iter()
        .flatten()
        .flat_map(super::law::Law::corners)
        .collect()
}

fn judge_forces(
    judged: &mut Judged,
    program: &Program,
    reading: &Reading,
    scene: &str,
    draws: &mut Draws,
) -> Result<(), String> {
    let has_motion = scene
        .parse::<toml::Table>()
        .is_ok_and(|s| s.contains_key("prescribed") || s.contains_key("coordinate-sweep"));
    for command in ["kinetostatics", "statics"] {
        // Without a motion there are no speeds that forces of inertia follow from.
        if !has_motion && (command == "kinetostatics" || reading.actuator_count > 1) {
            continue;
        }
        let points = (61 + draws.below(60)).to_string();
        let run = program
            .run(command, scene, &[command, "--points", &points])
            .map_err(|e| e.to_string())?;
        let rows = run.npz(&format!("-{command}.npz"))?;
        let of = closure(reading, &rows, command);
        judged.closure.merge(of.joints);
        let forces = equilibrium(reading, &rows, command, command == "statics");
        judged.equilibrium.merge(forces.bodies);
        judged.loads.merge(forces.loads);
        judged.totals.merge(forces.totals);
        judged.add_formats(&run, reading, command)?;
    }
    if has_motion {
        judge_sections(judged, program, reading, scene, draws)?;
    }
    Ok(())
}

/// Links of a case whose internal forces are judged.
const LINKS: usize = 2;

/// The internal forces of drawn links, in the row where the program has found the largest bending moment.
fn judge_sections(
    judged: &mut Judged,
    program: &Program,
    reading: &Reading,
    scene: &str,
    draws: &mut Draws,
) -> Result<(), String> {
    let mut links = links(reading);
    let drawn: Vec<_> = (0..LINKS.min(links.len()))
        .map(|_| links.remove(draws.below(links.len())))
        .collect();
    if drawn.is_empty() {
        return Ok(());
    }
    let arguments = ["kinetostatics", "--points", "37"];
    let scene = requesting_sections(scene, reading, &drawn)?;
    let run = program
        .run("sections", &scene, &arguments)
        .map_err(|e| e.to_string())?;
    let (rows, summary) = (
        run.csv("-kinetostatics.csv")?,
        run.json("-kinetostatics.json")?,
    );
    let abscissa = summary["extrema_over"]["name"].as_str().unwrap_or("t");
    for link in &drawn {
        let body = &reading.bodies[link.body].name;
        let [from, to] = &link.names;
        let cuts = run.csv(&format!(
            "-kinetostatics-internal-forces-{body}.{from}.{to}.csv"
        ))?;
        let name = format!("{body} from {from} to {to}.bending_moment");
        let at = summary["results"][format!("{name}.at")]["value"].as_f64();
        let column = rows.columns.get(abscissa);
        let row = at.zip(column).and_then(|(at, column)| {
            column
                .iter()
                .position(|x| (x - at).abs() <= 1e-12 * (1.0 + at.abs()))
        });
        let Some(row) = row else {
            judged
                .cuts
                .fail(format!("the largest {name} is at {at:?}, which is no row"));
            continue;
        };
        let of = sections(reading, &rows, row, link, &cuts);
        judged.cuts.merge(of.cuts);
        judged.ends.merge(of.ends);
        // The largest moment that is printed is one of the cuts.
        let said = summary["results"][&name]["value"]
            .as_f64()
            .unwrap_or(f64::NAN);
        let column = cuts.columns.get("bending").into_iter().flatten();
        let largest = column.fold(0.0_f64, |max, v| max.max(v.abs()));
        judged
            .files
            .add(said.abs() - largest, largest, "N m", || name.clone());
    }
    Ok(())
}

fn requesting_sections(scene: &str, reading: &Reading, drawn: &[Link]) -> Result<String, String> {
    let mut scene: toml::Table = scene
        .parse()
        .map_err(|e| format!("the scene is no TOML: {e}"))?;
    let request = |link: &Link| {
        let [from, to] = &link.names;
        let entries = [
            ("body", &reading.bodies[link.body].name),
            ("from", from),
            ("to", to),
        ];
        let entry =
            |(key, value): (&str, &String)| (key.to_owned(), toml::Value::String(value.clone()));
        toml::Value::Table(entries.into_iter().map(entry).collect())
    };
    let requested = toml::Value::Array(drawn.iter().map(request).collect());
    let requests = toml::Table::from_iter([("sections".to_owned(), requested)]);
    scene.insert("requests".to_owned(), toml::Value::Table(requests));
    text_of(&scene)
}

fn judge_reduced(
    judged: &mut Judged,
    program: &Program,
    reading: &Reading,
    [scene, everything]: [&str; 2],
    draws: &mut Draws,
) -> Result<(), String> {
    let points = (181 + draws.below(180)).to_string();
    let run = |name: &str, scene: &str, command: &str| {
        program
            .run(name, scene, &[command, "--points", &points])
            .map_err(|e| e.to_string())
    };
    let all = run("reduce", everything, "reduce")?.csv("-reduced.csv")?;
    let requested = run("requested", scene, "reduce")?.npz("-reduced.npz")?;
    let swept = swept(everything, reading, &all)?;
    let run_i = run("sweep", &swept, "kinetostatics")?.npz("-kinetostatics.npz")?;
    let run_ii = run("runs", everything, "runs")?.csv("-run-ii.csv")?;
    let files = ReducedFiles {
        reduced: &all,
        run_i: &run_i,
        run_ii: &run_ii,
    };
    let coordinate = &reading.coordinates[0].name;
    let of = reduced(reading, &files, coordinate);
    let range =
        [0, all.count.saturating_sub(1)].map(|row| all.get(row, coordinate).unwrap_or(f64::NAN));
    judge_laws(judged, program, reading, everything, range, draws)?;
    judge_copies(judged, program, reading, everything, &all)?;
    let whole: toml::Table = everything
        .parse()
        .map_err(|e| format!("the scene is no TOML: {e}"))?;
    judged
        .variants
        .merge(sweep_differences(program, &whole, reading, draws)?);
    judged
        .calibration
        .merge(calibration_differences(program, &whole, reading)?);
    judged.reduced_sums.merge(of.sums);
    judged.reduced_bodies.merge(of.bodies);
    judged.reduced_slopes.merge(of.slopes);
    judged.reduced_runs.merge(of.runs);
    judged.reduced_runs.merge(same_columns(
        &requested,
        &all,
        "the requested file of `reduce`",
    ));
    for (rows, file) in [(&run_i, "run i"), (&run_ii, "run ii")] {
        judged.closure.merge(closure(reading, rows, file).joints);
    }
    Ok(())
}

/// The accuracy that tables are asked for.
const TABLE_ACCURACY: &str = "1e-7";

/// The reduced model once more: as a table, and as code in two languages.
fn judge_copies(
    judged: &mut Judged,
    program: &Program,
    reading: &Reading,
    scene: &str,
    rows: &Rows,
) -> Result<(), String> {
    let coordinate = &reading.coordinates[0].name;
    let arguments = [
        "reduce",
        "--points",
        "3",
        "--table-accuracy",
        TABLE_ACCURACY,
    ];
    match program.run("table", scene, &arguments) {
        Ok(run) => judged
            .table
            .merge(table_differences(&run.text(".table")?, rows, coordinate)),
        // Not every mechanism has one, as its format says.
        Err(e)
            if ["tables are of driven angles", "no table:"]
                .iter()
                .any(|why| e.to_string().contains(why)) => {}
        Err(e) => judged.table.fail(e.to_string()),
    }
    let reaction = reading
        .joints
        .iter()
        .find(|joint| rows.columns.contains_key(&format!("{}.x.a", joint.name)));
    let Some(reaction) = reaction.map(|joint| format!("{}.x", joint.name)) else {
        return Ok(());
    };
    for (format, end) in [("python", "-symbolic.py"), ("c", "-symbolic.c")] {
        let arguments = ["symbolic", "--format", format, "--reaction", &reaction];
        match program.run("code", scene, &arguments) {
            Ok(run) => {
                let code = run.text(end)?;
                judged
                    .code
                    .merge(code_differences(&code, rows, coordinate, &reaction));
            }
            // Not every mechanism has a closed form; then the command says so.
            Err(e) if e.to_string().contains("closed form") => {}
            Err(e) => judged.code.fail(e.to_string()),
        }
    }
    Ok(())
}

/// Laws of every kind and expressions of every function in drawn motions.
fn judge_laws(
    judged: &mut Judged,
    program: &Program,
    reading: &Reading,
    scene: &str,
    range: [f64; 2],
    draws: &mut Draws,
) -> Result<(), String> {
    for motion in drawn_motions(program, scene, reading, range, draws)? {
        let (reading, rows) = (&motion.reading, &motion.rows);
        let of = closure(reading, rows, &motion.name);
        judged.closure.merge(of.joints);
        judged.laws.merge(of.laws);
        if let Some(time) = rows.columns.get("t") {
            judged
                .law_rates
                .merge(rates(rows, time, &corners(reading), &motion.name));
        }
        if motion.name.ends_with("expression") {
            let forces = equilibrium(reading, rows, &motion.name, false);
            judged.equilibrium.merge(forces.bodies);
            judged.loads.merge(forces.loads);
        }
    }
    Ok(())
}

/// The mechanism without forces, swept over the positions of a file of `reduce` at unit speed.
fn swept(scene: &str, reading: &Reading, rows: &Rows) -> Result<String, String> {
    let mut scene: toml::Table = scene
        .parse()
        .map_err(|e| format!("the scene is no TOML: {e}"))?;
    for section in [
        "prescribed",
        "loads",
        "friction",
        "drives",
        "stops",
        "motion",
        "calibration",
    ] {
        scene.remove(section);
    }
    let coordinate = &reading.coordinates[0];
    let unit = reading.unit_of(coordinate.measure);
    let column = rows
        .columns
        .get(&coordinate.name)
        .ok_or("`reduce` has no column of the coordinate")?;
    let ends = [column.first(), column.last()]
        .into_iter()
        .flatten()
        .map(|q| toml::Value::Float(q / unit));
    let mut sweep = toml::Table::new();
    sweep.insert(coordinate.name.clone(), toml::Value::Array(ends.collect()));
    scene.insert("coordinate-sweep".to_owned(), toml::Value::Table(sweep));
    text_of(&scene)
}

/// What the columns of a name are compared with: forces in x and y, and along the axes of a body, are of one kind.
fn kind_of(name: &str, is_point: bool) -> String {
    if let Some((_, load)) = name.split_once(".c.") {
        return format!("c.{load}");
    }
    let end = name.rsplit('.').next().unwrap_or(name);
    let kind = match end.split('@').next().unwrap_or(end) {
        "half_dm" => "m",
        "x" | "y" if is_point && !end.contains('@') => "position",
        "vx" | "vy" => "v",
        "ax" | "ay" => "a",
        "x" | "y" | "normal" | "tangent" | "tooth" | "axial" | "force" | "magnitude" | "fx"
        | "fy" | "load_force" => "force",
        "moment" | "load_moment" => "moment",
        _ if name.starts_with("power.") || end == "power" => "power",
        other => other,
    };
    kind.to_owned()
}

/// The columns of a file against those of another that has them, too, relative to the largest of the same ending.
fn same_columns(rows: &Rows, other: &Rows, file: &str) -> Differences {
    let is_point = |name: &str| name.matches('.').count() == 2;
    let ending = |name: &str| kind_of(name, is_point(name));
    let mut scales = BTreeMap::<String, f64>::new();
    for (name, values) in &other.columns {
        let scale = scales.entry(ending(name)).or_default();
        *scale = values.iter().fold(*scale, |max, v| max.max(v.abs()));
    }
    // Where nothing accelerates, what the velocities would make of it stands in.
    for (acceleration, velocity) in [("angular_acceleration", "angular_velocity"), ("a", "v")] {
        let velocity = scales.get(velocity).copied().unwrap_or(0.0);
        let scale = scales.entry(acceleration.to_owned()).or_default();
        *scale = scale.max(velocity * velocity);
    }
    let mut all = Differences::default();
    for (name, values) in rows
        .columns
        .iter()
        .filter(|(name, _)| *name != "relative_error")
    {
        let Some(others) = other
            .columns
            .get(name)
            .filter(|others| others.len() == values.len())
        else {
            all.fail(format!(
                "{file} has a column {name} of {} rows that the whole one does not have",
                values.len()
            ));
            continue;
        };
        let scale = scales.get(&ending(name)).copied().unwrap_or(0.0);
        for (row, (value, expected)) in values.iter().zip(others).enumerate() {
            all.add(value - expected, scale, "", || {
                format!("{file}, row {row}, {name}")
            });
        }
    }
    all
}

impl Judged {
    fn add_formats(&mut self, run: &Run, reading: &Reading, command: &str) -> Result<(), String> {
        let of = formats(run, command, command, &corners(reading))?;
        self.files.merge(of.files);
        self.extrema.merge(of.extrema);
        self.printed.merge(of.printed);
        Ok(())
    }

    fn findings(self) -> Vec<Finding> {
        let specs = [
            (
                self.closure,
                "written-closure",
                Check::WrittenPositions,
                "joints, points and coordinates of every row with the scene's text: values, velocities, accelerations",
                5e-13,
            ),
            (
                self.laws,
                "written-laws",
                Check::WrittenLaws,
                "actuators of every row with the laws of the scene's text and their derivatives",
                4e-13,
            ),
            (
                self.rates,
                "written-rates",
                Check::WrittenRates,
                "changes between rows with the integrals of their rates",
                1e-9,
            ),
            (
                self.equilibrium,
                "written-equilibrium",
                Check::WrittenForces,
                "Newton's and Euler's equations of every body with the written forces",
                2e-14,
            ),
            (
                self.loads,
                "written-loads",
                Check::WrittenLaws,
                "forces of loads with expressions and tables of the scene's text",
                2e-14,
            ),
            (
                self.totals,
                "written-totals",
                Check::WrittenTotals,
                "shaking forces, powers and energies with sums over all bodies",
                2e-14,
            ),
            (
                self.reduced_sums,
                "written-reduced",
                Check::WrittenTotals,
                "m, ½m′ and w of `reduce` with sums over all bodies",
                1e-12,
            ),
            (
                self.reduced_bodies,
                "written-coefficients",
                Check::WrittenForces,
                "a, b and c of `reduce` in the equations of every body",
                1e-13,
            ),
            (
                self.reduced_slopes,
                "written-slopes",
                Check::WrittenRates,
                "m and V of `reduce` with the integrals of ½m′ and w between rows",
                1e-9,
            ),
            (
                self.reduced_runs,
                "written-runs",
                Check::WrittenTwice,
                "m, ½m′, a and b of `reduce` with two runs of kinetostatics, and with the columns that are requested",
                4e-11,
            ),
            (
                self.files,
                "written-files",
                Check::WrittenTwice,
                "CSV with NPZ, extrema and peaks of the summary with the rows",
                1e-12,
            ),
            (
                self.law_rates,
                "written-law-rates",
                Check::WrittenRates,
                "changes between rows of drawn laws with the integrals of their rates",
                1e-6,
            ),
            (
                self.table,
                "written-table",
                Check::WrittenTwice,
                "the table of `reduce` with its rows, beyond the errors that it states",
                1e-13,
            ),
            (
                self.code,
                "written-code",
                Check::WrittenTwice,
                "code of `symbolic` in Python and C, run line by line, with the rows of `reduce`",
                1e-12,
            ),
            (
                self.variants,
                "written-sweep",
                Check::WrittenTwice,
                "extrema of m in rows of `sweep` with `reduce` of each changed scene",
                1e-13,
            ),
            (
                self.calibration,
                "written-calibration",
                Check::WrittenTotals,
                "the period of the calibrated scene by quadrature of the rows of `reduce`",
                1e-11,
            ),
            (
                self.units,
                "written-units",
                Check::WrittenUnits,
                "files of the scene with those of the scene in other units",
                1e-11,
            ),
            (
                self.extrema,
                "written-extrema",
                Check::WrittenRates,
                "extrema of the summary with the rows around them",
                1e-6,
            ),
            (
                self.printed,
                "written-sentences",
                Check::WrittenSentences,
                "printed numbers with the summary, to their digits",
                1e-12,
            ),
            (
                self.cuts,
                "written-sections",
                Check::WrittenForces,
                "internal forces of links with equilibrium of the part behind each cut",
                2e-14,
            ),
            (
                self.ends,
                "written-section-ends",
                Check::WrittenTotals,
                "internal forces at the end of a link with what acts there",
                2e-14,
            ),
        ];
        let finding =
            |(of, key, check, comparison, tolerance): (Differences, &str, Check, &str, f64)| {
                let texts = Texts {
                    key,
                    check,
                    comparison,
                    scale: "the largest of its kind in the file",
                    tolerance,
                    tolerance_reason: RULE,
                };
                of.finding(texts, "all rows of the files")
            };
        specs.into_iter().filter_map(finding).collect()
    }
}
