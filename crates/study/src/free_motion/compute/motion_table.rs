//! A free motion as one table.

use crate::explain::{StudyError, explain_machine, explain_motion};
use crate::free_motion::compute::{ComputedMotion, FreeMotionProblem};
use crate::models::SolverSettings;
use crate::trajectory::compute::{Analysis, Trajectory, TrajectoryTable};
use dwell_dynamics::{DynamicsError, Options, loads_with_drives};
use dwell_findings::Table;
use dwell_scene::{FreeMotionSpec, Scene, SceneLocation};

/// Number of samples if no sample interval is given.
const DEFAULT_SAMPLES: f64 = 1000.0;
/// Maximum number of samples of a motion.
const MAX_SAMPLES: f64 = 100_000.0;

/// How a motion is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MotionSolver {
    /// By a method and its tolerances.
    Settings(SolverSettings),
    /// By the cheapest method that reaches an accuracy, which bounds the error of angles in rad, of lengths relative to
    /// their largest change, and of energy and reactions relative to their largest value.
    Accuracy {
        /// The accuracy.
        accuracy: f64,
        /// Sample interval, s; `None` for a thousandth of the duration.
        sample_interval: Option<f64>,
    },
}

impl MotionSolver {
    fn sample_interval(&self) -> Option<f64> {
        match self {
            Self::Settings(settings) => settings.sample_interval,
            Self::Accuracy {
                sample_interval, ..
            } => *sample_interval,
        }
    }
}

/// A free motion as tables.
#[derive(Debug)]
pub struct MotionTable {
    /// Every sample, and why the motion ended early if it did.
    pub motion: TrajectoryTable,
    /// By event that happened: its time, s, and its name.
    pub events: Vec<(f64, String)>,
    /// The estimated error, in the sense of [`MotionSolver::Accuracy`], where an accuracy was required.
    pub estimated_error: Option<f64>,
}

impl FreeMotionProblem<'_> {
    /// Integrates the motion; the sample interval is bounded.
    ///
    /// # Errors
    /// [`StudyError`] where the motion has no duration, or its initial state cannot be evaluated.
    pub(crate) fn compute(
        &self,
        scene: &Scene,
        solver: &MotionSolver,
    ) -> Result<ComputedMotion, StudyError> {
        let duration = self.duration()?;
        let interval = solver
            .sample_interval()
            .unwrap_or(duration / DEFAULT_SAMPLES);
        let sample_interval = interval.max(duration / MAX_SAMPLES);
        let settings = match solver {
            MotionSolver::Accuracy { accuracy, .. } => {
                return self.to_accuracy(scene, *accuracy, duration, sample_interval);
            }
            MotionSolver::Settings(settings) => settings,
        };
        let options = Options {
            atol: settings.atol,
            max_step: settings.max_step,
            sample_interval: Some(sample_interval),
            ..Options::new(settings.method, settings.rtol)
        };
        let motion = self.solve(scene, duration, &options)?;
        let error = self.estimate_error(scene, &motion, &options)?;
        Ok(ComputedMotion {
            method_text: settings.describe(),
            remarks: self.method_hint(&motion, settings) + &error,
            accuracy: None,
            motion,
        })
    }

    /// The samples of a computed motion as a trajectory.
    ///
    /// # Errors
    /// [`StudyError`] where not even the initial state can be evaluated.
    pub(crate) fn trajectory(
        &self,
        computed: &ComputedMotion,
    ) -> Result<Trajectory<'_>, StudyError> {
        let motion = &computed.motion;
        if let Some(error) = motion.failure.as_ref().filter(|_| motion.end_time() == 0.0) {
            return Err(self.explain(error));
        }
        let charts = motion.charts.iter().map(|c| c.output_model.clone());
        let mut trajectory = Trajectory::of_free_motion(
            self.output_model.plan(),
            self.samples(motion).map_err(|e| self.explain(&e))?,
            self.extra_columns(),
            self.spec.laws.iter().map(Option::is_some).collect(),
            charts.collect(),
        );
        trajectory.method_text.clone_from(&computed.method_text);
        Ok(trajectory)
    }

    /// Why a computed motion is not what was required: it ended early, or is less accurate.
    pub(crate) fn shortfall(&self, scene: &Scene, computed: &ComputedMotion) -> Option<StudyError> {
        if let Some(error) = &computed.motion.failure {
            return Some(self.explain(error));
        }
        match computed.accuracy {
            Some([requested, error]) if error > requested => {
                Some(accuracy_not_reached(scene, requested, error))
            }
            _ => None,
        }
    }

    fn explain(&self, error: &DynamicsError) -> StudyError {
        explain_motion(self.loaded_scene, self.output_model.plan(), error)
    }
}

fn accuracy_not_reached(scene: &Scene, requested: f64, error: f64) -> StudyError {
    let message =
        format!("an accuracy of {requested:e} is not reached: the estimated error is {error:.1e}");
    let help =
        "the results are written with the error above; require that accuracy, or a shorter motion";
    let label = (
        SceneLocation::Duration,
        "the error grows with the duration".to_owned(),
    );
    scene.error(message, Some(help.to_owned()), &[label]).into()
}

/// The free motion of a scene, and the scene with the loads through which its drives act.
///
/// # Errors
/// [`StudyError`] where a drive does not fit the mechanism, or the scene has no motion.
pub(crate) fn motion_and_drives(scene: &Scene) -> Result<(&FreeMotionSpec, Scene), StudyError> {
    let Some(spec) = &scene.motion else {
        return Err(no_motion_error(scene));
    };
    let mut loaded_scene = scene.clone();
    let loads = loads_with_drives(&scene.mechanism, &scene.loads, &scene.drives);
    loaded_scene.loads = loads.map_err(|e| explain_machine(scene, e.into()))?;
    Ok((spec, loaded_scene))
}

fn no_motion_error(scene: &Scene) -> StudyError {
    let help = "add [motion] with `initial-velocity`, and `periods` or `duration`";
    let label = (
        SceneLocation::Whole,
        "there is no [motion] in this file".to_owned(),
    );
    scene
        .error(
            "the scene has no [motion] to simulate".to_owned(),
            Some(help.to_owned()),
            &[label],
        )
        .into()
}

/// Computes the free motion of a scene.
///
/// # Errors
/// [`StudyError`] when the scene has no motion, or its initial state cannot be evaluated. An error later in the motion is
/// in [`TrajectoryTable::early_stop`].
pub fn compute_free_motion(
    scene: &Scene,
    solver: &MotionSolver,
) -> Result<MotionTable, StudyError> {
    let (spec, loaded_scene) = motion_and_drives(scene)?;
    let problem = FreeMotionProblem::new(scene, &loaded_scene, spec)?;
    let computed = problem.compute(scene, solver)?;
    let trajectory = problem.trajectory(&computed)?;
    let analysis = Analysis::FreeMotion;
    let mut motion =
        TrajectoryTable::evaluate(&loaded_scene, &problem.output_model, &trajectory, analysis)?;
    if let Some(error) = problem.shortfall(scene, &computed) {
        motion.early_stop = Some(error);
    }
    let event = |(_, o): (usize, &dwell_dynamics::EventOccurrence)| {
        let name = spec.events.get(o.event).map(|e| e.name.clone());
        (o.state.t, name.unwrap_or_default())
    };
    Ok(MotionTable {
        motion,
        events: computed.motion.occurrences().map(event).collect(),
        estimated_error: computed.accuracy.map(|[_, error]| error),
    })
}

impl MotionTable {
    /// The samples.
    pub fn table(&self) -> &Table {
        &self.motion.table
    }
}
