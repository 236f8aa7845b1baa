//! The report of a case in space: findings, what is determined, pictures, and the values that every machine reproduces.

use super::claims::SpaceClaims;
use super::determined;
use super::findings::findings;
use super::reference::Reference;
use super::several::of_several;
use crate::case_report::snapshot::{rounded_to, verdicts};
use crate::case_report::validate::{Validation, pictures};
use crate::error::ValidationError;
use crate::report_parts::{figure_blocks, findings_text, result_line};
use crate::written;
use dwell_findings::Finding;
use dwell_kinetostatics::Coefficients;
use dwell_report::{Block, Document, Figure, Files, markdown_text};
use dwell_scene::SpaceScene;
use dwell_study::number_format::count;
use dwell_study::output::provenance_line;
use dwell_study::reduce::compute::ReducedCurves;
use dwell_study::reduce::compute::ReducedScene as _;
use dwell_study::{Outcome, PreparedSpaceScene, reduce};
use std::fmt::Write as _;
use std::path::Path;

/// Positions in the snapshot.
const PRINTED: usize = 8;

/// What a report says of a case, beside the findings of what is written of it.
pub(super) struct Report {
    pub(super) findings: Vec<Finding>,
    /// What follows the number of findings that pass.
    pub(super) about: String,
    /// What a reference is called.
    pub(super) reference: &'static str,
    /// What is said below it.
    pub(super) more: Option<String>,
    /// Values that every machine reproduces.
    pub(super) values: String,
    pub(super) figures: Vec<Figure>,
}

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
    let reference = folder.join(format!("{}.json", scene.name));
    let reference = reference.is_file().then(|| Reference::read(&reference));
    let reference = reference.transpose()?;
    let claims = SpaceClaims::new(scene)?;
    let mut report = match scene.mechanism.actuators.len() {
        1 => of_one(&claims, reference.as_ref())?,
        _ => of_several(&claims, reference.as_ref())?,
    };
    if let Some(program) = program {
        let text = scene.source.inner();
        report
            .findings
            .extend(written::findings(program, &scene.name, text));
        report
            .findings
            .extend(determined::finding(&claims, program));
    }
    report.findings.sort_by_key(|finding| finding.check);
    let document = document(scene, reference.as_ref(), &report);
    let snapshot = format!("{}\n{}", report.values, verdicts(&report.findings));
    let name = &scene.name;
    let mut files = Files::new();
    files.add(format!("{name}.txt"), snapshot.clone());
    files.add_document(name, &document);
    Ok(Validation {
        outcome: Outcome {
            summary: findings_text(name, &report.findings, ""),
            files,
            findings: report.findings,
            pictures: pictures(scene, report.figures),
            ..Outcome::default()
        },
        snapshot,
        ..Validation::default()
    })
}

fn document(scene: &SpaceScene, reference: Option<&Reference>, report: &Report) -> Document {
    let findings = &report.findings;
    let mut texts = vec![format!("{}{}", result_line(findings), report.about)];
    texts.extend(reference.map(|reference| {
        let source = markdown_text(reference.source());
        format!("{}: {source}.", report.reference)
    }));
    texts.extend(report.more.clone());
    let mut blocks: Vec<Block> = texts.into_iter().map(Block::Text).collect();
    blocks.extend(scene.note.iter().cloned().map(Block::Words));
    blocks.push(Block::Heading("Findings".to_owned()));
    blocks.push(Block::Findings(findings.clone()));
    blocks.push(Block::Heading("Figures".to_owned()));
    blocks.extend(figure_blocks(&scene.name, &report.figures, true));
    blocks.push(Block::Text(provenance_line(scene)));
    Document {
        title: scene.title.clone(),
        blocks,
    }
}

/// The report of a case of one coordinate.
fn of_one(
    claims: &SpaceClaims<'_>,
    reference: Option<&Reference>,
) -> Result<Report, ValidationError> {
    let prepared = PreparedSpaceScene::new(claims.scene())?;
    let findings = findings(claims, &prepared, reference)?;
    let curves = ReducedCurves::new(&prepared, None)?;
    let is_rounding = curves.rounding(&prepared);
    let mut figures = vec![prepared.mechanism_figure()?];
    figures.push(reduce::figures::reduced(&prepared, &curves, &is_rounding));
    figures.extend(reduce::figures::coefficients(&prepared, &curves, &is_rounding).0);
    Ok(Report {
        findings,
        about: String::new(),
        reference: "Reference of 25 digits",
        more: overconstrained(&prepared),
        values: values(&prepared)?,
        figures,
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

/// The reduced model at eight positions, to seven digits after the first of the largest value of its kind.
fn values(prepared: &PreparedSpaceScene<'_>) -> Result<String, ValidationError> {
    let [from, to] = prepared.drawn_range();
    let at = |k: usize| from + (to - from) * (k as f64 + 0.5) / PRINTED as f64;
    let q: Vec<f64> = (0..PRINTED).map(at).collect();
    let all = prepared.coefficients(&q)?;
    let names = prepared.reaction_units();
    let m_max = all.iter().fold(0.0_f64, |max, at| max.max(at.m));
    let of_unit = |unit: &str| {
        let of_row = |at: &Coefficients| {
            let pairs = names.iter().zip(at.a.iter().zip(&at.b));
            let own = pairs.filter(|((_, of), _)| *of == unit);
            own.fold(0.0_f64, |max, (_, (a, b))| max.max(a.abs()).max(b.abs()))
        };
        all.iter().map(of_row).fold(0.0, f64::max)
    };
    let ([forces, moments], size) = (["N", "N m"].map(of_unit), prepared.size());
    // What all is rounding beside the other unit has no digits.
    let scales = [
        forces.max(NO_PART * moments / size),
        moments.max(NO_PART * forces * size),
    ];
    let mut text = format!("{}\n\n", prepared.scene.title);
    // Writing to a string cannot fail.
    for (q, at) in q.iter().zip(&all) {
        let [m, half_dm] = [at.m, at.half_dm].map(|value| rounded_to(value, m_max));
        let _ = writeln!(text, "q = {q:.7}  m = {m}  half_dm = {half_dm}");
        for (k, (name, unit)) in names.iter().enumerate() {
            let scale = if *unit == "N" { scales[0] } else { scales[1] };
            let [a, b] = [at.a[k], at.b[k]].map(|value| rounded_to(value, scale));
            let _ = writeln!(text, "    {name}  a = {a}  b = {b}");
        }
    }
    Ok(text)
}
