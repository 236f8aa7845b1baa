//! Runs of the commands for the start of a motion and the linearisation about it.

use super::starts::DURATION;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::rows::Rows;

/// The first and last row of a short motion.
pub(super) fn simulate(program: &Program, name: &str, text: &str) -> Result<Rows, String> {
    let interval = DURATION.to_string();
    let method = ["simulate", "--method", "dop853"];
    let options = [&method[..], &["--sample-interval", &interval]].concat();
    let run = program.run(&format!("simulate-{name}"), text, &options)?;
    run.csv("-motion.csv")
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
