//! Why a motion is not what was required, in the plane or in space: it ended early, or is less accurate.

use crate::explain::{
    NamedScene, StepLimits, StudyError, explain_max_steps, explain_switching, scene_error,
};
use crate::free_motion::compute::MotionSolver;
use dwell_dynamics::DynamicsError;
use dwell_scene::SceneLocation;

/// An error of this part of a coordinate's change, or of the largest kinetic energy, is no result: its second digit
/// is wrong.
pub(crate) const LARGE_ERROR: f64 = 0.01;

/// A motion that took the highest number of steps.
pub(crate) fn too_many_steps(
    scene: &impl NamedScene,
    error: Option<&DynamicsError>,
    solver: &MotionSolver,
) -> Option<StudyError> {
    let limits = match solver {
        MotionSolver::Settings(settings) => StepLimits {
            max_step: settings.max_step,
            tolerance: "--rtol",
        },
        MotionSolver::Accuracy { .. } => StepLimits {
            max_step: None,
            tolerance: "--accuracy",
        },
    };
    match error {
        Some(&DynamicsError::MaxStepsReached { t, max_steps }) => {
            let what = format!("the maximum of {max_steps} steps is reached");
            Some(explain_max_steps(scene, t, (max_steps, &what), &limits))
        }
        Some(&DynamicsError::TooSlow {
            t,
            steps,
            needed,
            switching: Some(load),
            ..
        }) => Some(explain_switching(scene, load, t, (steps, needed))),
        Some(&DynamicsError::TooSlow {
            t,
            steps,
            needed,
            max_steps,
            ..
        }) => {
            let what = format!(
                "{max_steps} steps are not enough: after {steps}, about {needed:.0e} remain"
            );
            Some(explain_max_steps(scene, t, (steps, &what), &limits))
        }
        _ => None,
    }
}

/// A motion whose error is so large, or so little known, that it is no result.
pub(crate) fn not_resolved(scene: &impl NamedScene, why: &str) -> StudyError {
    let message = format!("the motion is not resolved: {why}");
    let help = "use a smaller --rtol, or --accuracy; a chaotic motion can be computed for a shorter time only";
    let place = (SceneLocation::Duration, "over this time");
    scene_error(scene, message, help, [place])
}

/// A motion whose estimated error is above the required one.
pub(crate) fn not_accurate(
    scene: &impl NamedScene,
    [accuracy, error]: [f64; 2],
) -> Option<StudyError> {
    let message =
        format!("an accuracy of {accuracy:e} is not reached: the estimated error is {error:.1e}");
    let help =
        "the results are written with the error above; require that accuracy, or a shorter motion";
    let place = (SceneLocation::Duration, "the error grows with the duration");
    (error > accuracy).then(|| scene_error(scene, message, help, [place]))
}
