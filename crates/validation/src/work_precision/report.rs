//! The text and the tables of a study.

use super::combination::{
    CombinationResult, CostMeasure, ErrorQuantity, Evaluation, Integrator, WorkPrecision,
    digits_or_dash,
};
use super::commands::CommandRun;
use super::exported_code::ExportedCode;
use crate::report_parts::{self, TextColumn, table_of};
use dwell_dynamics::Method;
use dwell_findings::Record;
use dwell_report::{Block, Column, Document, Table, TableExport as _};
use dwell_scene::SceneFile;
use dwell_study::StudyError;
use dwell_study::number_format::{count, digits};
use dwell_study::output::provenance_line;
use std::fmt::Write as _;

/// Accuracies for which the cheapest combination is listed.
const ACCURACIES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// All numbers. The integrators are numbered as `Method::ALL`, quadrature is −1; evaluations are 0 exact, 1 single
/// precision, 2 table, 3 other.
pub(super) fn table(found: &WorkPrecision) -> Table {
    let mut table = numbers(found);
    let coded = ["evaluation", "integrator"].map(|name| Column::new(name, ""));
    table.columns.splice(0..0, coded);
    for (row, point) in table.rows.iter_mut().zip(&found.points) {
        let evaluation = match point.combination.evaluation {
            Evaluation::Exact => 0.0,
            Evaluation::SinglePrecision => 1.0,
            Evaluation::Table { .. } => 2.0,
            Evaluation::Other(_) => 3.0,
        };
        let integrator = match point.combination.integrator {
            Integrator::Steps(its_method, _) => {
                let position = Method::ALL.iter().position(|&method| method == its_method);
                position.map_or(f64::NAN, |position| position as f64)
            }
            Integrator::Quadrature => -1.0,
        };
        row.splice(0..0, [evaluation, integrator]);
    }
    table
}

/// All numbers, with names before them.
pub(super) fn csv(found: &WorkPrecision) -> Result<String, StudyError> {
    let text = numbers(found).csv()?;
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    let mut csv = format!("evaluation,integrator,{header}\n");
    for (line, point) in lines.zip(&found.points) {
        let evaluation = point.combination.evaluation.name();
        let integrator = point.combination.integrator.name();
        // Writing to a string cannot fail.
        let _ = writeln!(csv, "{evaluation},{integrator},{line}");
    }
    Ok(csv)
}

fn numbers(found: &WorkPrecision) -> Table {
    let unit = found.unit.replace(' ', "_");
    let columns = [
        ("tolerance", ""),
        ("table_accuracy", ""),
        ("table_cells", ""),
        ("table_bytes", ""),
        ("steps", ""),
        ("rejected", ""),
        ("evaluations", ""),
        ("jacobians", ""),
        ("weighted_evaluations", ""),
        ("time", "evaluations"),
        ("time_with_build", "evaluations"),
        ("coordinate_error", unit.as_str()),
        ("energy_error", ""),
        ("reaction_error", ""),
        ("coordinate_below_reference_error", ""),
        ("energy_below_reference_error", ""),
        ("reaction_below_reference_error", ""),
    ];
    let row = |point: &CombinationResult| {
        let (cost, tolerance) = (point.cost, point.combination.integrator.tolerance());
        let mut row = vec![tolerance.unwrap_or(f64::NAN)];
        row.extend(match point.combination.evaluation {
            Evaluation::Table {
                accuracy,
                cells,
                bytes,
            } => [accuracy, cells as f64, bytes as f64],
            _ => [f64::NAN; 3],
        });
        let solver = [cost.steps, cost.rejected, cost.evaluations];
        row.extend(solver.map(|count| count as f64));
        row.extend([cost.jacobians, cost.weighted_evaluations].map(|count| count as f64));
        row.extend([cost.time, cost.of(CostMeasure::TimeWithBuild)]);
        row.extend(ErrorQuantity::ALL.map(|quantity| point.errors.of(quantity)));
        let is_below = |quantity| found.is_below_reference(point, quantity);
        row.extend(ErrorQuantity::ALL.map(|q| f64::from(u8::from(is_below(q)))));
        row
    };
    Table {
        columns: columns.map(|(n, u)| Column::new(n, u)).to_vec(),
        rows: found.points.iter().map(row).collect(),
    }
}

fn quantity_name(quantity: ErrorQuantity) -> &'static str {
    match quantity {
        ErrorQuantity::Coordinate => "coordinate",
        ErrorQuantity::Energy => "energy",
        ErrorQuantity::Reaction => "worst reaction",
    }
}

/// The table cells of a point of a front.
fn cells(found: &WorkPrecision, result: &CombinationResult) -> Vec<String> {
    let mut cells = vec![
        result.combination.name(),
        result.cost.steps.to_string(),
        result.cost.weighted_evaluations.to_string(),
        digits(result.cost.time, 3),
        digits(result.cost.of(CostMeasure::TimeWithBuild), 3),
    ];
    cells.extend(ErrorQuantity::ALL.map(|q| found.describe_error(result, q)));
    cells
}

fn front_table(found: &WorkPrecision, quantity: ErrorQuantity, measure: CostMeasure) -> Block {
    let coordinate = format!("error of the coordinate, {}", found.unit);
    let header = [
        "combination",
        "steps",
        "evaluations",
        "time",
        "time with build",
        coordinate.as_str(),
        "energy drift",
        "worst reaction",
    ];
    let front = found.pareto_front(quantity, measure).into_iter();
    report_parts::table(&header, front.map(|k| cells(found, &found.points[k])))
}

/// The cheapest combination with its cost.
fn cheapest(
    found: &WorkPrecision,
    quantity: ErrorQuantity,
    measure: CostMeasure,
    accuracy: f64,
) -> String {
    let Some(k) = found.cheapest(quantity, measure, accuracy) else {
        let unknown = found.reference.error.of(quantity) > accuracy;
        return if unknown { "not known" } else { "none" }.to_owned();
    };
    let point = &found.points[k];
    let cost = digits(point.cost.of(measure), 3);
    format!("{} ({cost})", point.combination.name())
}

/// The document of a study.
pub(super) fn document(scene: &SceneFile, found: &WorkPrecision, file: &str) -> Document {
    let mut blocks = vec![
        Block::Text(intro(scene, found)),
        Block::Figure {
            file: format!("{file}.png"),
            alt: "Cost over true error of every combination".to_owned(),
            caption: String::new(),
        },
        Block::Heading("The cheapest for an accuracy".to_owned()),
        Block::Text("A combination reaches an accuracy if it and all finer tolerances of its integrator do. Combinations without a table and in double precision are typed as `dwell simulate --method … --rtol …`; tables and single precision are those of the library and of exported code.".to_owned()),
        report_parts::table(
            &[
                "error of",
                "at most",
                "by evaluations",
                "by time without build",
                "by time with build",
            ],
            ErrorQuantity::ALL.into_iter().flat_map(|quantity| {
                ACCURACIES.map(|accuracy| cheapest_row(found, quantity, accuracy))
            }),
        ),
        Block::Text(quadrature(found)),
    ];
    if let Some(fixed) = fixed_step(found) {
        blocks.push(Block::Text(format!("For comparison, {fixed}.")));
    }
    for (quantity, measure) in [
        (ErrorQuantity::Coordinate, CostMeasure::Evaluations),
        (ErrorQuantity::Coordinate, CostMeasure::TimeWithBuild),
        (ErrorQuantity::Coordinate, CostMeasure::Time),
        (ErrorQuantity::Energy, CostMeasure::Evaluations),
        (ErrorQuantity::Reaction, CostMeasure::Evaluations),
    ] {
        let cost = match measure {
            CostMeasure::Evaluations => "evaluations",
            CostMeasure::Time => "time without build",
            CostMeasure::TimeWithBuild => "time with build",
        };
        let heading = format!("Front: {} over {cost}", quantity_name(quantity));
        blocks.push(Block::Heading(heading));
        blocks.push(front_table(found, quantity, measure));
    }
    if !found.omitted.is_empty() {
        blocks.push(Block::Heading("Left out".to_owned()));
        let lines: Vec<String> = found.omitted.iter().map(|why| format!("- {why}")).collect();
        blocks.push(Block::Text(lines.join("\n")));
    }
    Document {
        title: format!("Work–precision diagram: {}", scene.title),
        blocks,
    }
}

fn cheapest_row(found: &WorkPrecision, quantity: ErrorQuantity, accuracy: f64) -> Vec<String> {
    let mut row = vec![quantity_name(quantity).to_owned()];
    row.push(format!("{accuracy:.0e}"));
    row.extend(CostMeasure::ALL.map(|measure| cheapest(found, quantity, measure, accuracy)));
    row
}

fn intro(scene: &SceneFile, found: &WorkPrecision) -> String {
    let reference_error = found.reference.error;
    let mut text = format!(
        "{}.\n\nThe motion from t = 0 to {} s; errors are the largest at 50 times spread over it, by dense output.\n",
        provenance_line(scene),
        digits(found.duration, 7)
    );
    for line in &found.motion_notes {
        let _ = write!(text, "\n- {line}");
    }
    let _ = write!(
        text,
        "\n\nReference: {}. Its error is {} {} in the coordinate, {} of the largest kinetic energy and {} of the largest reaction; smaller errors are reported as below that.\n\nAn *evaluation* is one evaluation of the equation of motion; a Jacobian counts as its dual-number evaluations. *Time* is in units of one exact evaluation in double precision, measured between the runs ({} ns here; a Jacobian takes {} of them): the minimum of {}. *With build* adds the time to build the table once.",
        found.reference.method,
        digits(reference_error.coordinate, 2),
        found.unit,
        digits(reference_error.energy, 2),
        digits_or_dash(reference_error.reaction, 2),
        digits(found.evaluation_time * 1e9, 2),
        digits(found.jacobian_cost, 2),
        count(found.repetitions, "run"),
    );
    text
}

fn quadrature(found: &WorkPrecision) -> String {
    match found.quadrature() {
        Some(point) => format!(
            "The motion is determined by its energy: quadrature computes all of it with {} evaluations, in the time of {}, with errors of {}, {} and {}. No time-stepping method is competitive, so the Pareto fronts show integrators only.",
            point.cost.weighted_evaluations,
            digits(point.cost.time, 3),
            found.describe_error(point, ErrorQuantity::Coordinate),
            found.describe_error(point, ErrorQuantity::Energy),
            found.describe_error(point, ErrorQuantity::Reaction),
        ),
        None => "Quadrature does not apply: the motion is not conservative, not periodic, or has several degrees of freedom."
            .to_owned(),
    }
}

/// The result of fixed steps, in words.
fn fixed_step(found: &WorkPrecision) -> Option<String> {
    let fixed = found.fixed_step?;
    let [coordinate, energy, reaction] =
        ErrorQuantity::ALL.map(|quantity| digits_or_dash(fixed.errors.of(quantity), 2));
    Some(format!(
        "fixed step of 1 ms (classical Runge–Kutta, {}, in time {}): errors {coordinate} {} in the coordinate, {energy} of the energy, {reaction} of the worst reaction",
        count(fixed.steps, "step"),
        digits(fixed.time, 3),
        found.unit,
    ))
}

/// The exported code, a line each.
pub(super) fn exported_code_summary(found: &WorkPrecision) -> String {
    let line = |code: &ExportedCode| {
        let [[coefficients, worst], [step, worst_step]] =
            code.times.map(|pair| pair.map(|t| digits(t, 2)));
        format!(
            "  exported code, {}, steps of 1 ms: {} {} off; coefficients {coefficients} evaluations (worst {worst}), a step {step} (worst {worst_step})\n",
            code.name,
            digits_or_dash(code.errors.coordinate, 2),
            found.unit,
        )
    };
    found.exported_code.iter().map(line).collect()
}

/// The exported code, as a part of the document.
pub(super) fn exported_code_blocks(found: &WorkPrecision) -> Vec<Block> {
    if found.exported_code.is_empty() {
        return Vec::new();
    }
    let columns: [TextColumn<&ExportedCode>; 8] = [
        ("exported C, steps of 1 ms", |code| code.name.to_owned()),
        ("error of the coefficients", |code| {
            digits_or_dash(code.coefficients, 2)
        }),
        ("error of the coordinate", |code| {
            digits_or_dash(code.errors.coordinate, 2)
        }),
        ("energy drift", |code| digits_or_dash(code.errors.energy, 2)),
        ("all coefficients: mean", |code| digits(code.times[0][0], 2)),
        ("worst", |code| digits(code.times[0][1], 2)),
        ("a step: mean", |code| digits(code.times[1][0], 2)),
        ("worst", |code| digits(code.times[1][1], 2)),
    ];
    vec![
        Block::Heading("Exported code".to_owned()),
        Block::Text(format!(
            "`dwell export --to c`, compiled here and run through the motion by its own step, of a millisecond at most. Errors of the coefficients are relative to \
             the largest value of each, that of the coordinate is in {}, the drift relative to the largest kinetic energy. Times are in units of one exact evaluation; \
             of each of 2000 calls the least of seven counts, the worst is the largest of these.",
            found.unit
        )),
        table_of(&columns, found.exported_code.iter()),
    ]
}

/// The command for each accuracy, as lines of the summary.
pub(super) fn command_summary(scene: &SceneFile, found: &WorkPrecision) -> String {
    let line = |of: &CommandRun| {
        let accuracy = format!("{:.0e}", of.preset.1);
        let errors = errors_text(found, of);
        if !of.is_reached {
            return format!("  for {accuracy}: not reached; measured {errors}\n");
        }
        let kept = if of.keeps_accuracy(&found.reference.error) {
            "measured"
        } else {
            "NOT KEPT:"
        };
        let whole = of.whole.map_or_else(String::new, |whole| {
            let [files, pictures] = whole.map(|s| digits(1e3 * s, 2));
            format!(", with files {files} ms, with the main pictures {pictures} ms")
        });
        format!(
            "  for {accuracy} in coordinate, energy and reactions: dwell simulate {} --accuracy {accuracy}\n    computing {} ms{whole}, {}; {kept} {errors}\n",
            scene.source.name(),
            digits(1e3 * of.computing, 2),
            of.method,
        )
    };
    found.commands.iter().map(line).collect()
}

/// The true errors of a command: coordinate, energy, worst reaction.
fn errors_text(found: &WorkPrecision, of: &CommandRun) -> String {
    let [coordinate, energy, reaction] =
        ErrorQuantity::ALL.map(|quantity| digits_or_dash(of.errors.of(quantity), 1));
    format!("{coordinate} {}, {energy}, {reaction}", found.unit)
}

/// The command for each accuracy, as a part of the document.
pub(super) fn command_blocks(found: &WorkPrecision) -> [Block; 3] {
    let columns: [TextColumn<&CommandRun>; 9] = [
        ("to type", |of| {
            format!("`dwell simulate … --accuracy {:.0e}`", of.preset.1)
        }),
        ("method", |of| of.method.clone()),
        ("estimated error", |of| {
            digits_or_dash(of.estimated_error.unwrap_or(f64::NAN), 2)
        }),
        ("measured: coordinate", |of| {
            digits_or_dash(of.errors.coordinate, 2)
        }),
        ("energy", |of| digits_or_dash(of.errors.energy, 2)),
        ("reactions", |of| digits_or_dash(of.errors.reaction, 2)),
        ("computing, s", |of| digits(of.computing, 2)),
        ("with files, s", |of| {
            digits_or_dash(of.whole.map_or(f64::NAN, |whole| whole[0]), 2)
        }),
        ("with the main pictures, s", |of| {
            digits_or_dash(of.whole.map_or(f64::NAN, |whole| whole[1]), 2)
        }),
    ];
    [
        Block::Heading("What to type".to_owned()),
        Block::Text(
            "`dwell simulate --accuracy` over the motion that is studied: the method that it chooses, the error that it estimates and the errors of its rows against the \
             reference; computing the motion with its rows, extrema and error; the same with tables and page written; and with the main pictures. One run each."
                .to_owned(),
        ),
        table_of(&columns, found.commands.iter()),
    ]
}

/// The numbers of the summary.
pub(super) fn record(found: &WorkPrecision) -> Record {
    let mut record = Record::default();
    record.add_count("combinations", found.points.len());
    record.add("duration", "s", found.duration);
    let error = found.reference.error;
    record.add("reference.error.coordinate", found.unit, error.coordinate);
    record.add("reference.error.energy", "", error.energy);
    record.add("reference.error.reaction", "", error.reaction);
    for accuracy in ACCURACIES {
        for (measure, name) in
            CostMeasure::ALL
                .into_iter()
                .zip(["evaluations", "time", "time_with_build"])
        {
            let cheapest = found.cheapest(ErrorQuantity::Coordinate, measure, accuracy);
            if let Some(k) = cheapest {
                let name = format!("cheapest.{accuracy:.0e}.{name}");
                record.add(name, "", found.points[k].cost.of(measure));
            }
        }
    }
    if let Some(point) = found.quadrature() {
        record.add(
            "quadrature.evaluations",
            "",
            point.cost.weighted_evaluations as f64,
        );
        record.add("quadrature.time", "", point.cost.time);
    }
    record
}

/// The summary.
pub(super) fn summary(scene: &SceneFile, found: &WorkPrecision) -> String {
    let reference_error = found.reference.error;
    let mut text = format!(
        "{}: {} combinations over {} s\n",
        scene.title.trim_end_matches('.'),
        found.points.len(),
        digits(found.duration, 6)
    );
    for line in &found.motion_notes {
        let _ = writeln!(text, "  {line}");
    }
    let _ = writeln!(
        text,
        "  reference: {}\n  its error: {} {}, {} of the energy, {} of the reactions",
        found.reference.method,
        digits(reference_error.coordinate, 1),
        found.unit,
        digits(reference_error.energy, 1),
        digits_or_dash(reference_error.reaction, 1)
    );
    if let Some(point) = found.quadrature() {
        let _ = writeln!(
            text,
            "  quadrature, since the motion is determined by its energy: {} evaluations, in time {}",
            point.cost.weighted_evaluations,
            digits(point.cost.time, 3)
        );
    }
    if let Some(fixed) = fixed_step(found) {
        let _ = writeln!(text, "  {fixed}");
    }
    for why in found.omitted.iter().take(8) {
        let _ = writeln!(text, "  left out: {why}");
    }
    if found.omitted.len() > 8 {
        let more = found.omitted.len() - 8;
        let _ = writeln!(text, "  and {more} more, listed in the report");
    }
    text
}
