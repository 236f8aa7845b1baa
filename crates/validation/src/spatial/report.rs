//! The report of a case in space: findings, what is determined, pictures, and the values that every machine reproduces.

use super::claims::SpaceClaims;
use super::determined;
use super::findings::findings;
use super::reference::SpaceReference;
use super::several::of_several;
use crate::case_report::report::CaseReport;
use crate::case_report::snapshot::{printed_positions, reduced_text};
use crate::case_report::validate::Validation;
use crate::error::ValidationError;
use crate::written;
use dwell_kinetostatics::Coefficients;
use dwell_report::{Block, Files, markdown_text};
use dwell_scene::SpaceScene;
use dwell_study::number_format::count;
use dwell_study::reduce::compute::ReducedCurves;
use dwell_study::reduce::compute::ReducedScene as _;
use dwell_study::{PreparedSpaceScene, reduce};
use std::path::Path;

/// Validates a scene in space, with the reference `NAME.json` in a folder if there is one, and what the program at a path writes of it when it
/// runs as a process.
///
/// # Errors
/// [`ValidationError`] when the scene or the reference cannot be used. A failed check is no error.
pub(crate) fn validate_in_space(
    scene: &SpaceScene,
    folder: &Path,
    program: Option<&Path>,
) -> Result<Validation, ValidationError> {
    let (claims, name) = (SpaceClaims::new(scene)?, &scene.name);
    let reference = folder.join(format!("{name}.json"));
    let reference = reference
        .is_file()
        .then(|| SpaceReference::read(&reference));
    let reference = reference.transpose()?;
    let mut report = match scene.mechanism.actuators.len() {
        1 => of_one(&claims, reference.as_ref())?,
        _ => of_several(&claims, reference.as_ref())?,
    };
    let findings = &mut report.findings;
    if let Some(program) = program {
        findings.extend(written::findings(program, name, scene.source.inner()));
        findings.extend(determined::finding(&claims, program));
    }
    findings.sort_by_key(|finding| finding.check);
    let note = scene.note.iter().cloned().map(Block::Words);
    report.introduction.extend(note);
    let mut files = Files::new();
    files.add_document(name, &report.document(scene));
    Ok(report.validation(scene, files))
}

/// Where a reference comes from.
pub(super) fn source(what: &str, reference: Option<&SpaceReference>) -> Vec<Block> {
    let text = |reference: &SpaceReference| {
        let source = markdown_text(reference.source());
        Block::Text(format!("{what}: {source}."))
    };
    reference.map(text).into_iter().collect()
}

/// The report of a case of one coordinate.
fn of_one(
    claims: &SpaceClaims<'_>,
    reference: Option<&SpaceReference>,
) -> Result<CaseReport, ValidationError> {
    let prepared = PreparedSpaceScene::new(claims.scene())?;
    let findings = findings(claims, &prepared, reference)?;
    let curves = ReducedCurves::new(&prepared, None)?;
    let is_rounding = curves.rounding(&prepared);
    let mut figures = vec![prepared.mechanism_figure()?];
    figures.push(reduce::figures::reduced(&prepared, &curves, &is_rounding));
    figures.extend(reduce::figures::coefficients(&prepared, &curves, &is_rounding).0);
    let mut introduction = source("Reference of 25 digits", reference);
    introduction.extend(overconstrained(&prepared).map(Block::Text));
    Ok(CaseReport {
        findings,
        introduction,
        values: values(&prepared)?,
        figures,
        ..CaseReport::default()
    })
}

/// What is said of a mechanism with redundant constraints.
fn overconstrained(prepared: &PreparedSpaceScene<'_>) -> Option<String> {
    let mobility = prepared.model.model().plan().mobility();
    if mobility.redundant_count == 0 {
        return None;
    }
    let redundant = count(mobility.redundant_count, "constraint");
    let mut text = format!("The mechanism is overconstrained by {redundant}.");
    let open = prepared.indeterminate.iter();
    let open: Vec<String> = open.map(|&r| prepared.scene.reaction_name(r)).collect();
    if !open.is_empty() {
        text += &format!(
            " So these reactions are statically indeterminate and are given nowhere: {}.",
            markdown_text(&open.join(", "))
        );
    }
    let named = prepared.reaction_units().into_iter().map(|(name, _)| name);
    let named: Vec<String> = named.collect();
    text += &match named.is_empty() {
        true => " No component along the axes of the ground is determined.".to_owned(),
        false => format!(" Determined are {}.", markdown_text(&named.join(", "))),
    };
    Some(text)
}

/// Forces that are all smaller than this part of the moments over the size, and moments than the forces times the size, are rounding.
const NO_PART: f64 = 1e-6;

/// The reduced model, to seven digits after the first of the largest value of its kind.
fn values(prepared: &PreparedSpaceScene<'_>) -> Result<String, ValidationError> {
    let q = printed_positions(prepared.drawn_range());
    let all = prepared.coefficients(&q)?;
    let names = prepared.reaction_units();
    let m_max = all.iter().fold(0.0_f64, |max, at| max.max(at.m));
    let [forces, moments] = ["N", "N m"].map(|unit| {
        let of_row = |at: &Coefficients| {
            let pairs = names.iter().zip(at.a.iter().zip(&at.b));
            let own = pairs.filter(|((_, of), _)| *of == unit);
            own.fold(0.0_f64, |max, (_, (a, b))| max.max(a.abs()).max(b.abs()))
        };
        all.iter().map(of_row).fold(0.0, f64::max)
    });
    let size = prepared.size();
    // What all is rounding beside the other unit has no digits.
    let scales = [
        m_max,
        forces.max(NO_PART * moments / size),
        moments.max(NO_PART * forces * size),
    ];
    Ok(reduced_text(prepared, q.into_iter().zip(all), scales))
}
