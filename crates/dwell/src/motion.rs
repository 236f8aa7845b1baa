//! Motions in time, prescribed and free.

use crate::column_table::ColumnTable;
use crate::error::Error;
use dwell_dynamics::Method;
use dwell_study::trajectory::compute::ComputedTrajectory;
use dwell_study::{MotionSolver, SolverSettings};

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

/// The integration method of a free motion, and its accuracy.
///
/// ```
/// use dwell::{Method, Solver};
/// let to_accuracy = Solver::accuracy(1e-9);
/// let by_method = Solver::method(Method::Dop853, 1e-12).sample_interval(0.01);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solver(pub(crate) MotionSolver);

impl Solver {
    /// The cheapest method that reaches an accuracy: a bound of the error of angles in rad, of lengths relative to their
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

    /// Sets the time between samples, s; the default is a thousandth of the duration.
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
    /// The events: time, s, and name.
    pub events: Vec<(f64, String)>,
    /// The estimated error, if an accuracy was required.
    pub estimated_error: Option<f64>,
    /// The reason if the motion ended early or is less accurate than required.
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
