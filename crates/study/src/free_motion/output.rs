//! Writes a free motion: everything that is written of a trajectory, events and summary.

use crate::explain::StudyError;
use crate::free_motion::compute::{MotionSolver, compute_free_motion_at};
use crate::models::SolverSettings;
use crate::progress::Progress;
use crate::trajectory::figures::PictureSpan;
use crate::trajectory::output::{TrajectoryOutcome, report};
use dwell_findings::RecordedEvent;
use dwell_report::TableExport as _;
use dwell_scene::Scene;

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
    simulate_with(scene, &MotionSolver::Settings(*settings), None, progress)
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
    let solver = MotionSolver::Accuracy {
        accuracy,
        sample_interval,
    };
    simulate_with(scene, &solver, None, progress)
}

/// The free motion of a scene, with rows at wanted `times` (s, ascending) and at its end, or else equally spaced.
///
/// # Errors
/// As [`simulate`]; [`StudyError::Scene`] for a time outside the motion.
pub fn simulate_with(
    scene: &Scene,
    solver: &MotionSolver,
    times: Option<&[f64]>,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    simulate_within(scene, solver, times, PictureSpan::default(), progress)
}

/// The same, with curves that show a part of the motion.
///
/// # Errors
/// As [`simulate_with`]; [`StudyError::Scene`] where the part is not within the motion.
pub fn simulate_within(
    scene: &Scene,
    solver: &MotionSolver,
    times: Option<&[f64]>,
    span: PictureSpan,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let motion = compute_free_motion_at(scene, solver, times, progress)?;
    let (scene, computed) = (&motion.loaded_scene, motion.computed);
    let mut outcome = report(scene, &computed, span)?;
    if !motion.events.is_empty() {
        let name = format!("{}-motion-events.csv", scene.name);
        outcome.files.add(name, motion.event_table.csv()?);
    }
    outcome.summary += &motion.summary;
    let event = |(t, name): (f64, String)| RecordedEvent { name, t };
    outcome.record.extend(motion.record);
    outcome.record.events = motion.events.into_iter().map(event).collect();
    Ok(TrajectoryOutcome {
        outcome,
        early_stop: computed.early_stop,
    })
}
