//! Scenes and mechanisms in space.

use crate::errors::Raise as _;
use crate::interrupt::run;
use crate::machine::{Cycle, Equilibrium, Linear};
use crate::motion::{Rows, solver};
use crate::reduced::{Arrays, Table, with_threads};
use crate::scene::export_target;
use numpy::{IntoPyArray as _, PyReadonlyArray1};
use pyo3::prelude::*;
use std::path::PathBuf;

/// The description of a mechanism in space, read and checked.
#[pyclass(frozen, module = "dwell._native")]
pub(crate) struct SpaceScene {
    pub(crate) scene: dwell::space::Scene,
}

#[pymethods]
impl SpaceScene {
    #[new]
    fn new(py: Python<'_>, text: &str) -> PyResult<Self> {
        let scene = dwell::space::Scene::parse(text).or_raise(py)?;
        Ok(Self { scene })
    }

    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let scene = dwell::space::Scene::read(path).or_raise(py)?;
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

    fn check(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.scene.describe()).or_raise(py)
    }

    fn assemble(&self, py: Python<'_>) -> PyResult<SpaceMechanism> {
        let mechanism = py.detach(|| self.scene.assemble()).or_raise(py)?;
        Ok(SpaceMechanism { mechanism })
    }
}

/// An assembled mechanism in space: constant, shared between threads.
#[pyclass(frozen, module = "dwell._native")]
pub(crate) struct SpaceMechanism {
    mechanism: dwell::space::Mechanism,
}

#[pymethods]
impl SpaceMechanism {
    #[getter]
    fn actuators(&self) -> Vec<&str> {
        self.mechanism.actuators()
    }

    #[getter]
    fn reactions(&self) -> Vec<String> {
        self.mechanism.reactions()
    }

    /// The reactions that redundant constraints do not leave open.
    #[getter]
    fn determined_reactions(&self) -> Vec<String> {
        self.mechanism.determined_reactions()
    }

    #[getter]
    fn limits(&self) -> Option<(f64, f64)> {
        self.mechanism.limits()
    }

    #[getter]
    fn points(&self) -> Vec<(&str, Vec<&str>)> {
        self.mechanism.points()
    }

    #[getter]
    fn start(&self) -> Vec<f64> {
        self.mechanism.start()
    }

    fn at(
        &self,
        py: Python<'_>,
        q: Vec<f64>,
        q_dot: Vec<f64>,
        q_ddot: Vec<f64>,
        t: f64,
    ) -> PyResult<SpaceState> {
        let forces = self.mechanism.inverse_dynamics(t, &q, &q_dot, &q_ddot);
        Ok(SpaceState {
            forces: forces.or_raise(py)?,
        })
    }

    fn reduced(&self, py: Python<'_>, reactions: Vec<String>) -> PyResult<SpaceReducedModel> {
        let names = reactions.iter().map(String::as_str);
        let reduced = self.mechanism.reduced(names).or_raise(py)?;
        Ok(SpaceReducedModel { reduced })
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
}

/// The state of all bodies in space and all forces at one position.
#[pyclass(frozen, module = "dwell._native")]
pub(crate) struct SpaceState {
    forces: dwell::space::InverseDynamics,
}

#[pymethods]
impl SpaceState {
    fn position(&self, py: Python<'_>, point: &str) -> PyResult<[f64; 3]> {
        self.forces.kinematics().position(point).or_raise(py)
    }

    fn velocity(&self, py: Python<'_>, point: &str) -> PyResult<[f64; 3]> {
        self.forces.kinematics().velocity(point).or_raise(py)
    }

    fn acceleration(&self, py: Python<'_>, point: &str) -> PyResult<[f64; 3]> {
        self.forces.kinematics().acceleration(point).or_raise(py)
    }

    /// By axis of the body its components in the axes of the ground.
    fn axes(&self, py: Python<'_>, body: &str) -> PyResult<[[f64; 3]; 3]> {
        self.forces.kinematics().axes(body).or_raise(py)
    }

    fn angular_velocity(&self, py: Python<'_>, body: &str) -> PyResult<[f64; 3]> {
        self.forces.kinematics().angular_velocity(body).or_raise(py)
    }

    fn angular_acceleration(&self, py: Python<'_>, body: &str) -> PyResult<[f64; 3]> {
        let found = self.forces.kinematics().angular_acceleration(body);
        found.or_raise(py)
    }

    fn reaction(&self, py: Python<'_>, name: &str) -> PyResult<f64> {
        self.forces.reaction(name).or_raise(py)
    }

    fn actuator_force(&self, py: Python<'_>, name: &str) -> PyResult<f64> {
        self.forces.actuator_force(name).or_raise(py)
    }
}

/// The exact reduced model of a mechanism in space: constant, shared between threads.
#[pyclass(frozen, module = "dwell._native")]
pub(crate) struct SpaceReducedModel {
    reduced: dwell::space::ReducedModel,
}

#[pymethods]
impl SpaceReducedModel {
    #[getter]
    fn reactions(&self) -> Vec<String> {
        self.reduced.reactions()
    }

    #[getter]
    fn loads(&self) -> Vec<&str> {
        self.reduced.loads()
    }

    /// As of a mechanism in the plane.
    fn coefficients<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'py, f64>,
        threads: usize,
    ) -> PyResult<Arrays<'py>> {
        let q = q.as_array().to_vec();
        let batch = with_threads(py, threads, || self.reduced.batch(&q))?.or_raise(py)?;
        let all = [batch.m, batch.half_dm, batch.a, batch.b, batch.w, batch.c];
        Ok(all.map(|values| values.into_pyarray(py)))
    }

    /// The table of an accuracy.
    fn table(&self, py: Python<'_>, accuracy: f64) -> PyResult<Table> {
        let table = py.detach(|| self.reduced.table(accuracy)).or_raise(py)?;
        Ok(Table { table })
    }
}
