//! Writes an export.

use crate::explain::{StudyError, actuator_labels, scene_error};
use crate::export::{
    ExportRequest, compute_export, compute_export_of_several_freedoms, fmu_archive,
};
use crate::number_format::count;
use crate::output::Outcome;
use crate::reduce::compute::compute_reduction;
use dwell_export::{
    Export, FmiVersion, Identifiers, PartKind, Precision, c_files, c_files_of_several_freedoms,
    matlab_files, rust_files,
};
use dwell_findings::{Column, Record, Table};
use dwell_report::{Number, TableFormat, json};
use dwell_scene::{Scene, SceneFile, SceneLocation};

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
    /// The same as a JSON list of name, unit and values of every column.
    Json,
}

/// Exports the reduced model of a scene's machine.
///
/// # Errors
/// [`StudyError::Scene`] where the scene cannot be exported: it says why and what to change.
pub fn export(
    scene: &Scene,
    target: ExportTarget,
    asked: &ExportRequest,
) -> Result<Outcome, StudyError> {
    if scene.mechanism.actuators.len() > 1 {
        return export_several_freedoms(scene, target, asked);
    }
    let table = || Ok(compute_reduction(scene, None)?.table());
    export_machine(scene, target, asked, table, || compute_export(scene, asked))
}

/// Writes the equations of motion of a scene with several actuators.
fn export_several_freedoms(
    scene: &Scene,
    target: ExportTarget,
    asked: &ExportRequest,
) -> Result<Outcome, StudyError> {
    if target != ExportTarget::C {
        let given = count(scene.mechanism.actuators.len(), "actuator");
        return Err(scene_error(
            scene,
            format!("the scene has {given}: several degrees of freedom are exported as C alone"),
            "export to `c`; or give exactly one actuator in [actuators]",
            actuator_labels(scene, "drives it"),
        ));
    }
    let export = compute_export_of_several_freedoms(scene, asked)?;
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
    for (path, text) in c_files_of_several_freedoms(&export) {
        outcome.summary += &format!("  written: {path}\n");
        outcome.files.add(path, text.into_bytes());
    }
    Ok(outcome)
}

/// Writes what a target needs of a machine: its rows, or its fitted functions.
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
    let mut outcome = Outcome {
        summary: summary(scene, &export),
        record: record(&export),
        ..Outcome::default()
    };
    let mut add = |path: String, bytes: Vec<u8>| {
        outcome.summary += &format!("  written: {path}\n");
        outcome.files.add(path, bytes);
    };
    match target {
        ExportTarget::C => {
            for (path, text) in c_files(&export) {
                add(path, text.into_bytes());
            }
        }
        ExportTarget::Rust => {
            for (path, text) in rust_files(&export).into_iter().flatten() {
                add(path, text.into_bytes());
            }
        }
        // Their rows are written already.
        ExportTarget::Rows(_) | ExportTarget::Json => {}
        ExportTarget::Matlab => {
            for (path, bytes) in matlab_files(&export).into_iter().flatten() {
                add(path, bytes);
            }
        }
        ExportTarget::Fmu(version) => {
            let (bytes, sentence) = fmu_archive(scene, &export, version)?;
            add(
                format!("{}.fmu", Identifiers::new(&export.machine).prefix),
                bytes,
            );
            outcome.summary += &format!("  {sentence}\n");
        }
    }
    Ok(outcome)
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
            let columns = table.columns.iter().enumerate();
            let columns: Vec<(String, String, Vec<Number>)> = columns.map(column).collect();
            outcome.files.add(format!("{stem}.json"), json(&columns)?);
        }
    }
    let count = table.rows.len();
    outcome.record.add_count("positions", count);
    outcome.summary = format!("{}: {count} positions, evaluated exactly\n", scene.title);
    Ok(outcome)
}

fn summary(scene: &SceneFile, export: &Export) -> String {
    let (machine, measured) = (&export.machine, &export.measured);
    let numbers = match export.request.precision {
        Precision::Double => "double",
        Precision::Float => "single",
    };
    let counts = PartKind::ALL.map(|kind| cells(export, kind));
    let names = ["of motion", "of reactions", "of positions"];
    let cells = counts.into_iter().zip(names).filter(|(n, _)| *n > 0);
    let cells: Vec<String> = cells
        .map(|(n, of)| format!("{} {of}", count(n, "cell")))
        .collect();
    let [motion, all, step] = measured.operations;
    let (title, coordinate, error) = (&scene.title, &machine.coordinate, measured.errors.max());
    let worth = match export.code {
        Some(_) => {
            let [of_motion, of_all] = export.functions();
            format!(
                "the model's own operations; largest error {error:.1e} of the largest value of each function\n  square roots, sines, cosines and angles: {of_motion} of the terms of motion, {of_all} with reactions"
            )
        }
        None => format!(
            "{}, {} bytes of constants; largest error {error:.1e} of the largest value of each function (asked: {:e})",
            cells.join(", "),
            export.constant_bytes(),
            export.request.accuracy,
        ),
    };
    let mut text = format!(
        "{title}: reduced model in {numbers} precision over {coordinate}\n  {worth}\n  operations, at most: {motion} of the terms of motion, {all} with reactions, {step} of a step\n"
    );
    if let Some([q, q_dot]) = measured.step_error {
        let unit = if machine.is_angle { "rad" } else { "m" };
        text +=
            &format!("  after 1 s of steps of 1 ms: {q:.1e} {unit} and {q_dot:.1e} {unit}/s off\n");
    }
    for sentence in &machine.left_out {
        text += &format!("  left out: {sentence}\n");
    }
    text
}

fn record(export: &Export) -> Record {
    let measured = &export.measured;
    let mut record = Record::default();
    // Of an exact export, nothing was asked for.
    if export.code.is_none() {
        record.add("accuracy", "", export.request.accuracy);
    }
    record.add("error", "", measured.errors.max());
    record.add("error.m", "", measured.errors.m);
    record.add("error.half_dm", "", measured.errors.half_dm);
    record.add("error.reactions", "", measured.errors.reactions);
    record.add_count("constants.bytes", export.constant_bytes());
    for (kind, name) in PartKind::ALL
        .into_iter()
        .zip(["motion", "reactions", "positions"])
    {
        record.add_count(format!("cells.{name}"), cells(export, kind));
    }
    if let Some([q, q_dot]) = measured.step_error {
        let unit = if export.machine.is_angle { "rad" } else { "m" };
        record.add("step_error.q", unit, q);
        record.add("step_error.q_dot", &format!("{unit}/s"), q_dot);
    }
    let [motion, all, step] = measured.operations;
    for (name, operations) in [("motion", motion), ("reactions", all), ("step", step)] {
        record.add_count(format!("operations.{name}"), operations as usize);
    }
    record
}

/// Cells of a part; none where all its functions are constants.
fn cells(export: &Export, kind: PartKind) -> usize {
    let part = &export.parts[kind as usize];
    match part.index.is_empty() {
        true => 0,
        false => part.cell_count(),
    }
}
