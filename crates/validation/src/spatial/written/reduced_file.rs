//! The table of `reduce`: m, ½m′, a, b, and what the loads make, at its rows, with the dense equations at the model's placements there.

use super::super::claims::{NAMES, SpaceClaims, components, constant};
use super::finding;
use crate::error::ValidationError;
use crate::written::motions::simpson;
use crate::written::poses::difference::Differences;
use crate::written::poses::program::Program;
use crate::written::poses::range::range_differences;
use crate::written::poses::rows::{Rows, largest};
use dwell_findings::{Check, Finding};
use dwell_kinetostatics::space::{Load, LoadKind};
use dwell_scene::SpaceScene;
use dwell_verify::FindingSpec;
use dwell_verify::space::DenseSpace;
use std::path::Path;

const COEFFICIENTS: FindingSpec<'_> = FindingSpec {
    key: "written-reduced",
    check: Check::WrittenForces,
    comparison: "m, ½m′, w, a, b and c of the table with the dense equations at unit speed, unit acceleration and under the loads",
    scale: "the largest of each pass, of its kind, in the row, or a thousandth of what the whole mass makes",
    // The largest seen in a case is 2.6e-12.
    tolerance: 2e-10,
    tolerance_reason: "rounding, amplified by the condition of the equations",
};

const RANGE: FindingSpec<'_> = FindingSpec {
    key: "written-range",
    check: Check::WrittenTotals,
    comparison: "the ends of the rows of `reduce` with the limit positions of `check`",
    scale: "the range",
    // The largest seen in a case is 1.1e-16.
    tolerance: 1e-14,
    tolerance_reason: "rounding of the limits",
};
const SLOPES: FindingSpec<'_> = FindingSpec {
    key: "written-slopes",
    check: Check::WrittenRates,
    comparison: "m and V of `reduce` with the integrals of 2·½m′ and −w between rows, by Simpson's rule",
    scale: "the largest of the column, or of its slope times the range",
    // The largest seen in a case is 3.1e-16: nothing is left beyond the rule's estimated error.
    tolerance: 3e-14,
    tolerance_reason: "what the rule's estimated error leaves",
};

/// A pass: speed and acceleration of the coordinate, and whether the loads act.
#[derive(Clone, Copy)]
struct Pass {
    q_dot: f64,
    q_ddot: f64,
    is_loaded: bool,
}

/// Unit speed, unit acceleration from rest, and the loads at rest.
const PASSES: [Pass; 3] = [
    Pass {
        q_dot: 1.0,
        q_ddot: 0.0,
        is_loaded: false,
    },
    Pass {
        q_dot: 0.0,
        q_ddot: 1.0,
        is_loaded: false,
    },
    Pass {
        q_dot: 0.0,
        q_ddot: 0.0,
        is_loaded: true,
    },
];

impl Pass {
    /// A thousandth of the force that the pass gives the whole mass at the size of the mechanism, N or kg m.
    fn floor(self, claims: &SpaceClaims<'_>, scene: &SpaceScene) -> f64 {
        let mass: f64 = scene.masses.iter().map(|mass| mass.mass).sum();
        let weight = scene.loads.iter().find_map(|load| match constant(load)? {
            (LoadKind::Gravity(_), magnitude) => Some(magnitude),
            _ => None,
        });
        let plan = claims.model().plan();
        let acceleration = match self.is_loaded {
            true => weight.unwrap_or(1.0),
            false if plan.is_angle(0) => plan.size(),
            false => 1.0,
        };
        1e-3 * mass * acceleration
    }
}

/// Rows of the table, and those that are judged.
const POINTS: &str = "97";
const STEP: usize = 16;

/// The finding of the table that the program at a path writes.
pub(super) fn findings(
    scene: &SpaceScene,
    (program, text): (&Path, &str),
) -> Result<Vec<Finding>, ValidationError> {
    let claims = SpaceClaims::new(scene)?;
    let read = || -> Result<(Rows, Differences), String> {
        let program = Program::new(program, &format!("{}-reduced", scene.name));
        let run = program.run(&scene.name, text, &["reduce", "--points", POINTS])?;
        let rows = run.csv("-reduced.csv")?;
        let contents = program.run(&scene.name, text, &["check"])?;
        let summary = contents.json("-check.json")?;
        let coordinate = &scene.mechanism.actuators[0].name;
        let range = range_differences((&summary, &contents.printed), &rows, coordinate);
        Ok((rows, range))
    };
    let (rows, range) = match read() {
        Ok(read) => read,
        Err(reason) => return Ok(vec![super::refused(&reason)]),
    };
    let mut worst = Differences::default();
    for row in (1..rows.count).step_by(STEP) {
        compare(&mut worst, &claims, scene, (&rows, row));
    }
    let mut found: Vec<Finding> = finding(worst, &COEFFICIENTS, &rows, "reduced.csv")
        .into_iter()
        .collect();
    found.extend(slopes(scene, &rows));
    found.extend(range.counted_finding(&RANGE, "reduced.csv"));
    Ok(found)
}

/// m′ = 2·½m′, and V′ = −Σ w F of the loads that have a potential, by Simpson's rule between rows.
fn slopes(scene: &SpaceScene, rows: &Rows) -> Option<Finding> {
    let q = rows.column(&scene.mechanism.actuators[0].name);
    let ends = q.last().zip(q.first());
    let span = ends.map_or(1.0, |(last, first)| last - first);
    let mut found = Differences::default();
    let mut compare = |what: &str, values: &[f64], slope: &[f64]| {
        let scale = largest(values).max(largest(slope) * span.abs());
        simpson(&mut found, q, [values, slope], scale, what);
    };
    let halves = rows.column("half_dm").iter();
    let slope: Vec<f64> = halves.map(|half| 2.0 * half).collect();
    compare("m", rows.column("m"), &slope);
    let weight = |load: &Load| match constant(load)? {
        (LoadKind::Gravity(_), magnitude) => Some(magnitude),
        _ => None,
    };
    // Of other loads not every one has a potential.
    let weights: Option<Vec<f64>> = scene.loads.iter().map(weight).collect();
    if let (Some(weights), true) = (weights, rows.columns.contains_key("V")) {
        let mut slope = vec![0.0; q.len()];
        for (load, magnitude) in scene.loads.iter().zip(weights) {
            let w = rows.column(&format!("{}.w", load.name));
            for (slope, w) in slope.iter_mut().zip(w) {
                *slope -= magnitude * w;
            }
        }
        compare("V", rows.column("V"), &slope);
    }
    found.counted_finding(&SLOPES, "reduced.csv")
}

/// The three passes of a row.
// Long because each pass has its columns, its signs and its scales.
fn compare(
    worst: &mut Differences,
    claims: &SpaceClaims<'_>,
    scene: &SpaceScene,
    (rows, row): (&Rows, usize),
) {
    let q = rows.get(row, &scene.mechanism.actuators[0].name);
    let q = q.unwrap_or(f64::NAN);
    let Ok(placements) = claims.placements::<f64>(&[q]) else {
        let place = || format!("q = {q:.4}: no pose");
        return worst.compare([f64::NAN, 0.0, 1.0], "", place);
    };
    let plan = claims.model().plan();
    let (size, is_angle) = (plan.size(), plan.is_angle(0));
    let columns = [["half_dm", "b"], ["m", "a"], ["w", "c"]];
    for (pass, [of_actuator, of_reaction]) in PASSES.into_iter().zip(columns) {
        let loads: Vec<(LoadKind, f64)> = match pass.is_loaded {
            true => scene.loads.iter().filter_map(constant).collect(),
            false => Vec::new(),
        };
        let rates: [&[f64]; 2] = [&[pass.q_dot], &[pass.q_ddot]];
        let (mechanism, masses) = (&scene.mechanism, &scene.masses);
        let Ok(dense) = DenseSpace::new(mechanism, masses, &placements, rates, &loads) else {
            continue;
        };
        // Under loads: the sum of each load's column times its magnitude.
        let written = |name: &str, kind: &str| match pass.is_loaded {
            false if name.is_empty() => rows.get(row, kind),
            false => rows.get(row, &format!("{name}.{kind}")),
            true => {
                let of_load = |load: &Load| {
                    let (_, magnitude) = constant(load)?;
                    let column = match name.is_empty() {
                        true => format!("{}.{kind}", load.name),
                        false => format!("{name}.{kind}.{}", load.name),
                    };
                    Some(magnitude * rows.get(row, &column)?)
                };
                scene.loads.iter().map(of_load).sum::<Option<f64>>()
            }
        };
        let floor = pass.floor(claims, scene);
        let all: Vec<[f64; 6]> = dense.reactions.iter().map(components).collect();
        let largest = |kind: usize| {
            let of_kind = all.iter().zip(&dense.determined).flat_map(|(v, is)| {
                let determined = (3 * kind..3 * kind + 3).filter(|k| is[*k]);
                determined.map(|k| &v[k])
            });
            largest(of_kind)
        };
        let scales = [largest(0).max(floor), largest(1).max(floor * size)];
        let unit = match is_angle {
            true => size,
            false => 1.0,
        };
        if let Some(found) = written("", of_actuator) {
            // The loads do what the actuator must undo.
            let sign = if pass.is_loaded { -1.0 } else { 1.0 };
            let wanted = sign * dense.actuator_actions[0];
            worst.compare([found, wanted, wanted.abs().max(floor * unit)], "", || {
                format!("q = {q:.4}, {of_actuator}")
            });
        }
        for (joint, values) in scene.mechanism.joints.iter().zip(&all) {
            for (k, end) in NAMES.into_iter().enumerate() {
                let name = format!("{}.{end}", joint.name);
                if let Some(found) = written(&name, of_reaction) {
                    worst.compare([found, values[k], scales[k / 3]], "", || {
                        format!("q = {q:.4}, {name}.{of_reaction}")
                    });
                }
            }
        }
    }
}
