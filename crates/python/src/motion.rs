//! Motions as rows, and settings of their integration.

use crate::errors::{DwellError, Raise as _, raise};
use numpy::{IntoPyArray as _, PyArray1};
use pyo3::prelude::*;

/// The rows of a motion.
#[pyclass(frozen, module = "dwell._native")]
pub(crate) struct Rows(pub(crate) dwell::MotionResults);

#[pymethods]
impl Rows {
    /// Names and units.
    #[getter]
    fn columns(&self) -> Vec<(&str, &str)> {
        self.0.columns().collect()
    }

    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(self.0.column(name).or_raise(py)?.into_pyarray(py))
    }

    #[getter]
    fn events(&self) -> Vec<(f64, String)> {
        self.0.events.clone()
    }

    #[getter]
    fn estimated_error(&self) -> Option<f64> {
        self.0.estimated_error
    }

    /// The reason why it ended early, as an exception.
    #[getter]
    fn early_stop(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        let error = self.0.early_stop.as_ref()?;
        Some(raise(py, error).into_value(py).into_any())
    }
}

/// The settings of an integration, from the arguments in Python.
pub(crate) fn solver(
    accuracy: Option<f64>,
    method: Option<&str>,
    tolerance: f64,
    sample_interval: Option<f64>,
) -> PyResult<dwell::Solver> {
    let solver = match (accuracy, method) {
        (Some(_), Some(_)) => {
            let message =
                "give `accuracy`, or `method` with `tolerance`: an accuracy chooses its method";
            return Err(DwellError::new_err(message));
        }
        (Some(accuracy), None) => dwell::Solver::accuracy(accuracy),
        (None, name) => dwell::Solver::method(find_method(name.unwrap_or("bdf"))?, tolerance),
    };
    Ok(match sample_interval {
        Some(interval) => solver.sample_interval(interval),
        None => solver,
    })
}

fn find_method(name: &str) -> PyResult<dwell::Method> {
    let plain = |text: &str| text.to_lowercase().replace('-', "");
    let mut all = dwell::Method::ALL.into_iter();
    let found = all.find(|method| plain(method.name()) == plain(name));
    found.ok_or_else(|| {
        let names: Vec<&str> = dwell::Method::ALL.iter().map(|m| m.name()).collect();
        DwellError::new_err(format!(
            "there is no method `{name}`: there are {}",
            names.join(", ")
        ))
    })
}
