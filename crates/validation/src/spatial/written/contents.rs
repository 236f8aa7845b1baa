//! What `check` says of a scene: which components of reactions the loads determine, by the ranks of the dense equations at the assembly, and
//! how many bodies, joints and coordinates there are.

use super::super::claims::{NAMES, SpaceClaims};
use crate::written::poses::difference::Differences;
use crate::written::poses::program::Program;
use crate::written::poses::stated::result;
use dwell_findings::{Check, Finding};
use dwell_geometry::space::{Placement, Vec3};
use dwell_kinetostatics::MachineModel as _;
use dwell_scene::SpaceScene;
use dwell_verify::FindingSpec;
use dwell_verify::space::DenseSpace;
use serde_json::Value as Json;

/// The findings of its sentences.
// Long because each sentence of `check` is judged in its own way, into one finding.
pub(super) fn findings(
    program: &Program,
    (claims, scene): (&SpaceClaims<'_>, &SpaceScene),
) -> Result<Vec<Finding>, String> {
    let run = program.run(&scene.name, scene.source.inner(), &["check"])?;
    let zero = vec![0.0; scene.mechanism.actuators.len()];
    let (case, rates) = (claims.case(), [&zero[..]; 2]);
    let dense = DenseSpace::new(case.mechanism, case.masses, case.start.1, rates, &[]);
    let dense = dense.map_err(|e| e.to_string())?;
    let mut found = Differences::default();
    let mut says = |what: String| {
        let is_said = run.printed.contains(&what);
        found.require(is_said, || format!("`check` does not say `{what}`"));
    };
    let count = |n: usize, one: &str, many: &str| match n {
        1 => format!("1 {one}"),
        _ => format!("{n} {many}"),
    };
    says(count(
        scene.mechanism.bodies.len() - 1,
        "moving body",
        "moving bodies",
    ));
    says(count(scene.mechanism.joints.len(), "joint", "joints"));
    says(count(zero.len(), "degree of freedom", "degrees of freedom"));
    if !scene.lists_reactions {
        let mut lines = run.printed.lines();
        let said = lines.find_map(|line| line.trim().strip_prefix("statically determinate: "));
        let said: Vec<&str> = said.map_or_else(Vec::new, |list| list.split(", ").collect());
        for (joint, determined) in scene.mechanism.joints.iter().zip(&dense.determined) {
            for (end, is) in NAMES.into_iter().zip(determined) {
                let name = format!("{}.{end}", joint.name);
                // A component that the joint does not transmit is zero, and not a reaction.
                let is_right = *is || !said.contains(&name.as_str());
                found.require(is_right, || {
                    format!("`check` says that {name} is determined")
                });
            }
        }
    }
    let summary = run.json("-check.json")?;
    for stop in &scene.stops {
        let per = match claims.model().is_angle(stop.actuator.0) {
            true => ["N m/rad", "N m s/rad"],
            false => ["N/m", "N s/m"],
        };
        let numbers = stop
            .yielding
            .into_iter()
            .flatten()
            .zip(["stiffness", "damping"]);
        for ((value, what), unit) in numbers.zip(per) {
            let written = &summary["results"][format!("stop.{}.{what}", stop.name)];
            found.add(
                written["value"].as_f64().unwrap_or(f64::NAN) - value,
                value,
                unit,
                || format!("{what} of {}", stop.name),
            );
            if written["unit"].as_str() != Some(unit) {
                found.fail(format!("{what} of {} in {}", stop.name, written["unit"]));
            }
        }
    }
    let masses = masses(&summary, scene, case.start.1, claims.model().plan().size());
    let texts = FindingSpec {
        key: "written-contents",
        check: Check::WrittenSentences,
        comparison: "counts and determined reactions that `check` prints with the scene and the ranks of the dense equations",
        scale: "nothing: words",
        tolerance: 0.0,
        tolerance_reason: "words",
    };
    let of_masses = FindingSpec {
        key: "written-contents-masses",
        check: Check::WrittenTotals,
        comparison: "the whole mass and its centre with the sums over the bodies where they are assembled",
        scale: "the whole mass, or the size of the mechanism",
        // The largest seen in a case is 7.9e-16.
        tolerance: 7e-14,
        tolerance_reason: "a sum of rounded terms",
    };
    let found = [
        found.counted_finding(&texts, "check"),
        masses.counted_finding(&of_masses, "check"),
    ];
    Ok(found.into_iter().flatten().collect())
}

/// The mass of the moving bodies, and its first moments, about the origin, over it.
fn masses(summary: &Json, scene: &SpaceScene, places: &[Placement], size: f64) -> Differences {
    let mut found = Differences::default();
    let moving = |body: &usize| *body != scene.mechanism.ground;
    let all = (0..scene.masses.len()).filter(moving);
    let total: f64 = all.clone().map(|body| scene.masses[body].mass).sum();
    let mut add = |name: &str, value: f64, scale: f64, unit: &'static str| {
        if total > 0.0 {
            let difference = result(summary, name).unwrap_or(f64::NAN) - value;
            found.add(difference, scale, unit, || name.to_owned());
        }
    };
    add("mass", total, total, "kg");
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let of = |v: Vec3| [v.x, v.y, v.z][axis];
        let moments = all.clone().map(|body| {
            let Placement { position, rotation } = &places[body];
            let mass = &scene.masses[body];
            mass.mass * (of(*position) + of(rotation.apply(mass.center)))
        });
        let moment: f64 = moments.sum();
        add(&format!("mass.center.{name}"), moment / total, size, "m");
    }
    found
}
