//! One entry to all studies of a scene.

use crate::analyses::{
    analyse_trajectory_within, check, export, reduce, simulate_within, symbolic,
};
use crate::calibrate::calibrate;
use crate::cycle::output::cycle;
use crate::equilibria::output::equilibria;
use crate::explain::StudyError;
use crate::export::ExportRequest;
use crate::export::output::ExportTarget;
use crate::free_motion::compute::MotionSolver;
use crate::gradient::output::gradient;
use crate::gradient::tolerance_output::tolerance;
use crate::linearise::compute::OperatingPoint;
use crate::linearise::output::linearise;
use crate::models::SolverSettings;
use crate::optimise::output::optimise_job;
use crate::output::Outcome;
use crate::progress::Progress;
use crate::reduce::compute::TableRequest;
use crate::study_scene::{SceneTask, StudyScene, with_dimension};
use crate::sweep::SweepRequest;
use crate::sweep::output::{ParameterSweep, sweep};
use crate::symbolic::output::FormulaFormat;
use crate::trajectory::compute::Analysis;
use crate::trajectory::figures::PictureSpan;
use crate::trajectory::output::TrajectoryOutcome;
use crate::unit_runs::output::unit_runs;
use dwell_scene::Scene;

/// A study of a scene.
#[derive(Debug, Clone)]
pub enum Request<'a> {
    /// [`check`].
    Check,
    /// [`reduce`].
    Reduce {
        /// The number of positions.
        points: Option<usize>,
        /// An interpolation table.
        table: Option<TableRequest>,
    },
    /// [`analyse_trajectory_within`].
    Trajectory {
        /// The analysis at each position.
        analysis: Analysis,
        /// The number of positions.
        points: Option<usize>,
        /// The part that curves show.
        span: PictureSpan,
    },
    /// [`simulate_within`].
    Simulate {
        /// How it is integrated.
        solver: MotionSolver,
        /// Wanted instants, s, ascending.
        times: Option<Vec<f64>>,
        /// The part that curves show.
        span: PictureSpan,
    },
    /// [`cycle`].
    Cycle {
        /// Method and tolerance.
        settings: SolverSettings,
        /// The coefficient of fluctuation that a flywheel shall reach.
        fluctuation: Option<f64>,
    },
    /// [`equilibria`].
    Equilibria,
    /// [`linearise`].
    Linearise {
        /// The state to linearise about.
        about: OperatingPoint,
    },
    /// [`unit_runs`].
    UnitRuns {
        /// The number of positions of each run.
        points: Option<usize>,
    },
    /// [`symbolic`].
    Symbolic {
        /// Formulas or code.
        format: FormulaFormat,
        /// The reaction; none for the first that the scene requests.
        reaction: Option<&'a str>,
    },
    /// [`export`].
    Export {
        /// The target of the export.
        target: ExportTarget,
        /// How accurately.
        asked: ExportRequest,
    },
    /// [`calibrate`].
    Calibrate {
        /// The path of the number; `None` for that of the scene.
        parameter: Option<&'a str>,
        /// The required period, s; `None` for that of the scene.
        period: Option<f64>,
    },
    /// [`sweep`].
    Sweep(ParameterSweep<'a>),
    /// [`gradient`].
    Gradient {
        /// The results, by their names in a sweep.
        results: &'a [String],
        /// Whether each derivative is compared with differences.
        has_check: bool,
    },
    /// The best design of a job.
    Optimise {
        /// The name of the job; `None` for the only one.
        job: Option<&'a str>,
        /// The seed of random designs.
        seed: u64,
    },
    /// The spread of results by random numbers: `vary` are their distributions, `requests` the results.
    Tolerance(SweepRequest<'a>),
}

/// Studies a scene.
///
/// # Errors
/// Those of the study. The outcome contains the reason for an early end of a motion.
///
/// ```
/// use dwell_study::{Request, no_progress, run};
///
/// let scene = dwell_scene::Scene::read("../../validation/spatial/rssr.toml")?;
/// let outcome = run(&scene, &Request::Check, &no_progress)?.outcome;
/// assert!(outcome.summary.contains("1 degree of freedom"));
/// # Ok::<(), dwell_study::StudyError>(())
/// ```
pub fn run(
    scene: &Scene,
    request: &Request<'_>,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    with_dimension(scene, Study { request, progress })
}

struct Study<'a> {
    request: &'a Request<'a>,
    progress: Progress<'a>,
}

impl SceneTask for Study<'_> {
    type Output = Result<TrajectoryOutcome, StudyError>;

    fn run<S: StudyScene>(self, scene: &S) -> Self::Output {
        let progress = self.progress;
        let outcome: Outcome = match self.request {
            Request::Check => check(scene)?,
            Request::Reduce { points, table } => reduce(scene, *points, *table)?,
            Request::Trajectory {
                analysis,
                points,
                span,
            } => return analyse_trajectory_within(scene, *analysis, *points, *span, progress),
            Request::Simulate {
                solver,
                times,
                span,
            } => return simulate_within(scene, solver, times.as_deref(), *span, progress),
            Request::Cycle {
                settings,
                fluctuation,
            } => return cycle(scene, settings, *fluctuation),
            Request::Equilibria => equilibria(scene)?,
            Request::Linearise { about } => linearise(scene, *about)?,
            Request::UnitRuns { points } => return unit_runs(scene, *points, progress),
            Request::Symbolic { format, reaction } => symbolic(scene, *format, *reaction)?,
            Request::Export { target, asked } => export(scene, *target, asked)?,
            Request::Calibrate { parameter, period } => calibrate(scene, *parameter, *period)?,
            Request::Sweep(asked) => sweep(scene, asked, progress)?,
            Request::Gradient { results, has_check } => {
                gradient(scene, results, *has_check, progress)?
            }
            Request::Optimise { job, seed } => optimise_job(scene, *job, *seed, progress)?,
            Request::Tolerance(asked) => tolerance(scene, asked, progress)?,
        };
        Ok(TrajectoryOutcome::from(outcome))
    }
}
