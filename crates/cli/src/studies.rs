//! The commands that study one scene.

use crate::options::Command;
use dwell_dynamics::Method;
use dwell_scene::Scene;
use dwell_study::{Progress, Request, SolverSettings, StudyError, TrajectoryOutcome};
use std::path::Path;

/// Runs a study of a scene, in the plane or in space.
pub(crate) fn run(
    command: &Command,
    scene: &Scene,
    out: &Path,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    match request(command, out)? {
        Some(request) => dwell_study::run(scene, &request, progress),
        None => Ok(dwell_validation::work_precision(scene, progress)?.into()),
    }
}

/// A method with one tolerance, relative and absolute.
fn settings(method: Method, tolerance: f64) -> SolverSettings {
    SolverSettings {
        method,
        rtol: tolerance,
        atol: tolerance,
        ..SolverSettings::default()
    }
}

/// The request of a command; `None` for a work–precision diagram.
fn request<'a>(command: &'a Command, out: &'a Path) -> Result<Option<Request<'a>>, StudyError> {
    if let Some((given, analysis)) = command.trajectory() {
        return Ok(Some(Request::Trajectory {
            analysis,
            points: given.points(),
            span: given.span(),
        }));
    }
    Ok(Some(match command {
        Command::Reduce(given) => Request::Reduce {
            points: given.points(),
            table: given.table(),
        },
        Command::Simulate(given) => Request::Simulate {
            solver: given.solver(),
            times: given.times()?,
            span: given.span(),
        },
        Command::Cycle {
            fluctuation,
            method,
            rtol,
            ..
        } => Request::Cycle {
            settings: settings(*method, *rtol),
            fluctuation: *fluctuation,
        },
        Command::Equilibria { .. } => Request::Equilibria,
        Command::Linearise { about, .. } => Request::Linearise { about: *about },
        Command::Gradient(given) => given.request(),
        Command::Runs { points, .. } => Request::UnitRuns {
            points: points.map(|n| n as usize),
        },
        Command::Symbolic {
            format, reaction, ..
        } => Request::Symbolic {
            format: *format,
            reaction: reaction.as_deref(),
        },
        Command::Export(given) => Request::Export {
            target: given.to,
            asked: given.request(),
        },
        Command::Calibrate {
            parameter, period, ..
        } => Request::Calibrate {
            parameter: parameter.as_deref(),
            period: *period,
        },
        Command::Sweep(given) => Request::Sweep(given.sweep(out)),
        Command::Optimise(given) => given.request(),
        Command::WorkPrecision { .. } => return Ok(None),
        // The others were handled before, or are no studies of a scene.
        Command::Kinematics(_) | Command::Statics(_) | Command::Kinetostatics(_) => Request::Check,
        Command::Check { .. } | Command::Validate { .. } | Command::View { .. } => Request::Check,
        Command::Schema | Command::Init { .. } | Command::Import(_) => Request::Check,
    }))
}
