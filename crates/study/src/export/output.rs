//! Writes an export.

use crate::explain::{StudyError, scene_error};
use crate::export::{ExportRequest, fmu_archive};
use crate::number_format::{coordinate_unit, count};
use crate::output::Outcome;
use dwell_export::{
    Export, FmiVersion, Identifiers, PartKind, Precision, SeveralFreedomsExport, c_files,
    c_files_of_several_freedoms, matlab_files, rust_files,
};
use dwell_findings::{Column, Record, Table};
use dwell_report::{Number, TableFormat, json};
use dwell_scene::{SceneFile, SceneLocation};

/// The target of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportTarget {
    /// One header and one source in C99.
    C,
    /// A Rust crate without the standard library.
    Rust,
    /// An FMU.
    Fmu(FmiVersion),
    /// The cells as a file of MATLAB, and functions that evaluate and integrate.
    Matlab,
    /// The rows of `dwell reduce` in a format of tables.
    Rows(TableFormat),
    /// The rows as a JSON list of name, unit and values of every column.
    Json,
}

/// The code of the equations of motion of several coordinates.
pub(crate) fn several_freedoms_outcome(export: &SeveralFreedomsExport) -> Outcome {
    let (machine, errors) = (&export.machine, export.errors);
    let names: Vec<&str> = machine
        .coordinates
        .iter()
        .map(|c| c.name.as_str())
        .collect();
    let operations = export.code.each_ref().map(|code| code.operations.len());
    let functions = export.code.each_ref().map(|code| code.functions());
    let mut outcome = Outcome {
        summary: format!(
            "{}: equations of motion over {}\n  the model's own operations; largest error {:.1e} of the largest value of each kind of term\n  operations: {} of the terms of motion, {} of those of the reactions; square roots, sines, cosines and angles among them: {} and {}\n",
            machine.title,
            names.join(", "),
            errors.max(),
            operations[0],
            operations[1],
            functions[0],
            functions[1],
        ),
        ..Outcome::default()
    };
    for sentence in &machine.left_out {
        outcome.summary += &format!("  left out: {sentence}\n");
    }
    let record = &mut outcome.record;
    record.add("error", "", errors.max());
    record.add("error.mass_matrix", "", errors.mass_matrix);
    record.add("error.velocity_terms", "", errors.velocity_terms);
    record.add("error.loads", "", errors.loads);
    record.add("error.reactions", "", errors.reactions);
    for (name, count) in ["motion", "reactions", "positions"]
        .into_iter()
        .zip(operations)
    {
        record.add_count(format!("operations.{name}"), count);
    }
    let files = of_texts(c_files_of_several_freedoms(export));
    add_files(&mut outcome, files);
    outcome
}

/// Writes the machine for a target: its rows, or its fitted functions.
pub(crate) fn export_machine(
    scene: &SceneFile,
    target: ExportTarget,
    asked: &ExportRequest,
    table: impl FnOnce() -> Result<Table, StudyError>,
    fitted: impl FnOnce() -> Result<Export, StudyError>,
) -> Result<Outcome, StudyError> {
    reject_options(scene, target, asked)?;
    match target {
        ExportTarget::Rows(format) => return rows(scene, &table()?, Some(format)),
        ExportTarget::Json => return rows(scene, &table()?, None),
        ExportTarget::C | ExportTarget::Rust | ExportTarget::Fmu(_) | ExportTarget::Matlab => {}
    }
    let export = fitted()?;
    let mut outcome = Outcome::default();
    outcome.summary = summary(scene, &export, &mut outcome.record);
    let mut about_library = String::new();
    let files: Vec<(String, Vec<u8>)> = match target {
        ExportTarget::C => of_texts(c_files(&export)),
        ExportTarget::Rust => of_texts(rust_files(&export).into_iter().flatten()),
        ExportTarget::Matlab => matlab_files(&export).into_iter().flatten().collect(),
        ExportTarget::Fmu(version) => {
            let (bytes, sentence) = fmu_archive(scene, &export, version)?;
            about_library = format!("  {sentence}\n");
            let prefix = Identifiers::new(&export.machine).prefix;
            vec![(format!("{prefix}.fmu"), bytes)]
        }
        // Their rows are written already.
        ExportTarget::Rows(_) | ExportTarget::Json => Vec::new(),
    };
    add_files(&mut outcome, files);
    outcome.summary += &about_library;
    Ok(outcome)
}

/// The bytes of texts.
fn of_texts(files: impl IntoIterator<Item = (String, String)>) -> Vec<(String, Vec<u8>)> {
    let files = files.into_iter();
    files
        .map(|(path, text)| (path, text.into_bytes()))
        .collect()
}

/// Adds files, with a line about each.
fn add_files(outcome: &mut Outcome, files: Vec<(String, Vec<u8>)>) {
    for (path, bytes) in files {
        outcome.summary += &format!("  written: {path}\n");
        outcome.files.add(path, bytes);
    }
}

/// Rejects options that a target does not have.
fn reject_options(
    scene: &SceneFile,
    target: ExportTarget,
    asked: &ExportRequest,
) -> Result<(), StudyError> {
    if matches!(target, ExportTarget::Fmu(_)) && asked.request.precision == Precision::Float {
        return Err(scene_error(
            scene,
            "an FMU computes in double precision, as its interface does",
            "leave --float out",
            [(SceneLocation::Whole, "of this scene")],
        ));
    }
    let takes_operations = matches!(target, ExportTarget::C | ExportTarget::Fmu(_));
    if asked.exact && !takes_operations {
        return Err(scene_error(
            scene,
            "an exact export is C or an FMU: its operations need square roots, sines and cosines",
            "leave --exact out, or export to `c` or `fmu`",
            [(SceneLocation::Whole, "of this scene")],
        ));
    }
    Ok(())
}

/// The rows of the reduced model, evaluated exactly.
fn rows(
    scene: &SceneFile,
    table: &Table,
    format: Option<TableFormat>,
) -> Result<Outcome, StudyError> {
    let mut outcome = Outcome::default();
    let stem = format!("{}-reduced", scene.name);
    match format {
        Some(format) => outcome.files.add_table(&stem, table, &[format])?,
        None => {
            let column = |(k, column): (usize, &Column)| {
                let values = table.rows.iter().map(|row| Number(row[k]));
                (column.name.clone(), column.unit.clone(), values.collect())
            };
            let columns: Vec<(String, String, Vec<Number>)> =
                table.columns.iter().enumerate().map(column).collect();
            outcome.files.add(format!("{stem}.json"), json(&columns)?);
        }
    }
    let count = table.rows.len();
    outcome.record.add_count("positions", count);
    outcome.summary = format!("{}: {count} positions, evaluated exactly\n", scene.title);
    Ok(outcome)
}

/// The summary of an export; its numbers are recorded.
fn summary(scene: &SceneFile, export: &Export, record: &mut Record) -> String {
    let (machine, measured) = (&export.machine, &export.measured);
    let (title, coordinate) = (&scene.title, &machine.coordinate);
    let numbers = match export.request.precision {
        Precision::Double => "double",
        Precision::Float => "single",
    };
    let worth = worth(export, record);
    let [motion, all, step] = measured.operations;
    let mut text = format!(
        "{title}: reduced model in {numbers} precision over {coordinate}\n  {worth}\n  operations, at most: {motion} of the terms of motion, {all} with reactions, {step} of a step\n"
    );
    if let Some([q, q_dot]) = measured.step_error {
        let unit = coordinate_unit(machine.is_angle);
        record.add("step_error.q", unit, q);
        record.add("step_error.q_dot", &format!("{unit}/s"), q_dot);
        text +=
            &format!("  after 1 s of steps of 1 ms: {q:.1e} {unit} and {q_dot:.1e} {unit}/s off\n");
    }
    for (name, operations) in [("motion", motion), ("reactions", all), ("step", step)] {
        record.add_count(format!("operations.{name}"), operations as usize);
    }
    for sentence in &machine.left_out {
        text += &format!("  left out: {sentence}\n");
    }
    text
}

/// The text on the errors and the size of an export.
fn worth(export: &Export, record: &mut Record) -> String {
    let errors = &export.measured.errors;
    // Of an exact export, nothing was asked for.
    if export.code.is_none() {
        record.add("accuracy", "", export.request.accuracy);
    }
    let error = errors.max();
    record.add("error", "", error);
    record.add("error.m", "", errors.m);
    record.add("error.half_dm", "", errors.half_dm);
    record.add("error.reactions", "", errors.reactions);
    record.add_count("constants.bytes", export.constant_bytes());
    let mut cells = Vec::new();
    let names = ["motion", "reactions", "positions"];
    for (kind, name) in PartKind::ALL.into_iter().zip(names) {
        let part = &export.parts[kind as usize];
        // None where all its functions are constants.
        let number = if part.index.is_empty() {
            0
        } else {
            part.cell_count()
        };
        record.add_count(format!("cells.{name}"), number);
        if number > 0 {
            cells.push(format!("{} of {name}", count(number, "cell")));
        }
    }
    if export.code.is_some() {
        let [of_motion, of_all] = export.functions();
        return format!(
            "the model's own operations; largest error {error:.1e} of the largest value of each function\n  square roots, sines, cosines and angles: {of_motion} of the terms of motion, {of_all} with reactions"
        );
    }
    format!(
        "{}, {} bytes of constants; largest error {error:.1e} of the largest value of each function (asked: {:e})",
        cells.join(", "),
        export.constant_bytes(),
        export.request.accuracy,
    )
}
