//! How `dwell simulate` computes a motion, by its arguments.

use crate::instants;
use crate::options::Command;
use dwell_study::{MotionSolver, PictureSpan, SolverSettings, StudyError};

/// Method and tolerances, wanted instants, and the part that curves show.
pub(crate) type Simulation = (MotionSolver, Option<Vec<f64>>, PictureSpan);

/// Of the command `simulate`; of another, its defaults.
pub(crate) fn simulation(command: &Command) -> Result<Simulation, StudyError> {
    let Command::Simulate {
        method,
        rtol,
        atol,
        max_step,
        accuracy,
        sample_interval,
        times,
        from,
        to,
        ..
    } = command
    else {
        let settings = SolverSettings::default();
        let span = PictureSpan::default();
        return Ok((MotionSolver::Settings(settings), None, span));
    };
    let solver = match *accuracy {
        Some(accuracy) => MotionSolver::Accuracy {
            accuracy,
            sample_interval: *sample_interval,
        },
        None => MotionSolver::Settings(SolverSettings {
            method: *method,
            rtol: *rtol,
            atol: atol.unwrap_or(*rtol),
            max_step: *max_step,
            sample_interval: *sample_interval,
        }),
    };
    let times = times.as_deref().map(instants::read).transpose()?;
    let span = PictureSpan {
        from: *from,
        to: *to,
    };
    Ok((solver, times, span))
}
