//! Reduced models at many coordinates, without copies.

use crate::errors::{DwellError, Raise as _};
use numpy::{IntoPyArray as _, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// The exact reduced model: constant, shared between threads.
#[pyclass(frozen, module = "dwell._native")]
pub(crate) struct ReducedModel {
    pub(crate) reduced: dwell::ReducedModel,
}

/// m, ½m′, and by position a, b, w and c.
pub(crate) type Arrays<'py> = [Bound<'py, PyArray1<f64>>; 6];

#[pymethods]
impl ReducedModel {
    #[getter]
    fn reactions(&self) -> Vec<String> {
        self.reduced.reactions()
    }

    #[getter]
    fn loads(&self) -> Vec<&str> {
        self.reduced.loads()
    }

    /// The coefficients at many coordinates: m, ½m′; a and b by position and reaction; w by position and load; c by position,
    /// load and reaction.
    fn coefficients<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'py, f64>,
        threads: usize,
    ) -> PyResult<Arrays<'py>> {
        let copied;
        let q = match q.as_slice() {
            Ok(q) => q,
            Err(_) => {
                copied = q.as_array().to_vec();
                &copied
            }
        };
        let batch = with_threads(py, threads, || self.reduced.batch(q))?.or_raise(py)?;
        let all = [batch.m, batch.half_dm, batch.a, batch.b, batch.w, batch.c];
        Ok(all.map(|values| values.into_pyarray(py)))
    }

    /// The table with an accuracy.
    fn table(&self, py: Python<'_>, accuracy: f64) -> PyResult<Table> {
        let table = py.detach(|| self.reduced.table(accuracy)).or_raise(py)?;
        Ok(Table { table })
    }
}

/// Runs a computation on `threads` threads, or on all.
pub(crate) fn with_threads<T: Send>(
    py: Python<'_>,
    threads: usize,
    compute: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let pool = match threads {
        0 => None,
        count => Some(pool(count)?),
    };
    Ok(py.detach(|| match &pool {
        Some(pool) => pool.install(compute),
        None => compute(),
    }))
}

/// The thread pools by size: creating one takes longer than a small batch.
fn pool(threads: usize) -> PyResult<Arc<ThreadPool>> {
    static POOLS: LazyLock<Mutex<HashMap<usize, Arc<ThreadPool>>>> = LazyLock::new(Mutex::default);
    // A thread that panicked while holding the lock left the map intact.
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(pool) = pools.get(&threads) {
        return Ok(Arc::clone(pool));
    }
    let built = ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| DwellError::new_err(e.to_string()))?;
    let pool = Arc::clone(pools.entry(threads).or_insert(Arc::new(built)));
    Ok(pool)
}

/// A reduced model as piecewise polynomials.
#[pyclass(frozen, module = "dwell._native")]
pub(crate) struct Table {
    pub(crate) table: dwell::Table,
}

#[pymethods]
impl Table {
    #[getter]
    fn error_bound(&self) -> f64 {
        self.table.error_bound()
    }

    /// m, ½m′, a, b, w, c (by load and reaction) at one coordinate.
    #[expect(clippy::type_complexity, reason = "six lists that Python names")]
    fn at(
        &self,
        py: Python<'_>,
        q: f64,
    ) -> PyResult<(f64, f64, Vec<f64>, Vec<f64>, Vec<f64>, Vec<Vec<f64>>)> {
        let at = self.table.at(q).or_raise(py)?;
        Ok((at.m, at.half_dm, at.a, at.b, at.w, at.c))
    }

    fn to_text(&self, py: Python<'_>) -> PyResult<String> {
        self.table.to_text().or_raise(py)
    }
}
