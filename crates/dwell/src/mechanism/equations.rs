//! The equation of motion of a mechanism.

use super::Mechanism;
use crate::equation::EquationOfMotion;
use crate::error::Error;

impl Mechanism {
    /// The equation of the scene's free motion, ẏ = f(t, y), with the states y = [free coordinates; their velocities; states of
    /// drives and contacts; works of the sources without a potential].
    ///
    /// # Errors
    /// [`Error::Study`] if the scene has no motion, or its machine cannot be built.
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
        self.assembled.equation().map(EquationOfMotion::new)
    }
}
