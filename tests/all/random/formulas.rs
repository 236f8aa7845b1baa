//! The random mechanisms that are made of dyads, as closed forms.

use super::{BuiltMechanism, condition, seed};
use crate::random::placed_mechanism::Description;
use dwell_symbolic::{Symbolic, SymbolicError};
use proptest::prelude::*;
use proptest::test_runner::{FileFailurePersistence, TestRunner};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// What is allowed of the largest quantity: roundings, of which a long chain makes many.
const TOLERANCE: f64 = 1e-12;
/// And of what one unit of rounding in the lengths does to the forms themselves.
const ROUNDING_FACTOR: f64 = 30.0;

/// What was met.
#[derive(Debug, Default)]
struct Coverage {
    checked: u32,
    reactions: usize,
    /// Bars in one line at the start: the branch is that of a rounding, and there is nothing to compare.
    singular: u32,
    /// What was in the way of how many, and how the plan solves it.
    refused: BTreeMap<(&'static str, &'static str), u32>,
    worst: f64,
}

fn check(built: &BuiltMechanism, coverage: &mut Coverage) -> Result<(), String> {
    let (mechanism, model) = (&built.described.mechanism, &built.model);
    let plan = model.plan();
    let symbolic = match Symbolic::new(mechanism, &built.described.masses, plan) {
        Ok(symbolic) => symbolic,
        Err(SymbolicError::Group { what, group, .. }) => {
            let solved = plan.group_methods()[group].1;
            *coverage.refused.entry((what, solved)).or_default() += 1;
            return Ok(());
        }
        Err(other) => return Err(other.to_string()),
    };
    let q = plan.assembly_coordinates()[0];
    let mut out = model.coefficient_buffer::<f64>();
    model
        .reduce(q, &mut model.workspace(), &mut out)
        .map_err(|e| e.to_string())?;
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |s, v| s.max(v.abs()));
    let mut scale = [out.m, out.m, largest(&out.a), largest(&out.b)];
    scale[1] = scale[1].max(out.half_dm.abs());
    // What is zero throughout is measured by its neighbour: lengths are about one metre.
    scale[3] = scale[3].max(scale[2]);
    for (k, &reaction) in mechanism.reactions().iter().enumerate() {
        if !plan.is_determinate(k) {
            continue;
        }
        let form = symbolic
            .closed_form(Some(reaction))
            .map_err(|e| e.to_string())?;
        let (found, rounding) = (form.evaluate(q), form.rounding_error(q));
        let expected = [out.m, out.half_dm, out.a[k], out.b[k]];
        let first = found.len() - expected.len();
        for (j, expected) in expected.into_iter().enumerate() {
            let difference = (found[first + j] - expected).abs();
            let allowed = TOLERANCE * scale[j] + ROUNDING_FACTOR * rounding[first + j];
            if difference > 0.0 {
                coverage.worst = coverage.worst.max(difference / allowed);
            }
            if difference.is_nan() || difference > allowed {
                let name = mechanism.reaction_name(reaction);
                return Err(format!(
                    "{name} {j}: {difference:.1e} where {allowed:.1e} is allowed, of {:.1e}",
                    scale[j]
                ));
            }
        }
        coverage.reactions += 1;
    }
    coverage.checked += 1;
    Ok(())
}

#[test]
fn random_dyads_agree_with_their_closed_forms() {
    let failures = FileFailurePersistence::Direct("proptest-regressions/formulas.txt");
    let mut runner = TestRunner::new(ProptestConfig {
        failure_persistence: Some(Box::new(failures)),
        max_shrink_iters: 300,
        ..ProptestConfig::default()
    });
    let coverage = RefCell::new(Coverage::default());
    let result = runner.run(&seed(), |mut seed| {
        seed.drives.truncate(1);
        // Formulas of long chains are long, and show nothing more.
        seed.steps.truncate(5);
        let standing = seed.mechanism();
        let view = Description::of(&standing, seed.views[0]);
        let Ok(built) = BuiltMechanism::new(&standing, &view) else {
            return Ok(());
        };
        if condition(&built.described)
            .map_err(TestCaseError::fail)?
            .is_none()
        {
            coverage.borrow_mut().singular += 1;
            return Ok(());
        }
        check(&built, &mut coverage.borrow_mut())
            .map_err(|fault| TestCaseError::fail(format!("{fault}\n{standing:?}")))
    });
    let coverage = coverage.into_inner();
    println!("{coverage:?}");
    if let Err(error) = result {
        panic!("{error}");
    }
    assert!(
        coverage.checked * 8 >= ProptestConfig::default().cases,
        "{coverage:?}"
    );
}
