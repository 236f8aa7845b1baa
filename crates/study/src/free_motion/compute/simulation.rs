//! Simulates a free motion: integration, samples, energies and forces.

use crate::explain::{StudyError, missing_section_label, scene_error};
use crate::free_motion::compute::{ComputedMotion, FreeMotionProblem};
use crate::models::{SolverSettings, with_drive_loads};
use crate::progress::Progress;
use crate::trajectory::compute::{Analysis, ComputedTrajectory, compute_along};
use dwell_dynamics::Options;
use dwell_findings::Table;
use dwell_scene::{Scene, SceneLocation};

/// Number of samples if no sample interval is given.
const DEFAULT_SAMPLES: f64 = 1000.0;
/// Maximum number of samples of a motion.
const MAX_SAMPLES: f64 = 100_000.0;

/// A free motion, up to where it ended.
pub struct FreeMotion {
    /// The scene with the loads through which its drives act.
    pub loaded_scene: Scene,
    /// Coordinates, energies and forces at the samples.
    pub computed: ComputedTrajectory<'static>,
    /// The time of each event, and the actuator coordinates and speeds then; `None` if none occurred.
    pub events: Option<Table>,
    /// What the integration reports: method, events, cost, motion class, energy balance and estimated error.
    pub summary: String,
    /// Why it ended early, or misses the required accuracy.
    pub early_stop: Option<StudyError>,
}

/// The free motion of a scene, by a method and a tolerance.
///
/// # Errors
/// [`StudyError`] when the scene has no motion, or its initial state cannot be evaluated. An error later in
/// the motion is in [`FreeMotion::early_stop`].
pub fn compute_motion(
    scene: &Scene,
    settings: &SolverSettings,
    progress: Progress<'_>,
) -> Result<FreeMotion, StudyError> {
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
    compute_with(scene, settings.sample_interval, progress, &compute)
}

/// The free motion of a scene to a required accuracy, by the cheapest method that reaches it. `accuracy` bounds the
/// error of angles in rad, of lengths relative to their largest change, and of energy and reactions relative to their
/// largest value.
///
/// # Errors
/// As [`compute_motion`]. If the accuracy is not reached, [`FreeMotion::early_stop`] says so.
pub fn compute_motion_to_accuracy(
    scene: &Scene,
    accuracy: f64,
    sample_interval: Option<f64>,
    progress: Progress<'_>,
) -> Result<FreeMotion, StudyError> {
    let compute = |problem: &FreeMotionProblem<'_>, duration: f64, sample_interval: f64| {
        problem.to_accuracy(scene, accuracy, duration, sample_interval)
    };
    compute_with(scene, sample_interval, progress, &compute)
}

fn compute_with(
    scene: &Scene,
    sample_interval: Option<f64>,
    progress: Progress<'_>,
    compute: &dyn Fn(&FreeMotionProblem<'_>, f64, f64) -> Result<ComputedMotion, StudyError>,
) -> Result<FreeMotion, StudyError> {
    let Some(spec) = &scene.motion else {
        return Err(scene_error(
            scene,
            "the scene has no [motion] to simulate",
            "add [motion] with `speed`, and `periods` or `duration`",
            missing_section_label("motion"),
        ));
    };
    let loaded_scene = with_drive_loads(scene)?;
    let problem = FreeMotionProblem::new(scene, &loaded_scene, spec)?;
    let duration = problem.duration()?;
    let sample_interval = sample_interval.unwrap_or(duration / DEFAULT_SAMPLES);
    let sample_interval = sample_interval.max(duration / MAX_SAMPLES);
    let computed = compute(&problem, duration, sample_interval)?;
    let motion = &computed.motion;
    if let Some(error) = motion.failure.as_ref().filter(|_| motion.end_time() == 0.0) {
        return Err(problem.explain(error));
    }
    let trajectory = problem
        .trajectory(&computed)
        .map_err(|e| problem.explain(&e))?;
    let (model, analysis) = (&problem.output_model, Analysis::FreeMotion);
    let along = compute_along(&loaded_scene, model, trajectory, analysis, progress)?;
    let occurred = motion.occurrences().next().is_some();
    let events = occurred.then(|| problem.event_table(motion));
    let mut summary = problem.summary(motion, &computed.method_text, duration);
    summary += &problem.notes;
    summary += &computed.remarks;
    let early_stop = match (&motion.failure, computed.accuracy) {
        (Some(error), _) => Some(problem.explain(error)),
        (None, Some([requested, error])) if error > requested => Some(scene_error(
            scene,
            format!(
                "an accuracy of {requested:e} is not reached: the estimated error is {error:.1e}"
            ),
            "the results are written with the error above; require that accuracy, or a shorter motion",
            [(SceneLocation::Duration, "the error grows with the duration")],
        )),
        _ => None,
    };
    Ok(FreeMotion {
        computed: along,
        events,
        summary,
        early_stop,
        loaded_scene,
    })
}
