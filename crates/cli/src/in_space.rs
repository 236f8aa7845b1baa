//! The commands that take a scene in space.

use crate::options::{Command, TrajectoryArgs};
use dwell_scene::SpaceScene;
use dwell_study::{Analysis, Outcome, PictureSpan, Progress, StudyError, TrajectoryOutcome};
use std::path::Path;

/// Runs a study of a scene in space.
pub(crate) fn run_study(
    command: &Command,
    scene: &SpaceScene,
    out: &Path,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let outcome = match command {
        Command::Check { .. } => dwell_study::check_in_space(scene)?,
        Command::Reduce { runs: None, .. } => reduce(command, scene)?,
        Command::Export(arguments) => crate::export::run_in_space(arguments, scene)?,
        Command::Kinematics(arguments) => {
            return run_trajectory(arguments, scene, Analysis::Kinematics, progress);
        }
        Command::Statics(arguments) => {
            return run_trajectory(arguments, scene, Analysis::Statics, progress);
        }
        Command::Kinetostatics(arguments) => {
            return run_trajectory(arguments, scene, Analysis::Kinetostatics, progress);
        }
        Command::Simulate { .. } => {
            let (solver, times, span) = crate::simulation::simulation(command)?;
            let times = times.as_deref();
            return dwell_study::simulate_in_space(scene, &solver, times, span, progress);
        }
        Command::Cycle {
            fluctuation,
            method,
            rtol,
            ..
        } => {
            let settings = crate::cycle_settings(*method, *rtol);
            return dwell_study::cycle(scene, &settings, *fluctuation);
        }
        Command::Equilibria { .. } => dwell_study::equilibria(scene)?,
        Command::Linearise { about, .. } => dwell_study::linearise(scene, *about)?,
        Command::Calibrate {
            parameter, period, ..
        } => {
            if let Some(path) = parameter {
                crate::sweep::note_former_path(scene, path);
            }
            dwell_study::calibrate(scene, parameter.as_deref(), *period)?
        }
        Command::Runs { points, .. } => {
            let points = points.map(|n| n as usize);
            return dwell_study::unit_runs(scene, points, progress);
        }
        Command::WorkPrecision { .. } => dwell_validation::work_precision(scene, progress)?,
        Command::Sweep { .. } => {
            let sweep = crate::sweep::parameter_sweep(command, scene, out);
            dwell_study::sweep(scene, &sweep, progress)?
        }
        _ => return Err(scene.planar_only().into()),
    };
    Ok(TrajectoryOutcome {
        outcome,
        early_stop: None,
    })
}

/// The reduced parameters, with a table if it is asked for.
fn reduce(command: &Command, scene: &SpaceScene) -> Result<Outcome, StudyError> {
    let Command::Reduce {
        table_accuracy,
        accuracy,
        points,
        table_from,
        table_to,
        ..
    } = command
    else {
        return Err(scene.planar_only().into());
    };
    let accuracies = [*table_accuracy, *accuracy];
    let table = crate::table_request(accuracies, [*table_from, *table_to]);
    dwell_study::reduce_in_space(scene, points.map(|n| n as usize), table)
}

/// Analyses a scene along its trajectory.
fn run_trajectory(
    arguments: &TrajectoryArgs,
    scene: &SpaceScene,
    analysis: Analysis,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let points = arguments.points.map(|n| n as usize);
    let span = PictureSpan {
        from: arguments.from,
        to: arguments.to,
    };
    dwell_study::analyse_in_space(scene, analysis, points, span, progress)
}
