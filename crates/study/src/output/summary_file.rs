//! The summary of a command for programs: `NAME-COMMAND.json`.

use super::Outcome;
use crate::explain::StudyError;
use dwell_report::{Message, SceneRecord, Summary};
use dwell_scene::{SceneError, SceneFile};

/// The result of a command, in addition to its outcome.
#[derive(Debug, Clone, Copy)]
pub struct CommandResult<'a> {
    /// The name of the command.
    pub command: &'a str,
    /// Its scene, if it reads one.
    pub scene: Option<&'a SceneFile>,
    /// The path of the file, relative to the output folder.
    pub path: &'a str,
    /// The exit status.
    pub status: u8,
    /// Errors that do not keep the results from being written.
    pub errors: &'a [SceneError],
}

/// Adds the summary to the files of an outcome that is drawn.
///
/// # Errors
/// [`StudyError::Report`] if it cannot be written as JSON.
pub fn add_summary(outcome: &mut Outcome, result: &CommandResult<'_>) -> Result<(), StudyError> {
    let scene = result.scene.map(|scene| SceneRecord {
        name: scene.name.clone(),
        title: scene.title.clone(),
        sha256: scene.hash(),
    });
    let warnings = result.scene.iter().flat_map(|scene| &scene.warnings);
    let warnings = warnings.map(|warning| Message {
        severity: "warning",
        text: warning.message.clone(),
        help: None,
    });
    let errors = result.errors.iter().flat_map(SceneError::errors);
    let errors = errors.map(|error| Message {
        severity: "error",
        text: error.message.clone(),
        help: error.help.clone(),
    });
    let written = outcome.files.iter();
    let written = written.map(|(path, _)| path.display().to_string());
    let own = std::iter::once(result.path.to_owned());
    let record = std::mem::take(&mut outcome.record);
    let others = record.files.iter().cloned();
    let mut files: Vec<String> = written.chain(own).chain(others).collect();
    files.sort();
    let summary = Summary {
        command: result.command,
        version: env!("CARGO_PKG_VERSION"),
        scene,
        status: result.status,
        status_meaning: status_meaning(result.status),
        record,
        findings: &outcome.findings,
        printed: &outcome.summary,
        messages: warnings.chain(errors).collect(),
        files,
    };
    let text = summary.json()?;
    outcome.files.add(result.path, text);
    Ok(())
}

/// The meaning of an exit status.
fn status_meaning(status: u8) -> &'static str {
    match status {
        0 => "success",
        1 => "not all results can be trusted: a check or a message says why",
        _ => "invalid input: a message says where",
    }
}
