//! What is run and judged for a case.

use super::run_program::Program;
use dwell_findings::Finding;
use dwell_scene::Scene;

/// The findings over what the program writes for a case.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct WrittenFindings {
    pub(crate) findings: Vec<Finding>,
    /// The seed of the instants and angles, for the report.
    pub(crate) seed: String,
}

/// What the checks of a case are given.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WrittenCase<'a> {
    pub(crate) program: &'a Program,
    pub(crate) scene: &'a Scene,
    /// The text of the scene.
    pub(crate) text: &'a str,
}

/// A task: it runs the program once or more, and judges what it wrote. A run that fails is a failed finding.
type Task = fn(&WrittenCase<'_>) -> Vec<Finding>;

/// All tasks, in the order of their findings.
const TASKS: [Task; 0] = [];

/// Runs all tasks of a case, side by side.
pub(crate) fn check_written(program: &Program, scene: &Scene) -> WrittenFindings {
    use super::drawn_numbers::DrawnNumbers;
    use rayon::prelude::*;
    let case = WrittenCase {
        program,
        scene,
        text: scene.source.inner(),
    };
    let findings = TASKS.par_iter().map(|task| task(&case)).collect::<Vec<_>>();
    WrittenFindings {
        findings: findings.concat(),
        seed: DrawnNumbers::of(case.text, "").seed(),
    }
}
