//! The commands that tell how a motion starts, and what is linear about its start.

use super::starts::DURATION;
use crate::written::motions::MotionReading;
use crate::written::poses::difference::Differences;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::rows::Rows;

/// The first and last row of a short motion, with the second reading of its scene and the dense equations of its bodies.
pub(super) struct Simulated {
    pub(super) motion: MotionReading,
    pub(super) rows: Rows,
    pub(super) equations: Differences,
}

/// Runs `simulate` on the text of a scene.
pub(super) fn simulate(program: &Program, name: &str, text: &str) -> Result<Simulated, String> {
    let interval = DURATION.to_string();
    let method = ["simulate", "--method", "dop853"];
    let options = [&method[..], &["--sample-interval", &interval]].concat();
    let run = program.run(&format!("simulate-{name}"), text, &options)?;
    let rows = run.csv("-motion.csv")?;
    let motion = MotionReading::new(text)?;
    let compared = motion.compare(&rows, name);
    let compared = compared.ok_or("a column of `simulate` is missing")?;
    Ok(Simulated {
        motion,
        rows,
        equations: compared.equations,
    })
}

/// Runs `linearise` about the initial state.
pub(super) fn linearise(program: &Program, name: &str, text: &str) -> Result<Run, String> {
    let options = ["linearise", "--about", "initial"];
    program.run(&format!("linearise-{name}"), text, &options)
}

/// Runs `linearise` about the equilibrium that is nearest to the start.
pub(super) fn linearise_nearest(program: &Program, name: &str, text: &str) -> Result<Run, String> {
    program.run(&format!("linearise-{name}"), text, &["linearise"])
}
