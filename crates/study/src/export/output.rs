//! Writes an export.

use crate::explain::{StudyError, scene_error};
use crate::export::fmu_archive::fmu_archive;
use crate::export::{ExportRequest, compute_export};
use crate::number_format::count;
use crate::output::Outcome;
use dwell_export::{Export, FmiVersion, Identifiers, PartKind, Precision, c_files, rust_files};
use dwell_findings::Record;
use dwell_scene::{Scene, SceneLocation};

/// The target of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportTarget {
    /// One header and one source in C99.
    C,
    /// A Rust crate without the standard library.
    Rust,
    /// An FMU.
    Fmu(FmiVersion),
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
    if matches!(target, ExportTarget::Fmu(_)) && asked.request.precision == Precision::Float {
        return Err(scene_error(
            scene,
            "an FMU computes in double precision, as its interface does",
            "leave --float out",
            [(SceneLocation::Whole, "of this scene")],
        ));
    }
    let export = compute_export(scene, asked)?;
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
            for (path, text) in rust_files(&export) {
                add(path, text.into_bytes());
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
