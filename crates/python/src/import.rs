//! Models of other programs.

use crate::errors::Raise as _;
use dwell::ImportOptions;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;

/// The text of the scene, and what became of the parts of the file: each text, and whether something is lost.
#[pyfunction]
#[pyo3(signature = (path, drives, start, close, *, format=None, key=None, loops=None, fix=None, plane=true, tolerance=None))]
#[expect(
    clippy::too_many_arguments,
    reason = "keywords of a function in Python"
)]
pub(crate) fn import_model(
    py: Python<'_>,
    path: PathBuf,
    drives: Vec<String>,
    start: Vec<(String, f64)>,
    close: Vec<String>,
    format: Option<String>,
    key: Option<String>,
    loops: Option<String>,
    fix: Option<String>,
    plane: bool,
    tolerance: Option<f64>,
) -> PyResult<(String, Vec<(String, bool)>)> {
    let close = close
        .iter()
        .map(|text| text.parse())
        .collect::<Result<_, String>>();
    let options = ImportOptions {
        from: format
            .map(|name| name.parse())
            .transpose()
            .map_err(PyValueError::new_err)?,
        drives,
        key,
        start,
        close: close.map_err(PyValueError::new_err)?,
        loops,
        fix,
        spatial: !plane,
        tolerance,
    };
    let import = py.detach(|| dwell::import(path, &options)).or_raise(py)?;
    let finding = |one: &dwell::Finding| (one.to_string(), one.effect == dwell::Effect::Changes);
    Ok((
        import.scene.clone(),
        import.findings.iter().map(finding).collect(),
    ))
}
