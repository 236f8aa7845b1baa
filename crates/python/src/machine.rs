//! Equilibria, linearised motion, steady cycles, and the equation of motion.

use crate::errors::Raise as _;
use numpy::{IntoPyArray as _, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

/// An equilibrium.
#[derive(IntoPyObject)]
pub(crate) struct Equilibrium {
    coordinates: Vec<f64>,
    stability: &'static str,
    /// By mode: angular frequency, rad/s, damping ratio.
    modes: Vec<(f64, f64)>,
    /// 1/s, as real and imaginary parts.
    eigenvalues: Vec<[f64; 2]>,
}

impl From<dwell::Equilibrium> for Equilibrium {
    fn from(found: dwell::Equilibrium) -> Self {
        let modes = found.modes.iter();
        Self {
            coordinates: found.coordinates,
            stability: match found.stability {
                dwell::Stability::Asymptotic => "asymptotic",
                dwell::Stability::Centre => "centre",
                dwell::Stability::Unstable => "unstable",
                dwell::Stability::Neutral => "neutral",
                dwell::Stability::Undecided => "undecided",
            },
            modes: modes
                .map(|m| (m.angular_frequency, m.damping_ratio))
                .collect(),
            eigenvalues: found.eigenvalues,
        }
    }
}

/// A result with its gradient: name, unit, value; by number its path, unit, value, derivative and estimated error, which is zero of an
/// exact one; coordinates at which other extrema are as large.
#[derive(IntoPyObject)]
pub(crate) struct ResultGradient {
    name: String,
    unit: String,
    value: f64,
    paths: Vec<String>,
    units: Vec<String>,
    values: Vec<f64>,
    derivatives: Vec<f64>,
    errors: Vec<f64>,
    ties: Vec<f64>,
}

impl From<dwell::ResultGradient> for ResultGradient {
    fn from(found: dwell::ResultGradient) -> Self {
        let numbers = || found.numbers.iter();
        Self {
            paths: numbers().map(|n| n.path.clone()).collect(),
            units: numbers().map(|n| n.unit.clone()).collect(),
            values: numbers().map(|n| n.value).collect(),
            derivatives: numbers().map(|n| n.slope).collect(),
            errors: numbers()
                .map(|n| match n.method {
                    dwell::SlopeMethod::Exact => 0.0,
                    dwell::SlopeMethod::Differences(error) => error,
                })
                .collect(),
            name: found.name,
            unit: found.unit,
            value: found.value,
            ties: found.ties,
        }
    }
}

/// A linearised motion; matrices are lists of rows.
#[derive(IntoPyObject)]
pub(crate) struct Linear {
    states: Vec<String>,
    inputs: Vec<String>,
    outputs: Vec<String>,
    operating_point: Vec<f64>,
    a: Vec<Vec<f64>>,
    b: Vec<Vec<f64>>,
    c: Vec<Vec<f64>>,
    d: Vec<Vec<f64>>,
    eigenvalues: Vec<[f64; 2]>,
}

impl From<dwell::StateSpace> for Linear {
    fn from(found: dwell::StateSpace) -> Self {
        Self {
            states: found.states,
            inputs: found.inputs,
            outputs: found.outputs,
            operating_point: found.operating_point,
            a: found.a,
            b: found.b,
            c: found.c,
            d: found.d,
            eigenvalues: found.eigenvalues,
        }
    }
}

/// A steady cycle.
#[derive(IntoPyObject)]
pub(crate) struct Cycle {
    period: f64,
    mean_speed: f64,
    fluctuation: f64,
    is_stable: bool,
    works: Vec<(String, f64)>,
    flywheel: Option<f64>,
}

impl From<dwell::Cycle> for Cycle {
    fn from(found: dwell::Cycle) -> Self {
        Self {
            period: found.period,
            mean_speed: found.mean_speed,
            fluctuation: found.fluctuation,
            is_stable: found.is_stable,
            works: found.works,
            flywheel: found.flywheel,
        }
    }
}

/// The equation of motion with working memory, for one thread at a time.
#[pyclass(module = "dwell._native")]
pub(crate) struct Equation {
    pub(crate) equation: dwell::EquationOfMotion,
}

#[pymethods]
impl Equation {
    #[getter]
    fn initial_state<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.equation.initial_state().into_pyarray(py)
    }

    fn rates<'py>(
        &mut self,
        py: Python<'py>,
        t: f64,
        y: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let rates = match y.as_slice() {
            Ok(y) => self.equation.rates(t, y),
            Err(_) => self.equation.rates(t, &y.as_array().to_vec()),
        };
        Ok(PyArray1::from_slice(py, rates.or_raise(py)?))
    }

    /// Row by row.
    fn jacobian<'py>(
        &mut self,
        py: Python<'py>,
        t: f64,
        y: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let jacobian = self.equation.jacobian(t, &y.as_array().to_vec());
        Ok(jacobian.or_raise(py)?.into_pyarray(py))
    }
}
