//! Errors as Python exceptions: the message of the command, with line and column.

use miette::{GraphicalReportHandler, GraphicalTheme};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};

pyo3::create_exception!(
    dwell,
    DwellError,
    PyValueError,
    "What the mechanism cannot do, or has no part of that name."
);
pyo3::create_exception!(
    dwell,
    SceneError,
    DwellError,
    "What is wrong in a scene. `line` and `column` (from 1) say where, `help` what to try; both may be None."
);

/// The last exception of a Python function of a load; the error of the failed evaluation is raised from it.
static RAISED: Mutex<Option<PyErr>> = Mutex::new(None);

/// Stores an exception of a function of a load.
pub(crate) fn keep(error: PyErr) {
    // A thread that panicked while holding the lock left an intact value.
    *RAISED.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
}

/// An error of the library as an exception.
pub(crate) fn raise(py: Python<'_>, error: &dwell::Error) -> PyErr {
    let raised = exception(py, error);
    let cause = RAISED.lock().unwrap_or_else(PoisonError::into_inner).take();
    if cause.is_some() {
        raised.set_cause(py, cause);
    }
    raised
}

fn exception(py: Python<'_>, error: &dwell::Error) -> PyErr {
    let Some(scene) = error.scene_error() else {
        return DwellError::new_err(error.to_string());
    };
    let mut text = String::from("\n");
    let theme = GraphicalTheme::unicode_nocolor();
    let handler = GraphicalReportHandler::new_themed(theme).with_width(100);
    if handler.render_report(&mut text, scene).is_err() {
        text = error.to_string();
    }
    let raised = SceneError::new_err(text);
    let errors = scene.errors();
    let first = errors.first().unwrap_or(scene);
    let place = line_and_column(first);
    let value = raised.value(py);
    // Setting an attribute of a new exception fails only if memory is exhausted.
    let _ = value.setattr("line", place.map(|(line, _)| line));
    let _ = value.setattr("column", place.map(|(_, column)| column));
    let _ = value.setattr("help", first.help.clone());
    let _ = value.setattr("message", first.message.clone());
    raised
}

/// Line and column, from 1, of the first place of an error.
fn line_and_column(error: &dwell_scene::SceneError) -> Option<(usize, usize)> {
    let text = error.text.as_ref()?.inner();
    let before = text.get(..error.labels.first()?.offset())?;
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next()?.chars().count() + 1;
    Some((line, column))
}

/// Adds the exception to a result.
pub(crate) trait Raise<T> {
    /// The value, or the exception.
    fn or_raise(self, py: Python<'_>) -> PyResult<T>;
}

impl<T> Raise<T> for Result<T, dwell::Error> {
    fn or_raise(self, py: Python<'_>) -> PyResult<T> {
        self.map_err(|error| raise(py, &error))
    }
}
