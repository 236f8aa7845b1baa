//! `dwell reduce --from`: reads the exported tables and the names of their columns.

use crate::Done;
use crate::options::Options;
use crate::reduction::ReduceArgs;
use crate::times::Times;
use dwell_report::npz_columns;
use dwell_scene::SceneError;
use dwell_study::{ColumnNames, ExportedTable, Outcome, StudyError, no_progress};
use std::fs;
use std::path::{Path, PathBuf};

/// The name of the results: that of the first file without extension.
pub(crate) fn name(options: &Options, runs: &[PathBuf]) -> String {
    let stem = runs.first().and_then(|path| path.file_stem());
    let of_file = || stem.map_or("runs".into(), |stem| stem.to_string_lossy());
    options
        .name
        .clone()
        .unwrap_or_else(|| of_file().into_owned())
}

/// The reduced parameters of the tables of run i and run ii, with their pictures.
pub(crate) fn reduce(
    options: &Options,
    arguments: &ReduceArgs,
    runs: &[PathBuf],
    times: &mut Times,
) -> Result<Done, StudyError> {
    let name = name(options, runs);
    let outcome = computed(&name, runs, arguments);
    times.add("computing");
    let outcome = outcome?.draw((options.pictures, options.picture_format), &no_progress)?;
    times.add("drawing");
    Ok(Done {
        outcome,
        exported: Some(name),
        ..Done::default()
    })
}

fn computed(name: &str, runs: &[PathBuf], arguments: &ReduceArgs) -> Result<Outcome, StudyError> {
    let tables = runs
        .iter()
        .map(|path| table(path))
        .collect::<Result<Vec<_>, _>>()?;
    let [one, two] = tables.as_slice() else {
        let message = format!("{} exported tables", tables.len());
        let help = "give the tables of run i and of run ii";
        return Err(SceneError::without_labels(message, Some(help.to_owned())).into());
    };
    let names = match &arguments.columns {
        Some(path) => {
            let text = fs::read_to_string(path).map_err(|e| unread(path, &e.to_string()))?;
            ColumnNames::read(&path.display().to_string(), &text)?
        }
        None => ColumnNames::default(),
    };
    dwell_study::reduce_runs(name, [one, two], &names, arguments.interpolation)
}

fn unread(path: &Path, reason: &str) -> SceneError {
    let help = "give the path of an exported table: CSV, or a NumPy archive (.npz)";
    let message = format!("`{}` cannot be read: {reason}", path.display());
    SceneError::without_labels(message, Some(help.to_owned()))
}

/// The table in a file; its first bytes distinguish archives from text.
fn table(path: &Path) -> Result<ExportedTable, SceneError> {
    let bytes = fs::read(path).map_err(|e| unread(path, &e.to_string()))?;
    let file = path.display().to_string();
    if bytes.starts_with(b"PK") {
        let columns = npz_columns(&bytes).map_err(|e| unread(path, &e.to_string()))?;
        return Ok(ExportedTable::of_columns(&file, columns));
    }
    let text = String::from_utf8(bytes)
        .map_err(|_| unread(path, "it is neither UTF-8 text nor a NumPy archive"))?;
    ExportedTable::read(&file, &text)
}
