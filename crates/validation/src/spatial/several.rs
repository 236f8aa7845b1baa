//! A case of several coordinates: its findings and its report.

use super::claims::{COMPONENTS, SpaceClaims};
use super::motion::motion_findings;
use super::reference::Reference;
use super::report::Report;
use super::states::{
    STATES, free_accelerations, free_machine, in_units, near_assembly, state_findings,
};
use super::stopped_motion::stopped_findings;
use crate::case_report::snapshot::rounded_to;
use crate::error::ValidationError;
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::largest;
use dwell_findings::{Check, Finding};
use dwell_kinetostatics::space::Axes;
use dwell_report::Figure;
use dwell_study::figure_of_positions;
use dwell_verify::FindingSpec;
use std::fmt::Write as _;

const INERTIA: FindingSpec<'_> = FindingSpec {
    key: "reference-inertia",
    check: Check::ReferenceValues,
    comparison: "the generalised inertias and the actuators' actions with the reference of 25 digits",
    scale: "the largest of each",
    // The largest seen in a case is 6.5e-16.
    tolerance: 5e-14,
    tolerance_reason: "rounding, amplified by the condition of the equations",
};
const REACTIONS: FindingSpec<'_> = FindingSpec {
    key: "reference-reactions",
    check: Check::ReferenceValues,
    comparison: "the reactions under the weight, in motion, with the reference of 25 digits",
    scale: "the largest force or moment",
    // The largest seen in a case is 5.0e-15.
    tolerance: 5e-13,
    tolerance_reason: "rounding, amplified by the condition of the equations",
};
/// Speeds and accelerations at which a reference is compared.
const RATES: [[f64; 4]; 2] = [[1.3, -0.7, 0.4, 0.2], [-0.9, 1.1, 0.6, -0.5]];

/// All findings of a scene.
fn findings(
    claims: &SpaceClaims<'_>,
    reference: Option<&Reference>,
) -> Result<Vec<Finding>, ValidationError> {
    let scene = claims.scene();
    let mut found = state_findings(claims, &near_assembly(scene, claims.model()))?;
    found.extend(match scene.stops.is_empty() {
        true => motion_findings(claims, reference)?,
        false => stopped_findings(claims)?,
    });
    if let Some(reference) = reference {
        found.extend(against_reference(claims, reference));
    }
    Ok(found)
}

fn against_reference(claims: &SpaceClaims<'_>, reference: &Reference) -> Vec<Finding> {
    let mut worst = <[Differences; 2]>::default();
    let rates = RATES.each_ref().map(|row| in_units(claims.model(), row));
    let rates = [&rates[0][..], &rates[1][..]];
    let mut count = 0;
    for sample in reference.of_two_coordinates() {
        let wanted = (
            sample.coordinates(),
            sample.inertias(),
            sample.actions(rates),
        );
        let (Some(q), Some(inertias), Some(actions)) = wanted else {
            continue;
        };
        count += 1;
        let place = |what: &str| format!("q = {:.4} {:.4}, {what}", q[0], q[1]);
        let state = claims.state::<f64>(0.0, [&q, rates[0], rates[1]], Axes::Ground);
        let Ok(state) = state else {
            worst[0].compare([f64::NAN, 0.0, 1.0], "", || place("no pose"));
            continue;
        };
        let scale = largest(&inertias);
        for (found, wanted) in state.inertias.iter().zip(inertias) {
            worst[0].compare([*found, wanted, scale], "kg m2", || place("inertia"));
        }
        let scale = largest(&actions);
        for (found, wanted) in state.tau.iter().zip(actions) {
            worst[0].compare([*found, wanted, scale], "N m", || place("action"));
        }
        let reactions = sample.reactions(rates);
        let scales = [0, 1].map(|kind| {
            let of_kind = reactions.iter().filter(|(_, k, _)| k / 3 == kind);
            largest(of_kind.map(|(.., value)| value))
        });
        for (joint, k, wanted) in reactions {
            let mut joints = claims.scene().mechanism.joints.iter();
            let index = joints.position(|j| j.name == joint);
            let found = index.map_or(f64::NAN, |j| state.reactions[COMPONENTS * j + k]);
            let unit = ["N", "N m"][k / 3];
            worst[1].compare([found, wanted, scales[k / 3]], unit, || place(&joint));
        }
    }
    let domain = format!("{count} positions of the reference");
    let [inertia, reactions] = worst;
    let found = [
        inertia.finding(&INERTIA, &domain),
        reactions.finding(&REACTIONS, &domain),
    ];
    found.into_iter().flatten().collect()
}

/// The report of a case of several coordinates.
///
/// # Errors
/// [`ValidationError`] when the scene cannot be used.
pub(super) fn of_several(
    claims: &SpaceClaims<'_>,
    reference: Option<&Reference>,
) -> Result<Report, ValidationError> {
    Ok(Report {
        findings: findings(claims, reference)?,
        about: format!(
            " The mechanism has {} coordinates, so there is no reduced model: states near the assembly are \
             checked, at prescribed accelerations and in free motion, and a free motion.",
            claims.scene().mechanism.actuators.len()
        ),
        reference: "Reference",
        more: None,
        values: values(claims)?,
        figures: vec![mechanism(claims)],
    })
}

/// The mechanism at the assembly.
fn mechanism(claims: &SpaceClaims<'_>) -> Figure {
    let scene = claims.scene();
    let start = claims.placements::<f64>(&scene.assembly.q);
    let position = (start.unwrap_or_default(), "the assembly".to_owned());
    let provenance = "the mechanism at its assembly".to_owned();
    figure_of_positions(scene, vec![position], provenance)
}

/// Inertias, actions under the loads at rest and free accelerations at some states, to seven digits after the first of the largest of
/// their kind.
fn values(claims: &SpaceClaims<'_>) -> Result<String, ValidationError> {
    let scene = claims.scene();
    let machine = free_machine(scene)?;
    let actuators = scene.mechanism.actuators.iter();
    let names: Vec<&str> = actuators.map(|a| a.name.as_str()).collect();
    let mut text = format!("{}\n\n", scene.title);
    // What is zero but for rounding has no digits beside what an acceleration of one makes.
    let line = |values: &[f64], least: f64| {
        let largest = largest(values).max(least);
        let all: Vec<String> = values.iter().map(|v| rounded_to(*v, largest)).collect();
        all.join("  ")
    };
    // Writing to a string cannot fail.
    for q in near_assembly(scene, claims.model()).iter().take(STATES) {
        let at = names.iter().zip(q);
        let at: Vec<String> = at.map(|(name, q)| format!("{name} = {q:.7}")).collect();
        let _ = writeln!(text, "{}", at.join("  "));
        let at_rest = vec![0.0; q.len()];
        let Ok(state) = claims.state::<f64>(0.0, [q, &at_rest, &at_rest], Axes::Ground) else {
            let _ = writeln!(text, "    no pose");
            continue;
        };
        let inertia = largest(&state.inertias);
        for (name, row) in names.iter().zip(state.inertias.chunks(q.len())) {
            let _ = writeln!(text, "    inertia {name}: {}", line(row, inertia));
        }
        let _ = writeln!(text, "    actions at rest: {}", line(&state.tau, inertia));
        let machine = machine.as_ref();
        if let Some(free) = machine.and_then(|m| free_accelerations(m, 0.0, [q, &at_rest])) {
            let _ = writeln!(text, "    free accelerations: {}", line(&free, 1.0));
        }
    }
    Ok(text)
}
