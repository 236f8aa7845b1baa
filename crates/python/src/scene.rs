//! Scenes.

use crate::errors::{Raise as _, keep};
use crate::mechanism::Mechanism;
use dwell::{ExportTarget, FmiVersion, Language};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;

/// The description of a mechanism, read and checked.
#[pyclass(frozen, module = "dwell._native")]
pub(crate) struct Scene {
    pub(crate) scene: dwell::Scene,
}

#[pymethods]
impl Scene {
    #[new]
    fn new(py: Python<'_>, text: &str) -> PyResult<Self> {
        let scene = dwell::Scene::parse(text).or_raise(py)?;
        Ok(Self { scene })
    }

    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let scene = dwell::Scene::read(path).or_raise(py)?;
        Ok(Self { scene })
    }

    #[getter]
    fn title(&self) -> &str {
        self.scene.title()
    }

    #[getter]
    fn text(&self) -> &str {
        self.scene.text()
    }

    #[getter]
    fn warnings(&self) -> Vec<&str> {
        self.scene.warnings().collect()
    }

    fn value(&self, py: Python<'_>, path: &str) -> PyResult<f64> {
        self.scene.value(path).or_raise(py)
    }

    fn with_value(&self, py: Python<'_>, path: &str, value: f64) -> PyResult<Self> {
        let scene = self.scene.with_value(path, value).or_raise(py)?;
        Ok(Self { scene })
    }

    /// Sets the magnitude of a load to a Python function of a tuple of signals, with breakpoints of some of them.
    fn with_function(
        &self,
        py: Python<'_>,
        load: &str,
        signals: Vec<String>,
        function: Py<PyAny>,
        breakpoints: Vec<(String, Vec<f64>)>,
    ) -> PyResult<Self> {
        let names: Vec<&str> = signals.iter().map(String::as_str).collect();
        let called = move |signals: &[f64]| {
            Python::attach(|py| {
                let tuple = pyo3::types::PyTuple::new(py, signals)?;
                function.call1(py, tuple)?.extract::<f64>(py)
            })
            // A failing function has no value: the evaluation fails, names the load, and is raised from this exception.
            .unwrap_or_else(|error| {
                keep(error);
                f64::NAN
            })
        };
        let mut magnitude = dwell::Magnitude::function(&names, called);
        for (signal, values) in breakpoints {
            magnitude = magnitude.breakpoints(&signal, &values);
        }
        let scene = self.scene.with_magnitude(load, &magnitude).or_raise(py)?;
        Ok(Self { scene })
    }

    /// Files of an export: path and content of each.
    fn export(
        &self,
        py: Python<'_>,
        target: &str,
        accuracy: f64,
    ) -> PyResult<Vec<(String, Vec<u8>)>> {
        let target = export_target(target)?;
        py.detach(|| self.scene.export(target, accuracy))
            .or_raise(py)
    }

    /// The closed forms as a function in Python.
    fn closed_form(&self, py: Python<'_>, reaction: Option<&str>) -> PyResult<String> {
        py.detach(|| self.scene.closed_form(Language::Python, reaction))
            .or_raise(py)
    }

    fn check(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.scene.describe()).or_raise(py)
    }

    fn assemble(&self, py: Python<'_>) -> PyResult<Mechanism> {
        let mechanism = py.detach(|| self.scene.assemble()).or_raise(py)?;
        Ok(Mechanism { mechanism })
    }
}

/// A target of exports by its name.
pub(crate) fn export_target(name: &str) -> PyResult<ExportTarget> {
    Ok(match name {
        "c" => ExportTarget::C,
        "exact-c" => ExportTarget::ExactC,
        "rust" => ExportTarget::Rust,
        "matlab" => ExportTarget::Matlab,
        "fmu" => ExportTarget::Fmu(FmiVersion::Three),
        "exact-fmu" => ExportTarget::ExactFmu(FmiVersion::Three),
        "fmu2" => ExportTarget::Fmu(FmiVersion::Two),
        "exact-fmu2" => ExportTarget::ExactFmu(FmiVersion::Two),
        other => {
            let message = format!("there is no target `{other}`");
            return Err(PyValueError::new_err(message));
        }
    })
}
