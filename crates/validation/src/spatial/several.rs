//! A case of several coordinates: its findings and its report.

use super::claims::SpaceClaims;
use super::motion::motion_findings;
use super::reference::SpaceReference;
use super::report::source;
use super::states::{STATES, free_accelerations, free_machine, near_assembly, state_findings};
use super::stopped_motion::stopped_findings;
use crate::case_report::report::CaseReport;
use crate::case_report::snapshot::rounded_to;
use crate::error::ValidationError;
use crate::written::poses::rows::largest;
use dwell_findings::Finding;
use dwell_kinetostatics::space::Axes;
use dwell_report::Figure;
use dwell_study::figure_of_positions;
use std::fmt::Write as _;

/// All findings of a scene.
fn findings(
    claims: &SpaceClaims<'_>,
    reference: Option<&SpaceReference>,
) -> Result<Vec<Finding>, ValidationError> {
    let scene = claims.scene();
    let mut found = state_findings(claims, &near_assembly(scene, claims.model()))?;
    found.extend(match scene.stops.is_empty() {
        true => motion_findings(claims, reference)?,
        false => stopped_findings(claims)?,
    });
    found.extend(reference.map_or_else(Vec::new, |reference| reference.findings_of_two(claims)));
    Ok(found)
}

/// The report of a case of several coordinates.
///
/// # Errors
/// [`ValidationError`] when the scene cannot be used.
pub(super) fn of_several(
    claims: &SpaceClaims<'_>,
    reference: Option<&SpaceReference>,
) -> Result<CaseReport, ValidationError> {
    Ok(CaseReport {
        findings: findings(claims, reference)?,
        about: format!(
            " The mechanism has {} coordinates, so there is no reduced model: states near the assembly are \
             checked, at prescribed accelerations and in free motion, and a free motion.",
            claims.scene().mechanism.actuators.len()
        ),
        introduction: source("Reference", reference),
        values: values(claims)?,
        figures: vec![mechanism(claims)],
        ..CaseReport::default()
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
    let mut text = String::new();
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
