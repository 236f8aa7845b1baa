//! Motions of a mechanism in time.

use super::Mechanism;
use crate::error::Error;
use crate::motion::{MotionResults, Period, Solver};
use dwell_study::Analysis;

impl Mechanism {
    /// Positions, velocities, accelerations, actuator forces and reactions along the prescribed motion or the coordinate
    /// sweep of the scene: the columns of `dwell kinetostatics`.
    ///
    /// # Errors
    /// [`Error::Study`] if the scene prescribes no motion, or its first position cannot be reached.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let motion = slider.kinetostatics()?;
    /// let torque = motion.column("phi.actuator_force")?;
    /// let largest = torque.iter().fold(0.0_f64, |max, t| max.max(t.abs()));
    /// assert!((largest - 128.076).abs() < 1e-3); // N·m, as in the README
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn kinetostatics(&self) -> Result<MotionResults, Error> {
        self.assembled.along_motion(Analysis::Kinetostatics)
    }

    /// Positions, velocities and accelerations along the prescribed motion or the coordinate sweep of the scene: the
    /// columns of `dwell kinematics`.
    ///
    /// # Errors
    /// As [`Mechanism::kinetostatics`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let motion = slider.kinematics_along_motion()?;
    /// assert_eq!(motion.column("phi.velocity")?[0], 150.0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn kinematics_along_motion(&self) -> Result<MotionResults, Error> {
        self.assembled.along_motion(Analysis::Kinematics)
    }

    /// Actuator forces and reactions under the loads, at rest in every position of the prescribed motion or the coordinate
    /// sweep: the columns of `dwell statics`.
    ///
    /// # Errors
    /// As [`Mechanism::kinetostatics`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let held = slider.statics_along_motion()?;
    /// assert_eq!(held.column("phi.actuator_force")?.len(), 361);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn statics_along_motion(&self) -> Result<MotionResults, Error> {
        self.assembled.along_motion(Analysis::Statics)
    }

    /// The free motion of the scene under its loads, drives and friction: the columns of `dwell simulate`, including all
    /// reactions and energies.
    ///
    /// # Errors
    /// [`Error::Study`] if the scene has no motion, or its initial state cannot be evaluated. If the motion ends early,
    /// [`MotionResults::early_stop`] has the reason.
    ///
    /// ```
    /// use dwell::{Actuator, Joint, Load, Mechanism, Motion, Solver};
    ///
    /// let mut m = Mechanism::builder("Pendulum");
    /// m.ground().point("O", [0.0, 0.0]);
    /// m.body("bob").point("O", [0.0, 0.0]).mass(2.0, [0.0, -0.5], 0.0);
    /// m.joint("O", Joint::revolute("ground.O", "bob.O"));
    /// m.actuator("phi", Actuator::angle("ground", "bob"));
    /// m.load("weight", Load::gravity([0.0, -9.81]));
    /// m.motion(Motion::seconds(1.0).initial_coordinate("phi", 0.1));
    /// let motion = m.assemble()?.simulate(&Solver::accuracy(1e-9))?;
    /// // Small oscillations: 0.1 cos(√(g/L) t).
    /// let last = motion.column("phi")?.last().copied().unwrap_or(f64::NAN);
    /// assert!((last - 0.1 * (9.81_f64 / 0.5).sqrt().cos()).abs() < 1e-3);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn simulate(&self, solver: &Solver) -> Result<MotionResults, Error> {
        self.assembled.simulate(solver)
    }

    /// The period of the free motion, s, and its energy, J: by quadrature, for one free coordinate and conservative loads.
    ///
    /// # Errors
    /// [`Error::Study`] if the scene has no motion, or if the motion is not conservative or not periodic.
    ///
    /// ```
    /// let study = dwell::Scene::read("../../validation/single-dwell/scene.toml")?.assemble()?;
    /// assert!((study.period()?.period - 5.41966267706427).abs() < 1e-12);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn period(&self) -> Result<Period, Error> {
        self.assembled.period()
    }
}
