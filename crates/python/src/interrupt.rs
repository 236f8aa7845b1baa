//! Long computations without the interpreter's lock.

use pyo3::prelude::*;

/// Runs a computation while other Python threads go on.
pub(crate) fn run<T: Send>(py: Python<'_>, compute: impl FnOnce() -> T + Send) -> PyResult<T> {
    Ok(py.detach(compute))
}
