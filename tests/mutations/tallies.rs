//! The faults of single operations, put together by the step of the plan that they are in.

use super::detection::CHECKS;
use super::operations::{MutationOutcome, MutationResult};
use super::source::SourceFiles;
use std::collections::BTreeMap;

/// What the faults of one function, or of one step, came to.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tally {
    /// Signs, terms and factors that went wrong.
    pub mutations: usize,
    /// Of them: no answer moved, and no answer was given.
    pub unchanged: usize,
    pub no_result: usize,
    /// Of the others, how many each check detected, and to how many it was applied.
    pub detected: [usize; CHECKS.len()],
    pub applicable: [usize; CHECKS.len()],
    /// The fewest checks that detected one.
    pub min_checks: Option<usize>,
}

impl Tally {
    fn count(&mut self, result: &MutationResult) {
        self.mutations += 1;
        match &result.outcome {
            MutationOutcome::Unchanged => self.unchanged += 1,
            MutationOutcome::NoResult => self.no_result += 1,
            MutationOutcome::Checked(detection, _) => {
                for number in 0..CHECKS.len() {
                    self.detected[number] += usize::from(detection.detects(number));
                    self.applicable[number] += usize::from(detection.digits[number].is_some());
                }
                let count = detection.check_count();
                self.min_checks = Some(self.min_checks.map_or(count, |min| min.min(count)));
            }
        }
    }

    /// Faults that changed an answer.
    pub fn effective(&self) -> usize {
        self.mutations - self.unchanged - self.no_result
    }
}

/// By the function they are in.
pub fn by_function(results: &[MutationResult], source: &SourceFiles) -> BTreeMap<String, Tally> {
    let mut tallies: BTreeMap<String, Tally> = BTreeMap::new();
    for result in results {
        let tally = tallies
            .entry(source.function_label(result.operation))
            .or_default();
        tally.count(result);
    }
    tallies
}

/// By the step of a plan, in the order of evaluation.
///
/// # Panics
/// Where a function belongs to no step.
pub fn by_step(
    results: &[MutationResult],
    source: &SourceFiles,
    step_of: fn(&str, &str) -> Option<(usize, &'static str)>,
) -> Vec<(&'static str, Tally)> {
    let mut tallies: BTreeMap<(usize, &'static str), Tally> = BTreeMap::new();
    for result in results {
        let (file, function) = (result.operation.file, source.function(result.operation));
        let step = step_of(file, function).unwrap_or_else(|| {
            panic!("`{function}` in {file} belongs to no step: name it in tallies.rs, or space/steps.rs")
        });
        tallies.entry(step).or_default().count(result);
    }
    tallies
        .into_iter()
        .map(|((_, step), tally)| (step, tally))
        .collect()
}

// Long: an entry for each step.
/// The step that a function belongs to, with its place in the order of evaluation. Every function in which a mutation was
/// tried must be named here: what is unknown fails, so that a renamed file cannot move its mutations to another step.
pub fn evaluation_step(path: &str, function: &str) -> Option<(usize, &'static str)> {
    // An operator that is passed as a function, such as `Add::add`, is called from the standard library.
    if path.contains("library/core/") {
        return Some((25, "operators passed as functions"));
    }
    let module = path.trim_start_matches("crates/").trim_end_matches(".rs");
    let (name, module) = module.split_once("/src/")?;
    Some(match (name, module, function) {
        ("geometry", _, "rrr_dyad_positions") => (0, "positions: RRR dyad"),
        ("geometry", _, "guided_point_positions") => (1, "positions: guided point"),
        ("geometry", _, "coupling_angle_derivatives") => (17, "moments of couplings"),
        ("geometry", "positions/construct", _) => (3, "positions: triangle, circle, line"),
        ("geometry", "positions/factored_group", _) => (4, "positions: Newton and Jacobian"),
        (
            "geometry",
            "positions" | "positions/closed_forms" | "plan" | "plan/pose" | "body_frames",
            _,
        ) => (2, "positions: vectors, loops, revolutions"),
        ("numerics", "lu" | "factor_outcome", _) => (5, "groups: elimination"),
        ("numerics", "qr", _) => (6, "groups: least squares"),
        ("geometry", "structure/coupling", _) => (7, "gears, cams and other couplings"),
        (
            "geometry",
            "motion",
            "velocities"
            | "vector_velocity"
            | "gap_velocity"
            | "normal_gap_velocity"
            | "factored_velocities",
        ) => (8, "velocities"),
        (
            "geometry",
            "motion",
            "accelerations"
            | "vector_velocity_and_acceleration"
            | "gap_velocity_and_acceleration"
            | "normal_gap_acceleration"
            | "factored_accelerations",
        ) => (9, "accelerations"),
        ("geometry", "motion", _) => (10, "velocities of actuated frames and slides"),
        ("geometry", "motion/multipliers", _) => (13, "multipliers, group by group"),
        ("kinetostatics", "pass/acceleration", _)
        | ("kinetostatics", "pass/recursive_pass", "forward_pass") => (11, "inertia forces"),
        ("kinetostatics", "pass/recursive_pass", "backward_pass") => (12, "forces along the tree"),
        (
            "kinetostatics",
            "pass/recursive_pass",
            "store_inertia_forces" | "accumulate_joint_forces" | "loop_joint_force",
        ) => (14, "forces in the tree's joints"),
        (
            "kinetostatics",
            "pass/recursive_pass",
            "accumulate_joint_moments" | "transfer_joint_moments",
        ) => (15, "moments in the tree's joints"),
        ("kinetostatics", "pass/recursive_pass", "tau") => (16, "actuator forces"),
        (
            "kinetostatics",
            "pass/recursive_pass",
            "evaluate_loaded" | "evaluate" | "propagate_loads",
        ) => (22, "loads along the tree"),
        ("kinetostatics", "pass/sources", _) => (18, "reactions"),
        ("kinetostatics", "friction", _) | ("kinetostatics", _, "solve_friction") => {
            (23, "friction")
        }
        ("kinetostatics", "reduced" | "model/kinematic_state" | "model/workspace", _) => {
            (19, "unit accelerations")
        }
        ("geometry", "body_states", _) => (20, "states of bodies and distances"),
        ("kinetostatics", _, _) if module.starts_with("load") => (21, "loads"),
        ("laws", _, _) | ("numerics", "scalar", _) => (24, "laws and number types"),
        _ => return None,
    })
}
