//! What the report of a case in the plane says.

use super::dwell::Dwell;
use super::family::Family;
use super::{dimensions, family_page};
use crate::cases::reference::Reference;
use crate::checked::analysis::CaseAnalysis;
use crate::report_parts::{TextColumn, table_of};
use dwell_findings::Finding;
use dwell_report::Block;
use dwell_scene::PlaneScene;
use dwell_study::CalibrationResult;
use dwell_study::number_format::count;
use dwell_verify::{CheckedFreeMotion, ToleranceRun};

/// What precedes the findings.
pub(super) fn introduction(
    scene: &PlaneScene,
    reference: &Reference,
    analysis: &CaseAnalysis<'_>,
    dwell: Option<&Dwell>,
    family: Option<&Family>,
) -> Vec<Block> {
    let note = scene.note.iter().cloned().map(Block::Words);
    let mut blocks: Vec<Block> = note.collect();
    blocks.push(Block::Text(reference.kinds.sentence()));
    if !reference.source.is_empty() {
        blocks.push(Block::Text(format!("Source: {}.", reference.source)));
    }
    if let Some(computed) = &reference.computed_by {
        blocks.push(Block::Text(format!("Reference numbers: {computed}.")));
    }
    let reduced = analysis.reduced.as_ref();
    if let Some(calibration) = reduced.and_then(|r| r.calibration.as_ref()) {
        blocks.push(Block::Heading("Agreement by construction".to_owned()));
        blocks.push(Block::Text(calibration_sentence(calibration)));
    }
    blocks.extend(dwell.map(|d| Block::Text(dwell_sentence(scene, d))));
    blocks.extend(family.map_or_else(Vec::new, |f| family_page::blocks(scene, f)));
    blocks.extend(dimensions::blocks(scene));
    blocks
}

/// What follows the findings.
pub(super) fn remarks(analysis: &CaseAnalysis<'_>) -> Vec<Block> {
    let mut blocks = vec![tolerances_block(&analysis.findings)];
    let reduced = analysis.reduced.as_ref();
    if let Some(motion) = reduced.and_then(|r| r.motion.as_ref()) {
        blocks.push(Block::Heading("Errors of the integrators".to_owned()));
        blocks.push(Block::Text(
            "A tolerance bounds the error of one step, not of the motion: with BDF the energy error is hundreds of times \
             the tolerance. Errors are relative; times are of the machine that wrote this report."
                .to_owned(),
        ));
        blocks.push(tolerance_runs_block(motion));
    }
    blocks
}

/// What follows the number of findings that pass.
pub(super) fn findings_sentence(reference: &Reference, analysis: &CaseAnalysis<'_>) -> String {
    let reference_states = match reference.state_requests().len() {
        0 => String::new(),
        n => format!(" and {n} of the reference"),
    };
    format!(
        " States were checked at {} instants: {}{reference_states}.",
        analysis.states.states.len(),
        analysis.states.motion_text,
    )
}

fn calibration_sentence(c: &CalibrationResult) -> String {
    format!(
        "`{}` is fitted to the period of {} s, so that the period is not a finding. The fit gives **{:.12} {}** for \
         {} s; the scene has the rounded value {} {}, for which the period is {:.12} s.",
        c.path, c.period, c.value, c.unit, c.period, c.current, c.unit, c.current_period
    )
}

fn dwell_sentence(scene: &PlaneScene, dwell: &Dwell) -> String {
    let body = scene.mechanism.body_name(dwell.body);
    let [variation, swing] = [dwell.variation, dwell.swing].map(f64::to_degrees);
    let [from, to] = [dwell.from, dwell.to].map(f64::to_degrees);
    format!(
        "Dwell: the angle of `{body}` varies by {variation:.3}° (of {swing:.2}° over the whole range) while the actuator \
         moves from {from:.1}° to {to:.1}°."
    )
}

/// The paragraph on the tolerances of a case.
fn tolerances_block(findings: &[Finding]) -> Block {
    let loose: Vec<String> = (findings.iter().filter(|f| f.is_loose()))
        .map(|f| format!("`{}` (at most {:.0e})", f.key, f.max_tolerance()))
        .collect();
    let integrated = findings.iter().filter(|f| f.integrated).count();
    let mut text = match loose.is_empty() {
        true => "No tolerance is above 100 times the largest difference plus 50 rounding errors times the condition number.".to_owned(),
        false => format!(
            "Tolerances above 100 times the largest difference plus 50 rounding errors times the condition number: {}.",
            loose.join(", ")
        ),
    };
    if integrated > 0 {
        text += &format!(
            " That rule does not apply to {}, which are checked by convergence orders and by multiples of the integrator's tolerance.",
            count(integrated, "integrated result")
        );
    }
    Block::Text(text)
}

/// Cost and errors of every method and tolerance.
fn tolerance_runs_block(motion: &CheckedFreeMotion) -> Block {
    let columns: [TextColumn<&ToleranceRun>; 10] = [
        ("Method", |r| r.method.name().to_owned()),
        ("Tolerance", |r| format!("{:.0e}", r.tolerance)),
        ("Steps", |r| r.statistics.steps.to_string()),
        ("Evaluations", |r| r.statistics.evaluations.to_string()),
        ("Jacobians", |r| r.statistics.jacobians.to_string()),
        ("Time (ms)", |r| format!("{:.2}", r.wall_time * 1e3)),
        ("Period", |r| format!("{:.1e}", r.period_error)),
        ("Energy", |r| format!("{:.1e}", r.drift)),
        ("Reaction", |r| format!("{:.1e}", r.reaction_error)),
        ("Energy error / tolerance", |r| {
            format!("{:.0}", r.drift / r.tolerance)
        }),
    ];
    table_of(&columns, motion.tolerance_runs.iter())
}
