//! All findings of a case in space.

use super::claims::SpaceClaims;
use super::reference::SpaceReference;
use super::states::state_findings;
use crate::error::ValidationError;
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::largest;
use dwell_findings::{Check, Finding};
use dwell_kinetostatics::Coefficients;
use dwell_study::PreparedSpaceScene;
use dwell_study::reduce::compute::ReducedScene as _;
use dwell_verify::{Case, FindingSpec, verify_all};

/// Positions at which everything is compared.
const POSITIONS: usize = 12;

const IN_PASSES: FindingSpec<'_> = FindingSpec {
    key: "reduced-passes",
    check: Check::NewtonEuler,
    comparison: "m, ½m′, a and b of the reduced model with the two runs of the mechanism in space",
    scale: "m, and the largest reaction of the run there",
    // Seen: 3.5e-15.
    tolerance: 3e-13,
    tolerance_reason: "rounding, amplified by the condition of the equations",
};
const DIGITS: FindingSpec<'_> = FindingSpec {
    key: "rounding",
    check: Check::Rounding,
    comparison: "m, ½m′, a and b with 32-digit arithmetic",
    scale: "the largest of each kind",
    tolerance: 1e-11,
    ..IN_PASSES
};

/// All findings; a reference may be missing.
pub(super) fn findings(
    claims: &SpaceClaims<'_>,
    prepared: &PreparedSpaceScene<'_>,
    reference: Option<&SpaceReference>,
) -> Result<Vec<Finding>, ValidationError> {
    let q = positions(prepared);
    let case = Case {
        mechanism: claims.assembled().mechanism,
        range: prepared.range(),
        positions: q.clone(),
    };
    let mut found = verify_all(&case, claims, &[]);
    let domain = format!("{POSITIONS} positions");
    found.extend(against_passes(prepared, &q)?.finding(&IN_PASSES, &domain));
    found.extend(rounding(prepared, &q)?.finding(&DIGITS, &domain));
    let positions: Vec<Vec<f64>> = q.iter().step_by(3).map(|q| vec![*q]).collect();
    found.extend(state_findings(claims, &positions)?);
    if let Some(reference) = reference {
        found.extend(reference.findings_of_one(claims, prepared)?);
    }
    Ok(found)
}

/// Positions between the ends of the range, and at no special place of it.
fn positions(prepared: &PreparedSpaceScene<'_>) -> Vec<f64> {
    let [from, to] = prepared.drawn_range();
    let at = |k: usize| from + (to - from) * (k as f64 + 0.43) / POSITIONS as f64;
    (0..POSITIONS).map(at).collect()
}

/// The reduced coefficients, which may come from a planar equivalent, with the passes that the dense equations judge.
fn against_passes(
    prepared: &PreparedSpaceScene<'_>,
    q: &[f64],
) -> Result<Differences, ValidationError> {
    let mut worst = Differences::default();
    let model = prepared.model.model();
    let (mut workspace, mut found) = (model.workspace(), model.result_buffer());
    let names = prepared.reaction_units();
    for (&q, at) in q.iter().zip(&prepared.coefficients(q)?) {
        // At unit speed, and at unit acceleration from rest.
        let runs = [
            ([[1.0], [0.0]], at.half_dm, &at.b),
            ([[0.0], [1.0]], at.m, &at.a),
        ];
        for (rates, action, reactions) in runs {
            let done =
                model.inverse_dynamics(&[q], &rates[0], &rates[1], &mut workspace, &mut found);
            done.map_err(|e| prepared.explain(&e))?;
            let place = |what: &str| format!("q = {q:.4}, {what}");
            worst.compare([action, found.tau[0], at.m], "kg m2", || place("m or ½m′"));
            let wanted = &found.reactions;
            let largest = largest(wanted);
            for ((name, _), (found, wanted)) in names.iter().zip(reactions.iter().zip(wanted)) {
                worst.compare([*found, *wanted, largest], "", || place(name));
            }
        }
    }
    Ok(worst)
}

/// The errors of rounding.
fn rounding(
    prepared: &PreparedSpaceScene<'_>,
    positions: &[f64],
) -> Result<Differences, ValidationError> {
    let mut worst = Differences::default();
    let all = prepared.coefficients(positions)?;
    let m_max = all.iter().map(|at| at.m).fold(0.0, f64::max);
    let largest = |of: fn(&Coefficients) -> &Vec<f64>| largest(all.iter().flat_map(of));
    let (a_max, b_max) = (largest(|at| &at.a), largest(|at| &at.b));
    for (&q, at) in positions.iter().zip(&all) {
        let errors = prepared.rounding_errors(q, at)?;
        let place = |what: &str| format!("q = {q:.4}, {what}");
        worst.compare([errors.m, 0.0, m_max], "kg m2", || place("m"));
        worst.compare([errors.half_dm, 0.0, m_max], "kg m2/rad", || place("½m′"));
        for (errors, max, what) in [(&errors.a, a_max, "a"), (&errors.b, b_max, "b")] {
            let error = errors.iter().copied().fold(0.0, f64::max);
            worst.compare([error, 0.0, max], "", || place(what));
        }
    }
    Ok(worst)
}
