//! Equilibria, linearised motion and the steady cycle of a mechanism.

use super::Mechanism;
use crate::error::Error;
use crate::machine::{Cycle, Equilibrium, StateSpace};
use crate::motion::Solver;
use dwell_study::gradient::Gradient;
use dwell_study::optimise::Optimised;

impl Mechanism {
    /// The equilibria: with one coordinate all in its range, with several those that Newton's method reaches from many initial positions.
    ///
    /// # Errors
    /// [`Error::Study`] if loads depend on time, or if none is found with several coordinates.
    ///
    /// ```
    /// use dwell::{Actuator, Joint, Load, Mechanism, Stability};
    ///
    /// let mut m = Mechanism::builder("Pendulum");
    /// m.ground().point("O", [0.0, 0.0]);
    /// m.body("bob").point("O", [0.0, 0.0]).mass(2.0, [0.0, -0.5], 0.0);
    /// m.joint("O", Joint::revolute("ground.O", "bob.O"));
    /// m.actuator("phi", Actuator::angle("ground", "bob"));
    /// m.load("weight", Load::gravity([0.0, -9.81]));
    /// let found = m.assemble()?.equilibria()?;
    /// assert_eq!(found.len(), 2);
    /// let hanging = found.iter().find(|e| e.stability == Stability::Centre).unwrap();
    /// assert!((hanging.modes[0].angular_frequency - (9.81_f64 / 0.5).sqrt()).abs() < 1e-9);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn equilibria(&self) -> Result<Vec<Equilibrium>, Error> {
        self.assembled.equilibria()
    }

    /// The derivatives of results of a [`Sweep`](crate::Sweep) by all numbers of the scene, in its units: exact where a result is an
    /// extremum, a mean or a sum along the trajectory, an extremum of m or a period; otherwise by differences.
    ///
    /// # Errors
    /// [`Error::Study`] if there is no such result, or the scene cannot be evaluated.
    ///
    /// ```
    /// let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let gradient = scene.assemble()?.gradient(&["m.max", "m.min"])?;
    /// assert_eq!(gradient.results.len(), 2);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn gradient(&self, results: &[&str]) -> Result<Gradient, Error> {
        let results: Vec<String> = results.iter().map(|name| (*name).to_owned()).collect();
        self.assembled.gradient(&results)
    }

    /// The best design of a job of `[optimise]`, as of `dwell optimise`: of the only one if none is named. Random designs depend on the seed.
    ///
    /// # Errors
    /// [`Error::Study`] if there is no such job, it is at fault, or no design can be evaluated.
    ///
    /// ```
    /// let scene = dwell::Scene::read("../../tests/all/optimise/lamp.toml")?;
    /// let best = scene.assemble()?.optimise(Some("stiffness"), 1)?;
    /// // The spring balances the lamp: no torque is left.
    /// assert!(best.after < 1e-9 && best.is_admissible());
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn optimise(&self, job: Option<&str>, seed: u64) -> Result<Optimised, Error> {
        self.assembled.optimise(job, seed)
    }

    /// Small motions about the equilibrium nearest to the initial state, as ẋ = A x + B u, z = C x + D u.
    ///
    /// # Errors
    /// As [`Mechanism::equilibria`].
    ///
    /// ```
    /// # use dwell::{Actuator, Joint, Load, Mechanism};
    /// # let mut m = Mechanism::builder("Pendulum");
    /// # m.ground().point("O", [0.0, 0.0]);
    /// # m.body("bob").point("O", [0.0, 0.0]).mass(2.0, [0.0, -0.5], 0.0);
    /// # m.joint("O", Joint::revolute("ground.O", "bob.O"));
    /// # m.actuator("phi", Actuator::angle("ground", "bob"));
    /// # m.load("weight", Load::gravity([0.0, -9.81]));
    /// # let pendulum = m.assemble()?;
    /// let linear = pendulum.linearise()?;
    /// assert_eq!(linear.states, ["phi [rad]", "phi.velocity [rad/s]"]);
    /// assert!((linear.a[1][0] + 9.81 / 0.5).abs() < 1e-9);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn linearise(&self) -> Result<StateSpace, Error> {
        self.assembled.linearise()
    }

    /// The steady cycle of a rotating machine, and, if `fluctuation` is given, the flywheel for this coefficient of
    /// fluctuation.
    ///
    /// # Errors
    /// [`Error::Study`] if the machine does not rotate, has no drive or loss, or depends on time.
    ///
    /// ```
    /// use dwell::{Actuator, Drive, Joint, Load, Mechanism, Solver};
    ///
    /// // A wheel of 0.2 kg m2 with a motor line and a load torque that varies over the revolution.
    /// let mut m = Mechanism::builder("Wheel");
    /// m.ground().point("O", [0.0, 0.0]);
    /// m.body("wheel").point("O", [0.0, 0.0]).mass(5.0, "O", 0.2);
    /// m.joint("O", Joint::revolute("ground.O", "wheel.O"));
    /// m.actuator("phi", Actuator::angle("ground", "wheel"));
    /// m.load("work", Load::torque("wheel", "-2 - 1.5*cos(phi)"));
    /// m.drive("motor", Drive::motor_line("phi", 10.0, 30.0));
    /// let cycle = m.assemble()?.cycle(&Solver::accuracy(1e-10), Some(0.005))?;
    /// assert!(cycle.fluctuation > 0.005);
    /// assert!(cycle.flywheel.unwrap() > 0.0); // kg m2 to be added
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn cycle(&self, solver: &Solver, fluctuation: Option<f64>) -> Result<Cycle, Error> {
        self.assembled.cycle(solver, fluctuation)
    }
}
