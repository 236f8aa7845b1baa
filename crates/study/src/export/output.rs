//! Writes an export.

use crate::explain::StudyError;
use crate::export::{ExportRequest, compute_export};
use crate::number_format::count;
use crate::output::Outcome;
use dwell_export::{Export, PartKind, Precision, c_files};
use dwell_findings::Record;
use dwell_scene::Scene;

/// The target of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportTarget {
    /// One header and one source in C99.
    C,
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
    let export = compute_export(scene, asked)?;
    let mut outcome = Outcome {
        summary: summary(scene, &export),
        record: record(&export),
        ..Outcome::default()
    };
    let files = match target {
        ExportTarget::C => c_files(&export),
    };
    outcome.summary += "  written:";
    for (path, text) in files {
        outcome.summary += &format!(" {path}");
        outcome.files.add(path, text);
    }
    outcome.summary += "\n";
    Ok(outcome)
}

fn summary(scene: &Scene, export: &Export) -> String {
    let (machine, measured) = (&export.machine, &export.measured);
    let numbers = match export.request.precision {
        Precision::Double => "double",
        Precision::Float => "single",
    };
    let cells = PartKind::ALL.map(|kind| {
        let part = &export.parts[kind as usize];
        if part.index.is_empty() {
            0
        } else {
            part.cell_count()
        }
    });
    let names = ["of motion", "of reactions", "of positions"];
    let cells = cells.into_iter().zip(names).filter(|(n, _)| *n > 0);
    let cells: Vec<String> = cells
        .map(|(n, of)| format!("{} {of}", count(n, "cell")))
        .collect();
    let [motion, all, step] = measured.operations;
    let mut text = format!(
        "{}: reduced model in {numbers} precision over {}\n  {}, {} bytes of constants; largest error {:.1e} of the largest value of each function (asked: {:e})\n  operations, at most: {motion} of the terms of motion, {all} with reactions, {step} of a step\n",
        scene.title,
        machine.coordinate,
        cells.join(", "),
        export.constant_bytes(),
        measured.errors.max(),
        export.request.accuracy,
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
    record.add("accuracy", "", export.request.accuracy);
    record.add("error", "", measured.errors.max());
    record.add("error.m", "", measured.errors.m);
    record.add("error.half_dm", "", measured.errors.half_dm);
    record.add("error.reactions", "", measured.errors.reactions);
    record.add_count("constants.bytes", export.constant_bytes());
    let [motion, all, step] = measured.operations;
    for (name, operations) in [("motion", motion), ("reactions", all), ("step", step)] {
        record.add_count(format!("operations.{name}"), operations as usize);
    }
    record
}
