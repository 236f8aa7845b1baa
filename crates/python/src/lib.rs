//! The native half of the Python package `dwell`: thin classes over the crate `dwell`.
//!
//! The Python half has arrays of any shape, names of columns, pictures and builders.

// pyo3 passes arrays from Python by value.
#![expect(
    clippy::needless_pass_by_value,
    reason = "pyo3 hands over arrays and lists by value"
)]

mod errors;
mod import;
mod interrupt;
mod machine;
mod mechanism;
mod motion;
#[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
mod oldest_hypot;
mod reduced;
mod scene;
mod sweep;

use pyo3::prelude::*;

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("DwellError", module.py().get_type::<errors::DwellError>())?;
    module.add("SceneError", module.py().get_type::<errors::SceneError>())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<mechanism::Mechanism>()?;
    module.add_class::<mechanism::State>()?;
    module.add_class::<reduced::ReducedModel>()?;
    module.add_class::<reduced::Table>()?;
    module.add_class::<motion::Rows>()?;
    module.add_class::<machine::Equation>()?;
    module.add_function(wrap_pyfunction!(import::import_model, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep, module)?)?;
    Ok(())
}
