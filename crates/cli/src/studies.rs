//! The commands that study one scene.

use crate::options::Command;
use dwell_scene::{AnyScene, Scene, SpaceScene};
use dwell_study::unit_runs::compute::UnitRunScene;
use dwell_study::{
    CalibratedScene, Outcome, Progress, SolverSettings, StudyError, TrajectoryOutcome,
};
use dwell_validation::work_precision::StudiedScene;
use std::path::Path;

/// Runs a study of a scene, in the plane or in space.
pub(crate) fn run(
    command: &Command,
    scene: &AnyScene,
    out: &Path,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    match scene {
        AnyScene::Plane(scene) => in_plane(command, scene, out, progress),
        AnyScene::Space(scene) => in_space(command, scene, out, progress),
    }
}

fn in_plane(
    command: &Command,
    scene: &Scene,
    out: &Path,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    if let Some((given, analysis)) = command.trajectory() {
        let (points, span) = (given.points(), given.span());
        return dwell_study::analyse_trajectory_within(scene, analysis, points, span, progress);
    }
    let outcome = match command {
        Command::Check { .. } => dwell_study::check(scene)?,
        Command::Reduce(given) => dwell_study::reduce(scene, given.points(), given.table())?,
        Command::Simulate(given) => {
            let (solver, times, span) = (given.solver(), given.times()?, given.span());
            return dwell_study::simulate_within(scene, &solver, times.as_deref(), span, progress);
        }
        Command::Symbolic {
            format, reaction, ..
        } => dwell_study::symbolic(scene, *format, reaction.as_deref())?,
        Command::Export(given) => dwell_study::export(scene, given.to, &given.request())?,
        _ => return in_either(command, scene, out, progress),
    };
    Ok(completed(outcome))
}

fn in_space(
    command: &Command,
    scene: &SpaceScene,
    out: &Path,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    if let Some((given, analysis)) = command.trajectory() {
        let (points, span) = (given.points(), given.span());
        return dwell_study::analyse_in_space(scene, analysis, points, span, progress);
    }
    let outcome = match command {
        Command::Check { .. } => dwell_study::check_in_space(scene)?,
        Command::Reduce(given) => {
            dwell_study::reduce_in_space(scene, given.points(), given.table())?
        }
        Command::Simulate(given) => {
            let (solver, times, span) = (given.solver(), given.times()?, given.span());
            let times = times.as_deref();
            return dwell_study::simulate_in_space(scene, &solver, times, span, progress);
        }
        Command::Symbolic { .. } => return Err(scene.planar_only().into()),
        Command::Export(given) => dwell_study::export_in_space(scene, given.to, &given.request())?,
        _ => return in_either(command, scene, out, progress),
    };
    Ok(completed(outcome))
}

/// What is one study in the plane and in space.
fn in_either(
    command: &Command,
    scene: &(impl UnitRunScene + CalibratedScene + StudiedScene),
    out: &Path,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let outcome = match command {
        Command::Cycle {
            fluctuation,
            method,
            rtol,
            ..
        } => {
            let settings = SolverSettings {
                method: *method,
                rtol: *rtol,
                atol: *rtol,
                ..SolverSettings::default()
            };
            return dwell_study::cycle(scene, &settings, *fluctuation);
        }
        Command::WorkPrecision { .. } => dwell_validation::work_precision(scene, progress)?,
        Command::Equilibria { .. } => dwell_study::equilibria(scene)?,
        Command::Linearise { about, .. } => dwell_study::linearise(scene, *about)?,
        Command::Runs { points, .. } => {
            let points = points.map(|n| n as usize);
            return dwell_study::unit_runs(scene, points, progress);
        }
        Command::Calibrate {
            parameter, period, ..
        } => dwell_study::calibrate(scene, parameter.as_deref(), *period)?,
        Command::Sweep(given) => dwell_study::sweep(scene, &given.sweep(out), progress)?,
        // The others are no studies of a scene, or their scenes are asked before.
        _ => Outcome::default(),
    };
    Ok(completed(outcome))
}

fn completed(outcome: Outcome) -> TrajectoryOutcome {
    let early_stop = None;
    TrajectoryOutcome {
        outcome,
        early_stop,
    }
}
