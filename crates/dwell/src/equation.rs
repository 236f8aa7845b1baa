//! The equation of a free motion as a function, for your own integrators.

use crate::error::Error;
use dwell_dynamics::{DynamicsError, Machine, MachineWorkspace};
use dwell_numerics::{Dual, Scalar as _};
use dwell_study::StudyScene;
use std::fmt;
use std::sync::Arc;

/// The equation of motion of a machine, with the working memory of one thread.
///
/// Loads and drives are evaluated at (t, y). Your integrator has to locate their switches itself.
///
/// ```
/// # let study = dwell::Scene::read("../../validation/single-dwell/scene.toml")?.assemble()?;
/// let mut equation = study.equation_of_motion()?;
/// let y = equation.initial_state();
/// let jacobian = equation.jacobian(0.0, &y)?; // row by row
/// assert_eq!(jacobian[..2], [0.0, 1.0]);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct EquationOfMotion(Box<dyn EquationSource>);

impl EquationOfMotion {
    pub(crate) fn new(source: Box<dyn EquationSource>) -> Self {
        Self(source)
    }

    /// The states at t = 0: rad or m, per s.
    ///
    /// ```
    /// # let study = dwell::Scene::read("../../validation/single-dwell/scene.toml")?.assemble()?;
    /// assert_eq!(study.equation_of_motion()?.initial_state().len(), 2);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn initial_state(&self) -> Vec<f64> {
        self.0.initial_state()
    }

    /// ẏ at time t, s. In the plane it allocates nothing.
    ///
    /// # Errors
    /// [`Error::State`] for a wrong number of states; [`Error::Study`] if there is no pose or no inertia at this state, or a load has no value.
    ///
    /// ```
    /// # let study = dwell::Scene::read("../../validation/single-dwell/scene.toml")?.assemble()?;
    /// let mut equation = study.equation_of_motion()?;
    /// let rates = equation.rates(0.0, &[0.5, 2.0])?;
    /// assert_eq!(rates[0], 2.0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn rates(&mut self, t: f64, y: &[f64]) -> Result<&[f64], Error> {
        self.0.rates(t, y)
    }

    /// ∂ẏ/∂y at time t, s, row by row, by dual numbers: exact to rounding.
    ///
    /// # Errors
    /// As [`EquationOfMotion::rates`].
    ///
    /// ```
    /// # let study = dwell::Scene::read("../../validation/single-dwell/scene.toml")?.assemble()?;
    /// let mut equation = study.equation_of_motion()?;
    /// assert_eq!(equation.jacobian(0.0, &[0.5, 2.0])?.len(), 4);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn jacobian(&mut self, t: f64, y: &[f64]) -> Result<Vec<f64>, Error> {
        self.0.jacobian(t, y)
    }
}

/// The equation of motion of a scene.
pub(crate) trait EquationSource: fmt::Debug + Send + Sync {
    fn copy(&self) -> Box<dyn EquationSource>;

    fn initial_state(&self) -> Vec<f64>;

    fn rates(&mut self, t: f64, y: &[f64]) -> Result<&[f64], Error>;

    fn jacobian(&mut self, t: f64, y: &[f64]) -> Result<Vec<f64>, Error>;
}

impl Clone for Box<dyn EquationSource> {
    fn clone(&self) -> Self {
        self.copy()
    }
}

pub(crate) struct SceneEquation<S: StudyScene> {
    scene: Arc<S>,
    machine: Arc<Machine<S::Model>>,
    start: Vec<f64>,
    workspace: MachineWorkspace<f64, S::Model>,
    dual_workspace: MachineWorkspace<Dual, S::Model>,
    rates: Vec<f64>,
}

impl<S: StudyScene> fmt::Debug for SceneEquation<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SceneEquation({})", self.scene.name)
    }
}

impl<S: StudyScene> SceneEquation<S> {
    pub(crate) fn new(scene: Arc<S>, machine: Machine<S::Model>, start: Vec<f64>) -> Self {
        let machine = Arc::new(machine);
        Self {
            scene,
            workspace: machine.workspace(),
            dual_workspace: machine.workspace(),
            rates: vec![0.0; start.len()],
            machine,
            start,
        }
    }

    fn check(&self, y: &[f64]) -> Result<(), Error> {
        let states = self.start.len();
        match y.len() {
            given if given == states => Ok(()),
            given => Err(Error::State { given, states }),
        }
    }

    fn explain(&self, error: &DynamicsError) -> Error {
        self.scene.explain(self.machine.model(), error).into()
    }
}

impl<S: StudyScene> EquationSource for SceneEquation<S> {
    fn copy(&self) -> Box<dyn EquationSource> {
        Box::new(Self {
            scene: Arc::clone(&self.scene),
            machine: Arc::clone(&self.machine),
            start: self.start.clone(),
            workspace: self.workspace.clone(),
            dual_workspace: self.dual_workspace.clone(),
            rates: self.rates.clone(),
        })
    }

    fn initial_state(&self) -> Vec<f64> {
        self.start.clone()
    }

    fn rates(&mut self, t: f64, y: &[f64]) -> Result<&[f64], Error> {
        self.check(y)?;
        match self.machine.evaluate(t, y, &mut self.workspace) {
            Ok(state) => state.derivative(&mut self.rates),
            Err(error) => return Err(self.explain(&error)),
        }
        Ok(&self.rates)
    }

    fn jacobian(&mut self, t: f64, y: &[f64]) -> Result<Vec<f64>, Error> {
        self.check(y)?;
        let n = y.len();
        let mut states: Vec<Dual> = y.iter().map(|&value| Dual::from_f64(value)).collect();
        let mut rates = states.clone();
        let mut jacobian = vec![0.0; n * n];
        // No rate depends on the works.
        for column in 0..self.machine.work_offset() {
            states[column] = Dual::variable(y[column]);
            match self.machine.evaluate(t, &states, &mut self.dual_workspace) {
                Ok(state) => state.derivative(&mut rates),
                Err(error) => return Err(self.explain(&error)),
            }
            states[column] = Dual::from_f64(y[column]);
            for (row, rate) in rates.iter().enumerate() {
                jacobian[row * n + column] = rate.d;
            }
        }
        Ok(jacobian)
    }
}
