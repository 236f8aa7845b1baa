//! Writes a free motion: everything that is written of a trajectory, events and summary.

use crate::explain::{StudyError, explain_machine, explain_motion};
use crate::free_motion::compute::{ComputedMotion, FreeMotionProblem};
use crate::models::SolverSettings;
use crate::progress::Progress;
use crate::trajectory::compute::{Analysis, Trajectory};
use crate::trajectory::{TrajectoryOutcome, evaluate_and_report};
use dwell_dynamics::{DynamicsError, Options, loads_with_drives};
use dwell_report::TableExport as _;
use dwell_scene::{Scene, SceneLocation};

/// Number of samples if no sample interval is given.
const DEFAULT_SAMPLES: f64 = 1000.0;
/// Maximum number of samples of a motion.
const MAX_SAMPLES: f64 = 100_000.0;

/// The free motion of a scene, by a method and a tolerance.
///
/// # Errors
/// [`StudyError`] when the scene has no motion, or its initial state cannot be evaluated. An error later in
/// the motion is in [`TrajectoryOutcome::early_stop`].
pub fn simulate(
    scene: &Scene,
    settings: &SolverSettings,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let compute = |problem: &FreeMotionProblem<'_>, duration: f64, sample_interval: f64| {
        let options = Options {
            atol: settings.atol,
            max_step: settings.max_step,
            sample_interval: Some(sample_interval),
            ..Options::new(settings.method, settings.rtol)
        };
        let motion = problem.solve(scene, duration, &options)?;
        let error = problem.estimate_error(scene, &motion, &options)?;
        Ok(ComputedMotion {
            method_text: settings.describe(),
            remarks: problem.method_hint(&motion, settings) + &error,
            accuracy: None,
            motion,
        })
    };
    simulate_with(scene, settings.sample_interval, progress, &compute)
}

/// The free motion of a scene to a required accuracy, by the cheapest method that reaches it. `accuracy` bounds the
/// error of angles in rad, of lengths relative to their largest change, and of energy and reactions relative to their
/// largest value.
///
/// # Errors
/// As [`simulate`]. If the accuracy is not reached, [`TrajectoryOutcome::early_stop`] says so.
pub fn simulate_to_accuracy(
    scene: &Scene,
    accuracy: f64,
    sample_interval: Option<f64>,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let compute = |problem: &FreeMotionProblem<'_>, duration: f64, sample_interval: f64| {
        problem.to_accuracy(scene, accuracy, duration, sample_interval)
    };
    simulate_with(scene, sample_interval, progress, &compute)
}

fn simulate_with(
    scene: &Scene,
    sample_interval: Option<f64>,
    progress: Progress<'_>,
    compute: &dyn Fn(&FreeMotionProblem<'_>, f64, f64) -> Result<ComputedMotion, StudyError>,
) -> Result<TrajectoryOutcome, StudyError> {
    let Some(spec) = &scene.motion else {
        return Err(no_motion_error(scene));
    };
    let mut loaded_scene = scene.clone();
    let loads = loads_with_drives(&scene.mechanism, &scene.loads, &scene.drives);
    loaded_scene.loads = loads.map_err(|e| explain_machine(scene, e.into()))?;
    let problem = FreeMotionProblem::new(scene, &loaded_scene, spec)?;
    let duration = problem.duration()?;
    let sample_interval = sample_interval.unwrap_or(duration / DEFAULT_SAMPLES);
    let computed = compute(
        &problem,
        duration,
        sample_interval.max(duration / MAX_SAMPLES),
    )?;
    let ComputedMotion {
        motion,
        method_text,
        ..
    } = &computed;
    let explain = |e: &DynamicsError| explain_motion(&loaded_scene, problem.output_model.plan(), e);
    if let Some(error) = motion.failure.as_ref().filter(|_| motion.end_time() == 0.0) {
        return Err(explain(error));
    }
    let samples = problem.samples(motion).map_err(|e| explain(&e))?;
    let prescribed = spec.laws.iter().map(Option::is_some).collect();
    let charts = motion
        .charts
        .iter()
        .map(|c| c.output_model.clone())
        .collect();
    let mut trajectory = Trajectory::of_free_motion(
        problem.output_model.plan(),
        samples,
        problem.extra_columns(),
        prescribed,
        charts,
    );
    trajectory.method_text.clone_from(method_text);
    let mut result = evaluate_and_report(
        &loaded_scene,
        &problem.output_model,
        &trajectory,
        Analysis::FreeMotion,
        progress,
    )?;
    let outcome = &mut result.outcome;
    if motion.occurrences().next().is_some() {
        let name = format!("{}-motion-events.csv", scene.name);
        outcome.files.add(name, problem.event_table(motion).csv()?);
    }
    outcome.summary += &problem.summary(motion, method_text, duration);
    outcome.summary += &problem.notes;
    outcome.summary += &computed.remarks;
    if let Some(error) = &motion.failure {
        result.early_stop = Some(explain(error));
    } else if let Some([requested, error]) = computed.accuracy
        && error > requested
    {
        result.early_stop = Some(accuracy_not_reached(scene, requested, error));
    }
    Ok(result)
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

fn no_motion_error(scene: &Scene) -> StudyError {
    let help = "add [motion] with `speed`, and `periods` or `duration`";
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
