//! The runs of a machine: each required accuracy, as a user starts it, against the reference.

use super::draw::RandomMachine;
use super::reference::Reference;
use crate::draws::Draws;
use dwell_scene::PlaneScene;
use dwell_study::FreeMotion;
use dwell_study::{MotionSolver, StudyError, compute_free_motion, no_progress};
use dwell_validation::extremes::column;
use rayon::prelude::*;

/// The accuracies that are required.
pub(super) const ACCURACIES: [f64; 4] = [1e-3, 1e-5, 1e-7, 1e-9];
/// Rows of a motion behind its start.
const ROWS: usize = 20;

/// A machine with all its runs.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineResult {
    /// Its number among those of the seed.
    pub number: usize,
    /// What it is.
    pub kind: &'static str,
    /// The scene.
    pub text: String,
    /// Why there is no reference, if there is none.
    pub without_reference: Option<String>,
    /// The runs, by accuracy.
    pub runs: Vec<MachineRun>,
}

/// A run to a required accuracy.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineRun {
    /// The required accuracy.
    pub accuracy: f64,
    /// Why the motion is refused.
    pub refused: Option<String>,
    /// The true error: rad, of lengths and energies relative to the largest.
    pub error: f64,
    /// The part of it that the reference may have.
    pub reference_error: f64,
    /// The estimated error.
    pub estimate: f64,
}

/// The runs of some machines of a seed.
pub fn evaluate(count: usize, seed: u64) -> Vec<MachineResult> {
    (0..count)
        .into_par_iter()
        .map(|number| machine_result(seed, number))
        .collect()
}

fn machine_result(seed: u64, number: usize) -> MachineResult {
    // Other draws than those of the pulses.
    let random = RandomMachine::draw(&mut Draws::new(!seed, number));
    let times: Vec<f64> = (0..=ROWS)
        .map(|k| random.span * k as f64 / ROWS as f64)
        .collect();
    let reference = Reference::new(&random, &times);
    // Without a reference there is nothing to compare with.
    let runs = |reference| ACCURACIES.map(|accuracy| run(&random, accuracy, reference));
    let runs = reference.iter().flat_map(runs).collect();
    MachineResult {
        number,
        kind: random.kind,
        without_reference: reference.err(),
        text: random.text,
        runs,
    }
}

/// A run; where the scene is refused, with the reason.
fn run(random: &RandomMachine, accuracy: f64, reference: &Reference) -> MachineRun {
    let solver = MotionSolver::Accuracy {
        accuracy,
        sample_interval: Some(random.span / ROWS as f64),
    };
    let scene = PlaneScene::parse("machine.toml", &random.text).map_err(StudyError::from);
    let found = scene.and_then(|scene| compute_free_motion(&scene, &solver, &no_progress));
    match found {
        Ok(found) => compared(accuracy, &found, reference),
        Err(error) => MachineRun {
            accuracy,
            refused: Some(error.to_string()),
            error: f64::NAN,
            reference_error: f64::NAN,
            estimate: f64::NAN,
        },
    }
}

/// The errors of a motion.
fn compared(accuracy: f64, found: &FreeMotion, reference: &Reference) -> MachineRun {
    let table = &found.computed.table;
    let cells = |name: &str| column(table, name).unwrap_or_default();
    let largest = |values: &[f64]| values.iter().map(|v| v.abs()).fold(0.0, f64::max);
    let [kinetic, balance] =
        ["energy.kinetic", "energy.balance_error"].map(|name| largest(&cells(name)));
    let mut error = if kinetic > 0.0 {
        balance / kinetic
    } else {
        0.0
    };
    let mut reference_error = 0.0_f64;
    for (i, name) in ["q", "r"].iter().enumerate().take(reference.travels.len()) {
        let scale = match reference.is_angle[i] {
            true => 1.0,
            false => reference.travels[i],
        };
        let pairs = cells(name).into_iter().zip(&reference.coordinates);
        let differences = pairs.map(|(value, expected)| (value - expected[i]).abs());
        error = error.max(differences.fold(0.0, f64::max) / scale);
        reference_error = reference_error.max(reference.errors[i] / scale);
    }
    for (difference, own, scale) in reference.reaction_errors(kinetic, &cells) {
        error = error.max(difference / scale);
        reference_error = reference_error.max(own / scale);
    }
    MachineRun {
        accuracy,
        refused: found.computed.early_stop.as_ref().map(ToString::to_string),
        error,
        reference_error,
        estimate: found.estimated_error.unwrap_or(f64::NAN),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A motor, a controller and a force whose switches limit the steps of a part of the motion: there two runs erred alike,
    /// and their difference was a third of the error.
    #[test]
    fn estimates_hold_where_switches_limit_the_steps() {
        let machine = machine_result(1, 32);
        assert_eq!(machine.without_reference, None);
        for run in &machine.runs {
            let ratio = run.estimate_ratio().unwrap_or(1.0);
            assert!(ratio >= 1.0 && run.refused.is_none(), "{run:?}");
        }
    }
}
