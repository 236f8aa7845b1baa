//! Simulates a free motion: integration, samples, energies and forces.

use crate::estimate;
use crate::explain::StudyError;
use crate::free_motion::compute::accuracy::to_accuracy;
use crate::free_motion::compute::between_samples::{MotionSampler, max_skipped};
use crate::free_motion::compute::description::{method_hint, moves, starts_unstable, summary};
use crate::free_motion::compute::error_estimate::estimate_error;
use crate::free_motion::compute::events::{event_table, named_events};
use crate::free_motion::compute::shortfall::{not_accurate, not_resolved, too_many_steps};
use crate::free_motion::compute::tables::trajectory;
use crate::free_motion::compute::{
    ChartedProblem, ComputedMotion, FreeMotionProblem, MotionOf, motion_to_simulate,
};
use crate::machines::MachineScene as _;
use crate::models::{SolverSettings, with_drive_loads};
use crate::number_format::digits;
use crate::progress::Progress;
use crate::trajectory::compute::{
    ComputedTrajectory, MotionBetweenRows, RowScene, RowSource, Sampler, SecondRows, Trajectory,
    TrajectorySample,
};
use dwell_dynamics::{DynamicsError, Options};
use dwell_findings::{Record, Table};
use dwell_scene::{PlaneScene, SceneError};

/// Number of samples if no sample interval is given.
const DEFAULT_SAMPLES: f64 = 1000.0;
/// Why a motion is no result that starts in an unstable equilibrium.
const STARTS_UNSTABLE: &str =
    "it starts in an unstable equilibrium, and rounding alone decides when and where it leaves it";
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

/// A free motion, up to where it ended.
pub struct FreeMotion {
    /// Coordinates, energies and forces at the samples, and why the motion ended early or misses the required accuracy.
    pub computed: ComputedTrajectory<'static>,
    /// By event that happened: its time, s, and its name.
    pub events: Vec<(f64, String)>,
    /// The estimated error, in the sense of [`MotionSolver::Accuracy`], where an accuracy was required.
    pub estimated_error: Option<f64>,
}

/// A free motion, and what is said of it.
pub struct DescribedMotion<'m> {
    /// The motion.
    pub(crate) motion: FreeMotion,
    /// What is said of it, to be computed where it is asked for.
    pub(crate) description: Box<dyn FnOnce() -> MotionDescription + 'm>,
}

/// What is said of a free motion.
pub(crate) struct MotionDescription {
    /// By event that happened: its time and number, and the actuator coordinates and speeds then.
    #[cfg_attr(
        not(feature = "output"),
        expect(dead_code, reason = "pages do not show it")
    )]
    pub(crate) event_table: Table,
    /// What the integration reports: method, events, cost, motion class, energy balance and estimated error.
    pub(crate) summary: String,
    /// The numbers in it.
    pub(crate) record: Record,
}

/// A motion at its rows, and what is known between them.
type FollowedMotion<'s> = (Trajectory<'static>, Option<MotionBetweenRows<'s>>);

/// A scene whose free motion is simulated.
pub trait SimulatedScene: RowScene {
    /// Does something with its free motion, with rows at wanted `times` (s, ascending) and at its end, or else equally spaced.
    ///
    /// # Errors
    /// As of [`compute_free_motion`](crate::compute_free_motion).
    fn simulate_then<R>(
        &self,
        solver: &MotionSolver,
        times: Option<&[f64]>,
        progress: Progress<'_>,
        then: impl FnOnce(&RowSource<'_, '_, Self>, DescribedMotion<'_>) -> R,
    ) -> Result<R, StudyError>;
}

impl SimulatedScene for PlaneScene {
    fn simulate_then<R>(
        &self,
        solver: &MotionSolver,
        times: Option<&[f64]>,
        progress: Progress<'_>,
        then: impl FnOnce(&RowSource<'_, '_, Self>, DescribedMotion<'_>) -> R,
    ) -> Result<R, StudyError> {
        let spec = motion_to_simulate(self, self.motion.as_ref())?;
        let loaded_scene = with_drive_loads(self)?;
        let problem = FreeMotionProblem::new(self, &loaded_scene, spec)?;
        simulated(&problem, solver, (times, progress), then)
    }
}

/// Refuses a sample interval beyond the duration (s), or of more than the highest number of samples.
fn check_sample_interval(interval: f64, duration: f64) -> Result<f64, StudyError> {
    // What is printed with six digits can be given.
    const PRINTED: f64 = 1e-6;
    let shortest = duration / MAX_SAMPLES;
    let fault = if interval > duration * (1.0 + PRINTED) {
        let duration = digits(duration, 6);
        format!("longer than the motion of {duration} s")
    } else if interval < shortest * (1.0 - PRINTED) {
        let samples = digits((duration / interval).ceil(), 6);
        format!(
            "too short for a motion of {} s: it would have {samples} samples",
            digits(duration, 6)
        )
    } else {
        return Ok(interval);
    };
    let [interval, shortest, longest] = [interval, shortest, duration].map(|t| digits(t, 6));
    let message = format!("a sample interval of {interval} s is {fault}");
    let help = format!(
        "from {shortest} s ({MAX_SAMPLES} samples) to {longest} s (start and end only) is allowed"
    );
    Err(SceneError::without_labels(message, Some(help)).into())
}

/// Refuses wanted times (s) that are not ascending, or outside a motion of this duration (s).
fn check_times(times: &[f64], duration: f64) -> Result<(), StudyError> {
    let pairs = times.iter().zip(times.iter().skip(1));
    let mut unordered = pairs.filter(|(before, after)| after <= before);
    let is_outside = |t: &&f64| **t < 0.0 || **t > duration;
    let message = if times.is_empty() || times.len() as f64 > MAX_SAMPLES {
        format!("{} wanted instants", times.len())
    } else if let Some((before, after)) = unordered.next() {
        format!("the wanted instant {after} s follows {before} s")
    } else if let Some(t) = times.iter().find(is_outside) {
        format!(
            "the wanted instant {t} s is not within the motion of {} s",
            digits(duration, 6)
        )
    } else {
        return Ok(());
    };
    let help = format!(
        "give from 1 to {MAX_SAMPLES} instants, each once and in ascending order, from 0 to {duration} s"
    );
    Err(SceneError::without_labels(message, Some(help)).into())
}

impl MotionSolver {
    /// The interval of samples over a duration, s.
    ///
    /// # Errors
    /// [`StudyError::Scene`] where it is longer than that, or there would be too many samples.
    pub(crate) fn sample_interval(&self, duration: f64) -> Result<f64, StudyError> {
        let (Self::Settings(SolverSettings {
            sample_interval, ..
        })
        | Self::Accuracy {
            sample_interval, ..
        }) = self;
        match *sample_interval {
            Some(interval) => check_sample_interval(interval, duration),
            None => Ok(duration / DEFAULT_SAMPLES),
        }
    }
}

/// A motion of a problem with what is said of it.
type Computed<P> = ComputedMotion<<P as ChartedProblem>::Chart>;

/// Does something with the motion by a solver, as [`SimulatedScene::simulate_then`] does.
pub(crate) fn simulated<P: ChartedProblem, R>(
    problem: &P,
    solver: &MotionSolver,
    (times, progress): (Option<&[f64]>, Progress<'_>),
    then: impl FnOnce(&RowSource<'_, '_, P::Scene>, DescribedMotion<'_>) -> R,
) -> Result<R, StudyError> {
    let duration = problem.duration()?;
    times.map_or(Ok(()), |times| check_times(times, duration))?;
    let mut integrated = integrate(problem, solver, duration)?;
    let [evaluated, others] = std::mem::take(&mut integrated.evaluated);
    let motion = &integrated.motion;
    // Where branches are too close at the start, the scene is a valid one.
    let is_refused = |error: &&DynamicsError| !matches!(error, DynamicsError::NearBranches { .. });
    let failure = motion.failure.as_ref().filter(is_refused);
    if let Some(error) = failure.filter(|_| motion.end_time() == 0.0) {
        return Err(problem.explain(error));
    }
    let method_text = &integrated.method_text;
    let max_skipped = max_skipped(solver);
    let (followed, steps) = rayon::join(
        || trajectory(problem, (motion, evaluated), method_text, times),
        || problem.steps_as_samples(motion, max_skipped),
    );
    let followed = followed.map_err(|e| problem.explain(&e))?;
    let sampler = || -> Sampler<'_> {
        let mut sampler = MotionSampler::new(problem, motion);
        Box::new(move |t, precision| sampler.sample_at(t, precision))
    };
    let between = steps.map(|further| MotionBetweenRows {
        further,
        sampler: &sampler,
    });
    let second = || second_rows(problem, &integrated, others, times);
    let followed = ((followed, between), second);
    let rows = rows_and_summary(problem, &integrated, followed, duration, progress);
    let (mut computed, mut said) = rows?;
    if let Some(end) = computed.end_of_rows() {
        integrated.end_at(end);
        said = summary(problem, &integrated, duration);
    }
    let shortfall = shortfall(problem, &integrated, solver);
    computed.early_stop = shortfall.or(computed.early_stop);
    let source = problem.row_source(&integrated.motion);
    Ok(then(
        &source,
        described(problem, &integrated, computed, said),
    ))
}

/// A motion with its rows, and what is said of it besides its method.
fn described<'m, P: ChartedProblem>(
    problem: &'m P,
    integrated: &'m Computed<P>,
    computed: ComputedTrajectory<'static>,
    (mut summary, mut record): (String, Record),
) -> DescribedMotion<'m> {
    let motion = FreeMotion {
        computed,
        events: named_events(problem, &integrated.motion.segments),
        estimated_error: integrated.accuracy.map(|[_, error]| error),
    };
    let description = Box::new(move || {
        record.extend(integrated.record.clone());
        let notes = problem
            .scene()
            .assembly_note(P::Scene::model_of(problem.rows()));
        summary = summary + &notes + &integrated.remarks;
        MotionDescription {
            event_table: event_table(problem, &integrated.motion),
            summary,
            record,
        }
    });
    DescribedMotion {
        motion,
        description,
    }
}

fn integrate<P: ChartedProblem>(
    problem: &P,
    solver: &MotionSolver,
    duration: f64,
) -> Result<Computed<P>, StudyError> {
    let interval = solver.sample_interval(duration)?;
    let settings = match solver {
        MotionSolver::Settings(settings) => settings,
        MotionSolver::Accuracy { accuracy, .. } => {
            return to_accuracy(problem, *accuracy, duration, interval);
        }
    };
    let options = Options {
        sample_interval: Some(interval),
        ..settings.options()
    };
    let finer = estimate::comparison_options(&options);
    // The second run is the same unless the first one fails.
    let (motion, second) = rayon::join(
        || problem.by_method(duration, &options),
        || problem.by_method(duration, &finer).ok(),
    );
    let motion = motion?;
    let second = match &motion.failure {
        None => second,
        Some(_) if motion.end_time() == 0.0 => None,
        Some(_) => problem.by_method(motion.end_time(), &finer).ok(),
    };
    let (estimate, hint) = rayon::join(
        || estimate_error(problem, &motion, second, &options),
        || method_hint(problem, &motion, settings),
    );
    let mut estimate = estimate?;
    estimate.record.add("tolerance", "", settings.rtol);
    let leaves_unstable = starts_unstable(problem) && moves(problem, &motion);
    let unstable = leaves_unstable.then(|| STARTS_UNSTABLE.to_owned());
    Ok(ComputedMotion {
        method_text: settings.describe(),
        remarks: hint + &estimate.remarks,
        inaccuracy: unstable.or(estimate.inaccuracy),
        motion,
        ..estimate
    })
}

/// The rows of a motion with the errors of their columns, and what is said of it.
fn rows_and_summary<P: ChartedProblem>(
    problem: &P,
    integrated: &Computed<P>,
    (followed, second_rows): (
        FollowedMotion<'_>,
        impl FnOnce() -> Option<SecondRows> + Send,
    ),
    duration: f64,
    progress: Progress<'_>,
) -> Result<(ComputedTrajectory<'static>, (String, Record)), StudyError> {
    let mut beside = None;
    let computed = rayon::in_place_scope(|scope| {
        // On another core: the rows of the second computation, and the summary.
        scope.spawn(|_| {
            beside = Some((second_rows(), summary(problem, integrated, duration)));
        });
        let (trajectory, between) = followed;
        let source = problem.row_source(&integrated.motion);
        source.along(trajectory, between, progress)
    });
    let mut computed = computed?;
    let (second, summary) = beside.unwrap_or_default();
    computed.set_errors(second.as_ref());
    Ok((computed, summary))
}

/// The rows of a motion's second computation, at the same times; none where it has none.
fn second_rows<P: ChartedProblem>(
    problem: &P,
    integrated: &Computed<P>,
    evaluated: Option<Vec<TrajectorySample>>,
    times: Option<&[f64]>,
) -> Option<SecondRows> {
    let second: &MotionOf<P> = integrated.comparison.as_ref()?;
    let followed = trajectory(problem, (second, evaluated), &integrated.method_text, times);
    SecondRows::new(&problem.row_source(second), &followed.ok()?)
}

/// Why a motion is not what was required: it ended early, or is less accurate.
fn shortfall<P: ChartedProblem>(
    problem: &P,
    integrated: &Computed<P>,
    solver: &MotionSolver,
) -> Option<StudyError> {
    let (scene, failure) = (problem.scene(), integrated.motion.failure.as_ref());
    let ended = || Some(problem.explain_end(&integrated.motion, failure?));
    let inaccuracy = || Some(not_resolved(scene, integrated.inaccuracy.as_ref()?));
    too_many_steps(scene, failure, solver)
        .or_else(ended)
        .or_else(inaccuracy)
        .or_else(|| not_accurate(scene, integrated.accuracy?))
}
