//! Assembled mechanisms, and their state at one position.

use crate::errors::Raise as _;
use crate::interrupt::run;
use crate::machine::{Cycle, Equation, Equilibrium, Linear, ResultGradient};
use crate::motion::{Rows, solver};
use crate::reduced::ReducedModel;
use numpy::{IntoPyArray as _, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

/// An assembled mechanism: constant, shared between threads.
#[pyclass(frozen, module = "dwell._native")]
pub(crate) struct Mechanism {
    pub(crate) mechanism: dwell::Mechanism,
}

#[pymethods]
impl Mechanism {
    #[getter]
    fn actuators(&self) -> Vec<&str> {
        self.mechanism.actuators()
    }

    #[getter]
    fn reactions(&self) -> Vec<String> {
        self.mechanism.reactions()
    }

    /// The reactions that equilibrium determines.
    #[getter]
    fn determined_reactions(&self) -> Vec<String> {
        self.mechanism.determined_reactions()
    }

    /// 2 in the plane, 3 in space.
    #[getter]
    fn dimension(&self) -> usize {
        self.mechanism.dimension()
    }

    #[getter]
    fn limits(&self) -> Option<(f64, f64)> {
        self.mechanism.limits()
    }

    /// Bodies with their points, by name.
    #[getter]
    fn points(&self) -> Vec<(&str, Vec<&str>)> {
        self.mechanism.points()
    }

    /// The coordinates at assembly.
    #[getter]
    fn start(&self) -> Vec<f64> {
        self.mechanism.start()
    }

    /// The state and forces at one position.
    fn at(
        &self,
        py: Python<'_>,
        q: Vec<f64>,
        q_dot: Vec<f64>,
        q_ddot: Vec<f64>,
        t: f64,
    ) -> PyResult<State> {
        let forces = self.mechanism.inverse_dynamics(t, &q, &q_dot, &q_ddot);
        Ok(State {
            forces: forces.or_raise(py)?,
            dimension: self.mechanism.dimension(),
        })
    }

    /// A picture at coordinates, as SVG.
    fn svg(&self, py: Python<'_>, q: Vec<f64>) -> PyResult<String> {
        self.mechanism.svg(&q).or_raise(py)
    }

    /// x, y and z of points at many positions; `q` has the coordinates of one position after another.
    fn paths<'py>(
        &self,
        py: Python<'py>,
        points: Vec<String>,
        q: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let q = q.as_slice()?;
        let names = points.iter().map(String::as_str);
        let found = py
            .detach(|| self.mechanism.paths::<3>(names, q))
            .or_raise(py)?;
        Ok(found.into_flattened().into_pyarray(py))
    }

    fn reduced(&self, py: Python<'_>, reactions: Vec<String>) -> PyResult<ReducedModel> {
        let names = reactions.iter().map(String::as_str);
        let reduced = self.mechanism.reduced(names).or_raise(py)?;
        Ok(ReducedModel { reduced })
    }

    fn kinematics(&self, progress: &Bound<'_, PyAny>) -> PyResult<Rows> {
        run(progress, |_| self.mechanism.kinematics_along_motion()).map(Rows)
    }

    fn statics(&self, progress: &Bound<'_, PyAny>) -> PyResult<Rows> {
        run(progress, |_| self.mechanism.statics_along_motion()).map(Rows)
    }

    fn kinetostatics(&self, progress: &Bound<'_, PyAny>) -> PyResult<Rows> {
        run(progress, |_| self.mechanism.kinetostatics()).map(Rows)
    }

    fn simulate(
        &self,
        accuracy: Option<f64>,
        method: Option<&str>,
        tolerance: f64,
        sample_interval: Option<f64>,
        progress: &Bound<'_, PyAny>,
    ) -> PyResult<Rows> {
        let solver = solver(accuracy, method, tolerance, sample_interval)?;
        run(progress, |_| self.mechanism.simulate(&solver)).map(Rows)
    }

    fn period(&self, progress: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
        let found = run(progress, |_| self.mechanism.period())?;
        Ok((found.period, found.energy))
    }

    fn equilibria(&self, progress: &Bound<'_, PyAny>) -> PyResult<Vec<Equilibrium>> {
        let found = run(progress, |_| self.mechanism.equilibria())?;
        Ok(found.into_iter().map(Equilibrium::from).collect())
    }

    fn gradient(
        &self,
        results: Vec<String>,
        progress: &Bound<'_, PyAny>,
    ) -> PyResult<Vec<ResultGradient>> {
        let results: Vec<&str> = results.iter().map(String::as_str).collect();
        let found = run(progress, |_| self.mechanism.gradient(&results))?;
        Ok(found
            .results
            .into_iter()
            .map(ResultGradient::from)
            .collect())
    }

    fn linearise(&self, progress: &Bound<'_, PyAny>) -> PyResult<Linear> {
        run(progress, |_| self.mechanism.linearise()).map(Linear::from)
    }

    fn cycle(
        &self,
        accuracy: Option<f64>,
        method: Option<&str>,
        tolerance: f64,
        fluctuation: Option<f64>,
        progress: &Bound<'_, PyAny>,
    ) -> PyResult<Cycle> {
        let solver = solver(accuracy, method, tolerance, None)?;
        let found = run(progress, |_| self.mechanism.cycle(&solver, fluctuation));
        found.map(Cycle::from)
    }

    fn equation(&self, py: Python<'_>) -> PyResult<Equation> {
        let equation = self.mechanism.equation_of_motion().or_raise(py)?;
        Ok(Equation { equation })
    }
}

/// The state of all bodies and all forces at one position.
#[pyclass(frozen, module = "dwell._native")]
pub(crate) struct State {
    forces: dwell::InverseDynamics,
    /// 2 in the plane, 3 in space.
    dimension: usize,
}

impl State {
    fn numbers(&self, vector: [f64; 3]) -> Vec<f64> {
        vector[..self.dimension].to_vec()
    }

    /// An angular vector: its z component in the plane, all components in space.
    fn turning(&self, vector: [f64; 3]) -> Vec<f64> {
        let first = if self.dimension == 2 { 2 } else { 0 };
        vector[first..].to_vec()
    }
}

#[pymethods]
impl State {
    fn position(&self, py: Python<'_>, point: &str) -> PyResult<Vec<f64>> {
        let found = self.forces.kinematics().position(point);
        Ok(self.numbers(found.or_raise(py)?))
    }

    fn velocity(&self, py: Python<'_>, point: &str) -> PyResult<Vec<f64>> {
        let found = self.forces.kinematics().velocity(point);
        Ok(self.numbers(found.or_raise(py)?))
    }

    fn acceleration(&self, py: Python<'_>, point: &str) -> PyResult<Vec<f64>> {
        let found = self.forces.kinematics().acceleration(point);
        Ok(self.numbers(found.or_raise(py)?))
    }

    /// The axes of the body, each by its components in the axes of the ground.
    fn axes(&self, py: Python<'_>, body: &str) -> PyResult<[[f64; 3]; 3]> {
        self.forces.kinematics().axes(body).or_raise(py)
    }

    fn angle(&self, py: Python<'_>, body: &str) -> PyResult<f64> {
        self.forces.kinematics().angle(body).or_raise(py)
    }

    fn angular_velocity(&self, py: Python<'_>, body: &str) -> PyResult<Vec<f64>> {
        let found = self.forces.kinematics().angular_velocity(body);
        Ok(self.turning(found.or_raise(py)?))
    }

    fn angular_acceleration(&self, py: Python<'_>, body: &str) -> PyResult<Vec<f64>> {
        let found = self.forces.kinematics().angular_acceleration(body);
        Ok(self.turning(found.or_raise(py)?))
    }

    fn coordinate(&self, py: Python<'_>, name: &str) -> PyResult<[f64; 3]> {
        self.forces.kinematics().coordinate(name).or_raise(py)
    }

    fn reaction(&self, py: Python<'_>, name: &str) -> PyResult<f64> {
        self.forces.reaction(name).or_raise(py)
    }

    fn actuator_force(&self, py: Python<'_>, name: &str) -> PyResult<f64> {
        self.forces.actuator_force(name).or_raise(py)
    }
}
