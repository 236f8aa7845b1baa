//! Which components of reactions `check` says that the loads determine, by the ranks of the dense equations at the assembly.

use super::claims::{NAMES, SpaceClaims};
use crate::written::poses::difference::Differences;
use crate::written::poses::program::Program;
use dwell_findings::{Check, Finding};
use dwell_verify::FindingSpec;
use std::path::Path;

const SPEC: FindingSpec<'_> = FindingSpec {
    key: "written-determined",
    check: Check::WrittenSentences,
    comparison: "determined reactions that `check` prints with the ranks of the dense equations",
    scale: "nothing: words",
    tolerance: 0.0,
    tolerance_reason: "words",
};

/// The finding of what the program at a path prints; none where the scene lists the reactions that it wants.
pub(super) fn finding(claims: &SpaceClaims<'_>, program: &Path) -> Option<Finding> {
    let scene = claims.scene();
    if scene.requests.lists_reactions {
        return None;
    }
    let zero = vec![0.0; scene.mechanism.actuators.len()];
    let start = claims
        .placements::<f64>(&scene.assembly.q)
        .unwrap_or_default();
    let dense = claims.dense_pose(&start);
    let dense = dense.map(|pose| pose.solve([&zero; 2], &[]));
    let program = Program::new(program, &format!("{}-determined", scene.name));
    let run = program.run(&scene.name, scene.source.inner(), &["check"]);
    let mut found = Differences::default();
    match (run, dense) {
        (Ok(run), Ok(dense)) => {
            let mut lines = run.printed.lines();
            let said = lines.find_map(|line| line.trim().strip_prefix("statically determinate: "));
            let said: Vec<&str> = said.map_or_else(Vec::new, |list| list.split(", ").collect());
            for (joint, determined) in scene.mechanism.joints.iter().zip(&dense.determined) {
                for (end, is) in NAMES.into_iter().zip(determined) {
                    let name = format!("{}.{end}", joint.name);
                    // A component that the joint does not transmit is zero, and not a reaction.
                    found.require(*is || !said.contains(&name.as_str()), || {
                        format!("`check` says that {name} is determined")
                    });
                }
            }
        }
        (Err(reason), _) => found.fail(reason),
        (_, Err(reason)) => found.fail(reason.to_string()),
    }
    found.counted_finding(&SPEC, "check")
}
