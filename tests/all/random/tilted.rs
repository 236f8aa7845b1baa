//! The random planar mechanisms in oblique planes, each joint at a height of its own: evaluated in space with and without planes, they
//! have the m and ½m′ of the plane, and the reactions of each other.

use super::{BuiltMechanism, seed};
use crate::random::placed_mechanism::Description;
use dwell_geometry::Range;
use dwell_geometry::space::{Joint, JointKind, Placement, Rotation, vec3};
use dwell_kinetostatics::space::{Axes, Model};
use dwell_kinetostatics::{Coefficients, ExactModel, ReducedModel, ReducibleModel};
use dwell_tests::changes::Rng;
use dwell_tests::lifted::{Lifted, Plane, wrenches};
use dwell_verify::rank;
use proptest::prelude::*;
use proptest::test_runner::{FileFailurePersistence, TestRunner};
use std::cell::RefCell;

/// What is allowed of the largest quantity, for a unit of the condition of the dense rows. Seen: 1.1e-15.
const TOLERANCE: f64 = 1e-14;

/// The same of the reactions that are determined, of the largest of all: large ones that redundant constraints leave open round those beside
/// them (2e-13 of the largest determined one in the regression). Seen: 1.1e-15.
const REACTION_TOLERANCE: f64 = 5e-14;

/// What was met.
#[derive(Debug, Default)]
struct Coverage {
    compared: u32,
    /// Those with a plane whose ranges are of one kind, and of them those that are evaluated as their planar equivalent.
    as_in_plane: u32,
    in_plane: u32,
    /// What is refused in space, with planes and without.
    refused: u32,
    worst: [f64; 3],
    /// Those whose reactions are those of their planar equivalent, and how far they are from those of both models in space.
    reactions: u32,
    worst_reactions: f64,
    /// Limit positions at ends of ranges, and those at which both models in space end at other positions.
    limits: u32,
    short_of_limits: u32,
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

/// An end of a range is where a step last converged. At a limit position, where the Jacobian's determinant falls as the root of the distance δ from it,
/// that is the same with planes and without, to the smallest step. Where the plane calls an end a change point the determinant falls as δ or faster: two branches
/// meet there or pass each other closely, or two slides become parallel and their travels grow as 1/δ. There the rounding of the loops, over the
/// determinant, is larger than what Newton's method asks of its steps, from some δ on that the rounding decides.
/// In one of 2000 mechanisms, of ten slides, they end 2.6e-5 and 1.4e-5 short of a limit position: never beyond, and never but in a few.
fn compare_ranges(
    built: &BuiltMechanism,
    ranges: [Range; 2],
    coverage: &mut Coverage,
) -> Result<(), String> {
    let kinds = ranges.map(|range| std::mem::discriminant(&range));
    let limits = ranges.map(|range| range.limits().unwrap_or((0.0, 0.0)));
    let planar = built.model.plan().range_limits();
    let gaps = [limits[0].0 - limits[1].0, limits[0].1 - limits[1].1];
    let [low, high] = planar.map(|limit| limit.map_or(0.0, |limit| limit.q));
    let short = limits.map(|(from, to)| [from - low, high - to]);
    let agree = (0..2).all(|end| {
        // Seen: 1.2e-4; and 0 at nearly all limit positions, where the smallest step is 6e-9 rad.
        match planar[end] {
            Some(limit) if limit.change_point => gaps[end].abs() < 1e-3,
            Some(_) => {
                coverage.limits += 1;
                coverage.short_of_limits += u32::from(gaps[end].abs() >= 2e-8);
                gaps[end].abs() < 2e-8 || short.iter().all(|of| (-2e-8..1e-4).contains(&of[end]))
            }
            None => gaps[end].abs() < 2e-8,
        }
    });
    match agree && kinds[0] == kinds[1] {
        true => Ok(()),
        false => Err(format!("{ranges:?}, in the plane {planar:?}")),
    }
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
    let count = mechanism.joints.len();
    let all = [Axes::Ground, Axes::Joint].map(|axes| wrenches(count, axes));
    let all = all.concat();
    let models = [
        Model::new(&mechanism, &masses, &assembly, &all),
        Model::without_planes(&mechanism, &masses, &assembly, &all),
    ];
    let [Ok(with), Ok(without)] = models else {
        coverage.refused += 1;
        let refusals = models.map(|model| model.map(|_| ()));
        return match refusals[0] == refusals[1] {
            true => Ok(()),
            false => Err(format!("{refusals:?}")),
        };
    };
    let ranges = [&with, &without].map(|model| model.plan().range());
    compare_ranges(built, ranges, coverage)?;
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
    let coefficients = compare_reactions(&reduced, [&with, &without], q)?;
    let is_in_plane = with.for_inertia().is_in_plane();
    let is_oblique = |joint: &Joint| matches!(joint.kind, JointKind::Distance { .. });
    let plan = built.model.plan();
    let count = built.model.mechanism().reactions().len();
    let is_determinate = (0..count).all(|k| plan.is_determinate(k));
    // Reactions are lifted wherever no rod rises from the plane and nothing is open in it.
    if is_determinate
        && !mechanism.joints.iter().any(is_oblique)
        && reduced.model().is_in_plane() != is_in_plane
    {
        return Err("its reactions are not those of its planar equivalent".to_owned());
    }
    let kinds = [plan.range(), with.plan().range()].map(|range| range.limits().is_some());
    // Slides alone turn no body: no axis says which plane they move in.
    let mut turning = mechanism.joints.iter();
    let has_plane = turning.any(|joint| matches!(joint.kind, JointKind::Revolute));
    coverage.as_in_plane += u32::from(has_plane && kinds[0] == kinds[1]);
    coverage.reactions += u32::from(reduced.model().is_in_plane());
    coverage.worst_reactions = coverage.worst_reactions.max(coefficients / condition);
    if coefficients > REACTION_TOLERANCE * condition {
        return Err(format!(
            "reactions by {coefficients:e}, condition {condition:.0e}"
        ));
    }
    coverage.compared += 1;
    coverage.in_plane += u32::from(is_in_plane);
    Ok(())
}

/// How far the reactions of a reduced model are from those that are determined, over the largest of all, open ones included.
fn compare_reactions(
    reduced: &ExactModel<Model>,
    models: [&Model; 2],
    q: f64,
) -> Result<f64, String> {
    let mut found = reduced.coefficient_buffer();
    let done = reduced.coefficients(q, &mut reduced.workspace(), &mut found);
    done.map_err(|e| e.to_string())?;
    let mut worst = 0.0_f64;
    let mut last = None;
    for model in models {
        let mut wanted: Coefficients = model.coefficient_buffer();
        let mut workspace = model.workspace();
        let done = model.reduce(q, &mut workspace, &mut wanted);
        done.map_err(|e| e.to_string())?;
        let determined = model.determined(&[q], &mut workspace);
        let determined = determined.map_err(|e| e.to_string())?;
        if last
            .replace(determined.clone())
            .is_some_and(|last| last != determined)
        {
            return Err("other reactions are determined".to_owned());
        }
        let pairs = [(&found.a, &wanted.a), (&found.b, &wanted.b)];
        let chosen = |of: &[f64]| -> Vec<f64> {
            let pairs = of.iter().zip(&determined);
            pairs.filter(|(_, d)| **d).map(|(v, _)| *v).collect()
        };
        // All reactions may be zero.
        let [mut largest, mut difference] = [1e-3 * wanted.m.abs(), 0.0_f64];
        for (found, wanted) in pairs {
            // Large reactions that redundant constraints leave open round those beside them, too.
            largest = wanted.iter().fold(largest, |max, w| max.max(w.abs()));
            for (f, w) in chosen(found).into_iter().zip(chosen(wanted)) {
                let off = (f - w).abs();
                difference = if off.is_nan() {
                    f64::INFINITY
                } else {
                    difference.max(off)
                };
            }
        }
        worst = worst.max(difference / largest);
    }
    Ok(worst)
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
        coverage.compared * 16 >= ProptestConfig::default().cases
            // Seen: 33 of 36.
            && 10 * coverage.in_plane >= 8 * coverage.as_in_plane
            && coverage.in_plane > 0
            // Seen: 1 of about 2000.
            && 20 * coverage.short_of_limits <= coverage.limits.max(20)
            && coverage.reactions > 0,
        "{coverage:?}"
    );
}
