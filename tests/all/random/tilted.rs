//! The random planar mechanisms in oblique planes, each joint at a height of its own: evaluated in space with and without planes, they
//! have the m and ½m′ of the plane.

use super::{BuiltMechanism, seed};
use crate::random::placed_mechanism::Description;
use dwell_geometry::space::{Placement, Rotation, vec3};
use dwell_kinetostatics::space::Model;
use dwell_kinetostatics::{Coefficients, ExactModel, ReducedModel, ReducibleModel};
use dwell_tests::changes::Rng;
use dwell_tests::lifted::{Lifted, Plane};
use dwell_verify::rank;
use proptest::prelude::*;
use proptest::test_runner::{FileFailurePersistence, TestRunner};
use std::cell::RefCell;

/// What is allowed of the largest quantity, for a unit of the condition of the dense rows. Seen: 1.1e-15.
const TOLERANCE: f64 = 1e-14;

/// What was met.
#[derive(Debug, Default)]
struct Coverage {
    compared: u32,
    /// Those that are evaluated as their planar equivalent.
    in_plane: u32,
    /// What is refused in space, with planes and without.
    refused: u32,
    worst: [f64; 3],
}

/// A plane somewhere, and heights.
fn lifted(built: &BuiltMechanism, seed: u64) -> Option<Lifted> {
    let mut random = Rng(seed);
    let mut vector = |size: f64| {
        let [x, y, z] = [(); 3].map(|()| random.between(-size, size));
        vec3(x, y, z)
    };
    let frame = Placement {
        position: vector(2.0),
        rotation: Rotation::of_vector(vector(2.0)),
    };
    let joints = built.described.mechanism.joints.len();
    let count = joints.max(built.described.masses.len());
    let heights: Vec<f64> = (0..count).map(|_| vector(0.5).x).collect();
    let plane = Plane {
        frame,
        heights: &|j| heights[j],
    };
    plane.lift(&built.model, &built.described.masses)
}

fn check(built: &BuiltMechanism, seed: u64, coverage: &mut Coverage) -> Result<(), String> {
    let Some(Lifted {
        mechanism,
        masses,
        assembly,
    }) = lifted(built, seed)
    else {
        return Ok(());
    };
    let described = &built.described;
    let ranks = rank(&described.mechanism, &described.start_poses).map_err(|e| e.to_string())?;
    let values = &ranks.with_actuators.singular_values;
    let [largest, smallest] = [values.first(), values.last()].map(|v| v.copied().unwrap_or(0.0));
    let condition = largest / smallest;
    let models = [
        Model::new(&mechanism, &masses, &assembly, &[]),
        Model::without_planes(&mechanism, &masses, &assembly, &[]),
    ];
    let [Ok(with), Ok(without)] = models else {
        coverage.refused += 1;
        let refusals = models.map(|model| model.map(|_| ()));
        return match refusals[0] == refusals[1] {
            true => Ok(()),
            false => Err(format!("{refusals:?}")),
        };
    };
    if with.plan().range() != without.plan().range() {
        let ranges = [&with, &without].map(|model| model.plan().range());
        let limits = ranges.map(|range| range.limits().unwrap_or((0.0, 0.0)));
        let gap = (limits[0].0 - limits[1].0).abs() + (limits[0].1 - limits[1].1).abs();
        // Ends of ranges are where a step last converged; why one differs is not known. Seen: 1.2e-4.
        let kinds = ranges.map(|range| std::mem::discriminant(&range));
        if gap > 1e-3 || kinds[0] != kinds[1] {
            return Err(format!("{ranges:?}"));
        }
    }
    let mobilities = [&with, &without].map(|model| model.plan().mobility());
    if mobilities[0] != mobilities[1] {
        return Err(format!("{mobilities:?}"));
    }
    let q = assembly.q[0];
    let mut wanted: Coefficients = built.model.coefficient_buffer();
    built
        .model
        .reduce(q, &mut built.model.workspace(), &mut wanted)
        .map_err(|e| e.to_string())?;
    let scale = (wanted.m.abs() + wanted.half_dm.abs()) * condition;
    let reduced = ExactModel::new(with.clone()).ok_or("several actuators")?;
    let in_plane = reduced.inertia(q, &mut reduced.workspace());
    let mut found = vec![in_plane.map_err(|e| e.to_string())?];
    for model in [&with, &without] {
        let mut out: Coefficients = model.coefficient_buffer();
        let done = model.reduce(q, &mut model.workspace(), &mut out);
        done.map_err(|e| e.to_string())?;
        found.push((out.m, out.half_dm));
    }
    for (k, (m, half_dm)) in found.into_iter().enumerate() {
        let difference = (m - wanted.m).abs().max((half_dm - wanted.half_dm).abs());
        coverage.worst[k] = coverage.worst[k].max(difference / scale);
        // A difference that is no number fails, too.
        let agrees = difference <= TOLERANCE * scale;
        if !agrees {
            return Err(format!(
                "{k}: {m} and {half_dm} for {} and {}, condition {condition:.0e}",
                wanted.m, wanted.half_dm
            ));
        }
    }
    coverage.compared += 1;
    coverage.in_plane += u32::from(with.for_inertia().is_in_plane());
    Ok(())
}

#[test]
fn random_planar_mechanisms_agree_in_oblique_planes() {
    let failures = FileFailurePersistence::Direct("proptest-regressions/tilted.txt");
    let mut runner = TestRunner::new(ProptestConfig {
        failure_persistence: Some(Box::new(failures)),
        max_shrink_iters: 300,
        ..ProptestConfig::default()
    });
    let coverage = RefCell::new(Coverage::default());
    let result = runner.run(&seed(), |mut seed| {
        seed.drives.truncate(1);
        seed.steps.truncate(4);
        // Bars in one line are refused by rank, which has tests of its own.
        seed.flat = None;
        let standing = seed.mechanism();
        let view = Description::of(&standing, seed.views[0]);
        let Ok(built) = BuiltMechanism::new(&standing, &view) else {
            return Ok(());
        };
        check(&built, seed.views[1], &mut coverage.borrow_mut())
            .map_err(|fault| TestCaseError::fail(format!("{fault}\n{standing:?}")))
    });
    let coverage = coverage.into_inner();
    println!("{coverage:?}");
    if let Err(error) = result {
        panic!("{error}");
    }
    assert!(
        coverage.compared * 16 >= ProptestConfig::default().cases && coverage.in_plane > 0,
        "{coverage:?}"
    );
}
