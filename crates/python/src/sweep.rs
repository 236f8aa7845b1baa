//! Parameter sweeps.

use crate::errors::Raise as _;
use crate::interrupt::run;
use crate::scene::Scene;
use numpy::{IntoPyArray as _, PyArray1};
use pyo3::prelude::*;

/// The columns of a sweep: name, unit, values; and by row the reason if results are missing.
type Columns<'py> = (
    Vec<(String, String, Bound<'py, PyArray1<f64>>)>,
    Vec<Option<String>>,
);

/// Computes every combination of the varied numbers.
#[pyfunction]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    vary: Vec<(String, String)>,
    results: Vec<String>,
    samples: Option<u64>,
    seed: u64,
    progress: &Bound<'py, PyAny>,
) -> PyResult<Columns<'py>> {
    let mut sweep = dwell::Sweep::new(&scene.get().scene);
    for (path, variation) in &vary {
        sweep = sweep.vary(path, variation);
    }
    for result in &results {
        sweep = sweep.result(result);
    }
    if let Some(samples) = samples {
        sweep = sweep.samples(samples, seed);
    }
    let found = run(progress, |steps| {
        sweep.run_with_progress(&|done, all| steps.show(done, all))
    })?;
    let names: Vec<_> = found
        .columns()
        .map(|(name, unit)| (name.to_owned(), unit.to_owned()))
        .collect();
    let mut columns = Vec::with_capacity(names.len());
    for (name, unit) in names {
        let values = found.column(&name).or_raise(py)?.into_pyarray(py);
        columns.push((name, unit, values));
    }
    Ok((columns, found.messages))
}
