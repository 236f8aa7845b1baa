//! The equation of a free motion as a function, for integrators of one's own.

use crate::error::Error;
use crate::mechanism::Mechanism;
use crate::mechanism::scene::Scene;
use dwell_dynamics::{DynamicsError, Machine, MachineWorkspace};
use dwell_numerics::{Dual, Scalar as _};
use dwell_study::explain::explain_motion;
use dwell_study::free_motion::compute::{FreeMotionProblem, MotionProblem as _};
use std::sync::Arc;

impl Mechanism {
    /// The equation of the scene's free motion, ẏ = f(t, y), with the states y = [free coordinates; their velocities; states of
    /// drives and contacts; works of the sources that have no potential].
    ///
    /// # Errors
    /// [`Error::Study`] where the scene has no motion, or its machine cannot be built.
    ///
    /// ```
    /// let study = dwell::Scene::read("../../validation/single-dwell/scene.toml")?.assemble()?;
    /// let mut equation = study.equation_of_motion()?;
    /// let start = equation.initial_state();
    /// assert_eq!(start, [0.0, 1.0]); // φ and φ̇
    /// let rates = equation.rates(0.0, &start)?.to_vec();
    /// assert_eq!(rates[0], 1.0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn equation_of_motion(&self) -> Result<EquationOfMotion, Error> {
        let scene = self.scene.inner();
        let Some(spec) = &scene.motion else {
            let help = Some("add a motion".to_owned());
            return Err(scene
                .error("the scene has no [motion]".to_owned(), help, &[])
                .into());
        };
        let problem = FreeMotionProblem::new(scene, scene, spec)?;
        let start = problem.initial_state().y;
        let machine = Arc::new(problem.machine);
        Ok(EquationOfMotion {
            scene: self.scene.clone(),
            workspace: machine.workspace(),
            dual_workspace: machine.workspace(),
            rates: vec![0.0; start.len()],
            machine,
            start,
        })
    }
}

/// The equation of motion of a machine with the working memory of one thread.
///
/// Loads and drives are evaluated as they are at (t, y): an integrator that steps over their switches must find these itself.
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
pub struct EquationOfMotion {
    scene: Scene,
    machine: Arc<Machine>,
    start: Vec<f64>,
    workspace: MachineWorkspace<f64>,
    dual_workspace: MachineWorkspace<Dual>,
    rates: Vec<f64>,
}

impl EquationOfMotion {
    /// The states at t = 0: rad or m, per s.
    ///
    /// ```
    /// # let study = dwell::Scene::read("../../validation/single-dwell/scene.toml")?.assemble()?;
    /// assert_eq!(study.equation_of_motion()?.initial_state().len(), 2);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn initial_state(&self) -> Vec<f64> {
        self.start.clone()
    }

    /// ẏ at time t, s. It allocates nothing.
    ///
    /// # Errors
    /// [`Error::State`] for a wrong number of states; [`Error::Study`] where there is no pose or no inertia, or a load has no value.
    ///
    /// ```
    /// # let study = dwell::Scene::read("../../validation/single-dwell/scene.toml")?.assemble()?;
    /// let mut equation = study.equation_of_motion()?;
    /// let rates = equation.rates(0.0, &[0.5, 2.0])?;
    /// assert_eq!(rates[0], 2.0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn rates(&mut self, t: f64, y: &[f64]) -> Result<&[f64], Error> {
        self.check(y)?;
        match self.machine.evaluate(t, y, &mut self.workspace) {
            Ok(state) => state.derivative(&mut self.rates),
            Err(error) => return Err(self.explain(&error)),
        }
        Ok(&self.rates)
    }

    /// ∂ẏ/∂y at time t, s, row by row, by dual numbers: exact but for rounding.
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
        self.check(y)?;
        let n = y.len();
        let mut states: Vec<Dual> = y.iter().map(|&value| Dual::from_f64(value)).collect();
        let mut rates = states.clone();
        let mut jacobian = vec![0.0; n * n];
        // Nothing depends on the works.
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

    fn check(&self, y: &[f64]) -> Result<(), Error> {
        let states = self.start.len();
        match y.len() {
            given if given == states => Ok(()),
            given => Err(Error::State { given, states }),
        }
    }

    fn explain(&self, error: &DynamicsError) -> Error {
        explain_motion(self.scene.inner(), self.machine.model().plan(), error).into()
    }
}
