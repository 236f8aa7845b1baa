//! The report of a case as a document.

use super::dwell::Dwell;
use super::family::Family;
use super::{dimensions, family_page};
use crate::cases::reference::Reference;
use crate::checked::analysis::CaseAnalysis;
use crate::report_parts::{TextColumn, figure_blocks, result_line, table_of};
use dwell_findings::Finding;
use dwell_report::{Block, Document, Figure};
use dwell_scene::PlaneScene;
use dwell_study::CalibrationResult;
use dwell_study::number_format::count;
use dwell_study::output::provenance_line;
use dwell_verify::{CheckedFreeMotion, ToleranceRun};

/// The document with its figures.
pub(super) fn document(
    scene: &PlaneScene,
    reference: &Reference,
    figures: &[Figure],
    analysis: &CaseAnalysis<'_>,
    dwell: Option<&Dwell>,
    family: Option<&Family>,
) -> Document {
    let mut blocks = vec![Block::Text(findings_sentence(reference, analysis))];
    blocks.extend(scene.note.iter().cloned().map(Block::Words));
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
    let of_family = family.map(|f| family_page::blocks(scene, f));
    blocks.extend(of_family.unwrap_or_default());
    blocks.extend(dimensions::blocks(scene));
    blocks.push(Block::Heading("Findings".to_owned()));
    blocks.push(Block::Findings(analysis.findings.clone()));
    blocks.push(tolerances_block(&analysis.findings));
    if let Some(motion) = reduced.and_then(|r| r.motion.as_ref()) {
        blocks.push(Block::Heading("Errors of the integrators".to_owned()));
        blocks.push(Block::Text(
            "A tolerance bounds the error of one step, not of the motion: with BDF the energy error is hundreds of times \
             the tolerance. Errors are relative; times are of the machine that wrote this report."
                .to_owned(),
        ));
        blocks.push(tolerance_runs_block(motion));
    }
    blocks.push(Block::Heading("Figures".to_owned()));
    blocks.extend(figure_blocks(&scene.name, figures, true));
    blocks.push(Block::Text(provenance_line(scene)));
    Document {
        title: scene.title.clone(),
        blocks,
    }
}

fn findings_sentence(reference: &Reference, analysis: &CaseAnalysis<'_>) -> String {
    let reference_states = match reference.state_requests().len() {
        0 => String::new(),
        n => format!(" and {n} of the reference"),
    };
    format!(
        "{} States were checked at {} instants: {}{reference_states}.",
        result_line(&analysis.findings),
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
