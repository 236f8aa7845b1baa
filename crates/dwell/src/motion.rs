//! Motions in time: along a prescribed motion, and free.

use crate::column_table::ColumnTable;
use crate::error::Error;
use crate::mechanism::Mechanism;
use dwell_dynamics::Method;
use dwell_study::trajectory::compute::ComputedTrajectory;
use dwell_study::{
    Analysis, MotionSolver, SolverSettings, compute_free_motion, compute_period,
    compute_trajectory, no_progress,
};

impl Mechanism {
    /// Positions, velocities, accelerations, actuator forces and reactions along the prescribed motion or the coordinate
    /// sweep of the scene: every column that `dwell kinetostatics` writes.
    ///
    /// # Errors
    /// [`Error::Study`] where the scene prescribes no motion, or its first position cannot be reached.
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
        self.along_motion(Analysis::Kinetostatics)
    }

    /// Positions, velocities and accelerations along the prescribed motion or the coordinate sweep of the scene: every
    /// column that `dwell kinematics` writes.
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
        self.along_motion(Analysis::Kinematics)
    }

    /// Actuator forces and reactions under the loads, at rest in every position of the prescribed motion or the coordinate
    /// sweep: every column that `dwell statics` writes.
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
        self.along_motion(Analysis::Statics)
    }

    fn along_motion(&self, analysis: Analysis) -> Result<MotionResults, Error> {
        let computed = compute_trajectory(self.scene.inner(), analysis, None, &no_progress)?;
        Ok(MotionResults::new(computed))
    }

    /// The free motion of the scene under its loads, drives and friction: every column that `dwell simulate` writes, all
    /// reactions and energies among them.
    ///
    /// # Errors
    /// [`Error::Study`] where the scene has no motion, or its initial state cannot be evaluated. A motion that ends early
    /// says why in [`MotionResults::early_stop`].
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
        let motion = compute_free_motion(self.scene.inner(), &solver.0, &no_progress)?;
        Ok(MotionResults {
            events: motion.events,
            estimated_error: motion.estimated_error,
            ..MotionResults::new(motion.computed)
        })
    }

    /// The period of the free motion, s, and its energy, J: by quadrature, for one free coordinate and conservative loads.
    ///
    /// # Errors
    /// [`Error::Study`] where the scene has no motion, or it is not conservative or does not repeat itself.
    ///
    /// ```
    /// let study = dwell::Scene::read("../../validation/single-dwell/scene.toml")?.assemble()?;
    /// assert!((study.period()?.period - 5.41966267706427).abs() < 1e-12);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn period(&self) -> Result<Period, Error> {
        let orbit = compute_period(self.scene.inner())?;
        Ok(Period {
            period: orbit.period,
            energy: orbit.energy,
        })
    }
}

/// The period of a conservative motion.
///
/// ```
/// # let study = dwell::Scene::read("../../validation/single-dwell/scene.toml")?.assemble()?;
/// let dwell::Period { period, energy } = study.period()?;
/// # assert!(period > 0.0 && energy > 0.0);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Period {
    /// Time of one period, s.
    pub period: f64,
    /// Kinetic and potential energy, J.
    pub energy: f64,
}

/// How a free motion is integrated.
///
/// ```
/// use dwell::{Method, Solver};
/// let to_accuracy = Solver::accuracy(1e-9);
/// let by_method = Solver::method(Method::Dop853, 1e-12).sample_interval(0.01);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solver(pub(crate) MotionSolver);

impl Solver {
    /// The cheapest method that reaches an accuracy: it bounds the error of angles in rad, of lengths relative to their
    /// largest change, and of energy and reactions relative to their largest value.
    ///
    /// ```
    /// let solver = dwell::Solver::accuracy(1e-9);
    /// ```
    pub fn accuracy(accuracy: f64) -> Self {
        Self(MotionSolver::Accuracy {
            accuracy,
            sample_interval: None,
        })
    }

    /// A method with one tolerance, relative and absolute.
    ///
    /// ```
    /// let solver = dwell::Solver::method(dwell::Method::Bdf, 1e-10);
    /// ```
    pub fn method(method: Method, tolerance: f64) -> Self {
        Self(MotionSolver::Settings(SolverSettings {
            method,
            rtol: tolerance,
            atol: tolerance,
            ..SolverSettings::default()
        }))
    }

    /// The same with this time between samples, s; otherwise it is a thousandth of the duration.
    ///
    /// ```
    /// let solver = dwell::Solver::accuracy(1e-9).sample_interval(0.01);
    /// ```
    #[must_use]
    pub fn sample_interval(mut self, interval: f64) -> Self {
        match &mut self.0 {
            MotionSolver::Settings(settings) => settings.sample_interval = Some(interval),
            MotionSolver::Accuracy {
                sample_interval, ..
            } => *sample_interval = Some(interval),
        }
        self
    }

    pub(crate) fn settings(&self) -> SolverSettings {
        match self.0 {
            MotionSolver::Settings(settings) => settings,
            MotionSolver::Accuracy { accuracy, .. } => SolverSettings {
                method: Method::Dop853,
                rtol: accuracy,
                atol: accuracy,
                ..SolverSettings::default()
            },
        }
    }
}

/// A motion as a table, with its events.
///
/// ```
/// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
/// let motion = slider.kinetostatics()?;
/// for (t, force) in motion.column("t")?.iter().zip(motion.column("A.magnitude")?) {
///     println!("{t:.4} s: {force:.1} N");
/// }
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug)]
pub struct MotionResults {
    table: ColumnTable,
    /// The events that happened: time, s, and name.
    pub events: Vec<(f64, String)>,
    /// The estimated error, where an accuracy was required.
    pub estimated_error: Option<f64>,
    /// Why the motion ended early, or is less accurate than required, if so.
    pub early_stop: Option<Error>,
}

impl MotionResults {
    pub(crate) fn new(computed: ComputedTrajectory<'_>) -> Self {
        Self {
            table: ColumnTable {
                columns: computed.table.columns,
                rows: computed.table.rows,
            },
            events: Vec::new(),
            estimated_error: None,
            early_stop: computed.early_stop.map(Error::from),
        }
    }

    /// Names and units of the columns.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.kinetostatics()?.columns().next(), Some(("t", "s")));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn columns(&self) -> impl Iterator<Item = (&str, &str)> + Clone {
        self.table.columns()
    }

    /// A column.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let normal = slider.kinetostatics()?.column("guide.normal")?;
    /// assert_eq!(normal.len(), 361);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn column(&self, name: &str) -> Result<Vec<f64>, Error> {
        self.table.column(name)
    }
}
