//! The commands that take a scene in space.

use crate::options::Command;
use dwell_scene::SpaceScene;
use dwell_study::{StudyError, TrajectoryOutcome};

/// Runs a study of a scene in space.
pub(crate) fn run_study(
    command: &Command,
    scene: &SpaceScene,
) -> Result<TrajectoryOutcome, StudyError> {
    let outcome = match command {
        Command::Check { .. } => dwell_study::check_in_space(scene)?,
        Command::Reduce {
            table_accuracy: None,
            accuracy: None,
            points,
            ..
        } => dwell_study::reduce_in_space(scene, points.map(|n| n as usize))?,
        _ => return Err(scene.planar_only().into()),
    };
    Ok(TrajectoryOutcome {
        outcome,
        early_stop: None,
    })
}
