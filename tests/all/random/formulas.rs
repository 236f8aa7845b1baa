//! The random mechanisms that are made of dyads, as closed forms.

use super::{Made, seed};
use crate::random::standing::View;
use dwell_symbolic::{Symbolic, SymbolicError};
use proptest::prelude::*;
use proptest::test_runner::{FileFailurePersistence, TestRunner};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Mechanisms of one run.
const COUNT: u32 = 250;
/// What is allowed of the largest quantity: roundings, of which a long chain makes many.
const TOLERANCE: f64 = 1e-12;
/// And of what one unit of rounding in the lengths does to the forms themselves.
const OF_ROUNDING: f64 = 30.0;

/// What was met.
#[derive(Debug, Default)]
struct Met {
    held: u32,
    reactions: usize,
    /// What was in the way of how many, and how the plan solves it.
    refused: BTreeMap<(&'static str, &'static str), u32>,
    worst: f64,
}

fn hold(made: &Made, met: &mut Met) -> Result<(), String> {
    let (mechanism, model) = (&made.described.mechanism, &made.model);
    let plan = model.plan();
    let symbolic = match Symbolic::new(mechanism, &made.described.masses, plan) {
        Ok(symbolic) => symbolic,
        Err(SymbolicError::Group { what, group, .. }) => {
            let solved = plan.group_kinds()[group].1;
            *met.refused.entry((what, solved)).or_default() += 1;
            return Ok(());
        }
        Err(other) => return Err(other.to_string()),
    };
    let q = plan.start()[0];
    let mut out = model.coefficients::<f64>();
    model
        .reduce(q, &mut model.workspace(), &mut out)
        .map_err(|e| e.to_string())?;
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |s, v| s.max(v.abs()));
    let mut scale = [out.m, out.m, largest(&out.a), largest(&out.b)];
    scale[1] = scale[1].max(out.half_dm.abs());
    // What is zero throughout is measured by its neighbour: lengths are about one metre.
    scale[3] = scale[3].max(scale[2]);
    for (k, &reaction) in mechanism.reactions().iter().enumerate() {
        if !plan.is_unique(k) {
            continue;
        }
        let form = symbolic.form(Some(reaction)).map_err(|e| e.to_string())?;
        let (found, own) = (form.evaluate(q), form.rounding(q));
        let wanted = [out.m, out.half_dm, out.a[k], out.b[k]];
        let first = found.len() - wanted.len();
        for (j, wanted) in wanted.into_iter().enumerate() {
            let apart = (found[first + j] - wanted).abs();
            let allowed = TOLERANCE * scale[j] + OF_ROUNDING * own[first + j];
            if apart > 0.0 {
                met.worst = met.worst.max(apart / allowed);
            }
            if apart.is_nan() || apart > allowed {
                let name = mechanism.reaction_name(reaction);
                return Err(format!(
                    "{name} {j}: {apart:.1e} where {allowed:.1e} is allowed, of {:.1e}",
                    scale[j]
                ));
            }
        }
        met.reactions += 1;
    }
    met.held += 1;
    Ok(())
}

#[test]
fn random_dyads_agree_with_their_closed_forms() {
    let failures = FileFailurePersistence::Direct("proptest-regressions/formulas.txt");
    let mut runner = TestRunner::new(ProptestConfig {
        cases: COUNT,
        failure_persistence: Some(Box::new(failures)),
        max_shrink_iters: 300,
        ..ProptestConfig::default()
    });
    let met = RefCell::new(Met::default());
    let result = runner.run(&seed(), |mut seed| {
        seed.drives.truncate(1);
        // Formulas of long chains are long, and show nothing more.
        seed.steps.truncate(5);
        let standing = seed.grown();
        let view = View::of(&standing, seed.views[0]);
        let Ok(made) = Made::new(&standing, &view) else {
            return Ok(());
        };
        hold(&made, &mut met.borrow_mut())
            .map_err(|fault| TestCaseError::fail(format!("{fault}\n{standing:?}")))
    });
    let met = met.into_inner();
    println!("{met:?}");
    if let Err(error) = result {
        panic!("{error}");
    }
    assert!(met.held * 8 >= COUNT, "{met:?}");
}
